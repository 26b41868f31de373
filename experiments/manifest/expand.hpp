// SPDX-License-Identifier: GPL-3.0-or-later
// Expands a manifest at one scale into its runs, in the order of the manifest.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiments/manifest/identity.hpp"
#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/parameters.hpp"
#include "experiments/manifest/start.hpp"
#include "provenance/records.hpp"

namespace shearcell {

struct ExpandOptions {
  std::optional<std::string> scale = {};     ///< default: `desk`, or `base` without scales
  std::optional<std::uint64_t> cycles = {};  ///< instead of the manifest's
  std::optional<std::uint64_t> seeds = {};   ///< how many; of listed seeds the first ones
  std::vector<std::string> variants = {};  ///< only those with these swept values, as "fluid=cell"
  std::vector<std::uint64_t> only_seeds = {};  ///< only runs with these; empty for all
  std::optional<std::string> engine = {};      ///< instead of the manifest's; named in the variant
  /// Runs of the store, and those that are computed before (add_as_computed). Warnings then assume
  /// the lengths that this manifest gave them before, if those are longer.
  std::span<const Stage> known = {};
};

/// A run that no store has yet. Its stage has the asks of all joined plans, its own first; its
/// scale is empty when the manifest has none, and its variant "base" when nothing is swept.
struct PlannedRun : Run {
  std::optional<Stage> prepare;  ///< the packing; none where it begins with a recorded state
  Parameters parameters;
  Parameters packing;  ///< those with which it settles
};

struct Plan {
  std::string experiment;
  std::string scale;
  std::optional<PackingText> file = {};  ///< of which the packings are made
  std::vector<PlannedRun> runs;          ///< variants in manifest order, and within each its seeds
  std::vector<std::string> warnings;     ///< sound but unlikely to be meant; one line each
};

/// Throws ManifestError when an option does not fit the manifest (unknown scale, no seeds, ...).
Plan expand(const Manifest& manifest, const ExpandOptions& options = {});

/// Adds the runs of the plan to `known`, or extends them there, as they are when they have the
/// cycles that the plan asks for: the start of another manifest may name them.
void add_as_computed(const Plan& plan, std::vector<Stage>& known);

/// The runs of one or more manifests, each once, with what all of them ask for.
Plan joined(std::span<const Plan> plans);

/// Whether LAMMPS computes any of its runs.
bool asks_for_lammps(const Plan& plan);

}  // namespace shearcell
