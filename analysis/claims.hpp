// SPDX-License-Identifier: GPL-3.0-or-later
// Claims about runs: one number per run, compared between two groups of runs or with a published
// number; those that a manifest states, and those of the figures that are computed here.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "analysis/figure.hpp"
#include "analysis/onset.hpp"
#include "analysis/statistics.hpp"
#include "analysis/verdict.hpp"

namespace shearcell {

/// Published numbers: one value, or points.
struct PublishedSpec {
  std::string label;  ///< in the key of a plot
  std::string source;
  std::optional<double> value = {};
  double error = 0;                              ///< of the value; 0: not stated
  std::vector<std::vector<double>> points = {};  ///< x, y and perhaps the error of y
};

/// A claim that a manifest states.
struct ClaimSpec {
  std::string name;
  std::string figure = {};  ///< as PlotSpec::figure
  std::string compare;      ///< as PlotSpec::y, but no curve
  /// What is compared of a measure of checkpoints, one of three: its mean over cycles, first to
  /// last; its mean over a window of phi; the first cycle at which it has at least this value. None
  /// of them for a measure of the whole run.
  std::optional<std::array<std::uint64_t, 2>> cycles = {};
  std::optional<std::array<double, 2>> phi = {};
  std::optional<double> reaches = {};
  /// Two variants, each by parameters and their values. The second is empty if the first is
  /// compared with a published number.
  std::array<nlohmann::json, 2> between = {nlohmann::json::object(), nlohmann::json::object()};
  std::optional<PublishedSpec> published = {};
  /// In units of the measure; for onset_size_cycle and `reaches`, of log2 of the ratio. 0: the
  /// published number is a bound.
  double margin = 0;
  bool relative = false;       ///< the margin is of the relative difference
  std::string statement = {};  ///< what the claim says, for people; "": from its keys
  Relation is = Relation::same;
  bool optional = false;  ///< no verdict if a side has no runs
  /// As PlotSpec::listed. A side that is not one variant then has no runs; otherwise it is an
  /// error.
  bool listed = false;
};

/// One number per run.
struct Scalar {
  std::string name;   ///< "phi at cycle 10"
  std::string reach;  ///< what a run must reach to have it: "cycle 10"
  std::function<RunValue(const FigureRun&)> of;
  bool relative = false;  ///< differences are relative: 0.03 is 3 %
};

/// Mean of a measure over the checkpoints of cycles first .. last, all of which the run must have.
/// Sentences call the measure `name`.
Scalar over_cycles(const std::string& name, const std::string& measure, std::int64_t first,
                   std::int64_t last);

/// Mean of a measure over a window of phi: the polygon through the means of the run's bins of phi
/// (binning.hpp), integrated over the window. Sentences call the measure `name`.
Scalar over_phi(const std::string& name, const std::string& measure, double low, double high);

/// A measure of the whole run.
Scalar of_whole_run(const Measure& measure);

/// phi at the onset by method 1 (onset.hpp).
Scalar onset_phi();

/// Applies an increasing function to the value and the interval; the spread does not change.
Estimate mapped(Estimate estimate, const std::function<double(double)>& increasing);

/// The runs of a group by packing_of(), in the order of the group.
using PackingGroups = nlohmann::ordered_map<std::string, std::vector<const FigureRun*>>;
PackingGroups by_packing(RunGroup group);

/// a less b. Paired, by Student's t, if some runs share a packing; runs without a partner are then
/// left out. Otherwise Welch's interval. A verdict needs least_runs runs or pairs. So that runs
/// that end early do not bias it, three quarters of each group must have the number, and with pairs
/// also a partner. [choice]
Verdict compare(const Claim& claim, const Scalar& scalar, RunGroup a, RunGroup b);

/// The mean over runs less the published number.
Verdict compare_with(const Claim& claim, const Scalar& scalar, RunGroup runs, double published);

/// For each run the first cycle at which the measure is at least `level`; without one, the run's
/// last cycle, as censored.
std::vector<Waiting> waits_for(RunGroup runs, const std::string& measure, double level);
/// For each run the cycle of the onset by method 1, or its last cycle, as censored.
std::vector<Waiting> waits_for_onset(RunGroup runs);

/// Estimates log2 of the ratio of the waiting times in `a` and `b` by the log-rank test
/// (statistics.hpp). `waits` gives the waiting times of runs; runs that end before the event are
/// censored.
Verdict compare_waits(const Claim& claim, const std::string& event,
                      const std::function<std::vector<Waiting>(RunGroup)>& waits, RunGroup a,
                      RunGroup b);

/// Whether the claim compares waiting times: a run may end before the event.
bool compares_waits(const ClaimSpec& claim);

/// What the claim says. `sides`: names of the variants that it compares; "": there is only one.
Claim stated(const ClaimSpec& claim, const std::array<std::string, 2>& sides);

/// What a claim compares. The second side is empty if the claim has a published number.
struct ClaimSides {
  std::array<std::vector<const FigureRun*>, 2> runs;
  std::array<std::string, 2> names;  ///< for stated()
  bool lacks_one = false;            ///< a side has no runs
};
ClaimSides sides_of(const ClaimSpec& claim, std::span<const FigureRun> runs);

/// One sentence for each reason why the sides cannot be compared. With `planned`, runs of all
/// variants are given, and it is a reason if a side has none of them.
std::vector<std::string> problems_of_sides(const ClaimSpec& claim, const ClaimSides& sides,
                                           bool planned);

/// No panel and one verdict (analysis/claims.hpp), undecided if a side of `between` has no runs.
/// Its function throws UsageError with the first of problems_of_sides().
Figure claim_figure(const ClaimSpec& claim);

/// An empty table of what entered a verdict: group (the run's variant), seed, packing, then these
/// columns.
FigureTable entered_with(const std::vector<std::string>& columns);
/// Adds the row of a run, with the values of the columns after group, seed and packing.
void enter(const FigureRun& run, const TableRow& values, FigureTable& entered);

}  // namespace shearcell
