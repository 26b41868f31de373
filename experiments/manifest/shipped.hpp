// SPDX-License-Identifier: GPL-3.0-or-later
// The figures of the supplement. analysis/figures/ computes some of them; shipped manifests, whose
// texts are part of the program, state the others. So `figures: [S2]` in any manifest means the
// plots and claims of drag.yaml.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "analysis/figure.hpp"
#include "experiments/manifest/manifest.hpp"

namespace shearcell {

/// The manifests that state figures of the supplement, as read_manifest() gives them.
std::span<const Manifest> shipped_manifests();

/// Every figure of the supplement: the computed ones, then the stated ones.
std::span<const Figure> all_figures();

/// The figure with that name ("S2"), or null.
const Figure* find_figure(std::string_view name);

/// The figures of the manifest's own plots and claims, in the order of its text.
std::vector<Figure> stated_figures(const Manifest& manifest);

}  // namespace shearcell
