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

Scalar scalar_of(const ClaimSpec& claim) {
  if (const Measure* of_run = find_measure(claim.compare, MeasureKind::run)) {
    return of_whole_run(*of_run);
  }
  return over_cycles(claim.compare, claim.compare, static_cast<std::int64_t>(claim.cycles->at(0)),
                     static_cast<std::int64_t>(claim.cycles->at(1)));
}

FigureResult decide_claim(const ClaimSpec& claim, std::span<const FigureRun> runs) {
  const Measure* of_run = find_measure(claim.compare, MeasureKind::run);
  const bool waits = of_run != nullptr && of_run->waits;
  const std::string a = words_of(claim.between[0]), b = words_of(claim.between[1]);
  const std::string name = waits ? "the cycle of the onset" : scalar_of(claim).name;
  const std::string more =
      waits ? fmt::format("later by more than a factor of {:.3g}", std::exp2(claim.margin))
            : fmt::format("higher by more than {}", claim.margin);
  const std::string text =
      claim.is == Relation::higher
          ? fmt::format("{}: {} is {} for {} than for {}", claim.name, name, more, a, b)
          : fmt::format("{}: {} is the same for {} and {}", claim.name, name, a, b);
  const Claim decided{text, claim.margin,
                      claim.is == Relation::higher ? Claimed::above : Claimed::within};
  const auto first = runs_with(claim.between[0], runs), second = runs_with(claim.between[1], runs);
  const bool any = !first.empty() && !second.empty();
  const std::vector<std::string> problems = problems_of_sides(
      claim,
      {std::max<std::size_t>(variants(first), 1), std::max<std::size_t>(variants(second), 1)},
      any && first.front()->run_id == second.front()->run_id);
  if (!problems.empty()) {
    throw UsageError(fmt::format("claim {}: {}", claim.name, problems.front()));
  }
  for (const auto& [side, words] : {std::pair(&first, &a), {&second, &b}}) {
    if (!side->empty()) continue;
    return {{},
            {decide(decided, "difference in " + name, std::nullopt, 0,
                    fmt::format("no run with {} has a checkpoint{}", *words,
                                of_run != nullptr ? "" : " of " + scalar_of(claim).reach))}};
  }
  return {{},
          {waits ? compare_waits(decided, "the onset", waits_for_onset, first, second)
                 : compare(decided, scalar_of(claim), first, second)}};
}

}  // namespace

std::vector<std::string> problems_of_sides(const ClaimSpec& claim,
                                           const std::array<std::size_t, 2>& variants, bool same) {
  if (claim.between[0] == claim.between[1]) {
    return {"both sides of `between` are the same. Name two variants."};
  }
  std::vector<std::string> problems;
  for (std::size_t k = 0; k < 2; ++k) {
    if (variants[k] == 1) continue;
    problems.push_back(fmt::format("{} variants have {}; `between` must name one on each side.",
                                   variants[k], words_of(claim.between[k])));
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
  if (const Measure* one = find_measure(claim.compare)) {
    figure.needs.push_back(provider_of(*one).name);
    figure.within = claim.cycles;
  }
  figure.uses = [claim](const FigureRun& run) {
    return has_parameters(run, claim.between[0]) || has_parameters(run, claim.between[1]);
  };
  return figure;
}

}  // namespace shearcell
