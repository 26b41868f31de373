// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/accuracy/accuracy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <span>

#include "analysis/statistics.hpp"
#include "core/watchdog.hpp"
#include "experiments/bench/accuracy/closed_forms.hpp"
#include "experiments/bench/packing.hpp"
#include "experiments/bench/speed.hpp"
#include "experiments/manifest/conversion.hpp"
#include "protocols/stiffen.hpp"

namespace shearcell::accuracy {
namespace {

using bench::PackingNumbers;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Three significant digits; `otherwise` if the value is not finite.
std::string short_number(double value, const std::string& otherwise = "") {
  return std::isfinite(value) ? fmt::format("{:.3g}", value) : otherwise;
}

std::string fixed(const std::optional<double>& value, int digits) {
  return fmt::format("{:.{}f}", value.value_or(kNaN), digits);
}

std::string with_error(const RunStatistics& of, int digits) {
  return fixed(of.mean, digits) + " +- " + fixed(of.standard_error, digits);
}

Parameters small_cell(bool quick) {
  Parameters parameters;
  parameters.grains = quick ? 300 : 600;
  return parameters;
}

// Seconds that one core takes for a cycle, at `engine_rate` million particle-steps/s.
double seconds_per_cycle(std::uint64_t grains, double time_step, double engine_rate) {
  return Parameters{}.period_s / time_step * static_cast<double>(grains) / (1e6 * engine_rate);
}

// NaN if the watchdog stops the run: the time step is too large for this scene.
double error_of(const ClosedForm& form, const Method& method, double dt) {
  try {
    return form.measure(method, dt);
  } catch (const NumericalFailure&) {
    return kNaN;
  }
}

Chart chart_of(const ClosedForm& form) {
  constexpr std::array kColours = {"#000000", "#1f4fd8", "#2ca02c"};
  constexpr std::array kPoints = {7, 9, 11};
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

// Error against cost of every method. The summary has a row for each time step.
Section section_of(const ClosedForm& form, const Scene& scene, const std::vector<double>& steps,
                   double engine_rate) {
  const double limit = stability_limit_s(Parameters{}), contact = contact_time(scene);
  Section section{form.title, "accuracy-" + form.name, chart_of(form)};
  const auto begin_row = [&](const std::string& step, const std::string& part) {
    section.summary.push_back({{"", {}, "dt [s]", step}, {"", {}, "dt/limit", part}});
  };
  for (const double dt : steps) begin_row(short_number(dt), fixed(dt / limit, 2));
  begin_row("order", "");
  for (const Method& method : methods()) {
    for (std::size_t s = 0; s < steps.size(); ++s) {
      const double dt = steps[s], error = error_of(form, method, dt);
      section.results.push_back(
          {{"method", method.name},
           {"time_step_s", dt},
           {"time_step_over_contact_time", dt / contact},
           {"time_step_over_stability_limit", dt / limit},
           {"evaluations_per_contact_time", method.evaluations / dt * contact},
           {"seconds_per_cycle", method.evaluations * seconds_per_cycle(600, dt, engine_rate)},
           {form.error, error}});
      section.summary[s].push_back({"", {}, method.name, short_number(error, "stopped")});
    }
    const double order = fitted_order(form, method, 4.4e-5);  // larger steps bend it
    section.summary.back().push_back({"", {}, method.name, fixed(order, 2)});
  }
  return section;
}

// From a quarter of the supplement's smallest time step to the stability limit; the supplement's
// four are included.
std::vector<Section> closed_form_sections(const Options& options, double engine_rate) {
  std::vector<double> steps = {5.5e-6, 1.1e-5, 2.6e-5, 3.5e-5, 2.0 / 45600, 7.0e-5, 1.0e-4, 1.2e-4};
  if (options.quick) steps = {1.1e-5, 2.0 / 45600, 7.0e-5};
  const Scene scene = shear_scene(Parameters{});
  std::vector<Section> sections;
  for (const ClosedForm& form : closed_forms(scene, options.quick)) {
    options.report(form.title);
    sections.push_back(section_of(form, scene, steps, engine_rate));
  }
  return sections;
}

// work(n) for n < count, `jobs` at once. Rethrows an exception of one of them.
template <class Work>
auto in_parallel(std::size_t count, std::size_t jobs, const Work& work) {
  std::vector<decltype(work(count))> results;
  while (results.size() < count) {
    std::vector<std::future<decltype(work(count))>> at_once;
    for (std::size_t n = results.size(); n < std::min(results.size() + jobs, count); ++n) {
      at_once.push_back(std::async(std::launch::async, work, n));
    }
    for (auto& result : at_once) results.push_back(result.get());
  }
  return results;
}

// Means over the ends of the cycles `first` to `last` of a run; NaN if the watchdog stopped it.
PackingNumbers means_of_cycles(const bench::Packing& packing, std::uint64_t steps_per_cycle,
                               std::uint64_t first, std::uint64_t last) {
  Parameters parameters = packing.parameters;
  parameters.steps_per_cycle = steps_per_cycle;
  const Drive tilt = drive(parameters);
  PackingNumbers mean;
  try {
    Simulation simulation(packing.cell, shear_scene(parameters), packing.state);
    simulation.advance(tilt, (first - 1) * steps_per_cycle);
    const auto count = static_cast<double>(last - first + 1);
    for (std::uint64_t cycle = first; cycle <= last; ++cycle) {
      simulation.advance(tilt, steps_per_cycle);
      simulation.check();
      const PackingNumbers now =
          bench::numbers_of(packing.cell, simulation.scene(), 0, simulation.state());
      mean.phi += now.phi / count;
      mean.contacts_per_grain += now.contacts_per_grain / count;
      mean.mean_overlap += now.mean_overlap / count;
    }
  } catch (const NumericalFailure&) {
    mean.phi = mean.contacts_per_grain = mean.mean_overlap = kNaN;
  }
  return mean;
}

Section seeds_section(const Options& options, double engine_rate) {
  options.report("means over seeds at each time step");
  const std::size_t seeds = options.quick ? 2 : 8;
  const std::uint64_t first = options.quick ? 1 : 3, last = options.quick ? 1 : 5;
  // The supplement's four, then up to the stability limit and beyond.
  std::vector<std::uint64_t> steps = {76923, 57143, 45600, 28571, 20000, 17000, 15000};
  if (options.quick) steps = {28571, 20000};
  Parameters p = small_cell(options.quick);
  const auto packings = in_parallel(
      seeds, options.jobs, [&](std::size_t s) { return bench::settled_packing(p, s + 1); });
  const auto means = in_parallel(steps.size() * seeds, options.jobs, [&](std::size_t n) {
    return means_of_cycles(packings[n % seeds], steps[n / seeds], first, last);
  });
  Section section;
  section.title = fmt::format("{} sheared grains, {} seeds, means of cycles {} to {}", p.grains,
                              seeds, first, last);
  section.name = "accuracy-seeds";
  section.chart = {
      .x = {.name = "time step", .unit = Text("2/ω") + subscript("max")},
      .y = {.name = "volume fraction", .symbol = italic("ϕ")},
      .series = {{.title = fmt::format("{} seeds", seeds),
                  .colour = "#000000",
                  .columns = {
                      .x = "time_step_over_stability_limit", .y = "phi", .y_error = "phi_error"}}}};
  for (std::size_t s = 0; s < steps.size(); ++s) {
    const std::span runs = std::span(means).subspan(s * seeds, seeds);
    const RunStatistics phi = bench::over(runs, &PackingNumbers::phi),
                        contacts = bench::over(runs, &PackingNumbers::contacts_per_grain),
                        overlap = bench::over(runs, &PackingNumbers::mean_overlap);
    const auto stopped = static_cast<std::int64_t>(seeds - phi.runs);
    p.steps_per_cycle = steps[s];
    const TimeStep step = shear_time_step(p);
    const double seconds = seconds_per_cycle(p.grains, step.seconds, engine_rate);
    section.results.push_back(
        {{"steps_per_cycle", static_cast<std::int64_t>(steps[s])},
         {"time_step_s", step.seconds, "dt [s]", short_number(step.seconds)},
         {"time_step_over_stability_limit", step.over_stability_limit, "dt/limit",
          fixed(step.over_stability_limit, 2)},
         {"seconds_per_cycle", seconds, "s/cycle", fixed(seconds, 2)},
         {"phi", phi.mean, "phi", with_error(phi, 4)},
         {"phi_error", phi.standard_error},
         {"contacts_per_grain", contacts.mean, "contacts", with_error(contacts, 2)},
         {"contacts_per_grain_error", contacts.standard_error},
         {"mean_overlap_d", overlap.mean, "overlap [d]", with_error(overlap, 6)},
         {"mean_overlap_d_error", overlap.standard_error},
         {"runs", static_cast<std::int64_t>(phi.runs)},
         {"stopped", stopped, "stopped", std::to_string(stopped)}});
  }
  return section;
}

// A settled packing, its stiffness raised to `decades` powers of ten above k_0, in quarters.
std::vector<PackingNumbers> stiffened(const Parameters& p, std::size_t seed,
                                      std::uint64_t decades) {
  const bench::Packing packing = bench::settled_packing(p, seed);
  StiffenParameters parameters;
  parameters.steps = decades * parameters.steps_per_decade + 1;
  const Scene scene = stiffen_scene(p);
  const Stiffen protocol(parameters, scene);
  Simulation simulation(packing.cell, scene, packing.state);
  std::vector<PackingNumbers> all;
  for (std::uint64_t n = 0; n < parameters.steps; ++n) {
    protocol.advance(simulation, 1);
    all.push_back(bench::numbers_of(packing.cell, simulation.scene(), 0, simulation.state()));
  }
  return all;
}

Section stiffness_section(const Options& options, double engine_rate) {
  options.report("finite stiffness");
  const std::size_t seeds = options.quick ? 2 : 4;
  const Parameters p = small_cell(options.quick);
  const auto runs = in_parallel(seeds, options.jobs, [&](std::size_t s) {
    return stiffened(p, s + 1, options.quick ? 1 : 2);
  });
  Section section;
  section.title =
      fmt::format("Finite stiffness: {} settled packings of {} grains", seeds, p.grains);
  section.name = "accuracy-stiffness";
  section.chart = {
      .x = {.name = fmt::format("seconds per cycle of {} sheared grains", p.grains), .log = true},
      .y = {.name = "bias of the volume fraction"},
      .series =
          {{.title = italic("ϕ") + subscript("u"),
            .colour = "#000000",
            .point = 6,
            .columns = {.x = "seconds_per_cycle",
                        .y = "phi_uncorrected_bias",
                        .y_error = "phi_uncorrected_bias_error"}},
           {.title = italic("ϕ") + Text(" (S4)"),
            .colour = "#d62728",
            .columns = {.x = "seconds_per_cycle", .y = "phi_bias", .y_error = "phi_bias_error"}}},
      .lines = {{.at = 0}}};
  for (std::size_t n = 0; n < runs.front().size(); ++n) {
    // At the same part of a contact time, a cycle takes sqrt(k) as many steps.
    const double factor = raised_stiffness(1, n, StiffenParameters{}.steps_per_decade);
    const double seconds =
        seconds_per_cycle(p.grains, shear_time_step_s(p), engine_rate) * std::sqrt(factor);
    std::vector<PackingNumbers> here;
    std::vector<double> biases, biases_u;
    for (const std::vector<PackingNumbers>& run : runs) {
      here.push_back(run[n]);
      biases.push_back(run[n].phi - run.back().phi);
      biases_u.push_back(run[n].phi_uncorrected - run.back().phi);
    }
    const RunStatistics phi = bench::over(here, &PackingNumbers::phi),
                        phi_u = bench::over(here, &PackingNumbers::phi_uncorrected),
                        overlap = bench::over(here, &PackingNumbers::mean_overlap),
                        bias = over_runs(biases), bias_u = over_runs(biases_u);
    section.results.push_back(
        {{"stiffness_factor", factor, "k/k_0", short_number(factor)},
         {"seconds_per_cycle", seconds, "s/cycle", fixed(seconds, 2)},
         {"mean_overlap_d", overlap.mean, "overlap [d]", short_number(overlap.mean.value_or(kNaN))},
         {"phi", phi.mean, "phi (S4)", fixed(phi.mean, 5)},
         {"phi_bias", bias.mean, "phi - hardest", with_error(bias, 5)},
         {"phi_bias_error", bias.standard_error},
         {"phi_uncorrected", phi_u.mean, "phi_u", fixed(phi_u.mean, 5)},
         {"phi_uncorrected_bias", bias_u.mean, "phi_u - hardest phi", with_error(bias_u, 5)},
         {"phi_uncorrected_bias_error", bias_u.standard_error},
         {"runs", static_cast<std::int64_t>(phi.runs)}});
  }
  return section;
}

}  // namespace

std::vector<Section> measure_accuracy(const Options& options) {
  options.report("the engine's rate");
  const double rate = bench::measure_speed({.sizes = {small_cell(options.quick).grains},
                                            .threads = {1},
                                            .repeats = options.quick ? 1U : 9U,
                                            .seconds_per_repeat = options.quick ? 0.05 : 0.3,
                                            .report = {}})
                          .front()
                          .median_rate;
  std::vector<Section> sections = closed_form_sections(options, rate);
  sections.push_back(seeds_section(options, rate));
  sections.push_back(stiffness_section(options, rate));
  return sections;
}

}  // namespace shearcell::accuracy
