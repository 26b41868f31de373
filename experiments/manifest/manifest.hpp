// SPDX-License-Identifier: GPL-3.0-or-later
// A manifest: one experiment as a YAML text, read and checked as a whole. For any bytes, reading
// ends in a Manifest or in a ManifestError that names the place and the remedy.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/own_figure.hpp"
#include "experiments/manifest/limits.hpp"
#include "experiments/manifest/until.hpp"
#include "provenance/errors.hpp"

namespace shearcell {

/// Place in the manifest's text, counted from 1; line 0 means the file as a whole.
struct Position {
  int line = 0;
  int column = 0;
};

struct ManifestProblem {
  std::string file;
  Position at;
  std::string key;      ///< path to the key, as in "scales.smoke.grains"; may be empty
  std::string problem;  ///< what is wrong
  std::string got;      ///< the offending value as written; may be empty
  std::string remedy;   ///< what to do, a sentence; may be empty

  /// "file:line:column: key: problem (got VALUE). remedy"
  std::string text() const;
};

/// All problems of one manifest; what() has one per line, in the order of the text.
class ManifestError : public UsageError {
 public:
  explicit ManifestError(std::vector<ManifestProblem> problems);
  const std::vector<ManifestProblem>& problems() const { return problems_; }

 private:
  std::vector<ManifestProblem> problems_;
};

/// A checked value, or "auto" (resolve_auto), and where it was written.
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

/// Variants: every combination of the `grid` axes (the first varies slowest), each with every row
/// of the `zip` axes (which advance together).
struct Sweep {
  std::vector<SweepAxis> grid;
  std::vector<SweepAxis> zip;
  bool empty() const { return grid.empty() && zip.empty(); }
};

/// 1..n when a manifest states a count, or the seeds that it lists.
struct Seeds {
  std::vector<std::uint64_t> values = {1};
  bool counted = true;
};

/// `until`, or `until: none` in a scale, and where it was written.
struct StatedUntil {
  std::optional<Until> until;
  Position at;
};

/// `checkpoints`, and where it was written.
struct Checkpoints {
  std::uint64_t every_cycles = 1;
  std::vector<double> phases = {};  ///< of each cycle after one of these; ascending, 0 < p < 1
  Position at = {};
};

/// A name of `labels` for the variants that have these values.
struct VariantLabel {
  nlohmann::json where;  ///< parameters and their values, an object
  std::string name;
  Position at;
};

/// A named size of the experiment. What it does not state is as in the manifest itself.
struct Scale {
  std::string name;
  Position at;
  Settings settings;
  std::optional<Sweep> sweep;
  std::optional<Seeds> seeds;
  std::optional<Checkpoints> checkpoints;
  std::optional<StatedUntil> until;
};

struct Manifest {
  std::string file;  ///< name for messages
  std::string text;  ///< the bytes that were read
  std::string experiment;
  std::string question;
  std::vector<std::string> figures;
  std::vector<VariantLabel> labels;
  std::vector<PlotSpec> plots;
  std::vector<ClaimSpec> claims;
  Position base_at;
  Settings base;
  Sweep sweep;
  Seeds seeds;
  Checkpoints checkpoints;
  StatedUntil until;
  std::vector<Scale> scales;  ///< in the order of the text
};

/// Letters, digits, '-' and '_', at most 64 of them and no '-' first: such a text can name an
/// experiment, its folder and its figures.
bool is_name(std::string_view text);

/// Reads a file. Throws ManifestError.
Manifest load_manifest(const std::filesystem::path& path);

/// Reads a text; `file` is its name in messages. Every scale is checked through to the time step of
/// every variant. Throws ManifestError.
Manifest parse_manifest(std::string_view text, std::string_view file);

}  // namespace shearcell
