// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/claims.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string/replace.hpp>
#include <cmath>
#include <set>
#include <utility>

#include "analysis/estimators.hpp"
#include "analysis/looks.hpp"
#include "analysis/plots.hpp"
#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

bool is_of(const ClaimSpec& claim, const FrameRun& run) {
  return has_parameters(run, claim.where) &&
         (has_parameters(run, claim.between[0]) ||
          (!has_one_side(claim) && has_parameters(run, claim.between[1])));
}

/// The parameters that a run of side `k` must have.
nlohmann::json selected_on(const ClaimSpec& claim, std::size_t k) {
  nlohmann::json where = claim.where;
  where.update(claim.between.at(k));
  return where;
}

/// Returns the estimated quantity in words, for sentences.
std::string words_of(const ClaimSpec& claim) {
  const Estimator& estimator = estimator_of(claim);
  return estimator.words != nullptr ? estimator.words(claim) : estimator.scalar(claim).name;
}

/// Adds to the note how many runs begin to crystallize before the last cycle of ClaimSpec::cycles,
/// since crystallization changes a mean over these cycles.
void note_early_onsets(const ClaimSpec& claim, std::initializer_list<RunGroup> groups,
                       Verdict& verdict) {
  if (!claim.cycles || claim.cycles->at(0) == claim.cycles->at(1)) return;
  const std::uint64_t last = claim.cycles->at(1);
  std::size_t early = 0, all = 0;
  for (const RunGroup group : groups) {
    all += group.size();
    early += static_cast<std::size_t>(
        std::ranges::count_if(waits_for_onset(group), [&](const CensoredValue& wait) {
          return !wait.censored && wait.value < static_cast<double>(last);
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

/// What to add to a side that selects several variants: "Add `pressure_Pa: 300` or another value."
std::string remedy_for(RunGroup side) {
  std::vector<std::string> values;
  for (const std::string& key : varied_keys(swept_of(side))) {
    values.push_back(fmt::format("{}: {}", key, value_text(parameter_of(*side.front(), key))));
  }
  return values.empty() ? "" : fmt::format(" Add `{}` or other values.", fmt::join(values, ", "));
}

/// The combinations of swept values among the runs of side `k`. The keys that select side `k` are
/// left out. A claim may average over the variants of each side if both sides have the same
/// combinations.
std::set<nlohmann::json> others_of(const ClaimSpec& claim, const ClaimSides& sides, std::size_t k) {
  std::set<nlohmann::json> others;
  for (const FrameRun* run : sides.runs.at(k)) {
    nlohmann::json swept = run->place.swept;
    for (const auto& [key, value] : claim.between.at(k).items()) {
      if (swept.is_object()) swept.erase(key);  // false only in a damaged store
    }
    others.insert(std::move(swept));
  }
  return others;
}

/// The verdict on the claim from the runs of its sides; `b` is empty if the claim has one side.
Verdict decided_by(const ClaimSpec& claim, const Claim& stated, RunGroup a, RunGroup b) {
  const Estimator& estimator = estimator_of(claim);
  if (estimator.decide != nullptr) return estimator.decide(claim, stated, a, b);
  Scalar scalar = estimator.scalar(claim);
  scalar.relative = claim.relative;
  if (claim.published) {
    const double published = *claim.published->value;
    if (claim.margin > 0) return compare_with(stated, scalar, a, published);
    Claim bound = stated;
    bound.margin = published;
    return compare_with(bound, scalar, a, 0);
  }
  Verdict verdict = compare(stated, scalar, a, b);
  note_early_onsets(claim, {a, b}, verdict);
  return verdict;
}

/// A look (interim analysis) at n seeds uses the first n of the seeds that both sides have. The
/// look is made when all runs of these seeds have ended. If no looks are planned, there is one
/// look, at all seeds that at least one side has. Returns the verdict of the first look that
/// decides the claim. If no look decides the claim, the verdict is undecided. Its numbers are then
/// computed from the seeds before the first seed with a planned run (Frame::pending). If there are
/// no seeds before it, or if no run is planned, the numbers are computed from all seeds. Seeds that
/// are in no look are used only in Verdict::note. `planned`: the planned runs of the two sides.
Verdict at_looks(const ClaimSpec& claim, Claim stated, const ClaimSides& sides,
                 const ClaimSides& planned, const Frame& frame) {
  const auto seeds_of = [](std::initializer_list<RunGroup> groups) {
    std::set<std::uint64_t> seeds;
    for (const RunGroup group : groups) {
      for (const FrameRun* run : group) seeds.insert(run->place.seed);
    }
    return seeds;
  };
  const auto& [a, b] = sides.runs;
  const auto& [planned_a, planned_b] = planned.runs;
  std::set<std::uint64_t> begun = seeds_of({a, b});
  const std::set<std::uint64_t> pending = seeds_of({planned_a, planned_b});
  const std::set<std::uint64_t> of_a = seeds_of({a, planned_a}), of_b = seeds_of({b, planned_b});
  const bool paired = !frame.looks.empty() && !has_one_side(claim);
  const auto lacks = [&](std::uint64_t seed) {
    return paired ? !of_a.contains(seed) || !of_b.contains(seed)
                  : !of_a.contains(seed) && !of_b.contains(seed);
  };
  std::erase_if(begun, lacks);
  std::vector<std::uint64_t> seeds = frame.seeds;
  std::erase_if(seeds, lacks);
  const auto of_first = [&](std::size_t count) {
    const std::span first = std::span(seeds).first(count);
    std::array<std::vector<const FrameRun*>, 2> runs = sides.runs;
    for (auto& side : runs) {
      std::erase_if(side, [&](const FrameRun* run) {
        return std::ranges::find(first, run->place.seed) == first.end();
      });
    }
    return decided_by(claim, stated, runs[0], runs[1]);
  };
  if (seeds.empty()) return decided_by(claim, stated, a, b);
  std::vector<std::size_t> looks = frame.looks;
  if (looks.empty()) looks = {seeds.size()};
  for (std::size_t& look : looks) look = std::min(look, seeds.size());
  looks.erase(std::unique(looks.begin(), looks.end()), looks.end());
  seeds.resize(looks.back());
  const auto first_pending =
      std::ranges::find_if(seeds, [&](std::uint64_t seed) { return pending.contains(seed); });
  const auto ended = static_cast<std::size_t>(first_pending - seeds.begin());
  stated.level = look_level(looks);
  Verdict verdict;
  std::size_t taken = 0;
  for (const std::size_t look : looks) {
    if (look > ended || is_firm(verdict.ruling)) break;
    verdict = of_first(taken = look);
  }
  const auto next = std::ranges::upper_bound(looks, ended);
  const std::size_t shown = ended > 0 ? ended : seeds.size();
  if (!is_firm(verdict.ruling) && shown != taken) {
    verdict = of_first(shown);
    withhold(verdict);
  }
  if (verdict.ruling == Ruling::undecided && next != looks.end()) {
    verdict.runs_needed.reset();
    add_note(verdict.note,
             fmt::format("{} of {} have ended; the next look (interim analysis) is at {}", ended,
                         counted(seeds.size(), "seed"), counted(*next, "seed")));
    if (const auto& now = verdict.estimate; looks.size() > 1 && now && std::isfinite(now->spread)) {
      // A seed may have several runs (one of each variant), or a run that has no number.
      const auto used = std::ranges::count_if(std::span(seeds).first(shown),
                                              [&](auto seed) { return begun.contains(seed); });
      const double spread =
          now->spread * std::sqrt(static_cast<double>(used) / static_cast<double>(verdict.runs));
      const auto power = power_of(verdict, now->value, spread, now->groups, looks);
      const LookPower& there = power[static_cast<std::size_t>(next - looks.begin())];
      verdict.power = there.as_claimed + there.against;
      add_note(verdict.note,
               fmt::format("if this estimate is the true value, the claim is decided at or "
                           "before that look with probability {:.2f}",
                           *verdict.power));
    }
  }
  if (!frame.looks.empty()) verdict.looks = looks, verdict.look = taken;
  if (taken == looks.back() && verdict.ruling == Ruling::undecided && !frame.looks.empty()) {
    verdict.runs_needed.reset();
    add_note(verdict.note, "the last planned look has not decided the claim");
  }
  std::erase_if(begun, [&](std::uint64_t seed) { return std::ranges::count(seeds, seed) > 0; });
  if (begun.empty()) return verdict;
  const Verdict all = decided_by(claim, stated, a, b);
  add_note(verdict.note,
           fmt::format("an unplanned look (interim analysis), with {} more than planned, gives: {}",
                       counted(begun.size(), "seed"), numbers_of(all)));
  return verdict;
}

/// Returns nothing if the claim is optional and one of its sides has no runs.
std::optional<Verdict> decide_one(const ClaimSpec& claim, const Frame& frame) {
  ClaimSides sides = sides_of(claim, frame.runs);
  if (claim.optional && sides.lacks_one) return {};
  const ClaimSides planned = sides_of(claim, frame.pending);
  for (std::size_t k = 0; k < 2; ++k) {  // a side without runs is named after its planned runs
    if (sides.runs[k].empty() && !planned.runs[k].empty()) sides.names[k] = planned.names[k];
  }
  const Claim decided = stated(claim, sides.names);
  const std::vector<std::string> problems = problems_of_sides(claim, sides, false);
  if (!problems.empty() && !claim.listed) {
    throw UsageError(fmt::format("claim {}: {}", claim.id, problems.front()));
  }
  if (!problems.empty()) sides.runs = {};
  if (sides.lacks_one && !claim.listed) {
    const nlohmann::json where = selected_on(claim, sides.runs[0].empty() ? 0 : 1);
    const Estimator& estimator = estimator_of(claim);
    const bool of_cycles = claim.cycles && estimator.scalar != nullptr;
    const Verdict none = decided_by(claim, decided, {}, {});
    Verdict verdict = decide(decided, none.quantity, std::nullopt, 0,
                             fmt::format("no run{} has a checkpoint{}",
                                         where.empty() ? "" : " with " + shearcell::words_of(where),
                                         of_cycles ? " of " + estimator.scalar(claim).reach : ""));
    verdict.waits_for = none.waits_for;
    return verdict;
  }
  return at_looks(claim, decided, sides, planned, frame);
}

}  // namespace

bool has_one_side(const ClaimSpec& claim) {
  return claim.published || estimator_of(claim).one_side;
}

std::string figure_of(const ClaimSpec& claim) {
  return claim.figure.empty() ? claim.id.substr(0, claim.id.find('.')) : claim.figure;
}

Claim stated(const ClaimSpec& claim, const std::array<std::string, 2>& sides) {
  const bool waits = compares_waits(claim);
  const std::string name = words_of(claim);
  const bool same = claim.is == Relation::same, higher = claim.is == Relation::higher;
  std::string how = same ? "the same" : std::string(name_of(claim.is));
  if (waits && !same) how = higher ? "later" : "earlier";
  if (!same && claim.margin > 0) {
    how += " by more than " + (waits ? fmt::format("a factor of {:.3g}", std::exp2(claim.margin))
                               : claim.relative ? fmt::format("{:.6g} %", 100 * claim.margin)
                                                : fmt::format("{}", claim.margin));
  }
  std::string text = claim.statement;
  if (text.empty() && has_one_side(claim)) {
    const std::string as = claim.published ? "as " : fmt::format("within {} of ", claim.margin);
    text = fmt::format("{}: {} is {}{}{}", claim.id, name, same ? as : how + " than ",
                       claim.published ? "published, " + published_in_words(*claim.published)
                                       : std::string(estimator_of(claim).reference),
                       sides[0].empty() ? "" : ", for " + sides[0]);
  } else if (text.empty()) {
    text = fmt::format("{}: {} is {} for {} {} {}", claim.id, name, how, sides[0],
                       same ? "and" : "than for", sides[1]);
  }
  return {.text = text,
          .margin = claim.is == Relation::lower ? -claim.margin : claim.margin,
          .claimed = claim.is,
          .id = claim.id,
          .cannot_be_decided = claim.cannot_be_decided};
}

ClaimSides sides_of(const ClaimSpec& claim, std::span<const FrameRun> runs) {
  ClaimSides sides;
  for (std::size_t k = 0; k < (has_one_side(claim) ? 1U : 2U); ++k) {
    const nlohmann::json& where = claim.between.at(k);
    const std::vector<const FrameRun*>& side = sides.runs.at(k) =
        runs_with(selected_on(claim, k), runs);
    const std::string name = shared_name(side);
    if (!where.empty()) sides.names.at(k) = name.empty() ? words_of(where) : name;
    sides.lacks_one = sides.lacks_one || side.empty();
  }
  return sides;
}

std::vector<std::string> problems_of_sides(const ClaimSpec& claim, const ClaimSides& sides,
                                           bool planned) {
  if (!has_one_side(claim) && claim.between[0] == claim.between[1]) {
    return {"both sides of `between` are the same. Name two variants."};
  }
  std::vector<std::string> problems;
  const bool averages =
      !has_one_side(claim) && others_of(claim, sides, 0) == others_of(claim, sides, 1);
  for (std::size_t k = 0; k < (has_one_side(claim) ? 1U : 2U); ++k) {
    const std::size_t variants = count_variants(sides.runs[k]);
    if (variants == 1 || (variants > 1 && (averages || estimator_of(claim).over_variants)) ||
        (variants == 0 && !planned))
      continue;
    const nlohmann::json where = selected_on(claim, k);
    problems.push_back(fmt::format("{}; `{}` must select one variant{}.{}",
                                   where.empty() ? fmt::format("there are {} variants", variants)
                                                 : variants_have(variants, where),
                                   has_one_side(claim) ? "of" : "between",
                                   has_one_side(claim) ? "" : " on each side",
                                   remedy_for(sides.runs[k])));
  }
  const auto& [a, b] = sides.runs;
  const std::set<std::string_view> of_a = stage_ids(a);
  const auto shared = static_cast<std::size_t>(
      std::ranges::count_if(b, [&](const FrameRun* run) { return of_a.contains(run->stage.id); }));
  if (!problems.empty() || shared == 0) return problems;
  return {shared == b.size()
              ? "both sides of `between` select the same runs, so the difference is exactly zero. "
                "Choose two different variants."
              : fmt::format("{} on both sides of `between`. Select sides that share no run.",
                            shared == 1 ? "1 run is" : fmt::format("{} runs are", shared))};
}

std::vector<ClaimSpec> each_of(const ClaimSpec& claim, std::span<const FrameRun> runs) {
  if (claim.for_each.empty()) return {claim};
  std::set<nlohmann::json> values;
  for (const FrameRun& run : runs) {
    const nlohmann::json value = parameter_of(run, claim.for_each);
    if (is_of(claim, run) && !value.is_null()) values.insert(value);
  }
  std::vector<ClaimSpec> each;
  for (const nlohmann::json& value : values) {
    ClaimSpec& one = each.emplace_back(claim);
    const std::string text = value_text(value);
    one.for_each.clear();
    one.where[claim.for_each] = value;
    one.id += fmt::format("@{}={}", claim.for_each, text);
    boost::replace_all(one.statement, "{" + claim.for_each + "}", text);
  }
  return each.empty() ? std::vector{claim} : each;
}

Figure claim_figure(const ClaimSpec& claim) {
  Figure figure{claim.id, "", [claim](const Frame& frame) {
                  FigureResult result;
                  for (const ClaimSpec& one : each_of(claim, frame.runs)) {
                    if (auto verdict = decide_one(one, frame)) {
                      result.verdicts.push_back(std::move(*verdict));
                    }
                  }
                  return result;
                }};
  figure.claims = {claim.id};
  const std::vector<std::string> columns = {claim.compare, claim.against};
  figure.needs = providers_of(columns);
  figure.within = claim.cycles;
  figure.uses = [claim](const FrameRun& run) { return is_of(claim, run); };
  return figure;
}

}  // namespace shearcell
