// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/agreement.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <utility>

namespace shearcell {

CurveDifference difference(std::span<const ComparedPoint> points, double resolution) {
  CurveDifference result;
  double sum = 0;
  for (const ComparedPoint& point : points) {
    if (std::min(point.a.runs, point.b.runs) < runs_to_tell) continue;
    const double s = std::max(
        std::hypot(point.a.standard_error.value(), point.b.standard_error.value()), resolution);
    const double z = (point.a.mean.value() - point.b.mean.value()) / s;
    sum += z * z;
    const std::size_t freedom = point.a.runs + point.b.runs - 2;
    result.freedom = result.points == 0 ? freedom : std::min(result.freedom, freedom);
    ++result.points;
  }
  if (result.points > 0) result.rms = std::sqrt(sum / static_cast<double>(result.points));
  return result;
}

double limit_of_agreement(std::size_t freedom, std::size_t tests) {
  constexpr double outside = 0.0455;  // of a normal distribution, beyond two standard deviations
  const boost::math::students_t student(static_cast<double>(freedom));
  return boost::math::quantile(
      boost::math::complement(student, outside / (2 * static_cast<double>(tests))));
}

Verdict means_agree(bool enough, std::string claim, const RunStatistics& a, const RunStatistics& b,
                    std::string note) {
  Verdict verdict{std::move(claim),     "difference of the means in standard errors",
                  std::nullopt,         std::nullopt,
                  Ruling::too_few_runs, std::move(note)};
  const ComparedPoint point{a, b};
  const CurveDifference found = difference(std::span(&point, 1), 1e-6);
  if (!found.rms) return verdict;
  verdict.value = found.rms;
  verdict.limit = limit_of_agreement(found.freedom);
  if (enough) verdict.ruling = *verdict.value < *verdict.limit ? Ruling::pass : Ruling::fail;
  return verdict;
}

}  // namespace shearcell
