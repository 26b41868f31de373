// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/experiments/program.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>
#include <utility>

#include "tests/support/spawn.hpp"

namespace shearcell::test {

namespace fs = std::filesystem;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
static constexpr int kLimitSeconds = 1200;  // the sanitizers make a program up to 20 times slower
#else
static constexpr int kLimitSeconds = 120;
#endif

ProgramTest::Running ProgramTest::start(const Arguments& arguments, const std::string& name,
                                        const char* executable) {
  Running program{0, outputs_.path() / ("out" + name), outputs_.path() / ("err" + name)};
  for (const fs::path& file : {program.out, program.err}) fs::remove(file);
  // The caller's environment may name a store.
  Arguments words = {"-u", "SHEARCELL_STORE", "-u", "NO_COLOR"};
  if (!named_store_.empty()) words.push_back("SHEARCELL_STORE=" + named_store_);
  words.emplace_back(executable);
  program.pid = spawn(joined(words, arguments), folder_.path(), program.out, program.err);
  return program;
}

ProgramTest::Running ProgramTest::start_beside(const Arguments& arguments,
                                               const std::string& name) {
  return start(arguments, "-" + name);
}

Outcome ProgramTest::wait_for(const Running& program) {
  int status = 0;
  // A program that hangs must not hang the suite.
  const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(kLimitSeconds);
  while (waitpid(program.pid, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > limit) kill(program.pid, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  Outcome outcome;
  if (WIFEXITED(status)) outcome.code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) outcome.signal = WTERMSIG(status);
  outcome.out = read_bytes(program.out);
  outcome.err = read_bytes(program.err);
  return outcome;
}

void ProgramTest::wait_for_words(const Running& program, const std::string& words) {
  const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(kLimitSeconds);
  while (!has(read_bytes(program.err), words) && std::chrono::steady_clock::now() < limit) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

Outcome ProgramTest::run(const Arguments& arguments) {
  return wait_for(start(arguments));
}

Outcome ProgramTest::expect(int code, const Arguments& arguments,
                            const std::vector<std::string>& says, CallPlace where) {
  std::string words;
  for (const std::string& word : arguments) words += " " + word;
  const testing::ScopedTrace trace(where.file, where.line, words);
  Outcome outcome = run(arguments);
  const std::string said = outcome.out + outcome.err;
  EXPECT_EQ(outcome.code, code) << "signal " << outcome.signal << "\n" << said.substr(0, 2000);
  for (const std::string& part : says) EXPECT_TRUE(has(said, part));
  return outcome;
}

void ProgramTest::expect_refused(const Arguments& arguments, const std::vector<std::string>& says,
                                 CallPlace where) {
  const auto before = listing();
  EXPECT_EQ(expect(2, arguments, says, where).out, "");
  EXPECT_EQ(listing(), before) << "something was written";
}

Outcome ProgramTest::shell(const std::string& script) {
  return wait_for(start({"-c", script, SHEARCELL_PROGRAM}, "", "/bin/sh"));
}

Outcome ProgramTest::run_until(const Arguments& arguments, std::size_t files, int signal) {
  const Running program = start(arguments);
  const pid_t child = program.pid;
  siginfo_t ended{};
  while (objects() < files) {
    waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT);
    if (ended.si_pid == child) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  kill(child, signal);
  return wait_for(program);
}

void ProgramTest::shared(const std::string& identity, const std::string& place,
                         const std::function<void(const std::string& folder)>& make) {
  // In a folder named after the program's date: another build makes it again.
  const fs::path program = SHEARCELL_PROGRAM;
  const auto date = fs::last_write_time(program).time_since_epoch().count();
  const fs::path all = program.parent_path() / "test-campaigns" / std::to_string(date);
  const fs::path kept = all / std::to_string(std::hash<std::string>{}(identity));
  if (fs::create_directories(all)) {
    for (const auto& old : fs::directory_iterator(all.parent_path())) {
      if (old.path() != all) fs::remove_all(old.path());
    }
  }
  const int lock = open((kept.string() + ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_GE(lock, 0);
  flock(lock, LOCK_EX);
  if (!fs::exists(kept)) {
    const std::string part = kept.string() + ".part";
    fs::remove_all(part);
    make(part);
    if (HasFailure()) {  // the next test tries again
      fs::remove_all(part);
      close(lock);
      return;
    }
    fs::rename(part, kept);
  }
  close(lock);
  fs::copy(kept, path(place), fs::copy_options::recursive);
}

void ProgramTest::campaign(const std::string& manifest, const Arguments& options,
                           const std::string& store) {
  const std::string file = write("m.yaml", manifest);
  std::string identity = manifest;
  for (const std::string& option : options) identity += " " + option;
  shared(identity, store, [&](const std::string& folder) {
    expect(0, joined({"run", file, "-q", "--store", folder}, options));
  });
}

std::vector<std::string> ProgramTest::commands() {
  const std::string help = expect(0, {"--help"}, {"\nCompute:\n", "\nExamples:\n"}).out;
  std::istringstream lines(help.substr(help.find("\nCompute:\n") + 1));
  std::vector<std::string> found;
  for (std::string line; std::getline(lines, line) && line != "Examples:";) {
    if (line.starts_with("  ") && line[2] != ' ') {
      found.push_back(line.substr(2, line.find(' ', 2) - 2));
    }
  }
  EXPECT_GE(found.size(), 20U);
  return found;
}

void ProgramTest::wait_for_objects(std::size_t files, const std::string& store) const {
  const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(kLimitSeconds);
  while (objects(store) < files) {
    ASSERT_LT(std::chrono::steady_clock::now(), limit) << objects(store) << " of " << files;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

nlohmann::json ProgramTest::json(const Arguments& arguments) {
  const Outcome outcome = expect(0, arguments);
  nlohmann::json facts = nlohmann::json::parse(outcome.out, nullptr, false);
  EXPECT_FALSE(facts.is_discarded()) << outcome.out;
  return facts;
}

std::set<std::string> ProgramTest::listing() const {
  std::set<std::string> found;
  for (const auto& entry : fs::recursive_directory_iterator(folder_.path())) {
    found.insert(entry.path().lexically_relative(folder_.path()).string());
  }
  return found;
}

std::size_t ProgramTest::objects(const std::string& store) const {
  std::size_t count = 0;
  std::error_code gone;
  for (auto entry = fs::recursive_directory_iterator(path(store) / "objects", gone);
       !gone && entry != fs::recursive_directory_iterator(); entry.increment(gone)) {
    count += entry->path().extension() == ".h5" ? 1 : 0;
  }
  return count;
}

std::map<std::string, std::string> ProgramTest::hashes(const std::string& store) {
  std::map<std::string, std::string> found;
  const nlohmann::json status = json({"status", "--json", "--store", store});
  for (const auto& run : status.at("runs")) {
    EXPECT_EQ(run.at("state"), "completed");
    found[run.at("id")] = run.at("state_hash");
  }
  EXPECT_FALSE(found.empty());
  return found;
}

}  // namespace shearcell::test
