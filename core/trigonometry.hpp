// SPDX-License-Identifier: GPL-3.0-or-later
// Sine and cosine with the same bits on every machine, which libm does not guarantee.
#pragma once

#include <cstdint>

namespace shearcell {

struct SineCosine {
  double sine;
  double cosine;
};

/// Sine and cosine of `angle` [rad] for |angle| <= pi/2, from Taylor series with explicit fused
/// multiply-adds. The error is about one unit in the last place. Other angles give NaN.
SineCosine sine_cosine(double angle);

/// Sine and cosine of 2 pi step / period. The result is exact at multiples of a quarter turn.
SineCosine turn_sine_cosine(std::uint64_t step, std::uint64_t period);

}  // namespace shearcell
