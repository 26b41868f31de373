// SPDX-License-Identifier: GPL-3.0-or-later
// Figure S1: phi_u falls as the springs of a packing are made stiffer, phi does not. Supplement
// B.2.
#include <cmath>
#include <map>
#include <vector>

#include "analysis/claims.hpp"
#include "analysis/figures/curves.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/published.hpp"
#include "analysis/statistics.hpp"

namespace shearcell {
namespace {

/// The measures of a run by log10(k/k0), rounded to hundredths, so that equal steps have equal
/// keys; k0 is the stiffness at which the packing settled. Of two checkpoints at one stiffness the
/// later one counts: at k0 the minimum, not the packing as it settled.
std::map<int, const Measures*> by_stiffness(const FigureRun& run) {
  const double settled = number_of(run, "stiffness_N_per_m");
  std::map<int, const Measures*> found;
  for (const CheckpointMeasures& checkpoint : run.checkpoints) {
    const double ratio =
        std::log10(checkpoint.measures.number("raised_stiffness_N_per_m") / settled);
    if (!std::isfinite(ratio)) continue;
    found[static_cast<int>(std::lround(100 * ratio))] = &checkpoint.measures;
  }
  return found;
}

struct Load {
  const char* at;      ///< the value of `pressure_at`
  Text note;           ///< behind the titles of its curves
  std::string claims;  ///< behind its claims
  std::string colour;
  std::vector<const FigureRun*> runs = {};
};

/// The loads that occur in the runs, the default first.
std::vector<Load> loads_of(std::span<const FigureRun> runs) {
  std::vector<Load> loads = {
      {"top", "", "", "#000000"},
      {"moving_wall", ", P on the moving wall", " (P on the moving wall)", "#d55e00"}};
  for (const FigureRun& run : runs) {
    for (Load& load : loads) {
      if (parameter_of(run, "pressure_at") == load.at) load.runs.push_back(&run);
    }
  }
  std::erase_if(loads, [](const Load& load) { return load.runs.empty(); });
  return loads;
}

std::vector<Series> series_under(const Load& load) {
  const auto phi_series = [&](const Text& title, int point, const std::string& column) {
    return Series{.title = title + load.note,
                  .colour = load.colour,
                  .point = point,
                  .columns = {.x = "overlap_mean_d",
                              .y = column + "_mean",
                              .x_error = "overlap_standard_error_d",
                              .y_error = column + "_standard_error",
                              .runs = "runs"},
                  .filter = {"pressure_at", load.at}};
  };
  return {phi_series(formula("$ϕ_u$, uncorrected"), 6, "phi_u"),
          phi_series(formula("$ϕ$"), 7, "phi")};
}

FigureTable table_of(std::span<const Load> loads) {
  FigureTable table{
      .name = "S1",
      .columns = {"pressure_at", "log10_k_over_k0", "overlap_mean_d", "overlap_standard_error_d",
                  "phi_u_mean", "phi_u_standard_error", "phi_mean", "phi_standard_error", "runs"}};
  Axis overlap = overlap_axis;
  overlap.log = true;
  table.chart = {.x = std::move(overlap), .y = phi_axis};
  for (const Load& load : loads) {
    std::map<int, std::vector<const Measures*>> packings;
    for (const FigureRun* run : load.runs) {
      for (const auto& [hundredths, measures] : by_stiffness(*run)) {
        packings[hundredths].push_back(measures);
      }
    }
    for (const auto& [hundredths, at] : packings) {
      TableRow& row = table.rows.emplace_back(TableRow{load.at, hundredths / 100.0});
      RunStatistics over;
      for (const char* measure : {"mean_overlap_d", "phi_uncorrected", "phi"}) {
        std::vector<double> values;
        for (const Measures* measures : at) values.push_back(measures->number(measure));
        over = over_runs(values);
        add_values(over, row);
      }
      row.emplace_back(over.runs);  // of phi
    }
    for (Series& series : series_under(load)) table.chart.series.push_back(std::move(series));
  }
  return table;
}

/// `change` of a measure of the packing of a run from k0 to 100 k0.
Scalar over_the_hundredfold(std::string name, const char* measure,
                            double (*change)(double soft, double hard)) {
  const auto of = [measure, change](const FigureRun& run) -> RunValue {
    const std::map<int, const Measures*> own = by_stiffness(run);
    constexpr int hundredfold = 200;
    if (own.empty() || own.rbegin()->first < hundredfold) return {0, Missing::too_short};
    if (!own.contains(0) || !own.contains(hundredfold)) return {0, Missing::checkpoint};
    return measured(change(own.at(0)->number(measure), own.at(hundredfold)->number(measure)));
  };
  return {std::move(name), "k/k0 from 1 to 100", of};
}

}  // namespace

FigureResult figure_s1(std::span<const FigureRun> runs) {
  const Scalar fall =
      over_the_hundredfold("relative fall of phi_u", "phi_uncorrected",
                           [](double soft, double hard) { return 1 - hard / soft; });
  const Scalar change = over_the_hundredfold("change of phi", "phi",
                                             [](double soft, double hard) { return hard - soft; });
  const std::vector<Load> loads = loads_of(runs);
  FigureResult result{{table_of(loads)}, {}};
  for (const Load& load : loads) {
    result.verdicts.push_back(compare_with(
        {"B.2: phi_u falls by about 2 % over a hundredfold k" + load.claims, margin_fall_of_phi_u},
        fall, load.runs, published_fall_of_phi_u));
    result.verdicts.push_back(compare_with(
        {"B.2: phi (Eq. S4) stays the same over a hundredfold k" + load.claims, margin_hard_phi},
        change, load.runs, 0));
  }
  return result;
}

}  // namespace shearcell
