// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/claims.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "analysis/binning.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

constexpr const char* no_group =
    "there are no such runs, or they differ in another swept parameter too";

/// The numbers of one or two groups of runs, and why other runs have none.
struct Values {
  std::map<const FigureRun*, double> found;
  std::size_t runs = 0;
  std::map<Missing, std::size_t> missing;
  std::size_t not_positive = 0;  ///< numbers without a logarithm, which are left out
  bool enough = true;            ///< three quarters of each group have a number

  /// With `logarithms` only positive numbers count.
  void take(const Scalar& scalar, RunGroup group, bool logarithms = false) {
    std::size_t without = 0;
    for (const FigureRun* run : group) {
      const RunValue value = scalar.of(*run);
      const bool found_one = value.missing == Missing::nothing;
      const bool counts = found_one && (!logarithms || value.value > 0);
      ++runs;
      if (!found_one) ++missing[value.missing];
      if (found_one && !counts) ++not_positive;
      if (counts) {
        found[run] = value.value;
      } else {
        ++without;
      }
    }
    enough = enough && 4 * without <= group.size();
  }
};

void add(std::string& note, const std::string& text) {
  if (!text.empty()) note += (note.empty() ? "" : "; ") + text;
}

void add_missing(std::string& note, const Values& values, const Scalar& scalar) {
  if (values.not_positive > 0) {
    add(note, fmt::format("{} of {} runs have no ratio, since their value at {} is not positive",
                          values.not_positive, values.runs, scalar.reach));
  }
  for (const auto& [why, count] : values.missing) {
    add(note, fmt::format("{} of {} runs {} {}", count, values.runs,
                          why == Missing::checkpoint  ? "lack a checkpoint of"
                          : why == Missing::too_short ? "end too early for"
                          : why == Missing::too_late  ? "begin too late for"
                                                      : "have no value at",
                          scalar.reach));
  }
}

/// One number of each run.
Entered entered_by(const Scalar& scalar, std::initializer_list<RunGroup> groups) {
  Entered entered = entered_with({"value", "missing"});
  for (const RunGroup group : groups) {
    for (const FigureRun* run : group) {
      const RunValue value = scalar.of(*run);
      enter(*run, {value.or_nan(), std::string(name_of(value.missing))}, entered);
    }
  }
  return entered;
}

Verdict conclude(const Claim& claim, const std::string& quantity, std::optional<Estimate> estimate,
                 std::size_t runs, const Values& values, const Scalar& scalar, std::string note) {
  add_missing(note, values, scalar);
  if (values.runs == 0) {
    note = no_group;
  } else if (!values.enough) {
    add(note, "more than a quarter of the runs are left out");
    estimate.reset();
  } else if (runs < least_runs) {
    add(note, fmt::format("too few runs: {}; at least {} are needed", runs, least_runs));
  }
  return decide(claim, quantity, estimate, runs, std::move(note));
}

/// The number of each run; not a number where it has none.
std::vector<double> numbers_of(RunGroup group, const Values& values,
                               const std::function<double(double)>& number) {
  std::vector<double> numbers;
  for (const FigureRun* run : group) {
    const auto found = values.found.find(run);
    numbers.push_back(found == values.found.end() ? std::nan("") : number(found->second));
  }
  return numbers;
}

/// Differences a - b of the packings that both groups have: each of the mean over its runs.
struct Pairs {
  std::vector<double> differences;
  bool any = false;    ///< different runs share a packing, with numbers or without
  bool enough = true;  ///< three quarters of the packings of each group
};
Pairs paired(RunGroup a, RunGroup b, const Values& values,
             const std::function<double(double)>& number) {
  Pairs pairs;
  const auto first = by_packing(a), second = by_packing(b);
  for (const auto& [packing, runs] : first) {
    const auto same = std::ranges::find(second, packing, [](const auto& of) { return of.first; });
    if (same == second.end() || same->second == runs) continue;
    pairs.any = true;
    const std::vector<double> x = over_packings(runs, numbers_of(runs, values, number));
    const std::vector<double> y =
        over_packings(same->second, numbers_of(same->second, values, number));
    if (!x.empty() && !y.empty()) pairs.differences.push_back(x.front() - y.front());
  }
  pairs.enough = 4 * pairs.differences.size() >= 3 * std::max(first.size(), second.size());
  return pairs;
}

std::string wait_in_words(std::span<const Waiting> runs) {
  const auto median = median_wait(runs);
  return fmt::format("median cycle {} ({} of {} runs end before theirs)",
                     median ? fmt::format("{:.3g}", *median) : "unknown",
                     std::ranges::count(runs, false, &Waiting::observed), runs.size());
}

}  // namespace

Scalar over_cycles(const std::string& name, const std::string& measure, std::int64_t first,
                   std::int64_t last) {
  const auto of = [measure, first, last](const FigureRun& run) -> RunValue {
    double sum = 0;
    std::int64_t count = 0;
    for (const CheckpointMeasures& checkpoint : run.checkpoints) {
      const double cycle = checkpoint.cycle;
      if (std::floor(cycle) != cycle || cycle < static_cast<double>(first) ||
          cycle > static_cast<double>(last)) {
        continue;
      }
      sum += checkpoint.measures.number(measure);
      ++count;
    }
    if (count != last - first + 1) {
      const double end = run.checkpoints.empty() ? 0 : run.checkpoints.back().cycle;
      const bool ended = std::max(run.end, end) < static_cast<double>(last);
      return {0, ended ? Missing::too_short : Missing::checkpoint};
    }
    return measured(sum / static_cast<double>(count));
  };
  if (first == last) {
    return {fmt::format("{} at cycle {}", name, last), fmt::format("cycle {}", last), of};
  }
  return {fmt::format("{}, mean over cycles {} to {}", name, first, last),
          fmt::format("cycles {} to {}", first, last), of};
}

Scalar over_phi(const std::string& name, const std::string& measure, double low, double high) {
  const auto of = [=](const FigureRun& run) -> RunValue {
    const FigureRun* one = &run;
    const std::vector<PhiBin> bins = binned_by_phi(std::span(&one, 1), measure);
    if (bins.empty()) return {0, Missing::too_short};
    if (*bins.front().phi.mean > low) return {0, Missing::too_late};
    if (*bins.back().phi.mean < high) return {0, Missing::too_short};
    double area = 0;
    for (std::size_t k = 1; k < bins.size(); ++k) {
      const double x0 = *bins[k - 1].phi.mean, x1 = *bins[k].phi.mean;
      const double begin = std::max(x0, low), end = std::min(x1, high);
      if (begin >= end) continue;
      const double middle = ((begin + end) / 2 - x0) / (x1 - x0);
      area += (end - begin) * std::lerp(*bins[k - 1].value.mean, *bins[k].value.mean, middle);
    }
    return measured(area / (high - low));
  };
  return {fmt::format("{}, mean over phi from {} to {}", name, low, high),
          fmt::format("phi from {} to {}", low, high), of};
}

Scalar of_whole_run(const Measure& measure) {
  return {std::string(measure.words), std::string(measure.reach), measure.of_run};
}

Scalar onset_phi() {
  return of_whole_run(*find_measure("onset_size_phi", MeasureKind::run));
}

Estimate mapped(Estimate estimate, const std::function<double(double)>& increasing) {
  estimate.value = increasing(estimate.value);
  estimate.interval = {increasing(estimate.interval.low), increasing(estimate.interval.high)};
  return estimate;
}

PackingGroups by_packing(RunGroup group) {
  PackingGroups packings;
  for (const FigureRun* run : group) {
    auto same =
        std::ranges::find(packings, packing_of(*run), [](const auto& of) { return of.first; });
    if (same == packings.end()) same = packings.insert(same, {packing_of(*run), {}});
    same->second.push_back(run);
  }
  return packings;
}

Verdict compare(const Claim& claim, const Scalar& scalar, RunGroup a, RunGroup b) {
  const auto number = [&](double value) { return scalar.relative ? std::log(value) : value; };
  Values all;
  all.take(scalar, a, scalar.relative);
  all.take(scalar, b, scalar.relative);
  const Pairs pairs = paired(a, b, all, number);
  std::optional<Estimate> estimate;
  std::string note;
  std::size_t runs = 0;
  if (pairs.any) {
    estimate = mean_of(pairs.differences);
    runs = pairs.differences.size();
    note = fmt::format("{} of runs that share{} a packing", counted(runs, "pair"),
                       runs == 1 ? "s" : "");
    if (estimate && !pairs.enough) {
      note += "; more than a quarter of the runs have no partner";
      estimate.reset();
    }
  } else {
    const std::vector<double> x = over_packings(a, numbers_of(a, all, number));
    const std::vector<double> y = over_packings(b, numbers_of(b, all, number));
    estimate = difference_of_means(x, y);
    runs = std::min(x.size(), y.size());
    note = fmt::format("{} and {} independent runs", x.size(), y.size());
  }
  if (estimate && scalar.relative) {  // a difference of logarithms
    estimate = mapped(*estimate, [](double log_ratio) { return std::expm1(log_ratio); });
  }
  if (a.empty() || b.empty()) all = {};
  Verdict verdict = conclude(
      claim, (scalar.relative ? "relative difference in " : "difference in ") + scalar.name,
      estimate, runs, all, scalar, std::move(note));
  verdict.counted = pairs.any ? Counted::pairs : Counted::runs_per_variant;
  verdict.entered = entered_by(scalar, {a, b});
  return verdict;
}

Verdict compare_with(const Claim& claim, const Scalar& scalar, RunGroup runs, double published) {
  Values all;
  all.take(scalar, runs);
  const double sign = published < 0 ? -1 : 1;  // a higher value has a positive difference
  const auto number = [&](double value) {
    return scalar.relative ? sign * (value / published - 1) : value - published;
  };
  std::vector<double> values = over_packings(runs, numbers_of(runs, all, number));
  std::sort(values.begin(), values.end());  // not in the order of addresses
  std::string quantity = scalar.name;
  if (scalar.relative) {
    quantity += fmt::format(", relative difference from {:.6g}", published);
  } else if (published != 0) {
    quantity += fmt::format(" less {:.6g}", published);
  }
  Verdict verdict = conclude(claim, quantity, mean_of(values), values.size(), all, scalar, "");
  verdict.entered = entered_by(scalar, {runs});
  return verdict;
}

std::vector<Waiting> waits_for(RunGroup runs, const std::string& measure, double level) {
  std::vector<Waiting> waits;
  for (const FigureRun* run : runs) {
    if (run->checkpoints.empty()) continue;
    Waiting wait{run->checkpoints.back().cycle, false};
    for (const CheckpointMeasures& checkpoint : run->checkpoints) {
      if (!(checkpoint.measures.number(measure) >= level)) continue;
      wait = {checkpoint.cycle, true};
      break;
    }
    waits.push_back(wait);
  }
  return waits;
}

std::vector<Waiting> waits_for_onset(RunGroup runs) {
  std::vector<Waiting> waits;
  for (const FigureRun* run : runs) {
    if (run->checkpoints.empty()) continue;
    const RunOnset onset = onset_by_size(*run);
    const bool observed = onset.observed != Observed::never;
    waits.push_back({observed ? onset.cycle : run->checkpoints.back().cycle, observed});
  }
  return waits;
}

Entered entered_with(const std::vector<std::string>& columns) {
  Entered entered{{"group", "seed", "packing"}};
  entered.columns.insert(entered.columns.end(), columns.begin(), columns.end());
  return entered;
}

void enter(const FigureRun& run, const TableRow& values, Entered& entered) {
  TableRow& row = entered.rows.emplace_back(TableRow{run.variant, run.seed, packing_of(run)});
  row.insert(row.end(), values.begin(), values.end());
}

Verdict compare_waits(const Claim& claim, const std::string& event,
                      const std::function<std::vector<Waiting>(RunGroup)>& waits, RunGroup first,
                      RunGroup second) {
  const std::vector<Waiting> a = waits(first), b = waits(second);
  const std::optional<Estimate> estimate = log2_wait_ratio(a, b);
  const std::size_t runs = std::min(a.size(), b.size());
  std::string note;
  if (runs > 0) note = "first: " + wait_in_words(a) + "; second: " + wait_in_words(b);
  if (runs == 0) {
    note = no_group;
  } else if (runs < least_runs) {
    add(note, fmt::format("too few runs: {}; at least {} are needed", runs, least_runs));
  } else if (!estimate) {
    add(note, fmt::format("{} is at cycle 0 in every run of one group, or in no run", event));
  }
  Verdict verdict =
      decide(claim, fmt::format("log2 of the ratio of the cycles of {}, log-rank", event), estimate,
             runs, std::move(note));
  verdict.counted = Counted::runs_per_variant;
  const auto cycle_of = [&](const FigureRun& run) -> RunValue {
    const FigureRun* alone = &run;
    const std::vector<Waiting> wait = waits(RunGroup(&alone, 1));
    if (wait.empty()) return {0, Missing::checkpoint};
    return {wait.front().cycle, wait.front().observed ? Missing::nothing : Missing::too_short};
  };
  verdict.entered = entered_with({"cycle", "missing"});
  for (const RunGroup group : {first, second}) {
    for (const FigureRun* run : group) {
      const RunValue cycle = cycle_of(*run);
      enter(*run, {cycle.value, std::string(name_of(cycle.missing))}, verdict.entered);
    }
  }
  return verdict;
}

}  // namespace shearcell
