// SPDX-License-Identifier: GPL-3.0-or-later
// What the experiments that share a run ask for: its length, an early end, and checkpoints. None of
// this is part of the run's identity; the run gets everything that any of them asks for.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/scene.hpp"
#include "experiments/manifest/manifest.hpp"
#include "protocols/cyclic_shear.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// What one experiment asks for.
struct RunAsk {
  std::uint64_t target_cycles = 0;
  std::optional<Until> until = {};
  std::uint64_t checkpoint_every = 1;  ///< cycles
  std::vector<double> phases = {};     ///< more checkpoints in each cycle after one of these
};

/// The motion of the walls in a shear; nothing for another kind of run, and for a record that this
/// program cannot read (`verify` names it).
std::optional<Drive> shear_drive(const RunRecord& run);

/// One for each membership of the run, from its declarations. Throws StoreDamaged when a
/// declaration is not as this program writes it.
std::vector<RunAsk> asks_of(const Store& store, const std::string& run);

/// For one membership of the run.
RunAsk ask_of(const Store& store, const std::string& run, const Membership& membership);

/// Whether an experiment states an `until`, so that the run may end before its number of cycles.
bool may_end_early(const Store& store, const std::string& run);

/// The same as the shear takes it.
CheckpointCadence cadence_of(const RunAsk& ask, const Drive& drive);

/// Steps of a shear, from cycle `first` to cycle `last`, at which `ask` asks for a checkpoint;
/// ascending, at most a million.
std::vector<std::uint64_t> checkpoint_steps(const RunAsk& ask, const Drive& drive, double first,
                                            double last);

/// The longest interval [cycles] that gives every experiment its checkpoints at whole cycles.
std::uint64_t checkpoint_cadence(const RunRecord& run);

/// Steps before the run's last one at which an experiment, or one of the `planned` asks, asks for a
/// checkpoint that was never recorded; ascending. This happens when a denser cadence is asked for
/// later. Empty for a LAMMPS run, because it cannot be repeated.
std::vector<std::uint64_t> missing_checkpoints(const Store& store, const RunRecord& run,
                                               std::span<const RunAsk> planned = {});

/// Whether the run is not completed or lacks checkpoints. False for a completed run whose records
/// cannot be read; `verify` names those.
bool has_work_left(const Store& store, const RunRecord& run);

}  // namespace shearcell
