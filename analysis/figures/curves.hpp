// SPDX-License-Identifier: GPL-3.0-or-later
// Runs grouped into the curves of a figure, and the panels that draw such curves: one curve per
// variant, averaged over runs, against the cycle or against the volume fraction.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/figure.hpp"
#include "analysis/statistics.hpp"

namespace shearcell {

/// How a manifest or a figure wants the curve of the runs with these parameters drawn. A style that
/// fits several curves is ignored. What no style states follows from the variant: the title from
/// its name, the colour from the first parameter that varies, the symbol from the other parameters.
struct CurveStyle {
  nlohmann::json where;     ///< parameters and their values
  Text title = {};          ///< empty: not stated
  std::string colour = {};  ///< "#rrggbb"; empty: not stated
  int point = -1;           ///< as in Series; -1: not stated
  /// A manifest states the style. Any other style is used only if the runs differ in the parameters
  /// of styles alone, and its title only if no label of the manifest names the variant.
  bool of_manifest = false;
};

/// All checkpoints of one variant at the end of one cycle, one per run.
struct CurvePoint {
  std::int64_t cycle;
  std::vector<const FigureRun*> runs;
  std::vector<const Measures*> measures;  ///< of the same runs
};

struct Curve {
  std::string variant;    ///< its name, with ';' for ','
  CurveStyle style = {};  ///< complete, without `where`
  std::vector<const FigureRun*> runs;
  std::vector<CurvePoint> points;  ///< by cycle
};

/// One curve for each variant, in the order of the styles, then any others by their values.
/// Checkpoints inside a cycle are left out. Throws AnalysisError if one run has two checkpoints of
/// one cycle. Points into `runs`.
std::vector<Curve> curves_of(std::span<const FigureRun> runs, std::span<const CurveStyle> styles);

// The axes that several figures share.
inline const Axis cycle_axis = {.name = "shear cycle", .symbol = formula("$n$"), .whole = true};
inline const Axis phi_axis = {.name = "volume fraction", .symbol = formula("$ϕ$")};
inline const Axis crystalline_axis = {.name = "percentage crystalline", .unit = "%", .low = 0};
inline const Axis overlap_axis = {
    .name = "mean overlap", .symbol = formula("⟨$δ$⟩"), .unit = formula("$d$")};
inline const Axis amplitude_axis = {
    .name = "amplitude", .symbol = formula("$A$"), .unit = "rad", .low = 0, .high = 0.12};
inline const Axis onset_axis = {.name = "onset", .symbol = formula("$ϕ$")};

/// Dashed lines at phi = 0.646 +- 0.001, the supplement's onset.
std::vector<ReferenceLine> onset_lines(bool vertical = false);
/// The supplement's critical size [grains] of one amplitude.
ReferenceLine critical_line(double size, const std::string& colour);

/// Columns of a size, its interval and its standard error, all in grains.
void add_size_columns(const std::string& name, std::vector<std::string>& columns);
/// The values of those columns; empty without an estimate.
void add_size(const std::optional<Estimate>& size, TableRow& row);

/// Colours for readers with any colour vision (Okabe and Ito, jfly.uni-koeln.de/color), and their
/// names in manifests.
inline constexpr std::array<const char*, 7> safe_colours = {
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"};
inline constexpr std::array<std::string_view, 7> colour_names = {
    "blue", "vermilion", "green", "purple", "orange", "sky", "black"};

/// No symbol, then those of curve_symbol(), as manifests name them.
inline constexpr std::array<std::string_view, 11> marker_names = {
    "none",        "square",      "circle",        "triangle",           "triangle_down", "diamond",
    "open_square", "open_circle", "open_triangle", "open_triangle_down", "open_diamond"};

/// The five filled symbols, then the open ones.
inline int curve_symbol(std::size_t k) {
  return (k / 5 % 2 == 0 ? 5 : 4) + 2 * static_cast<int>(k % 5);
}
inline constexpr std::size_t curve_symbols = 10;

/// The trace of one run.
Series thin_line(Text title, std::string colour, int point = 0);

/// Joined points with a band of errors for each curve. The table has a column "variant". Throws
/// AnalysisError if two curves have the same title.
std::vector<Series> series_of(std::span<const Curve> curves, const SeriesColumns& columns);

/// One quantity of a panel: its columns are NAME_mean (or NAME_rms) and NAME_standard_error, with
/// the unit at the end where there is one.
struct MeasureColumn {
  std::string name;
  std::string unit;  ///< as part of a column's name: "d", "percent" or ""
  std::string measure;
  double least = -infinite;  ///< lower values count as this
  std::string known = {};    ///< left out where this measure is unknown; "" for none
  bool rms = false;          ///< the root mean square over runs in place of the mean

  double of(const Measures& measures) const;
  RunStatistics over(std::span<const double> values) const;  ///< one value of each run
};

/// Name of the column of a statistic, "mean" or "standard_error". "mean" is the root mean square if
/// `rms`.
std::string column_name(const MeasureColumn& measure, const char* statistic);
void add_columns(const MeasureColumn& measure, std::vector<std::string>& columns);
void add_values(const RunStatistics& statistics, TableRow& row);
/// The columns to draw: x, the measure's mean with its error, and the number of runs.
SeriesColumns columns_against(std::string x, const MeasureColumn& y);

/// Of phi at the onset.
inline const MeasureColumn onset_column = {"onset_phi", "", "onset_size_phi"};

/// A row for each variant and cycle. The first measure is drawn.
FigureTable against_cycle(const std::string& name, std::span<const Curve> curves,
                          std::span<const MeasureColumn> measures, Axis y);

/// A row for each variant and bin of phi.
FigureTable against_phi(const std::string& name, std::span<const Curve> curves,
                        const MeasureColumn& measure, Axis y);

}  // namespace shearcell
