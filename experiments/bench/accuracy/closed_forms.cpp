// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/accuracy/closed_forms.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace shearcell::accuracy {
namespace {

// Accelerations by contacts and gravity, over all pairs.
Eigen::Matrix3Xd forces(const Packing& box, const Eigen::Matrix3Xd& x) {
  const Eigen::Vector3d size(box.cell.width, box.cell.top, box.cell.depth);
  const double stiffness = box.scene.stiffness;
  Eigen::Matrix3Xd a = Eigen::Matrix3Xd::Zero(3, x.cols());
  a.row(1).array() -= box.scene.gravity;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    for (Eigen::Index j = i + 1; j < x.cols(); ++j) {
      Eigen::Vector3d dr = x.col(i) - x.col(j);
      dr.z() -= size.z() * std::nearbyint(dr.z() / size.z());
      const double r = dr.norm();
      if (r >= 1) continue;
      const Eigen::Vector3d push = stiffness * (1 / r - 1) * dr;
      a.col(i) += push;
      a.col(j) -= push;
    }
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      const double low = std::max(0.5 - x(axis, i), 0.0);
      const double high = std::max(0.5 - (size[axis] - x(axis, i)), 0.0);
      a(axis, i) += stiffness * (low - high);
    }
  }
  return a;
}

// Drifts x' = v and kicks v' = F(x) - b v at fixed x, each solved exactly.
void pefrl(const Packing& box, double dt, State& now) {
  constexpr double xi = 0.1786178958448091, lambda = -0.2123418310626054,
                   chi = -0.6626458266981849e-1;
  constexpr std::array kicks = {0.5 - lambda, lambda, lambda, 0.5 - lambda};
  constexpr std::array drifts = {chi, 1 - 2 * (chi + xi), chi, xi};
  const double b = box.scene.drag_rate;
  now.position += xi * dt * now.velocity;
  for (std::size_t n = 0; n < kicks.size(); ++n) {
    const double h = kicks[n] * dt;
    const double gain = b == 0 ? h : -std::expm1(-b * h) / b;
    now.velocity = std::exp(-b * h) * now.velocity + gain * forces(box, now.position);
    now.position += drifts[n] * dt * now.velocity;
  }
}

void runge_kutta(const Packing& box, double dt, State& now) {
  const auto rate = [&](const State& at) -> State {
    return {.position = at.velocity,
            .velocity = forces(box, at.position) - box.scene.drag_rate * at.velocity};
  };
  const auto moved = [&](const State& k, double h) -> State {
    return {.position = now.position + h * k.position, .velocity = now.velocity + h * k.velocity};
  };
  const State k1 = rate(now), k2 = rate(moved(k1, dt / 2)), k3 = rate(moved(k2, dt / 2)),
              k4 = rate(moved(k3, dt));
  now.position += dt / 6 * (k1.position + 2 * k2.position + 2 * k3.position + k4.position);
  now.velocity += dt / 6 * (k1.velocity + 2 * k2.velocity + 2 * k3.velocity + k4.velocity);
}

// Two grains collide head on: the root mean square error of the speed of separation over that of
// approach, u, over `phases` starts, spread evenly over one time step. While they touch, the
// overlap is
//   (u/w) exp(-b t/2m) sin(w t),   w^2 = 2 k/m - (b/2m)^2;
// before and after, drag slows them down exponentially.
double collision_error(const Scene& scene, const Method& method, double dt, int phases) {
  const double u = 10, b = scene.drag_rate;
  const double lasts = std::numbers::pi / std::sqrt(2 * scene.stiffness - b * b / 4);
  const Eigen::Vector3d n = Eigen::Vector3d(2, 3, 6) / 7;  // oblique to the axes
  const Eigen::Vector3d middle(10, 10, 10);
  Packing box = bench::placed(contacts_only(scene.stiffness), {middle, middle}, 2 * middle);
  box.scene.drag_rate = b;
  box.state.velocity.col(0) = u / 2 * n;
  box.state.velocity.col(1) = -u / 2 * n;
  double mean_square = 0;
  for (int phase = 0; phase < phases; ++phase) {
    // Far enough apart that half a step backwards is free of contact as well.
    const double gap = (2 + (phase + 0.5) / phases) * u * dt;
    box.state.position.col(0) = middle - (1 + gap) / 2 * n;
    box.state.position.col(1) = middle + (1 + gap) / 2 * n;
    const double touch_at = b == 0 ? gap / u : -std::log1p(-b * gap / u) / b;
    const double leave_at = touch_at + lasts,
                 leave_with = u * std::exp(-b * (touch_at + lasts / 2));
    const double steps = std::ceil((leave_at + contact_time(scene) / 2) / dt) + 2;
    const State end = integrate(box, method, dt, static_cast<std::uint64_t>(steps));
    const double t = dt * (method.step == nullptr ? steps - 0.5 : steps);
    const Eigen::Vector3d apart = end.position.col(1) - end.position.col(0);
    const double speed = (end.velocity.col(1) - end.velocity.col(0)).dot(apart.normalized());
    const double error = (speed - leave_with * std::exp(-b * (t - leave_at))) / u;
    mean_square += error * error / phases;
  }
  return std::sqrt(mean_square);
}

// One grain on the bottom plane under gravity, lifted by half of its overlap g/k, so that it stays
// in contact: the root mean square error of its position over the first `periods`, over its
// amplitude at the start. The motion is
//   y - y_0 = a exp(-b t/2m) (cos w t + b/(2 m w) sin w t),   w^2 = k/m - (b/2m)^2
double wall_error(const Scene& scene, const Method& method, double dt, double periods) {
  const double overlap = scene.gravity / scene.stiffness, decay = scene.drag_rate / 2;
  const Eigen::Vector3d rest(10, 0.5 - overlap, 10), amplitude(0, overlap / 2, 0);
  Packing box = bench::placed(contacts_only(scene.stiffness), {rest + amplitude}, {20, 20, 20});
  box.scene.drag_rate = scene.drag_rate;
  box.scene.gravity = scene.gravity;
  const double omega = std::sqrt(scene.stiffness - decay * decay);
  const auto steps =
      static_cast<std::uint64_t>(std::ceil(periods * 2 * std::numbers::pi / omega / dt));
  double squares = 0;
  integrate(box, method, dt, steps, [&](std::uint64_t n, const State& state) {
    const double t = dt * static_cast<double>(n);
    const double swing =
        std::exp(-decay * t) * (std::cos(omega * t) + decay / omega * std::sin(omega * t));
    squares += (state.position.col(0) - rest - swing * amplitude).squaredNorm();
  });
  return std::sqrt(squares / static_cast<double>(steps)) / amplitude.norm();
}

}  // namespace

Scene contacts_only(double stiffness) {
  Scene scene;
  scene.stiffness = stiffness;
  scene.wall_mass = 1e30;  // too heavy to move
  return scene;
}

const std::vector<Method>& methods() {
  static const std::vector<Method> all = {
      {"engine", 1, nullptr}, {"PEFRL", 4, pefrl}, {"Runge-Kutta", 4, runge_kutta}};
  return all;
}

State integrate(const Packing& box, const Method& method, double dt, std::uint64_t steps,
                const Visit& visit) {
  State now = box.state;
  const auto repeat = [&](auto&& step) {
    for (std::uint64_t n = 1; n <= steps; ++n) {
      step();
      if (visit) visit(n, now);
    }
    return now;
  };
  if (method.step != nullptr) return repeat([&] { method.step(box, dt, now); });
  runge_kutta(box, -dt / 2, now);
  Packing start = box;
  start.scene.time_step = dt;
  start.state.velocity = now.velocity;
  Simulation simulation = bench::simulate(start);
  return repeat([&] {
    simulation.advance(Drive{}, 1);
    now = simulation.state();
  });
}

double contact_time(const Scene& scene) {
  return std::numbers::pi / std::sqrt(2 * scene.stiffness);
}

std::vector<ClosedForm> closed_forms(const Scene& scene, bool quick) {
  const auto collision = [=](const Method& m, double dt) {
    return collision_error(scene, m, dt, quick ? 4 : 32);
  };
  const auto wall = [=](const Method& m, double dt) {
    return wall_error(scene, m, dt, quick ? 2 : 10);
  };
  return {{"collision-speed", "Two grains collide: speed after it", "speed_error", collision, true},
          {"wall", "One grain swings on a wall: position, in amplitudes", "position_error", wall}};
}

double fitted_order(const ClosedForm& form, const Method& method, double largest) {
  const int count = form.irregular ? 17 : 9;
  Eigen::VectorXd x(count), y(count);
  for (int n = 0; n < count; ++n) {
    const double dt = largest * std::exp2(-n / 4.0);
    x[n] = std::log(dt);
    y[n] = std::log(form.measure(method, dt));
  }
  x.array() -= x.mean();
  return x.dot(y) / x.squaredNorm();
}

}  // namespace shearcell::accuracy
