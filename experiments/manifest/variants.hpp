// SPDX-License-Identifier: GPL-3.0-or-later
// The variants of an experiment at one scale: base, scale and sweep combined, and their names.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/parameters.hpp"

namespace shearcell {

/// The scale with what it takes from `base`, so that it states everything.
Scale whole_scale(const Manifest& manifest, const Scale& scale);

/// Every scale of the manifest, or the base of one without any; each states everything.
std::vector<Scale> whole_scales(const Manifest& manifest);

/// The value of a parameter that is not swept, or "auto".
nlohmann::json value_at(const Scale& scale, std::string_view key);

/// Whether the setting is `auto`, which variants_of() resolves.
bool is_auto(const Setting& setting);

/// Points into the scale.
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

/// "amplitude_rad,fluid," of "fluid=cell,amplitude_rad=0.1". Values of the same keys are
/// alternatives; those of other keys must fit too.
std::string keys_of(const std::string& wanted);

/// Whether the variant (swept keys and values) has all values of the label.
bool selects(const VariantLabel& label, const nlohmann::json& variant);

/// Names for people (identity and CSV files use Variant::name()) of variants, which are objects of
/// swept keys and values. A label replaces the keys that it states, one with more keys before one
/// with fewer; then come the other keys that distinguish the variants: "fluid at rest, A=0.05 rad".
/// "base" where nothing is swept. Variants may come more than once.
std::map<nlohmann::json, std::string> variant_names(const std::vector<nlohmann::json>& variants,
                                                    std::span<const VariantLabel> labels);

/// The swept axis of this key, or nullptr.
const SweepAxis* find_axis(const Sweep& sweep, std::string_view key);

/// How many there are; saturates at 2^64 - 1.
std::uint64_t variant_count(const Sweep& sweep);

/// In manifest order: the first grid axis varies slowest, the rows of the zip fastest. The scale
/// states everything, outlives the result, and has no more variants than ManifestLimits::runs.
std::vector<Variant> variants_of(const Scale& scale);

/// "has an effect only under protocol paused" of a parameter, or `until`, that this variant does
/// not feel; else "".
std::string without_effect(std::string_view key, const Parameters& parameters);

/// A warning for each plot or claim that `shearcell figures` would refuse or leave without data: a
/// side of `between` that is not one variant, a plot that would average over a swept key that it
/// does not name, cycles beyond the end of the runs, `at_cycle` where every cycle is drawn.
/// `variants`: those of one scale.
std::vector<std::string> own_warnings(const Manifest& manifest,
                                      const std::vector<Variant>& variants);

/// Time steps, units and geometry of every variant of every scale, and how many runs there are.
/// Only for a manifest that is well formed otherwise. Throws ManifestError.
void check_variants(const Manifest& manifest);

}  // namespace shearcell
