// SPDX-License-Identifier: GPL-3.0-or-later
// The variants of an experiment at one scale: base, scale and sweep combined.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/schema.hpp"

namespace shearcell {

/// A manifest as one of its scales has it. Points into the manifest.
struct AtScale {
  Settings settings;  ///< base, overridden by the scale
  const Sweep* sweep = nullptr;
  const Seeds* seeds = nullptr;
  Checkpoints checkpoints;
  StatedUntil until;
};

/// Whether the setting is `auto`, which for_each_variant() resolves.
bool is_auto(const Setting& setting);

/// `scale` may be null: the manifest without any.
AtScale at_scale(const Manifest& manifest, const Scale* scale);

struct Variant {
  /// In the order of the manifest; without the length of the run.
  std::vector<std::pair<std::string, const Setting*>> swept;
  Parameters parameters;

  std::string name() const;       ///< "fluid=cell", "base" when nothing is swept
  nlohmann::json labels() const;  ///< swept keys and values
};

/// Whether the variant of that name has the values that `wanted` lists: "fluid=cell" fits
/// "fluid=cell,amplitude_rad=0.1".
bool has_values(const std::string& wanted, const std::string& variant);

/// How many there are; saturates at 2^64 - 1.
std::uint64_t variant_count(const Sweep& sweep);

/// In manifest order: the first grid axis varies slowest, the rows of the zip fastest.
void for_each_variant(const AtScale& scale, const std::function<void(const Variant&)>& visit);

/// When a variant feels the parameter, as "only under protocol paused", if this variant does not;
/// else "".
std::string without_effect(const Field& field, const Parameters& parameters);

/// Time steps, units and geometry of every variant of every scale, and how many runs there are.
/// Only for a manifest that is well formed otherwise.
std::vector<ManifestProblem> check_variants(const Manifest& manifest);

}  // namespace shearcell
