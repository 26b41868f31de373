// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/estimators.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "core/named.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

/// Converts a run's value to the number that is compared, such as its logarithm.
using Number = std::function<double(double value)>;

/// One number for each run of one or two groups, and the reasons why some runs have no number.
struct Values {
  std::map<const FrameRun*, CensoredValue> numbers;  ///< NaN or infinite: the run has no number
  std::size_t runs = 0, censored = 0;
  std::map<Missing, std::size_t> missing;
  std::size_t not_positive = 0;  ///< runs left out because their value has no logarithm
  bool enough = true;            ///< at least 3/4 of the runs in each group have a finite number
  Table entered = entered_with({"value", "missing"});

  void take(const Scalar& scalar, RunGroup group, const Number& number) {
    std::size_t without = 0;
    for (const FrameRun* run : group) {
      const RunValue value = scalar.of(*run);
      CensoredValue found = censored_value(value);
      found.value = number(found.value);
      found.censored = found.censored && std::isfinite(found.value);
      TableRow row = {value.or_nan(), std::string(name_of(value.missing))};
      if (found.censored) {
        ++censored;
        if (entered.columns.size() < 6) entered.columns.emplace_back("above");
        row.emplace_back(value.above);
      } else if (value.missing != Missing::nothing) {
        ++missing[value.missing];
      }
      enter(*run, row, entered);
      numbers[run] = found;
      if (std::isfinite(found.value)) continue;
      ++without;
      not_positive += value.missing == Missing::nothing ? 1 : 0;
    }
    runs += group.size();
    enough = enough && is_enough(group.size() - without, group.size());
  }
  std::vector<CensoredValue> over_packings(RunGroup group) const {
    std::vector<CensoredValue> values;
    for (const FrameRun* run : group) values.push_back(numbers.at(run));
    return shearcell::over_packings(group, values);
  }
};

/// Makes the verdict and its note. `runs`: how many independent runs, or pairs, have a value.
Verdict conclude(const Claim& claim, const std::string& quantity, std::optional<Estimate> estimate,
                 std::size_t runs, Values values, const Scalar& scalar, std::string note,
                 bool two_sides) {
  if (values.not_positive > 0) {
    add_note(note, fmt::format("{} of {} runs have no ratio: their value at {} is not positive",
                               values.not_positive, values.runs, scalar.reach));
  }
  if (values.censored > 0) {
    add_note(note, fmt::format("{} of {} runs end before {} and are censored", values.censored,
                               values.runs, scalar.reach));
  }
  for (const auto& [why, count] : values.missing) {
    add_note(note, fmt::format("{} of {} runs {} {}", count, values.runs,
                               why == Missing::checkpoint  ? "lack a checkpoint of"
                               : why == Missing::too_short ? "end too early for"
                               : why == Missing::too_late  ? "begin too late for"
                                                           : "have no value at",
                               scalar.reach));
  }
  if (values.runs == 0) {
    note = no_group;
  } else if (!values.enough) {
    add_note(note, many_left_out);
    estimate.reset();
  } else if (runs < least_runs) {
    add_note(note, fmt::format("too few runs: {}; at least {} are needed", runs, least_runs));
  }
  const bool no_scatter = estimate && estimate->interval.low == estimate->interval.high;
  const bool equal_sides = no_scatter && two_sides && estimate->value == 0;
  if (no_scatter) {
    add_note(note, equal_sides
                       ? "the numbers of the two sides agree in every digit, usually because both "
                         "sides are the same computation; this is no evidence for or against "
                         "the claim"
                       : "the numbers have no scatter, so the interval has no width");
  }
  Verdict verdict =
      decide(claim, quantity, estimate, runs, std::move(note), std::move(values.entered));
  if (equal_sides) withhold(verdict);
  verdict.censored = values.censored;
  return verdict;
}

/// For each packing that occurs in both groups: the mean over its runs in each group.
struct Pairs {
  std::vector<CensoredValue> a, b;
  bool any = false;    ///< some runs of the two groups share a packing
  bool enough = true;  ///< at least 3/4 of the packings of each group are in `a` and `b`
};
Pairs paired(RunGroup a, RunGroup b, const Values& values) {
  Pairs pairs;
  const auto first = by_packing(a), second = by_packing(b);
  for (const auto& [packing, runs] : first) {
    const auto same = second.find(packing);
    if (same == second.end() || same->second == runs) continue;
    pairs.any = true;
    const std::vector<CensoredValue> x = values.over_packings(runs);
    const std::vector<CensoredValue> y = values.over_packings(same->second);
    if (x.empty() || y.empty()) continue;
    pairs.a.push_back(x.front());
    pairs.b.push_back(y.front());
  }
  pairs.enough = is_enough(pairs.a.size(), std::max(first.size(), second.size()));
  return pairs;
}

}  // namespace

std::span<const Estimator> all_estimators() {
  static const std::array all = {mean_over_cycles,    mean_over_phi, number_of_the_run,
                                 change_over_cycles,  relative_fall, slope_over_cycles,
                                 first_cycle_reached, waiting_ratio, slope_against,
                                 spread_of_variants,  spread_ratio,  pooled_difference,
                                 rate_exponent};
  return all;
}

const Estimator& estimator_of(const ClaimSpec& claim) {
  if (const Estimator* named = find_named(all_estimators(), claim.estimator)) return *named;
  if (!claim.against.empty()) return slope_against;
  if (claim.reaches) return first_cycle_reached;
  const Measure* of_run = find_measure(claim.compare, MeasureKind::run);
  if (of_run != nullptr && of_run->waits && !claim.published) return waiting_ratio;
  return estimator_by_keys(claim);
}

const Estimator& estimator_by_keys(const ClaimSpec& claim) {
  return claim.cycles ? mean_over_cycles : claim.phi ? mean_over_phi : number_of_the_run;
}

std::string words_of_column(const std::string& column) {
  const Measure* measure = find_measure(column);
  return measure != nullptr && !measure->words.empty() ? std::string(measure->words) : column;
}

Verdict compare(const Claim& claim, const Scalar& scalar, RunGroup a, RunGroup b) {
  const auto number = [&](double value) { return scalar.relative ? std::log(value) : value; };
  Values all;
  all.take(scalar, a, number);
  all.take(scalar, b, number);
  const Pairs pairs = paired(a, b, all);
  std::optional<Estimate> estimate;
  std::string note;
  std::size_t runs = 0;
  if (pairs.any) {
    estimate = censored_difference(pairs.a, pairs.b, true, claim.level);
    runs = pairs.a.size();
    note = fmt::format("{} of runs that share{} a packing", counted(runs, "pair"),
                       runs == 1 ? "s" : "");
    if (estimate && !pairs.enough) {
      note += "; more than a quarter of the runs have no partner";
      estimate.reset();
    }
  } else {
    const std::vector<CensoredValue> x = all.over_packings(a), y = all.over_packings(b);
    estimate = censored_difference(x, y, false, claim.level);
    runs = std::min(x.size(), y.size());
    note = fmt::format("the two sides have {} and {} independent runs", x.size(), y.size());
  }
  if (estimate && scalar.relative) {  // a difference of logarithms
    estimate = mapped(*estimate, [](double log_ratio) { return std::expm1(log_ratio); });
  }
  if (a.empty() || b.empty()) all.runs = 0;
  Verdict verdict = conclude(
      claim, (scalar.relative ? "relative difference in " : "difference in ") + scalar.name,
      estimate, runs, all, scalar, std::move(note), true);
  verdict.counted = pairs.any ? Counted::pairs : Counted::runs_per_variant;
  return verdict;
}

Verdict compare_with(const Claim& claim, const Scalar& scalar, RunGroup runs, double published) {
  const double sign =
      published < 0 ? -1 : 1;  // a relative difference is positive if value > published
  const auto number = [&](double value) {
    return scalar.relative ? sign * (value / published - 1) : value - published;
  };
  Values all;
  all.take(scalar, runs, number);
  std::vector<CensoredValue> values = all.over_packings(runs);
  // Sorted, so that the order of the runs does not change the bits of the result.
  std::ranges::sort(values, {},
                    [](const CensoredValue& v) { return std::pair(v.value, v.censored); });
  std::string quantity = scalar.name;
  if (scalar.relative) {
    quantity += fmt::format(", relative difference from {:.6g}", published);
  } else if (published != 0) {
    quantity += fmt::format(" minus {:.6g}", published);
  }
  return conclude(claim, quantity, censored_mean(values, claim.level), values.size(), all, scalar,
                  "", false);
}

CensoredValue censored_value(const RunValue& value) {
  const bool above = value.missing == Missing::too_short && std::isfinite(value.above);
  return {above ? value.above : value.or_nan(), above};
}

std::vector<CensoredValue> over_packings(RunGroup runs, std::span<const CensoredValue> values) {
  nlohmann::ordered_map<std::string, std::pair<std::vector<double>, bool>> packings;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    auto& [of_packing, censored] = packings[packing_of(*runs[k])];
    of_packing.push_back(values[k].value);
    censored = censored || values[k].censored;
  }
  std::vector<CensoredValue> means;
  for (const auto& [packing, found] : packings) {
    if (const auto mean = over_runs(found.first).mean) means.push_back({*mean, found.second});
  }
  return means;
}

std::vector<RunValue> NumbersOfRuns::take(const Scalar& scalar, RunGroup group) {
  std::vector<RunValue> numbers;
  std::size_t with = 0;
  for (const FrameRun* run : group) {
    const RunValue& value = numbers.emplace_back(scalar.of(*run));
    if (value.missing == Missing::nothing) {
      ++with;
    } else {
      ++(censored_value(value).censored ? censored : missing);
    }
  }
  runs += group.size();
  enough = enough && censored == 0 && is_enough(with, group.size());
  return numbers;
}

std::string NumbersOfRuns::why_not() const {
  return enough ? ""
                : fmt::format(
                      "no verdict, because {} of {} runs end before the event and {} have "
                      "no number",
                      censored, runs, missing);
}

Table entered_with(const std::vector<TableColumn>& columns) {
  Table entered{.columns = {"group", "seed", "packing"}};
  entered.columns.insert(entered.columns.end(), columns.begin(), columns.end());
  return entered;
}

void enter(const FrameRun& run, const TableRow& values, Table& entered) {
  TableRow& row =
      entered.rows.emplace_back(TableRow{run.place.variant, run.place.seed, packing_of(run)});
  row.insert(row.end(), values.begin(), values.end());
}

}  // namespace shearcell
