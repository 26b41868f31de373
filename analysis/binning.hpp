// SPDX-License-Identifier: GPL-3.0-or-later
// A measure against volume fraction. Runs reach the same phi at different cycles, so they are
// averaged at equal phi.
#pragma once

#include <string>
#include <vector>

#include "analysis/figure.hpp"
#include "analysis/statistics.hpp"

namespace shearcell {

/// Width of the bins in phi. [choice]
inline constexpr double phi_bin = 0.002;

/// All checkpoints with low <= phi < high. Each run counts once, with the mean of its checkpoints
/// there, and runs of one packing count as one run, so that errors are over independent runs.
struct PhiBin {
  double low = 0;
  double high = 0;
  RunStatistics phi;
  RunStatistics value;
};

/// Ascending bins between whole multiples of phi_bin; only those that some run visits. Checkpoints
/// without a finite phi are left out. Values below `least` count as `least`.
std::vector<PhiBin> binned_by_phi(RunGroup runs, const std::string& measure,
                                  double least = -infinite);

}  // namespace shearcell
