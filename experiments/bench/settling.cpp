// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/settling.hpp"

#include <chrono>
#include <limits>
#include <utility>

#include "experiments/runner/lammps/lammps_settle.hpp"
#include "experiments/manifest/conversion.hpp"

namespace shearcell {
namespace {

using accuracy::Packing;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Settling facts_of(const Packing& loose, const Scene& scene, State state, double seconds,
                  double stepping, double bytes) {
  Settling settling;
  const auto grains = static_cast<double>(state.position.cols());
  settling.seconds = seconds;
  settling.million_particle_steps_per_second =
      1e-6 * static_cast<double>(state.step) * grains / stepping;
  settling.bytes = bytes;
  settling.numbers = numbers_of(loose.cell, scene, 0, state);
  settling.state = std::move(state);
  return settling;
}

}  // namespace

Packing loose_packing(const Parameters& parameters, std::uint64_t seed) {
  Packing packing{parameters, make_cell(geometry(parameters), seed), {}};
  packing.state = fill_cell(packing.cell, geometry(parameters), seed);
  return packing;
}

Settling settling_by_us(const Packing& loose, const SettleParameters& settle) {
  const auto start = Clock::now();
  const Scene scene = settle_scene(loose.parameters);
  const Settle protocol(settle, scene);
  Simulation simulation(loose.cell, scene, loose.state);
  while (!protocol.advance(simulation, std::numeric_limits<std::uint64_t>::max()).finished) {
  }
  const double seconds = seconds_since(start);
  return facts_of(loose, scene, simulation.state(), seconds, seconds,
                  static_cast<double>(simulation.bytes()));
}

Settling settling_by_lammps(const Packing& loose, const SettleParameters& settle,
                            const LammpsProgram& program, std::size_t ranks,
                            const std::function<void(const State&)>& seen) {
  const auto start = Clock::now();
  const Scene scene = settle_scene(loose.parameters);
  LammpsResult result =
      settle_by_lammps(program, Settle(settle, scene), scene, loose.cell, loose.state, ranks, seen);
  const double seconds = seconds_since(start);
  return facts_of(loose, scene, std::move(result.state), seconds, result.loop_seconds,
                  static_cast<double>(result.peak_bytes));
}

}  // namespace shearcell
