// SPDX-License-Identifier: GPL-3.0-or-later
// Finds errors in the variants of a manifest, and warns of values that are probably mistakes.
// reader.cpp finds errors in the text of the manifest.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/variants.hpp"

namespace shearcell {

/// Checks the number of runs, `looks` and `labels` and, for each variant at each scale, time steps,
/// cell, `start` and `phases`. The manifest must come from read_manifest(). Throws ManifestError.
void check_variants(const Manifest& manifest);

/// Why LAMMPS cannot compute these runs; "" if it can, or if LAMMPS is not the engine.
std::string unfit_for_lammps(const Parameters& parameters, const Checkpoints& checkpoints);

/// Returns warnings about the variants in `planned`, one line each. They concern parameters that
/// make settling fail, are outside the advised range, or have no effect on any variant; figures,
/// plots and claims that will have no data; and entries of `primary` that are not ids of claims.
/// `all`: all variants of the scale.
std::vector<std::string> warnings_of(const Manifest& manifest, const Scale& scale,
                                     std::span<const Variant> all, std::span<const Variant> planned,
                                     std::size_t seeds);

}  // namespace shearcell
