// SPDX-License-Identifier: GPL-3.0-or-later
// A manifest is a YAML text that defines one experiment. Reading any bytes returns a Manifest, or
// throws ManifestError with the position and the remedy of each problem.
#pragma once

#include <compare>
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/plots.hpp"
#include "core/named.hpp"
#include "experiments/manifest/packing_file.hpp"
#include "provenance/errors.hpp"

namespace shearcell {

/// Limits of a manifest's text and of its expansion. The schema has the ranges of the parameters.
struct ManifestLimits {
  static constexpr std::size_t bytes = 1 << 20;
  static constexpr std::size_t nodes = 100'000;
  static constexpr std::size_t depth = 16;
  static constexpr std::size_t values_per_list = 1'000;
  static constexpr std::size_t scales = 16;
  static constexpr std::uint64_t runs = 10'000;  ///< of all scales together
};

/// Position in a text. Lines and columns count from 1; line 0 means the whole file.
struct Position {
  int line = 0;
  int column = 0;

  auto operator<=>(const Position&) const = default;
};

/// The message about one problem: "file:line:column: key: problem (got VALUE). remedy". `key` is
/// the path to the key, as in "scales.smoke.grains"; `got` is the value as written; `remedy` is a
/// sentence. `key`, `got` and `remedy` may be empty.
std::string problem_text(std::string_view file, Position at, const std::string& key,
                         const std::string& problem, const std::string& got,
                         const std::string& remedy);

/// The problems of one manifest; what() has one line for each problem.
struct ManifestError : UsageError {
  using UsageError::UsageError;
};

/// Collects the problems of a manifest, so that all are reported at once.
class ProblemList {
 public:
  explicit ProblemList(std::string_view file) : file_(file) {}

  /// Adds a problem_text(), unless it was added before: many variants may have the same problem.
  void add(Position at, const std::string& key, const std::string& problem, const std::string& got,
           const std::string& remedy);

  std::size_t size() const { return problems_.size(); }

  /// Throws ManifestError if a problem was added. The error lists the problems by position.
  void raise() const;

 private:
  std::string file_;
  std::set<std::pair<Position, std::string>> problems_;
};

/// Throws a ManifestError with the problem_text() of these arguments.
[[noreturn]] void refuse(std::string_view file, Position at, const std::string& key,
                         const std::string& problem, const std::string& got,
                         const std::string& remedy);

/// A checked value, or "auto" (see resolve_auto()), and its position in the text.
struct Setting {
  nlohmann::json value;
  Position at;
};
using Settings = std::map<std::string, Setting, std::less<>>;

struct SweepAxis {
  std::string key;
  Position at;
  std::vector<Setting> values;
};

/// A variant combines one value of each `grid` axis with one row of the `zip` axes. Row k has the
/// k-th value of each `zip` axis. All combinations are variants; the first `grid` axis varies
/// slowest.
struct Sweep {
  std::vector<SweepAxis> grid;
  std::vector<SweepAxis> zip;
};

/// The seeds 1 to n if the manifest gives a count, otherwise the seeds that it lists.
struct Seeds {
  std::vector<std::uint64_t> values = {1};
  bool counted = true;
  Position at = {};  ///< line 0: not given
};

/// `until`: a run ends `extra_cycles` after the first checkpoint at which the measure is at least
/// `value`. The id of a run does not depend on `until`.
struct Until {
  std::string measure = {};
  double value = 0;
  std::uint64_t extra_cycles = 0;

  bool operator==(const Until&) const = default;
};

/// Whether `until` can use the measure: it must have one value for each checkpoint, computed from
/// this checkpoint alone and without a simulation.
bool can_be_until(std::string_view measure);

/// {"crystalline_percent": 10, "extra_cycles": 15}, as a manifest writes it.
nlohmann::json to_json(const Until& until);

/// The inverse of to_json(). Throws std::runtime_error if the JSON, which is not trusted, is wrong.
Until until_from_json(const nlohmann::json& json);

/// "crystalline_percent >= 10 and 15 more cycles".
std::string describe(const Until& until);

/// The value of `until` and its position in the text. `until: none` in a scale gives no value.
struct StatedUntil {
  std::optional<Until> until;
  Position at;
};

struct Checkpoints {
  std::uint64_t every_cycles = 1;
  /// In the cycle after each checkpoint of `every_cycles`, further checkpoints are written at these
  /// fractions of the cycle. Ascending, in (0, 1).
  std::vector<double> phases = {};
  Position at = {};
};

/// An entry of `labels`: a name for the variants that have the values `where`.
struct VariantLabel {
  nlohmann::json where;  ///< parameters and their values, an object
  std::string name;
  Position at;
};

/// A plot or claim and its position in the text.
template <class Spec>
struct Placed : Spec {
  Position at;
};

/// `start`: initial state, from a file of grains or from a recorded run. Default: loose grains that
/// settle.
struct Start {
  std::string file = {};  ///< relative to the folder of the manifest
  std::optional<LengthUnit> unit = {};
  std::string experiment = {};
  std::string scale = {};  ///< scale of the recorded run; "": the scale of the new run
  nlohmann::json variant = nlohmann::json::object();  ///< swept values; empty if not given
  /// First digits of the recorded run's id, from the key `checkpoint`. If this key is
  /// given, experiment, scale and variant are empty.
  std::string run = {};
  Settings settings = {};  ///< start_seed, start_cycle, start_noise_d
  Position at = {};

  bool is_recorded() const { return !experiment.empty() || !run.empty(); }
};

/// An entry of `primary`: the id (in older manifests: the statement) of a claim.
struct PrimaryClaim {
  std::string id;
  Position at;
};

/// An entry of `scales`, completed with the keys of the top level; or the top level itself.
struct Scale {
  std::string name = {};  ///< "" for the top level
  Position at = {};
  Settings settings = {};
  Settings settle = {};  ///< parameters that differ while the packing settles
  Position settle_at = {};
  Start start = {};
  Sweep sweep = {};
  Seeds seeds = {};
  Checkpoints checkpoints = {};
  StatedUntil until = {};
  std::vector<PrimaryClaim> primary = {};  ///< the claims that this scale is meant to decide
  /// Number of seeds at each look (interim analysis), ascending. Empty: one look, with all seeds.
  std::vector<std::uint64_t> looks = {};
  std::set<std::string> own = {};  ///< keys written in this entry of `scales`
};

struct Manifest {
  std::string file;  ///< name for messages
  std::string text;  ///< the bytes that were read
  std::string experiment;
  Position experiment_at;
  std::string question;
  /// The plots and claims use the runs of these experiments. Empty: the runs of this experiment.
  std::vector<std::string> of;
  std::vector<std::string> figures;
  std::vector<VariantLabel> labels;
  std::vector<Placed<PlotSpec>> plots;
  std::vector<Placed<ClaimSpec>> claims;
  Scale base = {};
  std::vector<Scale> scales;  ///< in the order of the text
};

/// The scales of the manifest; `base` if it has no scales.
inline std::vector<Scale> scales_of(const Manifest& manifest) {
  return manifest.scales.empty() ? std::vector{manifest.base} : manifest.scales;
}

inline constexpr std::size_t kLongestName = 64;

/// Whether the text is a valid name of an experiment, a folder or a figure: 1 to kLongestName
/// letters, digits, '-' and '_', not beginning with '-'.
bool is_name(std::string_view text);

/// Whether the text can be the id of a claim: names (is_name()) joined by dots. The whole
/// id has at most kLongestName bytes.
bool is_claim_id(std::string_view text);

/// The bytes of a file, at most `limit` + 1 of them. Throws ManifestError.
std::string read_text(const std::filesystem::path& path, std::size_t limit);

/// Reads a file and checks every variant at every scale. Throws ManifestError.
Manifest load_manifest(const std::filesystem::path& path);

/// Reads a text and checks every variant at every scale. `file`: the name for messages. Throws
/// ManifestError.
Manifest parse_manifest(std::string_view text, std::string_view file);

/// The table of the top-level keys of a manifest, for experiments/REFERENCE.md.
std::string manifest_markdown();

/// Reads a text and checks keys, types and ranges, but not the variants. If `shipped`, plots and
/// claims may have the names of figures of the supplement. Throws ManifestError with all problems.
Manifest read_manifest(std::string_view text, std::string_view file, bool shipped = false);

/// The seeds of a text such as "6" or "6-9". `option`: name of the text for messages. Throws
/// ManifestError.
std::vector<std::uint64_t> read_seeds(const std::string& text, std::string_view option);

/// Reads the text of a manifest in a store. Returns an empty manifest, without even a name, if this
/// version of the program cannot read the text.
Manifest recorded_manifest(std::string_view text);

}  // namespace shearcell
