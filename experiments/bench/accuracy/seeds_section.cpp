// SPDX-License-Identifier: GPL-3.0-or-later
// Means over seeds at each time step.
#include <fmt/format.h>

#include <span>

#include "experiments/manifest/numerics.hpp"
#include "experiments/bench/accuracy/packings.hpp"

namespace shearcell::accuracy {
namespace {

void add_step(const Parameters& p, std::uint64_t steps, std::span<const RunMeans> runs,
              double engine_rate, Section& section) {
  std::vector<double> phi, contacts, overlap, thousandths;
  std::int64_t stopped = 0;
  for (const RunMeans& m : runs) {
    phi.push_back(m.phi);
    contacts.push_back(m.contacts);
    overlap.push_back(m.overlap);
    thousandths.push_back(1e3 * m.overlap);
    stopped += m.failure.empty() ? 0 : 1;
  }
  const RunStatistics f = over_runs(phi), z = over_runs(contacts), o = over_runs(overlap);
  Parameters here = p;
  here.steps_per_cycle = steps;
  const TimeStep step = shear_time_step(here);
  const double seconds = seconds_per_cycle(p, step.seconds, engine_rate);
  section.table.rows.push_back(
      {static_cast<std::int64_t>(steps), step.seconds, step.over_stability_limit, seconds,
       table_value(f.mean), table_value(f.standard_error), table_value(z.mean),
       table_value(z.standard_error), table_value(o.mean), table_value(o.standard_error),
       static_cast<std::int64_t>(f.runs), stopped});
  section.summary.push_back({short_number(step.seconds),
                             fmt::format("{:.2f}", step.over_stability_limit),
                             fmt::format("{:.2f}", seconds), with_error(f, 4), with_error(z, 2),
                             with_error(over_runs(thousandths), 3), std::to_string(stopped)});
}

}  // namespace

Section seeds_section(const Options& options, double engine_rate) {
  if (options.report) options.report("means over seeds at each time step");
  const std::size_t seeds = options.quick ? 2 : 8;
  const std::uint64_t cycles = options.quick ? 1 : 5, first = options.quick ? 1 : 3;
  // The supplement's four, then up to the limit and over it.
  std::vector<std::uint64_t> steps = {76923, 57143, 45600, 28571, 20000, 17000, 15000};
  if (options.quick) steps = {28571, 20000};
  const std::vector<Packing> all = packings(options, seeds);
  std::vector<RunMeans> means(steps.size() * seeds);
  in_parallel(means.size(), options.jobs, [&](std::size_t n) {
    means[n] = sheared_means(all[n % seeds], steps[n / seeds], cycles, first);
  });
  const Parameters& p = all.front().parameters;
  Section section{
      fmt::format("{} sheared grains, {} seeds, means of cycles {} to {}", p.grains, seeds, first,
                  cycles),
      {},
      {"dt [s]", "dt/limit", "s/cycle", "phi", "contacts", "overlap [1e-3 d]", "stopped"},
      {},
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
  for (std::size_t s = 0; s < steps.size(); ++s) {
    add_step(p, steps[s], std::span(means).subspan(s * seeds, seeds), engine_rate, section);
  }
  section.table.plot = fmt::format(
      "set xlabel 'time step over 2/ω_{{max}}'\n"
      "set ylabel 'volume fraction  {{/:Italic ϕ}}'\n"
      "plot data using 3:5:6 with yerrorbars pt 7 lc rgb '#000000' title '{} seeds'\n",
      seeds);
  return section;
}

}  // namespace shearcell::accuracy
