// SPDX-License-Identifier: GPL-3.0-or-later
// Means of a column in bins of the volume fraction phi. Runs reach the same phi at different
// cycles, so runs are averaged at equal phi.
#pragma once

#include <vector>

#include "analysis/frame.hpp"

namespace shearcell {

/// Width of the bins in phi. Bins begin at integer multiples of this width. [choice]
inline constexpr double phi_bin = 0.002;

/// Means over the checkpoints of one run in one bin of phi.
struct PhiMean {
  double phi = 0;
  double value = 0;
};

/// Means of the column in each bin of phi, in ascending order. Checkpoints without a finite phi and
/// bins without a finite value are left out.
std::vector<PhiMean> means_over_phi(const FrameRun& run, const NumberColumn& column);

}  // namespace shearcell
