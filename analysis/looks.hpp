// SPDX-License-Identifier: GPL-3.0-or-later
// A look (interim analysis) is a verdict at a planned number of runs. Computes the confidence level
// of each look, and the probability that the looks decide a claim.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analysis/statistics.hpp"
#include "analysis/verdict.hpp"

namespace shearcell {

/// The confidence level of the interval at each look (interim analysis). It is equal for all looks.
/// The probability that all intervals contain the true value is `level` (S. J. Pocock, Biometrika
/// 64, 191 (1977)). The interval of a look uses Student's quantile for the number of runs at this
/// look (C. Jennison and B. W. Turnbull, Group Sequential Methods (2000), section 11.4.4). `looks`:
/// numbers of runs, ascending. Estimates at n and m > n runs have the correlation sqrt(n / m).
/// Their joint probability is integrated from look to look: P. Armitage, C. K. McPherson and B. C.
/// Rowe, J. R. Stat. Soc. A 132, 235 (1969).
double look_level(std::span<const std::size_t> looks, double level = confidence_level);

/// Probabilities that this look or an earlier look decides the claim. The first decision is final.
struct LookPower {
  std::size_t runs = 0;
  double as_claimed = 0;  ///< agrees, or supported
  double against = 0;     ///< differs, or refuted
};

/// The power at each look if the true value is `truth` and the values of the runs have a normal
/// distribution. `spread`: Estimate::spread. `groups`: 1 for one group or for pairs, 2 for two
/// groups of equal size. Every call simulates 4000 studies, with the same random numbers. Standard
/// errors are at most 0.008.
std::vector<LookPower> power_of(const Claim& claim, double truth, double spread, std::size_t groups,
                                std::span<const std::size_t> looks);

}  // namespace shearcell
