// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/stability/scenes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/diagnostics.hpp"
#include "core/minimizer.hpp"
#include "experiments/manifest/conversion.hpp"
#include "protocols/settle.hpp"

namespace shearcell::stability {

Scene table_1() {
  return shear_scene(Parameters{});
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

Cell smooth_cell(double width, double height, double depth) {
  Cell cell;
  cell.width = width;
  cell.depth = depth;
  cell.top = height;
  return cell;
}

State at_rest(const Cell& cell, const std::vector<Eigen::Vector3d>& positions) {
  State state;
  const auto n = static_cast<Eigen::Index>(positions.size());
  state.position.resize(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    state.position.col(i) = positions[static_cast<std::size_t>(i)];
  }
  state.velocity = Eigen::Matrix3Xd::Zero(3, n);
  state.wall_height = cell.moving == MovingWall::bottom ? cell.bottom : cell.top;
  return state;
}

const Packing& settled_packing() {
  static const Packing packing = [] {
    Parameters parameters;
    parameters.grains = 60;
    Packing made{make_cell(geometry(parameters), 1), settle_scene(parameters), {}};
    made.state = fill_cell(made.cell, geometry(parameters), 1);
    const Settle settle({}, made.scene);
    Simulation simulation(made.cell, made.scene, made.state);
    while (!settle.advance(simulation, ~std::uint64_t{0}).finished) {
    }
    simulation.advance(Drive{}, 20000);  // two tolerances further
    made.state = simulation.state();
    made.state.step = 0;
    return made;
  }();
  return packing;
}

Packing crystal(int layers, double overlap, int along, bool vacancy) {
  const double spacing = 1 - overlap;
  const double rise = spacing / std::numbers::sqrt2;
  std::vector<Eigen::Vector3d> positions;
  const double end = 0.5 - overlap;
  for (int layer = 0; layer < layers; ++layer) {
    const int shift = layer % 2;  // every other layer sits in the hollows of its neighbours
    for (int column = 0; column < along - shift; ++column) {
      for (int k = 0; k < along; ++k) {
        positions.emplace_back(end + spacing * (column + 0.5 * shift), end + rise * layer,
                               spacing * (k + 0.5 * shift));
      }
    }
  }
  Packing made{
      smooth_cell(2 * end + spacing * (along - 1), 2 * end + rise * (layers - 1), spacing * along),
      only_springs(),
      {}};
  if (vacancy) {
    const Eigen::Vector3d middle(0.5 * made.cell.width, 0.5 * made.cell.top, 0.5 * made.cell.depth);
    positions.erase(std::min_element(
        positions.begin(), positions.end(),
        [&](const auto& a, const auto& b) { return (a - middle).norm() < (b - middle).norm(); }));
  }
  // Each grain of the lowest layer is pressed onto the wall with k times the overlap.
  made.scene.pressure = made.scene.stiffness * overlap / (spacing * spacing);
  made.scene.wall_mass = 10;
  Simulation simulation(made.cell, made.scene, at_rest(made.cell, positions));
  minimize_enthalpy(simulation, {.force_tolerance = 1e-9});
  made.state = simulation.state();
  made.state.step = 0;
  return made;
}

Packing row_between_walls(int count, const Scene& scene) {
  Packing made{smooth_cell(4, 1, 3), scene, {}};
  std::vector<Eigen::Vector3d> positions;
  for (int i = 0; i < count; ++i) positions.emplace_back(0.7 + 1.2 * i, 0.5, 1.5);
  made.state = at_rest(made.cell, positions);
  return made;
}

EngineSettings any_time_step() {
  EngineSettings settings;
  settings.limits.time_step = 1e9;
  return settings;
}

std::optional<NumericalFailure> advance_or_stop(Simulation& simulation, const Drive& drive,
                                                std::uint64_t steps) {
  try {
    simulation.advance(drive, steps);
  } catch (const NumericalFailure& failure) {
    return failure;
  }
  return std::nullopt;
}

std::string words(const NumericalFailure& failure) {
  return fmt::format("stopped at step {}: {} is {:.4g}, limit {:.4g}", failure.step,
                     failure.quantity, failure.value, failure.limit);
}

Outcome expect_stop(Simulation& simulation, const Drive& drive, std::uint64_t steps,
                    const std::string& quantity) {
  const auto failure = advance_or_stop(simulation, drive, steps);
  if (!failure) {
    return {false, fmt::format("not stopped in {} steps; kinetic energy per grain {:.3g}", steps,
                               kinetic_energy(simulation.state()))};
  }
  return {failure->quantity.find(quantity) != std::string::npos, words(*failure)};
}

Outcome expect_near(const std::string& what, double got, double right, double tolerance) {
  const double off = std::fabs(got - right);
  return {off <= tolerance, fmt::format("{} {:.9g}, right {:.9g}, off by {:.2g} (of {:.2g})", what,
                                        got, right, off, tolerance)};
}

Outcome expect_at_most(const std::string& what, double got, double most) {
  return {got <= most, fmt::format("{} {:.2g} (at most {:.2g})", what, got, most)};
}

Outcome all_of(const std::vector<Outcome>& parts) {
  Outcome whole{true, ""};
  for (const Outcome& part : parts) {
    whole.as_expected = whole.as_expected && part.as_expected;
    whole.text += (whole.text.empty() ? "" : "; ") + part.text;
  }
  return whole;
}

Outcome all_of(std::initializer_list<Outcome> parts) {
  return all_of(std::vector<Outcome>(parts));
}

double kinetic_energy(const State& state) {
  return 0.5 * state.velocity.squaredNorm() / static_cast<double>(state.velocity.cols());
}

double total_energy(Simulation& simulation) {
  const State before = simulation.state();
  const Scene& scene = simulation.scene();
  double potential = scene.gravity * before.position.row(1).sum();
  for_each_contact(
      simulation.cell(), before.position, wall_pose(simulation.cell(), 0, before.wall_height),
      [&](const Contact& c) { potential += 0.5 * scene.stiffness * c.overlap * c.overlap; });
  simulation.advance(Drive{}, 1);
  const State after = simulation.state();
  return potential + 0.25 * (before.velocity.squaredNorm() + after.velocity.squaredNorm());
}

double mean_energy(Simulation& simulation, int looks) {
  double sum = 0;
  for (int n = 0; n < looks; ++n) {
    sum += total_energy(simulation);
    simulation.advance(Drive{}, 6);
  }
  return sum / looks;
}

}  // namespace shearcell::stability
