// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/figures/figures.hpp"

namespace shearcell {
namespace {

constexpr auto scalars = FigureNeeds::scalars;

constexpr std::array figures = {
    Figure{"table1", "Table I beside the parameters of every experiment", FigureNeeds::none,
           figure_table1, FigureScope::every},
    Figure{"S1", "Packing fraction in the limit of hard grains", scalars, figure_s1},
    Figure{"S2", "Still fluid and fluid that moves with the cell", scalars, figure_s2},
    Figure{"S3", "Four time steps", scalars, figure_s3},
    Figure{"S4", "Moving bottom wall and moving top wall", scalars, figure_s4},
    Figure{"S5a", "Onset of crystallization against amplitude", scalars, figure_s5a},
    Figure{"S5b", "Onset of crystallization against system size", scalars, figure_s5b},
    Figure{"S6", "Shear with and without gravity", scalars, figure_s6},
    Figure{"S7", "Where crystallites nucleate", FigureNeeds::crystallites, figure_s7},
    Figure{"C", "Growth of crystallites by size", FigureNeeds::crystallites, figure_c},
    Figure{"B5", "Continuous and periodically paused shear", scalars, figure_b5},
    Figure{"walls", "Rough and smooth walls", scalars, figure_walls},
    Figure{"choices", "Mass and drag of the moving wall, and other wall grains", scalars,
           figure_choices},
};

}  // namespace

nlohmann::json parameter_of(const FigureRun& run, const std::string& key) {
  for (const nlohmann::json* values : {&run.labels, &run.parameters}) {
    if (values->is_object() && values->contains(key)) return values->at(key);
  }
  return nullptr;
}

double number_of(const FigureRun& run, const std::string& key) {
  const nlohmann::json value = parameter_of(run, key);
  return value.is_number() ? value.get<double>() : std::nan("");
}

std::span<const Figure> all_figures() {
  return figures;
}

const Figure* find_figure(std::string_view name) {
  const auto* found = std::find_if(figures.begin(), figures.end(),
                                   [&](const Figure& figure) { return figure.name == name; });
  return found == figures.end() ? nullptr : found;
}

}  // namespace shearcell
