// SPDX-License-Identifier: GPL-3.0-or-later
// The four loops over neighbours that take nearly all of the time, as plain functions over arrays.
//
// Each exists as a scalar text, which is the specification, and as a vector text that must give the
// same bits. Properties that make that possible:
//  1. One grain per lane: a grain's force is summed by its own lane, over its neighbours in
//     ascending permanent id. No sum crosses lanes.
//  2. A neighbour that does not touch, and padding, adds +0 to the sum, which changes no bit. So
//     the result does not depend on which non-touching neighbours a list happens to hold.
//  3. A position is a row {x, y, z, 0} of four doubles. Lanes load whole rows and transpose them in
//     registers: no gathers, and nothing is written but a grain's own row.
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

/// Neighbours as row offsets (4 * index, in doubles), in blocks of one vector of grains. Grain
/// `lane` of block b has its k-th neighbour, k < slots[b], at list[begin[b] + k * lanes + lane].
/// Shorter rows are filled up with the offset of a row that touches nothing.
struct NeighbourRows {
  const std::int32_t* list = nullptr;
  const std::uint32_t* begin = nullptr;
  const std::uint16_t* slots = nullptr;
  /// 1 for a block with a pair that is nearest through the seam in z; elsewhere the kernel need not
  /// look for the nearest image. Null: every block may have one.
  const std::uint8_t* seam = nullptr;
};

/// One time step of the leapfrog for every grain of a range of blocks.
struct StepTask {
  std::size_t grains = 0;
  const double* rows = nullptr;          ///< positions at this step [d], rows of 4
  double* next_rows = nullptr;           ///< positions at the next step
  double* velocity[3] = {};              ///< [d/s], half a step before -> half a step after
  const double* wall_sum[3] = {};        ///< sum over wall contacts of overlap times normal [d]
  const std::uint8_t* walled = nullptr;  ///< 0 for a block of which no grain has a wall sum
  NeighbourRows neighbours;
  double depth = 0, per_depth = 0;
  double keep = 0;  ///< (1 - b dt / 2m) / (1 + b dt / 2m)
  double kick = 0;  ///< dt k/m / (1 + b dt / 2m)
  double fall = 0;  ///< -dt g / (1 + b dt / 2m)
  double flow = 0;  ///< dt b/m du/dy / (1 + b dt / 2m), for the fluid that follows the walls
  double time_step = 0;
  double top = 0;  ///< height at which that fluid stands still
  /// Where each grain was when the list was made, in the frame that moves with the shear; in single
  /// precision, which only the margin of the lists has to know.
  const float* reference[3] = {};
  double next_shear = 0, next_top = 0;  ///< tan(theta) and top wall at the next step
};

/// Contacts of the grains near one wall with its plane and its wall grains.
struct WallTask {
  const double* rows = nullptr;
  const std::int32_t* members =
      nullptr;                           ///< row offsets of grains near this wall, padded to blocks
  std::size_t count = 0;                 ///< members without the padding
  const std::uint8_t* first = nullptr;   ///< 1 where no wall before this one has the grain
  const double* wall_rows = nullptr;     ///< wall grains
  NeighbourRows neighbours;              ///< member -> wall grains
  double point[2] = {}, normal[2] = {};  ///< the plane, and its normal into the cell
  double depth = 0, per_depth = 0;
  double* wall_sum[3] = {};  ///< per grain: set by its first wall, added to by the next
  double* push = nullptr;    ///< y component of each member's sum, or null
};

/// Grains ordered by the cells of a grid, x fastest, then z, then y.
struct CellGrid {
  std::int32_t columns = 1, layers = 1, rows = 1;  ///< in x, z and y
  const std::uint32_t* begin = nullptr;  ///< first place of each cell, and the number of grains
  const std::uint32_t* cell = nullptr;   ///< cell of the grain at each place
  const double* position[3] = {};        ///< of the grain at each place [d]
  const std::int32_t* id = nullptr;      ///< its permanent id
};

/// The outer list: neighbours within `cutoff` of the grains at a range of places, ascending id.
struct SearchTask {
  CellGrid grid;
  const std::int32_t* offset_of_id = nullptr;  ///< row offset of the grain with an id
  std::int32_t* outer = nullptr;               ///< per grain, `stride` apart
  std::size_t stride = 0;
  std::uint16_t* count = nullptr;  ///< per grain
  std::int32_t padding = 0;        ///< fills each row up to a multiple of 8
  double depth = 0, per_depth = 0;
  double cutoff_squared = 0;
};

/// More neighbours than any packing has; a row is cut off there when a cell has collapsed.
inline constexpr std::size_t kMostNeighbours = 1024;

/// The inner list from the outer: neighbours within `cutoff` now.
struct PruneTask {
  std::size_t grains = 0;
  const double* rows = nullptr;
  const std::int32_t* outer = nullptr;
  std::size_t outer_stride = 0;
  const std::uint16_t* outer_count = nullptr;  ///< per grain
  std::int32_t* inner = nullptr;               ///< laid out as NeighbourRows
  std::size_t inner_stride = 0;                ///< most slots that a block may have
  std::uint32_t* begin = nullptr;              ///< per block, packed within each range
  std::uint16_t* inner_count = nullptr;        ///< per grain and spare lane
  std::uint16_t* slots = nullptr;
  std::uint8_t* seam = nullptr;
  std::int32_t padding = 0;
  double depth = 0, per_depth = 0;
  double cutoff_squared = 0;
};

/// One implementation of the loops.
struct Kernels {
  const char* name;
  std::size_t lanes;
  /// Indexed [gravity on][fluid moves]. Returns the largest squared displacement from `reference`.
  double (*step[2][2])(const StepTask&, std::size_t first_block, std::size_t last_block);
  void (*walls)(const WallTask&);
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
