// SPDX-License-Identifier: GPL-3.0-or-later
// An estimator computes one number of one or two groups of runs, with its confidence interval. To
// add an estimator, write a file in analysis/estimators/ and extend the list in estimators.cpp.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/censored.hpp"
#include "analysis/claims.hpp"
#include "analysis/statistics.hpp"

namespace shearcell {

/// A rule that gives each run one number.
struct Scalar {
  std::string name;   ///< "phi at cycle 10"
  std::string reach;  ///< what a run must reach to have the number: "cycle 10"
  std::function<RunValue(const FrameRun&)> of;
  bool relative = false;  ///< differences are relative: 0.03 is 3 %
};

struct Estimator {
  std::string_view name;      ///< name of the estimator in manifests
  std::string_view meaning;   ///< description in REFERENCE.md
  std::string_view key = {};  ///< a key that a claim must have to use this estimator; "": none
  /// Whether ClaimSpec::compare is a measure of the run or of checkpoints. Empty: both are allowed.
  std::optional<bool> of_run = false;
  bool over_variants = false;  ///< a group of runs may contain several variants
  /// Claims with this estimator always have one group. With any other estimator, a claim has one
  /// group only if it has a published number.
  bool one_side = false;
  bool compares_variants = false;  ///< the group must contain several variants
  /// Without a published number, the estimate for a single group is compared with this number.
  std::string_view reference = "0";
  /// Returns a Scalar, which computes one number per run. The estimate is the mean of these numbers
  /// or, for two groups, the difference of their means. If this pointer is null, `decide` gives the
  /// verdict.
  Scalar (*scalar)(const ClaimSpec& claim) = nullptr;
  /// Decides the claim if `scalar` is null. Group `b` is empty if the claim has only one group.
  Verdict (*decide)(const ClaimSpec& claim, const Claim& stated, RunGroup a, RunGroup b) = nullptr;
  /// Returns the estimated quantity in words, for sentences. If this pointer is null, Scalar::name
  /// is used.
  std::string (*words)(const ClaimSpec& claim) = nullptr;
};

/// All estimators that claims can use, in the order of REFERENCE.md.
std::span<const Estimator> all_estimators();
/// The estimator given by the claim's key `estimator` or, without this key, by its other keys.
const Estimator& estimator_of(const ClaimSpec& claim);
/// mean_over_cycles for a claim with `cycles`, mean_over_phi with `phi`, else number_of_the_run.
const Estimator& estimator_by_keys(const ClaimSpec& claim);

// Defined in analysis/estimators/.
extern const Estimator mean_over_cycles, mean_over_phi, number_of_the_run, change_over_cycles,
    relative_fall, slope_over_cycles, first_cycle_reached, waiting_ratio, slope_against,
    spread_of_variants, spread_ratio, pooled_difference, rate_exponent;

/// Whether the claim compares waiting times for an event, which may come after the end of a run.
bool compares_waits(const ClaimSpec& claim);

/// Decides the claim from the mean of `a` minus the mean of `b`. A run of `a` and a run of `b` are
/// a pair if they have the same packing. If is_enough() packings of each group are in a pair, the
/// pairs are compared by Student's t, and runs without a partner are left out. Otherwise all runs
/// are compared by Welch's test. The test ignores that values of one packing are correlated: if the
/// correlation is positive, the interval is too wide. Runs that end before an event are censored
/// (censored.hpp). A verdict needs least_runs runs or pairs, and is_enough() runs of each group
/// must have a number from `scalar`. [choice]
Verdict compare(const Claim& claim, const Scalar& scalar, RunGroup a, RunGroup b);

/// Decides the claim from the mean over runs minus the published number.
Verdict compare_with(const Claim& claim, const Scalar& scalar, RunGroup runs, double published);

/// Returns for each run the cycle of the onset by method 1 (onset.hpp). A run without an onset is
/// censored at its last cycle.
std::vector<CensoredValue> waits_for_onset(RunGroup runs);

/// Converts a run's value. If the run ended before the event, the result is censored and holds the
/// lower bound RunValue::above. It holds NaN if neither the value nor the bound is known.
CensoredValue censored_value(const RunValue& value);

/// Whether at least three quarters of `all` runs, or packings, are used. The others could bias a
/// verdict. [choice]
constexpr bool is_enough(std::size_t used, std::size_t all) {
  return 4 * used >= 3 * all;
}
/// The note of a verdict without is_enough().
inline constexpr const char* many_left_out = "more than a quarter of the runs are left out";

/// An empty table for the numbers that enter a verdict. Its columns are `group` (the run's
/// variant), `seed`, `packing`, and those in `columns`.
Table entered_with(const std::vector<TableColumn>& columns);
/// Adds a row for the run to `entered`. `values`: one for each column after column `packing`.
void enter(const FrameRun& run, const TableRow& values, Table& entered);

/// Takes the numbers of runs, and counts the runs that have none.
struct NumbersOfRuns {
  Scalar scalar;
  /// Converts the number of a run to the number that is compared, such as its logarithm.
  std::function<double(double value)> converted = std::identity();
  /// The number of each run. If a run is censored, there is a column `above`.
  Table entered = entered_with({"value", "missing"});
  std::size_t runs = 0, censored = 0;
  std::size_t not_positive = 0;                 ///< runs whose value has no logarithm
  std::map<Missing, std::size_t> missing = {};  ///< other runs without a number
  bool enough = true;                           ///< is_enough() of each group have a number

  /// Returns the number of the run, which is not finite if the run has none. `value`: its value
  /// before conversion. Adds a row to `entered`; `more` are its cells before `value`.
  CensoredValue take(const FrameRun& run, const RunValue& value, const TableRow& more = {});
  /// Takes the numbers of all runs in the group, and returns the mean of each packing.
  PackingMeans take(RunGroup group);
  /// Adds to the note how many runs have no number, by reason.
  void note_missing(std::string& note) const;
  /// Why an estimator that cannot use censored runs cannot be used; "" if it can.
  std::string why_not() const;
};

/// The note of a verdict that uses no runs.
inline constexpr const char* no_group =
    "the claim selects no runs, or its runs differ in a swept parameter that is not in the claim";

/// The name of a column, for use in sentences: Measure::words, or the column's text.
std::string words_of_column(const std::string& column);

}  // namespace shearcell
