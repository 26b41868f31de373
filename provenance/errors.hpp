// SPDX-License-Identifier: GPL-3.0-or-later
// What can go wrong with a store, told apart by what the caller can do about it.
#pragma once

#include <stdexcept>

namespace shearcell {

/// The bytes of the store are not what was once written there: not a store, a newer schema, a
/// truncated or altered checkpoint, a broken chain. The program ends with exit code 4.
class StoreDamaged : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An append expected another version of its stream: somebody else wrote to it meanwhile.
class ConcurrencyConflict : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Another program holds the run (lease.hpp) and is at work on it.
class RunHeld : public ConcurrencyConflict {
 public:
  using ConcurrencyConflict::ConcurrencyConflict;
};

/// Another process held the store's write lock for longer than the waiting time.
class StoreBusy : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The named store, run or checkpoint does not exist, or the name fits several.
class NotFound : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Two stores tell different things about the same run, so they cannot be merged.
class MergeConflict : public StoreDamaged {
 public:
  using StoreDamaged::StoreDamaged;
};

/// The checkpoint was pruned: its record stays and its file was removed on purpose.
class CheckpointPruned : public NotFound {
 public:
  using NotFound::NotFound;
};

}  // namespace shearcell
