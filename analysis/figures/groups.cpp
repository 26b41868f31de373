// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/figures/groups.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "analysis/published.hpp"

namespace shearcell {

std::vector<const FigureRun*> pointers(std::span<const FigureRun> runs) {
  std::vector<const FigureRun*> all;
  for (const FigureRun& run : runs) all.push_back(&run);
  return all;
}

std::map<double, std::vector<const FigureRun*>> runs_by(std::span<const FigureRun> runs,
                                                        const std::string& parameter) {
  std::map<double, std::vector<const FigureRun*>> groups;
  for (const FigureRun& run : runs) {
    const double value = number_of(run, parameter);
    if (std::isfinite(value)) groups[value].push_back(&run);
  }
  return groups;
}

double at_start(RunGroup runs, const std::string& measure) {
  std::vector<double> values;
  for (const FigureRun* run : runs) {
    if (!run->checkpoints.empty())
      values.push_back(run->checkpoints.front().measures.number(measure));
  }
  return over_runs(values).mean.value_or(std::numeric_limits<double>::quiet_NaN());
}

std::optional<double> published_interior(double grains) {
  for (const PublishedSize& size : published_sizes) {
    if (static_cast<double>(size.grains) == grains)
      return static_cast<double>(size.interior_grains);
  }
  return std::nullopt;
}

Verdict interior_is_published(double grains, RunGroup runs) {
  const double published = published_interior(grains).value();
  Scalar interior = over_cycles("N_inves", "interior_grains", 0, 0);
  interior.relative = true;
  return compare_with(
      {fmt::format("C: N = {} has {} grains at least 1.5 d from the walls", grains, published),
       margin_interior},
      interior, runs, published);
}

Verdict onset_is_published(RunGroup runs, std::string claim) {
  return compare_with({std::move(claim), margin_onset_phi}, onset_phi(), runs, published_onset_phi);
}

}  // namespace shearcell
