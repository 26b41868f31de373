// SPDX-License-Identifier: GPL-3.0-or-later
// Other programs, run in the background or to their end. Arguments are passed as they are; no shell
// is involved.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace shearcell {

/// A program is missing, cannot be started or failed; what() says what to do.
class ProgramError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The text as one word for a POSIX shell, in single quotes only if it needs them.
std::string shell_word(std::string_view text);

/// The executable file of this name: the name itself if it has a slash, else the first on PATH.
/// Nothing when there is no such file.
std::optional<std::filesystem::path> find_program(const std::string& name);

struct Command {
  std::vector<std::string> words;  ///< the program (a path or a name on PATH) and arguments
  std::filesystem::path folder;    ///< working folder
  /// Changes of the environment: "NAME=value" sets a variable, "NAME" removes it, and "NAME*"
  /// removes all whose names begin with NAME.
  std::vector<std::string> variables;
  int output = -1;    ///< descriptor for its standard output
  int messages = -1;  ///< descriptor for its standard error
};

/// A running program. Its standard input is empty. It has its own process group, so Ctrl-C on a
/// terminal does not reach it. It gets SIGTERM when this object is destroyed or when the thread
/// that started it ends for any reason.
class ChildProcess {
 public:
  /// Throws ProgramError when it cannot be started.
  explicit ChildProcess(const Command& command);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// The exit code, or 128 + the number of the signal that ended it; nothing while it runs.
  std::optional<int> exit_code();

  /// Waits for the end of the program and returns exit_code().
  int wait();

  /// Processor time of the program so far, without its children.
  double core_seconds() const;

 private:
  bool reap(int options);

  pid_t pid_ = 0;
  std::optional<int> exit_code_;
  double core_seconds_ = 0;  // of the ended process
};

struct ProgramOutcome {
  int code = 0;          ///< as ChildProcess::exit_code
  std::string output;    ///< its standard output
  std::string messages;  ///< its standard error
};

/// Runs the program `words[0]` in `folder` and waits for its end. Nothing when it is not installed.
/// Throws ProgramError when it cannot be started, or has not ended after `seconds`; then it is
/// killed.
std::optional<ProgramOutcome> run_program(const std::vector<std::string>& words,
                                          const std::filesystem::path& folder,
                                          const std::vector<std::string>& variables = {},
                                          std::optional<double> seconds = std::nullopt);

}  // namespace shearcell
