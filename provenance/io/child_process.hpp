// SPDX-License-Identifier: GPL-3.0-or-later
// Runs other programs, in the background or until they end. No shell interprets the arguments.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace shearcell {

/// Thrown when a program is missing, cannot be started or fails. what() says what to do.
struct ProgramError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Returns `text` as one word for a POSIX shell. Quotes are added only if `text` needs them.
std::string shell_word(std::string_view text);

/// Path of the program `name`: the file `name` itself if the name has a slash, otherwise the first
/// executable file of this name on PATH. Nothing when there is no such file.
std::optional<std::filesystem::path> find_program(const std::string& name);

struct Command {
  std::vector<std::string> words;  ///< program (a path or a name on PATH), then arguments
  std::filesystem::path folder;    ///< working folder of the program
  /// Changes to the environment of the program: "NAME=value" sets a variable, "NAME" removes it,
  /// and "NAME*" removes all variables whose names begin with NAME.
  std::vector<std::string> variables;
  int output = -1;    ///< file descriptor that receives standard output
  int messages = -1;  ///< file descriptor that receives standard error
};

/// A running program. Its standard input is empty. The program has its own process group, so Ctrl-C
/// on a terminal does not stop it. When the thread that started the program ends, the program gets
/// SIGTERM. The destructor sends SIGTERM, and SIGKILL if the program still runs 5 s later.
class ChildProcess {
 public:
  /// Throws ProgramError when the program cannot be started.
  explicit ChildProcess(const Command& command);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Exit code, or 128 + the number of the signal that killed the program; nothing while it runs.
  std::optional<int> exit_code();

  /// Waits until the program ends and returns exit_code().
  int wait();

  /// Processor time of the program [s]. While the program runs, its child processes are not
  /// counted. After the end, the child processes for which the program waited are counted, too.
  double core_seconds() const;

 private:
  bool reap(int options);

  pid_t pid_ = 0;
  std::optional<int> exit_code_;
  double core_seconds_ = 0;  // processor time of a program that has ended
};

struct ProgramOutcome {
  int code = 0;          ///< see ChildProcess::exit_code()
  std::string output;    ///< what the program wrote to standard output
  std::string messages;  ///< what the program wrote to standard error, at most 2000 bytes and "..."
};

/// Runs the program `words[0]` in `folder` and waits until it ends. Returns nothing when the
/// program is not installed. Kills the program if it runs longer than `seconds`. Throws
/// ProgramError when the program cannot be started, or was killed because it ran too long.
std::optional<ProgramOutcome> run_program(const std::vector<std::string>& words,
                                          const std::filesystem::path& folder,
                                          const std::vector<std::string>& variables = {},
                                          std::optional<double> seconds = std::nullopt);

}  // namespace shearcell
