// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/speed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "core/kernel.hpp"
#include "experiments/bench/packing.hpp"
#include "provenance/checkpoint.hpp"
#include "provenance/io/clock.hpp"
#include "provenance/words.hpp"

namespace shearcell::bench {
namespace {

// The engine has no clock, so timed_kernels() wraps the functions of a kernel and adds up the
// times. Only one simulation with one thread can be timed at a time.
struct KernelTimes {
  const Kernels* inner = nullptr;
  std::size_t calls = 0;
  double step = 0, search = 0, prune = 0;
  // Every 16th step is sampled, that is, repeated three times: the whole step, the step without
  // walls, and the step without walls and neighbours. The results of the repetitions are written to
  // `elsewhere`. `sampled`: total time for sampling.
  double sampled = 0, whole = 0, without_walls = 0, without_neighbours = 0;
  // Numbers of blocks and of their neighbour slots, summed over the sampled steps. The repetitions
  // of a step are not counted.
  double blocks = 0, slots = 0;
  std::vector<double> elsewhere;
};
KernelTimes times;

template <class Call>
auto timed(double& total, Call&& call) {
  const Stopwatch watch;
  const auto result = call();
  total += watch.seconds();
  return result;
}

void sample_parts(StepTask task, std::size_t first, std::size_t last) {
  const Stopwatch watch;
  const std::size_t room = padded(task.grains);
  times.elsewhere.resize(8 * room);
  times.blocks += static_cast<double>(last - first);
  for (std::size_t block = first; block < last; ++block) {
    times.slots += task.neighbours.other_slots[block] + task.neighbours.moving_wall_slots[block];
  }
  task.next_rows = times.elsewhere.data();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double* velocity = times.elsewhere.data() + (4 + axis) * room;
    std::copy_n(task.velocity[axis], room, velocity);
    task.velocity[axis] = velocity;
  }
  task.moving_wall_force_y = times.elsewhere.data() + 7 * room;
  const auto again = [&] { return times.inner->step(task, first, last); };
  timed(times.whole, again);
  std::vector<std::uint8_t> near(task.neighbours.near + first, task.neighbours.near + last);
  for (std::uint8_t& bits : near) bits &= static_cast<std::uint8_t>(~kNearWall);
  task.neighbours.near = near.data() - first;
  timed(times.without_walls, again);
  const std::vector<std::uint16_t> none(last - first, 0);
  task.neighbours.other_slots = none.data() - first;
  timed(times.without_neighbours, again);
  times.sampled += watch.seconds();
}

Kernels timed_kernels(const Kernels& inner) {
  times = {};
  times.inner = &inner;
  return {inner.name, inner.lanes,
          [](const StepTask& task, std::size_t first, std::size_t last) {
            if (++times.calls % 16 == 0) sample_parts(task, first, last);
            return timed(times.step, [&] { return times.inner->step(task, first, last); });
          },
          [](const SearchTask& task, std::size_t first, std::size_t last) {
            return timed(times.search, [&] { return times.inner->search(task, first, last); });
          },
          [](const PruneTask& task, std::size_t first, std::size_t last) {
            return timed(times.prune, [&] { return times.inner->prune(task, first, last); });
          }};
}

Packing repeated(const Packing& one, std::size_t copies) {
  Packing made = one;
  made.cell.depth *= static_cast<double>(copies);
  const Eigen::Index grains = one.state.position.cols();
  made.state.position = one.state.position.replicate(1, static_cast<Eigen::Index>(copies));
  made.state.velocity = one.state.velocity.replicate(1, static_cast<Eigen::Index>(copies));
  for (std::size_t c = 1; c < copies; ++c) {
    const double shift = static_cast<double>(c) * one.cell.depth;
    made.state.position.block(2, static_cast<Eigen::Index>(c) * grains, 1, grains).array() += shift;
    for (WallGrain grain : one.cell.wall_grains) {
      grain.position.z() += shift;
      made.cell.wall_grains.push_back(grain);
    }
  }
  return made;
}

// Up to 18,200 grains form one packing. A larger cell consists of equal packings along the depth:
// as few as possible, with at least `grains` grains in all.
Packing prepare(std::size_t grains) {
  const std::size_t parts = (grains + 18199) / 18200;
  Parameters parameters;
  parameters.grains = (grains + parts - 1) / parts;
  Packing made = pressed_packing(parameters, 1);
  Simulation simulation = simulate(made);
  simulation.advance({}, 2000);  // without shear, under gravity
  made.state = simulation.state();
  made.state.step = 0;
  return parts == 1 ? made : repeated(made, parts);
}

std::string hash_after(const Packing& made, const SimulationSettings& settings,
                       std::uint64_t steps) {
  Simulation simulation = simulate(made, settings);
  simulation.advance(drive(made.parameters), steps);
  Checkpoint checkpoint;
  checkpoint.cell = made.cell;
  checkpoint.state = simulation.state();
  return state_hash(checkpoint);
}

void measure_shares(const Packing& made, const Kernels& kernels, std::uint64_t steps,
                    SpeedResult& result) {
  const Kernels table = timed_kernels(kernels);
  Simulation simulation = simulate(made, {&table, 1, {}, {}});
  const Stopwatch watch;
  simulation.advance(drive(made.parameters), steps);
  const double total = watch.seconds() - times.sampled;
  const double step_share = times.step / total;
  result.integration_share = step_share * times.without_neighbours / times.whole;
  result.wall_share = step_share * std::max(0.0, 1 - times.without_walls / times.whole);
  result.force_share = step_share - result.integration_share - result.wall_share;
  result.search_share = times.search / total;
  result.prune_share = times.prune / total;
  const ListCounts& counts = simulation.list_counts();
  result.steps_per_search = static_cast<double>(steps) / static_cast<double>(counts.builds);
  result.steps_per_prune = static_cast<double>(steps) / static_cast<double>(counts.prunes);
  result.bytes_per_grain =
      static_cast<double>(simulation.bytes()) / static_cast<double>(simulation.grains());
}

void measure_rate(const Packing& made, const SimulationSettings& settings,
                  const SpeedOptions& options, SpeedResult& result) {
  Simulation simulation = simulate(made, settings);
  const Stopwatch warm_up;
  std::uint64_t steps = 0;
  for (; warm_up.seconds() < options.seconds_per_repeat || steps == 0; steps += 20) {
    simulation.advance(drive(made.parameters), 20);
  }
  std::vector<double> rates;
  for (std::size_t repeat = 0; repeat < options.repeats; ++repeat) {
    const Stopwatch watch;
    simulation.advance(drive(made.parameters), steps);
    rates.push_back(1e-6 * static_cast<double>(steps * result.grains) / watch.seconds());
  }
  std::sort(rates.begin(), rates.end());
  result.median_rate = rates[rates.size() / 2];
  result.slowest_rate = rates.front();
  result.fastest_rate = rates.back();
}

void measure_size(std::size_t grains, const SpeedOptions& options,
                  std::vector<SpeedResult>& results) {
  const auto say = [&](const std::string& what) {
    if (options.report) options.report(fmt::format("N = {}: {}", grains, what));
  };
  say("pressing a packing");
  const Packing made = prepare(grains);
  grains = static_cast<std::size_t>(made.state.position.cols());
  const std::size_t first = results.size();
  for (const Kernels* kernels : kernels_here()) {
    for (const std::size_t threads : options.threads) {
      SpeedResult result{.grains = grains, .simd = kernels->name, .threads = threads};
      say(fmt::format("{}, {}", kernels->name, counted(threads, "thread")));
      const SimulationSettings settings{kernels, threads, {}, {}};
      result.state_hash = hash_after(made, settings, 200);
      if (results.size() > first && result.state_hash != results[first].state_hash) {
        throw std::runtime_error(fmt::format(
            "kernels {} ({} threads) and {} give different states after 200 steps at N = {}",
            result.simd, threads, results[first].simd, grains));
      }
      measure_rate(made, settings, options, result);
      const double steps = 1e6 * result.median_rate * options.seconds_per_repeat /
                           static_cast<double>(grains * threads);
      measure_shares(made, *kernels,
                     std::max<std::uint64_t>(400, static_cast<std::uint64_t>(steps)), result);
      result.multiplications = multiplications(kernels->lanes, times.slots / times.blocks);
      result.limit = 1e-6 * static_cast<double>(threads) * peak_multiplications(kernels->lanes) /
                     result.multiplications;
      results.push_back(result);
    }
  }
}

}  // namespace

std::vector<SpeedResult> measure_speed(const SpeedOptions& options) {
  std::vector<SpeedResult> all;
  for (const std::size_t grains : options.sizes) measure_size(grains, options, all);
  return all;
}

}  // namespace shearcell::bench
