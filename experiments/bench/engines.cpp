// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/engines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/statistics.hpp"
#include "core/drive.hpp"
#include "experiments/manifest/conversion.hpp"
#include "provenance/io/clock.hpp"

namespace shearcell::bench {
namespace {

constexpr std::size_t kOurs = 0;  // processes of LAMMPS

std::string engine_name(std::size_t ranks) {
  if (ranks == kOurs) return "shearcell";
  return ranks == 1 ? "LAMMPS" : fmt::format("LAMMPS, {} processes", ranks);
}

LammpsTask task_of(const Packing& packing, std::uint64_t steps) {
  LammpsTask task;
  task.cell = packing.cell;
  task.scene = shear_scene(packing.parameters);
  task.drive = drive(packing.parameters);
  task.state = packing.state;
  task.end = task.stride = packing.state.step + steps;
  task.check_every = lammps_check_steps(packing.parameters.grains, 1);
  return task;
}

// The time is that of the time loop alone, with the first lists built before it.
LammpsResult computed_by(std::size_t ranks, const LammpsProgram& program, const LammpsTask& task) {
  if (ranks != kOurs) return run_lammps(program, task, ranks);
  Simulation simulation(task.cell, task.scene, task.state);
  simulation.forces();
  const Stopwatch watch;
  simulation.advance(task.drive, task.end - task.state.step);
  return {simulation.state(), watch.seconds(), simulation.bytes()};
}

double farthest(const State& a, const State& b) {
  return (a.position - b.position).colwise().norm().maxCoeff();
}

TrajectoryCheck compare(const LammpsProgram& program, const std::string& scene,
                        const LammpsTask& task) {
  LammpsTask moved = task;  // the first grain by one unit in the last place
  double& x = moved.state.position(0, 0);
  x = std::nextafter(x, 1e9);
  const State ours = computed_by(kOurs, program, task).state;
  const State theirs = computed_by(1, program, task).state;
  return {scene, task.end - task.state.step, farthest(ours, theirs),
          std::fabs(ours.wall_height - theirs.wall_height),
          farthest(computed_by(kOurs, program, moved).state, ours)};
}

// `of_engine`: the numbers of the same packings by each engine.
EngineMeans compare_means(const std::vector<std::size_t>& engines,
                          const std::vector<std::vector<PackingNumbers>>& of_engine) {
  using N = PackingNumbers;
  constexpr std::pair<const char*, double N::*> quantities[] = {
      {"phi", &N::phi},
      {"contacts per grain", &N::contacts_per_grain},
      {"mean overlap [d]", &N::mean_overlap},
      {"force imbalance of the wall", &N::imbalance},
      {"height [d]", &N::height}};
  EngineMeans result;
  for (const auto& [quantity, number] : quantities) {
    // phi, without interior grains, does not exist in every packing.
    const auto lacks = [number = number](const std::vector<PackingNumbers>& packings) {
      return over(packings, number).runs < packings.size();
    };
    if (std::ranges::any_of(of_engine, lacks)) continue;
    const RunStatistics ours = over(of_engine.front(), number);
    for (std::size_t e = 0; e < engines.size(); ++e) {
      const RunStatistics of = over(of_engine[e], number);
      const double error =
          std::hypot(ours.standard_error.value_or(0), of.standard_error.value_or(0));
      result.means.push_back({quantity, engine_name(engines[e]), of,
                              error > 0 ? std::fabs(*of.mean - *ours.mean) / error : 0});
    }
  }
  const std::size_t comparisons = std::size(quantities) * (engines.size() - 1);
  // Two standard errors for many runs, shared among the comparisons (Bonferroni).
  constexpr double outside = 0.0455;
  const auto freedom = static_cast<double>(2 * (of_engine[0].size() - 1));
  result.limit = student_quantile(1 - outside / (2 * static_cast<double>(comparisons)), freedom);
  return result;
}

EngineMeans check_means(const LammpsProgram& program, const std::vector<Packing>& packings,
                        std::uint64_t cycles, const std::vector<std::size_t>& engines) {
  std::vector<std::vector<PackingNumbers>> of_engine(engines.size());
  for (const Packing& packing : packings) {
    const LammpsTask task = task_of(packing, cycles * cycle_steps(drive(packing.parameters)));
    for (std::size_t e = 0; e < engines.size(); ++e) {
      const State state = computed_by(engines[e], program, task).state;
      of_engine[e].push_back(
          numbers_of(task.cell, task.scene, tilt(task.drive, state.step).theta, state));
    }
  }
  return compare_means(engines, of_engine);
}

using Say = std::function<void(const std::string&)>;

// Reports the progress of LAMMPS every 30 s: it may settle for an hour.
std::function<void(const State&)> every_30_s(const Say& say) {
  return [&say, last = Stopwatch()](const State& state) mutable {
    if (last.seconds() < 30) return;
    say(fmt::format("LAMMPS at step {}, its wall at {:.2f} d", state.step, state.wall_height));
    last.restart();
  };
}

// Returns our packings at step 0; records how each engine settled them.
std::vector<Packing> settle_all(const LammpsProgram& program, const EngineCheckOptions& options,
                                const Say& say, EngineCheck& check) {
  Parameters parameters;
  parameters.grains = options.grains;
  if (!options.gravity) parameters.gravity_m_per_s2 = 0;
  const SettleParameters settle{.time_limit = options.settle_time_limit};
  std::vector<std::size_t> engines = {kOurs};
  if (options.settle) engines.push_back(options.ranks);
  std::vector<Packing> packings;
  std::vector<std::vector<PackingNumbers>> of_engine(engines.size());
  const std::size_t seeds = options.cycles > 0 ? options.seeds : 1;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const Packing loose = loose_packing(parameters, seed);
    for (std::size_t e = 0; e < engines.size(); ++e) {
      say(fmt::format("settling seed {}{}", seed, engines[e] == kOurs ? "" : " in LAMMPS"));
      Settling settling = settle_by(engines[e], program, loose, settle, every_30_s(say));
      settling.seed = seed;
      of_engine[e].push_back(settling.numbers);
      if (engines[e] == kOurs)
        packings.push_back({parameters, loose.cell, loose.scene, settling.state});
      check.settlings.push_back(std::move(settling));
    }
    packings.back().state.step = 0;
  }
  if (options.settle && seeds > 1) check.settled = compare_means(engines, of_engine);
  return packings;
}

// LAMMPS takes the steps between two checks of the protocol, which decides from the resulting state
// whether more are needed. The result's step counts the steps that LAMMPS took.
LammpsResult settle_by_lammps(std::size_t ranks, const LammpsProgram& program, const Packing& loose,
                              const Settle& protocol,
                              const std::function<void(const State&)>& seen) {
  LammpsResult settled{loose.state, 0, 0};
  for (;;) {
    // One step of our own, whose result is discarded: in it the protocol decides whether the
    // packing has settled and which forces act now. Then the watchdog checks the grains.
    Simulation check(loose.cell, loose.scene, settled.state);
    if (protocol.advance(check, 1).finished) return settled;
    check.check();
    const std::uint64_t end = protocol.next_check(settled.state.step);
    const LammpsTask task{.cell = loose.cell,
                          .scene = check.scene(),
                          .drive = protocol.drive(),
                          .state = std::move(settled.state),
                          .end = end,
                          .stride = end,
                          .check_every = lammps_check_steps(check.grains(), ranks)};
    LammpsResult part = run_lammps(program, task, ranks);
    settled.state = std::move(part.state);
    settled.loop_seconds += part.loop_seconds;
    settled.peak_bytes = std::max(settled.peak_bytes, part.peak_bytes);
    if (seen) seen(settled.state);
  }
}

}  // namespace

Settling settle_by(std::size_t ranks, const LammpsProgram& program, const Packing& loose,
                   const SettleParameters& parameters,
                   const std::function<void(const State&)>& seen) {
  const Stopwatch watch;
  LammpsResult result;
  if (ranks == kOurs) {
    Simulation simulation = simulate(loose);
    settle(simulation, parameters, loose.scene);
    result = {simulation.state(), watch.seconds(), simulation.bytes()};
  } else {
    result = settle_by_lammps(ranks, program, loose, Settle(parameters, loose.scene), seen);
  }
  const State& state = result.state;
  const auto work = static_cast<double>(state.step) * static_cast<double>(state.position.cols());
  return {{engine_name(ranks), 1e-6 * work / result.loop_seconds,
           static_cast<double>(result.peak_bytes)},
          0,
          state,
          watch.seconds(),
          numbers_of(loose.cell, loose.scene, 0, state)};
}

bool EngineMeans::agree() const {
  return std::ranges::all_of(means, [&](const EngineMean& mean) { return mean.apart <= limit; });
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
  const Say say = [&](const std::string& what) {
    options.report(fmt::format("N = {}: {}", options.grains, what));
  };
  const LammpsProgram program = find_lammps(options.ranks);
  EngineCheck check;
  check.lammps_version = program.version;
  check.grains = options.grains;
  std::vector<std::size_t> engines = {kOurs, 1};
  if (options.ranks > 1) engines.push_back(options.ranks);
  const std::vector<Packing> packings = settle_all(program, options, say, check);
  const LammpsTask task = task_of(packings.front(), options.steps);
  say(fmt::format("trajectories of {} steps", options.steps));
  LammpsTask other = task;
  check.trajectories.push_back(compare(program, "drag, still fluid", other));
  other.scene.fluid = Fluid::cell;
  check.trajectories.push_back(compare(program, "drag, moving fluid", other));
  other.scene.drag_rate = 0;
  check.trajectories.push_back(compare(program, "no drag", other));
  if (options.cycles > 0) {
    say(fmt::format("means after {} cycles, {} seeds", options.cycles, packings.size()));
    check.sheared = check_means(program, packings, options.cycles, engines);
  }
  say("speed");
  const double work = 1e-6 * static_cast<double>(options.steps * options.grains);
  for (const std::size_t ranks : engines) {
    const LammpsResult run = computed_by(ranks, program, task);
    check.speeds.push_back(
        {engine_name(ranks), work / run.loop_seconds, static_cast<double>(run.peak_bytes)});
  }
  return check;
}

}  // namespace shearcell::bench
