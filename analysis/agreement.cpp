// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/agreement.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

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

}  // namespace shearcell
