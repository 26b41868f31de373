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
#include "experiments/runner/measure.hpp"
#include "experiments/runner/particles.hpp"
#include "provenance/checkpoint.hpp"

namespace shearcell {

/// A measure that has one value for each particle.
struct ExportedColumn {
  std::string name;
  bool whole = false;  ///< whether the values are whole numbers
  std::vector<double> values;
};

/// Particles in SI units. Measures of wall grains are 0; classes of wall grains are -1. Velocities
/// of grains and of the moving wall are from half a time step before the state's step. Velocities
/// of tilting walls are from the state's step.
struct ExportedState : Particles {
  Checkpoint checkpoint;
  std::string sha256;  ///< SHA-256 of the checkpoint's file

  /// `run`: id, experiment, scale, variant and seed. `parameters`: the parameters that affect the
  /// run, by their keys in a manifest. Values are texts and numbers.
  std::vector<std::pair<std::string, nlohmann::json>> run, parameters;
  /// The frame's scalar measures, by their names in `shearcell table`; NaN if unknown.
  std::vector<std::pair<std::string, double>> scalars;

  /// Measures of each particle (analysis/measures.hpp). An unknown value is NaN, but in a column of
  /// whole numbers it is -1.
  std::vector<ExportedColumn> columns;
  double stiffness_N_per_m = std::nan("");  ///< of a contact; NaN if unknown
  MeasureOutcome unread;                    ///< earlier checkpoints that could not be read

  /// What LAMMPS must compute to continue the run. Empty if the run is a stiffening, or if its
  /// stage cannot be read.
  std::optional<LammpsTask> continued;
};

/// The name of a frame in file names: its cycle, or "step45600" for a packing, which has no cycles.
std::string frame_name(const ExportedState& frame);

/// Makes a frame from a checkpoint. Before this call, sources.read_run() must have been called for
/// the checkpoint's run. `every`: as in ToMeasure. Throws like analyse_stored().
ExportedState frame_of(const Checkpoint& checkpoint, const CheckpointRecord& record, const Run& run,
                       const MeasureSources& sources, std::uint64_t every);

}  // namespace shearcell
