// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/machine_limit.hpp"

#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "experiments/bench/machine_limit.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <limits>

#include "core/aligned.hpp"
#include "core/kernel.hpp"
#include "provenance/io/clock.hpp"

HWY_BEFORE_NAMESPACE();
namespace shearcell::bench {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// One shuffle of vectors; scalars have none.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V shuffle([[maybe_unused]] D d, V a, V b) {
#if HWY_TARGET != HWY_SCALAR
  if constexpr (hn::MaxLanes(D()) > 1) return hn::InterleaveLower(d, a, b);
#endif
  return hn::Max(a, b);
}

// 18 operations per round, of which only those of the same accumulator wait for each other. With
// the constant they fit in 16 registers.
template <class D>
double operations_per_second(D d) {
  constexpr std::size_t kRounds = 100'000, kOperations = 18;
  using V = hn::Vec<D>;
  const V half = hn::Set(d, 0.5);
  // Different values, or the compiler would compute one for all.
  V f0 = hn::Set(d, 0.1), f1 = hn::Set(d, 0.2), f2 = hn::Set(d, 0.3), f3 = hn::Set(d, 0.4);
  V f4 = hn::Set(d, 0.6), f5 = hn::Set(d, 0.7), f6 = hn::Set(d, 0.8), f7 = hn::Set(d, 0.9);
  V a0 = f0, a1 = f1, a2 = f2, a3 = f3;
  V s0 = hn::Set(d, 1.0), s1 = hn::Set(d, 2.0), s2 = hn::Set(d, 3.0);
  const Stopwatch watch;
  for (std::size_t k = 0; k < kRounds; ++k) {
    f0 = hn::MulAdd(f0, half, half), f1 = hn::MulAdd(f1, half, half);
    f2 = hn::MulAdd(f2, half, half), f3 = hn::MulAdd(f3, half, half);
    f4 = hn::MulAdd(f4, half, half), f5 = hn::MulAdd(f5, half, half);
    f6 = hn::MulAdd(f6, half, half), f7 = hn::MulAdd(f7, half, half);
    a0 = hn::Add(a0, half), a1 = hn::Add(a1, half);
    a2 = hn::Add(a2, half), a3 = hn::Add(a3, half);
    s0 = shuffle(d, s0, s1), s1 = shuffle(d, s1, s2), s2 = shuffle(d, s2, s0);
    s0 = shuffle(d, s1, s0), s1 = shuffle(d, s2, s1), s2 = shuffle(d, s0, s2);
  }
  const double seconds = watch.seconds();
  f0 =
      hn::Add(hn::Add(hn::Add(f0, f1), hn::Add(f2, f3)), hn::Add(hn::Add(f4, f5), hn::Add(f6, f7)));
  a0 = hn::Add(hn::Add(a0, a1), hn::Add(a2, a3));
  volatile double used = hn::GetLane(hn::Add(hn::Add(f0, a0), hn::Add(hn::Add(s0, s1), s2)));
  static_cast<void>(used);
  return static_cast<double>(kRounds * kOperations) / seconds;
}

double peak(bool vectors) {
  return vectors ? operations_per_second(hn::ScalableTag<double>())
                 : operations_per_second(hn::CappedTag<double, 1>());
}

double read_all(const double* from, std::size_t count) {
  const hn::ScalableTag<double> d;
  const std::size_t lanes = hn::Lanes(d);
  auto a = hn::Zero(d), b = hn::Zero(d), e = hn::Zero(d), f = hn::Zero(d);
  for (std::size_t k = 0; k + 4 * lanes <= count; k += 4 * lanes) {
    a = hn::Add(a, hn::Load(d, from + k));
    b = hn::Add(b, hn::Load(d, from + k + lanes));
    e = hn::Add(e, hn::Load(d, from + k + 2 * lanes));
    f = hn::Add(f, hn::Load(d, from + k + 3 * lanes));
  }
  return hn::GetLane(hn::SumOfLanes(d, hn::Add(hn::Add(a, b), hn::Add(e, f))));
}

}  // namespace HWY_NAMESPACE
}  // namespace shearcell::bench
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shearcell::bench {
namespace {

HWY_EXPORT(read_all);

constexpr std::size_t kRepeats = 9;

// Of the loops in core/simd_kernel.cpp, as a compiler makes them. A slot: moving 4 x lanes
// coordinates into 3 vectors; separation 3; square distance 3; maxima 2; series 7; sums 3. Of the
// grains: the same moves, velocity 7, position 3, rows stored, margins 16, the test of the series.
struct Operations {
  double per_slot, per_block;
};

Operations operations(std::size_t lanes) {
  switch (lanes) {
    case 8:
      return {11 + 18, 12 + 7 + 3 + 8 + 16 + 1};
    case 4:
      return {7 + 18, 8 + 7 + 3 + 8 + 16 + 1};
    case 2:
      return {3 + 18, 3 + 7 + 3 + 4 + 16 + 1};
    default:
      return {3 + 17, 7 + 3 + 16};  // 3 for the nearest image, one maximum
  }
}

}  // namespace

StepWork step_work(std::size_t lanes, double slots) {
  const auto [per_slot, per_block] = operations(lanes);
  const auto grains = static_cast<double>(lanes);
  // Row read and written, velocity read and written, reference position in single precision,
  // neighbour offsets; begin, two numbers of slots and the near bits of the block.
  return {(slots * per_slot + per_block) / grains,
          2 * 32.0 + 2 * 24.0 + 12.0 + 4 * slots + 9.0 / grains};
}

double step_footprint(std::size_t lanes, double slots) {
  return step_work(lanes, slots).bytes - 24.0;  // the velocity is written where it was read
}

double peak_operations(std::size_t lanes) {
  const auto measure = [lanes]() -> double {
#if HWY_TARGETS & HWY_AVX3
    if (lanes == 8) return N_AVX3::peak(true);
#endif
#if HWY_TARGETS & HWY_AVX2
    if (lanes == 4) return N_AVX2::peak(true);
    if ((hwy::SupportedTargets() & HWY_AVX2) != 0) return N_AVX2::peak(false);
#endif
    return HWY_STATIC_DISPATCH(peak)(lanes > 1);
  };
  double best = 0;
  for (std::size_t repeat = 0; repeat < kRepeats; ++repeat) best = std::max(best, measure());
  return best;
}

double read_bandwidth(std::size_t bytes) {
  // At least 16 MB are read in one timing.
  const AlignedVector<double> values(std::max<std::size_t>(bytes / sizeof(double), 64), 1.0);
  const std::size_t passes = 1 + (std::size_t{1} << 24) / (values.size() * sizeof(double));
  double best = 0;
  volatile double used = 0;
  for (std::size_t repeat = 0; repeat < kRepeats; ++repeat) {
    const Stopwatch watch;
    for (std::size_t pass = 0; pass < passes; ++pass) {
      used = HWY_DYNAMIC_DISPATCH(read_all)(values.data(), values.size());
    }
    const double read = static_cast<double>(passes * values.size() * sizeof(double));
    best = std::max(best, read / watch.seconds());
  }
  static_cast<void>(used);
  return best;
}

}  // namespace shearcell::bench
#endif  // HWY_ONCE
