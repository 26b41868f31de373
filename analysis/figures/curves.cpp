// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/figures/curves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "analysis/error.hpp"

namespace shearcell {
namespace {

/// gnuplot's single-quoted text, in which only the quote itself means anything.
std::string literal(const std::string& text) {
  std::string inside;
  for (const char c : text) {
    if (c == '\'') inside += '\'';
    if (c != '\n') inside += c;
  }
  return fmt::format("'{}'", inside);
}

/// gnuplot reads _, ^, @, &, {, } and \ as markup in titles.
std::string plain_title(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (std::string("_^@&{}\\~").find(c) != std::string::npos) result += '\\';
    result += c;
  }
  return result;
}

CurveStyle style_of(const std::string& variant, std::span<const CurveStyle> styles,
                    std::size_t index) {
  for (const CurveStyle& style : styles) {
    if (style.variant == variant) return style;
  }
  static const std::vector<std::string> colours = {"#1f78b4", "#33a02c", "#ff7f00", "#6a3d9a"};
  return {variant, plain_title(variant), colours[index % colours.size()],
          6 + 2 * static_cast<int>(index % 4)};
}

}  // namespace

std::vector<Curve> curves_by_cycle(std::span<const FigureRun> runs,
                                   std::span<const std::string> known) {
  std::map<std::string, std::map<std::int64_t, std::vector<const Measures*>>> found;
  for (const FigureRun& run : runs) {
    std::set<std::int64_t> seen;
    for (const CheckpointMeasures& checkpoint : run.checkpoints) {
      if (std::floor(checkpoint.cycle) != checkpoint.cycle) continue;
      const auto cycle = static_cast<std::int64_t>(checkpoint.cycle);
      if (!seen.insert(cycle).second) {
        throw AnalysisError("run " + run.run_id + " has two checkpoints of cycle " +
                            std::to_string(cycle));
      }
      found[run.variant][cycle].push_back(&checkpoint.measures);
    }
  }
  std::vector<std::string> order(known.begin(), known.end());
  for (const auto& [variant, points] : found) {
    if (std::find(known.begin(), known.end(), variant) == known.end()) order.push_back(variant);
  }
  std::vector<Curve> curves;
  for (const std::string& variant : order) {
    const auto entry = found.find(variant);
    if (entry == found.end()) continue;
    Curve curve{variant, {}};
    for (const auto& [cycle, measures] : entry->second) curve.points.push_back({cycle, measures});
    curves.push_back(std::move(curve));
  }
  return curves;
}

std::string plot_curves(std::span<const Curve> curves, std::span<const CurveStyle> styles,
                        const CurveColumns& columns) {
  std::string text;
  for (std::size_t k = 0; k < curves.size(); ++k) {
    const CurveStyle style = style_of(curves[k].variant, styles, k);
    const bool both = columns.x_error > 0;
    const std::string values = fmt::format("{}:(strcol(1) eq {} ? column({}) : NaN)", columns.x,
                                           literal(curves[k].variant), columns.y);
    const std::string errors = both ? fmt::format("{}:{}", columns.x_error, columns.y_error)
                                    : std::to_string(columns.y_error);
    text += k == 0 ? "plot " : ", \\\n     ";
    text += fmt::format("data using {}:{} with {} lc rgb '{}' lw 0.8 pt 0 notitle, \\\n     ",
                        values, errors, both ? "xyerrorbars" : "yerrorbars", style.colour);
    text += fmt::format("data using {} with linespoints lc rgb '{}' pt {} ps 0.6 title {}", values,
                        style.colour, style.point, literal(style.title));
  }
  return text.empty() ? text : text + "\n";
}

}  // namespace shearcell
