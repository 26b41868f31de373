// SPDX-License-Identifier: GPL-3.0-or-later
// A program that runs beside this one, started from a list of words and never through a shell.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace shearcell {

/// Another program that a computation needs is missing or went wrong; what() says what to do.
class EngineError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Command {
  std::vector<std::string> words;  ///< the program, as a path or a name on PATH, and its arguments
  std::filesystem::path folder;    ///< in which it works
  std::filesystem::path output;    ///< takes what it says on both streams
  /// Variables for it, where the environment does not set them already.
  std::vector<std::pair<std::string, std::string>> environment;
};

/// The file that a name stands for: itself with a slash, else the first on PATH; nothing where
/// there is none that may be executed.
std::optional<std::filesystem::path> find_program(const std::string& name);

/// It has a process group of its own, so that Ctrl-C on a terminal does not reach it, and is told
/// to end when this object goes away or the thread that made it ends, however that happens.
class ChildProcess {
 public:
  /// Throws EngineError when it cannot be started.
  explicit ChildProcess(const Command& command);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// As a shell tells it: the exit code, or 128 + the signal that ended it; nothing while it runs.
  std::optional<int> exit_code();

  /// Waits for its end.
  int wait();

  /// Memory of its largest process so far that ended [bytes]; 0 while it runs.
  std::size_t peak_bytes() const { return peak_bytes_; }

 private:
  bool reap(int options);

  pid_t pid_ = 0;
  std::optional<int> exit_code_;
  std::size_t peak_bytes_ = 0;
};

}  // namespace shearcell
