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
  // Estimate::spread is computed from the mean length of the two parts of the interval, below and
  // above the estimate. If one part is much longer, `needed` may be too small, even less than the
  // present number of runs. These runs have not decided the claim, so at least one more is needed.
  return needed ? std::max(*needed, estimate.runs + 1) : needed;
}

json claim_of(const Verdict& verdict) {
  json estimate, interval, runs_needed;
  if (verdict.estimate) {
    const auto& [low, high] = verdict.estimate->interval;
    estimate = rounded(verdict.estimate->value, significant);
    interval = {rounded(low, significant), rounded(high, significant)};
  }
  if (verdict.runs_needed) runs_needed = *verdict.runs_needed;
  json claim = {{"id", verdict.id},
                {"claim", verdict.text},
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

/// The longer of two waiting times divided by the shorter: "3.3" for log2(3.3) and log2(1 / 3.3).
std::string factor(double log2) {
  const double value = std::exp2(std::abs(log2));
  return fmt::format("{:.{}f}", value, value < 10 ? 1 : 0);
}

/// "0.0012, 90 % interval -0.0003 to 0.0027". For waiting times: "the events of the first group
/// come 2.1 times later, 90 % interval 1.3 times later to 3.4 times later".
std::string estimate_with_interval(const Verdict& verdict) {
  const bool waits = !verdict.waits_for.empty();
  const auto text = [&](double value) {
    if (!std::isfinite(value)) return std::string("unbounded");
    return waits ? fmt::format("{} times {}", factor(value), value < 0 ? "earlier" : "later")
                 : fmt::format("{:.3g}", value);
  };
  const auto& [low, high] = verdict.estimate->interval;
  const bool any_end = std::isfinite(low) || std::isfinite(high);
  return fmt::format(
      "{}, {:.3g} % interval {}",
      !std::isfinite(verdict.estimate->value)
          ? "no finite value"
          : (waits ? "the events of the first group come " : "") + text(verdict.estimate->value),
      100 * verdict.level, any_end ? text(low) + " to " + text(high) : text(low));
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
  Verdict verdict{claim, std::move(quantity), estimate};
  verdict.runs = runs;
  verdict.counted = counted;
  verdict.note = std::move(note);
  verdict.entered = std::move(entered);
  if (!claim.cannot_be_decided.empty()) {
    verdict.ruling = Ruling::undecidable;
    add_note(verdict.note, claim.cannot_be_decided);
  }
  if (!estimate || verdict.ruling == Ruling::undecidable) return verdict;
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

bool is_firm(Ruling ruling) {
  return ruling != Ruling::undecided && ruling != Ruling::undecidable;
}

void withhold(Verdict& verdict) {
  if (verdict.ruling != Ruling::undecidable) verdict.ruling = Ruling::undecided;
}

Table entered_table(std::span<const Verdict> verdicts) {
  Table table{.name = "entered", .columns = {"id", "claim"}};
  for (const Verdict& verdict : verdicts) {
    std::vector<std::size_t> places;
    for (const TableColumn& column : verdict.entered.columns) {
      places.push_back(table.place(column.name));
      if (places.back() == table.columns.size()) table.columns.push_back(column);
    }
    for (const TableRow& values : verdict.entered.rows) {
      TableRow& row = table.rows.emplace_back(TableRow{verdict.id, verdict.text});
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
  std::string text =
      verdict.estimate ? estimate_with_interval(verdict) : std::string("not measured");
  const std::string times = factor(verdict.margin);
  text += verdict.waits_for.empty() ? fmt::format(", margin {:.3g}", verdict.margin)
                                    : ", margin: " + (times == "2.0" ? "twice" : times + " times");
  text += fmt::format(", {}{}",
                      counted(verdict.runs, verdict.counted == Counted::pairs ? "pair" : "run"),
                      verdict.counted == Counted::runs_per_variant ? " per variant" : "");
  if (verdict.runs_needed) text += fmt::format(" ({} needed)", *verdict.runs_needed);
  if (verdict.censored > 0) text += fmt::format(", {} censored", verdict.censored);
  if (verdict.primary) text += ", primary claim";
  return text;
}

std::string result_of(const Verdict& verdict) {
  const std::string quantity = verdict.waits_for.empty()
                                   ? verdict.quantity
                                   : fmt::format("cycle of {} (log-rank test)", verdict.waits_for);
  return fmt::format("{}: {}{}{}", quantity, numbers_of(verdict), verdict.note.empty() ? "" : "; ",
                     verdict.note);
}

}  // namespace shearcell
