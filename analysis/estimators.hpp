// SPDX-License-Identifier: GPL-3.0-or-later
// Estimators: one number of one or two groups of runs, with its interval. To add one, write its
// file in analysis/estimators/ and add it to the list in estimators.cpp.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/censored.hpp"
#include "analysis/claims.hpp"
#include "analysis/statistics.hpp"

namespace shearcell {

/// One number per run.
struct Scalar {
  std::string name;   ///< "phi at cycle 10"
  std::string reach;  ///< what a run must reach to have it: "cycle 10"
  std::function<RunValue(const FrameRun&)> of;
  bool relative = false;  ///< differences are relative: 0.03 is 3 %
};

struct Estimator {
  std::string_view name;      ///< in manifests
  std::string_view meaning;   ///< for the reference
  std::string_view key = {};  ///< the key that its claims must state; "": none
  /// Whether it compares a number of the whole run, not one of checkpoints; empty: either.
  std::optional<bool> of_run = false;
  bool over_variants = false;  ///< each of its groups may have several variants
  bool one_side = false;       ///< it takes one group and no published number
  /// The number of each run. The mean over runs, or a difference of means, is estimated. Null: see
  /// `decide`.
  Scalar (*scalar)(const ClaimSpec& claim) = nullptr;
  /// Used if `scalar` is null: the verdict on the groups. The second group is empty if the claim
  /// has a published number or takes one side.
  Verdict (*decide)(const ClaimSpec& claim, const Claim& stated, RunGroup a, RunGroup b) = nullptr;
  /// Words for what is estimated. Null: the name of its Scalar.
  std::string (*words)(const ClaimSpec& claim) = nullptr;
};

/// All estimators that claims can name, in the order of the reference.
std::span<const Estimator> all_estimators();
/// The estimator that the claim names, or that its keys imply.
const Estimator& estimator_of(const ClaimSpec& claim);
/// The estimator of one number of each run that `cycles` or `phi` of the claim implies.
const Estimator& estimator_by_keys(const ClaimSpec& claim);

// The estimators, a file each.
extern const Estimator mean_over_cycles, mean_over_phi, number_of_the_run, change_over_cycles,
    relative_fall, slope_over_cycles, first_cycle_reached, waiting_ratio, slope_against,
    spread_of_variants, spread_ratio, pooled_difference, rate_exponent;

/// Whether the claim compares waiting times: a run may end before the event.
bool compares_waits(const ClaimSpec& claim);

/// The statistic of the (cycle, value) points of a column at the whole cycles first .. last, all of
/// which the run must have.
using PointStatistic = double (*)(std::span<const std::pair<double, double>> points);
RunValue at_cycles(const FrameRun& run, const NumberColumn& column, double first, double last,
                   PointStatistic statistic);

/// Mean of a column over the checkpoints of cycles first .. last, all of which the run must have.
/// Sentences call it `name`.
Scalar over_cycles(const std::string& name, const std::string& column, double first, double last);

/// Mean of a column over a window of phi: the polygon through the means of the run's bins of phi
/// (binning.hpp), integrated over the window. Sentences call it `name`.
Scalar over_phi(const std::string& name, const std::string& column, double low, double high);

/// The difference a less b. If some runs share a packing, these pairs are compared by Student's t
/// and other runs are left out; otherwise the interval is Welch's. Runs that end before an event
/// are censored (censored.hpp). A verdict needs least_runs runs or pairs. Three quarters of each
/// group must have the number, and with pairs also a partner, lest the missing runs bias the
/// verdict. [choice]
Verdict compare(const Claim& claim, const Scalar& scalar, RunGroup a, RunGroup b);

/// The mean over runs less the published number.
Verdict compare_with(const Claim& claim, const Scalar& scalar, RunGroup runs, double published);

/// For each run the first cycle at which the column is at least `level`. A run without such a cycle
/// is censored at its last cycle.
std::vector<Waiting> waits_for(RunGroup runs, const std::string& column, double level);
/// For each run the cycle of the onset by method 1. A run without onset is censored at its last
/// cycle.
std::vector<Waiting> waits_for_onset(RunGroup runs);

/// Estimates log2 of the ratio of the waiting times in `a` and `b` by the log-rank test
/// (statistics.hpp). `waits` gives the waiting times of runs; runs that end before the event are
/// censored.
Verdict compare_waits(const Claim& claim, const std::string& event,
                      const std::function<std::vector<Waiting>(RunGroup)>& waits, RunGroup a,
                      RunGroup b);

/// Mean over the items of all packings, such as nuclei. The bootstrap draws packings with all their
/// items.
std::optional<Estimate> share(std::span<const std::vector<double>> packings);

/// The number of a run. If the run ended before the event: the censored number, which is larger
/// than the value. NaN if neither is known.
CensoredValue censored_value(const RunValue& value);

/// Averages the values of runs, one per run, over the runs of each packing; a mean is censored if
/// one of its values is. Values that are not finite are left out.
std::vector<CensoredValue> over_packings(RunGroup runs, std::span<const CensoredValue> values);

/// The name of a measure in sentences.
std::string words_of_column(const std::string& column);

/// An empty table of what entered a verdict: group (the run's variant), seed, packing, then these
/// columns.
Table entered_with(const std::vector<TableColumn>& columns);
/// Adds the row of a run, with the values of the columns after group, seed and packing.
void enter(const FrameRun& run, const TableRow& values, Table& entered);

}  // namespace shearcell
