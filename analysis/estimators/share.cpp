// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/estimators.hpp"

namespace shearcell {

std::optional<Estimate> share(std::span<const std::vector<double>> packings) {
  return bootstrapped(packings.size(), [&](std::span<const std::size_t> selection) {
    double sum = 0, all = 0;
    for (const std::size_t packing : selection) {
      for (const double item : packings[packing]) {
        sum += item;
        ++all;
      }
    }
    return sum / all;
  });
}

}  // namespace shearcell
