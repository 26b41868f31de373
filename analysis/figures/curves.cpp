// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/figures/curves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "analysis/binning.hpp"
#include "analysis/error.hpp"

namespace shearcell {
namespace {

constexpr const char* cycle_label = "shear cycle  {/:Italic n}";
constexpr const char* phi_label = "volume fraction  {/:Italic ϕ}";
constexpr const char* crystalline_label = "percentage crystalline  [%]";

bool matches(const nlohmann::json& a, const nlohmann::json& b) {
  if (a.is_number() && b.is_number()) {
    const auto x = a.get<double>();
    const auto y = b.get<double>();
    return std::abs(x - y) <= 0.03 * std::abs(y);
  }
  return a == b;
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

/// gnuplot's strcol() ends a field at a comma, quoted or not, and reads quotes in ways of its own.
/// No name that a manifest gives has other characters than these; one of a stranger's store may.
std::string plain_field(std::string variant) {
  const auto odd = [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x80 && std::isalnum(byte) == 0 &&
           std::string_view("=.+-_;: /").find(c) == std::string_view::npos;
  };
  std::replace_if(variant.begin(), variant.end(), odd, ';');
  return variant;
}

CurveStyle style_of_other(const std::string& variant, std::size_t index) {
  static const std::array<const char*, 6> colours = {"#1f78b4", "#33a02c", "#ff7f00",
                                                     "#6a3d9a", "#b15928", "#000000"};
  return {nullptr, plain_title(variant), colours[index % colours.size()],
          6 + 2 * static_cast<int>(index % 4)};
}

std::vector<CurvePoint> points_of(std::span<const FigureRun* const> runs) {
  std::map<std::int64_t, std::vector<const Measures*>> found;
  for (const FigureRun* run : runs) {
    std::set<std::int64_t> seen;
    for (const CheckpointMeasures& checkpoint : run->checkpoints) {
      if (std::floor(checkpoint.cycle) != checkpoint.cycle) continue;
      const auto cycle = static_cast<std::int64_t>(checkpoint.cycle);
      if (!seen.insert(cycle).second) {
        throw AnalysisError("run " + run->run_id + " has two checkpoints of cycle " +
                            std::to_string(cycle));
      }
      found[cycle].push_back(&checkpoint.measures);
    }
  }
  std::vector<CurvePoint> points;
  for (auto& [cycle, measures] : found) points.push_back({cycle, std::move(measures)});
  return points;
}

/// So that the marks of a long curve stay apart.
std::size_t cycles_between_marks(std::span<const Curve> curves) {
  constexpr std::size_t most_marks = 60;
  std::size_t points = 1;
  for (const Curve& curve : curves) points = std::max(points, curve.points.size());
  std::size_t spacing = 1;
  for (const std::size_t step : {2U, 5U, 10U, 20U, 50U, 100U, 200U, 500U, 1000U}) {
    if (points / spacing > most_marks) spacing = step;
  }
  return spacing;
}

}  // namespace

std::vector<Curve> curves_of(std::span<const FigureRun> runs, const std::string& parameter,
                             std::span<const CurveStyle> styles) {
  return curves_by(
      runs, [&](const FigureRun& run) { return parameter_of(run, parameter); }, styles);
}

std::vector<Curve> curves_by(std::span<const FigureRun> runs,
                             const std::function<nlohmann::json(const FigureRun&)>& value_of,
                             std::span<const CurveStyle> styles) {
  std::map<std::string, std::vector<const FigureRun*>> variants;
  for (const FigureRun& run : runs) variants[run.variant].push_back(&run);
  std::vector<std::pair<std::size_t, Curve>> ranked;
  for (auto& [variant, members] : variants) {
    Curve curve;
    curve.variant = plain_field(variant);
    curve.value = value_of(*members.front());
    curve.points = points_of(members);
    curve.runs = std::move(members);
    if (curve.points.empty()) continue;
    const auto style = std::find_if(styles.begin(), styles.end(), [&](const CurveStyle& s) {
      return matches(curve.value, s.value);
    });
    const auto rank = static_cast<std::size_t>(style - styles.begin());
    curve.style =
        style == styles.end() ? style_of_other(variant, styles.size() + ranked.size()) : *style;
    ranked.emplace_back(rank, std::move(curve));
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Curve> curves;
  for (auto& [rank, curve] : ranked) curves.push_back(std::move(curve));
  return curves;
}

const Curve* curve_with(std::span<const Curve> curves, const nlohmann::json& value) {
  for (const Curve& curve : curves) {
    if (matches(curve.value, value)) return &curve;
  }
  return nullptr;
}

RunStatistics over(const CurvePoint& point, double Measures::*quantity) {
  std::vector<double> values;
  values.reserve(point.runs.size());
  for (const Measures* measures : point.runs) values.push_back(measures->*quantity);
  return over_runs(values);
}

std::string literal(const std::string& text) {
  std::string inside;
  for (const char c : text) {
    if (c == '\'') inside += '\'';
    if (static_cast<unsigned char>(c) >= 0x20) inside += c;  // a line's end would end the text
  }
  return fmt::format("'{}'", inside);
}

std::string plot_curves(std::span<const Curve> curves, const CurveColumns& columns) {
  const bool both = columns.x_error > 0;
  const std::size_t spacing = both ? 1 : cycles_between_marks(curves);
  std::string text;
  for (const Curve& curve : curves) {
    const std::string own = fmt::format("strcol(1) eq {}", literal(curve.variant));
    const std::string values = fmt::format("{}:({} ? column({}) : NaN)", columns.x, own, columns.y);
    const std::string marked =
        spacing == 1 ? values
                     : fmt::format("{0}:({1} && int(column({0})) % {2} == 0 ? column({3}) : NaN)",
                                   columns.x, own, spacing, columns.y);
    const std::string errors = both ? fmt::format("{}:{}", columns.x_error, columns.y_error)
                                    : std::to_string(columns.y_error);
    text += text.empty() ? "plot " : ", \\\n     ";
    text += fmt::format("data using {}:{} with {} lc rgb '{}' lw 0.8 pt 0 notitle, \\\n     ",
                        marked, errors, both ? "xyerrorbars" : "yerrorbars", curve.style.colour);
    const std::string look = fmt::format("lc rgb '{}' pt {} ps 0.6 title {}", curve.style.colour,
                                         curve.style.point, literal(curve.style.title));
    if (spacing == 1) {
      text += fmt::format("data using {} with linespoints {}", values, look);
    } else {
      text += fmt::format(
          "data using {} with lines lc rgb '{}' notitle, \\\n     data using {} with points {}",
          values, curve.style.colour, marked, look);
    }
  }
  return text.empty() ? text : text + "\n";
}

std::vector<ChartSeries> chart_curves(std::span<const Curve> curves, const TableRows& rows,
                                      const CurveColumns& columns) {
  std::vector<ChartSeries> series;
  for (const Curve& curve : curves) {
    series.push_back({curve.style.title, curve.style.colour, curve.style.point, true,
                      chart_points(rows, columns, 1, curve.variant)});
  }
  return series;
}

std::string points_with_errors(const std::string& x, const std::string& y, int error_column,
                               const std::string& colour, int point, const std::string& title) {
  return fmt::format(
      "data using {0}:{1}:{2} with yerrorbars lc rgb '{3}' lw 0.8 pt 0 notitle, \\\n"
      "     data using {0}:{1} with points lc rgb '{3}' pt {4} ps 0.7 title {5}",
      x, y, error_column, colour, point, literal(title));
}

std::vector<double> onset_levels() {
  return {0.645, 0.647};
}

std::string onset_lines() {
  std::string text = "set yrange [*<0.6445:0.6475<*]\n";  // both, wherever the data are
  for (const double phi : onset_levels()) {
    text += fmt::format(
        "set arrow from graph 0, first {0} to graph 1, first {0} nohead dt 2 lc rgb '#888888'\n",
        phi);
  }
  return text;
}

std::string cycle_axis(std::span<const Curve> curves) {
  std::int64_t last = 0;
  for (const Curve& curve : curves) last = std::max(last, curve.points.back().cycle);
  return fmt::format("set xlabel '{}'\n", cycle_label) +
         (last <= 10 ? "set xtics 1\nunset mxtics\n" : "");
}

FigureTable phi_against_cycle(const std::string& name, std::span<const Curve> curves) {
  FigureTable table;
  table.name = name;
  table.columns = {"variant",
                   "cycle",
                   "phi_mean",
                   "phi_standard_error",
                   "phi_u_mean",
                   "phi_u_standard_error",
                   "overlap_mean_d",
                   "overlap_standard_error_d",
                   "runs"};
  for (const Curve& curve : curves) {
    for (const CurvePoint& point : curve.points) {
      const RunStatistics phi = over(point, &Measures::phi);
      const RunStatistics phi_u = over(point, &Measures::phi_uncorrected);
      const RunStatistics overlap = over(point, &Measures::mean_overlap);
      table.rows.push_back(
          {curve.variant, point.cycle, table_value(phi.mean), table_value(phi.standard_error),
           table_value(phi_u.mean), table_value(phi_u.standard_error), table_value(overlap.mean),
           table_value(overlap.standard_error), static_cast<std::int64_t>(phi.runs)});
    }
  }
  table.plot = cycle_axis(curves) + fmt::format("set ylabel '{}'\n", phi_label) +
               plot_curves(curves, {.x = 2, .x_error = 0, .y = 3, .y_error = 4});
  table.chart = {{.label = cycle_label},
                 {.label = phi_label},
                 chart_curves(curves, table.rows, {.x = 2, .x_error = 0, .y = 3, .y_error = 4}),
                 {}};
  return table;
}

FigureTable crystallinity_against_cycle(const std::string& name, std::span<const Curve> curves) {
  FigureTable table;
  table.name = name;
  table.columns = {"variant", "cycle", "crystalline_mean_percent",
                   "crystalline_standard_error_percent", "runs"};
  for (const Curve& curve : curves) {
    for (const CurvePoint& point : curve.points) {
      const RunStatistics crystalline = over(point, &Measures::crystalline_percent);
      table.rows.push_back({curve.variant, point.cycle, table_value(crystalline.mean),
                            table_value(crystalline.standard_error),
                            static_cast<std::int64_t>(crystalline.runs)});
    }
  }
  table.plot = cycle_axis(curves) +
               fmt::format("set ylabel '{}'\nset yrange [0:*]\n", crystalline_label) +
               plot_curves(curves, {.x = 2, .x_error = 0, .y = 3, .y_error = 4});
  table.chart = {{.label = cycle_label},
                 {.label = crystalline_label, .low = 0},
                 chart_curves(curves, table.rows, {.x = 2, .x_error = 0, .y = 3, .y_error = 4}),
                 {}};
  return table;
}

FigureTable crystallinity_against_phi(const std::string& name, std::span<const Curve> curves) {
  FigureTable table;
  table.name = name;
  table.columns = {"variant",
                   "phi_low",
                   "phi_high",
                   "phi_mean",
                   "phi_standard_error",
                   "crystalline_mean_percent",
                   "crystalline_standard_error_percent",
                   "runs"};
  for (const Curve& curve : curves) {
    for (const PhiBin& bin : binned_by_phi(curve.runs, &Measures::crystalline_percent)) {
      table.rows.push_back({curve.variant, bin.low, bin.high, table_value(bin.phi.mean),
                            table_value(bin.phi.standard_error), table_value(bin.value.mean),
                            table_value(bin.value.standard_error),
                            static_cast<std::int64_t>(bin.value.runs)});
    }
  }
  table.plot = fmt::format("set xlabel '{}'\nset ylabel '{}'\n", phi_label, crystalline_label) +
               "set yrange [0:*]\n"
               "set offsets graph 0.03, graph 0.03, graph 0.05, 0\n" +
               plot_curves(curves, {.x = 4, .x_error = 5, .y = 6, .y_error = 7});
  table.chart = {{.label = phi_label},
                 {.label = crystalline_label, .low = 0},
                 chart_curves(curves, table.rows, {.x = 4, .x_error = 5, .y = 6, .y_error = 7}),
                 {}};
  return table;
}

}  // namespace shearcell
