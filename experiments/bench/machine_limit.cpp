// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/speed.hpp"

#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "experiments/bench/machine_limit.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cstring>
#include <vector>

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
  V fused[8], added[4], shuffled[3];
  double start = 0.1;  // different values, or the compiler would compute one for all
  const auto set = [&](V& v) HWY_ATTR { v = hn::Set(d, start += 0.1); };
  for (V& v : fused) set(v);
  for (V& v : added) set(v);
  for (V& v : shuffled) set(v);
  const Stopwatch watch;
  for (std::size_t k = 0; k < kRounds; ++k) {
    for (V& v : fused) v = hn::MulAdd(v, half, half);
    for (V& v : added) v = hn::Add(v, half);
    auto& [s0, s1, s2] = shuffled;
    s0 = shuffle(d, s0, s1), s1 = shuffle(d, s1, s2), s2 = shuffle(d, s2, s0);
    s0 = shuffle(d, s1, s0), s1 = shuffle(d, s2, s1), s2 = shuffle(d, s0, s2);
  }
  const double seconds = watch.seconds();
  V sum = hn::Zero(d);
  for (const V& v : fused) sum = hn::Add(sum, v);
  for (const V& v : added) sum = hn::Add(sum, v);
  for (const V& v : shuffled) sum = hn::Add(sum, v);
  volatile double used = hn::GetLane(sum);
  static_cast<void>(used);
  return static_cast<double>(kRounds * kOperations) / seconds;
}

double peak(bool vectors) {
  return vectors ? operations_per_second(hn::ScalableTag<double>())
                 : operations_per_second(hn::CappedTag<double, 1>());
}

}  // namespace HWY_NAMESPACE
}  // namespace shearcell::bench
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shearcell::bench {
namespace {

constexpr std::size_t kRepeats = 9;

}  // namespace

// Of the loops in core/simd_kernel.cpp, as a compiler makes them. A slot: moving 4 x lanes
// coordinates into 3 vectors; separation 3; square distance 3; maxima 2; series 7; sums 3. Of the
// grains: the same moves, velocity 7, position 3, rows stored, margins 16, the test of the series.
StepWork step_work(std::size_t lanes, double slots) {
  double per_slot = 3 + 17, per_block = 7 + 3 + 16;  // 3 for the nearest image, one maximum
  if (lanes == 8) per_slot = 11 + 18, per_block = 12 + 7 + 3 + 8 + 16 + 1;
  if (lanes == 4) per_slot = 7 + 18, per_block = 8 + 7 + 3 + 8 + 16 + 1;
  if (lanes == 2) per_slot = 3 + 18, per_block = 3 + 7 + 3 + 4 + 16 + 1;
  const auto grains = static_cast<double>(lanes);
  // Row read and written, velocity, reference position in single precision, neighbour offsets;
  // begin, two numbers of slots and the near bits of the block.
  const double footprint = 2 * 32.0 + 24.0 + 12.0 + 4 * slots + 9.0 / grains;
  return {(slots * per_slot + per_block) / grains, footprint + 24.0, footprint};
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
  // The C library's memchr reads with the widest vectors of the machine.
  const std::vector<char> zeros(std::max<std::size_t>(bytes, 512));
  const std::size_t passes = 1 + (std::size_t{1} << 24) / zeros.size();  // of at least 16 MB
  double best = 0;
  volatile bool found = false;
  for (std::size_t repeat = 0; repeat < kRepeats; ++repeat) {
    const Stopwatch watch;
    for (std::size_t pass = 0; pass < passes; ++pass) {
      const int sought = 1 + static_cast<int>(pass % 2);  // another call in each pass
      found = std::memchr(zeros.data(), sought, zeros.size()) != nullptr;
    }
    best = std::max(best, static_cast<double>(passes * zeros.size()) / watch.seconds());
  }
  static_cast<void>(found);
  return best;
}

}  // namespace shearcell::bench
#endif  // HWY_ONCE
