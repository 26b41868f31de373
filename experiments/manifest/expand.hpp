// SPDX-License-Identifier: GPL-3.0-or-later
// Expands a manifest at one scale into its runs, in the order of the manifest.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/frame.hpp"
#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/parameters.hpp"
#include "experiments/manifest/start.hpp"
#include "experiments/manifest/variants.hpp"
#include "provenance/records.hpp"

namespace shearcell {

struct ExpandOptions {
  std::optional<std::string> scale = {};     ///< default: `desk`, or `base` if there are no scales
  std::optional<std::uint64_t> cycles = {};  ///< replaces the number in the manifest
  /// Replaces the number of seeds. A list of seeds in the manifest is cut to this length.
  std::optional<std::uint64_t> seeds = {};
  /// Only variants with these values, for example "fluid=cell". Empty: all variants.
  std::vector<std::string> variants = {};
  std::vector<std::uint64_t> only_seeds = {};  ///< only runs with these seeds; empty: all runs
  /// Replaces the manifest's `engine`. If this changes the engine, `engine` becomes a swept key.
  std::optional<std::string> engine = {};
  /// Stages in the store, and stages of manifests that stand before this manifest in the same
  /// command. Each stage records the numbers of cycles requested for it. Warnings about a variant
  /// assume the largest number requested with this version of the manifest, including the number
  /// requested now.
  std::span<const Stage> known = {};
};

/// A run as a manifest defines it. Each of its stages has exactly one Membership, which names this
/// manifest. The scale is "" if the manifest has no scales; the variant is "base" if nothing is
/// swept.
struct PlannedRun : Run {
  std::optional<Stage> prepare;  ///< the packing; none if the shear begins with a recorded state
  Parameters parameters;
  Parameters packing;  ///< parameters while the packing settles
};

struct Plan {
  Manifest manifest;
  std::string scale = {};
  std::optional<PackingText> file = {};    ///< the initial grains of all packings
  std::vector<PlannedRun> runs = {};       ///< by variant, then by seed, as the manifest lists them
  std::vector<std::string> warnings = {};  ///< about probable mistakes; one line each
  /// A message of one line, or "". If the manifest has a file of grains: what was read from it. If
  /// the manifest has the key `of`: which experiments have the runs that the figures use.
  std::string read = {};
};

/// Throws ManifestError if an option does not fit the manifest, such as an unknown scale.
Plan expand(const Manifest& manifest, const ExpandOptions& options = {});

/// One run of each variant, with seed 1 and without checkpoints, for checks of plots and claims.
std::vector<FrameRun> planned_runs(const Manifest& manifest, const Scale& scale,
                                   std::span<const Variant> variants);

/// Adds the runs of the plan to `known`, as if all their cycles were computed, so that the `start`
/// of another manifest can refer to them.
void add_as_computed(const Plan& plan, std::vector<Stage>& known);

/// Whether LAMMPS computes any run of the plan.
bool asks_for_lammps(const Plan& plan);

}  // namespace shearcell
