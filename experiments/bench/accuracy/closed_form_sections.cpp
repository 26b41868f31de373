// SPDX-License-Identifier: GPL-3.0-or-later
// Error against cost of every method, for each motion with a closed form.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "core/watchdog.hpp"
#include "experiments/bench/accuracy/accuracy.hpp"
#include "experiments/bench/accuracy/closed_forms.hpp"
#include "experiments/manifest/conversion.hpp"

namespace shearcell::accuracy {
namespace {

constexpr std::array kColours = {"#000000", "#1f4fd8", "#2ca02c"};
constexpr std::array kPoints = {7, 9, 11};

// From a quarter of the supplement's smallest time step to the stability limit; its own four are
// among them.
std::vector<double> time_steps(bool quick) {
  if (quick) return {1.1e-5, 2.0 / 45600, 7.0e-5};
  return {5.5e-6, 1.1e-5, 2.6e-5, 3.5e-5, 2.0 / 45600, 7.0e-5, 1.0e-4, 1.2e-4};
}

// Seconds of one core that a cycle of 600 sheared grains takes: `evaluations` at every time step.
double cost(const Method& method, double dt, double engine_rate) {
  return method.evaluations / dt * Parameters{}.period_s * 600 / (1e6 * engine_rate);
}

double error_of(const ClosedForm& form, const Method& method, double dt) {
  try {
    return form.measure(method, dt);
  } catch (const NumericalFailure&) {  // the time step is too large for this scene
    return std::numeric_limits<double>::quiet_NaN();
  }
}

Chart chart_of(const ClosedForm& form) {
  Chart chart{.x = {.name = "seconds per cycle of 600 sheared grains", .log = true},
              .y = {.name = "relative error", .log = true},
              .title = form.title};
  for (std::size_t m = 0; m < methods().size(); ++m) {
    chart.series.push_back({.title = methods()[m].name,
                            .colour = kColours[m],
                            .point = kPoints[m],
                            .join = Join::line,
                            .columns = {.x = "seconds_per_cycle", .y = form.error},
                            .filter = {"method", methods()[m].name}});
  }
  return chart;
}

Section section_of(const ClosedForm& form, const Scene& scene, const std::vector<double>& steps,
                   double engine_rate) {
  Section section{form.title, {}, {"dt [s]", "dt/limit"}, {}};
  section.table.name = "accuracy-" + form.name;
  section.table.columns = {"method",
                           "time_step_s",
                           "time_step_over_contact_time",
                           "time_step_over_stability_limit",
                           "evaluations_per_contact_time",
                           "seconds_per_cycle",
                           form.error};
  section.table.chart = chart_of(form);
  const double limit = stability_limit_s(Parameters{}), contact = contact_time(scene);
  for (const double dt : steps) {
    section.summary.push_back({short_number(dt), fmt::format("{:.2f}", dt / limit)});
  }
  section.summary.push_back({"order", ""});
  for (const Method& method : methods()) {
    section.header.push_back(method.name);
    for (std::size_t s = 0; s < steps.size(); ++s) {
      const double dt = steps[s], error = error_of(form, method, dt);
      section.table.rows.push_back({method.name, dt, dt / contact, dt / limit,
                                    method.evaluations / dt * contact,
                                    cost(method, dt, engine_rate), error});
      section.summary[s].push_back(short_number(error, "stopped"));
    }
    // Larger steps bend the line.
    const double order = fitted_order([&](double dt) { return form.measure(method, dt); }, 4.4e-5,
                                      form.irregular ? 17 : 9);
    section.summary.back().push_back(fmt::format("{:.2f}", order));
  }
  return section;
}

}  // namespace

std::vector<Section> closed_form_sections(const Options& options, double engine_rate) {
  const Scene scene = shear_scene(Parameters{});
  Thoroughness how;
  if (options.quick) how = {.phases = 4, .periods = 2, .waves = 4, .wave_steps = 200};
  std::vector<Section> sections;
  for (const ClosedForm& form : closed_forms(scene, how)) {
    if (options.report) options.report(form.title);
    sections.push_back(section_of(form, scene, time_steps(options.quick), engine_rate));
  }
  return sections;
}

}  // namespace shearcell::accuracy
