// SPDX-License-Identifier: GPL-3.0-or-later
// Packings and lattices for the tests of analysis.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>
#include <vector>

#include "analysis/measures.hpp"
#include "core/cell.hpp"

namespace shearcell::test {

struct Packing {
  Cell cell;
  WallPose pose;
  Eigen::Matrix3Xd grains;  ///< 3 x n [d]
};

/// The packing at rest.
Checkpoint checkpoint_of(const Packing& packing);

double volume_of(const Packing& packing);

/// What a provider measures. Without a run, the units of mechanics are 1 in SI units.
Measures measured_by(std::string_view name, MeasureInput input);

/// q6 of every grain, by grain id.
std::vector<double> q6_of(const VoronoiDiagram& diagram);

/// Upright or tilted cell with smooth walls and its bottom plane at y = 0.
Packing empty_cell(double width, double height, double depth, double theta = 0);

/// Adds wall grains to all four walls by random sequential addition.
void roughen(Packing& packing, std::uint64_t seed);

/// Fills the cell with `count` grains at random, then moves them as soft spheres until overlaps are
/// small or `steps` are done: 0 steps leave a random set, 300 a jammed packing at phi about 0.64.
void fill(Packing& packing, int count, int steps, std::uint64_t seed);

/// A jammed packing in a cell of the usual shape.
Packing jammed(int count, bool rough, double theta, std::uint64_t seed);

/// Lattice of touching spheres, a whole number of unit cells in each direction, between smooth
/// walls that no lattice plane touches; periodic in z.
enum class Lattice { simple_cubic, bcc, fcc, hcp };
Packing lattice(Lattice kind, int cells);

/// Moves every grain by up to `amplitude` [d] in each direction.
void jitter(Packing& packing, double amplitude, std::uint64_t seed);

}  // namespace shearcell::test
