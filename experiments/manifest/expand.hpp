// SPDX-License-Identifier: GPL-3.0-or-later
// From a manifest at one scale to its runs, in the manifest's own order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "experiments/manifest/identity.hpp"
#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/parameters.hpp"

namespace shearcell {

struct ExpandOptions {
  std::optional<std::string> scale = {};     ///< default: `desk`, or the base without scales
  std::optional<std::uint64_t> cycles = {};  ///< instead of the manifest's
  std::optional<std::uint64_t> seeds = {};   ///< how many; of a listed set the first ones
  std::vector<std::string> variants = {};  ///< only those with these swept values, as "fluid=cell"
  std::optional<std::string> engine = {};  ///< instead of the manifest's; named in the variant
};

struct PlannedRun {
  std::string experiment;
  std::string scale;      ///< empty when the manifest has no scales
  std::string variant;    ///< "fluid=cell"; "base" when nothing is swept
  std::string name = {};  ///< of the variant, for people (names.hpp)
  nlohmann::json labels;  ///< the swept keys and their values, an object
  std::uint64_t seed = 0;
  StageSpec prepare;
  StageSpec last;                      ///< what is done to the packing: shear, or stiffening
  std::uint64_t cycles = 0;            ///< target length of the last stage
  std::uint64_t checkpoint_every = 1;  ///< cycles
  std::vector<double> checkpoint_phases = {};  ///< of each cycle after one of these
  std::string manifest = {};                   ///< SHA-256 of its text
  std::optional<Until> until = {};             ///< ends it before `cycles`
  std::size_t grains = 0;
  Parameters parameters;
};

struct Plan {
  std::string experiment;
  std::string scale;
  std::vector<PlannedRun> runs;       ///< variants in manifest order, and within each its seeds
  std::vector<std::string> warnings;  ///< sound but unlikely to be meant; one line each
};

/// Throws ManifestError when an option does not fit the manifest (unknown scale, no seeds, ...).
Plan expand(const Manifest& manifest, const ExpandOptions& options = {});

/// Whether LAMMPS computes any of its runs.
bool asks_for_lammps(const Plan& plan);

}  // namespace shearcell
