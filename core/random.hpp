// SPDX-License-Identifier: GPL-3.0-or-later
// Counter-based random numbers. A value depends only on the key and the counter, so there is no
// generator state to store, share or split.
#pragma once

#include <array>
#include <cstdint>

namespace shearcell {

/// Philox4x32-10 (Salmon, Moraes, Dror, Shaw: "Parallel random numbers: as easy as 1, 2, 3", SC11).
std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter,
                                        std::array<std::uint32_t, 2> key);

/// Two uniform random numbers in [0, 1) with 53 random bits each.
std::array<double, 2> uniform_pair(std::array<std::uint32_t, 4> counter, std::uint64_t seed);

/// A nearly normal random number with mean 0 and variance 1: the sum of twelve uniform numbers
/// minus 6. It has the same bits on every machine, because no logarithm or cosine is needed. The
/// last component of `counter` is replaced by 0, 1, ..., 5 to draw six pairs of uniform numbers.
double normal_number(std::array<std::uint32_t, 4> counter, std::uint64_t seed);

}  // namespace shearcell
