// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a checkpoint that reads well can be a cell at all: what a run goes on from or an analysis
// takes must not lead them out of the range of a double, or on forever.
#pragma once

#include "provenance/checkpoint.hpp"

namespace shearcell {

/// Throws StoreDamaged, naming the place in the file, when a length or a tilt is none of a cell.
void require_plausible(const Checkpoint& checkpoint);

}  // namespace shearcell
