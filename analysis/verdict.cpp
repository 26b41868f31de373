// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/verdict.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "provenance/json_text.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

constexpr int significant = 6;  // digits

std::optional<std::size_t> runs_needed(const Estimate& estimate, double margin, Relation claimed) {
  const bool within = claimed == Relation::same;
  const bool may_be_zero = estimate.interval.low <= 0 && estimate.interval.high >= 0;
  const std::optional<std::size_t> planned = runs_to_resolve(estimate, std::abs(margin), within);
  if (may_be_zero && (!planned || *planned > estimate.runs)) return planned;
  const double size = within ? std::abs(estimate.value) : estimate.value;
  const auto needed = runs_to_resolve(estimate, std::abs(size - margin), false);
  // The spread is the mean of both sides of the interval, of which one may be much longer.
  return needed ? std::max(*needed, estimate.runs + 1) : needed;
}

json claim_of(const Verdict& verdict) {
  json estimate, interval, runs_needed;
  if (verdict.estimate) {
    estimate = rounded(*verdict.estimate, significant);
    interval = {rounded(verdict.interval.low, significant),
                rounded(verdict.interval.high, significant)};
  }
  if (verdict.runs_needed) runs_needed = *verdict.runs_needed;
  json claim = {{"id", verdict.id},
                {"claim", verdict.claim},
                {"quantity", verdict.quantity},
                {"estimate", estimate},
                {"interval", interval},
                {"level", rounded(verdict.level, significant)},
                {"margin", rounded(verdict.margin, significant)},
                {"verdict", name_of(verdict.ruling)},
                {"runs", verdict.runs},
                {"counted", name_of(verdict.counted)},
                {"runs_needed", runs_needed},
                {"note", verdict.note}};
  if (verdict.censored > 0) claim["censored"] = verdict.censored;
  if (!verdict.looks.empty()) claim["looks"] = verdict.looks, claim["look"] = verdict.look;
  if (verdict.primary) claim["primary"] = true;
  return claim;
}

}  // namespace

Ruling ruling_of(const Interval& interval, double margin, Relation claimed) {
  const bool is_above = interval.low > margin;
  const bool is_below = interval.high < margin;
  if (claimed == Relation::same) {
    if (interval.low >= -margin && interval.high <= margin) return Ruling::agrees;
    return is_above || interval.high < -margin ? Ruling::differs : Ruling::undecided;
  }
  if (is_above) return claimed == Relation::higher ? Ruling::supported : Ruling::refuted;
  if (is_below) return claimed == Relation::lower ? Ruling::supported : Ruling::refuted;
  return Ruling::undecided;
}

Verdict decide(const Claim& claim, std::string quantity, const std::optional<Estimate>& estimate,
               std::size_t runs, std::string note, Table entered, Counted counted) {
  Verdict verdict;
  verdict.id = claim.id;
  verdict.claim = claim.text;
  verdict.quantity = std::move(quantity);
  verdict.margin = claim.margin;
  verdict.level = claim.level;
  verdict.runs = runs;
  verdict.counted = counted;
  verdict.note = std::move(note);
  verdict.entered = std::move(entered);
  if (!claim.cannot_be_decided.empty()) {
    verdict.ruling = Ruling::undecidable;
    verdict.note += (verdict.note.empty() ? "" : "; ") + claim.cannot_be_decided;
  }
  if (!estimate) return verdict;
  verdict.estimate = estimate->value;
  verdict.interval = estimate->interval;
  verdict.spread = estimate->spread;
  verdict.groups = estimate->groups;
  if (verdict.ruling == Ruling::undecidable) return verdict;
  verdict.ruling = ruling_of(estimate->interval, claim.margin, claim.claimed);
  if (verdict.ruling == Ruling::undecided) {
    verdict.runs_needed = runs_needed(*estimate, claim.margin, claim.claimed);
  }
  return verdict;
}

std::map<Ruling, std::size_t> rulings_of(std::span<const Verdict> verdicts) {
  std::map<Ruling, std::size_t> counts;
  for (const Verdict& verdict : verdicts) ++counts[verdict.ruling];
  return counts;
}

std::string headline_of(const std::map<Ruling, std::size_t>& rulings) {
  std::vector<std::string> words;
  for (const auto& [ruling, count] : rulings) {
    words.push_back(fmt::format("{} {}", count, name_of(ruling)));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

Table entered_table(std::span<const Verdict> verdicts) {
  Table table{.name = "entered", .columns = {"claim"}};
  for (const Verdict& verdict : verdicts) {
    std::vector<std::size_t> places;
    for (const TableColumn& column : verdict.entered.columns) {
      places.push_back(table.place(column.name));
      if (places.back() == table.columns.size()) table.columns.push_back(column);
    }
    for (const TableRow& values : verdict.entered.rows) {
      TableRow& row = table.rows.emplace_back(TableRow{verdict.claim});
      row.resize(table.columns.size());
      for (std::size_t k = 0; k < values.size(); ++k) row[places[k]] = values[k];
    }
  }
  for (TableRow& row : table.rows) row.resize(table.columns.size());
  return table;
}

json to_json(std::span<const Verdict> verdicts) {
  json claims = json::array();
  for (const Verdict& verdict : verdicts) claims.push_back(claim_of(verdict));
  const std::string words = headline_of(rulings_of(verdicts));
  return {{"verdict", words.empty() ? json() : json(words)}, {"claims", std::move(claims)}};
}

std::string numbers_of(const Verdict& verdict) {
  const auto end = [](double value) {
    return std::isfinite(value) ? fmt::format("{:.3g}", value) : std::string("unbounded");
  };
  const auto [low, high] = verdict.interval;
  const bool any_end = std::isfinite(low) || std::isfinite(high);
  std::string text = "not measured";
  if (verdict.estimate) {
    text = std::isfinite(*verdict.estimate) ? end(*verdict.estimate) : "no finite value";
    text += fmt::format(", {:.3g} % interval {}", 100 * verdict.level,
                        any_end ? end(low) + " to " + end(high) : end(low));
  }
  text += fmt::format(", margin {:.3g}, {}{}", verdict.margin,
                      counted(verdict.runs, verdict.counted == Counted::pairs ? "pair" : "run"),
                      verdict.counted == Counted::runs_per_variant ? " per variant" : "");
  if (verdict.is_log2 && verdict.estimate && any_end) {
    const double least = std::exp2(low), most = std::exp2(high);
    text += std::isinf(high)  ? fmt::format(" (a ratio of at least {:.2g}", least)
            : std::isinf(low) ? fmt::format(" (a ratio of at most {:.2g}", most)
                              : fmt::format(" (a ratio from {:.2g} to {:.2g}", least, most);
    text += fmt::format("; margin: a factor of {:.3g})", std::exp2(verdict.margin));
  }
  if (verdict.runs_needed) text += fmt::format(" of {} needed", *verdict.runs_needed);
  if (verdict.censored > 0) text += fmt::format(", {} censored", verdict.censored);
  if (verdict.primary) text += ", primary claim";
  return text;
}

}  // namespace shearcell
