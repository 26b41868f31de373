// SPDX-License-Identifier: GPL-3.0-or-later
// Claims about runs: an estimator (estimators.hpp) over one or two groups of runs, and a margin.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "analysis/figure.hpp"
#include "analysis/verdict.hpp"

namespace shearcell {

/// Published numbers: one value, or points.
struct PublishedSpec {
  std::string label = {};  ///< in the key of a plot
  std::string source = {};
  std::optional<double> value = {};
  double error = 0;                              ///< of the value; 0: not stated
  std::vector<std::vector<double>> points = {};  ///< x, y and perhaps the error of y
};

/// A claim that a manifest states.
struct ClaimSpec {
  std::string id;            ///< "S2.phi"; the same in every manifest that lists its figure
  std::string figure = {};   ///< as PlotSpec::figure
  std::string compare = {};  ///< as PlotSpec::y, but no curve
  /// The estimator's name; "": the other keys imply the estimator (estimator_of()).
  std::string estimator = {};
  /// Each estimator takes one of these: first and last cycle, a window of phi, a value to be
  /// reached, or another number of the run.
  std::optional<std::array<std::uint64_t, 2>> cycles = {};
  std::optional<std::array<double, 2>> phi = {};
  std::optional<double> reaches = {};
  std::string against = {};
  /// Selects runs for both sides, by has_parameters().
  nlohmann::json where = nlohmann::json::object();
  /// A parameter: one claim for each of its values among the runs, "S5a.onset@amplitude_rad=0.05".
  std::string for_each = {};
  /// Two variants, each by parameters and their values. The second is empty if the first is
  /// compared with a published number.
  std::array<nlohmann::json, 2> between = {nlohmann::json::object(), nlohmann::json::object()};
  std::optional<PublishedSpec> published = {};
  /// In units of the measure. For waiting times it limits log2 of their ratio. If it is 0, the
  /// published number is a bound.
  double margin = 0;
  bool relative = false;  ///< the margin limits the relative difference
  /// What the claim says, for people; "": from its keys. "{KEY}" is the value of `for_each`.
  std::string statement = {};
  Relation is = Relation::same;
  bool optional = false;               ///< no verdict if a side has no runs
  std::string cannot_be_decided = {};  ///< as Claim::cannot_be_decided
  /// As PlotSpec::listed. A side that is not one variant then has no runs; otherwise it is an
  /// error.
  bool listed = false;
};

/// Whether the claim has one group of runs: it compares with a published number, or its estimator
/// takes one group.
bool has_one_side(const ClaimSpec& claim);

/// The figure of the claim: as stated, or what its id has before the dot, or its id.
std::string figure_of(const ClaimSpec& claim);

/// What a claim compares. The second side is empty if the claim has a published number.
struct ClaimSides {
  std::array<std::vector<const FrameRun*>, 2> runs;
  std::array<std::string, 2> names;  ///< for stated()
  bool lacks_one = false;            ///< a side has no runs
};
ClaimSides sides_of(const ClaimSpec& claim, std::span<const FrameRun> runs);

/// Resolves `for_each`: one claim for each value among the runs. Returns the claim itself if it has
/// no `for_each`, or if no run has a value.
std::vector<ClaimSpec> each_of(const ClaimSpec& claim, std::span<const FrameRun> runs);

/// What the claim says. `sides`: names of the variants that it compares; "": there is only one.
Claim stated(const ClaimSpec& claim, const std::array<std::string, 2>& sides);

/// One sentence for each reason why the sides cannot be compared. With `planned`, the runs are
/// those of all planned variants, and a side without runs is a reason, too.
std::vector<std::string> problems_of_sides(const ClaimSpec& claim, const ClaimSides& sides,
                                           bool planned);

/// A figure without panels that gives the verdicts of the claim: undecided if a side of `between`
/// has no runs. Its function throws UsageError with the first of problems_of_sides().
Figure claim_figure(const ClaimSpec& claim);

}  // namespace shearcell
