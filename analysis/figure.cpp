// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/figure.hpp"

namespace shearcell {

// Each function is defined in a file of analysis/figures/.
using MakeFigure = FigureResult(const Frame& frame);
MakeFigure figure_table1, figure_s7, figure_c, figure_committor, figure_nucleation,
    figure_nucleation_core;

std::span<const Figure> computed_figures() {
  using enum FigureForm;
  using Names = std::vector<std::string>;
  const auto one = [](const char* name, const char* title, auto* make, FigureForm form,
                      Names keys = {}, Names needs = {}, Names claims = {}) {
    return Figure{name, title, make, form, std::move(keys), std::move(claims), std::move(needs)};
  };
  static const std::vector<Figure> all = {
      one("table1", "Table I and the parameters of every experiment", figure_table1, table),
      one("S7", "Where crystallites nucleate", figure_s7, groups,
          {"amplitude_rad", "stiffness_N_per_m"}, {"crystallites"},
          {"S7.inner", "S7.top", "S7.stiff"}),
      one("C", "Growth of crystallites by size", figure_c, groups, {"amplitude_rad"},
          {"crystallites"}, {"C.critical_size", "C.growth"}),
      one("committor", "The probability that a crystallite grows", figure_committor, groups,
          {"amplitude_rad", "start_seed", "start_cycle"}, {"crystallites"},
          {"committor.size", "committor.growth"}),
      one("nucleation", "Runs without an onset, and the rate of nucleation", figure_nucleation,
          groups, {"amplitude_rad", "grains"}, {}, {"nucleation.volume"}),
      one("nucleation_core", "The rate of nucleation at least 4 d from the walls",
          figure_nucleation_core, groups, {"amplitude_rad", "grains"}, {"core"},
          {"nucleation_core.volume"})};
  return all;
}

}  // namespace shearcell
