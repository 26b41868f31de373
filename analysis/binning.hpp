// SPDX-License-Identifier: GPL-3.0-or-later
// A column against volume fraction. Runs reach the same phi at different cycles, so they are
// averaged at equal phi.
#pragma once

#include <vector>

#include "analysis/frame.hpp"

namespace shearcell {

/// Width of the bins in phi, which begin at whole multiples of it. [choice]
inline constexpr double phi_bin = 0.002;

/// Means over a run's checkpoints in one bin of phi.
struct PhiMean {
  double phi = 0;
  double value = 0;
};

/// The bins in which a run has the column; ascending. Checkpoints without a finite phi are left
/// out.
std::vector<PhiMean> means_over_phi(const FrameRun& run, const NumberColumn& column);

}  // namespace shearcell
