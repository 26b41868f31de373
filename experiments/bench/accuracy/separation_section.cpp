// SPDX-License-Identifier: GPL-3.0-or-later
// How soon runs of different time steps part.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/bench/accuracy/fit.hpp"
#include "experiments/bench/accuracy/packings.hpp"

namespace shearcell::accuracy {
namespace {

// The distance at the look nearest to a time; looks are whole numbers of steps, so those of two
// runs differ a little.
double distance_at(const Separation& run, double time) {
  const auto near =
      std::ranges::min_element(run.time, {}, [&](double t) { return std::fabs(t - time); });
  return run.distance[static_cast<std::size_t>(near - run.time.begin())];
}

double order_at(const Chaos& chaos, double time) {
  std::vector<double> step, distance;
  for (const Separation& run : chaos.runs) {
    step.push_back(run.time_step);
    distance.push_back(distance_at(run, time));
  }
  return fitted_order(step, distance);
}

void add_run(const std::string& name, const Separation& run, Section& section) {
  for (std::size_t n = 0; n < run.time.size(); ++n) {
    section.table.rows.push_back({name, run.time_step, run.time[n], run.distance[n]});
  }
  section.summary.push_back({name});
  for (const double time : {0.01, 0.02, 0.04, 0.08}) {
    section.summary.back().push_back(short_number(distance_at(run, time)));
  }
  section.summary.back().push_back(short_number(run.distance.back()));
}

std::string plot_of(const Section& section) {
  std::string plot =
      "set logscale y\nset format y '10^{%T}'\nset xlabel 'time  [s]'\n"
      "set ylabel 'distance  [{/:Italic d}]'\nplot ";
  for (std::size_t n = 0; n < section.summary.size(); ++n) {
    const std::string& name = section.summary[n][0];
    const bool moved = n + 1 == section.summary.size();
    plot += fmt::format(
        "{}data using (strcol(1) eq '{}' ? $3 : NaN):4 with lines lw 1.5 lc {} title '{}{}'",
        n == 0 ? "" : ", \\\n     ", name, moved ? "rgb '#000000'" : std::to_string(n + 1), name,
        moved ? "" : " s");
  }
  return plot + "\n";
}

}  // namespace

Section separation_section(const Options& options) {
  if (options.report) options.report("runs part from a reference at 1/32 of the time step");
  const Packing packing = settled(small_cell(options.quick), 1);
  // Whole numbers of the reference's steps nearest to the supplement's four time steps, and beyond.
  std::vector<std::uint64_t> steps = {182400, 76800, 58368, 45600, 29184, 19200};
  if (options.quick) steps = {182400, 45600};
  const Chaos chaos = separate(packing, steps, options.quick ? 0.08 : 0.4, options.quick ? 16 : 80);
  Section section{fmt::format("{} sheared grains: distance from a run at 1/32 of Table I's step",
                              packing.parameters.grains),
                  {},
                  {"dt [s]", "after 10 ms [d]", "20 ms", "40 ms", "80 ms", "end"},
                  {},
                  {}};
  section.table.name = "accuracy-separation";
  section.table.columns = {"run", "time_step_s", "time_s", "distance_d"};
  for (const Separation& run : chaos.runs) {
    add_run(fmt::format("{:.3g}", run.time_step), run, section);
  }
  add_run("moved by 1e-13 d", chaos.perturbed, section);
  section.table.plot = plot_of(section);
  section.findings = {
      fmt::format("Order after 10 ms: {:.2f}.", order_at(chaos, 0.01)),
      fmt::format("Lyapunov time {:.3g} ms: a difference grows a billionfold within {:.0f} ms, "
                  "whatever the integrator. What can be right is the statistics.",
                  1e3 * chaos.lyapunov_time, 1e3 * chaos.lyapunov_time * std::log(1e9))};
  return section;
}

}  // namespace shearcell::accuracy
