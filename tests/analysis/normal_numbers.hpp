// SPDX-License-Identifier: GPL-3.0-or-later
// Normal random numbers, the same on every machine up to rounding.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/random.hpp"

namespace shearcell::testing {

/// Mean 0 and variance 1, by Box and Muller; each `sample` is independent of the others.
inline std::vector<double> normal_numbers(std::uint32_t sample, std::size_t count) {
  std::vector<double> values;
  for (std::uint32_t k = 0; k < count; ++k) {
    const auto [u, v] = uniform_pair({sample, k, 0, 1}, 7);
    values.push_back(std::sqrt(-2 * std::log1p(-u)) * std::cos(2 * std::numbers::pi * v));
  }
  return values;
}

}  // namespace shearcell::testing
