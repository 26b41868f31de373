// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/engines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/estimate.hpp"
#include "core/drive.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/runner/lammps/lammps_run.hpp"
#include "provenance/io/clock.hpp"

namespace shearcell::bench {
namespace {

constexpr const char* kOurs = "shearcell";

Settling facts_of(const Packing& loose, State state, double seconds, double stepping,
                  double bytes) {
  const auto work = static_cast<double>(state.step) * static_cast<double>(state.position.cols());
  const PackingNumbers numbers = numbers_of(loose.cell, loose.scene, 0, state);
  return {"", 0, std::move(state), seconds, 1e-6 * work / stepping, bytes, numbers};
}

LammpsTask task_of(const Packing& packing, std::uint64_t steps) {
  LammpsTask task;
  task.cell = packing.cell;
  task.scene = shear_scene(packing.parameters);
  task.drive = drive(packing.parameters);
  task.state = packing.state;
  task.end = task.stride = packing.state.step + steps;
  task.look = lammps_look_steps(packing.parameters.grains, 1);
  return task;
}

State by_us(const LammpsTask& task) {
  Simulation simulation(task.cell, task.scene, task.state);
  simulation.advance(task.drive, task.end - task.state.step);
  return simulation.state();
}

double farthest(const State& a, const State& b) {
  return (a.position - b.position).colwise().norm().maxCoeff();
}

// Moves the first grain by one unit in the last place.
double effect_of_rounding(const LammpsTask& task, const State& ours) {
  LammpsTask moved = task;
  double& x = moved.state.position(0, 0);
  x = std::nextafter(x, 1e9);
  return farthest(by_us(moved), ours);
}

TrajectoryCheck compare(const LammpsProgram& program, const std::string& scene,
                        const LammpsTask& task) {
  const State ours = by_us(task), theirs = run_lammps(program, task, 1).state;
  return {scene, task.end - task.state.step, farthest(ours, theirs),
          std::fabs(ours.wall_height - theirs.wall_height), effect_of_rounding(task, ours)};
}

void check_trajectories(const LammpsProgram& program, const Packing& packing, std::uint64_t steps,
                        EngineCheck& check) {
  LammpsTask task = task_of(packing, steps);
  check.trajectories.push_back(compare(program, "drag, still fluid", task));
  task.scene.fluid = Fluid::cell;
  check.trajectories.push_back(compare(program, "drag, moving fluid", task));
  task.scene.drag_rate = 0;
  check.trajectories.push_back(compare(program, "no drag", task));
}

PackingNumbers sheared_numbers(const LammpsTask& task, const State& state) {
  return numbers_of(task.cell, task.scene, tilt(task.drive, state.step).theta, state);
}

EngineMean mean_of(const std::string& name,
                   const std::vector<std::vector<PackingNumbers>>& of_engine,
                   double PackingNumbers::*member) {
  EngineMean mean{name, {}, {}};
  for (const std::vector<PackingNumbers>& packings : of_engine) {
    std::vector<double> values;
    for (const PackingNumbers& numbers : packings) values.push_back(numbers.*member);
    mean.of.push_back(over_runs(values));
    const RunStatistics &a = mean.of.front(), &b = mean.of.back();
    const double error = std::hypot(a.standard_error.value_or(0), b.standard_error.value_or(0));
    mean.apart.push_back(error > 0 ? std::fabs(*b.mean - *a.mean) / error : 0);
  }
  return mean;
}

EngineMeans compare_means(std::vector<std::string> engines,
                          const std::vector<std::vector<PackingNumbers>>& of_engine) {
  using N = PackingNumbers;
  EngineMeans result{
      std::move(engines),
      {mean_of("phi", of_engine, &N::phi), mean_of("contacts per grain", of_engine, &N::contacts),
       mean_of("mean overlap [d]", of_engine, &N::overlap),
       mean_of("force imbalance of the wall", of_engine, &N::imbalance),
       mean_of("height [d]", of_engine, &N::height)},
      0};
  const std::size_t comparisons = result.means.size() * (of_engine.size() - 1);
  // Two standard errors for many runs, shared among the comparisons (Bonferroni).
  constexpr double outside = 0.0455;
  const auto freedom = static_cast<double>(2 * (of_engine[0].size() - 1));
  result.limit = student_quantile(1 - outside / (2 * static_cast<double>(comparisons)), freedom);
  return result;
}

EngineMeans check_means(const LammpsProgram& program, const std::vector<Packing>& packings,
                        std::uint64_t cycles, const std::vector<std::size_t>& ranks,
                        const std::vector<std::string>& engines) {
  std::vector<std::vector<PackingNumbers>> of_engine(engines.size());
  for (const Packing& packing : packings) {
    const LammpsTask task = task_of(packing, cycles * cycle_steps(drive(packing.parameters)));
    of_engine[0].push_back(sheared_numbers(task, by_us(task)));
    for (std::size_t r = 0; r < ranks.size(); ++r) {
      const State theirs = run_lammps(program, task, ranks[r]).state;
      of_engine[r + 1].push_back(sheared_numbers(task, theirs));
    }
  }
  return compare_means(engines, of_engine);
}

void measure_speeds(const LammpsProgram& program, const Packing& packing, std::uint64_t steps,
                    const std::vector<std::size_t>& ranks, const std::vector<std::string>& engines,
                    EngineCheck& check) {
  const LammpsTask task = task_of(packing, steps);
  const double work = 1e-6 * static_cast<double>(steps * packing.parameters.grains);
  Simulation simulation(task.cell, task.scene, task.state);
  simulation.advance(task.drive, 1);  // builds the lists, as LAMMPS does before it starts timing
  const Stopwatch watch;
  simulation.advance(task.drive, steps);
  check.speeds.push_back(
      {engines[0], work / watch.seconds(), static_cast<double>(simulation.bytes())});
  for (std::size_t r = 0; r < ranks.size(); ++r) {
    const LammpsResult theirs = run_lammps(program, task, ranks[r]);
    check.speeds.push_back(
        {engines[r + 1], work / theirs.loop_seconds, static_cast<double>(theirs.peak_bytes)});
  }
}

std::string lammps_name(std::size_t ranks) {
  return ranks == 1 ? "LAMMPS" : fmt::format("LAMMPS, {} processes", ranks);
}

// Reports the progress of LAMMPS every 30 s: it may settle for an hour.
std::function<void(const State&)> every_30_s(const std::function<void(const std::string&)>& say) {
  return [&say, last = Stopwatch()](const State& state) mutable {
    if (last.seconds() < 30) return;
    say(fmt::format("LAMMPS at step {}, its wall at {:.2f} d", state.step, state.wall_height));
    last.restart();
  };
}

// Returns our packings at step 0; records how each engine settled them.
std::vector<Packing> settle_all(const LammpsProgram& program, const EngineCheckOptions& options,
                                const std::function<void(const std::string&)>& say,
                                EngineCheck& check) {
  Parameters parameters;
  parameters.grains = options.grains;
  if (!options.gravity) parameters.gravity_m_per_s2 = 0;
  SettleParameters settle;
  settle.time_limit = options.settle_time_limit;
  std::vector<Packing> packings;
  std::vector<std::vector<PackingNumbers>> of_engine(options.settle ? 2 : 1);
  const std::size_t seeds = options.cycles > 0 ? options.seeds : 1;
  const auto keep = [&](std::size_t engine, const std::string& name, Settling settling) {
    of_engine[engine].push_back(settling.numbers);
    settling.engine = name;
    settling.seed = packings.size() + 1;
    check.settlings.push_back(std::move(settling));
  };
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    say(fmt::format("settling seed {}", seed));
    Packing packing = loose_packing(parameters, seed);
    keep(0, kOurs, settling_by_us(packing, settle));
    State ours = check.settlings.back().state;
    if (options.settle) {
      say(fmt::format("settling seed {} in LAMMPS", seed));
      keep(1, lammps_name(options.ranks),
           settling_by_lammps(packing, settle, program, options.ranks, every_30_s(say)));
    }
    packing.state = std::move(ours);
    packing.state.step = 0;
    packings.push_back(std::move(packing));
  }
  if (options.settle && seeds > 1) {
    check.settled = compare_means({kOurs, lammps_name(options.ranks)}, of_engine);
  }
  return packings;
}

}  // namespace

Settling settling_by_us(const Packing& loose, const SettleParameters& parameters) {
  const Stopwatch watch;
  Simulation simulation(loose.cell, loose.scene, loose.state);
  settle(simulation, parameters, loose.scene);
  const double seconds = watch.seconds();
  return facts_of(loose, simulation.state(), seconds, seconds,
                  static_cast<double>(simulation.bytes()));
}

Settling settling_by_lammps(const Packing& loose, const SettleParameters& parameters,
                            const LammpsProgram& program, std::size_t ranks,
                            const std::function<void(const State&)>& seen) {
  const Stopwatch watch;
  LammpsResult result = settle_by_lammps(program, Settle(parameters, loose.scene), loose.scene,
                                         loose.cell, loose.state, ranks, seen);
  return facts_of(loose, std::move(result.state), watch.seconds(), result.loop_seconds,
                  static_cast<double>(result.peak_bytes));
}

bool EngineMeans::agree() const {
  return std::ranges::all_of(means, [&](const EngineMean& mean) {
    return std::ranges::all_of(mean.apart, [&](double errors) { return errors <= limit; });
  });
}

bool EngineCheck::agree() const {
  // Rounding differs in every sum, not only in the one number that was moved.
  constexpr double kRoundings = 1e3, kSmallest = 1e-9;
  const bool near = std::ranges::all_of(trajectories, [&](const TrajectoryCheck& t) {
    return t.distance <= std::max(kSmallest, kRoundings * t.rounding);
  });
  return near && settled.agree() && sheared.agree();
}

EngineCheck check_engines(const EngineCheckOptions& options) {
  const auto say = [&](const std::string& what) {
    if (options.report) options.report(fmt::format("N = {}: {}", options.grains, what));
  };
  const LammpsProgram program = find_lammps();
  EngineCheck check;
  check.lammps_version = program.version;
  check.grains = options.grains;
  std::vector<std::size_t> ranks = {1};
  if (options.ranks > 1) ranks.push_back(options.ranks);
  std::vector<std::string> engines = {kOurs};
  for (const std::size_t n : ranks) engines.push_back(lammps_name(n));
  const std::vector<Packing> packings = settle_all(program, options, say, check);
  say(fmt::format("trajectories of {} steps", options.steps));
  check_trajectories(program, packings.front(), options.steps, check);
  if (options.cycles > 0) {
    say(fmt::format("means after {} cycles, {} seeds", options.cycles, packings.size()));
    check.sheared = check_means(program, packings, options.cycles, ranks, engines);
  }
  say("speed");
  measure_speeds(program, packings.front(), options.steps, ranks, engines, check);
  return check;
}

}  // namespace shearcell::bench
