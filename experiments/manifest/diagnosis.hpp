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

/// Checks `looks`, `labels`, `primary` and the number of runs. For each variant at each scale, also
/// checks the time steps, cell, `start` and `phases`. `manifest`: from read_manifest(). Throws
/// ManifestError.
void check_variants(const Manifest& manifest);

/// Why LAMMPS cannot compute these runs; "" if it can, or if LAMMPS is not the engine.
std::string unfit_for_lammps(const Parameters& parameters, const Checkpoints& checkpoints);

/// For a manifest that has the key `of`: returns warnings about its plots and claims. Such a
/// manifest defines no runs, so only problems that can be found without runs are reported.
std::vector<std::string> warnings_of(const Manifest& manifest);

/// Returns warnings about the variants in `planned`, one line each. Reasons: a parameter makes
/// settling fail, is outside the advised range, or has no effect on any variant; a figure, plot or
/// claim will have no data; an entry of `primary` is not the id of a claim.
/// `all`: all variants of the scale.
std::vector<std::string> warnings_of(const Manifest& manifest, const Scale& scale,
                                     std::span<const Variant> all, std::span<const Variant> planned,
                                     std::size_t seeds);

}  // namespace shearcell
