// SPDX-License-Identifier: GPL-3.0-or-later
// The three loops over neighbours that take nearly all of the time, as plain functions over arrays.
//
// Each exists as a scalar text, which is the specification, and as a vector text that must give the
// same bits. Properties that make that possible:
//  1. One grain per lane: a grain's force is summed by its own lane, in this order: the plane and
//     the grains of the moving wall, the other planes, the other walls' grains, its neighbours, all
//     in ascending permanent id. No sum crosses lanes.
//  2. A neighbour that does not touch, and padding, adds +0 to the sum, which changes no bit. So
//     the result does not depend on which non-touching neighbours a list happens to hold.
//  3. A position is a row {x, y, z, margin} of four doubles. Lanes load whole rows and transpose
//     them in registers: no gathers, and nothing is written but a grain's own row.
//
// The rows of one array are: the grains, padded; a place that nothing touches; the wall grains,
// those of the moving wall first. The margin [d] is how far the grain may move in the frame of the
// shear before its list has to be made again.
#pragma once

#include <cstddef>
#include <cstdint>

namespace shearcell {

/// Arrays over grains are padded to a multiple of the widest vector.
constexpr std::size_t padded(std::size_t grains) {
  return (grains + 7) / 8 * 8;
}

/// Offset of the row, just behind the padded grains, of a place that nothing touches.
constexpr std::int32_t padding_offset(std::size_t grains) {
  return static_cast<std::int32_t>(4 * padded(grains));
}

/// Offset of the first wall grain's row.
constexpr std::int32_t wall_offset(std::size_t grains) {
  return padding_offset(grains) + 4;
}

/// A wall plane in the plane of shear: a point and the unit normal into the cell.
struct WallPlane {
  double point[2] = {}, normal[2] = {};
};

/// What a grain, or some grain of a block, is near to; the kernel need not look for the rest. With
/// kNearSeam a neighbour is nearest through the seam in z.
inline constexpr std::uint8_t kNearSeam = 1, kNearMovingWall = 2, kNearOtherWall = 4;
inline constexpr std::uint8_t kNearWall = kNearMovingWall | kNearOtherWall;

/// Neighbours as row offsets (4 * index, in doubles), in blocks of one vector of grains. Grain
/// `lane` of block b has its k-th neighbour, k < head[b] + slots[b], at
/// list[begin[b] + k * lanes + lane]. The first head[b] are grains of the moving wall. Shorter rows
/// are filled up with the offset of a row that touches nothing.
struct NeighbourRows {
  const std::int32_t* list = nullptr;
  const std::uint32_t* begin = nullptr;
  const std::uint16_t* slots = nullptr;
  const std::uint16_t* head = nullptr;
  const std::uint8_t* near = nullptr;  ///< per block
};

/// One time step of the leapfrog for every grain of a range of blocks.
struct StepTask {
  std::size_t grains = 0;
  const double* rows = nullptr;  ///< positions at this step [d], rows of 4
  double* next_rows = nullptr;   ///< positions at the next step
  double* velocity[3] = {};      ///< [d/s], half a step before -> half a step after
  NeighbourRows neighbours;
  WallPlane planes[4];  ///< that of the moving wall first
  double* push =
      nullptr;  ///< per grain of blocks near the moving wall: y of its sum with that wall
  double depth = 0, per_depth = 0;
  double keep = 0;  ///< (1 - b dt / 2m) / (1 + b dt / 2m)
  double kick = 0;  ///< dt k/m / (1 + b dt / 2m)
  double fall = 0;  ///< -dt g / (1 + b dt / 2m)
  double flow = 0;  ///< dt b/m du/dy / (1 + b dt / 2m), for the fluid that follows the walls
  double time_step = 0;
  double top = 0;  ///< height at which that fluid stands still
  /// Where each grain was when the list was made, in the frame that moves with the shear; in single
  /// precision, which only the margins have to know.
  const float* reference[3] = {};
  double origin = 0;      ///< height at which that frame stands still
  double next_shear = 0;  ///< tan(theta) at the next step
  double loss = 0;        ///< what the shear and rounding have taken from every margin [d]
};

/// Sites (grains and wall grains) ordered by the cells of a grid, x fastest, then z, then y.
struct CellGrid {
  std::int32_t columns = 1, layers = 1, rows = 1;  ///< in x, z and y
  const std::uint32_t* begin = nullptr;  ///< first place of each cell, and the number of sites
  const std::uint32_t* cell = nullptr;   ///< cell of the site at each place
  const double* position[3] = {};        ///< of the site at each place [d]
  const double* margin = nullptr;        ///< its margin [d]
  const std::int32_t* id = nullptr;      ///< its permanent id: wall grains before grains
};

/// The outer list: for the grains at a range of places, the sites nearer than 1 and both margins,
/// in ascending id.
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

/// More neighbours than any packing has; a row is cut off there when a cell has collapsed.
inline constexpr std::size_t kMostNeighbours = 1024;

/// The inner list from the outer: neighbours nearer than 1 and both margins now.
struct PruneTask {
  std::size_t grains = 0;
  const double* rows = nullptr;
  const std::int32_t* outer = nullptr;
  std::size_t outer_stride = 0;
  const std::uint16_t* outer_count = nullptr;   ///< per grain
  std::int32_t first_wall = 0, moving_end = 0;  ///< offsets of the moving wall's grains
  WallPlane planes[4];                          ///< that of the moving wall first
  double wall_margin = 0;                       ///< of the planes [d]
  std::int32_t* inner = nullptr;                ///< laid out as NeighbourRows
  std::size_t inner_stride = 0;                 ///< most slots that a block may have
  std::uint32_t* begin = nullptr;               ///< per block, packed within each range
  std::uint16_t* inner_count = nullptr;         ///< per grain and spare lane
  std::uint16_t* slots = nullptr;
  std::uint16_t* head = nullptr;
  std::uint8_t* near = nullptr;        ///< per block
  std::uint8_t* grain_near = nullptr;  ///< per grain and spare lane
  std::int32_t padding = 0;
  double depth = 0, per_depth = 0;
};

/// One implementation of the loops.
struct Kernels {
  const char* name;
  std::size_t lanes;
  /// Indexed [gravity on][fluid moves]. Returns a positive number when a grain has moved farther
  /// from `reference` than its margin less the loss.
  double (*step[2][2])(const StepTask&, std::size_t first_block, std::size_t last_block);
  /// Returns the largest number of neighbours found; rows longer than the stride are cut.
  std::size_t (*search)(const SearchTask&, std::size_t first_place, std::size_t last_place);
  /// Returns false, leaving the inner list unusable, when a row outgrows inner_stride.
  bool (*prune)(const PruneTask&, std::size_t first_block, std::size_t last_block);
};

enum class Simd { best, scalar, avx2, avx512 };

/// The implementation asked for; null where this machine lacks the instructions.
const Kernels* find_kernels(Simd simd);

const Kernels& scalar_kernels();

}  // namespace shearcell
