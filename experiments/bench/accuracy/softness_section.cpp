// SPDX-License-Identifier: GPL-3.0-or-later
// The bias of finite stiffness, and what less of it costs.
#include <fmt/format.h>

#include <cmath>

#include "experiments/manifest/conversion.hpp"
#include "experiments/bench/accuracy/packings.hpp"

namespace shearcell::accuracy {
namespace {

// At the same part of a contact time, a cycle takes sqrt(k) as many steps.
void add_stiffness(const Parameters& p, const std::vector<std::vector<Softness>>& runs,
                   std::size_t n, double engine_rate, Section& section) {
  std::vector<double> phi, phi_u, overlap, bias, bias_u;
  for (const std::vector<Softness>& run : runs) {
    phi.push_back(run[n].phi);
    phi_u.push_back(run[n].phi_uncorrected);
    overlap.push_back(run[n].overlap);
    bias.push_back(run[n].phi - run.back().phi);
    bias_u.push_back(run[n].phi_uncorrected - run.back().phi);
  }
  const double factor = runs.front()[n].stiffness_factor;
  const double seconds =
      seconds_per_cycle(p, shear_time_step_s(p), engine_rate) * std::sqrt(factor);
  const RunStatistics f = over_runs(phi), u = over_runs(phi_u), o = over_runs(overlap),
                      b = over_runs(bias), c = over_runs(bias_u);
  section.table.rows.push_back({factor, seconds, table_value(o.mean), table_value(f.mean),
                                table_value(b.mean), table_value(b.standard_error),
                                table_value(u.mean), table_value(c.mean),
                                table_value(c.standard_error), static_cast<std::int64_t>(f.runs)});
  section.summary.push_back({short_number(factor), fmt::format("{:.2f}", seconds),
                             short_number(o.mean.value_or(std::nan(""))),
                             fmt::format("{:.5f}", f.mean.value_or(std::nan(""))),
                             fmt::format("{:.5f}", u.mean.value_or(std::nan(""))), with_error(b, 5),
                             with_error(c, 5)});
}

}  // namespace

Section softness_section(const Options& options, double engine_rate) {
  if (options.report) options.report("finite stiffness");
  const std::size_t seeds = options.quick ? 2 : 4;
  const std::vector<Packing> all = packings(options, seeds);
  std::vector<std::vector<Softness>> runs(seeds);
  in_parallel(seeds, options.jobs,
              [&](std::size_t s) { runs[s] = stiffened(all[s], options.quick ? 1 : 2); });
  const Parameters& p = all.front().parameters;
  Section section{
      fmt::format("Finite stiffness: {} settled packings of {} grains", seeds, p.grains),
      {},
      {"k/k_0", "s/cycle", "overlap [d]", "phi (S4)", "phi_u", "phi - hardest",
       "phi_u - hardest phi"},
      {},
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
  for (std::size_t n = 0; n < runs.front().size(); ++n) {
    add_stiffness(p, runs, n, engine_rate, section);
  }
  section.table.plot = fmt::format(
      "set logscale x\nset xlabel 'seconds per cycle of {} sheared grains'\n"
      "set ylabel 'bias of the volume fraction'\n"
      "plot data using 2:8:9 with yerrorbars pt 6 lc rgb '#000000' title '{{/:Italic ϕ}}_u', \\\n"
      "     data using 2:5:6 with yerrorbars pt 7 lc rgb '#d62728' title '{{/:Italic ϕ}} (S4)', "
      "\\\n     0 lc rgb '#888888' notitle\n",
      p.grains);
  return section;
}

}  // namespace shearcell::accuracy
