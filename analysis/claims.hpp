// SPDX-License-Identifier: GPL-3.0-or-later
// A claim compares one or two groups of runs by an estimator (estimators.hpp) and a margin.
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
  std::string label = {};  ///< text in the legend of a plot
  std::string source = {};
  std::optional<double> value = {};
  double error = 0;                              ///< uncertainty of `value`; 0: not given
  std::vector<std::vector<double>> points = {};  ///< {x, y} or {x, y, error of y}
};

struct ClaimSpec {
  std::string id;            ///< "S2.phi"; the same in every manifest that lists the figure
  std::string figure = {};   ///< like PlotSpec::figure
  std::string compare = {};  ///< the compared quantity, as in PlotSpec::y; must not be a curve
  /// The estimator's name; "": the other keys imply the estimator (estimator_of()).
  std::string estimator = {};
  /// A claim sets at most one of the next four members: `cycles` (first and last), `phi` (lower
  /// and upper end of a range), `reaches` (a value of the measure), or `against` (another column).
  std::optional<std::array<std::uint64_t, 2>> cycles = {};
  std::optional<std::array<double, 2>> phi = {};
  std::optional<double> reaches = {};
  std::string against = {};
  /// The claim uses only runs whose parameters match this object; see has_parameters().
  nlohmann::json where = nlohmann::json::object();
  /// A parameter. Each of its values gives a claim with an id like "S5a.onset@amplitude_rad=0.05".
  std::string for_each = {};
  /// For each side, the parameters that select its runs. The second object is empty if the claim
  /// has only one side.
  std::array<nlohmann::json, 2> between = {nlohmann::json::object(), nlohmann::json::object()};
  std::optional<PublishedSpec> published = {};
  /// Tolerance, in units of the measure. For waiting times it is the tolerance of log2(ratio of the
  /// two waiting times). A claim with a margin of 0 and a published number states that the measure
  /// is above (Relation::higher) or below (Relation::lower) this number.
  double margin = 0;
  bool relative = false;  ///< the margin limits the relative difference
  /// The claim as a sentence. If empty, stated() makes the sentence from the other keys. With
  /// `for_each: amplitude_rad`, for example, "{amplitude_rad}" is replaced by the amplitude.
  std::string statement = {};
  Relation is = Relation::same;
  bool optional = false;               ///< true: no verdict if a group has no runs
  std::string cannot_be_decided = {};  ///< why no number of runs can decide the claim, or ""
  /// True if a shipped manifest defines the claim, and the user's manifest lists the claim's
  /// figure. If problems_of_sides() finds a problem in such a claim, the verdict is undecided and
  /// uses no runs. In any other claim, such a problem is an error.
  bool listed = false;
};

/// Whether the claim has only one group of runs. True if the claim has a published number, or if
/// Estimator::one_side is true.
bool has_one_side(const ClaimSpec& claim);

/// The figure of the claim: `figure` if given, otherwise the id up to its first dot.
std::string figure_of(const ClaimSpec& claim);

/// The id without the value of `for_each`: "S5a.onset" for "S5a.onset@amplitude_rad=0.05".
inline std::string without_value(const std::string& id) {
  return id.substr(0, id.find('@'));
}

/// The groups of runs that a claim compares. A claim with one side has an empty second group.
struct ClaimSides {
  std::array<std::vector<const FrameRun*>, 2> runs;
  /// Names of the sides, for use in sentences; "" for a side that `between` does not restrict.
  std::array<std::string, 2> names;
  bool lacks_one = false;  ///< a side has no runs
};
ClaimSides sides_of(const ClaimSpec& claim, std::span<const FrameRun> runs);

/// Returns one claim for each value that the parameter ClaimSpec::for_each has in the runs. Returns
/// the claim itself if `for_each` is empty, or if no run has this parameter.
std::vector<ClaimSpec> each_of(const ClaimSpec& claim, std::span<const FrameRun> runs);

/// Converts to a Claim. Claim::margin is negative for Relation::lower. `sides`: ClaimSides::names.
Claim stated(const ClaimSpec& claim, const std::array<std::string, 2>& sides);

/// One sentence for each reason why the sides cannot be compared. `planned`: true for planned runs,
/// false for recorded runs. A lack of planned runs is a reason; a lack of recorded runs is not.
std::vector<std::string> problems_of_sides(const ClaimSpec& claim, const ClaimSides& sides,
                                           bool planned);

/// A figure that has no panels, only the verdicts on the claim. A verdict is undecided if one of
/// the claim's sides has no runs. Unless ClaimSpec::listed is true, Figure::make throws UsageError
/// with the first problem that problems_of_sides() finds.
Figure claim_figure(const ClaimSpec& claim);

}  // namespace shearcell
