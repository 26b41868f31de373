// SPDX-License-Identifier: GPL-3.0-or-later
// Sections on small scenes: every method's error against cost, drift of energy.
#include <fmt/format.h>

#include <cmath>

#include "experiments/manifest/conversion.hpp"
#include "experiments/bench/accuracy/accuracy.hpp"
#include "experiments/bench/accuracy/closed_forms.hpp"
#include "experiments/bench/accuracy/crystal.hpp"
#include "experiments/bench/accuracy/work_precision.hpp"

namespace shearcell::accuracy {
namespace {

const Parameters kTable1;

std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.3g}", value) : "stopped";
}

// From a quarter of the supplement's smallest time step over its four to the stability limit.
std::vector<double> time_steps(bool quick) {
  if (quick) return {1.1e-5, 2.0 / 45600, 7.0e-5};
  return {5.5e-6, 1.1e-5, 2.6e-5, 3.5e-5, 2.0 / 45600, 7.0e-5, 1.0e-4, 1.2e-4};
}

// Rows: time steps; columns: methods.
void summarize(const SmallScene& small, const std::vector<WorkPoint>& points,
               const std::vector<double>& steps, Section& section) {
  section.header = {"dt [s]", "dt/limit"};
  for (const Method& method : methods()) section.header.push_back(method.name);
  for (std::size_t s = 0; s < steps.size(); ++s) {
    std::vector<std::string> row = {fmt::format("{:.3g}", steps[s]),
                                    fmt::format("{:.2f}", steps[s] / stability_limit_s(kTable1))};
    for (std::size_t m = 0; m < methods().size(); ++m) {
      row.push_back(number(points[m * steps.size() + s].error));
    }
    section.summary.push_back(std::move(row));
  }
  // Above, the largest steps would bend the line.
  constexpr double largest = 4.4e-5;
  std::vector<std::string> row = {"order", ""};
  for (const Method& method : methods()) {
    row.push_back(fmt::format("{:.2f}", order_of(small, points, method, largest)));
  }
  section.summary.push_back(std::move(row));
}

}  // namespace

std::vector<Section> small_scene_sections(const Options& options, double engine_rate) {
  const Scene scene = shear_scene(kTable1);
  const Cost cost{contact_time(scene), stability_limit_s(kTable1), kTable1.period_s,
                  600 / (1e6 * engine_rate)};
  SmallSceneSettings settings;
  if (options.quick)
    settings = {.phases = 4, .periods = 2, .layers = 4, .modes = 2, .mode_steps = 200};
  const std::vector<double> steps = time_steps(options.quick);
  std::vector<Section> sections;
  for (const SmallScene& small : small_scenes(scene, settings)) {
    if (options.report) options.report(small.title);
    const std::vector<WorkPoint> points = work_points(small, steps);
    Section section{small.title, work_table(small, points, cost), {}, {}, {}};
    summarize(small, points, steps, section);
    sections.push_back(std::move(section));
  }
  return sections;
}

namespace {

std::string finding_on(const DriftResult& r, double rate, std::uint64_t steps, bool opening,
                       double drag_rate) {
  if (!opening) {
    return fmt::format("Engine, contacts closed: drift {:.1e} over {} steps, momentum {:.1e}.",
                       r.drift, steps, r.momentum);
  }
  return fmt::format(
      "Contacts that open and close heat the engine's grains, by {:.2g} of their energy a second; "
      "Table I's drag takes up to {:.0f} a second.",
      rate, drag_rate);
}

}  // namespace

Section drift_section(const Options& options) {
  const Scene scene = shear_scene(kTable1);
  const Crystal crystal = fcc(scene, options.quick ? 4 : 6, 0.003, true);
  Section section{
      "Energy of a vibrating FCC crystal without drag, Table I's time step", {}, {}, {}, {}};
  section.table.name = "accuracy-drift";
  section.table.columns = {"contacts",         "method",  "steps",
                           "relative_drift",   "scatter", "rate_per_second",
                           "relative_momentum"};
  section.header = {"contacts", "method", "steps", "drift", "scatter", "rate [1/s]", "momentum"};
  for (const bool opening : {false, true}) {
    const Motion start = shaken(crystal, opening ? 40 : 0.5, 1);
    const std::string contacts = opening ? "opening" : "closed";
    for (const Method& method : methods()) {
      if (options.report) options.report(method.name + ": energy, contacts " + contacts);
      // The rivals' plain texts are slow: a tenth shows what they do.
      const bool is_engine = method.kind == Method::Kind::engine;
      const std::uint64_t steps = options.quick           ? 20'000
                                  : is_engine && !opening ? 1'000'000
                                                          : 100'000;
      const DriftResult r = energy_drift(crystal, start, method, scene.time_step, steps);
      const double rate = r.drift / (static_cast<double>(steps) * scene.time_step);
      section.table.rows.push_back({contacts, method.name, static_cast<std::int64_t>(steps),
                                    r.drift, r.scatter, rate, r.momentum});
      section.summary.push_back({contacts, method.name, std::to_string(steps), number(r.drift),
                                 number(r.scatter), number(rate), number(r.momentum)});
      if (is_engine) {
        section.findings.push_back(finding_on(r, rate, steps, opening, scene.drag_rate));
      }
    }
  }
  return section;
}

}  // namespace shearcell::accuracy
