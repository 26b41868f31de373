// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/engines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "analysis/agreement.hpp"
#include "analysis/measures.hpp"
#include "core/diagnostics.hpp"
#include "experiments/engines/lammps_run.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/report/accuracy/sheared.hpp"

namespace shearcell {
namespace {

using accuracy::Packing;
using Clock = std::chrono::steady_clock;

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

struct Computed {
  State state;
  double seconds;
  double bytes;
};

Computed by_lammps(const LammpsProgram& program, const LammpsTask& task, std::size_t ranks) {
  LammpsRun run(program, task, ranks);
  const auto frame = run.next_frame(std::chrono::hours(24 * 365));
  run.finish();
  return {*frame, run.loop_seconds(), static_cast<double>(run.peak_bytes())};
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
  const State ours = by_us(task), theirs = by_lammps(program, task, 1).state;
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

// Numbers of one packing after some cycles.
struct Numbers {
  double phi, contacts, overlap, imbalance, height;
};

Numbers numbers_of(const LammpsTask& task, const State& state) {
  const WallPose pose = wall_pose(task.cell, tilt(task.drive, state.step).theta, state.wall_height);
  const Measures measures = analyse(task.cell, pose, state.position).measures;
  const Diagnostics facts = diagnose(task.cell, task.scene, state, pose);
  return {measures.phi, measures.contacts_per_grain, measures.mean_overlap,
          std::fabs(facts.wall_imbalance), pose.top - pose.bottom};
}

EngineMean mean_of(const std::string& name, const std::vector<std::vector<Numbers>>& of_engine,
                   double Numbers::*member) {
  EngineMean mean{name, {}, {}};
  for (const std::vector<Numbers>& runs : of_engine) {
    std::vector<double> values;
    for (const Numbers& numbers : runs) values.push_back(numbers.*member);
    mean.of.push_back(over_runs(values));
    const RunStatistics &a = mean.of.front(), &b = mean.of.back();
    const double error = std::hypot(a.standard_error.value_or(0), b.standard_error.value_or(0));
    mean.apart.push_back(error > 0 ? std::fabs(*b.mean - *a.mean) / error : 0);
  }
  return mean;
}

void check_means(const LammpsProgram& program, const std::vector<Packing>& packings,
                 const EngineCheckOptions& options, const std::vector<std::size_t>& ranks,
                 EngineCheck& check) {
  std::vector<std::vector<Numbers>> of_engine(1 + ranks.size());
  for (const Packing& packing : packings) {
    const LammpsTask task =
        task_of(packing, options.cycles * cycle_steps(drive(packing.parameters)));
    of_engine[0].push_back(numbers_of(task, by_us(task)));
    for (std::size_t r = 0; r < ranks.size(); ++r) {
      of_engine[r + 1].push_back(numbers_of(task, by_lammps(program, task, ranks[r]).state));
    }
  }
  check.means = {mean_of("phi", of_engine, &Numbers::phi),
                 mean_of("contacts per grain", of_engine, &Numbers::contacts),
                 mean_of("mean overlap [d]", of_engine, &Numbers::overlap),
                 mean_of("force imbalance of the wall", of_engine, &Numbers::imbalance),
                 mean_of("height [d]", of_engine, &Numbers::height)};
  check.limit = limit_of_agreement(2 * (packings.size() - 1), check.means.size() * ranks.size());
}

void measure_speeds(const LammpsProgram& program, const Packing& packing, std::uint64_t steps,
                    const std::vector<std::size_t>& ranks, EngineCheck& check) {
  const LammpsTask task = task_of(packing, steps);
  const double work = 1e-6 * static_cast<double>(steps * packing.parameters.grains);
  Simulation simulation(task.cell, task.scene, task.state);
  simulation.advance(task.drive, 1);  // makes the lists, as LAMMPS does before it counts
  const auto start = Clock::now();
  simulation.advance(task.drive, steps);
  check.speeds.push_back(
      {check.engines[0], work / seconds_since(start), static_cast<double>(simulation.bytes())});
  for (std::size_t r = 0; r < ranks.size(); ++r) {
    const Computed theirs = by_lammps(program, task, ranks[r]);
    check.speeds.push_back({check.engines[r + 1], work / theirs.seconds, theirs.bytes});
  }
}

}  // namespace

bool EngineCheck::agree() const {
  // Rounding differs in every sum, not in one number alone.
  constexpr double kRoundings = 1e3, kSmallest = 1e-9;
  const bool near = std::ranges::all_of(trajectories, [&](const TrajectoryCheck& t) {
    return t.rounding == 0 || t.distance <= std::max(kSmallest, kRoundings * t.rounding);
  });
  return near && std::ranges::all_of(means, [&](const EngineMean& mean) {
           return std::ranges::all_of(mean.apart, [&](double errors) { return errors <= limit; });
         });
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
  check.engines = {"shearcell"};
  for (const std::size_t n : ranks) {
    check.engines.push_back(n == 1 ? "LAMMPS" : fmt::format("LAMMPS, {} processes", n));
  }
  Parameters parameters;
  parameters.grains = options.grains;
  if (!options.gravity) parameters.gravity_m_per_s2 = 0;
  std::vector<Packing> packings;
  const std::size_t seeds = options.cycles > 0 ? options.seeds : 1;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    say(fmt::format("settling seed {}", seed));
    const auto start = Clock::now();
    packings.push_back(accuracy::settled(parameters, seed));
    if (seed == 1) check.settle_seconds = seconds_since(start);
  }
  check.settled_phi = numbers_of(task_of(packings.front(), 0), packings.front().state).phi;
  say(fmt::format("trajectories of {} steps", options.steps));
  check_trajectories(program, packings.front(), options.steps, check);
  if (options.cycles > 0) {
    say(fmt::format("means after {} cycles, {} seeds", options.cycles, seeds));
    check_means(program, packings, options, ranks, check);
  }
  say("speed");
  measure_speeds(program, packings.front(), options.steps, ranks, check);
  return check;
}

}  // namespace shearcell
