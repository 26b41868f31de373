// SPDX-License-Identifier: GPL-3.0-or-later
// A figure turns measured runs into tables and verdicts. The same runs give the same bytes.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/chart.hpp"
#include "analysis/measures.hpp"
#include "analysis/verdict.hpp"
#include "provenance/records.hpp"

namespace shearcell {

/// A checkpoint and what was measured on it.
struct CheckpointMeasures : CheckpointRecord {
  Measures measures = {};
  /// Names of the providers without a result, because this checkpoint or an earlier one could not
  /// be read.
  std::vector<std::string> lacking = {};
};

/// A run with the checkpoints that a figure or a table takes.
struct FigureRun : Run {
  /// Id of the stage that settled its packing, or SHA-256 of the file that all packings of its
  /// seeds are made of; "" if there is neither.
  std::string packing = {};
  nlohmann::json parameters = {};  ///< of all its stages, by their keys in a manifest
  std::vector<CheckpointMeasures> checkpoints = {};  ///< by step
  double end = 0;  ///< last cycle of the run so far, also if the figure leaves it out
  /// Computing time up to its end; known to figures that need the provider "cost".
  double core_time_s = std::numeric_limits<double>::quiet_NaN();
};

using RunGroup = std::span<const FigureRun* const>;

/// Why a run has no number: it lacks the checkpoint of the cycle, ends before the cycle, begins
/// after the cycle, or has no such quantity (`undefined`, as phi without interior grains).
enum class Missing { nothing, checkpoint, too_short, too_late, undefined };
template <>
inline constexpr auto kNames<Missing> = names_in_order<Missing>("", "no checkpoint", "ends before",
                                                                "begins after", "undefined");

/// One number of a run.
struct RunValue {
  double value = 0;
  Missing missing = Missing::nothing;

  /// Not a number if it is missing.
  double or_nan() const;
};
/// The value, which is missing if it is not finite.
RunValue measured(double value);

/// The panels of a figure in order, and the verdicts on its claims.
struct FigureResult {
  std::vector<FigureTable> tables;
  std::vector<Verdict> verdicts;
};

/// `table`: made of the runs of all experiments, each with its last checkpoint, which is not
/// measured; or made of other figures. `curves`: runs of one experiment, one curve for each
/// variant. `groups`: runs of one experiment, one mean for all variants with the same values of
/// `keys`.
enum class FigureForm { table, curves, groups };

/// A figure of the supplement, of plots and claims in a manifest, or of other figures (without
/// `make`).
struct Figure {
  std::string name;
  std::string title;
  std::function<FigureResult(std::span<const FigureRun> runs)> make;
  FigureForm form = FigureForm::curves;
  std::vector<std::string> keys = {};  ///< parameters that its curves compare
  /// Names of the providers (measures.hpp) that it needs besides "scalars".
  std::vector<std::string> needs = {};
  /// First and last cycle whose checkpoints the figure takes, also those at phases of a cycle.
  /// Without it the figure takes whole cycles only.
  std::optional<std::array<std::uint64_t, 2>> within = {};
  /// First and last cycle for which simulated measures are needed; default: all cycles.
  std::optional<std::array<std::uint64_t, 2>> simulated = {};
  /// Whether the figure uses the run, whose checkpoints are not read yet; empty: it uses all runs.
  std::function<bool(const FigureRun& run)> uses = {};
};

/// The value of a parameter, swept or not; null if the run has no such key.
nlohmann::json parameter_of(const FigureRun& run, const std::string& key);
/// The id of the packing that the run descends from; the id of the run if there is no packing. Runs
/// of one packing are not independent.
const std::string& packing_of(const FigureRun& run);
/// Averages the values of runs, one per run, over the runs of each packing; in the order of the
/// runs. Values that are not finite are left out.
std::vector<double> over_packings(RunGroup runs, std::span<const double> values);
/// The value of a parameter as a number; NaN if it is not a number.
double number_of(const FigureRun& run, const std::string& key);

std::vector<const FigureRun*> pointers(std::span<const FigureRun> runs);
/// Runs by the value of a parameter, ascending. Runs without a number are left out.
std::map<double, std::vector<const FigureRun*>> runs_by(std::span<const FigureRun> runs,
                                                        const std::string& parameter);
/// Mean over runs of the measure at their first checkpoint; not a number if there is none.
double at_start(RunGroup runs, const std::string& measure);

/// Whether the run has these parameters. Numbers may differ by a millionth, since a manifest may
/// round them.
bool has_parameters(const FigureRun& run, const nlohmann::json& where);

/// Returns those of `keys` that distinguish the variants: each of them varies, and without it two
/// variants would be equal. Of keys that advance together only the first is returned. `variants`
/// are objects of swept keys and values.
std::vector<std::string> keys_telling_apart(std::span<const nlohmann::json> variants,
                                            std::vector<std::string> keys);

/// If there is one curve for each set of values of `keys`: a swept key whose values differ within
/// one curve, so that the curve would average over them; "" if there is none.
std::string averaged_key(std::span<const FigureRun> runs, const std::vector<std::string>& keys);

/// Throws UsageError if averaged_key() finds a key for curves by `keys`. Keys that change together
/// with `keys` are allowed. The message ends with `remedy`.
void require_told_apart(const std::string& figure, std::span<const FigureRun> runs,
                        const std::vector<std::string>& keys, const std::string& remedy);

/// The swept keys that distinguish the variants of the runs, by keys_telling_apart(). Of keys that
/// advance together with `first`, `first` is returned.
std::vector<std::string> varied_keys(std::span<const FigureRun> runs, std::string_view first = "");

/// The figures with an analysis of their own (analysis/figures/), in the order of the supplement.
/// Manifests state the others (experiments/manifest/shipped.hpp).
std::span<const Figure> computed_figures();

}  // namespace shearcell
