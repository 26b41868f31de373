// SPDX-License-Identifier: GPL-3.0-or-later
// Exceptions, grouped by what the caller can do. experiments/cli/main.cpp maps them to exit codes.
#pragma once

#include <stdexcept>

namespace shearcell {

/// The user's input is wrong, for example an option, a manifest or an input file. Exit code 2.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The named store, run, checkpoint or figure does not exist, or the name is ambiguous.
struct NotFound : UsageError {
  using UsageError::UsageError;
};

/// The file of the checkpoint was deleted by `prune`. The record of the checkpoint still exists.
struct FilePruned : NotFound {
  using NotFound::NotFound;
};

/// The machine cannot do what was asked, or another program blocks this work. Exit code 1, as for
/// errors of the operating system (std::system_error).
struct MachineError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The data do not fit into the memory of this machine.
struct TooLittleMemory : MachineError {
  using MachineError::MachineError;
};

/// Another process holds the run, has taken it over, or wrote events that the caller did not read.
struct ConcurrencyConflict : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The store cannot be read or is not intact. Examples: another program's file, a newer schema, a
/// damaged checkpoint, a broken hash chain, two different results of one run. Exit code 4.
struct StoreDamaged : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The analysis cannot measure its input. The message names the grain, figure or file, and the
/// reason.
struct AnalysisError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace shearcell
