// SPDX-License-Identifier: GPL-3.0-or-later
// The loops over neighbours, which take nearly all of the computing time, as functions over arrays.
//
// Each loop has a scalar reference implementation (scalar_kernel.cpp) and a SIMD version
// (simd_kernel.cpp, simd_lists.cpp); both give the same bits. The rules that make this possible:
//  1. One grain per lane: the lane of a grain sums the force on this grain. The order is: plane and
//     grains of the moving wall, the other planes, then the grains of the other walls and the
//     neighbouring grains in ascending permanent id. No sum crosses lanes.
//  2. A neighbour that does not touch, and padding, adds +0 to the sum, which changes no bit.
//     So the result does not depend on which non-touching neighbours a list happens to hold.
//  3. A position is a row {x, y, z, margin} of four doubles. Lanes load whole rows and
//     transpose them in registers: no gathers, and a lane writes only its own grain's row.
//
// One array holds these rows: the grains, padded; one row that touches nothing; the wall grains,
// those of the moving wall first. The margin [d] is how far the grain may move in the frame of the
// shear before its neighbour list must be rebuilt.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/cell.hpp"
#include "core/grid.hpp"

namespace shearcell {

/// Arrays over grains are padded to a multiple of the widest vector.
constexpr std::size_t padded(std::size_t grains) {
  return (grains + 7) / 8 * 8;
}

/// Offset of the row that touches nothing, right behind the padded grains.
constexpr std::int32_t padding_offset(std::size_t grains) {
  return static_cast<std::int32_t>(4 * padded(grains));
}

/// Offset of the first wall grain's row.
constexpr std::int32_t wall_offset(std::size_t grains) {
  return padding_offset(grains) + 4;
}

/// What some grain of a block is near to; the kernel skips everything else. kNearSeam: the nearest
/// image of some neighbour lies across the seam in z.
inline constexpr std::uint8_t kNearSeam = 1, kNearMovingWall = 2, kNearOtherWall = 4;
inline constexpr std::uint8_t kNearWall = kNearMovingWall | kNearOtherWall;

/// Neighbours as row offsets (4 * index, in doubles), in blocks of one vector of grains. Grain
/// `lane` of block b has its k-th neighbour, k < moving_wall_slots[b] + other_slots[b], at
/// list[begin[b] + k * lanes + lane]. The first moving_wall_slots[b] are grains of the moving wall.
/// Shorter rows are filled up with padding_offset.
struct NeighbourRows {
  const std::int32_t* list = nullptr;
  const std::uint32_t* begin = nullptr;  ///< per block, like the next three
  const std::uint16_t* other_slots = nullptr;
  const std::uint16_t* moving_wall_slots = nullptr;
  const std::uint8_t* near = nullptr;
};

/// One time step of the leapfrog, and the check of the margins at its end. With
/// D = 1 + b dt / 2m the new velocity is velocity_factor * v + contact_kick * sum + gravity_step +
/// fluid_step * (y - fluid_rest_height).
struct StepTask {
  std::size_t grains = 0;
  const double* rows = nullptr;  ///< positions [d], rows of 4
  NeighbourRows neighbours;
  std::array<WallPlane, 4> planes;  ///< the plane of the moving wall first
  /// Output for each grain of a block near the moving wall: the y component of the sum over its
  /// contacts with this wall [d].
  double* moving_wall_force_y = nullptr;
  double depth = 0, per_depth = 0;  ///< period in z [d] and its inverse
  /// Position of each grain when its list was built, in the frame that moves with the shear.
  /// `margin_loss` includes the rounding to single precision.
  const float* reference[3] = {};
  double frame_height = 0;  ///< height at which that frame does not move [d]
  double tan_theta = 0;     ///< of the tilt at the end of the step
  double margin_loss = 0;   ///< part of every margin used up by the shear and by rounding [d]
  /// The kernel fetches rows this far ahead of a block into the cache (CellOrder::ahead()); 0:
  /// none.
  std::size_t ahead = 0;
  double* next_rows = nullptr;   ///< output: positions at the next step
  double* velocity[3] = {};      ///< [d/s], half a step before `rows` -> half a step after
  double velocity_factor = 0;    ///< (1 - b dt / 2m) / D
  double contact_kick = 0;       ///< dt k/m / D [1/s]
  double gravity_step = -0.0;    ///< -dt g / D [d/s], added to v_y; adding -0 changes no bit
  double fluid_step = 0;         ///< dt b/m du_x/dy / D [1/s]; 0 in a still fluid
  double fluid_rest_height = 0;  ///< height at which that fluid is at rest [d]
  double time_step = 0;          ///< dt [s]
};

/// Sites (grains and wall grains) ordered by the cells of a grid.
struct CellGrid {
  Grid cells;
  const std::uint32_t* begin = nullptr;  ///< first place of each cell, and the number of sites
  const std::uint32_t* cell = nullptr;   ///< cell of the site at each place
  const double* position[3] = {};        ///< of the site at each place [d]
  const double* margin = nullptr;        ///< its margin [d]
  const std::int32_t* id = nullptr;      ///< its permanent id: wall grains before grains
};

/// Finds the outer lists of the grains at a range of places. The outer list of a grain holds the
/// sites nearer than 1 plus both margins, in ascending id.
struct SearchTask {
  CellGrid grid;
  std::int32_t first_grain = 0;                ///< smallest id of a grain; wall grains have no list
  const std::int32_t* offset_of_id = nullptr;  ///< row offset of the site with an id
  std::int32_t* outer = nullptr;               ///< per grain, `stride` apart
  std::size_t stride = 0;
  std::uint16_t* count = nullptr;  ///< per grain
  std::int32_t padding = 0;        ///< fills each row up to a multiple of 8
  double depth = 0, per_depth = 0;
};

/// More neighbours than a grain has in any sound packing. In a collapsed cell, lists are cut off at
/// this length.
inline constexpr std::size_t kMostNeighbours = 1024;

/// Prunes the outer lists to the inner lists: to the neighbours that are nearer than 1 plus both
/// margins now.
struct PruneTask {
  std::size_t grains = 0;
  const double* rows = nullptr;
  const std::int32_t* outer = nullptr;
  std::size_t outer_stride = 0;
  const std::uint16_t* outer_count = nullptr;   ///< per grain
  std::int32_t first_wall = 0, moving_end = 0;  ///< offsets of the moving wall's grains
  std::array<WallPlane, 4> planes;              ///< the plane of the moving wall first
  double wall_margin = 0;                       ///< of the planes [d]
  std::int32_t* inner = nullptr;                ///< laid out as NeighbourRows
  std::size_t inner_stride = 0;                 ///< most slots that a block may have
  std::uint32_t* begin = nullptr;               ///< per block, packed within each range
  std::uint16_t* inner_count = nullptr;         ///< per grain and spare lane
  std::uint16_t* other_slots = nullptr;         ///< per block, like the next two
  std::uint16_t* moving_wall_slots = nullptr;
  std::uint8_t* near = nullptr;
  std::uint8_t* grain_near = nullptr;  ///< per grain and spare lane
  std::int32_t padding = 0;
  double depth = 0, per_depth = 0;
};

/// One implementation of the loops. `step` returns a positive number if some grain is farther from
/// its `reference` than its margin minus margin_loss.
struct Kernels {
  const char* name;
  std::size_t lanes;
  double (*step)(const StepTask&, std::size_t first_block, std::size_t last_block);
  /// Returns the largest number of neighbours found; rows longer than the stride are cut off.
  std::size_t (*search)(const SearchTask&, std::size_t first_place, std::size_t last_place);
  /// Returns false, leaving the inner list unusable, when a row outgrows inner_stride.
  bool (*prune)(const PruneTask&, std::size_t first_block, std::size_t last_block);
};

/// The implementations that run on this machine: the fastest first, the scalar implementation last.
std::span<const Kernels* const> kernels_here();

const Kernels& scalar_kernels();

}  // namespace shearcell
