// SPDX-License-Identifier: GPL-3.0-or-later
// Other programs, beside this one or run to their end: their words are passed as they are, and no
// shell sees them.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace shearcell {

/// Another program that is needed is missing or went wrong; what() says what to do.
class ProgramError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An open file, closed in the end; a negative number is none.
struct Descriptor {
  explicit Descriptor(int file) : number(file) {}
  ~Descriptor();
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number;
};

/// The file that a name stands for: itself with a slash, else the first on PATH; nothing where
/// there is none that may be executed.
std::optional<std::filesystem::path> find_program(const std::string& name);

struct Command {
  std::vector<std::string> words;      ///< the program, as a path or a name on PATH, and arguments
  std::filesystem::path folder;        ///< in which it works
  std::vector<std::string> variables;  ///< "NAME=value", over the environment
  int output = -1;                     ///< open files that take its standard output
  int messages = -1;                   ///< and its standard error
};

/// It has nothing to read and a process group of its own, so that Ctrl-C on a terminal does not
/// reach it, and is told to end when this object goes away or the thread that made it ends, however
/// that happens.
class ChildProcess {
 public:
  /// Throws ProgramError when it cannot be started.
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

struct ProgramOutcome {
  int code = 0;          ///< as ChildProcess::exit_code tells it
  std::string output;    ///< what it wrote to its standard output
  std::string messages;  ///< and to its standard error
};

/// Runs the program `words[0]` to its end, in `folder`, with `variables` ("NAME=value") over its
/// environment. Nothing when it is not installed. Throws ProgramError when it cannot be started.
std::optional<ProgramOutcome> run_program(const std::vector<std::string>& words,
                                          const std::filesystem::path& folder,
                                          const std::vector<std::string>& variables = {});

}  // namespace shearcell
