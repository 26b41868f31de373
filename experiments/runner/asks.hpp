// SPDX-License-Identifier: GPL-3.0-or-later
// What the experiments that share a run ask of it: its length, an early end, and checkpoints. None
// of this is part of the run's identity; the run has all that any of them asks for.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/scene.hpp"
#include "experiments/manifest/manifest.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// What one experiment asks of a run.
struct RunAsk {
  std::uint64_t target_cycles = 0;
  std::optional<Until> until = {};
  std::uint64_t checkpoint_every = 1;  ///< cycles
  std::vector<double> phases = {};     ///< of each cycle after one of these, for more checkpoints
};

/// One for each membership of the run, from its declarations. Throws StoreDamaged when one is not
/// as this program writes it.
std::vector<RunAsk> asks_of(const Store& store, const std::string& run);

/// That of one membership of the run.
RunAsk ask_of(const Store& store, const std::string& run, const Membership& membership);

/// Steps of a shear at which it asks for a checkpoint, from cycle `first` to cycle `last`,
/// ascending; a million at most.
std::vector<std::uint64_t> checkpoint_steps(const RunAsk& ask, const Drive& drive, double first,
                                            double last);

/// The cadence [cycles] that has the checkpoints at whole cycles of every experiment.
std::uint64_t checkpoint_cadence(const RunRecord& run);

/// Steps before the run's last one at which an experiment, or one of those `planned`, asks for
/// a checkpoint that was never recorded, ascending: it asked for a denser cadence later. None for a
/// run of LAMMPS, which cannot be repeated.
std::vector<std::uint64_t> missing_checkpoints(const Store& store, const RunRecord& run,
                                               std::span<const RunAsk> planned = {});

/// Whether the run is not completed or lacks checkpoints. A completed run whose records cannot be
/// read has none left; `verify` names them.
bool has_work_left(const Store& store, const RunRecord& run);

}  // namespace shearcell
