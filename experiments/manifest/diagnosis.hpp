// SPDX-License-Identifier: GPL-3.0-or-later
// What is wrong with the variants of a manifest, and what is sound but unlikely to be meant.
// Problems of the text itself are found while it is read (reader.cpp).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/variants.hpp"

namespace shearcell {

/// Checks the number of runs, and labels, time steps and geometry of every variant of every scale.
/// The manifest must come from read_manifest(). Throws ManifestError.
void check_variants(const Manifest& manifest);

/// Why LAMMPS cannot compute such a run; "" if it can, or if the engine is another one.
std::string unfit_for_lammps(const Parameters& parameters, const Checkpoints& checkpoints);

/// One line for each thing that is unlikely to be meant in a plan of the `planned` variants:
/// parameters that make settling fail, lie outside of advised ranges or have no effect on any
/// variant, and each figure, plot and claim that `shearcell figures` would refuse, leave without
/// data or not decide. `all`: the variants of the scale.
std::vector<std::string> warnings_of(const Manifest& manifest, const Scale& scale,
                                     std::span<const Variant> all, std::span<const Variant> planned,
                                     std::size_t seeds);

}  // namespace shearcell
