// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/stability/scenes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/diagnostics.hpp"
#include "core/minimizer.hpp"
#include "experiments/bench/stability/oracle.hpp"
#include "experiments/manifest/conversion.hpp"

namespace shearcell::stability {

Scene table_1() {
  Parameters parameters;
  parameters.pressure_at = PressureAt::moving_wall;  // the closed forms have P A_w as the load
  return shear_scene(parameters);
}

Scene only_springs() {
  Scene scene = table_1();
  scene.drag_rate = scene.gravity = scene.pressure = 0;
  scene.wall_mass = 1e30;
  return scene;
}

double crystal_limit(const Scene& scene) {
  return 2 / std::sqrt(8 * scene.stiffness);
}

Packing placed(const Scene& scene, const std::vector<V>& positions, const V& size) {
  Packing made;
  made.scene = scene;
  made.cell.width = size.x();
  made.cell.top = size.y();
  made.cell.depth = size.z();
  const auto n = static_cast<Eigen::Index>(positions.size());
  made.state.position.resize(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    made.state.position.col(i) = positions[static_cast<std::size_t>(i)];
  }
  made.state.velocity = Eigen::Matrix3Xd::Zero(3, n);
  made.state.wall_height = made.cell.bottom;
  return made;
}

const Packing& settled() {
  static const Packing packing = [] {
    Parameters parameters;
    parameters.grains = 60;
    parameters.pressure_at = PressureAt::moving_wall;
    Packing made = bench::settled_packing(parameters, 1);
    made.state = advanced(made, 20000);  // closer to rest than settling requires
    made.state.step = 0;
    return made;
  }();
  return packing;
}

Packing crystal(int layers, double overlap, int along, bool vacancy) {
  const double spacing = 1 - overlap, rise = spacing / std::numbers::sqrt2, end = 0.5 - overlap;
  std::vector<V> positions;
  for (int layer = 0; layer < layers; ++layer) {
    const int shift = layer % 2;  // every other layer sits in the hollows of its neighbours
    for (int column = 0; column < along - shift; ++column) {
      for (int k = 0; k < along; ++k) {
        positions.emplace_back(end + spacing * (column + 0.5 * shift), end + rise * layer,
                               spacing * (k + 0.5 * shift));
      }
    }
  }
  const V size(2 * end + spacing * (along - 1), 2 * end + rise * (layers - 1), spacing * along);
  if (vacancy) {
    positions.erase(
        std::ranges::min_element(positions, {}, [&](const V& p) { return (p - size / 2).norm(); }));
  }
  Packing made = placed(only_springs(), positions, size);
  // Each grain of the lowest layer is pressed onto the wall with k times the overlap.
  made.scene.pressure = made.scene.stiffness * overlap / (spacing * spacing);
  made.scene.wall_mass = 10;
  Simulation simulation = simulate(made);
  minimize_enthalpy(simulation, {.force_tolerance = 1e-9});
  made.state = simulation.state();
  made.state.step = 0;
  return made;
}

Packing in_fluid(Packing packing) {
  packing.scene.drag_rate = table_1().drag_rate;
  packing.scene.wall_drag = table_1().wall_drag;
  return packing;
}

Packing row_between_walls(int count, const Scene& scene) {
  std::vector<V> positions;
  for (int i = 0; i < count; ++i) positions.emplace_back(0.7 + 1.2 * i, 0.5, 1.5);
  return placed(scene, positions, {4, 1, 3});
}

Simulation simulate(const Packing& packing, const EngineSettings& settings) {
  return {packing.cell, packing.scene, packing.state, settings};
}

State advanced(const Packing& packing, std::uint64_t steps, const Drive& drive) {
  Simulation simulation = simulate(packing);
  simulation.advance(drive, steps);
  return simulation.state();
}

double kinetic_energy(const State& state) {
  return 0.5 * state.velocity.squaredNorm() / static_cast<double>(state.velocity.cols());
}

double mean_energy(Simulation& simulation, int samples) {
  const Scene& scene = simulation.scene();
  double sum = 0;
  for (int n = 0; n < samples; ++n) {
    const State before = simulation.state();
    sum += scene.gravity * before.position.row(1).sum();
    for_each_contact(
        simulation.cell(), before.position, wall_pose(simulation.cell(), 0, before.wall_height),
        [&](const Contact& c) { sum += 0.5 * scene.stiffness * c.overlap * c.overlap; });
    simulation.advance(Drive{}, 1);
    sum += 0.25 * (before.velocity.squaredNorm() + simulation.state().velocity.squaredNorm());
    simulation.advance(Drive{}, 6);
  }
  return sum / samples;
}

Outcome expect_stop(const Packing& packing, std::uint64_t steps, const std::string& quantity) {
  Simulation simulation = simulate(packing);
  try {
    simulation.advance(Drive{}, steps);
  } catch (const NumericalFailure& failure) {
    return {failure.quantity.find(quantity) != std::string::npos,
            fmt::format("stopped at step {}: {} is {:.4g}, limit {:.4g}", failure.step,
                        failure.quantity, failure.value, failure.limit)};
  }
  return {false, fmt::format("not stopped in {} steps; kinetic energy per grain {:.3g}", steps,
                             kinetic_energy(simulation.state()))};
}

Outcome expect_near(const std::string& what, double got, double right, double tolerance) {
  const double off = std::fabs(got - right);
  return {off <= tolerance, fmt::format("{} {:.9g}, right {:.9g}, off by {:.2g} (of {:.2g})", what,
                                        got, right, off, tolerance)};
}

Outcome expect_at_most(const std::string& what, double got, double most) {
  return {got <= most, fmt::format("{} {:.2g} (at most {:.2g})", what, got, most)};
}

Outcome expect_as_all_pairs(const Packing& packing, const State& end, const Drive& drive,
                            double tolerance) {
  State right = packing.state;
  advance_all_pairs(packing.cell, packing.scene, drive, end.step - right.step, right);
  return expect_at_most("difference from the sum over all pairs", largest_difference(end, right),
                        tolerance);
}

Outcome expect_balance(const Packing& packing, const State& state, double most) {
  return expect_at_most("largest net force / P d^2",
                        force_residual(packing.cell, packing.scene, state), most);
}

Outcome all_of(const std::vector<Outcome>& parts) {
  Outcome whole{true, ""};
  for (const Outcome& part : parts) {
    whole.as_expected = whole.as_expected && part.as_expected;
    whole.text += (whole.text.empty() ? "" : "; ") + part.text;
  }
  return whole;
}

}  // namespace shearcell::stability
