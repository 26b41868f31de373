// SPDX-License-Identifier: GPL-3.0-or-later
// Error against time step and cost of the engine, PEFRL, Runge-Kutta and LAMMPS, for the grains of
// Table I: bench_accuracy FOLDER writes the CSV files and figures of core/ACCURACY.md into FOLDER.
// accuracy.sh runs it and writes the tables. Only the costs depend on the machine.
#include <fmt/format.h>
#include <sys/resource.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "analysis/plot.hpp"
#include "analysis/statistics.hpp"
#include "experiments/manifest/conversion.hpp"
#include "provenance/io/file.hpp"
#include "tests/bench/closed_forms.hpp"
#include "tests/support/run_lammps.hpp"

namespace shearcell::test {
namespace {

constexpr std::uint64_t kGrains = 600;

// Core-seconds of a cycle of 600 sheared grains for each evaluation of the forces in a time step of
// `dt`, at `rate` million particle-steps/s.
double seconds_per_cycle(double dt, double rate) {
  return Parameters{}.period_s / dt * kGrains / (1e6 * rate);
}

// Processor time [s] of this process, or of the children that have ended.
double processor_seconds(int of) {
  rusage used;
  getrusage(of, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

// Million particle-steps per second of processor time, in the sheared cell from a pressed packing.
// Of LAMMPS with one process: 10,000 steps less what a start with 100 steps takes.
struct Rates {
  double ours, lammps;
};
Rates measure_rates() {
  const Packing packing = bench::pressed_packing({.grains = kGrains}, 1);
  const Drive tilt = drive(packing.parameters);
  Simulation simulation(packing.cell, packing.scene, packing.state);
  simulation.advance(tilt, 2000);
  constexpr std::uint64_t kOurs = 100'000, kTheirs = 10'000;
  const double before = processor_seconds(RUSAGE_SELF);
  simulation.advance(tilt, kOurs);
  const double ours = processor_seconds(RUSAGE_SELF) - before;
  const auto lammps_seconds = [&](std::uint64_t steps) {
    const double earlier = processor_seconds(RUSAGE_CHILDREN);
    run_lammps(find_lammps(),
               {.cell = packing.cell,
                .scene = packing.scene,
                .drive = tilt,
                .state = packing.state,
                .end = steps,
                .stride = steps,
                .check_every = lammps_check_steps(kGrains, 1)},
               1);
    return processor_seconds(RUSAGE_CHILDREN) - earlier;
  };
  const double start = lammps_seconds(100), theirs = lammps_seconds(100 + kTheirs) - start;
  return {1e-6 * kGrains * kOurs / ours, 1e-6 * kGrains * kTheirs / theirs};
}

// One closed form by one method, over time steps from twice Table I's down. The order is fitted
// from Table I's time step on. Errors below 1e-9 are partly rounding, and have no order.
void add_curve(const ClosedForm& form, const Method& method, double rate,
               std::vector<TableRow>& rows) {
  const Scene scene = shear_scene(Parameters{});
  std::vector<double> steps, errors;
  for (int n = -2; n <= 8; ++n) {
    steps.push_back(scene.time_step * std::exp2(-0.5 * n));
    errors.push_back(form.error(method, steps.back()));
  }
  std::size_t end = steps.size();
  while (errors[end - 1] < 1e-9) --end;
  const double order =
      order_of(std::span(steps).subspan(2, end - 2), std::span(errors).subspan(2, end - 2));
  for (std::size_t s = 0; s < steps.size(); ++s) {
    std::optional<double> local;  // slope between this time step and the next smaller one
    if (s + 1 < end) {
      local = std::log(errors[s] / errors[s + 1]) / std::log(steps[s] / steps[s + 1]);
    }
    const double cost = method.evaluations * seconds_per_cycle(steps[s], rate);
    rows.push_back({form.name, method.name, form.name + ", " + method.name, steps[s],
                    steps[s] / contact_time(scene), steps[s] / stability_limit_s(Parameters{}),
                    cost, errors[s], local, order});
  }
}

struct Style {
  const char *name, *colour;
  int point;
};
constexpr Style kStyles[] = {
    {"engine", "#000000", 7}, {"PEFRL", "#1f4fd8", 9}, {"Runge-Kutta", "#2ca02c", 11}};

// x and error of the rows of a curve or method.
std::vector<ChartPoint> points_in(const Table& table, const std::string& of, const std::string& x) {
  std::vector<ChartPoint> points;
  for (const TableRow& row : table.rows) {
    if (row[1] != TableCell(of) && row[2] != TableCell(of)) continue;
    points.push_back({std::get<double>(row[table.place(x)]),
                      std::get<double>(row[table.place("relative_error")])});
  }
  return points;
}

Table error_table(double ours, double lammps) {
  Table table{.name = "accuracy-order",
              .columns = {"motion", "method", "curve", "time_step_s", "time_step_over_contact_time",
                          "time_step_over_stability_limit", "core_seconds_per_cycle",
                          "relative_error", "local_order", "fitted_order"}};
  for (const ClosedForm& form : closed_forms(shear_scene(Parameters{}), 256)) {
    fmt::print(stderr, "{}\n", form.title);
    for (const Method& method : methods()) add_curve(form, method, ours, table.rows);
  }
  // LAMMPS makes the engine's steps up to rounding (tests/engines), at another cost.
  const std::vector<TableRow> rows = table.rows;
  for (TableRow row : rows) {
    if (row[1] != TableCell("engine")) continue;
    row[1] = "LAMMPS";
    row[2] = std::get<std::string>(row[0]) + ", LAMMPS";
    row[6] = std::get<double>(row[6]) * ours / lammps;
    table.rows.push_back(row);
  }
  table.chart = {.x = {.name = "time step", .unit = formula("2/ω$_{max}$"), .log = true},
                 .y = {.name = "relative error", .log = true}};
  for (const Style& style : kStyles) {
    for (const auto& [motion, title, hollow, join] :
         {std::tuple{"collision", "collision", 0, Join::line},
          std::tuple{"wall", "wall", 1, Join::dashes}}) {
      table.chart.series.push_back(
          {.title = fmt::format("{}, {}", title, style.name),
           .colour = style.colour,
           .point = style.point - hollow,
           .join = join,
           .points = points_in(table, fmt::format("{}, {}", motion, style.name),
                               "time_step_over_stability_limit")});
    }
  }
  const double largest = std::get<double>(table.rows[2][5]);
  for (const double end : {largest / 16, largest}) {
    table.chart.lines.push_back({.at = end, .vertical = true, .title = "range of the fits"});
  }
  return table;
}

Table cost_table(const Table& errors) {
  Table table{.name = "accuracy-cost", .columns = errors.columns};
  for (const TableRow& row : errors.rows) {
    if (row[0] == TableCell("collision")) table.rows.push_back(row);
  }
  table.chart = {.x = {.name = "core-seconds per cycle of 600 sheared grains", .log = true},
                 .y = {.name = "relative error of the speed after a collision", .log = true}};
  const auto add = [&](const Style& style) {
    table.chart.series.push_back(
        {.title = style.name,
         .colour = style.colour,
         .point = style.point,
         .join = Join::line,
         .points = points_in(table, style.name, "core_seconds_per_cycle")});
  };
  for (const Style& style : kStyles) add(style);
  add({"LAMMPS", "#d62728", 5});
  return table;
}

// An observable: the mean energy after collisions, in which gains and losses cancel.
Table energy_table() {
  fmt::print(stderr, "mean energy after collisions\n");
  const Scene scene = shear_scene(Parameters{});
  const double drag = 1 - std::exp(-scene.drag_rate * contact_time(scene));
  Table table{
      .name = "accuracy-energy",
      .columns = {"method", "time_step_s", "time_step_over_stability_limit", "speed_error",
                  "mean_energy_change", "local_order", "energy_lost_by_drag_in_a_collision"}};
  for (const Method& method : methods()) {
    const auto at = [&](double dt) { return collide(scene, method, dt, 4096); };
    for (int n = -2; n <= 2; ++n) {
      const double dt = scene.time_step * std::exp2(-0.5 * n);
      const Collision here = at(dt), finer = at(dt / std::sqrt(2.0));
      const double local = 2 * std::log2(std::fabs(here.energy_change / finer.energy_change));
      table.rows.push_back({method.name, dt, dt / stability_limit_s(Parameters{}), here.speed_error,
                            here.energy_change, local, drag});
    }
  }
  return table;
}

// Two runs of a settled packing of 600 grains under shear that differ by 1e-13 d in one coordinate:
// the time in which their distance grows by a factor of e, between 1e-11 and 1e-5 d.
Table divergence_table() {
  fmt::print(stderr, "divergence of two runs\n");
  Table table{.name = "accuracy-divergence",
              .columns = {"steps_per_cycle", "time_step_s", "time_step_over_stability_limit",
                          "lyapunov_time_s", "standard_error_s", "runs"}};
  constexpr std::uint64_t kSeeds = 4;
  std::vector<Packing> packings;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    packings.push_back(settled_packing({.grains = kGrains}, seed));
  }
  for (const std::uint64_t steps : {76923U, 45600U, 28571U}) {
    std::vector<double> times;
    for (const Packing& packing : packings) {
      Parameters parameters = packing.parameters;
      parameters.steps_per_cycle = steps;
      const Scene scene = shear_scene(parameters);
      const Drive tilt = drive(parameters);
      Simulation one(packing.cell, scene, packing.state);
      one.advance(tilt, steps / 8);
      State moved = one.state();
      moved.position(0, 0) += 1e-13;
      Simulation other(packing.cell, scene, moved);
      const std::uint64_t begin = one.step();
      double from = 0, first = 0;
      for (;;) {
        one.advance(tilt, 20);
        other.advance(tilt, 20);
        const double apart = farthest(one.state(), other.state());
        const double time = static_cast<double>(one.step() - begin) * scene.time_step;
        if (apart < 1e-11) continue;
        if (from == 0) from = time, first = apart;
        if (apart < 1e-5) continue;
        times.push_back((time - from) / std::log(apart / first));
        break;
      }
    }
    const RunStatistics mean = over_runs(times);
    const double dt = Parameters{}.period_s / static_cast<double>(steps);
    table.rows.push_back({static_cast<std::int64_t>(steps), dt,
                          dt / stability_limit_s(Parameters{}), mean.mean, mean.standard_error,
                          mean.runs});
  }
  return table;
}

void measure(const std::filesystem::path& folder) {
  fmt::print(stderr, "speed of the engine and of LAMMPS\n");
  const auto [ours, lammps] = measure_rates();
  const Table errors = error_table(ours, lammps);
  for (const Table& table : {errors, cost_table(errors), energy_table(), divergence_table()}) {
    write_output(folder / (table.name + ".csv"), to_csv(table));
    if (!table.chart.series.empty()) draw_svg(table, folder);
  }
}

}  // namespace
}  // namespace shearcell::test

int main(int argc, char** argv) {
  try {
    if (argc != 2) throw std::runtime_error("usage: bench_accuracy FOLDER");
    shearcell::test::measure(argv[1]);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_accuracy: {}\n", error.what());
    return 1;
  }
}
