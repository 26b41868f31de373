// SPDX-License-Identifier: GPL-3.0-or-later
// Verdicts at several planned numbers of runs: the confidence level of each look, and how often a
// claim is decided.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analysis/statistics.hpp"
#include "analysis/verdict.hpp"

namespace shearcell {

/// The confidence level of the interval at each look, so that with probability `level` all of them
/// hold the true value: S. J. Pocock, Biometrika 64, 191 (1977). The level is the same at each
/// look, and each look takes Student's quantile of its own runs at this level (C. Jennison and
/// B. W. Turnbull, Group Sequential Methods (2000), section 11.4.4). `looks`: numbers of runs,
/// ascending. Estimates at n and m > n runs have the correlation sqrt(n / m); their probability is
/// integrated from look to look: P. Armitage, C. K. McPherson and B. C. Rowe, J. R. Stat. Soc. A
/// 132, 235 (1969).
double look_level(std::span<const std::size_t> looks, double level = confidence_level);

/// Probabilities of a verdict at this look or an earlier one. The first verdict is final.
struct LookPower {
  std::size_t runs = 0;
  double as_claimed = 0;  ///< agrees, or supported
  double against = 0;     ///< differs, or refuted
};

/// The power at each look if the true value is `truth` and the runs are normally distributed with
/// `spread` (Estimate::spread). `groups`: 1 for one group or pairs, 2 for two groups of that many
/// runs each. 4000 campaigns are simulated, always the same ones; errors are at most 0.008.
std::vector<LookPower> power_of(const Claim& claim, double truth, double spread, std::size_t groups,
                                std::span<const std::size_t> looks);

}  // namespace shearcell
