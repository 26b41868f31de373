// SPDX-License-Identifier: GPL-3.0-or-later
// The ratio of the standard deviations of two correlated numbers of the same runs: E. J. G. Pitman,
// Biometrika 31, 9 (1939); W. A. Morgan, Biometrika 31, 13 (1939).
#include <fmt/format.h>

#include <cmath>
#include <map>

#include "analysis/estimators.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

std::string words_of_ratio(const ClaimSpec& claim) {
  return fmt::format("standard deviation of {} relative to that of {}", claim.compare,
                     claim.against);
}

/// Each run has two numbers, `compare` and `against`. F is the ratio of the variances of these
/// numbers, r is the correlation between them, and t is Student's quantile for f degrees of
/// freedom. F and r are computed from the deviation of each run from the mean of its variant. The
/// interval of the true variance ratio is
///
///     F (K -+ sqrt(K^2 - 1)),   K = 1 + 2 (1 - r^2) t^2 / f,   f = runs - variants - 1
Verdict decide_ratio(const ClaimSpec& claim, const Claim& stated, RunGroup runs, RunGroup) {
  ClaimSpec other = claim;
  other.compare = claim.against;
  const Scalar first = number_of_the_run.scalar(claim), second = number_of_the_run.scalar(other);
  Table entered = entered_with({"value", "other"});
  NumbersOfRuns numbers;
  std::map<std::string, std::vector<std::pair<double, double>>> variants;
  for (const FrameRun* run : runs) {
    const RunValue of_first = first.of(*run), of_second = second.of(*run);
    numbers.take(*run, of_first.missing == Missing::nothing ? of_second : of_first);
    const double x = of_first.or_nan(), y = of_second.or_nan();
    enter(*run, {x, y}, entered);
    if (std::isfinite(x) && std::isfinite(y)) variants[run->place.variant].emplace_back(x, y);
  }
  double n = 0, xx = 0, yy = 0, xy = 0;
  for (const auto& [variant, pairs] : variants) {
    const auto count = static_cast<double>(pairs.size());
    double x_mean = 0, y_mean = 0;
    for (const auto& [x, y] : pairs) x_mean += x / count, y_mean += y / count;
    for (const auto& [x, y] : pairs) {
      xx += (x - x_mean) * (x - x_mean);
      yy += (y - y_mean) * (y - y_mean);
      xy += (x - x_mean) * (y - y_mean);
    }
    n += count;
  }
  const auto with_both = static_cast<std::size_t>(n);
  numbers.enough = is_enough(with_both, runs.size());
  const std::string why_not = numbers.why_not();
  const double freedom = n - static_cast<double>(variants.size()) - 1;
  std::optional<Estimate> estimate;
  if (freedom >= 1 && xx > 0 && yy > 0 && why_not.empty()) {
    const double t = student_quantile((1 + stated.level) / 2, freedom);
    const double k = 1 + 2 * (1 - xy * xy / (xx * yy)) * t * t / freedom;
    const double log_ratio = std::log(xx / yy) / 2, half = std::acosh(k) / 2;
    estimate = mapped(estimate_with(log_ratio, {log_ratio - half, log_ratio + half}, t, with_both),
                      [](double log) { return std::expm1(log); });
  }
  std::string note =
      fmt::format("{} of {} runs have values of both measures, in {}; Pitman-Morgan test",
                  with_both, runs.size(), counted(variants.size(), "variant"));
  add_note(note, why_not);
  return decide(stated, words_of_ratio(claim) + ", minus 1", estimate, with_both, std::move(note),
                std::move(entered));
}

}  // namespace

const Estimator spread_ratio = {
    .name = "spread_ratio",
    .meaning =
        "s/t - 1, where s and t are the standard deviations of `compare` and of `against` among "
        "runs of the same variant",
    .key = "against",
    .of_run = true,
    .over_variants = true,
    .one_side = true,
    .reference = "1",
    .decide = decide_ratio,
    .words = words_of_ratio};

}  // namespace shearcell
