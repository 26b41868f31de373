// SPDX-License-Identifier: GPL-3.0-or-later
// Errors, by what the caller can do about them. experiments/cli/main.cpp turns them into exit
// codes.
#pragma once

#include <stdexcept>

namespace shearcell {

/// The user's input is wrong: an option, a manifest, an input file. Exit code 2.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The named store, run, checkpoint or figure does not exist, or the name is ambiguous.
struct NotFound : UsageError {
  using UsageError::UsageError;
};

/// The checkpoint was pruned: its record is kept and its file was deleted on purpose.
struct FilePruned : NotFound {
  using NotFound::NotFound;
};

/// The machine cannot do it, or another program is in the way. Exit code 1, like errors of the
/// operating system (std::system_error).
struct MachineError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The data do not fit into the memory of this machine.
struct TooLittleMemory : MachineError {
  using MachineError::MachineError;
};

/// Another writer was faster: it holds the run, took it, or wrote what the caller has not read.
struct ConcurrencyConflict : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The bytes of the store are not what was once written: not a store, a newer schema, a truncated
/// or altered checkpoint, a broken chain, two results for one run. Exit code 4.
struct StoreDamaged : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace shearcell
