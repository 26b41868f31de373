// SPDX-License-Identifier: GPL-3.0-or-later
// The figures of the supplement. analysis/figures/ computes some of them. Shipped manifests, whose
// texts are part of the program, define the others. So `figures: [S2]` in any manifest means the
// plots and claims of drag.yaml.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "analysis/figure.hpp"
#include "experiments/manifest/manifest.hpp"

namespace shearcell {

/// The manifests that define figures of the supplement, read by read_manifest().
std::span<const Manifest> shipped_manifests();

/// All figures of the supplement: first those computed in C++, then those defined in manifests.
std::span<const Figure> all_figures();

/// The figure with this name ("S2"), or null.
const Figure* find_figure(std::string_view name);

/// The figures that the manifest's own plots and claims state, in the order of the text.
std::vector<Figure> stated_figures(const Manifest& manifest);

}  // namespace shearcell
