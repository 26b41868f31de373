// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/figures/groups.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "analysis/agreement.hpp"
#include "analysis/published.hpp"

namespace shearcell {

std::map<double, std::vector<const FigureRun*>> runs_by(std::span<const FigureRun> runs,
                                                        const std::string& parameter) {
  std::map<double, std::vector<const FigureRun*>> groups;
  for (const FigureRun& run : runs) {
    const double value = number_of(run, parameter);
    if (std::isfinite(value)) groups[value].push_back(&run);
  }
  return groups;
}

double interior_grains(std::span<const FigureRun* const> runs) {
  std::vector<double> counts;
  for (const FigureRun* run : runs) {
    if (run->checkpoints.empty()) continue;
    counts.push_back(static_cast<double>(run->checkpoints.front().measures.interior_grains));
  }
  return over_runs(counts).mean.value_or(std::numeric_limits<double>::quiet_NaN());
}

std::optional<double> published_interior(double grains) {
  for (const PublishedSize& size : published_sizes) {
    if (static_cast<double>(size.grains) == grains)
      return static_cast<double>(size.interior_grains);
  }
  return std::nullopt;
}

Verdict interior_is_published(double grains, std::span<const FigureRun* const> runs) {
  const double published = published_interior(grains).value();
  const double interior = interior_grains(runs);
  const bool measured = std::isfinite(interior);
  return below(
      fmt::format("C: N = {} has {} grains at least 1.5 d from the walls", grains, published),
      "relative difference", std::abs(interior / published - 1), 0.03,
      measured ? fmt::format("N_inves = {:.1f} at the first checkpoint, mean over runs", interior)
               : fmt::format("no run of {} grains", grains));
}

std::string runs_in_words(const Onset& onset) {
  return fmt::format("{} runs, {} end before the onset, {} begin after it", onset.phi.runs,
                     onset.never, onset.before_start);
}

Verdict onset_is_published(const Onset& onset, std::string claim) {
  std::optional<double> distance;
  double limit = published_onset_error;
  std::string note = runs_in_words(onset);
  if (onset.phi.mean) {
    distance = std::abs(*onset.phi.mean - published_onset_phi);
    note += fmt::format("; phi = {:.5f}", *onset.phi.mean);
  }
  if (onset.phi_error) {
    limit += limit_of_agreement(onset.phi.runs - 1) * *onset.phi_error;
    note += fmt::format(" +- {:.5f}", *onset.phi_error);
  }
  return below_if(onset.tells(), std::move(claim), "distance of the mean onset from phi = 0.646",
                  distance, limit, note);
}

std::vector<std::string> onset_columns(std::vector<std::string> columns) {
  columns.insert(columns.end(), {"onset_phi_mean", "onset_phi_standard_error", "runs",
                                 "runs_ended_before", "runs_began_after"});
  return columns;
}

std::vector<TableValue> onset_row(std::vector<TableValue> row, const Onset& onset) {
  row.insert(row.end(),
             {table_value(onset.phi.mean), table_value(onset.phi_error),
              static_cast<std::int64_t>(onset.phi.runs), static_cast<std::int64_t>(onset.never),
              static_cast<std::int64_t>(onset.before_start)});
  return row;
}

}  // namespace shearcell
