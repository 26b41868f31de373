// SPDX-License-Identifier: GPL-3.0-or-later
// The unit of the error bounds that decide whether a corner is computed exactly.
#pragma once

#include <limits>

namespace shearcell {

/// Half the distance from 1 to the next double: the relative error of one rounding.
inline constexpr double unit_roundoff = std::numeric_limits<double>::epsilon() / 2;

}  // namespace shearcell
