// SPDX-License-Identifier: GPL-3.0-or-later
// One checkpoint for export: every particle with its measures, in SI units.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "experiments/figures/run_table.hpp"
#include "experiments/runner/lammps/lammps_deck.hpp"
#include "experiments/runner/measure_sources.hpp"
#include "experiments/runner/particles.hpp"
#include "provenance/checkpoint.hpp"

namespace shearcell {

/// A measure of each particle.
struct ExportedColumn {
  std::string name;
  bool whole = false;  ///< whole numbers
  std::vector<double> values;
};

/// Particles in SI units. Measures of wall grains are 0, classes -1. Velocities of grains and of
/// the moving wall are half a time step before the state's step, velocities of the tilting walls at
/// this step.
struct ExportedState : Particles {
  Checkpoint checkpoint;
  std::string sha256;  ///< of the checkpoint's file

  /// Facts of the run, texts and numbers: id, experiment, scale, variant and seed; the parameters
  /// that distinguish runs, by their keys in a manifest.
  std::vector<std::pair<std::string, nlohmann::json>> run, parameters;
  /// The measures of the frame by their names in `table`; NaN if unknown.
  std::vector<std::pair<std::string, double>> scalars;

  /// The measures of each grain (analysis/measures.hpp); if unknown NaN, or -1 of a whole number.
  std::vector<ExportedColumn> columns;
  double stiffness_N_per_m = std::nan("");  ///< of a contact; NaN if unknown
  MeasureOutcome unread;                    ///< earlier checkpoints; measures over them are NaN

  /// How the run goes on from here; nothing for a stiffening, or if the stage cannot be read.
  std::optional<LammpsTask> continued;
};

/// The frame in a file's name: its cycle; of a packing, which has no cycles, "step45600".
std::string frame_name(const ExportedState& frame);

/// `sources` has read the run; without it, measures that need earlier checkpoints are NaN. `every`:
/// as in ToMeasure. Throws as analyse_stored().
ExportedState frame_of(const Checkpoint& checkpoint, const CheckpointRecord& record = {},
                       const Run& run = {}, const MeasureSources* sources = nullptr,
                       std::uint64_t every = 1);

}  // namespace shearcell
