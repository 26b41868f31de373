// SPDX-License-Identifier: GPL-3.0-or-later
// Table I and the parameters of the runs of every experiment. Supplement B.1.
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>
#include <string_view>

#include "analysis/expression.hpp"
#include "analysis/figure.hpp"
#include "analysis/plots.hpp"

namespace shearcell {
namespace {

constexpr double pi = std::numbers::pi;

/// A row of Table I, or the time step, which follows from two rows.
struct Parameter {
  const char* name;          ///< ends in the unit
  const char* heading;       ///< symbol and unit; may contain formulas
  double published;          ///< value in all simulations that do not vary the parameter
  const char* value = name;  ///< expression of manifest keys; it varies if one of them is swept
};

constexpr Parameter parameters[] = {
    {"mass_kg", "$m$ [kg]", 2.0e-5},
    {"diameter_m", "$d$ [m]", 3.0e-3},
    {"stiffness_N_per_m", "$k$ [N/m]", 6.54e2},
    {"drag_kg_per_s", "$b$ [kg/s]", 1.28e-3},
    {"pressure_Pa", "$P$ [Pa]", 9.54e2},
    {"omega_rad_per_s", "$ω$ [rad/s]", pi, "2*pi/period_s"},
    {"steps_per_cycle", "steps/cycle", 45600},
    {"time_step_s", "$Δt$ [s]", 2.0 / 45600, "period_s/steps_per_cycle"},
    {"gravity_m_per_s2", "$g$ [m/s²]", 9.81}};

/// The values of one parameter in the runs of one experiment.
struct Found : DataRange {
  std::size_t runs = 0;  ///< runs that have the parameter
  bool varied = false;   ///< varied by a sweep or by stiffening

  static bool equal(double a, double b) {
    constexpr double rounding = 1e-12;
    return std::abs(a - b) <= rounding * std::abs(b);
  }
  bool is_one_value() const { return equal(low, high); }
  const char* beside(double published) const {
    if (runs == 0) return "none";
    if (varied && !is_one_value()) return "varied";
    return equal(low, published) && equal(high, published) ? "equal" : "differs";
  }
};

Found found_in(RunGroup runs, const Parameter& parameter) {
  Found found;
  const std::string_view name = parameter.name;
  const NumberColumn column(parameter.value);
  for (const FrameRun* run : runs) {
    const double value = column(*run);
    if (!std::isfinite(value)) continue;
    ++found.runs;
    found.take(value);
    for (const std::string& key : names_in(parameter.value)) {
      found.varied = found.varied || run->place.swept.contains(key);
    }
    // The checkpoints of a stiffening stage record the current stiffness.
    const double stiffness = run->checkpoints.back().measures.number("raised_stiffness_N_per_m");
    if (name == "stiffness_N_per_m" && std::isfinite(stiffness)) {
      found.take(stiffness);
      found.varied = true;
    }
  }
  return found;
}

Text number_text(double value) {
  if (value == pi) return formula("$π$");
  const double size = std::abs(value);
  if (size == 0 || (size >= 0.01 && size < 1e5)) return fmt::format("{:.6g}", value);
  const auto exponent = static_cast<int>(std::floor(std::log10(size)));
  return formula(fmt::format("{:.4g}×10$^{{{}{}}}$", value / std::pow(10, exponent),
                             exponent < 0 ? "−" : "", std::abs(exponent)));
}

Text range_text(const Found& found) {
  if (found.runs == 0) return "–";
  const Text smallest = number_text(found.low);
  return found.is_one_value() ? smallest : smallest + " – " + number_text(found.high);
}

/// The first two rows of the drawn table: the headings, and the values of the supplement.
TextTable heading() {
  TextTable text{.widths = {170},
                 .rows = {{{"experiment"}}, {{"supplement, Table I"}}},
                 .note = "blue: varied by the experiment; red: differs from Table I"};
  for (const Parameter& parameter : parameters) {
    const std::string_view name = parameter.name;
    text.widths.push_back(name == "time_step_s" || name == "stiffness_N_per_m" ? 185 : 112);
    text.rows[0].push_back({formula(parameter.heading)});
    text.rows[1].push_back({number_text(parameter.published)});
  }
  return text;
}

const char* colour_of(std::string_view comparison) {
  return comparison == "differs" ? "#d55e00" : comparison == "varied" ? "#0072b2" : "#555555";
}

}  // namespace

FigureResult figure_table1(const Frame& frame) {
  std::map<std::string, std::vector<const FrameRun*>> experiments;
  for (const FrameRun& run : frame.runs) {
    if (!run.checkpoints.empty()) experiments[run.place.experiment].push_back(&run);
  }
  Table table{.name = "table1",
              .columns = {"experiment", "parameter", "supplement", "smallest", "largest", "runs",
                          "comparison"}};
  if (!experiments.empty()) table.text = heading();
  for (const auto& [experiment, members] : experiments) {
    auto& row = table.text.rows.emplace_back();
    row.push_back({experiment});
    for (const Parameter& parameter : parameters) {
      const Found found = found_in(members, parameter);
      const std::string comparison = found.beside(parameter.published);
      table.rows.push_back({experiment, parameter.name, parameter.published, found.low, found.high,
                            found.runs, comparison});
      row.push_back({range_text(found), colour_of(comparison)});
    }
  }
  return {{std::move(table)}, {}};
}

}  // namespace shearcell
