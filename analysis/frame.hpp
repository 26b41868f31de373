// SPDX-License-Identifier: GPL-3.0-or-later
// The frame: runs with their measured checkpoints. A row is a checkpoint of a run, or a run as a
// whole; its columns are identifiers, parameters, measures and expressions of these. Tables, plots,
// claims and computed figures read the frame; nothing changes it after it was collected
// (experiments/figures/collect.hpp).
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/expression.hpp"
#include "analysis/measures.hpp"
#include "core/named.hpp"
#include "provenance/records.hpp"

namespace shearcell {

/// A checkpoint with its measures.
struct CheckpointMeasures : CheckpointRecord {
  Measures measures = {};
  /// Names of the providers without a result, because this checkpoint or an earlier one could not
  /// be read.
  std::vector<std::string> lacking = {};
};

/// A run with its rows.
struct FrameRun : Run {
  /// Id of the stage that settled its packing, or SHA-256 of the file from which its packing was
  /// made;
  /// "" without either.
  std::string packing = {};
  nlohmann::json parameters = {};  ///< parameters of all its stages, by manifest key
  std::vector<CheckpointMeasures> checkpoints = {};  ///< by step
  double end = 0;  ///< last cycle of the run so far, even if the frame lacks its checkpoint
  /// Computing time up to its end; known if cost_provider was asked for.
  double core_time_s = std::numeric_limits<double>::quiet_NaN();
};

using RunGroup = std::span<const FrameRun* const>;

struct Frame {
  std::vector<FrameRun> runs;
  /// Swept values of all variants of the experiments at this scale, with or without runs. Colours
  /// of variants follow from them. Empty: the variants of `runs`.
  std::vector<nlohmann::json> variants;
  /// Places and parameters of the planned runs that have not ended.
  std::vector<FrameRun> pending = {};
  /// Seeds of the experiments at this scale in their order, and the planned looks, in numbers of
  /// these seeds. Without seeds every claim is decided by the runs that there are.
  std::vector<std::uint64_t> seeds = {};
  std::vector<std::size_t> looks = {};

  Frame(std::vector<FrameRun> all = {}, std::vector<nlohmann::json> of = {})  // NOLINT
      : runs(std::move(all)), variants(std::move(of)) {}
  Frame(std::span<const FrameRun> all) : runs(all.begin(), all.end()) {}  // NOLINT
};

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
  /// If the run ended before the event: the number is larger than this (censored). NaN: unknown.
  double above = std::numeric_limits<double>::quiet_NaN();

  /// Not a number if it is missing.
  double or_nan() const;
};
/// The value, which is missing if it is not finite.
RunValue measured(double value);

// --- Columns ---

/// The value of a parameter, swept or not; null if the run has no such key.
nlohmann::json parameter_of(const FrameRun& run, const std::string& key);
/// The value of a parameter as a number; NaN if it is not a number.
double number_of(const FrameRun& run, const std::string& key);

/// A column of numbers: "cycle", a measure of a checkpoint or of the whole run, a parameter, or an
/// expression of these (expression.hpp). One thread at a time may read it.
class NumberColumn {
 public:
  explicit NumberColumn(std::string text);
  /// The number in the row of the checkpoint, or in the row of the whole run if `checkpoint` is
  /// null; NaN if the row has no such number.
  double operator()(const FrameRun& run, const CheckpointMeasures* checkpoint = nullptr) const;

 private:
  std::string text_;
  Evaluate evaluate_;  // empty of a single name
};

/// Whether a column is one number of a run: it names neither the cycle nor a measure of
/// checkpoints.
bool is_of_run(std::string_view column);
/// Whether a column names a measure of the whole run, which differs between runs of one variant.
bool is_measured_of_run(std::string_view column);
/// Names of the providers of the measures that the columns name.
std::vector<std::string> providers_of(std::span<const std::string> columns);

/// The checkpoint at a cycle; null if there is none.
const CheckpointMeasures* checkpoint_at(const FrameRun& run, double cycle);

// --- Selections and groups ---

/// Whether the run has these parameters: {"fluid": "still", "amplitude_rad": [0.04, 0.05],
/// "grains": {"min": 6000}}. A list takes any of its values, a range has `min`, `max` or both.
/// Numbers may differ by a millionth, since a manifest may round them.
bool has_parameters(const FrameRun& run, const nlohmann::json& where);
/// The runs with these parameters. If they belong to several variants, runs that `run --engine`
/// added are left out.
std::vector<const FrameRun*> runs_with(const nlohmann::json& where, std::span<const FrameRun> runs);

/// Whether a value is `wanted`: equal to it, one of a list, or in a range.
bool is_within(const nlohmann::json& value, const nlohmann::json& wanted);

std::vector<const FrameRun*> pointers(std::span<const FrameRun> runs);
/// Runs by the value of a parameter, ascending. Runs without a number are left out.
std::map<double, std::vector<const FrameRun*>> runs_by(std::span<const FrameRun> runs,
                                                       const std::string& parameter);
/// The number of variants among the runs.
std::size_t count_variants(RunGroup runs);

/// The id of the packing that the run descends from; the id of the run if there is no packing. Runs
/// of one packing are not independent.
const std::string& packing_of(const FrameRun& run);
/// The runs of a group by packing_of(), in the order of the group.
using PackingGroups = nlohmann::ordered_map<std::string, std::vector<const FrameRun*>>;
PackingGroups by_packing(RunGroup group);
/// Averages the values of runs, one per run, over the runs of each packing; in the order of the
/// runs. Values that are not finite are left out.
std::vector<double> over_packings(RunGroup runs, std::span<const double> values);
/// Mean over runs of the measure at their first checkpoint; not a number if there is none.
double at_start(RunGroup runs, const std::string& measure);

/// "fluid=still, walls=rough" of parameters and their values.
std::string words_of(const nlohmann::json& values);

/// Returns those of `keys` that distinguish the variants: each of them varies, and without it two
/// variants would be equal. Of keys that advance together only the first is returned. `variants`
/// are objects of swept keys and values.
std::vector<std::string> keys_telling_apart(std::span<const nlohmann::json> variants,
                                            std::vector<std::string> keys);
/// The swept keys that distinguish the variants, by keys_telling_apart(). Of keys that advance
/// together with `first`, `first` is returned.
std::vector<std::string> varied_keys(std::span<const nlohmann::json> variants,
                                     std::string_view first = "");
/// The swept keys that distinguish the variants of the runs.
std::vector<std::string> varied_keys(std::span<const FrameRun> runs, std::string_view first = "");

/// With one curve for each set of values of `keys`: the name of a swept key over whose values a
/// curve would average; "" without such a key.
std::string averaged_key(std::span<const FrameRun> runs, const std::vector<std::string>& keys);
/// Throws UsageError if averaged_key() finds a key for curves by `keys`. Keys that change together
/// with `keys` are allowed. The message ends with `remedy`.
void require_told_apart(const std::string& figure, std::span<const FrameRun> runs,
                        const std::vector<std::string>& keys, const std::string& remedy);

}  // namespace shearcell
