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

/// A figure that compares variants of one parameter: phi against cycle, percentage against phi.
struct Comparison {
  std::string name;     ///< "S2": its panels are S2a and S2b
  std::string section;  ///< of the supplement
  std::string what;     ///< "drags", for the claims
  std::int64_t similar_until;
};
FigureResult two_panels(std::span<const Curve> curves, const Comparison& comparison);

}  // namespace shearcell
