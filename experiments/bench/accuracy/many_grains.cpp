// SPDX-License-Identifier: GPL-3.0-or-later
// Errors of packings: means over seeds at each time step, and the bias of finite stiffness.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <future>
#include <span>

#include "analysis/statistics.hpp"
#include "core/watchdog.hpp"
#include "experiments/bench/accuracy/accuracy.hpp"
#include "experiments/bench/packing.hpp"
#include "experiments/bench/speed.hpp"
#include "experiments/manifest/conversion.hpp"
#include "protocols/stiffen.hpp"

namespace shearcell::accuracy {
namespace {

using bench::Packing;
using bench::PackingNumbers;

Parameters small_cell(bool quick) {
  Parameters parameters;
  parameters.grains = quick ? 300 : 600;
  return parameters;
}

// work(n) for n < count, `jobs` at once. Rethrows an exception of one of them.
void in_parallel(std::size_t count, std::size_t jobs,
                 const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::vector<std::future<void>> workers(std::min(jobs, count));
  for (std::future<void>& worker : workers) {
    worker = std::async(std::launch::async, [&] {
      for (std::size_t n = next++; n < count; n = next++) work(n);
    });
  }
  for (std::future<void>& worker : workers) worker.get();
}

std::vector<Packing> packings(const Options& options, std::size_t seeds) {
  std::vector<Packing> all(seeds);
  in_parallel(seeds, options.jobs, [&](std::size_t s) {
    all[s] = bench::settled_packing(small_cell(options.quick), s + 1);
  });
  return all;
}

double seconds_per_cycle(const Parameters& p, double time_step, double engine_rate) {
  return p.period_s / time_step * static_cast<double>(p.grains) / (1e6 * engine_rate);
}

RunStatistics over(std::span<const PackingNumbers> runs, double PackingNumbers::*number) {
  std::vector<double> values;
  for (const PackingNumbers& run : runs) values.push_back(run.*number);
  return over_runs(values);
}

std::string with_error(const RunStatistics& of, int digits) {
  return fmt::format("{:.{}f} +- {:.{}f}", of.mean.value_or(std::nan("")), digits,
                     of.standard_error.value_or(std::nan("")), digits);
}

// Means over the ends of the cycles `first` to `last` of a run; NaN if the watchdog stopped it.
PackingNumbers means_of_cycles(const Packing& packing, std::uint64_t steps_per_cycle,
                               std::uint64_t first, std::uint64_t last) {
  Parameters parameters = packing.parameters;
  parameters.steps_per_cycle = steps_per_cycle;
  const Drive tilt = drive(parameters);
  Simulation simulation = bench::sheared(packing, steps_per_cycle);
  PackingNumbers mean;
  try {
    simulation.advance(tilt, (first - 1) * steps_per_cycle);
    const auto count = static_cast<double>(last - first + 1);
    for (std::uint64_t cycle = first; cycle <= last; ++cycle) {
      simulation.advance(tilt, steps_per_cycle);
      simulation.check();
      const PackingNumbers now =
          bench::numbers_of(packing.cell, simulation.scene(), 0, simulation.state());
      mean.phi += now.phi / count;
      mean.contacts += now.contacts / count;
      mean.overlap += now.overlap / count;
    }
  } catch (const NumericalFailure&) {
    mean.phi = mean.contacts = mean.overlap = std::nan("");
  }
  return mean;
}

// The packing at rest, its stiffness raised to `decades` powers of ten above k_0, in quarters.
std::vector<PackingNumbers> stiffened(const Packing& packing, std::uint64_t decades) {
  StiffenParameters parameters;
  parameters.steps = decades * parameters.steps_per_decade + 1;
  const Scene scene = stiffen_scene(packing.parameters);
  const Stiffen protocol(parameters, scene);
  Simulation simulation(packing.cell, scene, packing.state);
  std::vector<PackingNumbers> all;
  for (std::uint64_t n = 0; n < parameters.steps; ++n) {
    protocol.advance(simulation, 1);
    all.push_back(bench::numbers_of(packing.cell, simulation.scene(), 0, simulation.state()));
  }
  return all;
}

}  // namespace

std::string short_number(double value, const std::string& otherwise) {
  return std::isfinite(value) ? fmt::format("{:.3g}", value) : otherwise;
}

Section seeds_section(const Options& options, double engine_rate) {
  if (options.report) options.report("means over seeds at each time step");
  const std::size_t seeds = options.quick ? 2 : 8;
  const std::uint64_t first = options.quick ? 1 : 3, last = options.quick ? 1 : 5;
  // The supplement's four, then up to the stability limit and beyond.
  std::vector<std::uint64_t> steps = {76923, 57143, 45600, 28571, 20000, 17000, 15000};
  if (options.quick) steps = {28571, 20000};
  const std::vector<Packing> all = packings(options, seeds);
  std::vector<PackingNumbers> means(steps.size() * seeds);
  in_parallel(means.size(), options.jobs, [&](std::size_t n) {
    means[n] = means_of_cycles(all[n % seeds], steps[n / seeds], first, last);
  });
  Parameters p = all.front().parameters;
  Section section{fmt::format("{} sheared grains, {} seeds, means of cycles {} to {}", p.grains,
                              seeds, first, last),
                  {},
                  {"dt [s]", "dt/limit", "s/cycle", "phi", "contacts", "overlap [d]", "stopped"},
                  {}};
  section.table.name = "accuracy-seeds";
  section.table.columns = {"steps_per_cycle",
                           "time_step_s",
                           "time_step_over_stability_limit",
                           "seconds_per_cycle",
                           "phi",
                           "phi_error",
                           "contacts_per_grain",
                           "contacts_per_grain_error",
                           "mean_overlap_d",
                           "mean_overlap_d_error",
                           "runs",
                           "stopped"};
  section.table.chart = {
      .x = {.name = "time step", .unit = Text("2/ω") + subscript("max")},
      .y = {.name = "volume fraction", .symbol = italic("ϕ")},
      .series = {{.title = fmt::format("{} seeds", seeds),
                  .colour = "#000000",
                  .columns = {
                      .x = "time_step_over_stability_limit", .y = "phi", .y_error = "phi_error"}}}};
  for (std::size_t s = 0; s < steps.size(); ++s) {
    const std::span runs = std::span(means).subspan(s * seeds, seeds);
    const RunStatistics phi = over(runs, &PackingNumbers::phi),
                        contacts = over(runs, &PackingNumbers::contacts),
                        overlap = over(runs, &PackingNumbers::overlap);
    const auto stopped = static_cast<std::int64_t>(seeds - phi.runs);
    p.steps_per_cycle = steps[s];
    const TimeStep step = shear_time_step(p);
    const double seconds = seconds_per_cycle(p, step.seconds, engine_rate);
    section.table.rows.push_back(
        {static_cast<std::int64_t>(steps[s]), step.seconds, step.over_stability_limit, seconds,
         table_value(phi.mean), table_value(phi.standard_error), table_value(contacts.mean),
         table_value(contacts.standard_error), table_value(overlap.mean),
         table_value(overlap.standard_error), static_cast<std::int64_t>(phi.runs), stopped});
    section.summary.push_back(
        {short_number(step.seconds), fmt::format("{:.2f}", step.over_stability_limit),
         fmt::format("{:.2f}", seconds), with_error(phi, 4), with_error(contacts, 2),
         with_error(overlap, 6), std::to_string(stopped)});
  }
  return section;
}

Section stiffness_section(const Options& options, double engine_rate) {
  if (options.report) options.report("finite stiffness");
  const std::size_t seeds = options.quick ? 2 : 4;
  const std::vector<Packing> all = packings(options, seeds);
  std::vector<std::vector<PackingNumbers>> runs(seeds);
  in_parallel(seeds, options.jobs,
              [&](std::size_t s) { runs[s] = stiffened(all[s], options.quick ? 1 : 2); });
  const Parameters& p = all.front().parameters;
  Section section{
      fmt::format("Finite stiffness: {} settled packings of {} grains", seeds, p.grains),
      {},
      {"k/k_0", "s/cycle", "overlap [d]", "phi (S4)", "phi_u", "phi - hardest",
       "phi_u - hardest phi"},
      {}};
  section.table.name = "accuracy-stiffness";
  section.table.columns = {"stiffness_factor",
                           "seconds_per_cycle",
                           "mean_overlap_d",
                           "phi",
                           "phi_bias",
                           "phi_bias_error",
                           "phi_uncorrected",
                           "phi_uncorrected_bias",
                           "phi_uncorrected_bias_error",
                           "runs"};
  section.table.chart = {
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
        seconds_per_cycle(p, shear_time_step_s(p), engine_rate) * std::sqrt(factor);
    std::vector<PackingNumbers> here;
    std::vector<double> bias, bias_u;
    for (const std::vector<PackingNumbers>& run : runs) {
      here.push_back(run[n]);
      bias.push_back(run[n].phi - run.back().phi);
      bias_u.push_back(run[n].phi_uncorrected - run.back().phi);
    }
    const RunStatistics phi = over(here, &PackingNumbers::phi),
                        phi_u = over(here, &PackingNumbers::phi_uncorrected),
                        overlap = over(here, &PackingNumbers::overlap), b = over_runs(bias),
                        b_u = over_runs(bias_u);
    section.table.rows.push_back(
        {factor, seconds, table_value(overlap.mean), table_value(phi.mean), table_value(b.mean),
         table_value(b.standard_error), table_value(phi_u.mean), table_value(b_u.mean),
         table_value(b_u.standard_error), static_cast<std::int64_t>(phi.runs)});
    section.summary.push_back({short_number(factor), fmt::format("{:.2f}", seconds),
                               short_number(overlap.mean.value_or(std::nan(""))),
                               fmt::format("{:.5f}", phi.mean.value_or(std::nan(""))),
                               fmt::format("{:.5f}", phi_u.mean.value_or(std::nan(""))),
                               with_error(b, 5), with_error(b_u, 5)});
  }
  return section;
}

std::vector<Section> measure_accuracy(const Options& options) {
  if (options.report) options.report("the engine's rate");
  const double rate = measure_speed({.sizes = {small_cell(options.quick).grains},
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
