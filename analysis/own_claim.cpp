// SPDX-License-Identifier: GPL-3.0-or-later
// Claims that a manifest states.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "analysis/claims.hpp"
#include "analysis/expression.hpp"
#include "analysis/figure.hpp"
#include "analysis/onset.hpp"
#include "analysis/own_figure.hpp"
#include "provenance/errors.hpp"

namespace shearcell {
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

/// What the claim says. `sides`: names of the variants.
Claim stated(const ClaimSpec& claim, const std::array<std::string, 2>& sides) {
  const bool waits = compares_waits(claim);
  const std::string name = quantity_of(claim);
  const bool higher = claim.is == Relation::higher;
  std::string how = "the same";
  if (claim.is != Relation::same) {
    const char* word = waits ? (higher ? "later" : "earlier") : (higher ? "higher" : "lower");
    how = word;
    if (claim.margin > 0) {
      how += " by more than " + (waits ? fmt::format("a factor of {:.3g}", std::exp2(claim.margin))
                                 : claim.relative ? fmt::format("{} %", 100 * claim.margin)
                                                  : fmt::format("{}", claim.margin));
    }
  }
  const bool same = claim.is == Relation::same;
  std::string text = claim.statement;
  if (text.empty() && claim.published) {
    text = fmt::format(
        "{}: {} is {} {}{}", claim.name, name, same ? "as published," : how + " than published,",
        published_in_words(*claim.published), sides[0].empty() ? "" : ", for " + sides[0]);
  } else if (text.empty()) {
    text = fmt::format("{}: {} is {} for {} {} {}", claim.name, name, how, sides[0],
                       same ? "and" : "than for", sides[1]);
  }
  if (same) return {text, claim.margin, Claimed::within};
  return higher ? Claim{text, claim.margin, Claimed::above}
                : Claim{text, -claim.margin, Claimed::below};
}

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
  std::array<std::vector<const FigureRun*>, 2> sides;
  std::array<std::size_t, 2> counts = {1, 1};
  std::array<std::string, 2> words;  // as people name the variants
  const std::size_t compared = claim.published ? 1 : 2;
  for (std::size_t k = 0; k < compared; ++k) {
    sides.at(k) = runs_with(claim.between.at(k), runs);
    counts.at(k) = std::max<std::size_t>(count_variants(sides.at(k)), 1);
    const bool named = !sides.at(k).empty() && !sides.at(k).front()->name.empty();
    words.at(k) = named ? sides.at(k).front()->name : words_of(claim.between.at(k));
    if (claim.between.at(k).empty()) words.at(k).clear();
    if (claim.optional && sides.at(k).empty()) return {};
  }
  const Claim decided = stated(claim, words);
  const bool same = !sides[0].empty() && !sides[1].empty() &&
                    sides[0].front()->run_id == sides[1].front()->run_id;
  const std::vector<std::string> problems = problems_of_sides(claim, counts, same);
  if (!problems.empty() && !claim.listed) {
    throw UsageError(fmt::format("claim {}: {}", claim.name, problems.front()));
  }
  if (!problems.empty()) sides = {};
  for (std::size_t k = 0; k < compared; ++k) {
    if (!sides.at(k).empty() || claim.listed) continue;
    return {{},
            {decide(decided, "difference in " + quantity_of(claim), std::nullopt, 0,
                    fmt::format("no run{} has a checkpoint{}",
                                words.at(k).empty() ? "" : " with " + words.at(k),
                                claim.cycles ? " of " + scalar_of(claim).reach : ""))}};
  }
  return {{}, {decided_by(claim, decided, sides[0], sides[1])}};
}

}  // namespace

bool compares_waits(const ClaimSpec& claim) {
  const Measure* of_run = find_measure(claim.compare, MeasureKind::run);
  return claim.reaches || (of_run != nullptr && of_run->waits && !claim.published);
}

std::vector<std::string> problems_of_sides(const ClaimSpec& claim,
                                           const std::array<std::size_t, 2>& variants, bool same) {
  if (!claim.published && claim.between[0] == claim.between[1]) {
    return {"both sides of `between` are the same. Name two variants."};
  }
  std::vector<std::string> problems;
  for (std::size_t k = 0; k < (claim.published ? 1 : 2); ++k) {
    if (variants[k] == 1) continue;
    problems.push_back(
        (claim.between[k].empty()
             ? fmt::format("there are {} variants; `of` must name one.", variants[k])
             : fmt::format("{} variants have {}; `{}` must name one{}.", variants[k],
                           words_of(claim.between[k]), claim.published ? "of" : "between",
                           claim.published ? "" : " on each side")));
  }
  if (same) {
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
