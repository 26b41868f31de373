// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/figures/groups.hpp"

#include <fmt/format.h>

#include <cmath>
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
