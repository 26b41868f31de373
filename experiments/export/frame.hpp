// SPDX-License-Identifier: GPL-3.0-or-later
// One checkpoint for export: every particle with its measures, in SI units.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "experiments/figures/run_table.hpp"
#include "experiments/runner/measure_sources.hpp"
#include "provenance/checkpoint.hpp"

namespace shearcell {

/// A measure of each particle.
struct FrameColumn {
  std::string name;
  std::variant<std::vector<double>, std::vector<std::int32_t>> values;
};

/// A contact of two particles, once, or of a grain with a plane.
struct FrameContact {
  std::size_t grain = 0, other = 0;  ///< numbers of the particles from 1; other 0: a plane
  std::int32_t side = 0;             ///< of a wall contact, as Frame::type; 0 between grains
  double overlap = 0;                ///< [d]
  double force = 0;                  ///< [N]; NaN if the stiffness is unknown
  Eigen::Vector3d normal;            ///< unit vector towards `grain`, the direction of its force
};

/// The grains by id, then the wall grains. Arrays have one entry, or one column, per particle. Wall
/// grains have measures of zero, and classes of -1. They move with the
/// shear (x of a wall point at y: (y - y_top) tan(theta)) and with the moving wall. Velocities of
/// grains and of the moving wall are half a time step before `step`, those of the shear at `step`.
struct Frame {
  std::uint64_t step = 0;
  double time_s = 0;
  double cycle = 0;
  double theta = 0;  ///< tilt [rad]

  /// Facts of the run, texts and numbers: id, experiment, scale, variant and seed; the parameters
  /// that distinguish runs, by their keys in a manifest.
  std::vector<std::pair<std::string, nlohmann::json>> run, parameters;
  std::string checkpoint;  ///< SHA-256 of its file
  /// The measures of the frame by their names in `table`; NaN if unknown.
  std::vector<std::pair<std::string, double>> scalars;

  /// The cell [m]: its lower left corner, and its edges as columns. Only the third is periodic.
  Eigen::Vector3d origin;
  Eigen::Matrix3d edges;

  std::size_t grains = 0;           ///< the first of the particles
  double radius = 0;                ///< of every particle [m]
  double mass = 0;                  ///< of every grain [kg]
  Eigen::Matrix3Xd position;        ///< [m], z within the cell
  Eigen::Matrix3Xd velocity;        ///< [m/s]; of wall grains that of their wall
  std::vector<std::int32_t> image;  ///< periods in z to add for the unwrapped position
  std::vector<std::int32_t> type;   ///< 0 grain; wall grain: 1 left, 2 right, 3 bottom, 4 top
  /// The measures of each grain (analysis/measures.hpp); NaN if unknown.
  std::vector<FrameColumn> columns;
  std::vector<FrameContact> contacts;  ///< by `grain`

  std::size_t particles() const { return type.size(); }
};

/// The frame in a file's name: its cycle; of a packing, which has no cycles, "step45600".
std::string frame_name(const Frame& frame);

/// `sources` has read the run; without it, measures that need earlier checkpoints are NaN. Throws
/// as analyse_stored().
Frame frame_of(const Checkpoint& checkpoint, const CheckpointRecord& record = {},
               const Run& run = {}, const MeasureSources* sources = nullptr);

}  // namespace shearcell
