// SPDX-License-Identifier: GPL-3.0-or-later
// Figure S2: the form of the drag force changes how fast the grains compact, not the curve of
// crystallinity against packing fraction. Supplement B.3.
#include "analysis/figures/claims.hpp"
#include "analysis/figures/figures.hpp"

namespace shearcell {

FigureResult figure_s2(std::span<const FigureRun> runs) {
  // Red triangles and black squares, as in the supplement.
  static const std::vector<CurveStyle> styles = {
      {"still", "{/:Italic v}_{fluid }= 0", "#d62728", 9},
      {"cell", "{/:Italic v}_{fluid }= {/:Italic v}_{cell}", "#000000", 5}};
  return two_panels(curves_of(runs, "fluid", styles),
                    {.name = "S2", .section = "B.3", .what = "both drags", .similar_until = 60});
}

}  // namespace shearcell
