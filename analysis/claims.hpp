// SPDX-License-Identifier: GPL-3.0-or-later
// Claims about runs: one number per run, compared between two groups of runs or with a published
// number.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "analysis/figure.hpp"
#include "analysis/onset.hpp"
#include "analysis/statistics.hpp"
#include "analysis/verdict.hpp"

namespace shearcell {

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
using PackingGroups = std::vector<std::pair<std::string, std::vector<const FigureRun*>>>;
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

/// An empty table of what entered a verdict: group (the run's variant), seed, packing, then these
/// columns.
Entered entered_with(const std::vector<std::string>& columns);
/// Adds the row of a run, with the values of the columns after group, seed and packing.
void enter(const FigureRun& run, const TableRow& values, Entered& entered);

}  // namespace shearcell
