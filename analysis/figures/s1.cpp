// SPDX-License-Identifier: GPL-3.0-or-later
// Figure S1: phi_u falls as the springs of a packing are made stiffer, phi stays where it is.
// Supplement B.2.
#include <algorithm>
#include <cmath>
#include <map>

#include "analysis/figures/curves.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/figures/groups.hpp"
#include "analysis/published.hpp"
#include "analysis/statistics.hpp"

namespace shearcell {
namespace {

/// The packings of all runs at one stiffness.
struct Stiffness {
  std::vector<double> phi;
  std::vector<double> phi_u;
  std::vector<double> overlap;
};

/// By log10(k/k0) in hundredths, so that rounding does not part equal steps; k0 is the smallest
/// stiffness of the run. Of two checkpoints at one stiffness the later counts: the packing as it
/// settled, then the minimum.
std::map<int, Stiffness> by_stiffness(std::span<const FigureRun> runs) {
  std::map<int, Stiffness> found;
  for (const FigureRun& run : runs) {
    double least = std::nan("");
    for (const CheckpointMeasures& checkpoint : run.checkpoints) {
      least = std::fmin(least, checkpoint.stiffness_N_per_m);
    }
    std::map<int, const Measures*> own;
    for (const CheckpointMeasures& checkpoint : run.checkpoints) {
      const double ratio = std::log10(checkpoint.stiffness_N_per_m / least);
      if (!std::isfinite(ratio)) continue;
      own[static_cast<int>(std::lround(100 * ratio))] = &checkpoint.measures;
    }
    for (const auto& [hundredths, measures] : own) {
      Stiffness& at = found[hundredths];
      at.phi.push_back(measures->phi);
      at.phi_u.push_back(measures->phi_uncorrected);
      at.overlap.push_back(measures->mean_overlap);
    }
  }
  return found;
}

FigureTable table_of(const std::map<int, Stiffness>& found) {
  FigureTable table;
  table.name = "S1";
  table.columns = {
      "log10_k_over_k0",      "overlap_mean_d", "overlap_standard_error_d", "phi_u_mean",
      "phi_u_standard_error", "phi_mean",       "phi_standard_error",       "runs"};
  for (const auto& [hundredths, at] : found) {
    const RunStatistics phi = over_runs(at.phi);
    const RunStatistics phi_u = over_runs(at.phi_u);
    const RunStatistics overlap = over_runs(at.overlap);
    table.rows.push_back({hundredths / 100.0, table_value(overlap.mean),
                          table_value(overlap.standard_error), table_value(phi_u.mean),
                          table_value(phi_u.standard_error), table_value(phi.mean),
                          table_value(phi.standard_error), static_cast<std::int64_t>(phi.runs)});
  }
  const auto phi_series = [](const Text& title, int point, const char* name) {
    const std::string column(name);
    return Series{.title = title,
                  .colour = "#000000",
                  .point = point,
                  .columns = {.x = "overlap_mean_d",
                              .y = column + "_mean",
                              .x_error = "overlap_standard_error_d",
                              .y_error = column + "_standard_error"}};
  };
  Axis overlap = overlap_axis();
  overlap.log = true;
  table.chart = {.x = std::move(overlap),
                 .y = phi_axis(),
                 .series = {phi_series(italic("ϕ") + subscript("u") + ", uncorrected", 6, "phi_u"),
                            phi_series(italic("ϕ"), 7, "phi")}};
  return table;
}

/// What `change` computes from the softest and the hardest packing of a run, if k spans the
/// hundredfold.
Scalar over_the_hundredfold(std::string name,
                            double (*change)(const Stiffness& soft, const Stiffness& hard)) {
  const auto of = [change](const FigureRun& run) -> RunValue {
    const std::map<int, Stiffness> own = by_stiffness(std::span(&run, 1));
    constexpr int hundredfold = 200;
    if (own.empty() || own.rbegin()->first < hundredfold) return {0, Missing::too_short};
    return {change(own.begin()->second, own.rbegin()->second), Missing::nothing};
  };
  return {std::move(name), "k/k0 = 100", of};
}

}  // namespace

FigureResult figure_s1(std::span<const FigureRun> runs) {
  const std::vector<const FigureRun*> all = pointers(runs);
  const Scalar fall = over_the_hundredfold("relative fall of phi_u",
                                           [](const Stiffness& soft, const Stiffness& hard) {
                                             return 1 - hard.phi_u.front() / soft.phi_u.front();
                                           });
  const Scalar change =
      over_the_hundredfold("change of phi", [](const Stiffness& soft, const Stiffness& hard) {
        return hard.phi.front() - soft.phi.front();
      });
  return {{table_of(by_stiffness(runs))},
          {compare_with(
               {"B.2: phi_u falls by about 2 % over a hundredfold k", margin_fall_of_phi_u.value},
               fall, all, published_fall_of_phi_u),
           compare_with(
               {"B.2: phi (Eq. S4) stays the same over a hundredfold k", margin_hard_phi.value},
               change, all, 0)}};
}

}  // namespace shearcell
