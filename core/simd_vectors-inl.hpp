// SPDX-License-Identifier: GPL-3.0-or-later
// Loads and stores rows of positions as vectors, with one grain per lane. Each SIMD file includes
// this file once per instruction set, so it has no ordinary include guard.
#if defined(SHEARCELL_SIMD_VECTORS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SHEARCELL_SIMD_VECTORS_INL
#undef SHEARCELL_SIMD_VECTORS_INL
#else
#define SHEARCELL_SIMD_VECTORS_INL
#endif

#include <hwy/highway.h>

#include <cstddef>

#include "core/kernel.hpp"

HWY_BEFORE_NAMESPACE();
namespace shearcell {
namespace HWY_NAMESPACE {
// Targets without a fused multiply-add would give different bits, so they use the scalar kernel.
// SVE is not used, because a struct cannot hold vectors whose size is unknown at compile time.
#define SHEARCELL_HAS_SIMD \
  (HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_NEON)
#if SHEARCELL_HAS_SIMD

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;
constexpr D kD{};
constexpr hn::Half<D> kHalf{};
constexpr std::size_t kLanes = hn::MaxLanes(kD);

struct Vectors {
  V x, y, z;
};

#if HWY_TARGET != HWY_NEON
// The even (or odd) 128-bit blocks of `low`, followed by the even (or odd) blocks of `high`.
template <bool kOdd>
HWY_INLINE V half_of_blocks(V low, V high) {
#if HWY_TARGET == HWY_AVX3
  return V{_mm512_shuffle_f64x2(low.raw, high.raw, kOdd ? 0xDD : 0x88)};
#else
  return kOdd ? hn::ConcatUpperUpper(kD, high, low) : hn::ConcatLowerLower(kD, high, low);
#endif
}
#endif

// Loads kLanes rows. Lane l gets the row at rows + offset(l).
template <class Offset>
HWY_INLINE Vectors load_rows(const double* HWY_RESTRICT rows, Offset&& offset, V& margin) {
#if HWY_TARGET == HWY_NEON
  const double* const a = rows + offset(0);
  const double* const b = rows + offset(1);
  const V xy_a = hn::LoadU(kD, a), z_a = hn::LoadU(kD, a + 2);
  const V xy_b = hn::LoadU(kD, b), z_b = hn::LoadU(kD, b + 2);
  margin = hn::InterleaveUpper(kD, z_a, z_b);
  return {hn::InterleaveLower(kD, xy_a, xy_b), hn::InterleaveUpper(kD, xy_a, xy_b),
          hn::InterleaveLower(kD, z_a, z_b)};
#else
#if HWY_TARGET == HWY_AVX3
  const auto row = [&](std::size_t lane) HWY_ATTR { return hn::LoadU(kHalf, rows + offset(lane)); };
  const V a = hn::Combine(kD, row(2), row(0)), b = hn::Combine(kD, row(3), row(1));
  const V c = hn::Combine(kD, row(6), row(4)), d = hn::Combine(kD, row(7), row(5));
#else
  const auto row = [&](std::size_t lane) HWY_ATTR { return hn::LoadU(kD, rows + offset(lane)); };
  const V a = row(0), b = row(1), c = row(2), d = row(3);
#endif
  const V x_z_low = hn::InterleaveLower(kD, a, b), x_z_high = hn::InterleaveLower(kD, c, d);
  const V y_m_low = hn::InterleaveUpper(kD, a, b), y_m_high = hn::InterleaveUpper(kD, c, d);
  margin = half_of_blocks<true>(y_m_low, y_m_high);
  return {half_of_blocks<false>(x_z_low, x_z_high), half_of_blocks<false>(y_m_low, y_m_high),
          half_of_blocks<true>(x_z_low, x_z_high)};
#endif
}

// Stores kLanes consecutive rows.
HWY_INLINE void store_rows(const Vectors& v, V margin, double* HWY_RESTRICT rows) {
  const V xy_even = hn::InterleaveLower(kD, v.x, v.y);  // lanes 0 and 2 (AVX-512: also 4 and 6)
  const V xy_odd = hn::InterleaveUpper(kD, v.x, v.y);
  const V z_even = hn::InterleaveLower(kD, v.z, margin);
  const V z_odd = hn::InterleaveUpper(kD, v.z, margin);
#if HWY_TARGET == HWY_NEON
  hn::StoreU(xy_even, kD, rows);
  hn::StoreU(z_even, kD, rows + 2);
  hn::StoreU(xy_odd, kD, rows + 4);
  hn::StoreU(z_odd, kD, rows + 6);
#else
  // Joins {x y} and {z margin} of each grain.
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
#endif
}

template <bool kSeam = true>
HWY_INLINE Vectors separation(const Vectors& own, const Vectors& other, V depth, V per_depth) {
  V dz = hn::Sub(own.z, other.z);
  // Without kSeam, no pair lies across the boundary: the image term would be 0 and change no bit.
  if constexpr (kSeam) dz = hn::NegMulAdd(hn::Round(hn::Mul(dz, per_depth)), depth, dz);
  return {hn::Sub(own.x, other.x), hn::Sub(own.y, other.y), dz};
}

HWY_INLINE V distance_to(const WallPlane& plane, const Vectors& at) {
  return hn::MulAdd(
      hn::Sub(at.x, hn::Set(kD, plane.point[0])), hn::Set(kD, plane.normal[0]),
      hn::Mul(hn::Sub(at.y, hn::Set(kD, plane.point[1])), hn::Set(kD, plane.normal[1])));
}

#endif  // SHEARCELL_HAS_SIMD
}  // namespace HWY_NAMESPACE
}  // namespace shearcell
HWY_AFTER_NAMESPACE();

#endif  // SHEARCELL_SIMD_VECTORS_INL
