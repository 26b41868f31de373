// SPDX-License-Identifier: GPL-3.0-or-later
// The kernel with one grain per vector lane, compiled for AVX2+FMA and AVX-512 and chosen at run
// time. Every arithmetic operation and its order is that of scalar_kernel.cpp.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/contact.hpp"
#include "core/kernel.hpp"
#include "core/simd_vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace shearcell {
namespace HWY_NAMESPACE {
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

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
    Vectors sum{hn::Zero(kD), hn::Zero(kD), hn::Zero(kD)};
    if (t.walled[block] != 0) {
      sum = {hn::LoadU(kD, t.wall_sum[0] + g), hn::LoadU(kD, t.wall_sum[1] + g),
             hn::LoadU(kD, t.wall_sum[2] + g)};
    }
    const std::int32_t* list = t.neighbours.list + t.neighbours.begin[block];
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

    const hn::Rebind<float, D> single;
    const auto reference = [&](std::size_t axis) HWY_ATTR {
      return hn::PromoteTo(kD, hn::LoadU(single, t.reference[axis] + g));
    };
    const V ry = reference(1);
    const V wx = hn::Sub(next.x, hn::MulAdd(hn::Set(kD, t.next_shear),
                                            hn::Sub(ry, hn::Set(kD, t.next_top)), reference(0)));
    const V wy = hn::Sub(next.y, ry);
    const V wz = hn::Sub(next.z, reference(2));
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
    add_contacts<true>(sum, own, t.wall_rows, t.neighbours.list + t.neighbours.begin[m / kLanes],
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

// simd_lists.cpp
std::size_t search(const SearchTask& task, std::size_t first_place, std::size_t last_place);
bool prune(const PruneTask& task, std::size_t first_block, std::size_t last_block);

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
