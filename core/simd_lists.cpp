// SPDX-License-Identifier: GPL-3.0-or-later
// The neighbour lists' loops with one neighbour per vector lane. They choose what the kernel looks
// at and never what it computes.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd_lists.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/cell_grid.hpp"
#include "core/kernel.hpp"
#include "core/simd_vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace shearcell {
namespace HWY_NAMESPACE {
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

using Offsets = hn::Rebind<std::int32_t, D>;
constexpr Offsets kOffsets{};

// Stores the lanes of `values` whose grains `mask` selects, one after the other, and anything
// behind them up to a whole vector. Returns how many. (Compressing doubles, Highway 1.0 copies a
// table of 16 kB on every call.)
HWY_INLINE std::size_t store_selected(hn::Vec<Offsets> values, hn::Mask<D> mask,
                                      std::int32_t* HWY_RESTRICT to) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(kD, mask, bits);
  hn::StoreU(hn::Compress(values, hn::LoadMaskBits(kOffsets, bits)), kOffsets, to);
  return hn::CountTrue(kD, mask);
}

// Ascending order by rank: how many keys are smaller is counted a vector at a time.
HWY_INLINE void sort_ids(std::int32_t* HWY_RESTRICT ids, std::size_t count) {
  const hn::ScalableTag<std::int32_t> d;
  constexpr std::size_t kMost = 64;
  if (count > kMost) {
    std::sort(ids, ids + count);
    return;
  }
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t k = count; k % lanes != 0; ++k) ids[k] = INT32_MAX;
  std::int32_t sorted[kMost];
  for (std::size_t k = 0; k < count; ++k) {
    const auto key = hn::Set(d, ids[k]);
    std::size_t rank = 0;
    for (std::size_t v = 0; v < count; v += lanes) {
      rank += hn::CountTrue(d, hn::Lt(hn::LoadU(d, ids + v), key));
    }
    sorted[rank] = ids[k];
  }
  std::copy(sorted, sorted + count, ids);
}

std::size_t search(const SearchTask& t, std::size_t first, std::size_t last) {
  const V depth = hn::Set(kD, t.depth);
  const V per_depth = hn::Set(kD, t.per_depth);
  const V cutoff = hn::Set(kD, t.cutoff_squared);
  std::int32_t found[kMostNeighbours + 64];
  std::size_t most = 0;
  for (std::size_t place = first; place < last; ++place) {
    const Vectors own{hn::Set(kD, t.grid.position[0][place]),
                      hn::Set(kD, t.grid.position[1][place]),
                      hn::Set(kD, t.grid.position[2][place])};
    const std::int32_t id = t.grid.id[place];
    const V own_id = hn::Set(kD, static_cast<double>(id));
    std::array<PlaceRun, 9> runs;
    const std::size_t run_count = surrounding_runs(t.grid, place, runs);
    std::size_t count = 0;
    for (std::size_t r = 0; r < run_count; ++r) {
      for (std::size_t p = runs[r].begin; p < runs[r].end; p += kLanes) {
        const Vectors other{hn::LoadU(kD, t.grid.position[0] + p),
                            hn::LoadU(kD, t.grid.position[1] + p),
                            hn::LoadU(kD, t.grid.position[2] + p)};
        const Vectors dr = separation(own, other, depth, per_depth);
        const V square = hn::MulAdd(dr.x, dr.x, hn::MulAdd(dr.y, dr.y, hn::Mul(dr.z, dr.z)));
        const auto ids = hn::LoadU(kOffsets, t.grid.id + p);
        // Compared as doubles, which hold every id exactly and whose mask fits.
        const auto near =
            hn::And(hn::And(hn::Lt(square, cutoff), hn::Ne(hn::PromoteTo(kD, ids), own_id)),
                    hn::FirstN(kD, runs[r].end - p));
        count = std::min(count + store_selected(ids, near, found + count), kMostNeighbours);
      }
    }
    most = std::max(most, count);
    count = std::min(count, t.stride);
    sort_ids(found, count);
    const std::size_t grain = static_cast<std::size_t>(t.offset_of_id[id]) / 4;
    std::int32_t* HWY_RESTRICT outer = t.outer + grain * t.stride;
    for (std::size_t k = 0; k < count; ++k) outer[k] = t.offset_of_id[found[k]];
    for (std::size_t k = count; k % 8 != 0; ++k) outer[k] = t.padding;
    t.count[grain] = static_cast<std::uint16_t>(count);
  }
  return most;
}

// Keeps the near ones of one grain's outer list in `kept`; returns their number.
HWY_INLINE std::size_t prune_row(const PruneTask& t, std::size_t g, std::int32_t* HWY_RESTRICT kept,
                                 hn::Mask<D>& seam) {
  const V depth = hn::Set(kD, t.depth);
  const V per_depth = hn::Set(kD, t.per_depth);
  const V cutoff = hn::Set(kD, t.cutoff_squared);
  const double* own_row = t.rows + 4 * g;
  const Vectors own{hn::Set(kD, own_row[0]), hn::Set(kD, own_row[1]), hn::Set(kD, own_row[2])};
  const std::int32_t* HWY_RESTRICT outer = t.outer + g * t.outer_stride;
  std::size_t count = 0;
  for (std::size_t k = 0; k < t.outer_count[g]; k += kLanes) {
    const Vectors other = load_rows(
        t.rows, [&](std::size_t lane) HWY_ATTR { return std::ptrdiff_t{outer[k + lane]}; });
    const V dz = hn::Sub(own.z, other.z);
    const V image = hn::Round(hn::Mul(dz, per_depth));
    const V z = hn::NegMulAdd(image, depth, dz);
    const V x = hn::Sub(own.x, other.x);
    const V y = hn::Sub(own.y, other.y);
    const V square = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
    const auto near = hn::Lt(square, cutoff);
    seam = hn::Or(seam, hn::And(near, hn::Ne(image, hn::Zero(kD))));
    count += store_selected(hn::LoadU(kOffsets, outer + k), near, kept + count);
  }
  return count;
}

bool prune(const PruneTask& t, std::size_t first, std::size_t last) {
  std::int32_t rows[kLanes][kMostNeighbours + 64];
  const auto padding = hn::Set(kOffsets, t.padding);
  std::size_t begin = first * t.inner_stride * kLanes;
  for (std::size_t block = first; block < last; ++block) {
    std::size_t count[kLanes];
    std::size_t most = 0;
    auto seam = hn::FirstN(kD, 0);
    for (std::size_t l = 0; l < kLanes; ++l) {
      const std::size_t g = block * kLanes + l;
      count[l] = g < t.grains ? prune_row(t, g, rows[l], seam) : 0;
      most = std::max(most, count[l]);
    }
    if (most > t.inner_stride) return false;
    for (std::size_t l = 0; l < kLanes; ++l) {
      t.inner_count[block * kLanes + l] = static_cast<std::uint16_t>(count[l]);
      for (std::size_t k = count[l]; k < most; k += kLanes) {
        hn::StoreU(padding, kOffsets, rows[l] + k);
      }
    }
    std::int32_t* HWY_RESTRICT inner = t.inner + begin;
    t.begin[block] = static_cast<std::uint32_t>(begin);
    begin += most * kLanes;
    for (std::size_t k = 0; k < most; ++k) {
      for (std::size_t l = 0; l < kLanes; ++l) inner[k * kLanes + l] = rows[l][k];
    }
    t.slots[block] = static_cast<std::uint16_t>(most);
    t.seam[block] = hn::AllFalse(kD, seam) ? 0 : 1;
  }
  return true;
}

#endif  // a target with fused multiply-add
}  // namespace HWY_NAMESPACE
}  // namespace shearcell
HWY_AFTER_NAMESPACE();
