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

/// Why a run has no number: it lacks a checkpoint of that cycle (`checkpoint`), ends before it,
/// begins after it, or the quantity does not exist in it (`undefined`: phi without interior
/// grains).
enum class Missing { nothing, checkpoint, too_short, too_late, undefined };

struct RunValue {
  double value = 0;
  Missing missing = Missing::nothing;
};

/// The value, which is missing if it is not finite.
RunValue measured(double value);

/// One number per run.
struct Scalar {
  std::string name;   ///< "phi at cycle 10"
  std::string reach;  ///< what a run must reach to have it: "cycle 10"
  std::function<RunValue(const FigureRun&)> of;
  bool relative = false;  ///< differences are relative: 0.03 is 3 %
};

/// Mean over the checkpoints of cycles first .. last, all of which the run must have.
Scalar over_cycles(const std::string& name, Quantity quantity, std::int64_t first,
                   std::int64_t last);

/// phi, mean over cycles 1 to 15, before most runs crystallize.
Scalar early_phi();

/// Percentage of crystalline grains, mean over phi from 0.646 to 0.67: the polygon through the
/// means of the run's bins of phi (binning.hpp), integrated over that window.
Scalar percentage_over_phi();

/// phi at the onset, with the supplement's critical size for the run's amplitude.
Scalar onset_phi(OnsetMethod method);

/// The estimate of an increasing function of the quantity. The spread stays that of the quantity.
Estimate mapped(Estimate estimate, const std::function<double(double)>& increasing);

/// a less b. Paired, by Student's t, if some runs share a packing; runs without a partner are then
/// left out. Otherwise Welch's interval. A verdict needs least_runs runs or pairs. So that runs
/// that end early do not bias it, three quarters of each group must have the number, and with pairs
/// also a partner. [choice]
Verdict compare(const Claim& claim, const Scalar& scalar, RunGroup a, RunGroup b);

/// The mean over runs less the published number.
Verdict compare_with(const Claim& claim, const Scalar& scalar, RunGroup runs, double published);

/// The cycle at which each run is first at `level` or more, or the last one.
std::vector<Waiting> waits_for(RunGroup runs, const Quantity& quantity, double level);
/// The same for the onset of crystallization by method 1.
std::vector<Waiting> waits_for_onset(RunGroup runs);

/// log2 of how many times later the event is in `a`, by the log-rank test (statistics.hpp).
/// Runs that end before it are censored.
Verdict compare_waits(const Claim& claim, const std::string& event, std::span<const Waiting> a,
                      std::span<const Waiting> b);

}  // namespace shearcell
