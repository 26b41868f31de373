// SPDX-License-Identifier: GPL-3.0-or-later
// The frame: runs with their measured checkpoints. A row is one checkpoint or one whole run.
// Columns are identifiers, parameters, measures and expressions of these. Tables, plots, claims and
// computed figures read the frame. Only experiments/figures/collect.hpp changes it.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/censored.hpp"
#include "analysis/expression.hpp"
#include "analysis/measures.hpp"
#include "core/named.hpp"
#include "provenance/records.hpp"

namespace shearcell {

struct CheckpointMeasures : CheckpointRecord {
  Measures measures = {};
  /// Providers that have no result because this or an earlier checkpoint could not be read.
  std::vector<std::string> lacking = {};
};

struct FrameRun : Run {
  /// Id of the stage that settled the packing, or SHA-256 of the file that the packing was read
  /// from; "" if there is neither.
  std::string packing = {};
  nlohmann::json parameters = {};  ///< parameters of all stages of the run, by manifest key
  std::vector<CheckpointMeasures> checkpoints = {};  ///< in the order of steps
  double end = 0;  ///< last cycle of the run so far; the frame may lack a checkpoint at this cycle
  /// Computing time of the run up to `end`; NaN unless the results of cost_provider were requested.
  double core_time_s = std::numeric_limits<double>::quiet_NaN();
};

using RunGroup = std::span<const FrameRun* const>;

struct Frame {
  std::vector<FrameRun> runs;
  /// Swept values of all variants of the experiments at this scale, including variants without
  /// runs. They determine the colours of variants. If empty, the variants of `runs` are used.
  std::vector<nlohmann::json> variants;
  /// Planned runs that have not ended. Only their variants, seeds, names and parameters are used.
  std::vector<FrameRun> pending = {};
  /// Seeds of the experiments at this scale, in order. If empty, each verdict uses all runs in the
  /// frame.
  std::vector<std::uint64_t> seeds = {};
  /// Number of seeds n of each planned look (interim analysis). The look uses the runs of the first
  /// n seeds that have a finished or planned run.
  std::vector<std::size_t> looks = {};

  Frame(std::vector<FrameRun> all = {}, std::vector<nlohmann::json> of = {})  // NOLINT
      : runs(std::move(all)), variants(std::move(of)) {}
  Frame(std::span<const FrameRun> all) : runs(all.begin(), all.end()) {}  // NOLINT
};

/// Why a number is missing for a run: there is no checkpoint at the cycle, the run ends before the
/// cycle or begins after it, the number is undefined, such as phi without interior grains, or it is
/// an expression of which a censored measure gives no lower limit.
enum class Missing { nothing, checkpoint, too_short, too_late, undefined, unbounded };
template <>
inline constexpr auto kNames<Missing> = names_in_order<Missing>("", "no checkpoint", "ends before",
                                                                "begins after", "undefined",
                                                                "no lower limit");

/// One number of a run, or the reason why it is missing.
struct RunValue {
  double value = 0;
  Missing missing = Missing::nothing;
  /// For a censored run (it ended before the event): lower limit of the value. NaN: no limit.
  double above = std::numeric_limits<double>::quiet_NaN();

  double or_nan() const;
};
/// Makes a RunValue. A value that is not finite is missing (`undefined`).
RunValue measured(double value);

/// Width of the bins in phi. Runs reach the same phi at different cycles, so they are averaged at
/// equal phi. Bins begin at integer multiples of this width. [choice]
inline constexpr double phi_bin = 0.002;

// --- Columns ---

/// The value of a parameter, swept or not; null if the run has no such key.
nlohmann::json parameter_of(const FrameRun& run, const std::string& key);
/// The value of a parameter as a number; NaN if it is not a number.
double number_of(const FrameRun& run, const std::string& key);

/// A column of numbers: "cycle", a measure of a checkpoint or of a whole run, a parameter, or an
/// expression of these (expression.hpp). Only one thread at a time may evaluate it.
class NumberColumn {
 public:
  explicit NumberColumn(std::string text);
  /// The value of the column at the checkpoint, or for the whole run if `checkpoint` is null. NaN
  /// if there is no such value.
  double operator()(const FrameRun& run, const CheckpointMeasures* checkpoint = nullptr) const;
  /// The number of a column that is_of_run(). If one measure in an expression is censored and the
  /// expression increases with it, the number is censored, too. If the expression does not increase
  /// or several measures are censored, the number is `unbounded`.
  RunValue of_run(const FrameRun& run) const;

 private:
  std::string text_;
  std::vector<std::string> names_;  // in the expression
  Evaluate evaluate_;               // empty if text_ is a single name
};

/// Whether a column has one number per run: it uses neither the cycle nor a checkpoint's measure.
bool is_of_run(std::string_view column);
/// Whether a column is a measure of a whole run. Unlike a parameter, such a measure differs between
/// runs of one variant.
bool is_measured_of_run(std::string_view column);
/// What a run must reach to have a number in a column of measures of the run: "the onset". For a
/// column without such measures: the column.
std::string reach_of(std::string_view column);
/// Names of the providers that compute the measures in the columns.
std::vector<std::string> providers_of(std::span<const std::string> columns);

/// The checkpoint at a cycle; null if there is none.
const CheckpointMeasures* checkpoint_at(const FrameRun& run, double cycle);

// --- Selections and groups ---

/// Whether the parameters of the run match `where`, such as {"fluid": "still", "amplitude_rad":
/// [0.04, 0.05], "grains": {"min": 6000}}. A list matches any of its values. A range has `min`,
/// `max` or both. The relative tolerance of numbers is 1e-6, since a manifest may round them;
/// whole numbers must be equal.
bool has_parameters(const FrameRun& run, const nlohmann::json& where);
/// The runs whose parameters match `where`. If several experiments share a matching run, only the
/// FrameRun of the first of these experiments is returned.
std::vector<const FrameRun*> all_runs_with(const nlohmann::json& where,
                                           std::span<const FrameRun> runs);
/// As all_runs_with(), except that runs added by `run --engine` are left out if the remaining runs
/// belong to exactly one variant.
std::vector<const FrameRun*> runs_with(const nlohmann::json& where, std::span<const FrameRun> runs);

/// Whether a value matches `wanted`, which is a value, a list of values or a range.
bool is_within(const nlohmann::json& value, const nlohmann::json& wanted);

std::vector<const FrameRun*> pointers(std::span<const FrameRun> runs);
/// Groups runs by a parameter, ascending. Runs whose parameter is not a number are left out.
std::map<double, std::vector<const FrameRun*>> runs_by(std::span<const FrameRun> runs,
                                                       const std::string& parameter);
std::size_t count_variants(RunGroup runs);
std::set<std::string_view> stage_ids(RunGroup runs);
/// The name of the variant that all runs belong to; "" if it has no name, or if the runs do not
/// belong to one variant.
std::string shared_name(RunGroup runs);

/// Id of the packing from which the run started; without a packing, id of the run. Runs with the
/// same packing are not independent.
const std::string& packing_of(const FrameRun& run);
/// The runs of each packing (packing_of()).
using PackingGroups = nlohmann::ordered_map<std::string, std::vector<const FrameRun*>>;
/// Groups runs by packing. Packings, and the runs of each packing, keep their order in `group`.
PackingGroups by_packing(RunGroup group);
/// Mean of the runs of each packing. Packings are in the order of the runs.
using PackingMeans = nlohmann::ordered_map<std::string, CensoredValue>;
/// Averages `values` (one per run) over the runs of each packing. A mean is censored if one of the
/// averaged values is censored. Values that are not finite are left out.
PackingMeans means_by_packing(RunGroup runs, std::span<const CensoredValue> values);
std::vector<CensoredValue> values_of(const PackingMeans& means);
std::vector<CensoredValue> over_packings(RunGroup runs, std::span<const CensoredValue> values);
/// The measure at the first checkpoint of each run, averaged over runs; NaN without checkpoints.
double at_start(RunGroup runs, const std::string& measure);

/// Writes parameters and their values as a text such as "fluid=still, walls=rough". A list is
/// written as "fluid=still or cell", a range as "grains >= 600" or "amplitude_rad 0.05 to 0.1".
std::string words_of(const nlohmann::json& values);

/// Reduces `keys` to the keys that are needed to distinguish all variants. If several keys
/// change together, only the first is kept. `variants` are objects of swept keys and values.
std::vector<std::string> keys_telling_apart(std::span<const nlohmann::json> variants,
                                            std::vector<std::string> keys);
/// The swept keys that keys_telling_apart() keeps. If several keys change together and one of them
/// is `first`, then `first` is kept.
std::vector<std::string> varied_keys(std::span<const nlohmann::json> variants,
                                     std::string_view first = "");
/// The swept values of each run, for varied_keys().
std::vector<nlohmann::json> swept_of(RunGroup runs);

/// A plot draws one curve for each combination of values of `keys`. If a curve would average over
/// the values of another swept key, returns this key, else "". Ignores keys that change only
/// together with `keys`.
std::string averaged_key(RunGroup runs, const std::vector<std::string>& keys);
/// Throws UsageError if `averaged`, from averaged_key(), is not "". The message ends with `remedy`.
void require_told_apart(const std::string& figure, RunGroup runs, const std::string& averaged,
                        const std::string& remedy);

}  // namespace shearcell
