// SPDX-License-Identifier: GPL-3.0-or-later
// Figure summary: onset, critical size and percentage crystalline of all experiments of a store,
// from the tables and verdicts of their figures.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <set>
#include <utility>

#include "analysis/claims.hpp"
#include "analysis/committor.hpp"
#include "analysis/figures/curves.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/published.hpp"
#include "analysis/statistics.hpp"

namespace shearcell {
namespace {

using Parts = std::span<const FigurePart>;

/// The figures whose curves of the percentage crystalline are drawn, and what their variants differ
/// in.
struct Compared {
  const char* figure;
  const char* what;
};
constexpr std::array<Compared, 6> compared_figures = {{{"S2", "drag"},
                                                       {"S3", "time step"},
                                                       {"S4", "moving wall, load"},
                                                       {"B5", "pauses"},
                                                       {"walls", "walls"},
                                                       {"S6", "gravity, amplitude"}}};

std::optional<std::size_t> column_of(const FigureTable& table, std::string_view name) {
  const auto found = std::ranges::find(table.columns, name);
  if (found == table.columns.end()) return std::nullopt;
  return static_cast<std::size_t>(found - table.columns.begin());
}

/// The rows of the tables for which `is` holds, each after its experiment and its curve (experiment
/// and variant), drawn as the first of these tables. Tables with other columns are left out.
/// Without columns if there is no such table.
FigureTable stacked(Parts parts, std::string name,
                    const std::function<bool(const FigurePart&, const FigureTable&)>& is) {
  FigureTable all;
  all.name = std::move(name);
  for (const FigurePart& part : parts) {
    for (const FigureTable& table : part.result.tables) {
      if (!is(part, table)) continue;
      std::vector<std::string> columns = {"experiment", "curve"};
      columns.insert(columns.end(), table.columns.begin(), table.columns.end());
      if (all.columns.empty()) {
        all.columns = columns;
        all.chart = table.chart;
      }
      if (all.columns != columns) continue;
      const auto variant = column_of(table, "variant");
      for (const TableRow& values : table.rows) {
        std::string curve = part.experiment;
        if (variant) curve += " " + std::get<std::string>(values.at(*variant));
        TableRow& row = all.rows.emplace_back(TableRow{part.experiment, std::move(curve)});
        row.insert(row.end(), values.begin(), values.end());
      }
    }
  }
  return all;
}

FigureTable stacked(Parts parts, std::string name, std::string_view table_name) {
  return stacked(parts, std::move(name), [&](const FigurePart&, const FigureTable& table) {
    return table.name == table_name;
  });
}

/// phi at the onset against the number of interior grains, a series for each experiment.
FigureTable onset_against_size(Parts parts) {
  FigureTable table = stacked(parts, "summary_b", "S5b");
  table.chart = {.x = {.name = "interior grains", .symbol = formula("$N_{inves}$"), .log = true},
                 .y = onset_axis,
                 .lines = onset_lines()};
  std::set<std::string> experiments;
  for (const TableRow& row : table.rows) experiments.insert(std::get<std::string>(row.front()));
  for (const std::string& experiment : experiments) {
    const std::size_t k = table.chart.series.size();
    table.chart.series.push_back({.title = experiment,
                                  .colour = safe_colours[k % safe_colours.size()],
                                  .point = curve_symbol(k),
                                  .columns = columns_against("interior_grains", onset_column),
                                  .filter = {"experiment", experiment}});
  }
  return table;
}

/// That of figure C, with the committor's sizes as lines where a part has them.
FigureTable size_against_cycles(Parts parts) {
  FigureTable table = stacked(parts, "summary_c", "C_followed");
  const FigureTable sizes = stacked(parts, "", "committor_sizes");
  const auto amplitude = column_of(sizes, "amplitude_rad");
  const auto rule = column_of(sizes, "cycles_without");
  const auto size = column_of(sizes, "half_size_grains");
  for (const TableRow& row : sizes.rows) {
    const auto* at = std::get_if<double>(&row.at(size.value()));
    if (at == nullptr || row.at(rule.value()) != TableValue(cycles_gone)) continue;
    const auto drawn = std::ranges::find_if(table.chart.series, [&](const Series& series) {
      return series.filter.value == row.at(amplitude.value());
    });
    const bool has_colour = drawn != table.chart.series.end();
    table.chart.lines.push_back({.at = *at,
                                 .colour = has_colour ? drawn->colour : "#888888",
                                 .title = "sizes of which half grow (committor)"});
  }
  return table;
}

/// A line for each variant, in the colour of its figure.
FigureTable percentage_against_phi(Parts parts) {
  const auto is_compared = [](const FigurePart& part, const FigureTable& table) {
    const bool listed = std::ranges::any_of(
        compared_figures, [&](const Compared& one) { return part.figure == one.figure; });
    return listed && column_of(table, "phi_low") && column_of(table, "crystalline_mean_percent");
  };
  FigureTable table = stacked(parts, "summary_d", is_compared);
  table.chart = {.x = phi_axis, .y = crystalline_axis, .lines = onset_lines(true)};
  for (std::size_t k = 0; k < compared_figures.size(); ++k) {
    std::set<std::string> known;  // curves of the figure
    for (const FigurePart& part : parts) {
      if (part.figure != compared_figures[k].figure) continue;
      const FigureTable own = stacked(std::span(&part, 1), "", is_compared);
      for (const TableRow& row : own.rows) {
        const auto& curve = std::get<std::string>(row.at(1));
        if (!known.insert(curve).second) continue;
        table.chart.series.push_back(
            {.title = known.size() > 1 ? Text() : Text(compared_figures[k].what),
             .colour = safe_colours[k],
             .point = 0,
             .join = Join::line,
             .columns = {.x = "phi_mean", .y = "crystalline_mean_percent"},
             .filter = {"curve", curve}});
      }
    }
  }
  return table;
}

/// The largest difference among all verdicts on such a difference between two groups. Each interval
/// is as much longer as Bonferroni's for that many comparisons, by Student's t for the fewest runs
/// that it may be of, so that all hold at once with 90 %. The largest difference then lies between
/// the largest of the least sizes that they allow and the largest of the greatest.
Verdict largest_difference(Parts parts, const std::string& quantity, const Claim& claim) {
  std::vector<std::pair<const FigurePart*, const Verdict*>> all;
  for (const FigurePart& part : parts) {
    for (const Verdict& verdict : part.result.verdicts) {
      if (verdict.quantity == quantity && verdict.estimate) all.emplace_back(&part, &verdict);
    }
  }
  std::optional<Estimate> largest;
  std::string of;
  FigureTable entered{
      .columns = {"experiment", "figure", "compared", "difference", "low", "high", "runs"}};
  for (const auto& [part, verdict] : all) {
    const double value = *verdict->estimate, freedom = static_cast<double>(verdict->runs) - 1;
    const double tail = (1 - confidence_level) / 2;
    const double longer = student_quantile(1 - tail / static_cast<double>(all.size()), freedom) /
                          student_quantile(1 - tail, freedom);
    const double low = value - longer * (value - verdict->interval.low);
    const double high = value + longer * (verdict->interval.high - value);
    entered.rows.push_back(
        {part->experiment, part->figure, verdict->claim, value, low, high, verdict->runs});
    const double least = std::max({low, -high, 0.0});
    if (!largest) largest.emplace().runs = verdict->runs;
    if (std::abs(value) >= largest->value) of = verdict->claim;
    largest->value = std::max(largest->value, std::abs(value));
    largest->interval.low = std::max(largest->interval.low, least);
    largest->interval.high = std::max({largest->interval.high, -low, high});
    largest->runs = std::min(largest->runs, verdict->runs);
  }
  Verdict verdict = decide(
      claim, "largest " + quantity, largest, largest ? largest->runs : 0,
      largest ? fmt::format("{} comparisons, whose intervals all hold with 90 % (Bonferroni); the "
                            "largest is that of \"{}\"",
                            all.size(), of)
              : "no figure of this store compares two groups",
      std::move(entered), Counted::runs_per_variant);
  // It would be the number for one comparison, and it is not known for which.
  verdict.runs_needed.reset();
  return verdict;
}

}  // namespace

const std::vector<std::string>& summary_parts() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all = {"S5a", "S5b", "C", "committor"};
    for (const Compared& one : compared_figures) all.emplace_back(one.figure);
    return all;
  }();
  return names;
}

FigureResult figure_summary(std::span<const FigurePart> parts) {
  FigureResult result;
  std::vector<std::string> missing;
  const std::pair<FigureTable, const char*> panels[] = {
      {stacked(parts, "summary_a", "S5a"), "onset against amplitude (S5a)"},
      {onset_against_size(parts), "onset against size (S5b)"},
      {size_against_cycles(parts), "critical size against n_bin (C)"},
      {percentage_against_phi(parts), "percentage against phi (S2, S3, S4, B5, walls, S6)"}};
  for (const auto& [table, what] : panels) {
    if (table.rows.empty()) {
      missing.emplace_back(what);
    } else {
      result.tables.push_back(table);
    }
  }
  if (!result.tables.empty() && !missing.empty()) {
    result.tables.back().chart.note +=
        fmt::format("{}this store has no runs for {}",
                    result.tables.back().chart.note.empty() ? "" : "; ", fmt::join(missing, ", "));
  }
  const Scalar percentage =
      over_phi("percentage crystalline", "crystalline_percent", window_low, window_high);
  result.verdicts = {
      largest_difference(parts, "difference in " + percentage.name,
                         {"B.3 to D: no drag, time step, wall or gravity changes the percentage "
                          "crystalline at equal phi",
                          margin_percentage}),
      largest_difference(parts, "difference in " + onset_phi().name,
                         {"B.3 to D: no drag, time step, wall or gravity changes phi at the onset",
                          margin_onset_phi})};
  return result;
}

}  // namespace shearcell
