// SPDX-License-Identifier: GPL-3.0-or-later
// Waiting times of which some end unobserved: the cycle of the onset in runs that may stop before.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "analysis/statistics.hpp"

namespace shearcell {

/// One run: the cycle of the event, or, censored, the last cycle without one.
struct Waiting {
  double cycle = 0;
  bool observed = false;
};

/// Probability to wait longer than `cycle`, from that cycle on.
struct SurvivalStep {
  double cycle = 0;
  double survival = 1;
};

/// The product-limit estimate, a step at each observed cycle: E. L. Kaplan and P. Meier, J. Am.
/// Stat. Assoc. 53, 457 (1958).
std::vector<SurvivalStep> kaplan_meier(std::span<const Waiting> runs);

/// The first cycle after which less than half of the runs still wait; the middle of the cycles
/// between which exactly half do, as the median of an even number of values. None if more than half
/// wait at the end.
std::optional<double> median_wait(std::span<const Waiting> runs);

/// The log-rank statistic: events of `a` observed and expected if both groups wait alike, over the
/// standard deviation of their difference. Positive if `a` is the earlier group, 0 without events.
/// N. Mantel, Cancer Chemother. Rep. 50, 163 (1966).
double log_rank(std::span<const Waiting> a, std::span<const Waiting> b);

/// log2 of the factor by which the waits of `a` are longer than those of `b`: the one at which the
/// log-rank statistic of `a` against the scaled `b` vanishes. The interval holds the factors that
/// the log-rank test does not reject (A. A. Tsiatis, Ann. Stat. 18, 354 (1990)); it is infinite
/// where too few events were observed. None for fewer than least_runs in a group, or without an
/// event.
std::optional<Estimate> log2_wait_ratio(std::span<const Waiting> a, std::span<const Waiting> b);

}  // namespace shearcell
