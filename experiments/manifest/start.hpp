// SPDX-License-Identifier: GPL-3.0-or-later
// Starts other than loose grains that settle: the recorded state of another run, or the grains of a
// file.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "core/cell.hpp"
#include "core/filling.hpp"
#include "core/state.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/variants.hpp"
#include "provenance/records.hpp"

namespace shearcell {

/// The recorded run among `known` with whose state the variant begins. If `start` names no variant
/// and the other experiment has several, it is the variant with the same values of all keys that
/// both experiments sweep. Throws ManifestError if there is not exactly one such run, if the run
/// has not reached the cycle, or if its cell or grains differ.
const Stage& recorded_run(const Manifest& manifest, const Scale& scale, const Variant& variant,
                          std::span<const Stage> known);

/// The text of a file of grains, and the facts about it that enter the id of its packing.
struct PackingText {
  std::string path;  ///< as messages name it
  std::string text;
  StartFile file;
};

/// Reads the file that `start` names, from the folder of the manifest. Throws ManifestError.
PackingText read_packing_file(const Manifest& manifest, const Scale& scale);

struct PlacedGrains {
  Cell cell;
  State state;       ///< at step 0; the moving wall is at rest
  std::string read;  ///< describe() of the file
};

/// Places the grains of the text in the cell of the parameters, with the wall grains of the seed.
/// The box of the file must be as wide and deep as the cell; without a box the walls touch the
/// outermost grains. Throws ManifestError with the reason and the remedy if they do not fit.
PlacedGrains placed(const PackingText& packing, const Parameters& parameters, std::uint64_t seed,
                    const Poll& poll = {});

}  // namespace shearcell
