// SPDX-License-Identifier: GPL-3.0-or-later
// Claims that several figures share: curves that agree, differ, or begin alike.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "analysis/figures/curves.hpp"

namespace shearcell {

/// Every two curves of phi against cycle agree (analysis/agreement.hpp) over cycles 1 .. until. The
/// pair that agrees worst is the one that is reported. `together` is how many such claims the
/// figure makes, among which the chance to fail is shared as it is among the pairs of one.
Verdict phi_agrees_until(std::span<const Curve> curves, std::int64_t until, std::string claim,
                         std::size_t together = 1);

/// Every two curves of percentage against phi agree, over the bins in which one of them has more
/// than 1 % of crystalline grains; fewer than three such bins tell nothing.
Verdict crystallinity_agrees(std::span<const Curve> curves, std::string claim);

/// B5: phi of paused shear above that of continuous shear, seed by seed.
Verdict pauses_compact_faster(std::span<const Curve> curves);

/// S3: the mean overlap at the time step of the main text.
Verdict overlap_is_small(std::span<const Curve> curves);

std::vector<Verdict> wall_verdicts(std::span<const Curve> curves);

}  // namespace shearcell
