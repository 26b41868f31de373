// SPDX-License-Identifier: GPL-3.0-or-later
// A claim decided by an interval and a margin.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/chart.hpp"
#include "analysis/statistics.hpp"
#include "core/named.hpp"

namespace shearcell {

/// The ruling on a claim of equality is `agrees` or `differs`; on a claim of a direction it is
/// `supported` or `refuted`. More runs may decide a claim that is `undecided`. No number of runs
/// decides a claim that is `undecidable`.
enum class Ruling { agrees, supported, differs, refuted, undecided, undecidable };
template <>
inline constexpr auto kNames<Ruling> = names_in_order<Ruling>("agrees", "supported", "differs",
                                                              "refuted", "undecided",
                                                              "cannot be decided");

/// The range in which a claim expects the quantity: from -margin to margin (`same`), above margin
/// (`higher`) or below margin (`lower`, with a margin of 0 or less). If a claim compares two
/// variants, the quantity is the value of the first variant minus the value of the second.
enum class Relation : std::uint8_t { same, higher, lower };
template <>
inline constexpr auto kNames<Relation> = names_in_order<Relation>("same", "higher", "lower");

struct Claim {
  std::string text;  ///< the claim in words: "C: the critical size grows with A"
  double margin = 0;
  Relation claimed = Relation::same;
  std::string id = {};  ///< "S5a.onset@amplitude_rad=0.05"
  double level = confidence_level;
  std::string cannot_be_decided = {};  ///< why no number of runs can decide the claim, or ""
};

/// The unit in which a verdict counts its runs.
enum class Counted { runs, pairs, runs_per_variant };
template <>
inline constexpr auto kNames<Counted> = names_in_order<Counted>("runs", "pairs",
                                                                "runs per variant");

/// A claim, and what the runs say about it.
struct Verdict : Claim {
  std::string quantity = {};              ///< what is estimated, with its unit
  std::optional<Estimate> estimate = {};  ///< empty if too few runs have a value
  /// The event of a claim on waiting times; "" for other claims. If the claim has an event,
  /// then `estimate` and `margin` are log2 of a ratio of waiting times (first group / second
  /// group).
  std::string waits_for = {};
  Ruling ruling = Ruling::undecided;
  std::size_t runs = 0;  ///< number of runs or of pairs; see `counted`
  Counted counted = Counted::runs;
  std::size_t censored = 0;                     ///< runs that ended before the event
  std::optional<std::size_t> runs_needed = {};  ///< for an undecided claim; empty if unknown
  std::vector<std::size_t> looks = {};  ///< numbers of seeds at the planned interim analyses
  std::size_t look = 0;                 ///< number of seeds at the last look; 0: no look yet
  /// Probability that a repetition of this study decides the claim no later than at the next look
  /// of this study, if `estimate` is the true value. Empty if the claim is decided, or if only one
  /// look is planned.
  std::optional<double> power = {};
  std::string note = {};  ///< how the runs were compared, and which runs are missing
  bool primary = false;   ///< the manifest lists the claim under `primary`
  Table entered = {};     ///< rows with the numbers that the verdict uses
};

/// Returns `agrees` (for Relation::same) or `supported` if the whole interval lies inside the range
/// of the Relation, `differs` (for Relation::same) or `refuted` if the whole interval lies outside
/// this range, and `undecided` otherwise.
Ruling ruling_of(const Interval& interval, double margin, Relation claimed);

/// The verdict that follows from the estimate's interval; undecided without an estimate. If the
/// claim has a reason why it cannot be decided, the verdict is undecidable, with this reason.
/// `runs_needed`: number of runs (counted as in Verdict::runs) that would decide an undecided claim
/// with 90 % probability. The assumed true value is 0 (Relation::same) or twice the margin (other
/// relations). If the interval excludes 0, or if Estimate::runs would then be enough, the estimate
/// is taken as the true value instead.
Verdict decide(const Claim& claim, std::string quantity, const std::optional<Estimate>& estimate,
               std::size_t runs, std::string note, Table entered = {},
               Counted counted = Counted::runs);

/// The number of verdicts with each ruling. Rulings that do not occur are left out.
std::map<Ruling, std::size_t> rulings_of(std::span<const Verdict> verdicts);

/// The rulings in words, such as "1 agrees, 1 refuted"; "" without verdicts.
std::string headline_of(const std::map<Ruling, std::size_t>& rulings);

/// Whether the ruling decides the claim: neither `undecided` nor `undecidable`.
bool is_firm(Ruling ruling);

/// Changes the ruling to `undecided`. The ruling `undecidable` is not changed.
void withhold(Verdict& verdict);

/// Joins the tables Verdict::entered of all verdicts into one table. The first columns are the id
/// and the text of the claim.
Table entered_table(std::span<const Verdict> verdicts);

/// {"verdict", "claims": [{"id", "claim", "quantity", "estimate", "interval": [low, high], "level",
/// "margin", "verdict", "runs", "counted", "runs_needed", "note"}]}. A claim also has "censored",
/// "looks", "look" and "primary" if they apply. The first "verdict" is headline_of() or null.
/// Numbers have six significant digits. A missing number and an infinite end of an interval are
/// null. The same verdicts give the same bytes.
nlohmann::json to_json(std::span<const Verdict> verdicts);

/// "0.0012, 90 % interval -0.0003 to 0.0027, margin 0.001, 6 runs per variant (24 needed)". Here
/// 24 runs per variant are needed. For waiting times: "the events of the first group come 2.1 times
/// later, 90 % interval 1.3 times later to 3.4 times later, margin: 1.5 times, 6 runs per variant".
std::string numbers_of(const Verdict& verdict);

/// The quantity, numbers_of() and the note, as the terminal and the report print them:
/// "cycle of the onset (log-rank test): the events of the first group come 2.1 times later, ...".
std::string result_of(const Verdict& verdict);

}  // namespace shearcell
