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
  std::optional<std::string> scale = {};       ///< default: `desk`, or `base` without scales
  std::optional<std::uint64_t> cycles = {};    ///< instead of the manifest's
  std::optional<std::uint64_t> seeds = {};     ///< number of seeds, the first ones of a list
  std::vector<std::string> variants = {};      ///< only variants with these values, as "fluid=cell"
  std::vector<std::uint64_t> only_seeds = {};  ///< only runs with these seeds; empty for all
  std::optional<std::string> engine = {};      ///< instead of the manifest's; part of the variant
  /// Stages of the store, and stages that are computed before this manifest. If this manifest asked
  /// for more cycles earlier, warnings assume that larger number.
  std::span<const Stage> known = {};
};

/// A run as a manifest states it; each of its stages has one ask. The scale is empty if the
/// manifest has no scales, the variant "base" if nothing is swept.
struct PlannedRun : Run {
  std::optional<Stage> prepare;  ///< the packing; none if the shear begins with a recorded state
  Parameters parameters;
  Parameters packing;  ///< parameters with which the packing settles
};

struct Plan {
  Manifest manifest;
  std::string scale;
  std::optional<PackingText> file = {};  ///< the grains of all packings
  std::vector<PlannedRun> runs;          ///< variants in manifest order, and within each its seeds
  std::vector<std::string> warnings;     ///< of what is unlikely to be meant; one line each
  std::string read = {};                 ///< what was read from the file of grains, in one line
};

/// Throws ManifestError when an option does not fit the manifest (unknown scale, no seeds, ...).
Plan expand(const Manifest& manifest, const ExpandOptions& options = {});

/// One run of each variant in the form that figures expect, without seed and checkpoints.
std::vector<FrameRun> planned_runs(const Manifest& manifest, const Scale& scale,
                                   std::span<const Variant> variants);

/// Adds the runs of the plan to `known`, as if all their cycles were computed, so that the `start`
/// of another manifest can name them.
void add_as_computed(const Plan& plan, std::vector<Stage>& known);

/// Whether LAMMPS computes any run of the plan.
bool asks_for_lammps(const Plan& plan);

}  // namespace shearcell
