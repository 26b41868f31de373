// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/claims.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "analysis/binning.hpp"
#include "analysis/expression.hpp"
#include "analysis/own_figure.hpp"
#include "provenance/errors.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

constexpr const char* no_group =
    "there are no such runs, or they differ in another swept parameter too";

void add(std::string& note, const std::string& text) {
  note += (note.empty() ? "" : "; ") + text;
}

/// What is compared of the value of a run.
using Number = std::function<double(double value)>;

/// The numbers of one or two groups of runs, and why other runs have none.
struct Values {
  std::map<const FigureRun*, double> numbers;  ///< not finite where there is none
  std::size_t runs = 0;
  std::map<Missing, std::size_t> missing;
  std::size_t not_positive = 0;  ///< values without a logarithm, which are left out
  bool enough = true;            ///< three quarters of each group have a number
  FigureTable entered = entered_with({"value", "missing"});

  void take(const Scalar& scalar, RunGroup group, const Number& number) {
    std::size_t without = 0;
    for (const FigureRun* run : group) {
      const RunValue value = scalar.of(*run);
      enter(*run, {value.or_nan(), std::string(name_of(value.missing))}, entered);
      const double found = numbers[run] = number(value.or_nan());
      if (value.missing != Missing::nothing) ++missing[value.missing];
      if (std::isfinite(found)) continue;
      ++without;
      not_positive += value.missing == Missing::nothing ? 1 : 0;
    }
    runs += group.size();
    enough = enough && 4 * without <= group.size();
  }
  std::vector<double> over_packings(RunGroup group) const {
    std::vector<double> values;
    for (const FigureRun* run : group) values.push_back(numbers.at(run));
    return shearcell::over_packings(group, values);
  }
};

/// `runs`: those with a number, or pairs of them.
Verdict conclude(const Claim& claim, const std::string& quantity, std::optional<Estimate> estimate,
                 std::size_t runs, Values values, const Scalar& scalar, std::string note) {
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
  if (values.runs == 0) {
    note = no_group;
  } else if (!values.enough) {
    add(note, "more than a quarter of the runs are left out");
    estimate.reset();
  } else if (runs < least_runs) {
    add(note, fmt::format("too few runs: {}; at least {} are needed", runs, least_runs));
  }
  return decide(claim, quantity, estimate, runs, std::move(note), std::move(values.entered));
}

/// Differences a - b of the packings that both groups have: each of the mean over its runs.
struct Pairs {
  std::vector<double> differences;
  bool any = false;    ///< different runs share a packing, with numbers or without
  bool enough = true;  ///< three quarters of the packings of each group
};
Pairs paired(RunGroup a, RunGroup b, const Values& values) {
  Pairs pairs;
  const auto first = by_packing(a), second = by_packing(b);
  for (const auto& [packing, runs] : first) {
    const auto same = second.find(packing);
    if (same == second.end() || same->second == runs) continue;
    pairs.any = true;
    const std::vector<double> x = values.over_packings(runs);
    const std::vector<double> y = values.over_packings(same->second);
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
  for (const FigureRun* run : group) packings[packing_of(*run)].push_back(run);
  return packings;
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
    estimate = mean_of(pairs.differences);
    runs = pairs.differences.size();
    note = fmt::format("{} of runs that share{} a packing", counted(runs, "pair"),
                       runs == 1 ? "s" : "");
    if (estimate && !pairs.enough) {
      note += "; more than a quarter of the runs have no partner";
      estimate.reset();
    }
  } else {
    const std::vector<double> x = all.over_packings(a), y = all.over_packings(b);
    estimate = difference_of_means(x, y);
    runs = std::min(x.size(), y.size());
    note = fmt::format("{} and {} independent runs", x.size(), y.size());
  }
  if (estimate && scalar.relative) {  // a difference of logarithms
    estimate = mapped(*estimate, [](double log_ratio) { return std::expm1(log_ratio); });
  }
  if (a.empty() || b.empty()) all.runs = 0;
  Verdict verdict = conclude(
      claim, (scalar.relative ? "relative difference in " : "difference in ") + scalar.name,
      estimate, runs, all, scalar, std::move(note));
  verdict.counted = pairs.any ? Counted::pairs : Counted::runs_per_variant;
  return verdict;
}

Verdict compare_with(const Claim& claim, const Scalar& scalar, RunGroup runs, double published) {
  const double sign = published < 0 ? -1 : 1;  // a higher value has a positive difference
  const auto number = [&](double value) {
    return scalar.relative ? sign * (value / published - 1) : value - published;
  };
  Values all;
  all.take(scalar, runs, number);
  std::vector<double> values = all.over_packings(runs);
  std::sort(values.begin(), values.end());  // the same bits in any order of the runs
  std::string quantity = scalar.name;
  if (scalar.relative) {
    quantity += fmt::format(", relative difference from {:.6g}", published);
  } else if (published != 0) {
    quantity += fmt::format(" less {:.6g}", published);
  }
  return conclude(claim, quantity, mean_of(values), values.size(), all, scalar, "");
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

FigureTable entered_with(const std::vector<std::string>& columns) {
  FigureTable entered{.columns = {"group", "seed", "packing"}};
  entered.columns.insert(entered.columns.end(), columns.begin(), columns.end());
  return entered;
}

void enter(const FigureRun& run, const TableRow& values, FigureTable& entered) {
  TableRow& row =
      entered.rows.emplace_back(TableRow{run.place.variant, run.place.seed, packing_of(run)});
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
  FigureTable entered = entered_with({"cycle", "missing"});
  for (const RunGroup group : {first, second}) {
    for (const FigureRun* run : group) {
      RunValue cycle = {0, Missing::checkpoint};
      for (const Waiting& wait : waits(RunGroup(&run, 1))) {
        cycle = {wait.cycle, wait.observed ? Missing::nothing : Missing::too_short};
      }
      enter(*run, {cycle.value, std::string(name_of(cycle.missing))}, entered);
    }
  }
  return decide(claim, fmt::format("log2 of the ratio of the cycles of {}, log-rank", event),
                estimate, runs, std::move(note), std::move(entered), Counted::runs_per_variant);
}

namespace {

/// The compared number. Of an expression: the runs must come from with_values().
Scalar scalar_of(const ClaimSpec& claim) {
  const Measure* measure = find_measure(claim.compare);
  const bool has_words = measure != nullptr && !measure->words.empty();
  const std::string name = has_words ? std::string(measure->words) : claim.compare;
  Scalar scalar;
  if (const Measure* of_run = find_measure(claim.compare, MeasureKind::run)) {
    scalar = of_whole_run(*of_run);
  } else if (claim.cycles) {
    scalar = over_cycles(name, claim.compare, static_cast<std::int64_t>(claim.cycles->at(0)),
                         static_cast<std::int64_t>(claim.cycles->at(1)));
  } else if (claim.phi) {
    scalar = over_phi(name, claim.compare, claim.phi->at(0), claim.phi->at(1));
  } else {
    const auto of = [text = claim.compare](const FigureRun& run) {
      return measured(number_of(run, text));
    };
    scalar = {claim.compare, claim.compare, of};
  }
  scalar.relative = claim.relative;
  return scalar;
}

/// What the runs of such a claim wait for.
std::string event_of(const ClaimSpec& claim) {
  return claim.reaches ? fmt::format("{} >= {}", claim.compare, *claim.reaches) : "the onset";
}

/// The name of the compared number in sentences.
std::string quantity_of(const ClaimSpec& claim) {
  return compares_waits(claim) ? "the cycle of " + event_of(claim) : scalar_of(claim).name;
}

/// Crystallization changes a mean over cycles: the note counts the runs that begin to crystallize
/// before the last of these.
void note_early_onsets(const ClaimSpec& claim, std::initializer_list<RunGroup> groups,
                       Verdict& verdict) {
  if (!claim.cycles || claim.cycles->at(0) == claim.cycles->at(1)) return;
  const std::uint64_t last = claim.cycles->at(1);
  std::size_t early = 0, all = 0;
  for (const RunGroup group : groups) {
    all += group.size();
    early += static_cast<std::size_t>(
        std::ranges::count_if(waits_for_onset(group), [&](const Waiting& wait) {
          return wait.observed && wait.cycle < static_cast<double>(last);
        }));
  }
  if (early == 0) return;
  verdict.note +=
      fmt::format("; {} of all {} runs have their onset before cycle {}", early, all, last);
}

std::string published_in_words(const PublishedSpec& published) {
  return fmt::format("{}{} ({})", published.value.value_or(0),
                     published.error > 0 ? fmt::format(" ± {}", published.error) : "",
                     published.source);
}

}  // namespace

Claim stated(const ClaimSpec& claim, const std::array<std::string, 2>& sides) {
  const bool waits = compares_waits(claim);
  const std::string name = quantity_of(claim);
  const bool same = claim.is == Relation::same, higher = claim.is == Relation::higher;
  std::string how = same ? "the same" : std::string(name_of(claim.is));
  if (waits && !same) how = higher ? "later" : "earlier";
  if (!same && claim.margin > 0) {
    how += " by more than " + (waits ? fmt::format("a factor of {:.3g}", std::exp2(claim.margin))
                               : claim.relative ? fmt::format("{:.6g} %", 100 * claim.margin)
                                                : fmt::format("{}", claim.margin));
  }
  std::string text = claim.statement;
  if (text.empty() && claim.published) {
    text = fmt::format(
        "{}: {} is {} {}{}", claim.name, name, same ? "as published," : how + " than published,",
        published_in_words(*claim.published), sides[0].empty() ? "" : ", for " + sides[0]);
  } else if (text.empty()) {
    text = fmt::format("{}: {} is {} for {} {} {}", claim.name, name, how, sides[0],
                       same ? "and" : "than for", sides[1]);
  }
  return {text, claim.is == Relation::lower ? -claim.margin : claim.margin, claim.is};
}

namespace {

/// The verdict on runs of both sides, or of the first one with a published number.
Verdict decided_by(const ClaimSpec& claim, const Claim& stated, RunGroup a, RunGroup b) {
  if (compares_waits(claim)) {
    const auto waits = [&claim](RunGroup runs) {
      return claim.reaches ? waits_for(runs, claim.compare, *claim.reaches) : waits_for_onset(runs);
    };
    return compare_waits(stated, event_of(claim), waits, a, b);
  }
  if (claim.published) {
    const double published = *claim.published->value;
    if (claim.margin > 0) return compare_with(stated, scalar_of(claim), a, published);
    return compare_with({stated.text, published, stated.claimed}, scalar_of(claim), a, 0);
  }
  Verdict verdict = compare(stated, scalar_of(claim), a, b);
  note_early_onsets(claim, {a, b}, verdict);
  return verdict;
}

FigureResult decide_claim(const ClaimSpec& claim, std::span<const FigureRun> given) {
  std::vector<FigureRun> computed;  // with the values of an expression
  if (is_expression(claim.compare)) computed = with_values(given, {claim.compare});
  const std::span<const FigureRun> runs = computed.empty() ? given : computed;
  ClaimSides sides = sides_of(claim, runs);
  if (claim.optional && sides.lacks_one) return {};
  const Claim decided = stated(claim, sides.names);
  const std::vector<std::string> problems = problems_of_sides(claim, sides, false);
  if (!problems.empty() && !claim.listed) {
    throw UsageError(fmt::format("claim {}: {}", claim.name, problems.front()));
  }
  if (!problems.empty()) sides.runs = {};
  if (sides.lacks_one && !claim.listed) {
    const std::string& name = sides.names[sides.runs[0].empty() ? 0 : 1];
    return {{},
            {decide(decided, "difference in " + quantity_of(claim), std::nullopt, 0,
                    fmt::format("no run{} has a checkpoint{}", name.empty() ? "" : " with " + name,
                                claim.cycles ? " of " + scalar_of(claim).reach : ""))}};
  }
  return {{}, {decided_by(claim, decided, sides.runs[0], sides.runs[1])}};
}

}  // namespace

bool compares_waits(const ClaimSpec& claim) {
  const Measure* of_run = find_measure(claim.compare, MeasureKind::run);
  return claim.reaches || (of_run != nullptr && of_run->waits && !claim.published);
}

ClaimSides sides_of(const ClaimSpec& claim, std::span<const FigureRun> runs) {
  ClaimSides sides;
  for (std::size_t k = 0; k < (claim.published ? 1 : 2); ++k) {
    const nlohmann::json& where = claim.between.at(k);
    const std::vector<const FigureRun*>& side = sides.runs.at(k) = runs_with(where, runs);
    const bool named = !side.empty() && !side.front()->name.empty();
    if (!where.empty()) sides.names.at(k) = named ? side.front()->name : words_of(where);
    sides.lacks_one = sides.lacks_one || side.empty();
  }
  return sides;
}

std::vector<std::string> problems_of_sides(const ClaimSpec& claim, const ClaimSides& sides,
                                           bool planned) {
  if (!claim.published && claim.between[0] == claim.between[1]) {
    return {"both sides of `between` are the same. Name two variants."};
  }
  std::vector<std::string> problems;
  for (std::size_t k = 0; k < (claim.published ? 1 : 2); ++k) {
    const std::size_t variants = count_variants(sides.runs[k]);
    if (variants == 1 || (variants == 0 && !planned)) continue;
    problems.push_back(
        (claim.between[k].empty()
             ? fmt::format("there are {} variants; `of` must name one.", variants)
             : fmt::format("{}; `{}` must name one{}.", variants_have(variants, claim.between[k]),
                           claim.published ? "of" : "between",
                           claim.published ? "" : " on each side")));
  }
  const auto& [a, b] = sides.runs;
  if (problems.empty() && !a.empty() && !b.empty() && a.front()->stage.id == b.front()->stage.id) {
    problems.emplace_back(
        "both sides of `between` are the same runs, so their difference is exactly zero. Name two "
        "variants that differ.");
  }
  return problems;
}

Figure claim_figure(const ClaimSpec& claim) {
  Figure figure{claim.name, "",
                [claim](std::span<const FigureRun> runs) { return decide_claim(claim, runs); }};
  figure.needs = needs_of({claim.compare});
  figure.within = claim.cycles;
  figure.uses = [claim](const FigureRun& run) {
    return has_parameters(run, claim.between[0]) ||
           (!claim.published && has_parameters(run, claim.between[1]));
  };
  return figure;
}

}  // namespace shearcell
