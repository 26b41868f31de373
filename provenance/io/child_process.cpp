// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/io/child_process.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <thread>

#include "provenance/io/clock.hpp"
#include "provenance/io/file.hpp"

namespace shearcell {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestMessages = 2000;  // [bytes]

std::vector<std::string> environment_with(const std::vector<std::string>& variables) {
  std::vector<std::string> all;
  for (const std::string& variable : variables) {
    if (variable.find('=') != variable.npos) all.push_back(variable);
  }
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string_view own = *variable, name = own.substr(0, own.find('='));
    const auto replaces = [&](std::string_view other) {
      const std::string_view pattern = other.substr(0, other.find('='));
      return pattern.ends_with('*') ? name.starts_with(pattern.substr(0, pattern.size() - 1))
                                    : name == pattern;
    };
    if (std::ranges::none_of(variables, replaces)) all.emplace_back(own);
  }
  return all;
}

// Null-terminated array for exec(3), valid as long as `texts` is not changed.
std::vector<char*> pointers_to(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

// A file in memory that collects the output of a program. The output may have any length.
Descriptor memory_file() {
  Descriptor file(memfd_create("output", MFD_CLOEXEC));
  if (!file.valid())
    throw ProgramError(std::string("cannot create a file in memory: ") + std::strerror(errno));
  return file;
}

// The text in the file. If the text is longer than `most` bytes, returns its beginning and "...".
std::string text_of(const Descriptor& file, std::size_t most = std::string::npos) {
  std::string text;
  std::array<char, 4096> part;
  while (text.size() <= most) {
    const ssize_t got =
        pread(file.get(), part.data(), part.size(), static_cast<off_t>(text.size()));
    if (got <= 0) return text;
    text.append(part.data(), static_cast<std::size_t>(got));
  }
  return text.substr(0, most) + "...";
}

}  // namespace

std::string shell_word(std::string_view text) {
  constexpr const char* plain =
      "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz./-_+=,:@";
  if (!text.empty() && text.find_first_not_of(plain) == text.npos) return std::string(text);
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

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
  if (!program) throw ProgramError("the program " + name + " is not on PATH");
  std::vector<std::string> words = command.words;
  std::vector<std::string> variables = environment_with(command.variables);
  const std::vector<char*> arguments = pointers_to(words), environment = pointers_to(variables);
  const pid_t parent = getpid();
  std::array<int, 2> errors{};
  if (pipe2(errors.data(), O_CLOEXEC) != 0) {
    throw ProgramError("cannot start " + name + ": " + std::strerror(errno));
  }
  pid_ = fork();
  if (pid_ == 0) {  // the child may only make async-signal-safe calls
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(127);
    // A child inherits ignored signals, so their default handling is restored.
    for (const int number : {SIGCHLD, SIGPIPE}) signal(number, SIG_DFL);
    const int in = open("/dev/null", O_RDONLY);
    if (in >= 0 && dup2(in, STDIN_FILENO) >= 0 && dup2(command.output, STDOUT_FILENO) >= 0 &&
        dup2(command.messages, STDERR_FILENO) >= 0 && chdir(command.folder.c_str()) == 0) {
      execve(program->c_str(), arguments.data(), environment.data());
    }
    const int why = errno;
    (void)!write(errors[1], &why, sizeof why);
    _exit(127);
  }
  int why = errno;
  close(errors[1]);
  const bool failed =
      pid_ < 0 || read(errors[0], &why, sizeof why) == static_cast<ssize_t>(sizeof why);
  close(errors[0]);
  if (!failed) return;
  if (pid_ > 0) waitpid(pid_, nullptr, 0);
  throw ProgramError("cannot start " + name + ": " + std::strerror(why));
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
  for (const timeval& time : {used.ru_utime, used.ru_stime}) {
    core_seconds_ += static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  }
  return true;
}

double ChildProcess::core_seconds() const {
  clockid_t clock{};
  timespec time{};
  const bool runs =
      !exit_code_ && clock_getcpuclockid(pid_, &clock) == 0 && clock_gettime(clock, &time) == 0;
  return runs ? seconds_of(time) : core_seconds_;
}

std::optional<int> ChildProcess::exit_code() {
  if (!exit_code_) reap(WNOHANG);
  return exit_code_;
}

int ChildProcess::wait() {
  if (!exit_code_) reap(0);
  return *exit_code_;
}

std::optional<ProgramOutcome> run_program(const std::vector<std::string>& words,
                                          const fs::path& folder,
                                          const std::vector<std::string>& variables,
                                          std::optional<double> seconds) {
  if (!find_program(words.front())) return std::nullopt;
  const Descriptor output = memory_file(), messages = memory_file();
  ChildProcess program({words, folder, variables, output.get(), messages.get()});
  const Stopwatch running;
  while (seconds && !program.exit_code()) {
    if (running.seconds() > *seconds) {
      throw ProgramError(words.front() + " did not answer within " +
                         std::to_string(std::lround(*seconds)) + " s");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  const int code = program.wait();
  return ProgramOutcome{code, text_of(output), text_of(messages, kLongestMessages)};
}

}  // namespace shearcell
