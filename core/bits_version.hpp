// SPDX-License-Identifier: GPL-3.0-or-later
// A version number that changes when any bit of the engine's results changes.
#pragma once

#include <cstdint>

namespace shearcell {

/// Programs with the same version compute the same states, bit for bit, from the same initial
/// state. Raise this number when a change alters any bit, and add a line to tests/core/golden.hpp.
///   1: all programs that write layout 1 of the events RunStarted and RunResumed
///   2: the force loop also sums the wall forces
inline constexpr std::uint64_t bits_version = 2;

}  // namespace shearcell
