// SPDX-License-Identifier: GPL-3.0-or-later
// The key `start`: a run begins with the recorded state of another run, or with the grains of a
// file, instead of loose grains that settle.
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

/// Returns the run in `known` from which the variant starts. If several runs fit the key `start`,
/// selects the run that has the same swept values as the variant. Only the keys that are swept both
/// in `manifest` and in the run's experiment are compared.
/// Throws ManifestError if no run or several runs remain, if the run has no checkpoint at the start
/// cycle, or if the run and the variant differ in their cells or grains.
const Stage& recorded_run(const Manifest& manifest, const Scale& scale, const Variant& variant,
                          std::span<const Stage> known);

/// The text of a file of grains, and the facts about the file that are part of the packing's id.
struct PackingText {
  std::string path;  ///< path as shown in messages
  std::string text;
  StartFile file;
};

/// Reads the file that `start` names. A relative path starts at the folder of the manifest. Throws
/// ManifestError.
PackingText read_packing_file(const Manifest& manifest, const Scale& scale);

struct PlacedGrains {
  Cell cell;
  State state;               ///< at step 0; the moving wall is at rest
  std::string read;          ///< what was read; see describe()
  std::string warning = {};  ///< message if the cell has room for more grains; otherwise empty
};

/// Places the grains of the file in the cell that `parameters` define. `seed` decides the positions
/// of the wall grains. The box of the file must be as wide and deep as the cell. Without a box, the
/// grains must fit into the cell; the bottom and top walls then touch the outermost grains. Throws
/// ManifestError if the file is invalid, if the grains do not fit, or if an overlap is larger than
/// the run allows (or, if the grains settle first, than settling allows).
PlacedGrains placed(const PackingText& packing, const Parameters& parameters, std::uint64_t seed,
                    const Poll& poll = {});

}  // namespace shearcell
