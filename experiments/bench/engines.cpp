// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/engines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "analysis/agreement.hpp"
#include "core/drive.hpp"
#include "experiments/runner/lammps/lammps_run.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/bench/accuracy/sheared.hpp"

namespace shearcell {
namespace {

using accuracy::Packing;
using Clock = std::chrono::steady_clock;

constexpr const char* kOurs = "shearcell";

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
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

// The smallest change that its numbers can hold, to the first grain.
double effect_of_rounding(const LammpsTask& task, const State& ours) {
  LammpsTask moved = task;
  double& x = moved.state.position(0, 0);
  x = std::nextafter(x, 1e9);
  return farthest(by_us(moved), ours);
}

TrajectoryCheck compare(const LammpsProgram& program, const std::string& scene,
                        const LammpsTask& task, bool rounding) {
  const State ours = by_us(task), theirs = run_lammps(program, task, 1).state;
  return {scene, task.end - task.state.step, farthest(ours, theirs),
          std::fabs(ours.wall_height - theirs.wall_height),
          rounding ? effect_of_rounding(task, ours) : 0};
}

// The drag as it is usually given to LAMMPS, over the time of 50 steps of Table I, which is short
// enough for the errors to be those of the scheme.
TrajectoryCheck explicit_drag(const LammpsProgram& program, Packing packing, std::uint64_t finer) {
  packing.parameters.steps_per_cycle *= finer;
  LammpsTask task = task_of(packing, 50 * finer);
  task.added_mass = false;
  const std::string name =
      finer == 1 ? "explicit drag, dt" : fmt::format("explicit drag, dt/{}", finer);
  return compare(program, name, task, false);
}

void check_trajectories(const LammpsProgram& program, const Packing& packing, std::uint64_t steps,
                        EngineCheck& check) {
  LammpsTask task = task_of(packing, steps);
  check.trajectories.push_back(compare(program, "drag, still fluid", task, true));
  task.scene.fluid = Fluid::cell;
  check.trajectories.push_back(compare(program, "drag, moving fluid", task, true));
  task.scene.drag_rate = 0;
  check.trajectories.push_back(compare(program, "no drag", task, true));
  for (const std::uint64_t finer : {1U, 2U}) {
    check.trajectories.push_back(explicit_drag(program, packing, finer));
  }
  const auto& last = check.trajectories;
  check.explicit_drag_order =
      std::log2(last[last.size() - 2].distance / last[last.size() - 1].distance);
}

PackingNumbers sheared_numbers(const LammpsTask& task, const State& state) {
  return numbers_of(task.cell, task.scene, tilt(task.drive, state.step).theta, state);
}

EngineMeans compare_means(std::vector<std::string> engines,
                          const std::vector<std::vector<PackingNumbers>>& of_engine) {
  EngineMeans result{std::move(engines), engine_means(of_engine), 0};
  const std::size_t comparisons = result.means.size() * (of_engine.size() - 1);
  result.limit = limit_of_agreement(2 * (of_engine[0].size() - 1), comparisons);
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
  simulation.advance(task.drive, 1);  // makes the lists, as LAMMPS does before it counts
  const auto start = Clock::now();
  simulation.advance(task.drive, steps);
  check.speeds.push_back(
      {engines[0], work / seconds_since(start), static_cast<double>(simulation.bytes())});
  for (std::size_t r = 0; r < ranks.size(); ++r) {
    const LammpsResult theirs = run_lammps(program, task, ranks[r]);
    check.speeds.push_back(
        {engines[r + 1], work / theirs.loop_seconds, static_cast<double>(theirs.peak_bytes)});
  }
}

std::string lammps_name(std::size_t ranks) {
  return ranks == 1 ? "LAMMPS" : fmt::format("LAMMPS, {} processes", ranks);
}

// Says where LAMMPS is, now and then: it may be settling for an hour.
std::function<void(const State&)> now_and_then(const std::function<void(const std::string&)>& say) {
  return [&say, last = Clock::now()](const State& state) mutable {
    if (seconds_since(last) < 30) return;
    say(fmt::format("LAMMPS at step {}, its wall at {:.2f} d", state.step, state.wall_height));
    last = Clock::now();
  };
}

// Our packings, and what it took either engine to settle them.
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
    check.settlings.push_back({name, packings.size() + 1, std::move(settling)});
  };
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    say(fmt::format("settling seed {}", seed));
    Packing packing = loose_packing(parameters, seed);
    keep(0, kOurs, settling_by_us(packing, settle));
    State ours = check.settlings.back().result.state;
    if (options.settle) {
      say(fmt::format("settling seed {} in LAMMPS", seed));
      keep(1, lammps_name(options.ranks),
           settling_by_lammps(packing, settle, program, options.ranks, now_and_then(say)));
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

bool EngineMeans::agree() const {
  return std::ranges::all_of(means, [&](const EngineMean& mean) {
    return std::ranges::all_of(mean.apart, [&](double errors) { return errors <= limit; });
  });
}

bool EngineCheck::agree() const {
  // Rounding differs in every sum, not in one number alone.
  constexpr double kRoundings = 1e3, kSmallest = 1e-9;
  const bool near = std::ranges::all_of(trajectories, [&](const TrajectoryCheck& t) {
    return t.rounding == 0 || t.distance <= std::max(kSmallest, kRoundings * t.rounding);
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

}  // namespace shearcell
