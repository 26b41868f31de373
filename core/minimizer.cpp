// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/minimizer.hpp"

#include <algorithm>
#include <cmath>

#include "core/diagnostics.hpp"

namespace shearcell {
namespace {

// Constants of FIRE, as recommended by Guenole et al. Time steps are in units of sqrt(m/k). In
// these units, the fastest mode of a contact network allows a time step of 2/sqrt(8) = 0.71.
constexpr double kFirstStep = 0.1, kLargestStep = 0.5, kSmallestStep = 0.002;
constexpr double kGrow = 1.1, kShrink = 0.5;
constexpr double kMixing = 0.25, kMixingShrink = 0.99;
constexpr int kDelay = 20;
// Moving wall's mass per d^2 [grain masses]. With this mass, the wall is about as fast as a grain.
constexpr double kWallMass = 1;
constexpr std::uint64_t kWatchInterval = 256;

double residual_of(const Forces& forces, const Cell& cell, const Scene& scene) {
  double largest = 0;
  for (Eigen::Index i = 0; i < forces.on_grain.cols(); ++i) {
    const double* f = forces.on_grain.data() + 3 * i;
    largest = std::max(largest, f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
  }
  const double wall = std::fabs(forces.on_wall) / (cell.width * cell.depth);
  return std::max(std::sqrt(largest), wall) / force_unit(scene);
}

// Sums of f v, v^2 and f^2 over the grains and the moving wall. The wall's v^2 is multiplied by its
// mass, and its f^2 is divided by its mass. Plain loops over the ids fix the order of the
// additions, so every machine computes the same bits.
struct Sums {
  double power, velocity, force;
};

Sums sums(const Forces& forces, const State& state, double wall_mass) {
  Sums s{forces.on_wall * state.wall_velocity,
         wall_mass * state.wall_velocity * state.wall_velocity,
         forces.on_wall * forces.on_wall / wall_mass};
  const double* f = forces.on_grain.data();
  const double* v = state.velocity.data();
  for (Eigen::Index n = 0; n < state.velocity.size(); n += 3) {
    s.power += f[n] * v[n] + f[n + 1] * v[n + 1] + f[n + 2] * v[n + 2];
    s.velocity += v[n] * v[n] + v[n + 1] * v[n + 1] + v[n + 2] * v[n + 2];
    s.force += f[n] * f[n] + f[n + 1] * f[n + 1] + f[n + 2] * f[n + 2];
  }
  return s;
}

// One FIRE minimization. `state_` holds the velocities of FIRE, which are not physical velocities.
class Fire {
 public:
  explicit Fire(const Simulation& simulation)
      : state_(simulation.state()),
        unit_(1 / std::sqrt(simulation.scene().stiffness)),
        wall_mass_(kWallMass * simulation.cell().width * simulation.cell().depth) {
    rest();
  }

  const State& state() const { return state_; }

  void rest() {
    state_.velocity.setZero();
    state_.wall_velocity = 0;
  }

  void step(const Forces& forces) {
    if (sums(forces, state_, wall_mass_).power > 0) {
      if (++downhill_ > kDelay) {
        dt_ = std::min(kGrow * dt_, kLargestStep);
        mixing_ *= kMixingShrink;
      }
    } else {
      if (++uphill_ > 1) dt_ = std::max(kShrink * dt_, kSmallestStep);
      downhill_ = 0;
      mixing_ = kMixing;
      move(-0.5 * dt_ * unit_);  // go back half a step, because the minimum was passed
      rest();
    }
    const double dt = dt_ * unit_;
    state_.velocity += dt * forces.on_grain;
    state_.wall_velocity += dt * (forces.on_wall / wall_mass_);
    mix(forces);
    move(dt);
  }

 private:
  void move(double dt) {
    state_.position += dt * state_.velocity;
    state_.wall_height += dt * state_.wall_velocity;
  }

  // Mixes the velocity with a vector of the same norm in the direction of the force.
  void mix(const Forces& forces) {
    const Sums s = sums(forces, state_, wall_mass_);
    if (!(s.force > 0)) return;
    const double turn = mixing_ * std::sqrt(s.velocity / s.force);
    state_.velocity = (1 - mixing_) * state_.velocity + turn * forces.on_grain;
    state_.wall_velocity =
        (1 - mixing_) * state_.wall_velocity + turn * (forces.on_wall / wall_mass_);
  }

  State state_;
  double unit_, wall_mass_;
  double dt_ = kFirstStep, mixing_ = kMixing;
  int downhill_ = 0, uphill_ = 0;
};

}  // namespace

void minimize_enthalpy(Simulation& simulation, const MinimizeSettings& settings) {
  const Cell& cell = simulation.cell();
  const Scene& scene = simulation.scene();
  Fire fire(simulation);
  for (std::uint64_t evaluations = 1;; ++evaluations) {
    simulation.set_state(fire.state());
    const Forces& forces = simulation.forces();
    const double residual = residual_of(forces, cell, scene);
    if (residual <= settings.force_tolerance) break;
    if (evaluations % kWatchInterval == 0) simulation.check();
    if (evaluations >= settings.most_evaluations) {
      throw NumericalFailure("the largest net force [P d^2] after the last step of a minimization",
                             residual, settings.force_tolerance, -1, simulation.step(),
                             "Raise minimize_force_tolerance, or raise the stiffness in smaller "
                             "steps (stiffness_steps_per_decade)");
    }
    fire.step(forces);
  }
  fire.rest();
  State end = fire.state();
  ++end.step;
  simulation.set_state(end);
  simulation.check();
}

double force_residual(const Cell& cell, const Scene& scene, const State& state) {
  const WallPose pose = wall_pose(cell, 0, state.wall_height);
  const WallSide moving = moving_side(cell);
  Forces forces;
  forces.on_grain = Eigen::Matrix3Xd::Zero(3, state.position.cols());
  forces.on_grain.row(1).setConstant(-scene.gravity);
  const auto grains = static_cast<std::size_t>(state.position.cols());
  forces.on_wall = inwards(cell) *
                   (scene.pressure * cell.width * cell.depth + carried_weight(scene, cell, grains));
  for_each_contact(cell, state.position, pose, [&](const Contact& c) {
    const Eigen::Vector3d force = scene.stiffness * c.overlap * c.normal;
    forces.on_grain.col(c.grain) += force;
    if (c.kind == Contact::Kind::grain) {
      forces.on_grain.col(c.other) -= force;
    } else if (c.side == moving) {
      forces.on_wall -= force.y();
    }
  });
  return residual_of(forces, cell, scene);
}

}  // namespace shearcell
