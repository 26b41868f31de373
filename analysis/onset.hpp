// SPDX-License-Identifier: GPL-3.0-or-later
// The volume fraction at which crystallization begins, by the two methods of supplement C.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "analysis/figure.hpp"
#include "analysis/statistics.hpp"
#include "core/named.hpp"

namespace shearcell {

/// A run is censored if its onset lies before its first or after its last checkpoint. `unclear`:
/// the onset lies between them, but the method finds no phi.
enum class Observed : std::uint8_t { yes, never, before_start, unclear };
template <>
inline constexpr auto kNames<Observed> = names_in_order<Observed>("observed", "never",
                                                                  "before_start", "unclear");

struct RunOnset {
  Observed observed = Observed::never;
  double phi = 0;    ///< only when observed
  double cycle = 0;  ///< likewise; between checkpoints
};

/// Method 1: the first time that the largest crystallite has the critical size. phi and cycle are
/// interpolated linearly in the size between this checkpoint and the checkpoint before. A run that
/// begins with a critical crystallite is censored at its start.
RunOnset onset_by_size(const FrameRun& run);

/// Method 2: where ln(largest crystallite) against phi is steepest. The slope at phi is the slope
/// of the least-squares line through the checkpoints within `slope_window / 2` of phi. These must
/// be at least four and span half of the window; a run without such a window is unclear. A packing
/// without a crystallite counts as one grain. A run whose largest crystallite never has the
/// critical size is censored. [choice]
inline constexpr double slope_window = 0.008;
RunOnset onset_by_slope(const FrameRun& run);

using OnsetMethod = RunOnset (*)(const FrameRun& run);

}  // namespace shearcell
