// SPDX-License-Identifier: GPL-3.0-or-later
// The kernel with one grain per vector lane, compiled for AVX2+FMA and AVX-512 and chosen at run
// time. Every arithmetic operation and its order is that of scalar_kernel.cpp.

// Targets without a fused multiply-add would give other bits: they take the scalar kernel.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>

#include "core/cell_grid.hpp"
#include "core/contact.hpp"
#include "core/kernel.hpp"

HWY_BEFORE_NAMESPACE();
namespace shearcell {
namespace HWY_NAMESPACE {
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;
constexpr D kD{};
constexpr hn::Half<D> kHalf{};
constexpr std::size_t kLanes = hn::MaxLanes(kD);

struct Vectors {
  V x, y, z;
};

// Rows {x, y, z, 0} of kLanes grains, transposed. `a` .. `d` hold rows 0 .. 3, and in their upper
// halves, where there are any, rows 4 .. 7.
HWY_INLINE Vectors transpose(V a, V b, V c, V d) {
  const V x_z_low = hn::InterleaveLower(kD, a, b);
  const V x_z_high = hn::InterleaveLower(kD, c, d);
  const V y_low = hn::InterleaveUpper(kD, a, b);
  const V y_high = hn::InterleaveUpper(kD, c, d);
  return {hn::OddEvenBlocks(hn::SwapAdjacentBlocks(x_z_high), x_z_low),
          hn::OddEvenBlocks(hn::SwapAdjacentBlocks(y_high), y_low),
          hn::OddEvenBlocks(x_z_high, hn::SwapAdjacentBlocks(x_z_low))};
}

// Loads kLanes rows; lane l takes the row at rows + offset(l).
template <class Offset>
HWY_INLINE Vectors load_rows(const double* HWY_RESTRICT rows, Offset&& offset) {
#if HWY_TARGET == HWY_AVX3
  const auto row = [&](std::size_t lane) HWY_ATTR { return hn::LoadU(kHalf, rows + offset(lane)); };
  return transpose(hn::Combine(kD, row(4), row(0)), hn::Combine(kD, row(5), row(1)),
                   hn::Combine(kD, row(6), row(2)), hn::Combine(kD, row(7), row(3)));
#else
  return transpose(hn::LoadU(kD, rows + offset(0)), hn::LoadU(kD, rows + offset(1)),
                   hn::LoadU(kD, rows + offset(2)), hn::LoadU(kD, rows + offset(3)));
#endif
}

// Stores x, y, z as kLanes consecutive rows.
HWY_INLINE void store_rows(const Vectors& v, double* HWY_RESTRICT rows) {
  const V zero = hn::Zero(kD);
  const V xy_even = hn::InterleaveLower(kD, v.x, v.y);  // lanes 0, 2 (, 4, 6)
  const V xy_odd = hn::InterleaveUpper(kD, v.x, v.y);
  const V z_even = hn::InterleaveLower(kD, v.z, zero);
  const V z_odd = hn::InterleaveUpper(kD, v.z, zero);
  // Rows of the even and odd 128-bit blocks: {x y} of one block beside {z 0} of the same block.
  const V row0 = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(z_even), xy_even);
  const V row1 = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(z_odd), xy_odd);
  const V row2 = hn::OddEvenBlocks(z_even, hn::SwapAdjacentBlocks(xy_even));
  const V row3 = hn::OddEvenBlocks(z_odd, hn::SwapAdjacentBlocks(xy_odd));
#if HWY_TARGET == HWY_AVX3
  hn::StoreU(hn::LowerHalf(row0), kHalf, rows);
  hn::StoreU(hn::LowerHalf(row1), kHalf, rows + 4);
  hn::StoreU(hn::LowerHalf(row2), kHalf, rows + 8);
  hn::StoreU(hn::LowerHalf(row3), kHalf, rows + 12);
  hn::StoreU(hn::UpperHalf(kHalf, row0), kHalf, rows + 16);
  hn::StoreU(hn::UpperHalf(kHalf, row1), kHalf, rows + 20);
  hn::StoreU(hn::UpperHalf(kHalf, row2), kHalf, rows + 24);
  hn::StoreU(hn::UpperHalf(kHalf, row3), kHalf, rows + 28);
#else
  hn::StoreU(row0, kD, rows);
  hn::StoreU(row1, kD, rows + 4);
  hn::StoreU(row2, kD, rows + 8);
  hn::StoreU(row3, kD, rows + 12);
#endif
}

// contact_factor(s) for s >= 0; kDeep: for s beyond the series too.
template <bool kDeep>
HWY_INLINE V contact_factors(V s) {
  const auto& c = kContactSeries;
  const V s2 = hn::Mul(s, s);
  V odd = hn::Set(kD, c[7]);
  V even = hn::Set(kD, c[6]);
  odd = hn::MulAdd(odd, s2, hn::Set(kD, c[5]));
  even = hn::MulAdd(even, s2, hn::Set(kD, c[4]));
  odd = hn::MulAdd(odd, s2, hn::Set(kD, c[3]));
  even = hn::MulAdd(even, s2, hn::Set(kD, c[2]));
  odd = hn::MulAdd(odd, s2, hn::Set(kD, c[1]));
  even = hn::MulAdd(even, s2, hn::Set(kD, c[0]));
  const V series = hn::Mul(s, hn::MulAdd(odd, s, even));
  if constexpr (!kDeep) return series;
  const V one = hn::Set(kD, 1.0);
  const V exact = hn::Sub(hn::Div(one, hn::Sqrt(hn::Sub(one, s))), one);
  return hn::IfThenElse(hn::Gt(s, hn::Set(kD, kSeriesEnd)), exact, series);
}

template <bool kSeam = true>
HWY_INLINE Vectors separation(const Vectors& own, const Vectors& other, V depth, V per_depth) {
  V dz = hn::Sub(own.z, other.z);
  // Without a seam the nearest image is this one, and subtracting 0 * depth would change no bit.
  if constexpr (kSeam) dz = hn::NegMulAdd(hn::Round(hn::Mul(dz, per_depth)), depth, dz);
  return {hn::Sub(own.x, other.x), hn::Sub(own.y, other.y), dz};
}

// Adds (1/r - 1) dr over the touching neighbours; lane l has its k-th at list[k * kLanes + l].
// Returns the largest s.
template <bool kSeam, bool kDeep>
HWY_INLINE V sum_contacts(Vectors& sum, const Vectors& own, const double* HWY_RESTRICT rows,
                          const std::int32_t* HWY_RESTRICT list, std::size_t slots, V depth,
                          V per_depth) {
  V deepest = hn::Zero(kD);
  for (const std::int32_t* const end = list + slots * kLanes; list != end; list += kLanes) {
    const Vectors other =
        load_rows(rows, [&](std::size_t lane) HWY_ATTR { return std::ptrdiff_t{list[lane]}; });
    const Vectors dr = separation<kSeam>(own, other, depth, per_depth);
    V s = hn::NegMulAdd(dr.z, dr.z,
                        hn::NegMulAdd(dr.y, dr.y, hn::NegMulAdd(dr.x, dr.x, hn::Set(kD, 1.0))));
    s = hn::Max(s, hn::Zero(kD));  // not touching: the factor is 0
    if constexpr (!kDeep) deepest = hn::Max(deepest, s);
    const V factor = contact_factors<kDeep>(s);
    sum.x = hn::MulAdd(factor, dr.x, sum.x);
    sum.y = hn::MulAdd(factor, dr.y, sum.y);
    sum.z = hn::MulAdd(factor, dr.z, sum.z);
  }
  return deepest;
}

// Overlaps beyond the series are rare: a block that has one is summed again, from its beginning.
template <bool kSeam>
HWY_INLINE void add_contacts(Vectors& sum, const Vectors& own, const double* HWY_RESTRICT rows,
                             const std::int32_t* HWY_RESTRICT list, std::size_t slots, V depth,
                             V per_depth) {
  Vectors series = sum;
  const V deepest = sum_contacts<kSeam, false>(series, own, rows, list, slots, depth, per_depth);
  if (HWY_LIKELY(hn::AllFalse(kD, hn::Gt(deepest, hn::Set(kD, kSeriesEnd))))) {
    sum = series;
  } else {
    sum_contacts<kSeam, true>(sum, own, rows, list, slots, depth, per_depth);
  }
}

template <bool kGravity, bool kFlow>
double step(const StepTask& t, std::size_t first, std::size_t last) {
  const V depth = hn::Set(kD, t.depth);
  const V per_depth = hn::Set(kD, t.per_depth);
  V farthest = hn::Zero(kD);
  for (std::size_t block = first; block < last; ++block) {
    const std::size_t g = block * kLanes;
    const auto row_of = [&](std::size_t lane) HWY_ATTR { return 4 * (g + lane); };
    const Vectors own = load_rows(t.rows, row_of);
    Vectors sum{hn::LoadU(kD, t.wall_sum[0] + g), hn::LoadU(kD, t.wall_sum[1] + g),
                hn::LoadU(kD, t.wall_sum[2] + g)};
    const std::int32_t* list = t.neighbours.list + g * t.neighbours.stride;
    const std::size_t slots = t.neighbours.slots[block];
    if (t.neighbours.seam[block] != 0) {
      add_contacts<true>(sum, own, t.rows, list, slots, depth, per_depth);
    } else {
      add_contacts<false>(sum, own, t.rows, list, slots, depth, per_depth);
    }

    const V keep = hn::Set(kD, t.keep);
    const V kick = hn::Set(kD, t.kick);
    V vx = hn::MulAdd(kick, sum.x, hn::Mul(keep, hn::LoadU(kD, t.velocity[0] + g)));
    V vy = hn::MulAdd(kick, sum.y, hn::Mul(keep, hn::LoadU(kD, t.velocity[1] + g)));
    const V vz = hn::MulAdd(kick, sum.z, hn::Mul(keep, hn::LoadU(kD, t.velocity[2] + g)));
    if constexpr (kGravity) vy = hn::Add(vy, hn::Set(kD, t.fall));
    if constexpr (kFlow) {
      vx = hn::MulAdd(hn::Set(kD, t.flow), hn::Sub(own.y, hn::Set(kD, t.top)), vx);
    }
    hn::StoreU(vx, kD, t.velocity[0] + g);
    hn::StoreU(vy, kD, t.velocity[1] + g);
    hn::StoreU(vz, kD, t.velocity[2] + g);
    const V dt = hn::Set(kD, t.time_step);
    const Vectors next{hn::MulAdd(dt, vx, own.x), hn::MulAdd(dt, vy, own.y),
                       hn::MulAdd(dt, vz, own.z)};
    store_rows(next, t.next_rows + 4 * g);

    const V ry = hn::LoadU(kD, t.reference[1] + g);
    const V wx =
        hn::Sub(next.x, hn::MulAdd(hn::Set(kD, t.next_shear), hn::Sub(ry, hn::Set(kD, t.next_top)),
                                   hn::LoadU(kD, t.reference[0] + g)));
    const V wy = hn::Sub(next.y, ry);
    const V wz = hn::Sub(next.z, hn::LoadU(kD, t.reference[2] + g));
    const V square = hn::MulAdd(wz, wz, hn::MulAdd(wy, wy, hn::Mul(wx, wx)));
    // The last block's spare lanes hold no grain.
    const auto real = hn::FirstN(kD, t.grains - g);
    farthest = hn::Max(farthest, hn::IfThenElseZero(real, square));
  }
  return hn::GetLane(hn::MaxOfLanes(kD, farthest));
}

void walls(const WallTask& t) {
  const V depth = hn::Set(kD, t.depth);
  const V per_depth = hn::Set(kD, t.per_depth);
  const V nx = hn::Set(kD, t.normal[0]);
  const V ny = hn::Set(kD, t.normal[1]);
  for (std::size_t m = 0; m < t.count; m += kLanes) {
    const std::int32_t* HWY_RESTRICT members = t.members + m;
    const Vectors own = load_rows(t.rows, [&](std::size_t lane) HWY_ATTR { return members[lane]; });
    const V distance = hn::MulAdd(hn::Sub(own.x, hn::Set(kD, t.point[0])), nx,
                                  hn::Mul(hn::Sub(own.y, hn::Set(kD, t.point[1])), ny));
    const V overlap = hn::Max(hn::Sub(hn::Set(kD, 0.5), distance), hn::Zero(kD));
    Vectors sum{hn::Mul(overlap, nx), hn::Mul(overlap, ny), hn::Zero(kD)};
    add_contacts<true>(sum, own, t.wall_rows, t.neighbours.list + m * t.neighbours.stride,
                       t.neighbours.slots[m / kLanes], depth, per_depth);

    HWY_ALIGN double lanes[3][kLanes];
    hn::Store(sum.x, kD, lanes[0]);
    hn::Store(sum.y, kD, lanes[1]);
    hn::Store(sum.z, kD, lanes[2]);
    for (std::size_t l = 0; l < kLanes && m + l < t.count; ++l) {
      const std::size_t g = static_cast<std::size_t>(members[l]) / 4;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        double& wall_sum = t.wall_sum[axis][g];
        wall_sum = (t.first[m + l] != 0 ? 0.0 : wall_sum) + lanes[axis][l];
      }
      if (t.push != nullptr) t.push[m + l] = lanes[1][l];
    }
  }
}

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
    std::int32_t* HWY_RESTRICT inner = t.inner + block * t.inner_stride * kLanes;
    for (std::size_t k = 0; k < most; ++k) {
      for (std::size_t l = 0; l < kLanes; ++l) inner[k * kLanes + l] = rows[l][k];
    }
    t.slots[block] = static_cast<std::uint16_t>(most);
    t.seam[block] = hn::AllFalse(kD, seam) ? 0 : 1;
  }
  return true;
}

const Kernels* kernels() {
  static const Kernels table{
      HWY_TARGET == HWY_AVX3 ? "AVX-512" : "AVX2",
      kLanes,
      {{step<false, false>, step<false, true>}, {step<true, false>, step<true, true>}},
      walls,
      search,
      prune};
  return &table;
}

#endif  // a target with fused multiply-add
}  // namespace HWY_NAMESPACE
}  // namespace shearcell
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shearcell {

const Kernels* find_kernels(Simd simd) {
  const auto supported = hwy::SupportedTargets();
  (void)supported;
#if HWY_TARGETS & HWY_AVX3
  if ((simd == Simd::best || simd == Simd::avx512) && (supported & HWY_AVX3) != 0) {
    return N_AVX3::kernels();
  }
#endif
#if HWY_TARGETS & HWY_AVX2
  if ((simd == Simd::best || simd == Simd::avx2) && (supported & HWY_AVX2) != 0) {
    return N_AVX2::kernels();
  }
#endif
  return simd == Simd::best || simd == Simd::scalar ? &scalar_kernels() : nullptr;
}

}  // namespace shearcell
#endif  // HWY_ONCE
