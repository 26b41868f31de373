// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/accuracy/sheared.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include "analysis/measures.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/bench/accuracy/fit.hpp"
#include "protocols/settle.hpp"
#include "protocols/stiffen.hpp"

namespace shearcell::accuracy {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

constexpr std::uint64_t kFinest = 32U * 45600U;  // steps per cycle of the reference

Parameters with_steps(Parameters parameters, std::uint64_t steps_per_cycle) {
  parameters.steps_per_cycle = steps_per_cycle;
  return parameters;
}

double distance(const State& a, const State& b) {
  return std::sqrt((a.position - b.position).squaredNorm() /
                   static_cast<double>(a.position.cols()));
}

// Steps of the finest run, whole multiples of `stride`, nearest to equal parts of `end`.
std::vector<std::uint64_t> look_steps(std::uint64_t end, std::uint64_t stride, int looks) {
  std::vector<std::uint64_t> steps;
  for (int n = 1; n <= looks; ++n) {
    const double target = static_cast<double>(end) * n / looks;
    const auto multiple =
        static_cast<std::uint64_t>(std::llround(target / static_cast<double>(stride)));
    const std::uint64_t step = std::max<std::uint64_t>(1, multiple) * stride;
    if (steps.empty() || step > steps.back()) steps.push_back(step);
  }
  return steps;
}

Simulation simulation_of(const Packing& packing, std::uint64_t steps_per_cycle) {
  const Parameters parameters = with_steps(packing.parameters, steps_per_cycle);
  return {packing.cell, shear_scene(parameters), packing.state};
}

// Shears from look to look; `visit(step of the finest run, state)`.
template <class Visit>
double shear_to_looks(const Packing& packing, std::uint64_t steps_per_cycle,
                      const std::vector<std::uint64_t>& looks, Visit&& visit) {
  const auto start = Clock::now();
  const std::uint64_t stride = kFinest / steps_per_cycle;
  Simulation simulation = simulation_of(packing, steps_per_cycle);
  const Drive tilt = drive(with_steps(packing.parameters, steps_per_cycle));
  for (const std::uint64_t look : looks) {
    simulation.advance(tilt, look / stride - simulation.step());
    visit(look, simulation.state());
  }
  return seconds_since(start);
}

double time_of(const Packing& packing, std::uint64_t finest_step) {
  return packing.parameters.period_s * static_cast<double>(finest_step) / kFinest;
}

// Time in which the distance grows by a factor of e, between 1e-11 and 1e-4 d.
double growth_time(const Separation& run) {
  std::vector<double> time, logarithm;
  for (std::size_t n = 0; n < run.time.size(); ++n) {
    if (run.distance[n] < 1e-11 || run.distance[n] > 1e-4) continue;
    time.push_back(run.time[n]);
    logarithm.push_back(std::log(run.distance[n]));
  }
  return time.size() < 3 ? 0 : 1 / fitted_line(time, logarithm).slope;
}

}  // namespace

Packing settled(const Parameters& parameters, std::uint64_t seed) {
  Packing packing{parameters, make_cell(geometry(parameters), seed), {}};
  const State loose = fill_cell(packing.cell, geometry(parameters), seed);
  const Scene scene = settle_scene(parameters);
  const Settle protocol({}, scene);
  Simulation simulation(packing.cell, scene, loose);
  while (!protocol.advance(simulation, std::numeric_limits<std::uint64_t>::max()).finished) {
  }
  packing.state = simulation.state();
  packing.state.step = 0;
  return packing;
}

double shear_rate_measured(const Packing& packing, int repeats, double seconds_each) {
  Simulation simulation = simulation_of(packing, packing.parameters.steps_per_cycle);
  const Drive tilt = drive(packing.parameters);
  std::vector<double> rates;
  for (int n = 0; n < repeats; ++n) {
    const auto start = Clock::now();
    const std::uint64_t before = simulation.step();
    while (seconds_since(start) < seconds_each) simulation.advance(tilt, 200);
    rates.push_back(1e-6 * static_cast<double>((simulation.step() - before) * simulation.grains()) /
                    seconds_since(start));
  }
  std::sort(rates.begin(), rates.end());
  return rates[rates.size() / 2];
}

Chaos separate(const Packing& packing, const std::vector<std::uint64_t>& steps_per_cycle,
               double time, int looks) {
  const auto end =
      static_cast<std::uint64_t>(time / packing.parameters.period_s * static_cast<double>(kFinest));
  std::map<std::uint64_t, State> exact;
  for (const std::uint64_t steps : steps_per_cycle) {
    if (steps == 0 || kFinest % steps != 0) {
      throw std::invalid_argument(std::to_string(steps) + " steps per cycle do not divide " +
                                  std::to_string(kFinest));
    }
    for (const std::uint64_t look : look_steps(end, kFinest / steps, looks)) exact[look];
  }
  std::vector<std::uint64_t> all;
  for (const auto& [look, state] : exact) all.push_back(look);
  shear_to_looks(packing, kFinest, all,
                 [&](std::uint64_t look, State state) { exact[look] = std::move(state); });

  Chaos chaos;
  const auto compared = [&](const Packing& with, std::uint64_t steps,
                            const std::map<std::uint64_t, State>& reference) {
    Separation run;
    run.time_step = packing.parameters.period_s / static_cast<double>(steps);
    run.wall_seconds = shear_to_looks(with, steps, look_steps(end, kFinest / steps, looks),
                                      [&](std::uint64_t look, const State& state) {
                                        run.time.push_back(time_of(packing, look));
                                        run.distance.push_back(distance(state, reference.at(look)));
                                      });
    return run;
  };
  for (const std::uint64_t steps : steps_per_cycle) {
    chaos.runs.push_back(compared(packing, steps, exact));
  }
  const std::uint64_t table_1 = packing.parameters.steps_per_cycle;
  std::map<std::uint64_t, State> unmoved;
  shear_to_looks(packing, table_1, look_steps(end, kFinest / table_1, looks),
                 [&](std::uint64_t look, State state) { unmoved[look] = std::move(state); });
  Packing moved = packing;
  for (Eigen::Index i = 0; i < moved.state.position.cols(); ++i) {
    moved.state.position(i % 3, i) += i % 2 == 0 ? 1e-13 : -1e-13;
  }
  chaos.perturbed = compared(moved, table_1, unmoved);
  chaos.lyapunov_time = growth_time(chaos.perturbed);
  return chaos;
}

RunMeans sheared_means(const Packing& packing, std::uint64_t steps_per_cycle, std::uint64_t cycles,
                       std::uint64_t first_cycle) {
  Simulation simulation = simulation_of(packing, steps_per_cycle);
  const Drive tilt = drive(with_steps(packing.parameters, steps_per_cycle));
  RunMeans means;
  try {
    simulation.advance(tilt, (first_cycle - 1) * steps_per_cycle);
    const auto count = static_cast<double>(cycles - first_cycle + 1);
    for (std::uint64_t cycle = first_cycle; cycle <= cycles; ++cycle) {
      simulation.advance(tilt, steps_per_cycle);
      simulation.check();
      const State state = simulation.state();
      const Measures m =
          analyse(packing.cell, wall_pose(packing.cell, 0, state.wall_height), state.position)
              .measures;
      means.phi += m.phi / count;
      means.contacts += m.contacts_per_grain / count;
      means.overlap += m.mean_overlap / count;
    }
  } catch (const NumericalFailure& failure) {
    means.failure = failure.what();
    means.phi = means.contacts = means.overlap = std::nan("");
  }
  return means;
}

std::vector<Softness> stiffened(const Packing& packing, std::uint64_t decades) {
  StiffenParameters parameters;
  parameters.steps = decades * parameters.steps_per_decade + 1;
  const Stiffen protocol(parameters, stiffen_scene(packing.parameters));
  Simulation simulation(packing.cell, stiffen_scene(packing.parameters), packing.state);
  std::vector<Softness> all;
  for (std::uint64_t n = 0; n < parameters.steps; ++n) {
    protocol.advance(simulation, 1);
    const State state = simulation.state();
    const Measures m =
        analyse(packing.cell, wall_pose(packing.cell, 0, state.wall_height), state.position)
            .measures;
    all.push_back({raised_stiffness(1, n, parameters.steps_per_decade), m.phi, m.phi_uncorrected,
                   m.mean_overlap});
  }
  return all;
}

}  // namespace shearcell::accuracy
