// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/published.hpp"

#include <algorithm>
#include <cmath>

namespace shearcell {

const PublishedAmplitude& published_nearest(double amplitude_rad) {
  return *std::min_element(published_amplitudes.begin(), published_amplitudes.end(),
                           [&](const PublishedAmplitude& a, const PublishedAmplitude& b) {
                             return std::abs(a.amplitude_rad - amplitude_rad) <
                                    std::abs(b.amplitude_rad - amplitude_rad);
                           });
}

}  // namespace shearcell
