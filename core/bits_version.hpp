// SPDX-License-Identifier: GPL-3.0-or-later
// The version of the bits that the engine computes.
#pragma once

#include <cstdint>

namespace shearcell {

/// Two programs with the same version compute the same bits of a state from the same initial state.
/// Raise it with every change of bits, and add a line to the golden states (tests/core/golden.hpp).
///   1: all programs whose events did not record this number (event layouts 1 and 2)
///   2: the force loop also sums the wall forces
inline constexpr std::uint64_t bits_version = 2;

}  // namespace shearcell
