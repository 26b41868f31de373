// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/accuracy/fit.hpp"

#include <cmath>
#include <vector>

namespace shearcell::accuracy {

Line fitted_line(std::span<const double> x, std::span<const double> y) {
  const auto count = static_cast<double>(x.size());
  double mean_x = 0, mean_y = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += x[i] / count;
    mean_y += y[i] / count;
  }
  double xx = 0, xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  Line line;
  line.slope = xy / xx;
  line.offset = mean_y - line.slope * mean_x;
  double squares = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    squares += (y[i] - line.at(x[i])) * (y[i] - line.at(x[i]));
  }
  line.scatter = std::sqrt(squares / count);
  return line;
}

double fitted_order(std::span<const double> step, std::span<const double> error) {
  std::vector<double> x, y;
  for (std::size_t i = 0; i < step.size(); ++i) {
    x.push_back(std::log(step[i]));
    y.push_back(std::log(error[i]));
  }
  return fitted_line(x, y).slope;
}

}  // namespace shearcell::accuracy
