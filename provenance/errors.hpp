// SPDX-License-Identifier: GPL-3.0-or-later
// Errors by what the caller can do about them. experiments/cli/exit_code.hpp gives each its exit
// code.
#pragma once

#include <stdexcept>

namespace shearcell {

/// The user's input is wrong: an option, a manifest, an input file. Exit code 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The named store, run, checkpoint or figure does not exist, or the name is ambiguous.
class NotFound : public UsageError {
 public:
  using UsageError::UsageError;
};

/// The checkpoint was pruned: its record is kept and its file was deleted on purpose.
class CheckpointPruned : public NotFound {
 public:
  using NotFound::NotFound;
};

/// The machine cannot do it. Exit code 1, like errors of the operating system (std::system_error).
class MachineError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The data do not fit into the memory of this machine.
class TooLittleMemory : public MachineError {
 public:
  using MachineError::MachineError;
};

/// Another process held the store's write lock for longer than the waiting time.
class StoreBusy : public MachineError {
 public:
  using MachineError::MachineError;
};

/// An append expected another version of its stream: another writer was faster.
class ConcurrencyConflict : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Another program holds the lease of the run (lease.hpp).
class RunHeld : public ConcurrencyConflict {
 public:
  using ConcurrencyConflict::ConcurrencyConflict;
};

/// The bytes of the store are not what was once written: not a store, a newer schema, a truncated
/// or altered checkpoint, a broken chain. Exit code 4.
class StoreDamaged : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Two stores hold different results for the same run, so they cannot be merged.
class MergeConflict : public StoreDamaged {
 public:
  using StoreDamaged::StoreDamaged;
};

}  // namespace shearcell
