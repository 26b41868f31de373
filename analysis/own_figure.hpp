// SPDX-License-Identifier: GPL-3.0-or-later
// Plots and claims that a manifest states.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/named.hpp"

namespace shearcell {

struct Figure;

/// What a plot draws: the mean over runs with its error, or every run.
enum class Show : std::uint8_t { mean, traces };
template <>
inline constexpr auto kNames<Show> = names_in_order<Show>("mean", "traces");

/// Logarithmic axes of a plot.
enum class LogAxes : std::uint8_t { none, x, y, xy };
template <>
inline constexpr auto kNames<LogAxes> = names_in_order<LogAxes>("none", "x", "y", "xy");

/// What a claim says of the first variant: it has the same value, or a higher one.
enum class Relation : std::uint8_t { same, higher };
template <>
inline constexpr auto kNames<Relation> = names_in_order<Relation>("same", "higher");

struct PlotSpec {
  std::string name;
  std::string y;            ///< a measure (analysis/measures.hpp): a number, a curve, or of a run
  std::string x = "cycle";  ///< "cycle", a scalar measure, or a parameter; unused by curves
  std::string by = {};      ///< a curve for each value of it; "": for each variant
  Show show = Show::mean;
  LogAxes log = LogAxes::none;
  /// Of curves, or with a parameter as x; default: the last one that all runs have.
  std::optional<std::uint64_t> cycle = {};
  /// Cycles first to last, with the checkpoints at their phases; with traces only.
  std::optional<std::array<std::uint64_t, 2>> cycles = {};
  std::string x_symbol = {}, x_unit = {};  ///< of that parameter; "" for none

  bool operator==(const PlotSpec&) const = default;
};

struct ClaimSpec {
  std::string name;
  std::string compare;  ///< a scalar measure or a run measure
  /// The measure's mean over these cycles, first to last; nothing for a run measure.
  std::optional<std::array<std::uint64_t, 2>> cycles = {};
  std::array<nlohmann::json, 2> between;  ///< parameters and their values, of one variant each
  double margin = 0;                      ///< of onset_size_cycle, of log2 of the ratio
  Relation is = Relation::same;

  bool operator==(const ClaimSpec&) const = default;
};

/// "fluid=still, walls=rough" of parameters and their values.
std::string words_of(const nlohmann::json& values);

/// Whether the x of a plot is a parameter: neither "cycle" nor a scalar measure.
bool is_parameter(std::string_view x);

/// Whether the plot draws every cycle, not one of them.
bool draws_every_cycle(const PlotSpec& plot);

/// Gives variants, which are objects of keys and values, names for people.
using NameVariants = std::function<std::map<nlohmann::json, std::string>(
    const std::vector<nlohmann::json>& variants)>;

/// One panel NAME: the measure against `x`, as the supplement's figures are drawn. Against phi,
/// runs are averaged in bins; against another measure, at each cycle; a curve measure against its
/// own x, at one cycle; against a parameter, at one cycle or a number of the whole run. `names`
/// names curves that several variants share by what these have in common; without it they are
/// called "fluid=still".
Figure plot_figure(const PlotSpec& plot, const NameVariants& names = {});

/// Why the sides of a claim cannot be compared, a sentence each. `variants`: how many variants have
/// the values of each side; `same`: whether both are the same runs.
std::vector<std::string> problems_of_sides(const ClaimSpec& claim,
                                           const std::array<std::size_t, 2>& variants, bool same);

/// No panel and one verdict (analysis/claims.hpp), undecided if a side of `between` has no runs.
/// Its function throws UsageError with the first of problems_of_sides().
Figure claim_figure(const ClaimSpec& claim);

}  // namespace shearcell
