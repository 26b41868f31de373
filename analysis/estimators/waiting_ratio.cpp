// SPDX-License-Identifier: GPL-3.0-or-later
// The ratio of the waiting times of two groups for an event, by the log-rank test.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/estimators.hpp"
#include "analysis/onset.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

std::string wait_in_words(std::span<const CensoredValue> runs) {
  const auto median = median_wait(runs);
  return fmt::format("median cycle {} ({} of {} runs end before the event)",
                     median ? fmt::format("{:.3g}", *median) : "unknown",
                     std::ranges::count(runs, true, &CensoredValue::censored), runs.size());
}

/// A text for the event whose waiting times the claim compares: "phi >= 0.64" or "the onset".
std::string event_of(const ClaimSpec& claim) {
  return claim.reaches ? fmt::format("{} >= {}", claim.compare, *claim.reaches) : "the onset";
}

/// The cycle of the event in each run. A run without the event is censored at its last cycle.
std::vector<CensoredValue> waits_of(const ClaimSpec& claim, RunGroup runs) {
  if (!claim.reaches) return waits_for_onset(runs);
  const NumberColumn number(claim.compare);
  std::vector<CensoredValue> waits;
  for (const FrameRun* run : runs) {
    if (run->checkpoints.empty()) continue;
    const auto reached = std::ranges::find_if(run->checkpoints, [&](const auto& checkpoint) {
      return number(*run, &checkpoint) >= *claim.reaches;
    });
    const bool censored = reached == run->checkpoints.end();
    waits.push_back({censored ? run->checkpoints.back().cycle : reached->cycle, censored});
  }
  return waits;
}

Verdict decide_waits(const ClaimSpec& claim, const Claim& stated, RunGroup first, RunGroup second) {
  const std::string event = event_of(claim);
  const std::vector<CensoredValue> a = waits_of(claim, first), b = waits_of(claim, second);
  const std::optional<Estimate> estimate = log2_wait_ratio(a, b, stated.level);
  const std::size_t runs = std::min(a.size(), b.size());
  const std::string names[] = {shared_name(first), shared_name(second)};
  std::string note = no_group;
  if (runs > 0) {
    note = fmt::format("{}: {}; {}: {}", names[0].empty() ? "first" : names[0], wait_in_words(a),
                       names[1].empty() ? "second" : names[1], wait_in_words(b));
    if (runs < least_runs) {
      add_note(note, fmt::format("too few runs: {}; at least {} are needed", runs, least_runs));
    } else if (!estimate) {
      add_note(note, fmt::format("no ratio: {} never occurs, or all waits of a group are 0 cycles",
                                 event));
    }
  }
  Table entered = entered_with({"cycle", "missing"});
  for (const RunGroup group : {first, second}) {
    for (const FrameRun* run : group) {
      RunValue cycle = {std::nan(""), Missing::checkpoint};
      for (const CensoredValue& wait : waits_of(claim, RunGroup(&run, 1))) {
        cycle = {wait.value, wait.censored ? Missing::too_short : Missing::nothing};
      }
      enter(*run, {cycle.value, std::string(name_of(cycle.missing))}, entered);
    }
  }
  Verdict verdict =
      decide(stated, fmt::format("log2 of the ratio of the cycles of {}, log-rank", event),
             estimate, runs, std::move(note), std::move(entered), Counted::runs_per_variant);
  verdict.waits_for = event;
  if (estimate && estimate->interval.low == estimate->interval.high) {
    add_note(
        verdict.note,
        "the waiting times have no scatter at these checkpoints, so the interval has no width");
    if (estimate->value == 0) withhold(verdict);  // as compare() does for equal sides
  }
  return verdict;
}

std::string words_of_waits(const ClaimSpec& claim) {
  return "the cycle of " + event_of(claim);
}

}  // namespace

std::vector<CensoredValue> waits_for_onset(RunGroup runs) {
  std::vector<CensoredValue> waits;
  for (const FrameRun* run : runs) {
    if (run->checkpoints.empty()) continue;
    const RunOnset onset = onset_by_size(*run);
    const bool censored = onset.missing == Missing::too_short;
    waits.push_back({censored ? run->checkpoints.back().cycle : onset.cycle, censored});
  }
  return waits;
}

bool compares_waits(const ClaimSpec& claim) {
  const std::string_view name = estimator_of(claim).name;
  return name == first_cycle_reached.name || name == waiting_ratio.name;
}

const Estimator first_cycle_reached = {
    .name = "first_cycle",
    .meaning =
        "log2 of a ratio of waiting times; a waiting time is the first cycle at which "
        "`compare` is at least `reaches`",
    .key = "reaches",
    .decide = decide_waits,
    .words = words_of_waits};

const Estimator waiting_ratio = {
    .name = "waiting_ratio",
    .meaning = "log2 of the ratio of the onset cycles of two groups; only for `onset_size_cycle`",
    .of_run = true,
    .decide = decide_waits,
    .words = words_of_waits};

}  // namespace shearcell
