// SPDX-License-Identifier: GPL-3.0-or-later
// Claims that a manifest states.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "analysis/claims.hpp"
#include "analysis/figure.hpp"
#include "analysis/onset.hpp"
#include "analysis/own_figure.hpp"
#include "provenance/errors.hpp"

namespace shearcell {
namespace {

/// Whether the run has these parameters.
bool has_parameters(const FigureRun& run, const nlohmann::json& where) {
  return std::ranges::all_of(where.items(), [&](const auto& stated) {
    return parameter_of(run, stated.key()) == stated.value();
  });
}

std::size_t variants(RunGroup runs) {
  std::set<std::string> distinct;
  for (const FigureRun* run : runs) distinct.insert(run->variant);
  return distinct.size();
}

/// The runs with these parameters; if they are of several variants, without those of another engine
/// that `run --engine` added.
std::vector<const FigureRun*> runs_with(const nlohmann::json& where,
                                        std::span<const FigureRun> runs) {
  std::vector<const FigureRun*> found;
  for (const FigureRun& run : runs) {
    if (has_parameters(run, where)) found.push_back(&run);
  }
  std::vector<const FigureRun*> as_stated = found;
  std::erase_if(as_stated, [](const FigureRun* run) { return sweeps_engine(*run); });
  return variants(found) > 1 && variants(as_stated) == 1 ? as_stated : found;
}

/// The compared number. Of an expression: the runs must come from with_values().
Scalar scalar_of(const ClaimSpec& claim) {
  Scalar scalar;
  if (const Measure* of_run = find_measure(claim.compare, MeasureKind::run)) {
    scalar = of_whole_run(*of_run);
  } else if (claim.cycles) {
    scalar = over_cycles(claim.compare, claim.compare, static_cast<std::int64_t>(claim.cycles->at(0)),
                         static_cast<std::int64_t>(claim.cycles->at(1)));
  } else {
    const auto of = [text = claim.compare](const FigureRun& run) {
      return measured(number_of(run, text));
    };
    scalar = {claim.compare, claim.compare, of};
  }
  scalar.relative = claim.relative;
  return scalar;
}

/// Whether waiting times are compared: a run may end before the event.
bool compares_waits(const ClaimSpec& claim) {
  const Measure* of_run = find_measure(claim.compare, MeasureKind::run);
  return of_run != nullptr && of_run->waits && !claim.published;
}

std::string published_in_words(const PublishedSpec& published) {
  return fmt::format("{}{} ({})", published.value.value_or(0),
                     published.error > 0 ? fmt::format(" ± {}", published.error) : "",
                     published.source);
}

/// What the claim says. `sides`: names of the variants.
Claim stated(const ClaimSpec& claim, const std::array<std::string, 2>& sides) {
  const bool waits = compares_waits(claim);
  const std::string name = waits ? "the cycle of the onset" : scalar_of(claim).name;
  const bool higher = claim.is == Relation::higher;
  std::string how = "the same";
  if (claim.is != Relation::same) {
    const char* word = waits ? (higher ? "later" : "earlier") : (higher ? "higher" : "lower");
    how = fmt::format("{} by more than {}", word,
                      waits            ? fmt::format("a factor of {:.3g}", std::exp2(claim.margin))
                      : claim.relative ? fmt::format("{} %", 100 * claim.margin)
                                       : fmt::format("{}", claim.margin));
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

FigureResult decide_claim(const ClaimSpec& claim, std::span<const FigureRun> given) {
  const std::vector<FigureRun> runs = with_values(given, {claim.compare});
  std::array<std::vector<const FigureRun*>, 2> sides;
  std::array<std::size_t, 2> counts = {1, 1};
  std::array<std::string, 2> words;  // as people name the variants
  const std::size_t compared = claim.published ? 1 : 2;
  for (std::size_t k = 0; k < compared; ++k) {
    sides.at(k) = runs_with(claim.between.at(k), runs);
    counts.at(k) = std::max<std::size_t>(variants(sides.at(k)), 1);
    const bool named = !sides.at(k).empty() && !sides.at(k).front()->name.empty();
    words.at(k) = named ? sides.at(k).front()->name : words_of(claim.between.at(k));
    if (claim.between.at(k).empty()) words.at(k).clear();
  }
  const Claim decided = stated(claim, words);
  const bool same = !sides[0].empty() && !sides[1].empty() &&
                    sides[0].front()->run_id == sides[1].front()->run_id;
  const std::vector<std::string> problems = problems_of_sides(claim, counts, same);
  if (!problems.empty()) {
    throw UsageError(fmt::format("claim {}: {}", claim.name, problems.front()));
  }
  const bool waits = compares_waits(claim);
  for (std::size_t k = 0; k < compared; ++k) {
    if (!sides.at(k).empty()) continue;
    return {{},
            {decide(decided,
                    "difference in " + (waits ? "the cycle of the onset" : scalar_of(claim).name),
                    std::nullopt, 0,
                    fmt::format("no run{} has a checkpoint{}",
                                words.at(k).empty() ? "" : " with " + words.at(k),
                                claim.cycles ? " of " + scalar_of(claim).reach : ""))}};
  }
  if (claim.published) {
    return {{}, {compare_with(decided, scalar_of(claim), sides[0], *claim.published->value)}};
  }
  return {{},
          {waits ? compare_waits(decided, "the onset", waits_for_onset, sides[0], sides[1])
                 : compare(decided, scalar_of(claim), sides[0], sides[1])}};
}

}  // namespace

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
