// SPDX-License-Identifier: GPL-3.0-or-later
// The loops over contacts with one grain per vector lane, for AVX2+FMA and AVX-512 (chosen at run
// time) and for NEON. The operations and their order are the same as in scalar_kernel.cpp.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd_kernel.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <vector>

#include "core/contact.hpp"
#include "core/kernel.hpp"
#include "core/simd_vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace shearcell {
namespace HWY_NAMESPACE {
#if SHEARCELL_HAS_SIMD

// Number of neighbours for which each lane computes the polynomial kContactSeries at the same time.
// Within one polynomial, each operation waits for the previous one. Four neighbours fit in 32
// registers if coefficients are loaded for each use. With 16 registers, one neighbour at a time is
// faster (README.md).
constexpr std::size_t kSlots = HWY_TARGET == HWY_AVX3 ? 4 : 1;

// Computes the function contact_factor for kCount values of s, all <= kSeriesEnd.
template <std::size_t kCount>
HWY_INLINE void series_factors(const V* s, V* factor) {
  const double* coefficient = kContactSeries.data() + kContactSeries.size() - 1;
  if constexpr (kSlots > 1) asm("" : "+r"(coefficient));  // forces a load for each use
  HWY_UNROLL(4)
  for (std::size_t k = 0; k < kCount; ++k) factor[k] = hn::Set(kD, *coefficient);
  for (std::size_t n = kContactSeries.size() - 1; n-- > 0;) {
    const V next = hn::Set(kD, *--coefficient);
    HWY_UNROLL(4)
    for (std::size_t k = 0; k < kCount; ++k) factor[k] = hn::MulAdd(factor[k], s[k], next);
  }
  HWY_UNROLL(4)
  for (std::size_t k = 0; k < kCount; ++k) factor[k] = hn::Mul(s[k], factor[k]);
}

// Returns `series` for s <= kSeriesEnd, and the exact contact_factor(s) for larger s.
HWY_INLINE V exact_beyond(V s, V series) {
  const V one = hn::Set(kD, 1.0);
  const V exact = hn::Sub(hn::Div(one, hn::Sqrt(hn::Sub(one, s))), one);
  return hn::IfThenElse(hn::Gt(s, hn::Set(kD, kSeriesEnd)), exact, series);
}

// For each grain in `own`, the separation from the neighbour in one slot of the grain's list.
template <bool kSeam>
HWY_INLINE Vectors load_slot(const Vectors& own, const double* HWY_RESTRICT rows,
                             const std::int32_t* HWY_RESTRICT list, V depth, V per_depth) {
  V margin;
  const Vectors other = load_rows(
      rows, [&](std::size_t lane) HWY_ATTR { return std::ptrdiff_t{list[lane]}; }, margin);
  return separation<kSeam>(own, other, depth, per_depth);
}

// Adds (1/r - 1) dr of the next kCount neighbours of each lane (0 for a neighbour without contact).
template <std::size_t kCount>
HWY_INLINE void add_slots(Vectors& sum, const V* x, const V* y, const V* z) {
  V s[kCount], factor[kCount];
  V deepest = hn::Zero(kD);
  HWY_UNROLL(4)
  for (std::size_t k = 0; k < kCount; ++k) {
    s[k] = hn::NegMulAdd(y[k], y[k], hn::NegMulAdd(x[k], x[k], hn::Set(kD, 1.0)));
    s[k] = hn::NegMulAdd(z[k], z[k], s[k]);
    s[k] = hn::Max(s[k], hn::Zero(kD));  // the factor is 0 without contact
    deepest = k == 0 ? s[k] : hn::Max(deepest, s[k]);
  }
  series_factors<kCount>(s, factor);
  if (HWY_UNLIKELY(!hn::AllFalse(kD, hn::Gt(deepest, hn::Set(kD, kSeriesEnd))))) {
    HWY_UNROLL(4)
    for (std::size_t k = 0; k < kCount; ++k) factor[k] = exact_beyond(s[k], factor[k]);
  }
  HWY_UNROLL(4)
  for (std::size_t k = 0; k < kCount; ++k) {
    sum.x = hn::MulAdd(factor[k], x[k], sum.x);
    sum.y = hn::MulAdd(factor[k], y[k], sum.y);
    sum.z = hn::MulAdd(factor[k], z[k], sum.z);
  }
}

// Adds (1/r - 1) dr of each touching neighbour to `sum`, in the order of the list. The k-th
// neighbour of lane l is list[k * kLanes + l].
template <bool kSeam>
HWY_INLINE void add_contacts(Vectors& sum, const Vectors& own, const double* HWY_RESTRICT rows,
                             const std::int32_t* HWY_RESTRICT list, std::size_t slots, V depth,
                             V per_depth) {
  if constexpr (kSlots > 1) {
    for (; slots >= kSlots; slots -= kSlots, list += kSlots * kLanes) {
      V x[kSlots], y[kSlots], z[kSlots];
      HWY_UNROLL(4)
      for (std::size_t k = 0; k < kSlots; ++k) {
        const Vectors dr = load_slot<kSeam>(own, rows, list + k * kLanes, depth, per_depth);
        x[k] = dr.x, y[k] = dr.y, z[k] = dr.z;
      }
      add_slots<kSlots>(sum, x, y, z);
    }
  }
  if (slots == 0) return;
  // Each slot is loaded before the previous slot is added to `sum`, so that no addition waits for
  // memory.
  Vectors dr = load_slot<kSeam>(own, rows, list, depth, per_depth);
  for (; slots > 1; --slots) {
    list += kLanes;
    const Vectors next = load_slot<kSeam>(own, rows, list, depth, per_depth);
    add_slots<1>(sum, &dr.x, &dr.y, &dr.z);
    dr = next;
  }
  add_slots<1>(sum, &dr.x, &dr.y, &dr.z);
}

HWY_INLINE void touch_plane(Vectors& sum, const Vectors& own, const WallPlane& plane) {
  const V nx = hn::Set(kD, plane.normal[0]);
  const V ny = hn::Set(kD, plane.normal[1]);
  const V overlap = hn::Max(hn::Sub(hn::Set(kD, 0.5), distance_to(plane, own)), hn::Zero(kD));
  sum.x = hn::MulAdd(overlap, nx, sum.x);
  sum.y = hn::MulAdd(overlap, ny, sum.y);
}

// Returns for each lane the larger of `excess` and the grain's margin_excess (scalar_kernel.cpp).
HWY_INLINE V raise_excess(V excess, const StepTask& t, std::size_t g, const Vectors& at, V margin) {
  const hn::Rebind<float, D> single;
  const auto reference = [&](std::size_t axis) HWY_ATTR {
    return hn::PromoteTo(kD, hn::LoadU(single, t.reference[axis] + g));
  };
  const V ry = reference(1);
  const V x =
      hn::MulAdd(hn::Set(kD, t.tan_theta), hn::Sub(ry, hn::Set(kD, t.frame_height)), reference(0));
  const V wx = hn::Sub(at.x, x);
  const V wy = hn::Sub(at.y, ry);
  const V wz = hn::Sub(at.z, reference(2));
  const V moved = hn::MulAdd(wz, wz, hn::MulAdd(wy, wy, hn::Mul(wx, wx)));
  const V room = hn::Max(hn::Sub(margin, hn::Set(kD, t.margin_loss)), hn::Zero(kD));
  // Spare lanes of the last block hold no grain.
  const auto real = hn::FirstN(kD, t.grains - g);
  return hn::IfThenElse(real, hn::Max(excess, hn::NegMulAdd(room, room, moved)), excess);
}

// For each grain of one block, the sum of the overlap vectors of its contacts [d].
HWY_INLINE Vectors contact_sum(const StepTask& t, std::size_t block, const Vectors& own, V depth,
                               V per_depth) {
  Vectors sum{hn::Zero(kD), hn::Zero(kD), hn::Zero(kD)};
  const std::int32_t* list = t.neighbours.list + t.neighbours.begin[block];
  const std::size_t slots = t.neighbours.other_slots[block];
  const std::uint8_t near = t.neighbours.near[block];
  if (HWY_UNLIKELY((near & kNearWall) != 0)) {
    if ((near & kNearMovingWall) != 0) {
      const std::size_t wall_slots = t.neighbours.moving_wall_slots[block];
      touch_plane(sum, own, t.planes[0]);
      add_contacts<true>(sum, own, t.rows, list, wall_slots, depth, per_depth);
      hn::StoreU(sum.y, kD, t.moving_wall_force_y + block * kLanes);
      list += wall_slots * kLanes;
    }
    if ((near & kNearOtherWall) != 0) {
      for (std::size_t w = 1; w < 4; ++w) touch_plane(sum, own, t.planes[w]);
    }
  }
  if ((near & kNearSeam) != 0) {
    add_contacts<true>(sum, own, t.rows, list, slots, depth, per_depth);
  } else {
    add_contacts<false>(sum, own, t.rows, list, slots, depth, per_depth);
  }
  return sum;
}

// Loads the positions and margins of a block. Prefetches the neighbours in the next row of cells,
// about `ahead` grains further in memory. The other neighbours are already in the cache.
HWY_INLINE Vectors load_block(const StepTask& t, std::size_t g, V& margin) {
  constexpr std::size_t kLine = 64 / sizeof(double);
  for (std::size_t k = 0; t.ahead != 0 && k < 4 * kLanes; k += kLine) {
    hwy::Prefetch(t.rows + 4 * (g + t.ahead) + k);  // a prefetch beyond the last row is harmless
  }
  return load_rows(
      t.rows, [&](std::size_t lane) HWY_ATTR { return 4 * (g + lane); }, margin);
}

// Advances velocities and positions of the block that starts at grain g. Returns raise_excess().
HWY_INLINE V advance_block(V excess, const StepTask& t, std::size_t g, const Vectors& own, V margin,
                           const Vectors& sum) {
  const V factor = hn::Set(kD, t.velocity_factor);
  const V kick = hn::Set(kD, t.contact_kick);
  V vx = hn::MulAdd(kick, sum.x, hn::Mul(factor, hn::LoadU(kD, t.velocity[0] + g)));
  V vy = hn::MulAdd(kick, sum.y, hn::Mul(factor, hn::LoadU(kD, t.velocity[1] + g)));
  const V vz = hn::MulAdd(kick, sum.z, hn::Mul(factor, hn::LoadU(kD, t.velocity[2] + g)));
  if (t.fluid_step != 0) {
    vx =
        hn::MulAdd(hn::Set(kD, t.fluid_step), hn::Sub(own.y, hn::Set(kD, t.fluid_rest_height)), vx);
  }
  vy = hn::Add(vy, hn::Set(kD, t.gravity_step));
  hn::StoreU(vx, kD, t.velocity[0] + g);
  hn::StoreU(vy, kD, t.velocity[1] + g);
  hn::StoreU(vz, kD, t.velocity[2] + g);
  const V dt = hn::Set(kD, t.time_step);
  const Vectors next{hn::MulAdd(dt, vx, own.x), hn::MulAdd(dt, vy, own.y),
                     hn::MulAdd(dt, vz, own.z)};
  store_rows(next, margin, t.next_rows + 4 * g);
  return raise_excess(excess, t, g, next, margin);
}

// Sums the contacts of block n + 1 and then advances block n, whose sum is ready by then.
double step(const StepTask& t, std::size_t first, std::size_t last) {
  if (first == last) return -1;
  const V depth = hn::Set(kD, t.depth);
  const V per_depth = hn::Set(kD, t.per_depth);
  V excess = hn::Set(kD, -1.0);
  V margin;
  Vectors own = load_block(t, first * kLanes, margin);
  Vectors sum = contact_sum(t, first, own, depth, per_depth);
  for (std::size_t block = first + 1; block < last; ++block) {
    V next_margin;
    const Vectors next_own = load_block(t, block * kLanes, next_margin);
    const Vectors next_sum = contact_sum(t, block, next_own, depth, per_depth);
    excess = advance_block(excess, t, (block - 1) * kLanes, own, margin, sum);
    own = next_own, margin = next_margin, sum = next_sum;
  }
  excess = advance_block(excess, t, (last - 1) * kLanes, own, margin, sum);
  return hn::GetLane(hn::MaxOfLanes(kD, excess));
}

// Defined in simd_lists.cpp.
std::size_t search(const SearchTask& task, std::size_t first_place, std::size_t last_place);
bool prune(const PruneTask& task, std::size_t first_block, std::size_t last_block);

const Kernels* kernels() {
  static const Kernels table{HWY_TARGET == HWY_AVX3   ? "AVX-512"
                             : HWY_TARGET == HWY_AVX2 ? "AVX2"
                                                      : "NEON",
                             kLanes, step, search, prune};
  return &table;
}

#endif  // SHEARCELL_HAS_SIMD
}  // namespace HWY_NAMESPACE
}  // namespace shearcell
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shearcell {

std::span<const Kernels* const> kernels_here() {
  static const std::vector<const Kernels*> here = [] {
    std::vector<const Kernels*> found;
#if HWY_TARGETS & HWY_NEON  // every 64-bit ARM has NEON
    found.push_back(N_NEON::kernels());
#endif
#if HWY_TARGETS & HWY_AVX3
    if ((hwy::SupportedTargets() & HWY_AVX3) != 0) found.push_back(N_AVX3::kernels());
#endif
#if HWY_TARGETS & HWY_AVX2
    if ((hwy::SupportedTargets() & HWY_AVX2) != 0) found.push_back(N_AVX2::kernels());
#endif
    found.push_back(&scalar_kernels());
    return found;
  }();
  return here;
}

}  // namespace shearcell
#endif  // HWY_ONCE
