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

/// How the curve of the variants with these parameters is drawn. What is not stated follows from
/// what varies (analysis/figures/curves.hpp).
struct SeriesSpec {
  nlohmann::json where;     ///< parameters and their values
  std::string label = {};   ///< with formulas (formula)
  std::string colour = {};  ///< "#rrggbb", or one of colour_names
  std::string marker = {};  ///< one of marker_names
};

/// A further column of a plot's CSV.
struct ColumnSpec {
  std::string measure;
  std::string name = {};  ///< of the column, without unit; "": that of the measure
};

struct PlotSpec {
  std::string name;
  /// A measure (measures.hpp): a number, a curve, or of a run; or an expression of numbers and
  /// parameters, or of measures of a run and parameters.
  std::string y;
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
  std::vector<ColumnSpec> also = {};  ///< further scalar measures for the CSV, against the cycle
  /// The cycle of a curve measure, or of `y` against a parameter; default: the last cycle that all
  /// runs have.
  std::optional<std::uint64_t> cycle = {};
  /// Cycles first to last, with the checkpoints at their phases; with traces and scatter only.
  std::optional<std::array<std::uint64_t, 2>> cycles = {};
  std::string x_symbol = {}, x_unit = {};  ///< of a parameter as x; "" for none
  /// The plot is of a shipped manifest, and the user's manifest lists its figure. Labels of the
  /// user's manifest then replace those of `series`. Styles of `series` are used only if the runs
  /// differ in no other parameters.
  bool listed = false;
};

/// "fluid=still, walls=rough" of parameters and their values.
std::string words_of(const nlohmann::json& values);

/// The name of a column that occurs twice in the CSV of means against the cycle; "" if there is
/// none.
std::string repeated_column(const PlotSpec& plot);

/// Whether an axis of a plot is one number of a run: it names neither the cycle nor a measure of
/// checkpoints.
bool is_parameter(std::string_view axis);
/// Whether `x` names a measure of the whole run, which differs between runs of one variant.
bool is_measured_of_run(std::string_view x);

/// The number of variants among the runs.
std::size_t count_variants(RunGroup runs);

/// The runs with these parameters. If they belong to several variants, runs that `run --engine`
/// added are left out.
std::vector<const FigureRun*> runs_with(const nlohmann::json& where,
                                        std::span<const FigureRun> runs);

/// Returns a copy of the runs with the values of the expressions and run measures in `texts`. A
/// number of the whole run becomes one of its parameters; any other value becomes a measure of each
/// checkpoint.
std::vector<FigureRun> with_values(std::span<const FigureRun> runs,
                                   const std::vector<std::string>& texts);

/// Names of the providers of the measures in expressions (Figure::needs).
std::vector<std::string> needs_of(const std::vector<std::string>& texts);

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
