// SPDX-License-Identifier: GPL-3.0-or-later
// Figure S4: which wall moves vertically changes how fast the grains compact, not the curve of
// crystallinity against packing fraction. Supplement B.6.
#include "analysis/figures/claims.hpp"
#include "analysis/figures/figures.hpp"

namespace shearcell {

FigureResult figure_s4(std::span<const FigureRun> runs) {
  // Red triangles and black squares, as in the supplement.
  static const std::vector<CurveStyle> styles = {{"bottom", "top fixed", "#d62728", 9},
                                                 {"top", "top moves vertically", "#000000", 5}};
  return two_panels(
      curves_of(runs, "moving_wall", styles),
      {.name = "S4", .section = "B.6", .what = "both moving walls", .similar_until = 40});
}

}  // namespace shearcell
