// SPDX-License-Identifier: GPL-3.0-or-later
// Sections on small scenes: every method's error against cost, dispersion, drift of energy.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "experiments/manifest/conversion.hpp"
#include "experiments/report/accuracy/accuracy.hpp"
#include "experiments/report/accuracy/closed_forms.hpp"
#include "experiments/report/accuracy/crystal.hpp"
#include "experiments/report/accuracy/work_precision.hpp"

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
void summarize(const std::vector<WorkPoint>& points, const std::vector<double>& steps,
               Section& section) {
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
    row.push_back(fmt::format("{:.2f}", order_of(points, method, largest)));
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
    summarize(points, steps, section);
    sections.push_back(std::move(section));
  }
  return sections;
}

Section dispersion_section(const Options& options) {
  constexpr double overlap = 0.003;
  const Scene scene = shear_scene(kTable1);
  const double dt = scene.time_step;
  const int layers = options.quick ? 4 : 8;
  const std::uint64_t steps = options.quick ? 200 : 2000;
  Section section{"Waves along z at Table I's time step", {}, {}, {}, {}};
  section.table.name = "accuracy-dispersion";
  section.table.columns = {
      "wave",           "wave_number_per_d", "exact_rad_per_s", "found_rad_per_s",
      "relative_error", "leapfrog_theory"};
  section.header = {"wave", "q [1/d]", "exact [rad/s]", "found", "error", "(w dt)^2/24"};
  double worst = 0;
  const auto measure = [&](const std::string& wave, const Crystal& crystal, const Method& method,
                           Eigen::Index axis, double q, double exact) {
    Eigen::Matrix3Xd shape = Eigen::Matrix3Xd::Zero(3, crystal.position.cols());
    shape.row(axis) = (q * crystal.position.row(2)).array().cos();
    const Eigen::VectorXd unit = shape.reshaped().normalized();
    const double found = measured_frequency(crystal, unit, method, dt, steps);
    const double theory = std::asin(exact * dt / 2) / (exact * dt / 2) - 1;
    worst = std::max(worst, std::fabs(found / exact - 1 - theory));
    section.table.rows.push_back({wave, q, exact, found, found / exact - 1, theory});
    section.summary.push_back({wave, number(q), fmt::format("{:.1f}", exact),
                               fmt::format("{:.1f}", found), number(found / exact - 1),
                               number(theory)});
  };
  const Crystal row = chain(scene, 2 * layers, overlap);
  const Crystal bulk = fcc(scene, layers, overlap, false);
  for (int n = 1; n <= layers; ++n) {
    const double q = 2 * std::numbers::pi * n / row.box.size.z();
    measure("row, engine", row, engine(), 2, q, chain_longitudinal(scene, overlap, q));
  }
  for (int n = 1; n <= layers / 2; ++n) {
    const double q = 2 * std::numbers::pi * n / bulk.box.size.z();
    measure("FCC longitudinal", bulk, methods()[1], 2, q, fcc_longitudinal(scene, overlap, q));
    measure("FCC transverse", bulk, methods()[1], 0, q, fcc_transverse(scene, overlap, q));
  }
  section.findings.push_back(fmt::format(
      "Every frequency is too high by what the leapfrog's own dispersion, sin(w' dt/2) = w dt/2, "
      "says; the rest is {:.1g}.",
      worst));
  section.table.plot =
      "set xlabel 'wave number  {/:Italic q}  [1/{/:Italic d}]'\n"
      "set ylabel 'frequency  [rad/s]'\n"
      "plot data using (strcol(1) eq 'row, engine' ? $2 : NaN):3 with lines lc rgb '#888888' "
      "notitle, \\\n"
      "     data using (strcol(1) eq 'FCC longitudinal' ? $2 : NaN):3 with lines lc rgb '#d62728' "
      "notitle, \\\n"
      "     data using (strcol(1) eq 'FCC transverse' ? $2 : NaN):3 with lines lc rgb '#1f4fd8' "
      "notitle, \\\n"
      "     data using (strcol(1) eq 'row, engine' ? $2 : NaN):4 with points pt 6 lc rgb "
      "'#000000' title 'row of grains', \\\n"
      "     data using (strcol(1) eq 'FCC longitudinal' ? $2 : NaN):4 with points pt 7 lc rgb "
      "'#d62728' title 'FCC, longitudinal', \\\n"
      "     data using (strcol(1) eq 'FCC transverse' ? $2 : NaN):4 with points pt 9 lc rgb "
      "'#1f4fd8' title 'FCC, transverse'\n";
  return section;
}

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
    for (const Method& method : methods()) {
      // The rivals' plain texts are slow: a tenth shows what they do.
      const bool whole = method.kind == Method::Kind::engine && !opening;
      const std::uint64_t steps = options.quick ? 20'000 : whole ? 1'000'000 : 100'000;
      const char* contacts = opening ? "opening" : "closed";
      if (options.report)
        options.report(fmt::format("{}: energy, contacts {}", method.name, contacts));
      const DriftResult r = energy_drift(crystal, start, method, scene.time_step, steps);
      const double rate = r.drift / (static_cast<double>(steps) * scene.time_step);
      section.table.rows.push_back({std::string(contacts), method.name,
                                    static_cast<std::int64_t>(steps), r.drift, r.scatter, rate,
                                    r.momentum});
      section.summary.push_back({contacts, method.name, std::to_string(steps), number(r.drift),
                                 number(r.scatter), number(rate), number(r.momentum)});
      if (method.kind != Method::Kind::engine) continue;
      section.findings.push_back(
          opening
              ? fmt::format("Contacts that open and close heat the engine's grains, by {:.2g} of "
                            "their energy a second; Table I's drag takes up to {:.0f} a second.",
                            rate, scene.drag_rate)
              : fmt::format("Engine, contacts closed: drift {:.1e} over {} steps, momentum {:.1e}.",
                            r.drift, steps, r.momentum));
    }
  }
  return section;
}

}  // namespace shearcell::accuracy
