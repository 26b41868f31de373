// SPDX-License-Identifier: GPL-3.0-or-later
// The loops over neighbours, which take nearly all of the computing time, as functions on arrays.
//
// Each loop has a scalar reference implementation (scalar_kernel.cpp) and a SIMD version
// (simd_kernel.cpp, simd_lists.cpp). Both give the same bits. Three rules make this possible:
//  1. One vector lane sums the force on one grain, in this order: the plane and the grains of the
//     moving wall, the other planes, then the grains of the other walls and the neighbouring grains
//     in ascending permanent id. No sum crosses lanes.
//  2. A neighbour that does not touch adds +0 to the sum. Padding also adds +0. Adding +0 changes
//     no bit, so the result does not depend on which neighbours without contact are in a list.
//  3. A position is a row {x, y, z, margin} of four doubles. Whole rows are loaded and transposed
//     in registers, without gather instructions. A lane writes only the row of its grain.
//
// One array holds the rows in this order: the grains, padded; one padding row, far from all grains;
// the grains of the moving wall; the other wall grains. The margin [d] is the distance that a grain
// may move in the frame of the shear before its neighbour list must be rebuilt.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/cell.hpp"
#include "core/grid.hpp"

namespace shearcell {

/// Rounds a number of grains up to a multiple of 8, the number of lanes of the widest vector. Lanes
/// without a grain are called spare lanes.
constexpr std::size_t padded(std::size_t grains) {
  return (grains + 7) / 8 * 8;
}

/// Offset of the padding row, which stands for a neighbour that is far from all grains. The padding
/// row comes after the rows of all grains and of all spare lanes.
constexpr std::int32_t padding_offset(std::size_t grains) {
  return static_cast<std::int32_t>(4 * padded(grains));
}

/// Offset of the row of the first wall grain.
constexpr std::int32_t wall_offset(std::size_t grains) {
  return padding_offset(grains) + 4;
}

/// Flags of a block of grains. kNearSeam: the nearest image of a neighbour is across the periodic
/// boundary in z. If a flag is not set, the kernel skips the code for the boundary or the
/// wall of that flag.
inline constexpr std::uint8_t kNearSeam = 1, kNearMovingWall = 2, kNearOtherWall = 4;
inline constexpr std::uint8_t kNearWall = kNearMovingWall | kNearOtherWall;

/// Neighbour lists as row offsets (4 * index, in doubles). A block is a group of grains, one for
/// each lane of a vector. A slot holds one neighbour of each grain of a block. Slot k of lane l of
/// block b is list[begin[b] + k * lanes + l], for k < moving_wall_slots[b] + other_slots[b]. The
/// first moving_wall_slots[b] slots hold grains of the moving wall. Empty slots hold
/// padding_offset().
struct NeighbourRows {
  const std::int32_t* list = nullptr;
  const std::uint32_t* begin = nullptr;  ///< one entry per block, as in the arrays below
  const std::uint16_t* other_slots = nullptr;
  const std::uint16_t* moving_wall_slots = nullptr;
  const std::uint8_t* near = nullptr;
};

/// One time step of the leapfrog, followed by a check of the margins. The new velocity is
/// velocity_factor * v + contact_kick * (contact sum) + gravity_step +
/// fluid_step * (y - fluid_rest_height). In the comments on the members, D = 1 + b dt / 2m.
struct StepTask {
  std::size_t grains = 0;
  const double* rows = nullptr;  ///< positions [d], rows of 4
  NeighbourRows neighbours;
  std::array<WallPlane, 4> planes;  ///< planes[0] belongs to the moving wall
  /// Output for each grain of a block near the moving wall: y component of the grain's contact sum,
  /// from contacts with this wall only [d].
  double* moving_wall_force_y = nullptr;
  double depth = 0, per_depth = 0;  ///< period in z [d] and its inverse
  /// Position of each grain when the list was built, in the frame that moves with the shear [d].
  /// The rounding error of single precision is included in `margin_loss`.
  const float* reference[3] = {};
  double frame_height = 0;  ///< height at which the frame has no velocity [d]
  double tan_theta = 0;     ///< tan(theta) at the end of the step
  double margin_loss = 0;   ///< part of each margin lost to shear and rounding [d]
  /// Prefetch distance in rows, see CellOrder::ahead(); 0 disables the prefetch.
  std::size_t ahead = 0;
  double* next_rows = nullptr;  ///< output: positions at the next step
  /// Velocities [d/s]. Input: half a step before the time of `rows`. Output: half a step after it.
  double* velocity[3] = {};
  double velocity_factor = 0;    ///< (1 - b dt / 2m) / D
  double contact_kick = 0;       ///< dt k/m / D [1/s]
  double gravity_step = -0.0;    ///< -dt g / D [d/s], added to v_y; the default -0 changes no bit
  double fluid_step = 0;         ///< dt b/m du_x/dy / D [1/s]; 0 in a still fluid
  double fluid_rest_height = 0;  ///< height at which the fluid is at rest [d]
  double time_step = 0;          ///< dt [s]
};

/// Sites (grains and wall grains), sorted by grid cell. Most arrays have one entry per site.
struct CellGrid {
  Grid cells;
  const std::uint32_t* begin = nullptr;  ///< first site of each cell; last entry: number of sites
  const std::uint32_t* cell = nullptr;   ///< grid cell of each site
  const double* position[3] = {};        ///< position of each site [d]
  const double* margin = nullptr;        ///< margin of each site [d]
  const std::int32_t* id = nullptr;      ///< permanent id; wall grains have the smallest ids
};

/// Input of the search for outer lists. The outer list of a grain holds, in ascending id, all sites
/// that are closer than 1 plus the margins of the grain and the site [d].
struct SearchTask {
  CellGrid grid;
  std::int32_t first_grain = 0;  ///< smallest id of a grain; smaller ids belong to wall grains
  const std::int32_t* offset_of_id = nullptr;  ///< row offset of each site, by id
  std::int32_t* outer = nullptr;  ///< output: one list per grain, `stride` entries apart
  std::size_t stride = 0;
  std::uint16_t* count = nullptr;  ///< output: length of each grain's list
  std::int32_t padding = 0;        ///< entry that fills lists up to a multiple of 8
  double depth = 0, per_depth = 0;
};

/// Largest length of a neighbour list. A grain of a valid packing has fewer neighbours. In a
/// collapsed cell, longer lists are truncated.
inline constexpr std::size_t kMostNeighbours = 1024;

/// Input for pruning the outer lists to inner lists. An inner list keeps the neighbours that are
/// now closer than 1 plus the margins of the grain and the neighbour [d].
struct PruneTask {
  std::size_t grains = 0;
  const double* rows = nullptr;
  const std::int32_t* outer = nullptr;
  std::size_t outer_stride = 0;
  const std::uint16_t* outer_count = nullptr;   ///< per grain
  std::int32_t first_wall = 0, moving_end = 0;  ///< range of the moving wall's row offsets
  std::array<WallPlane, 4> planes;              ///< planes[0] belongs to the moving wall
  double wall_margin = 0;                       ///< margin of the wall planes [d]
  std::int32_t* inner = nullptr;                ///< output, laid out as in NeighbourRows
  std::size_t inner_stride = 0;                 ///< largest allowed number of slots in a block
  std::uint32_t* begin = nullptr;               ///< where each block's list begins (NeighbourRows)
  std::uint16_t* inner_count = nullptr;         ///< length of the list of each lane
  std::uint16_t* other_slots = nullptr;         ///< one entry per block, like the next two arrays
  std::uint16_t* moving_wall_slots = nullptr;
  std::uint8_t* near = nullptr;  ///< flags, one entry per block
  /// Like `near`, but with one entry for each grain and one for each spare lane.
  std::uint8_t* grain_near = nullptr;
  std::int32_t padding = 0;
  double depth = 0, per_depth = 0;
};

/// One implementation of the loops. `step` returns a positive number if a grain has moved from its
/// `reference` by more than its margin minus margin_loss.
struct Kernels {
  const char* name;
  std::size_t lanes;
  double (*step)(const StepTask&, std::size_t first_block, std::size_t last_block);
  /// Truncates lists to `stride` entries. Returns the largest list length before the truncation.
  std::size_t (*search)(const SearchTask&, std::size_t first_place, std::size_t last_place);
  /// Returns false if a block needs more than inner_stride slots. The inner lists are then invalid.
  bool (*prune)(const PruneTask&, std::size_t first_block, std::size_t last_block);
};

/// Implementations that this machine can run, from the fastest to the scalar implementation.
std::span<const Kernels* const> kernels_here();

const Kernels& scalar_kernels();

}  // namespace shearcell
