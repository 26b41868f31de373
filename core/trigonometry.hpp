// SPDX-License-Identifier: GPL-3.0-or-later
// Sine and cosine with the same bits on every machine, which libm does not guarantee.
#pragma once

#include <cstdint>

namespace shearcell {

struct SineCosine {
  double sine;
  double cosine;
};

/// Sine and cosine of `angle` [rad], |angle| <= pi/2, to about one unit in the last place, by
/// Taylor series and explicit fused multiply-adds. Outside that range the result is not a number.
SineCosine sine_cosine(double angle);

/// Sine and cosine of the full turn's fraction step / period. Exact at the quarter turns.
SineCosine turn_sine_cosine(std::uint64_t step, std::uint64_t period);

}  // namespace shearcell
