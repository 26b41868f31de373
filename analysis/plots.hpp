// SPDX-License-Identifier: GPL-3.0-or-later
// Plots and claims that a manifest defines.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/claims.hpp"
#include "analysis/frame.hpp"
#include "core/named.hpp"

namespace shearcell {

/// What a plot draws. `mean`, `rms`: the mean or the root mean square over runs, with its error.
/// `traces`: a line for each run. `scatter`: a point for each value.
enum class Show : std::uint8_t { mean, rms, traces, scatter };
template <>
inline constexpr auto kNames<Show> = names_in_order<Show>("mean", "rms", "traces", "scatter");

enum class LogAxes : std::uint8_t { none, x, y, xy };
template <>
inline constexpr auto kNames<LogAxes> = names_in_order<LogAxes>("none", "x", "y", "xy");

/// Label, colour and symbol (`marker`) of the curve whose variants have the parameter values in
/// `where`. If the label is empty, the curve is named after its variants. If the colour or symbol
/// is empty, it is chosen from the swept values (styles.hpp).
struct SeriesSpec {
  nlohmann::json where;     ///< parameter -> value
  std::string column = {};  ///< instead of `where`: the name of a column, if `y` has several
  std::string label = {};   ///< may contain formulas, see formula()
  std::string colour = {};  ///< "#rrggbb", or one of colour_names
  std::string marker = {};  ///< one of marker_names
};

/// A column of a plot's CSV.
struct ColumnSpec {
  std::string measure;
  std::string name = {};  ///< name of the column, without unit; if empty, the measure's name
};

/// A black point on each curve. Its coordinates are two measures that have one value for each run.
/// These values are averaged over the runs of the curve.
struct MarkSpec {
  std::string x, y;
  std::string label = {};
};

struct PlotSpec {
  std::string name;
  /// The columns of the CSV. The first column is y: a measure of a checkpoint (a number or a
  /// curve), a measure of the whole run, or an expression of parameters and measures. An expression
  /// cannot contain a curve. It cannot contain measures of a checkpoint together with measures of
  /// the run. If x and y have one value for each run, columns that are not drawn are evaluated at
  /// the first checkpoint of the run.
  std::vector<ColumnSpec> columns;
  std::size_t drawn = 1;  ///< number of columns that get a curve
  /// Selects runs by has_parameters(). The key "cycle" selects checkpoints.
  nlohmann::json where = nlohmann::json::object();
  /// If not empty, these parameter values select one variant. The plot then shows differences: `y`
  /// minus the `y` of the run of this variant with the same packing, at the same cycle.
  nlohmann::json minus = nlohmann::json::object();
  /// "cycle", a parameter, a measure (of a checkpoint or of the run), or an expression of these. A
  /// measure of the run is averaged over the runs of each variant. Ignored if y is a curve.
  std::string x = "cycle";
  std::string by = {};      ///< one curve per value of this parameter; if empty, one per variant
  std::string figure = {};  ///< name of the plot's figure; if empty, the name of the plot
  std::string panel = {};   ///< one panel for each value of this parameter
  Show show = Show::mean;
  LogAxes log = LogAxes::none;
  std::string xlabel = {}, ylabel = {};  ///< may contain formulas; if empty, made from x and y
  std::vector<SeriesSpec> series = {};
  std::vector<PublishedSpec> published = {};
  std::optional<MarkSpec> mark = {};
  /// The cycle that is drawn if y is a curve, or if x has one value for each run. If empty, the
  /// last cycle that all runs have.
  std::optional<std::uint64_t> cycle = {};
  /// First and last cycle to draw, for traces and scatter. All checkpoints in between are drawn.
  std::optional<std::array<std::uint64_t, 2>> cycles = {};
  std::string x_symbol = {}, x_unit = {};  ///< of the x axis, if x is a parameter
  /// True if the plot is from a shipped manifest and a user's manifest lists the plot's figure.
  /// Labels in the user's manifest then replace the labels in `series`. The styles in `series` are
  /// then used only if each parameter in which the curves differ is in a SeriesSpec::where.
  bool listed = false;

  const std::string& y() const { return columns.front().measure; }
};

inline const std::string& figure_of(const PlotSpec& plot) {
  return plot.figure.empty() ? plot.name : plot.figure;
}

/// The name of a column that would occur twice in the CSV of means; "" if all names differ.
std::string repeated_column(const PlotSpec& plot);

/// Whether the plot draws all cycles instead of a single cycle.
bool draws_every_cycle(const PlotSpec& plot);

/// The plots of a manifest; null: none.
using Plots = std::shared_ptr<const std::vector<PlotSpec>>;

/// A run that a plot draws.
struct Selected {
  const FrameRun* run;
  /// The runs that PlotSpec::minus selects and that have the same packing as `run`. The mean of
  /// their values is subtracted.
  std::vector<const FrameRun*> partners = {};
  std::vector<const CheckpointMeasures*> checkpoints = {};
};

struct PlotRuns {
  std::vector<Selected> drawn = {};
  std::vector<const FrameRun*> subtracted = {};  ///< runs that PlotSpec::minus selects
  /// Runs that are left out, because no run in `subtracted` has the same packing.
  std::vector<const FrameRun*> alone = {};
};

/// The runs of a list whose items have a member `run`.
template <class Items>
std::vector<const FrameRun*> runs_of(const Items& items) {
  std::vector<const FrameRun*> runs;
  for (const auto& item : items) runs.push_back(item.run);
  return runs;
}

/// Selects the runs and checkpoints that the plot draws. If PlotSpec::minus is set, a checkpoint is
/// selected only if one of Selected::partners has a y at the same cycle. This condition does not
/// apply if y has one value per run.
PlotRuns selected_by(const PlotSpec& plot, std::span<const FrameRun> runs);

/// Returns a swept key that has several values within one curve of these runs, so that the curve
/// would average over these values; "" if there is none.
std::string averaged_by(const PlotSpec& plot, RunGroup runs);

/// Returns readable names of variants. A variant is an object of keys and values.
using NameVariants = std::function<std::map<nlohmann::json, std::string>(
    const std::vector<nlohmann::json>& variants)>;

/// The figure of a plot. It has one panel NAME; with PlotSpec::panel it has panels NAME_1, NAME_2,
/// ... with equal ranges. Runs are averaged in bins of phi if x is phi, at each cycle if x is
/// another measure, and at one cycle if x is a parameter. A measure that is a curve is drawn at one
/// cycle. `names` gives the titles of curves; without it a title has the form "fluid=still".
/// `others`: the plots of the same manifest. If one of them states a colour or symbol for a
/// variant, this plot uses it for the same variant.
Figure plot_figure(const PlotSpec& plot, const NameVariants& names = {}, const Plots& others = {});

/// Words for a message: "2 variants have fluid=still" or "no variant has fluid=still".
std::string variants_have(std::size_t variants, const nlohmann::json& where);

/// A sentence on why `minus` does not select exactly one variant; "" if it does. `variants`: number
/// of variants with the values of `minus`.
std::string problem_of_minus(const PlotSpec& plot, std::size_t variants);

/// The axis of "cycle", a measure, a parameter or an expression.
Axis axis_of(const std::string& column);

/// The figures of a manifest: first the figures with plots, then the figures with claims only, both
/// in the order of the manifest. `question` is the title of a figure with several parts.
std::vector<Figure> own_figures(std::span<const PlotSpec> plots, std::span<const ClaimSpec> claims,
                                const NameVariants& names, const std::string& question = {});

}  // namespace shearcell
