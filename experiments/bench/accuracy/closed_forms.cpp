// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/accuracy/closed_forms.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shearcell::accuracy {
namespace {

// Separation of two grains that meet head on, and how fast it grows, at time t after they were
// `gap` from touching with the speed of approach u.
struct Meeting {
  double stiffness, drag, gap, u;

  double omega() const { return std::sqrt(2 * stiffness - drag * drag / 4); }
  double touches_at() const { return drag == 0 ? gap / u : -std::log1p(-drag * gap / u) / drag; }
  double leaves_at() const { return touches_at() + std::numbers::pi / omega(); }
  double leaving_speed() const {
    return u * std::exp(-drag * (touches_at() + std::numbers::pi / (2 * omega())));
  }
  double speed(double t) const { return leaving_speed() * std::exp(-drag * (t - leaves_at())); }
  double separation(double t) const {
    const double since = t - leaves_at();
    const double way = drag == 0 ? since : -std::expm1(-drag * since) / drag;
    return 1 + leaving_speed() * way;
  }
};

CollisionError one_collision(const Scene& scene, const Method& method, double dt, double phase) {
  const double u = 10, time = contact_time(scene);
  // Far enough apart that a step backwards is free as well.
  const Meeting exact{scene.stiffness, scene.drag_rate, (2 + phase) * u * dt, u};
  Box box = box_of(scene, {20, 20, 20});
  box.gravity = 0;
  Motion start{Eigen::Matrix3Xd(3, 2), Eigen::Matrix3Xd::Zero(3, 2)};
  // Oblique, so that no direction of the grid is special.
  const Eigen::Vector3d n = Eigen::Vector3d(2, 3, 6) / 7;
  const Eigen::Vector3d middle(10, 10, 10);
  start.position.col(0) = middle - (1 + exact.gap) / 2 * n;
  start.position.col(1) = middle + (1 + exact.gap) / 2 * n;
  start.velocity.col(0) = u / 2 * n;
  start.velocity.col(1) = -u / 2 * n;
  const auto steps = static_cast<std::uint64_t>(std::ceil((exact.leaves_at() + time / 2) / dt)) + 2;
  CollisionError error;
  integrate(box, method, start, dt, steps, steps, [&](std::uint64_t n_steps, const Motion& m) {
    const double t = dt * static_cast<double>(n_steps);
    const double t_velocity = method.staggered ? t - dt / 2 : t;
    const Eigen::Vector3d apart = m.position.col(1) - m.position.col(0);
    const Eigen::Vector3d rate = m.velocity.col(1) - m.velocity.col(0);
    const double speed_error = rate.dot(apart.normalized()) - exact.speed(t_velocity);
    const double way_error = apart.norm() - exact.separation(t);
    error.speed = speed_error / u;
    // What the wrong speed does not explain of the separation comes from the wrong time.
    error.time = (speed_error * (t - exact.leaves_at()) - way_error) / exact.leaving_speed() / time;
  });
  return error;
}

// Of a grain that springs bind to `rest`, n springs in each of the given directions.
double oscillation_error(const Box& box, const Eigen::Vector3d& rest, const Eigen::Vector3d& start,
                         double springs, const Method& method, double dt, double periods) {
  const double decay = box.drag_rate / 2;
  const double omega = std::sqrt(springs * box.stiffness - decay * decay);
  const auto steps =
      static_cast<std::uint64_t>(std::ceil(periods * 2 * std::numbers::pi / omega / dt));
  const Eigen::Vector3d amplitude = start - rest;
  double squares = 0;
  integrate(box, method, {start, Eigen::Vector3d::Zero()}, dt, steps, 1,
            [&](std::uint64_t n, const Motion& m) {
              const double t = dt * static_cast<double>(n);
              const double swing = std::exp(-decay * t) *
                                   (std::cos(omega * t) + decay / omega * std::sin(omega * t));
              const Eigen::Vector3d exact = rest + swing * amplitude;
              squares += (m.position.col(0) - exact).squaredNorm();
            });
  return std::sqrt(squares / static_cast<double>(steps)) / amplitude.norm();
}

}  // namespace

double contact_time(const Scene& scene) {
  return std::numbers::pi / std::sqrt(2 * scene.stiffness);
}

CollisionError collision_error(const Scene& scene, const Method& method, double dt, int phases) {
  CollisionError mean;
  for (int p = 0; p < phases; ++p) {
    const CollisionError one = one_collision(scene, method, dt, (p + 0.5) / phases);
    mean.speed += one.speed * one.speed / phases;
    mean.time += one.time * one.time / phases;
  }
  return {std::sqrt(mean.speed), std::sqrt(mean.time)};
}

double wall_error(const Scene& scene, const Method& method, double dt, double periods) {
  const Box box = box_of(scene, {20, 20, 20});
  const double overlap = scene.gravity / scene.stiffness;
  return oscillation_error(box, {10, 0.5 - overlap, 10}, {10, 0.5 - overlap / 2, 10}, 1, method, dt,
                           periods);
}

double cage_error(const Scene& scene, const Method& method, double dt, double periods) {
  Box box = box_of(scene, {0.98, 0.98, 20});
  box.gravity = 0;
  return oscillation_error(box, {0.49, 0.49, 10}, {0.495, 0.485, 10}, 2, method, dt, periods);
}

}  // namespace shearcell::accuracy
