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

/// A claim of equality agrees or differs. A claim of a direction is supported or refuted. More runs
/// may decide a claim that is undecided, but not one that cannot be decided.
enum class Ruling { agrees, supported, differs, refuted, undecided, undecidable };
template <>
inline constexpr auto kNames<Ruling> = names_in_order<Ruling>("agrees", "supported", "differs",
                                                              "refuted", "undecided",
                                                              "cannot be decided");

/// Where a claim puts its quantity: from -margin to margin (`same`), above the margin, or below it.
/// The quantity of two variants is the difference, the first less the second.
enum class Relation : std::uint8_t { same, higher, lower };
template <>
inline constexpr auto kNames<Relation> = names_in_order<Relation>("same", "higher", "lower");

struct Claim {
  std::string text;  ///< in the supplement's sense, with its section
  double margin = 0;
  Relation claimed = Relation::same;
  std::string id = {};  ///< "S5a.onset@amplitude_rad=0.05"
  double level = confidence_level;
  std::string cannot_be_decided = {};  ///< why no number of runs would decide it; "": runs may
};

/// What the runs of a verdict are counted in.
enum class Counted { runs, pairs, runs_per_variant };
template <>
inline constexpr auto kNames<Counted> = names_in_order<Counted>("runs", "pairs",
                                                                "runs per variant");

struct Verdict {
  std::string id = {};             ///< of the claim
  std::string claim;               ///< its text
  std::string quantity;            ///< what is estimated, with its unit
  std::optional<double> estimate;  ///< none if too few runs have the quantity
  Interval interval;               ///< only with an estimate
  double level = confidence_level;
  /// The event of a claim on waiting times. `estimate`, `interval` and `margin` are then log2 of
  /// the ratio of the first group's waiting time to the second's. "" for other claims.
  std::string waits_for = {};
  double margin = 0;
  Ruling ruling = Ruling::undecided;
  std::size_t runs = 0;  ///< as `counted` says
  Counted counted = Counted::runs;
  std::size_t censored = 0;  ///< runs that ended before the event, among those that entered
  std::optional<std::size_t> runs_needed;  ///< if undecided; none if it is not known
  double spread = 0;                       ///< Estimate::spread
  std::size_t groups = 1;                  ///< Estimate::groups
  std::vector<std::size_t> looks = {};     ///< planned numbers of seeds; empty: not planned
  std::size_t look = 0;                    ///< seeds of the look that was taken; 0: none yet
  std::string note;                        ///< how it was compared, what is missing
  bool primary = false;  ///< its runs were made to decide it; others are exploratory
  Table entered = {};    ///< rows of a CSV file, from which anyone can compute it again
};

/// agrees, supported: the interval lies where the claim puts it. differs, refuted: the interval
/// lies wholly outside. undecided: otherwise.
Ruling ruling_of(const Interval& interval, double margin, Relation claimed);

/// The ruling of the estimate's interval; undecided without an estimate. A claim that states why it
/// cannot be decided gets this ruling, with the reason in the note. `runs_needed` runs would
/// decide with 90 % probability if the true value is 0 or twice the margin. If the interval
/// excludes 0, or that many runs exist already, the true value is taken to be the estimate.
/// `runs_needed` is always more than the runs of the estimate.
Verdict decide(const Claim& claim, std::string quantity, const std::optional<Estimate>& estimate,
               std::size_t runs, std::string note, Table entered = {},
               Counted counted = Counted::runs);

/// The number of claims with each ruling, without rulings that no claim has.
std::map<Ruling, std::size_t> rulings_of(std::span<const Verdict> verdicts);

/// "1 agrees, 1 refuted"; "" without claims.
std::string headline_of(const std::map<Ruling, std::size_t>& rulings);

/// Makes the ruling undecided, unless the claim cannot be decided.
void withhold(Verdict& verdict);

/// The rows of all verdicts in one table, which has the columns of all verdicts. The first column
/// is the claim.
Table entered_table(std::span<const Verdict> verdicts);

/// {"verdict", "claims": [{"id", "claim", "quantity", "estimate", "interval": [low, high], "level",
/// "margin", "verdict", "runs", "counted", "runs_needed", "note", and "primary" if it is}]}.
/// "verdict" is headline_of() or null. Numbers have six significant digits; null where there is
/// none, for an infinite end of an interval too. The same verdicts give the same bytes.
nlohmann::json to_json(std::span<const Verdict> verdicts);

/// "0.0012, 90 % interval -0.0003 to 0.0027, margin 0.001, 6 runs per variant of 24 needed". On
/// waiting times: "the first is at least 3.3 times later (90 %), margin: twice, 6 runs per
/// variant".
std::string numbers_of(const Verdict& verdict);

/// The quantity, numbers_of() and the note, as the terminal and the report print them:
/// "cycle of the onset (log-rank test): the first is at least 3.3 times later (90 %), ...".
std::string result_of(const Verdict& verdict);

}  // namespace shearcell
