// SPDX-License-Identifier: GPL-3.0-or-later
// Errors in the variants of a manifest, and warnings of what is unlikely to be meant. Errors in the
// text itself are found when the text is read (reader.cpp).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/variants.hpp"

namespace shearcell {

/// Checks the number of runs, the labels, and time steps and geometry of every variant of every
/// scale. The manifest must come from read_manifest(). Throws ManifestError.
void check_variants(const Manifest& manifest);

/// Why LAMMPS cannot compute such a run; "" if it can, or if LAMMPS is not the engine.
std::string unfit_for_lammps(const Parameters& parameters, const Checkpoints& checkpoints);

/// Warnings for a plan of the `planned` variants, one line each. They concern parameters that make
/// settling fail, lie outside of advised ranges or have no effect on any variant; figures, plots
/// and claims for which there will be no data; and claims that `primary` names by their statements.
/// `all`: the variants of the scale.
std::vector<std::string> warnings_of(const Manifest& manifest, const Scale& scale,
                                     std::span<const Variant> all, std::span<const Variant> planned,
                                     std::size_t seeds);

}  // namespace shearcell
