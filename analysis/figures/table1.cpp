// SPDX-License-Identifier: GPL-3.0-or-later
// Table I beside the parameters that the runs of every experiment had. Supplement B.1.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <string_view>

#include "analysis/figures/curves.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/published.hpp"

namespace shearcell {
namespace {

/// One row of Table I, and the time step, which follows from two of them.
struct Quantity {
  const char* name;     ///< with its unit
  const char* heading;  ///< gnuplot enhanced text
  double published;
  std::array<std::string_view, 2> keys;  ///< of a manifest; sweeping one of them varies it
  double (*of)(const FigureRun& run);    ///< NaN where the run has no such thing
};

double time_step(const FigureRun& run) {
  return number_of(run, "period_s") / number_of(run, "steps_per_cycle");
}

constexpr double pi = std::numbers::pi;

const std::array<Quantity, 9>& quantities() {
  using Run = const FigureRun&;
  static const std::array<Quantity, 9> all = {{
      {"mass_kg",
       "{/:Italic m} [kg]",
       published_mass_kg,
       {"mass_kg"},
       [](Run run) { return number_of(run, "mass_kg"); }},
      {"diameter_m",
       "{/:Italic d} [m]",
       published_diameter_m,
       {"diameter_m"},
       [](Run run) { return number_of(run, "diameter_m"); }},
      {"stiffness_N_per_m",
       "{/:Italic k} [N/m]",
       published_stiffness_N_per_m,
       {"stiffness_N_per_m"},
       [](Run run) { return number_of(run, "stiffness_N_per_m"); }},
      {"drag_kg_per_s",
       "{/:Italic b} [kg/s]",
       published_drag_kg_per_s,
       {"drag_kg_per_s"},
       [](Run run) { return number_of(run, "drag_kg_per_s"); }},
      {"pressure_Pa",
       "{/:Italic P} [Pa]",
       published_pressure_Pa,
       {"pressure_Pa"},
       [](Run run) { return number_of(run, "pressure_Pa"); }},
      {"omega_rad_per_s",
       "{/:Italic ω} [rad/s]",
       2 * pi / published_period_s,
       {"period_s"},
       [](Run run) { return 2 * pi / number_of(run, "period_s"); }},
      {"steps_per_cycle",
       "steps/cycle",
       published_steps_per_cycle,
       {"steps_per_cycle"},
       [](Run run) { return number_of(run, "steps_per_cycle"); }},
      {"time_step_s",
       "{/:Italic Δt} [s]",
       published_period_s / published_steps_per_cycle,
       {"period_s", "steps_per_cycle"},
       time_step},
      {"gravity_m_per_s2",
       "{/:Italic g} [m/s^2]",
       published_gravity_m_per_s2,
       {"gravity_m_per_s2"},
       [](Run run) { return number_of(run, "gravity_m_per_s2"); }},
  }};
  return all;
}

/// What the runs of one experiment had of one quantity.
struct Found {
  double smallest = std::numeric_limits<double>::infinity();
  double largest = -std::numeric_limits<double>::infinity();
  std::size_t runs = 0;  ///< that have it
  bool varied = false;   ///< on purpose

  void take(double value) {
    smallest = std::min(smallest, value);
    largest = std::max(largest, value);
  }
  bool equals(double published) const {
    constexpr double rounding = 1e-12;
    return std::abs(smallest - published) <= rounding * published &&
           std::abs(largest - published) <= rounding * published;
  }
  const char* beside(double published) const {
    if (runs == 0) return "none";
    if (varied) return "varied";
    return equals(published) ? "equal" : "differs";
  }
};

using Runs = std::vector<const FigureRun*>;

Found found_in(const Runs& runs, const Quantity& quantity) {
  Found found;
  for (const FigureRun* run : runs) {
    const double value = quantity.of(*run);
    if (!std::isfinite(value)) continue;
    ++found.runs;
    found.take(value);
    for (const std::string_view key : quantity.keys) {
      found.varied = found.varied || (run->labels.is_object() && run->labels.contains(key));
    }
    // A stiffening says at each checkpoint how far it came.
    const double stiffness = run->checkpoints.back().stiffness_N_per_m;
    if (quantity.keys.front() == "stiffness_N_per_m" && std::isfinite(stiffness)) {
      found.take(stiffness);
      found.varied = true;
    }
  }
  return found;
}

std::string number_text(double value) {
  if (value == pi) return "{/:Italic π}";
  const double size = std::abs(value);
  if (size == 0 || (size >= 0.01 && size < 1e5)) return fmt::format("{:.6g}", value);
  const auto exponent = static_cast<int>(std::floor(std::log10(size)));
  return fmt::format("{:.4g}×10^{{{}}}", value / std::pow(10, exponent), exponent);
}

std::string range_text(const Found& found) {
  if (found.runs == 0) return "–";
  const std::string low = number_text(found.smallest);
  const std::string high = number_text(found.largest);
  return low == high ? low : low + " – " + high;
}

/// Texts at places of the drawing [px], with a row for the supplement and one for each experiment.
class Drawing {
 public:
  explicit Drawing(FigureTable& table, std::size_t experiments) : table_(table) {
    table_.width = first_column;
    for (const Quantity& quantity : quantities()) table_.width += width_of(quantity);
    table_.height = row_height * (static_cast<int>(experiments) + 3);
    table_.plot = "unset border\nunset tics\nunset key\nset margins 0,0,0,0\n";
    text("experiment", margin, "left noenhanced", "#000000");
    cells([](const Quantity& q) { return std::pair(std::string(q.heading), "#000000"); });
    next_row();
    rule();
    text("supplement, Table I", margin, "left", "#000000");
    cells([](const Quantity& q) { return std::pair(number_text(q.published), "#000000"); });
    next_row();
    rule();
  }

  void add(const std::string& experiment, std::span<const Found> found) {
    text(experiment, margin, "left noenhanced", "#000000");
    std::size_t k = 0;
    cells([&](const Quantity& quantity) {
      const Found& here = found[k++];
      const std::string_view verdict = here.beside(quantity.published);
      return std::pair(range_text(here), verdict == "differs"  ? "#d62728"
                                         : verdict == "varied" ? "#1f4fd8"
                                                               : "#555555");
    });
    next_row();
  }

  void finish() {
    rule();
    text("blue: varied by the experiment; red: not as in Table I", margin, "left", "#555555");
    table_.plot += "plot [0:1] [0:1] NaN\n";
  }

 private:
  static constexpr int first_column = 170;
  static constexpr int margin = 10;
  static constexpr int row_height = 26;

  static int width_of(const Quantity& quantity) {
    return std::string_view(quantity.name) == "time_step_s" ||
                   std::string_view(quantity.name) == "stiffness_N_per_m"
               ? 185
               : 112;
  }

  template <class TextAndColour>
  void cells(TextAndColour&& cell) {
    int left = first_column;
    for (const Quantity& quantity : quantities()) {
      const auto [words, colour] = cell(quantity);
      text(words, left + width_of(quantity) / 2, "center", colour);
      left += width_of(quantity);
    }
  }

  void text(const std::string& words, int x, const char* how, const char* colour) {
    table_.plot +=
        fmt::format("set label {} at screen {:.5f}, screen {:.5f} {} tc rgb '{}'\n", literal(words),
                    share(x, table_.width), 1 - share(y_, table_.height), how, colour);
  }
  void rule() {
    const double y = 1 - share(y_ - row_height / 2, table_.height);
    table_.plot += fmt::format(
        "set arrow from screen 0, screen {0:.5f} to screen 1, screen {0:.5f} nohead lw 0.8\n", y);
  }
  void next_row() { y_ += row_height; }
  static double share(int part, int whole) { return static_cast<double>(part) / whole; }

  FigureTable& table_;
  int y_ = row_height / 2 + 3;
};

Verdict verdict_on(const std::string& experiment, std::span<const Found> found, std::size_t runs) {
  std::size_t compared = 0, different = 0;
  std::string note = fmt::format("{} runs", runs);
  for (std::size_t k = 0; k < found.size(); ++k) {
    const Quantity& quantity = quantities()[k];
    const std::string_view beside = found[k].beside(quantity.published);
    compared += beside == "none" ? 0 : 1;
    different += beside == "differs" ? 1 : 0;
    if (beside == "none" || beside == "equal") continue;
    note += fmt::format("; {} {}", beside == "varied" ? "varies" : "differs in", quantity.name);
    note += fmt::format(" ({:.6g} .. {:.6g})", found[k].smallest, found[k].largest);
  }
  return below_if(
      compared > 0,
      fmt::format("B.1: {} has the numbers of Table I, but for what it varies", experiment),
      "numbers that differ", static_cast<double>(different), 1, note);
}

}  // namespace

FigureResult figure_table1(std::span<const FigureRun> runs) {
  std::map<std::string, Runs> experiments;
  for (const FigureRun& run : runs) {
    if (!run.checkpoints.empty()) experiments[run.experiment].push_back(&run);
  }
  FigureResult result;
  FigureTable table;
  table.name = "table1";
  table.columns = {"experiment", "parameter", "supplement", "smallest",
                   "largest",    "runs",      "comparison"};
  Drawing drawing(table, experiments.size());
  for (const auto& [experiment, members] : experiments) {
    std::vector<Found> row;
    for (const Quantity& quantity : quantities()) {
      const Found& found = row.emplace_back(found_in(members, quantity));
      table.rows.push_back({experiment, std::string(quantity.name), quantity.published,
                            found.smallest, found.largest, static_cast<std::int64_t>(found.runs),
                            std::string(found.beside(quantity.published))});
    }
    drawing.add(experiment, row);
    result.verdicts.push_back(verdict_on(experiment, row, members.size()));
  }
  if (!experiments.empty()) drawing.finish();
  result.tables.push_back(std::move(table));
  return result;
}

}  // namespace shearcell
