// SPDX-License-Identifier: GPL-3.0-or-later
// Names of variants for people. Identity and CSV files use Variant::name().
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "experiments/manifest/manifest.hpp"

namespace shearcell {

/// Whether the variant (swept keys and values) has all values of the label.
bool selects(const VariantLabel& label, const nlohmann::json& variant);

/// Names of variants, which are objects of swept keys and values. A label replaces the keys that
/// it states, one with more keys before one with fewer; then come the other keys that distinguish
/// the variants: "fluid at rest, A=0.05 rad". "base" where nothing is swept.
std::vector<std::string> variant_names(const std::vector<nlohmann::json>& variants,
                                       std::span<const VariantLabel> labels);

}  // namespace shearcell
