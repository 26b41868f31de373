// SPDX-License-Identifier: GPL-3.0-or-later
// The volume fraction at which crystallization begins, by the two methods of supplement C.
#pragma once

#include <cstdint>

#include "analysis/figure.hpp"
#include "analysis/statistics.hpp"
#include "core/named.hpp"

namespace shearcell {

/// Whether the onset of a run was observed. A run is censored if its onset is before its first
/// checkpoint (`before_start`) or after its last checkpoint (`never`). `unclear`: the onset is
/// between these checkpoints, but the method finds no phi at the onset.
enum class Observed : std::uint8_t { yes, never, before_start, unclear };
template <>
inline constexpr auto kNames<Observed> = names_in_order<Observed>("observed", "never",
                                                                  "before_start", "unclear");

struct RunOnset {
  Observed observed = Observed::never;
  double phi = 0;    ///< at the onset; if `never`, at the last checkpoint
  double cycle = 0;  ///< of the onset, or of the last checkpoint if `never`
};

/// Method 1: the time at which the largest crystallite first has the critical size. phi and cycle
/// are interpolated linearly in the size, between the first checkpoint with at least the critical
/// size and the checkpoint before it. A run that begins with a critical crystallite is
/// `before_start`.
RunOnset onset_by_size(const FrameRun& run);

/// Method 2: the phi at which ln(largest crystallite) rises most steeply with phi. The slope at phi
/// is the slope of the least-squares line through the checkpoints within `slope_window / 2` of phi.
/// A value of phi is used only if at least four checkpoints lie within this distance, and if
/// this value and these checkpoints span a range of phi of at least `slope_window / 2`.
/// A run is `unclear` if no value of phi that is used has a positive slope. At a checkpoint without
/// crystallites, the size of the largest crystallite is taken as 1. A run that is `never` or
/// `before_start` by method 1 is so by method 2, too. [choice]
inline constexpr double slope_window = 0.008;
RunOnset onset_by_slope(const FrameRun& run);

using OnsetMethod = RunOnset (*)(const FrameRun& run);

}  // namespace shearcell
