// SPDX-License-Identifier: GPL-3.0-or-later
// What a figure is: measured runs in, tables with a plot script out. The same runs give the same
// bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/chart.hpp"
#include "analysis/crystallite_map.hpp"
#include "analysis/measures.hpp"
#include "analysis/verdict.hpp"

namespace shearcell {

struct CheckpointMeasures {
  double cycle = 0;  ///< cycles since the stage began
  std::uint64_t step = 0;
  std::string sha256;  ///< of the checkpoint file
  Measures measures;
  std::optional<CrystalliteMap> crystallites;  ///< where the figure needs them
  /// Observable of that name, which a stiffening records; NaN where there is none.
  double stiffness_N_per_m = std::numeric_limits<double>::quiet_NaN();
};

/// One run as a figure sees it.
struct FigureRun {
  std::string run_id;
  std::string experiment;
  std::string variant;    ///< the curve that it belongs to, as the manifest names it: "fluid=cell"
  nlohmann::json labels;  ///< the swept parameters of the run
  nlohmann::json parameters;  ///< all parameters, by their keys in a manifest
  std::uint64_t seed = 0;
  std::vector<CheckpointMeasures> checkpoints;  ///< by cycle
};

TableValue table_value(const std::optional<double>& value);

/// One panel: its data and how gnuplot draws them.
struct FigureTable {
  std::string name;                  ///< "S2a": letters, digits, '-' and '_'
  std::vector<std::string> columns;  ///< with the unit at the end where there is one
  TableRows rows;
  /// gnuplot commands that read the variable `data`, the table's CSV file; draw_svg() sets it, the
  /// terminal and the output.
  std::string plot;
  Chart chart;      ///< the same drawing for a reader who wants to zoom
  int width = 600;  ///< of the drawing [px]
  int height = 430;
};

/// RFC 4180 with a header row and "\n" line ends. Numbers carry nine significant digits, which is
/// more than any measure is good for and the same on every machine; a number that is not finite
/// leaves its field empty.
std::string to_csv(const FigureTable& table);

/// Writes FOLDER/NAME.csv and returns its path. Throws std::runtime_error when it cannot.
std::filesystem::path write_csv(const FigureTable& table, const std::filesystem::path& folder);

/// The panels of a figure in order, and what the supplement's claims of it come to.
struct FigureResult {
  std::vector<FigureTable> tables;
  std::vector<Verdict> verdicts;
};

/// Which measures of each checkpoint a figure takes. One that takes none has, of each run, the last
/// checkpoint alone, and nothing measured on it. Each has what those before it have.
enum class FigureNeeds { none, scalars, crystallites };

/// The runs of a figure: those of the experiments whose manifests ask for it, each run once; or of
/// every experiment, each run once in each.
enum class FigureScope { asking, every };

/// A figure of the supplement.
struct Figure {
  std::string_view name;
  std::string_view title;
  FigureNeeds needs;
  FigureResult (*make)(std::span<const FigureRun> runs);
  FigureScope scope = FigureScope::asking;
};

/// The value of a parameter, swept or not; null when the run does not say.
nlohmann::json parameter_of(const FigureRun& run, const std::string& key);
/// The same as a number; NaN when it is none.
double number_of(const FigureRun& run, const std::string& key);

/// Every figure that can be made, in the order of the supplement.
std::span<const Figure> all_figures();

/// The figure with that name ("S2"), or null.
const Figure* find_figure(std::string_view name);

}  // namespace shearcell
