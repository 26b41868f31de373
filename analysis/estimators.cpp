// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/estimators.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/named.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

/// Makes the verdict and its note. `runs`: how many independent runs, or pairs, have a value.
Verdict conclude(const Claim& claim, const std::string& quantity, std::optional<Estimate> estimate,
                 std::size_t runs, NumbersOfRuns values, std::string note, bool two_sides) {
  if (values.not_positive > 0) {
    add_note(note, fmt::format("{} of {} runs have no ratio: their value at {} is not positive",
                               values.not_positive, values.runs, values.scalar.reach));
  }
  if (values.censored > 0) {
    add_note(note, fmt::format("{} of {} runs end before {} and are censored", values.censored,
                               values.runs, values.scalar.reach));
  }
  values.note_missing(note);
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
  NumbersOfRuns all{scalar};
  if (scalar.relative) all.converted = [](double value) { return std::log(value); };
  const PackingMeans of_a = all.take(a), of_b = all.take(b);
  std::vector<CensoredValue> x, y;  // of packings that both groups have
  for (const auto& [packing, mean] : of_a) {
    const auto same = of_b.find(packing);
    if (same != of_b.end()) x.push_back(mean), y.push_back(same->second);
  }
  const std::size_t shared = x.size();
  const bool paired =
      shared > 0 && is_enough(shared, std::max(by_packing(a).size(), by_packing(b).size()));
  std::string note =
      fmt::format("the two sides have {} and {} independent runs", of_a.size(), of_b.size());
  if (paired) {
    note = fmt::format("{} of runs that share{} a packing", counted(shared, "pair"),
                       shared == 1 ? "s" : "");
  } else {
    x = values_of(of_a), y = values_of(of_b);
    if (shared > 0) {
      add_note(note, fmt::format("they share {}, too few for pairs: Welch's test ignores this, so "
                                 "the interval is too wide",
                                 counted(shared, "packing")));
    }
  }
  const std::size_t runs = std::min(x.size(), y.size());
  auto estimate = censored_difference(x, y, paired, claim.level);
  if (estimate && scalar.relative) {  // a difference of logarithms
    estimate = mapped(*estimate, [](double log_ratio) { return std::expm1(log_ratio); });
  }
  if (a.empty() || b.empty()) all.runs = 0;
  Verdict verdict = conclude(
      claim, (scalar.relative ? "relative difference in " : "difference in ") + scalar.name,
      estimate, runs, std::move(all), std::move(note), true);
  verdict.counted = paired ? Counted::pairs : Counted::runs_per_variant;
  return verdict;
}

Verdict compare_with(const Claim& claim, const Scalar& scalar, RunGroup runs, double published) {
  const double unit = scalar.relative ? std::abs(published) : 1;
  NumbersOfRuns all{scalar, [&](double value) { return (value - published) / unit; }};
  std::vector<CensoredValue> values = values_of(all.take(runs));
  // Sorted, so that the order of the runs does not change the bits of the result.
  std::ranges::sort(values, {},
                    [](const CensoredValue& v) { return std::pair(v.value, v.censored); });
  std::string quantity = scalar.name;
  if (scalar.relative) {
    quantity += fmt::format(", relative difference from {:.6g}", published);
  } else if (published != 0) {
    quantity += fmt::format(" minus {:.6g}", published);
  }
  return conclude(claim, quantity, censored_mean(values, claim.level), values.size(),
                  std::move(all), "", false);
}

CensoredValue censored_value(const RunValue& value) {
  const bool above = value.missing == Missing::too_short && std::isfinite(value.above);
  return {above ? value.above : value.or_nan(), above};
}

CensoredValue NumbersOfRuns::take(const FrameRun& run, const RunValue& value,
                                  const TableRow& more) {
  CensoredValue found = censored_value(value);
  found.value = converted(found.value);
  found.censored = found.censored && std::isfinite(found.value);
  TableRow row = more;
  row.insert(row.end(), {value.or_nan(), std::string(name_of(value.missing))});
  ++runs;
  if (found.censored) {
    ++censored;
    if (entered.place("above") == entered.columns.size()) entered.columns.emplace_back("above");
    row.emplace_back(value.above);
  } else if (value.missing != Missing::nothing) {
    ++missing[value.missing];
  } else if (!std::isfinite(found.value)) {
    ++not_positive;
  }
  enter(run, row, entered);
  return found;
}

PackingMeans NumbersOfRuns::take(RunGroup group) {
  std::vector<CensoredValue> values;
  for (const FrameRun* run : group) values.push_back(take(*run, scalar.of(*run)));
  const auto with = static_cast<std::size_t>(std::ranges::count_if(
      values, [](const CensoredValue& value) { return std::isfinite(value.value); }));
  enough = enough && is_enough(with, group.size());
  return means_by_packing(group, values);
}

void NumbersOfRuns::note_missing(std::string& note) const {
  for (const auto& [why, count] : missing) {
    add_note(note, fmt::format("{} of {} runs {} {}", count, runs,
                               why == Missing::checkpoint  ? "lack a checkpoint of"
                               : why == Missing::too_short ? "end too early for"
                               : why == Missing::too_late  ? "begin too late for"
                               : why == Missing::unbounded ? "are left out: they end before"
                                                           : "have no value at",
                               scalar.reach));
    if (why == Missing::unbounded) note += ", which gives no lower limit of " + scalar.name;
  }
}

std::string NumbersOfRuns::why_not() const {
  std::size_t end_before = censored, none = not_positive;
  for (const auto& [why, count] : missing) {
    (why == Missing::unbounded ? end_before : none) += count;
  }
  if (enough && end_before == 0) return "";
  return fmt::format("no verdict, because {} of {} runs end before the event and {} have no number",
                     end_before, runs, none);
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
