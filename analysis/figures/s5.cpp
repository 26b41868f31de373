// SPDX-License-Identifier: GPL-3.0-or-later
// Figures S5a and S5b: packing fraction at the onset of crystallization against amplitude, by both
// methods, and against the size of the system. Supplement C.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/figures/curves.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/figures/groups.hpp"
#include "analysis/onset.hpp"
#include "analysis/published.hpp"

namespace shearcell {
namespace {

constexpr double smallest_size = 5200;  // of the supplement; always claimed

struct AmplitudeOnset {
  double amplitude;
  double critical_size;
  Onset by_size;
  Onset by_slope;
};

/// The supplement takes the standard deviation of its simulations at A = 0.05 rad as the error of
/// the one experiment; this is ours. It states a number for method 1 only.
std::optional<double> experiment_error(std::span<const AmplitudeOnset> onsets) {
  for (const AmplitudeOnset& o : onsets) {
    const RunStatistics& phi = o.by_size.phi;
    if (std::abs(o.amplitude - 0.05) < 1e-6 && phi.standard_error) {
      return *phi.standard_error * std::sqrt(static_cast<double>(phi.runs));
    }
  }
  return std::nullopt;
}

FigureTable amplitude_table(std::span<const AmplitudeOnset> onsets) {
  FigureTable table;
  table.name = "S5a";
  table.columns = onset_columns({"method", "amplitude_rad", "critical_size_grains"});
  for (const AmplitudeOnset& o : onsets) {
    table.rows.push_back(onset_row({std::int64_t{1}, o.amplitude, o.critical_size}, o.by_size));
  }
  for (const AmplitudeOnset& o : onsets) {
    table.rows.push_back(onset_row({std::int64_t{2}, o.amplitude, o.critical_size}, o.by_slope));
  }
  const auto by_method = [](const char* title, const char* colour, int point, std::int64_t method,
                            double shift) {
    return Series{.title = title,
                  .colour = colour,
                  .point = point,
                  .columns = {.x = "amplitude_rad",
                              .y = "onset_phi_mean",
                              .y_error = "onset_phi_standard_error"},
                  .filter = {"method", method},
                  .shift = shift};
  };
  table.chart = {.x = amplitude_axis(),
                 .y = onset_axis(),
                 .series = {{.title = "experiment",
                             .colour = "#e69f00",
                             .points = {{experiment_amplitude_rad,
                                         experiment_onset_phi,
                                         {},
                                         experiment_error(onsets)}}},
                            by_method("largest crystallite is critical", "#0072b2", 9, 1, 0),
                            by_method("steepest growth", "#009e73", 13, 2, 0.001)},
                 .lines = onset_lines()};
  return table;
}

/// Both methods read the same runs.
Verdict methods_agree(double amplitude, RunGroup runs) {
  Scalar shift = onset_phi(onset_by_slope);
  shift.name = "phi at the onset by steepest growth less that by size";
  shift.of = [by_slope = shift.of, by_size = onset_phi(onset_by_size).of](const FigureRun& run) {
    RunValue value = by_slope(run);
    const RunValue other = by_size(run);
    if (other.missing != Missing::nothing) return other;
    value.value -= other.value;
    return value;
  };
  return compare_with({fmt::format("C: both methods give the same onset at A = {} rad", amplitude),
                       margin_onset_phi.value},
                      shift, runs, 0);
}

}  // namespace

FigureResult figure_s5a(std::span<const FigureRun> runs) {
  std::vector<AmplitudeOnset> onsets;
  const auto groups = runs_by(runs, "amplitude_rad");
  for (const auto& [amplitude, members] : groups) {
    const double size = published_nearest(amplitude).critical_size;
    onsets.push_back({amplitude, size, onset(members, onset_by_size, size),
                      onset(members, onset_by_slope, size)});
  }
  FigureResult result{{amplitude_table(onsets)}, {}};
  for (const auto& [amplitude, members] : groups) {
    if (amplitude <= small_amplitude_rad) {
      result.verdicts.push_back(onset_is_published(
          members, fmt::format("C: the onset at A = {} rad is phi = 0.646", amplitude)));
    }
    result.verdicts.push_back(methods_agree(amplitude, members));
  }
  return result;
}

FigureResult figure_s5b(std::span<const FigureRun> runs) {
  FigureTable table;
  table.name = "S5b";
  table.columns = onset_columns({"grains", "interior_grains", "supplement_interior_grains"});
  FigureResult result;
  bool converged = false;
  const auto groups = runs_by(runs, "grains");
  for (const auto& [grains, members] : groups) {
    const double amplitude = number_of(*members.front(), "amplitude_rad");
    const Onset found = onset(members, onset_by_size, published_nearest(amplitude).critical_size);
    const double interior = interior_grains(members);
    table.rows.push_back(
        onset_row({grains, interior, table_value(published_interior(grains))}, found));
    if (published_interior(grains)) {
      result.verdicts.push_back(interior_is_published(grains, members));
    }
    if (interior >= converged_interior_grains) {
      converged = true;
      result.verdicts.push_back(onset_is_published(
          members, fmt::format("C: the onset at N = {} is phi = 0.646", grains)));
    }
  }
  if (!converged) {
    result.verdicts.push_back(
        onset_is_published({}, "C: the onset for N_inves >= 6000 is phi = 0.646"));
  }
  if (!groups.contains(smallest_size)) {
    result.verdicts.push_back(interior_is_published(smallest_size, {}));
  }
  constexpr double most_grains = 20000;
  table.chart = {
      .x = {.name = "grains", .symbol = italic("N"), .low = 0, .high = most_grains},
      .y = onset_axis(),
      .series = {{.title = "simulated",
                  .colour = "#000000",
                  .point = 5,
                  .columns = {.x = "grains",
                              .y = "onset_phi_mean",
                              .y_error = "onset_phi_standard_error"}},
                 {.title = Text("experiment, ") + italic("A") + " = 0.01",
                  .colour = "#e69f00",
                  .point = 0,
                  .join = Join::line,
                  .points = {{0, experiment_onset_phi}, {most_grains, experiment_onset_phi}}}},
      .lines = onset_lines()};
  result.tables.push_back(std::move(table));
  return result;
}

}  // namespace shearcell
