// SPDX-License-Identifier: GPL-3.0-or-later
// The loops that build and prune the neighbour lists, with one neighbour per vector lane. They
// select the pairs that the kernel tests, and never change a result of the kernel.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd_lists.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "core/aligned.hpp"
#include "core/kernel.hpp"
#include "core/simd_vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace shearcell {
namespace HWY_NAMESPACE {
#if SHEARCELL_HAS_SIMD

using Offsets = hn::Rebind<std::int32_t, D>;
constexpr Offsets kOffsets{};

// Stores the selected lanes of `values` without gaps, and returns the number of selected lanes. A
// whole vector is written; its remaining lanes are undefined. The values are integers, not
// doubles. For doubles, Compress of Highway 1.0 would copy a table of 16 kB in each call.
HWY_INLINE std::size_t store_selected(hn::Vec<Offsets> values, hn::Mask<D> mask,
                                      std::int32_t* HWY_RESTRICT to) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(kD, mask, bits);
  hn::StoreU(hn::Compress(values, hn::LoadMaskBits(kOffsets, bits)), kOffsets, to);
  return hn::CountTrue(kD, mask);
}

// Writes the row offsets of the ids to `outer`, in ascending order of the ids. The rank of an id is
// the number of smaller ids. Nearly every list fits in two vectors. Each id is compared with two
// vectors of ids even if the list is shorter, because a branch on the length would be mispredicted.
// `ids` must have room for two vectors after its last entry.
HWY_INLINE void write_sorted(const SearchTask& t, std::int32_t* HWY_RESTRICT ids, std::size_t count,
                             std::int32_t* HWY_RESTRICT outer) {
  const hn::ScalableTag<std::int32_t> d;
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t v = 0; v < 2; ++v) hn::StoreU(hn::Set(d, INT32_MAX), d, ids + count + v * lanes);
  const auto first = hn::LoadU(d, ids);
  const auto second = hn::LoadU(d, ids + lanes);
  for (std::size_t k = 0; k < count; ++k) {
    const auto key = hn::Set(d, ids[k]);
    std::size_t rank = hn::CountTrue(d, hn::Lt(first, key)) + hn::CountTrue(d, hn::Lt(second, key));
    for (std::size_t v = 2 * lanes; HWY_UNLIKELY(v < count); v += lanes) {
      rank += hn::CountTrue(d, hn::Lt(hn::LoadU(d, ids + v), key));
    }
    outer[rank] = t.offset_of_id[ids[k]];
  }
}

// Square of the cutoff. The cutoff is 1 plus the margins of the two sites.
HWY_INLINE V square_cutoff(V own_margin, V other_margin) {
  const V cutoff = hn::Add(hn::Set(kD, 1.0), hn::Add(own_margin, other_margin));
  return hn::Mul(cutoff, cutoff);
}

// A contiguous copy of the sites in one grid cell and the cells around it. A search for
// neighbours is then one long loop. Nine short loops would cause more branch mispredictions.
class Surroundings {
 public:
  void copy(const CellGrid& grid, std::uint32_t cell) {
    std::array<CellRange, 9> ranges;
    const std::size_t range_count = grid.cells.surrounding(cell, ranges);
    size_ = 0;
    for (const CellRange& cells : std::span(ranges).first(range_count)) {
      const std::size_t begin = grid.begin[cells.begin];
      const std::size_t count = grid.begin[cells.end] - begin;
      make_room(size_ + count + kLanes);
      for (std::size_t k = 0; k < count; k += kLanes) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          copy_vector(kD, grid.position[axis] + begin + k, position_[axis].data() + size_ + k);
        }
        copy_vector(kD, grid.margin + begin + k, margin_.data() + size_ + k);
        copy_vector(kOffsets, grid.id + begin + k, id_.data() + size_ + k);
      }
      size_ += count;
    }
  }

  // Writes the ids of all sites near a given site to `found`. Returns the number of these ids.
  std::size_t find_near(const SearchTask& t, std::size_t place,
                        std::int32_t* HWY_RESTRICT found) const {
    const V depth = hn::Set(kD, t.depth);
    const V per_depth = hn::Set(kD, t.per_depth);
    const Vectors own{hn::Set(kD, t.grid.position[0][place]),
                      hn::Set(kD, t.grid.position[1][place]),
                      hn::Set(kD, t.grid.position[2][place])};
    const V own_margin = hn::Set(kD, t.grid.margin[place]);
    // Ids are converted to doubles, which is exact. Comparing the ids then gives a mask of the same
    // type as comparing the distances.
    const V own_id = hn::Set(kD, static_cast<double>(t.grid.id[place]));
    std::size_t count = 0;
    for (std::size_t k = 0; k < size_; k += kLanes) {
      const Vectors other{hn::LoadU(kD, position_[0].data() + k),
                          hn::LoadU(kD, position_[1].data() + k),
                          hn::LoadU(kD, position_[2].data() + k)};
      const Vectors dr = separation(own, other, depth, per_depth);
      const V square = hn::MulAdd(dr.x, dr.x, hn::MulAdd(dr.y, dr.y, hn::Mul(dr.z, dr.z)));
      const V cutoff = square_cutoff(own_margin, hn::LoadU(kD, margin_.data() + k));
      const auto ids = hn::LoadU(kOffsets, id_.data() + k);
      const auto near =
          hn::And(hn::And(hn::Lt(square, cutoff), hn::Ne(hn::PromoteTo(kD, ids), own_id)),
                  hn::FirstN(kD, size_ - k));
      count = std::min(count + store_selected(ids, near, found + count), kMostNeighbours);
    }
    return count;
  }

 private:
  template <class Tag, class T>
  static HWY_INLINE void copy_vector(Tag tag, const T* from, T* to) {
    hn::StoreU(hn::LoadU(tag, from), tag, to);
  }

  void make_room(std::size_t sites) {
    if (id_.size() >= sites) return;
    for (auto& axis : position_) axis.resize(2 * sites);
    margin_.resize(2 * sites);
    id_.resize(2 * sites);
  }

  std::size_t size_ = 0;
  std::array<AlignedVector<double>, 3> position_;
  AlignedVector<double> margin_;
  AlignedVector<std::int32_t> id_;
};

std::size_t search(const SearchTask& t, std::size_t first, std::size_t last) {
  std::int32_t found[kMostNeighbours + 64];
  Surroundings around;
  std::size_t most = 0;
  std::uint32_t cell = UINT32_MAX;
  for (std::size_t place = first; place < last; ++place) {
    const std::int32_t id = t.grid.id[place];
    if (id < t.first_grain) continue;
    if (t.grid.cell[place] != cell) {
      cell = t.grid.cell[place];
      around.copy(t.grid, cell);
    }
    std::size_t count = around.find_near(t, place, found);
    most = std::max(most, count);
    count = std::min(count, t.stride);
    const std::size_t grain = static_cast<std::size_t>(t.offset_of_id[id]) / 4;
    std::int32_t* HWY_RESTRICT outer = t.outer + grain * t.stride;
    write_sorted(t, found, count, outer);
    for (std::size_t k = count; k % 8 != 0; ++k) outer[k] = t.padding;
    t.count[grain] = static_cast<std::uint16_t>(count);
  }
  return most;
}

// Copies the near neighbours of grain g from its outer list to `kept`. Returns the new list length.
HWY_INLINE std::size_t prune_row(const PruneTask& t, std::size_t g,
                                 std::int32_t* HWY_RESTRICT kept) {
  const V depth = hn::Set(kD, t.depth);
  const V per_depth = hn::Set(kD, t.per_depth);
  const double* own_row = t.rows + 4 * g;
  const Vectors own{hn::Set(kD, own_row[0]), hn::Set(kD, own_row[1]), hn::Set(kD, own_row[2])};
  const V own_margin = hn::Set(kD, own_row[3]);
  const std::int32_t* HWY_RESTRICT outer = t.outer + g * t.outer_stride;
  std::size_t count = 0;
  auto seam = hn::FirstN(kD, 0);
  for (std::size_t k = 0; k < t.outer_count[g]; k += kLanes) {
    V margin;
    const Vectors other = load_rows(
        t.rows, [&](std::size_t lane) HWY_ATTR { return std::ptrdiff_t{outer[k + lane]}; }, margin);
    const V dz = hn::Sub(own.z, other.z);
    const V image = hn::Round(hn::Mul(dz, per_depth));
    const V z = hn::NegMulAdd(image, depth, dz);
    const V x = hn::Sub(own.x, other.x);
    const V y = hn::Sub(own.y, other.y);
    const V square = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
    const auto near = hn::Lt(square, square_cutoff(own_margin, margin));
    seam = hn::Or(seam, hn::And(near, hn::Ne(image, hn::Zero(kD))));
    count += store_selected(hn::LoadU(kOffsets, outer + k), near, kept + count);
  }
  if (!hn::AllFalse(kD, seam)) t.grain_near[g] |= kNearSeam;
  return count;
}

// Number of grains of the moving wall in a list. They are the first entries of the list.
HWY_INLINE std::size_t count_moving_wall(const PruneTask& t, const std::int32_t* kept,
                                         std::size_t count) {
  std::size_t wall = 0;
  while (wall < count && kept[wall] >= t.first_wall && kept[wall] < t.moving_end) ++wall;
  return wall;
}

// For each grain of a block, sets the flags of the wall planes that are near this grain.
HWY_INLINE void find_planes(const PruneTask& t, std::size_t block) {
  V margin;
  const Vectors own = load_rows(
      t.rows, [&](std::size_t lane) HWY_ATTR { return 4 * (block * kLanes + lane); }, margin);
  const V reach = hn::Add(hn::Set(kD, 0.5), hn::Add(margin, hn::Set(kD, t.wall_margin)));
  auto other = hn::FirstN(kD, 0);
  for (std::size_t w = 1; w < 4; ++w) {
    other = hn::Or(other, hn::Lt(distance_to(t.planes[w], own), reach));
  }
  std::uint8_t moving_bits[8] = {};
  std::uint8_t other_bits[8] = {};
  hn::StoreMaskBits(kD, hn::Lt(distance_to(t.planes[0], own), reach), moving_bits);
  hn::StoreMaskBits(kD, other, other_bits);
  for (std::size_t l = 0; l < kLanes; ++l) {
    const int near =
        (moving_bits[0] >> l & 1) * kNearMovingWall + (other_bits[0] >> l & 1) * kNearOtherWall;
    t.grain_near[block * kLanes + l] = static_cast<std::uint8_t>(near);
  }
}

// Neighbours of one block that remain after pruning, with one list per lane.
struct Kept {
  // write_block pads the list of lane l to at least wall[l] + other_slots entries.
  std::int32_t rows[kLanes][2 * kMostNeighbours + 64];
  std::size_t count[kLanes], wall[kLanes];
  std::size_t other_slots, wall_slots;  // numbers of slots needed: maximum over the lanes
};

HWY_INLINE void prune_block(const PruneTask& t, std::size_t block, Kept& kept) {
  find_planes(t, block);
  kept.other_slots = kept.wall_slots = 0;
  std::uint8_t near = 0;
  for (std::size_t l = 0; l < kLanes; ++l) {
    const std::size_t g = block * kLanes + l;
    if (g >= t.grains) t.grain_near[g] = 0;
    const std::size_t count = g < t.grains ? prune_row(t, g, kept.rows[l]) : 0;
    const std::size_t wall = count_moving_wall(t, kept.rows[l], count);
    if (wall > 0) t.grain_near[g] |= kNearMovingWall;
    near |= t.grain_near[g];
    kept.count[l] = count;
    kept.wall[l] = wall;
    kept.other_slots = std::max(kept.other_slots, count - wall);
    kept.wall_slots = std::max(kept.wall_slots, wall);
    t.inner_count[g] = static_cast<std::uint16_t>(count);
  }
  t.near[block] = near;
  t.moving_wall_slots[block] = static_cast<std::uint16_t>(kept.wall_slots);
  t.other_slots[block] = static_cast<std::uint16_t>(kept.other_slots);
}

// Interleaves the lists of the lanes: first the moving wall's grains, then the other neighbours.
HWY_INLINE void write_block(const PruneTask& t, Kept& kept, std::int32_t* HWY_RESTRICT to) {
  for (std::size_t l = 0; kept.wall_slots > 0 && l < kLanes; ++l) {
    for (std::size_t k = 0; k < kept.wall_slots; ++k) {
      to[k * kLanes + l] = k < kept.wall[l] ? kept.rows[l][k] : t.padding;
    }
  }
  to += kept.wall_slots * kLanes;
  const auto padding = hn::Set(kOffsets, t.padding);
  const std::int32_t* from[kLanes];
  for (std::size_t l = 0; l < kLanes; ++l) {
    std::size_t k = kept.count[l];
    do {  // one pass is nearly always enough
      hn::StoreU(padding, kOffsets, kept.rows[l] + k);
      k += kLanes;
    } while (k < kept.wall[l] + kept.other_slots);
    from[l] = kept.rows[l] + kept.wall[l];
  }
  for (std::size_t k = 0; k < kept.other_slots; ++k) {
    for (std::size_t l = 0; l < kLanes; ++l) to[k * kLanes + l] = from[l][k];
  }
}

bool prune(const PruneTask& t, std::size_t first, std::size_t last) {
  Kept kept;
  std::size_t begin = first * t.inner_stride * kLanes;
  for (std::size_t block = first; block < last; ++block) {
    prune_block(t, block, kept);
    if (kept.wall_slots + kept.other_slots > t.inner_stride) return false;
    t.begin[block] = static_cast<std::uint32_t>(begin);
    write_block(t, kept, t.inner + begin);
    begin += (kept.wall_slots + kept.other_slots) * kLanes;
  }
  return true;
}

#endif  // SHEARCELL_HAS_SIMD
}  // namespace HWY_NAMESPACE
}  // namespace shearcell
HWY_AFTER_NAMESPACE();
