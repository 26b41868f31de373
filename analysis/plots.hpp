// SPDX-License-Identifier: GPL-3.0-or-later
// Plots and claims that a manifest states.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/claims.hpp"
#include "analysis/frame.hpp"
#include "core/named.hpp"

namespace shearcell {

/// What a plot draws: the mean or the root mean square over runs with its error, every run, or
/// every value as a point.
enum class Show : std::uint8_t { mean, rms, traces, scatter };
template <>
inline constexpr auto kNames<Show> = names_in_order<Show>("mean", "rms", "traces", "scatter");

/// Logarithmic axes of a plot.
enum class LogAxes : std::uint8_t { none, x, y, xy };
template <>
inline constexpr auto kNames<LogAxes> = names_in_order<LogAxes>("none", "x", "y", "xy");

/// How the curve of the variants with these parameters is drawn. Styles that are not stated follow
/// from the swept values (styles.hpp).
struct SeriesSpec {
  nlohmann::json where;     ///< parameters and their values
  std::string column = {};  ///< instead of `where`: the name of one of several y
  std::string label = {};   ///< with formulas (formula)
  std::string colour = {};  ///< "#rrggbb", or one of colour_names
  std::string marker = {};  ///< one of marker_names
};

/// A further column of a plot's CSV.
struct ColumnSpec {
  std::string measure;
  std::string name = {};  ///< name of the column, without unit; "": the measure's name
};

/// A black point on each curve, at the means of two measures of the whole run.
struct MarkSpec {
  std::string x, y;
  std::string label = {};
};

struct PlotSpec {
  std::string name;
  /// A measure of a checkpoint (a number or a curve) or of a run. Or an expression: of numbers of a
  /// checkpoint and parameters, or of measures of a run and parameters.
  std::string y;
  /// Selects runs by has_parameters(), and by "cycle" checkpoints.
  nlohmann::json where = nlohmann::json::object();
  /// Parameters and their values that single out one variant. The plot then shows `y` minus the `y`
  /// of that variant's run with the same packing at the same cycle. Empty: `y` itself.
  nlohmann::json minus = nlohmann::json::object();
  /// "cycle", a number of a checkpoint, a parameter, a number of the whole run (drawn at its mean
  /// over the runs of each variant), or an expression of these; unused by curves.
  std::string x = "cycle";
  std::string by = {};      ///< a curve for each value of it; "": for each variant
  std::string figure = {};  ///< plots and claims of one figure are drawn together; "": alone
  std::string panel = {};   ///< a panel for each value of this parameter
  Show show = Show::mean;
  LogAxes log = LogAxes::none;
  std::string xlabel = {}, ylabel = {};  ///< with formulas; "": from the names
  std::vector<SeriesSpec> series = {};
  std::vector<PublishedSpec> published = {};
  /// Further columns of the CSV. If y is a number of the run, measures of checkpoints are taken at
  /// the run's first checkpoint. The first `drawn` of these columns have curves, too.
  std::vector<ColumnSpec> also = {};
  std::size_t drawn = 0;
  std::optional<MarkSpec> mark = {};
  /// The cycle of a curve measure, or of `y` against a parameter; default: the last cycle that all
  /// runs have.
  std::optional<std::uint64_t> cycle = {};
  /// Cycles first to last, with the checkpoints at their phases; with traces and scatter only.
  std::optional<std::array<std::uint64_t, 2>> cycles = {};
  std::string column = {};  ///< name of y's column, without unit; "": the measure's name
  std::string x_symbol = {}, x_unit = {};  ///< of a parameter as x; "" for none
  /// The plot is of a shipped manifest, and the user's manifest lists its figure. Labels of the
  /// user's manifest then replace those of `series`. Styles of `series` are used only if the runs
  /// differ in no other parameters.
  bool listed = false;
};

/// The figure of the plot: as stated, or its name.
inline const std::string& figure_of(const PlotSpec& plot) {
  return plot.figure.empty() ? plot.name : plot.figure;
}

/// The name of a column that occurs twice in the CSV of means against the cycle; "" if there is
/// none.
std::string repeated_column(const PlotSpec& plot);

/// Whether the plot draws every cycle, not one of them.
bool draws_every_cycle(const PlotSpec& plot);

/// Gives variants, which are objects of keys and values, names for people.
using NameVariants = std::function<std::map<nlohmann::json, std::string>(
    const std::vector<nlohmann::json>& variants)>;

/// The figure of a plot: one panel NAME, or with PlotSpec::panel panels NAME_1, NAME_2, ... with
/// equal ranges. Against phi, runs are averaged in bins of phi; against another measure, at each
/// cycle; against a parameter, at one cycle. A curve measure is drawn against its own x at one
/// cycle. `names` gives curves their titles; without it they are called "fluid=still".
Figure plot_figure(const PlotSpec& plot, const NameVariants& names = {});

/// "2 variants have fluid=still", "no variant has fluid=still".
std::string variants_have(std::size_t variants, const nlohmann::json& where);

/// A sentence on why `minus` does not name exactly one variant; "" if it does. `variants`: how many
/// variants have its values.
std::string problem_of_minus(const PlotSpec& plot, std::size_t variants);

/// The figures of a manifest, in the order of their first plots and claims. `question` is the title
/// of figures with several parts.
std::vector<Figure> own_figures(std::span<const PlotSpec> plots, std::span<const ClaimSpec> claims,
                                const NameVariants& names, const std::string& question = {});

}  // namespace shearcell
