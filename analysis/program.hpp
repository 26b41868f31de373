// SPDX-License-Identifier: GPL-3.0-or-later
// Other programs, run to their end: their words are passed as they are, and no shell sees them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace shearcell {

struct ProgramOutcome {
  int status = 0;        ///< as waitpid(2) gives it
  std::string output;    ///< what it wrote to its standard output
  std::string messages;  ///< and to its standard error

  /// Whether it ended by itself with code 0.
  bool succeeded() const;
};

/// Runs the program `words[0]`, searched in PATH, in `folder`, with nothing to read and with
/// `variables` ("NAME=value") over its environment. Nothing when it is not installed. Throws
/// std::runtime_error when it cannot be started or is lost.
std::optional<ProgramOutcome> run_program(std::vector<std::string> words,
                                          const std::filesystem::path& folder,
                                          const std::vector<std::string>& variables = {});

/// Pointers to the texts and a null at the end, as exec(3) takes words and variables; they hold as
/// long as `texts` stays as it is.
std::vector<char*> pointers_to(std::vector<std::string>& texts);

}  // namespace shearcell
