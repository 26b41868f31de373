// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/engines/child_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <thread>

#include "analysis/program.hpp"

namespace shearcell {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> environment_of(const Command& command) {
  std::vector<std::string> variables;
  for (char** variable = environ; *variable != nullptr; ++variable)
    variables.emplace_back(*variable);
  for (const auto& [name, value] : command.environment) {
    if (std::getenv(name.c_str()) == nullptr)
      variables.push_back(fmt::format("{}={}", name, value));
  }
  return variables;
}

// What the child needs, made before the fork: after it, only calls that are safe in a signal
// handler.
struct Prepared {
  const char* program;
  char* const* words;
  char* const* variables;
  const char* folder;
  const char* output;
  pid_t parent;
};

[[noreturn]] void become(const Prepared& p, int errors) {
  const auto fail = [errors] {
    const int why = errno;
    (void)!write(errors, &why, sizeof why);
    _exit(127);
  };
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != p.parent) _exit(127);
  const int in = open("/dev/null", O_RDONLY);
  const int out = open(p.output, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (in < 0 || out < 0) fail();
  if (dup2(in, STDIN_FILENO) < 0 || dup2(out, STDOUT_FILENO) < 0 || dup2(out, STDERR_FILENO) < 0) {
    fail();
  }
  if (chdir(p.folder) != 0) fail();
  execve(p.program, p.words, p.variables);
  fail();
  _exit(127);
}

}  // namespace

std::optional<fs::path> find_program(const std::string& name) {
  const auto usable = [](const fs::path& file) {
    std::error_code ignored;
    return fs::is_regular_file(file, ignored) && access(file.c_str(), X_OK) == 0;
  };
  if (name.find('/') != name.npos) {
    return usable(name) ? std::optional<fs::path>(fs::absolute(name)) : std::nullopt;
  }
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "/usr/bin:/bin" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path file = fs::path(folder.empty() ? "." : folder) / name;
    if (usable(file)) return fs::absolute(file);
  }
  return std::nullopt;
}

ChildProcess::ChildProcess(const Command& command) {
  const std::string& name = command.words.at(0);
  const auto program = find_program(name);
  if (!program) throw EngineError("there is no program " + name + " on PATH");
  std::vector<std::string> words = command.words;
  std::vector<std::string> variables = environment_of(command);
  const std::vector<char*> word_pointers = pointers_to(words);
  const std::vector<char*> variable_pointers = pointers_to(variables);
  const fs::path output = fs::absolute(command.output);
  const Prepared prepared = {program->c_str(),       word_pointers.data(), variable_pointers.data(),
                             command.folder.c_str(), output.c_str(),       getpid()};
  std::array<int, 2> errors{};
  if (pipe2(errors.data(), O_CLOEXEC) != 0) {
    throw EngineError("cannot start " + name + ": " + std::strerror(errno));
  }
  pid_ = fork();
  if (pid_ == 0) become(prepared, errors[1]);
  int why = errno;
  close(errors[1]);
  const bool failed =
      pid_ < 0 || read(errors[0], &why, sizeof why) == static_cast<ssize_t>(sizeof why);
  close(errors[0]);
  if (!failed) return;
  if (pid_ > 0) waitpid(pid_, nullptr, 0);
  throw EngineError("cannot start " + name + ": " + std::strerror(why));
}

ChildProcess::~ChildProcess() {
  using namespace std::chrono_literals;
  if (exit_code()) return;
  kill(-pid_, SIGTERM);
  for (int look = 0; look < 100; ++look) {
    if (exit_code()) return;
    std::this_thread::sleep_for(50ms);
  }
  kill(-pid_, SIGKILL);
  reap(0);
}

bool ChildProcess::reap(int options) {
  int status = 0;
  rusage used{};
  pid_t ended = 0;
  while ((ended = wait4(pid_, &status, options, &used)) < 0 && errno == EINTR) {
  }
  if (ended == 0) return false;
  exit_code_ = ended < 0 ? 127 : WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  peak_bytes_ = static_cast<std::size_t>(used.ru_maxrss) * 1024;
  return true;
}

std::optional<int> ChildProcess::exit_code() {
  if (!exit_code_) reap(WNOHANG);
  return exit_code_;
}

int ChildProcess::wait() {
  if (!exit_code_) reap(0);
  return *exit_code_;
}

}  // namespace shearcell
