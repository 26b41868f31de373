// SPDX-License-Identifier: GPL-3.0-or-later
// Straight lines by least squares: orders of convergence, drifts, rates of growth.
#pragma once

#include <span>

namespace shearcell::accuracy {

struct Line {
  double slope = 0, offset = 0;
  double scatter = 0;  ///< standard deviation of the points from it
  double at(double x) const { return offset + slope * x; }
};

/// Through points (x, y); needs two different x.
Line fitted_line(std::span<const double> x, std::span<const double> y);

/// Slope of log(error) against log(step): the order of convergence.
double fitted_order(std::span<const double> step, std::span<const double> error);

}  // namespace shearcell::accuracy
