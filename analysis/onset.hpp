// SPDX-License-Identifier: GPL-3.0-or-later
// The volume fraction at which crystallization begins, by the two methods of supplement C.
#pragma once

#include "analysis/figure.hpp"
#include "analysis/statistics.hpp"

namespace shearcell {

/// The onset of a run. It is missing if it is before the first checkpoint (`too_late`), after the
/// last checkpoint (`too_short`), or if the method finds none between them (`undefined`).
struct RunOnset {
  Missing missing = Missing::too_short;
  double phi = 0;    ///< at the onset; if `too_short`, at the last checkpoint
  double cycle = 0;  ///< of the onset, or of the last checkpoint if `too_short`
};

/// Method 1: the time at which the largest crystallite first has the critical size. phi and cycle
/// are interpolated linearly in the size, between the first checkpoint with at least the critical
/// size and the checkpoint before it. If a run begins with a critical crystallite, its onset is
/// `too_late`.
RunOnset onset_by_size(const FrameRun& run);

/// Method 2: the phi at which ln(largest crystallite) rises most steeply with phi. The slope at phi
/// is the slope of the least-squares line through the checkpoints within `slope_window / 2` of phi.
/// A value of phi is used only if at least four checkpoints lie within this distance, and if
/// this value and these checkpoints span a range of phi of at least `slope_window / 2`.
/// The onset is `undefined` if no value of phi that is used has a positive slope. At a checkpoint
/// without crystallites, the size of the largest crystallite is taken as 1. An onset that is
/// `too_short` or `too_late` by method 1 is so by method 2, too. [choice]
inline constexpr double slope_window = 0.008;
RunOnset onset_by_slope(const FrameRun& run);

using OnsetMethod = RunOnset (*)(const FrameRun& run);

}  // namespace shearcell
