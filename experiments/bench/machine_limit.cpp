// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/speed.hpp"

#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "experiments/bench/machine_limit.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

#include "provenance/io/clock.hpp"

HWY_BEFORE_NAMESPACE();
namespace shearcell::bench {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Fused multiply-adds (FMA) per second, measured with twelve independent chains. Two FMA units with
// a latency of five cycles need ten chains. Twelve chains and `half` fit in 16 registers.
template <class D>
double fused_per_second(D d) {
  constexpr std::size_t kRounds = 150'000, kChains = 12;
  using V = hn::Vec<D>;
  const V half = hn::Set(d, 0.5);
  V chains[kChains];
  double start = 0.1;  // chains with equal first values would be merged by the compiler
  for (V& v : chains) v = hn::Set(d, start += 0.1);
  const Stopwatch watch;
  for (std::size_t k = 0; k < kRounds; ++k) {
    for (V& v : chains) v = hn::MulAdd(v, half, half);
  }
  const double seconds = watch.seconds();
  V sum = hn::Zero(d);
  for (const V& v : chains) sum = hn::Add(sum, v);
  volatile double used = hn::GetLane(sum);
  static_cast<void>(used);
  return static_cast<double>(kRounds * kChains) / seconds;
}

double peak(bool vectors) {
  return vectors ? fused_per_second(hn::ScalableTag<double>())
                 : fused_per_second(hn::CappedTag<double, 1>());
}

}  // namespace HWY_NAMESPACE
}  // namespace shearcell::bench
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shearcell::bench {

double multiplications(std::size_t lanes, double slots) {
  // Operations per slot: distance 3, series 7, sums 3; per block: velocity 6, position 3, margin 5.
  return (13 * slots + 14) / static_cast<double>(lanes);
}

double peak_multiplications(std::size_t lanes) {
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
  for (int repeat = 0; repeat < 9; ++repeat) best = std::max(best, measure());
  return best;
}

}  // namespace shearcell::bench
#endif  // HWY_ONCE
