// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/accuracy/accuracy.hpp"

#include "experiments/bench/accuracy/packings.hpp"

namespace shearcell::accuracy {

std::vector<Section> measure_accuracy(const Options& options) {
  if (options.report) options.report("the engine's rate");
  const double rate = shear_rate_measured(settled(small_cell(options.quick), 1),
                                          options.quick ? 1 : 9, options.quick ? 0.05 : 0.3);
  std::vector<Section> sections = small_scene_sections(options, rate);
  sections.push_back(dispersion_section(options));
  sections.push_back(drift_section(options));
  sections.push_back(separation_section(options));
  sections.push_back(seeds_section(options, rate));
  sections.push_back(softness_section(options, rate));
  sections.push_back(order_section(options));
  return sections;
}

}  // namespace shearcell::accuracy
