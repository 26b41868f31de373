// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/accuracy/integrate.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/simulation.hpp"

namespace shearcell::accuracy {
namespace {

// Accelerations by contacts and gravity, over all pairs.
Eigen::Matrix3Xd forces(const Box& box, const Eigen::Matrix3Xd& x) {
  Eigen::Matrix3Xd a = Eigen::Matrix3Xd::Zero(3, x.cols());
  a.row(1).array() -= box.gravity;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    for (Eigen::Index j = i + 1; j < x.cols(); ++j) {
      Eigen::Vector3d dr = x.col(i) - x.col(j);
      dr.z() -= box.size.z() * std::nearbyint(dr.z() / box.size.z());
      const double r = dr.norm();
      if (r >= 1) continue;
      const Eigen::Vector3d push = box.stiffness * (1 / r - 1) * dr;
      a.col(i) += push;
      a.col(j) -= push;
    }
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      const double low = std::max(0.5 - x(axis, i), 0.0);
      const double high = std::max(0.5 - (box.size[axis] - x(axis, i)), 0.0);
      a(axis, i) += box.stiffness * (low - high);
    }
  }
  return a;
}

// Drifts x' = v and kicks v' = F(x) - b v at fixed x, each solved exactly.
class Pefrl {
 public:
  Pefrl(const Box& box, const Motion& start, double dt) : box_(box), dt_(dt), now_(start) {}

  void step() {
    constexpr double xi = 0.1786178958448091, lambda = -0.2123418310626054,
                     chi = -0.6626458266981849e-1;
    constexpr std::array kicks = {0.5 - lambda, lambda, lambda, 0.5 - lambda};
    constexpr std::array drifts = {chi, 1 - 2 * (chi + xi), chi, xi};
    now_.position += xi * dt_ * now_.velocity;
    for (std::size_t n = 0; n < kicks.size(); ++n) {
      kick(kicks[n] * dt_);
      now_.position += drifts[n] * dt_ * now_.velocity;
    }
  }
  const Motion& motion() const { return now_; }

 private:
  void kick(double h) {
    const double b = box_.drag_rate;
    const double gain = b == 0 ? h : -std::expm1(-b * h) / b;
    now_.velocity = std::exp(-b * h) * now_.velocity + gain * forces(box_, now_.position);
  }

  Box box_;
  double dt_;
  Motion now_;
};

class RungeKutta {
 public:
  RungeKutta(const Box& box, const Motion& start, double dt) : box_(box), dt_(dt), now_(start) {}

  void step() {
    const Motion k1 = rate(now_), k2 = rate(moved(k1, dt_ / 2)), k3 = rate(moved(k2, dt_ / 2)),
                 k4 = rate(moved(k3, dt_));
    now_.position += dt_ / 6 * (k1.position + 2 * k2.position + 2 * k3.position + k4.position);
    now_.velocity += dt_ / 6 * (k1.velocity + 2 * k2.velocity + 2 * k3.velocity + k4.velocity);
  }
  const Motion& motion() const { return now_; }

 private:
  Motion moved(const Motion& rate, double h) const {
    return {now_.position + h * rate.position, now_.velocity + h * rate.velocity};
  }
  Motion rate(const Motion& at) const {
    return {at.velocity, forces(box_, at.position) - box_.drag_rate * at.velocity};
  }

  Box box_;
  double dt_;
  Motion now_;
};

// Between walls at rest: the moving one is too heavy to move.
class Engine {
 public:
  Engine(const Box& box, const Motion& start, double dt) : simulation_(make(box, start, dt)) {}
  void step() { simulation_.advance(Drive{}, 1); }
  Motion motion() const {
    const State now = simulation_.state();
    return {now.position, now.velocity};
  }

 private:
  static Simulation make(const Box& box, const Motion& start, double dt) {
    Cell cell;
    cell.width = box.size.x();
    cell.top = box.size.y();
    cell.depth = box.size.z();
    Scene scene;
    scene.stiffness = box.stiffness;
    scene.drag_rate = box.drag_rate;
    scene.gravity = box.gravity;
    scene.wall_mass = 1e30;
    scene.time_step = dt;
    State state;
    state.position = start.position;
    state.velocity = start.velocity;
    return {cell, scene, state};
  }
  Simulation simulation_;
};

template <class Integrator>
void run(Integrator integrator, std::uint64_t steps, std::uint64_t every, const Visit& visit) {
  for (std::uint64_t n = 1; n <= steps; ++n) {
    integrator.step();
    if (n % every == 0) visit(n, integrator.motion());
  }
}

}  // namespace

const std::vector<Method>& methods() {
  static const std::vector<Method> all = {{"engine", Method::Kind::engine, 1, 2, true},
                                          {"PEFRL", Method::Kind::pefrl, 4, 4},
                                          {"Runge-Kutta", Method::Kind::runge_kutta, 4, 4}};
  return all;
}

void integrate(const Box& box, const Method& method, const Motion& start, double dt,
               std::uint64_t steps, std::uint64_t every, const Visit& visit) {
  Motion first = start;
  if (method.staggered) {
    RungeKutta back(box, start, -dt / 2);
    back.step();
    first.velocity = back.motion().velocity;
  }
  switch (method.kind) {
    case Method::Kind::engine:
      return run(Engine(box, first, dt), steps, every, visit);
    case Method::Kind::pefrl:
      return run(Pefrl(box, first, dt), steps, every, visit);
    case Method::Kind::runge_kutta:
      return run(RungeKutta(box, first, dt), steps, every, visit);
  }
}

}  // namespace shearcell::accuracy
