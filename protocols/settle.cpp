// SPDX-License-Identifier: GPL-3.0-or-later
#include "protocols/settle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/diagnostics.hpp"

namespace shearcell {
namespace {

constexpr std::uint64_t kChecksPerCheckpoint = 20;

std::uint64_t steps_in(double seconds, const Scene& scene) {
  return static_cast<std::uint64_t>(std::min(seconds / scene.time_step, kMostSteps));
}

}  // namespace

double pressing_time(const Scene& scene, double height, double per_area) {
  constexpr double dense_grains = 1.2;  // per d^3, at a packing fraction of 0.63
  const double way = std::max(0.0, height - per_area / dense_grains);
  const double speed = scene.pressure / (scene.wall_drag + scene.drag_rate * per_area);
  return way / speed + 0.5;
}

Settle::Settle(const SettleParameters& parameters, const Scene& scene)
    : parameters_(parameters),
      scene_(scene),
      check_steps_(std::max<std::uint64_t>(1, steps_in(kSettleCheckInterval, scene))),
      limit_steps_(std::max<std::uint64_t>(1, steps_in(parameters.time_limit, scene))) {}

std::uint64_t Settle::steps_without_gravity(const Cell& cell, std::size_t grains) const {
  return scene_.gravity == 0 ? 0 : compaction_steps(cell, grains);
}

std::uint64_t Settle::next_check(std::uint64_t step) const {
  return step + check_steps_ - step % check_steps_;
}

std::uint64_t Settle::compaction_steps(const Cell& cell, std::size_t grains) const {
  if (scene_.pressure == 0) return 0;
  const double per_area = static_cast<double>(grains) / (cell.width * cell.depth);
  const double time = pressing_time(scene_, cell.top - cell.bottom, per_area);
  const double checks = std::ceil(time / kSettleCheckInterval);
  return check_steps_ * static_cast<std::uint64_t>(
                            std::min(checks, parameters_.time_limit / kSettleCheckInterval));
}

State pressed(const Cell& cell, const State& loose, Scene scene) {
  scene.gravity = 0;
  Simulation simulation(cell, scene, loose);
  simulation.set_overlap_limit(kLargestOverlapLimit);
  const Settle unlimited({.time_limit = std::numeric_limits<double>::infinity()}, scene);
  simulation.advance(Drive{}, unlimited.compaction_steps(cell, simulation.grains()));
  State state = simulation.state();
  state.step = 0;
  return state;
}

bool Settle::settled(const Simulation& simulation) const {
  const State state = simulation.state();
  const double pressure = force_unit(scene_);
  const double kinetic =
      0.5 * state.velocity.squaredNorm() / static_cast<double>(state.velocity.cols());
  if (kinetic > parameters_.kinetic_tolerance * pressure) return false;
  if (std::fabs(state.wall_velocity) * scene_.wall_drag > parameters_.force_tolerance * pressure) {
    return false;
  }
  const WallPose pose = wall_pose(simulation.cell(), 0, state.wall_height);
  const Diagnostics facts = diagnose(simulation.cell(), scene_, state, pose);
  return std::fabs(facts.wall_imbalance) <= parameters_.force_tolerance;
}

bool Settle::finished(const Simulation& simulation) const {
  const std::uint64_t step = simulation.step();
  if (step % check_steps_ != 0) return false;
  const std::uint64_t pressed = steps_without_gravity(simulation.cell(), simulation.grains());
  if (step > pressed && settled(simulation)) return true;
  if (step < limit_steps_) return false;
  throw NumericalFailure(
      "the time [s] that the packing takes to settle", static_cast<double>(step) * scene_.time_step,
      parameters_.time_limit, -1, step,
      "Raise the limit (settle_time_limit_s) or the settling tolerances. Check that "
      "the pressure can lift the grains. Check that the drag (drag_kg_per_s) is "
      "large enough to stop the grains, but small enough to let the wall move");
}

StageProgress Settle::advance(Simulation& simulation, std::uint64_t most_steps) const {
  const std::uint64_t start = simulation.step();
  const bool compacting = start < compaction_steps(simulation.cell(), simulation.grains());
  simulation.set_overlap_limit(compacting
                                   ? std::max(parameters_.overlap_limit, kLargestOverlapLimit)
                                   : parameters_.overlap_limit);
  // A stage that was interrupted after its last state was recorded must not advance further.
  if (finished(simulation)) return {.checkpoint_due = true, .finished = true};

  Scene scene = scene_;
  if (start < steps_without_gravity(simulation.cell(), simulation.grains())) scene.gravity = 0;
  simulation.set_scene(scene);
  simulation.advance(Drive{}, std::min(most_steps, next_check(start) - start));
  const std::uint64_t step = simulation.step();
  if (step % check_steps_ == 0) simulation.check();
  const bool done = finished(simulation);
  return {.checkpoint_due = done || step % (kChecksPerCheckpoint * check_steps_) == 0,
          .finished = done};
}

}  // namespace shearcell
