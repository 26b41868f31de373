// SPDX-License-Identifier: GPL-3.0-or-later
// Do two curves, each a mean over runs, agree within their errors?
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "analysis/statistics.hpp"
#include "analysis/verdict.hpp"

namespace shearcell {

/// Fewer runs of a curve than this have no error worth a verdict. [choice]
inline constexpr std::size_t runs_to_tell = 3;

/// Two values at the same abscissa.
struct ComparedPoint {
  RunStatistics a;
  RunStatistics b;
};

struct CurveDifference {
  std::size_t points = 0;     ///< those where both curves have at least `runs_to_tell` runs
  std::size_t freedom = 0;    ///< smallest n_a + n_b - 2 among them
  std::optional<double> rms;  ///< of (a - b) / s over the points; none without points
};

/// s^2 = se_a^2 + se_b^2, and at least resolution^2: a difference below what can be resolved is no
/// difference, and runs that are equal by chance (no crystalline grain in any) have no error.
/// Points of one run are correlated, so one point may speak for all: the rms is then |t| itself,
/// which is why limit_of_agreement() does not shrink with the number of points.
CurveDifference difference(std::span<const ComparedPoint> points, double resolution);

/// Two standard errors (95.45 %, two-sided) for many runs; for few the same level of Student's t
/// with `freedom` degrees of freedom, shared among `tests` comparisons (Bonferroni). `freedom` and
/// `tests` at least 1.
double limit_of_agreement(std::size_t freedom, std::size_t tests = 1);

/// A verdict on two means over runs, passed when they differ by less than limit_of_agreement();
/// `enough` as in below_if().
Verdict means_agree(bool enough, std::string claim, const RunStatistics& a, const RunStatistics& b,
                    std::string note);

}  // namespace shearcell
