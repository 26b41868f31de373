// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/accuracy/closed_forms.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shearcell::accuracy {
namespace {

// Two grains collide head on. While they touch, the overlap is
//   (u/w) exp(-b t/2m) sin(w t),   w^2 = 2 k/m - (b/2m)^2,
// with u their speed of approach; before and after, drag slows them down exponentially. At t = 0
// they are `gap` from touching.
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

struct CollisionError {
  double speed = 0;  // of separation after it, over the speed of approach
  double time = 0;   // of its end, over the contact time
};

CollisionError one_collision(const Scene& scene, const Method& method, double dt, double phase) {
  const double u = 10, time = contact_time(scene);
  // Far enough apart that half a step backwards is free of contact as well.
  const Meeting exact{scene.stiffness, scene.drag_rate, (2 + phase) * u * dt, u};
  const Box box{{20, 20, 20}, scene.stiffness, scene.drag_rate};
  Motion start{Eigen::Matrix3Xd(3, 2), Eigen::Matrix3Xd::Zero(3, 2)};
  // Oblique to the axes.
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
    // The part of the separation's error that the speed does not explain is an error of time.
    error.time = (speed_error * (t - exact.leaves_at()) - way_error) / exact.leaving_speed() / time;
  });
  return error;
}

// Of a grain bound to `rest` by n springs in each direction, a damped harmonic motion:
//   x - x_0 = a exp(-b t/2m) (cos w t + b/(2 m w) sin w t),   w^2 = n k/m - (b/2m)^2
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

// Root mean square over `phases` starts, spread evenly over one time step.
CollisionError collision_error(const Scene& scene, const Method& method, double dt, int phases) {
  CollisionError mean;
  for (int p = 0; p < phases; ++p) {
    const CollisionError one = one_collision(scene, method, dt, (p + 0.5) / phases);
    mean.speed += one.speed * one.speed / phases;
    mean.time += one.time * one.time / phases;
  }
  return {std::sqrt(mean.speed), std::sqrt(mean.time)};
}

// Root mean square error of the position over the first `periods` of an oscillation, over its
// amplitude at the start. One grain on the bottom plane under gravity, lifted by half of its
// overlap g/k, so that it stays in contact.
double wall_error(const Scene& scene, const Method& method, double dt, double periods) {
  const Box box{{20, 20, 20}, scene.stiffness, scene.drag_rate, scene.gravity};
  const double overlap = scene.gravity / scene.stiffness;
  return oscillation_error(box, {10, 0.5 - overlap, 10}, {10, 0.5 - overlap / 2, 10}, 1, method, dt,
                           periods);
}

// One grain between four planes 1 - 0.02 d apart, released 0.005 d off the middle in x and y.
double cage_error(const Scene& scene, const Method& method, double dt, double periods) {
  return oscillation_error({{0.98, 0.98, 20}, scene.stiffness, scene.drag_rate}, {0.49, 0.49, 10},
                           {0.495, 0.485, 10}, 2, method, dt, periods);
}

}  // namespace

double contact_time(const Scene& scene) {
  return std::numbers::pi / std::sqrt(2 * scene.stiffness);
}

double row_frequency(const Scene& scene, int grains, int n) {
  return 2 * std::sqrt(scene.stiffness) * std::sin(std::numbers::pi * n / grains);
}

double found_row_frequency(const Scene& scene, const Method& method, double dt, int grains, int n,
                           std::uint64_t steps) {
  constexpr double overlap = 0.003, amplitude = 1e-6;
  constexpr double across = 1 - 2 * overlap;  // the planes of the duct hold each grain as deep
  const Box box{{across, across, grains * (1 - overlap)}, scene.stiffness};
  Eigen::Matrix3Xd rest(3, grains);
  Eigen::RowVectorXd wave(grains);
  for (int i = 0; i < grains; ++i) {
    rest.col(i) << across / 2, across / 2, i * (1 - overlap);
    wave[i] = std::cos(2 * std::numbers::pi * n * i / grains);
  }
  wave.normalize();
  Motion start{rest, Eigen::Matrix3Xd::Zero(3, grains)};
  start.position.row(2) += amplitude * wave;
  std::vector<double> x;
  integrate(box, method, start, dt, steps, 1, [&](std::uint64_t, const Motion& m) {
    x.push_back(wave.dot(m.position.row(2) - rest.row(2)));
  });
  double both = 0, square = 0;  // cos(w dt) = sum x_k (x_(k+1) + x_(k-1)) / (2 sum x_k^2)
  for (std::size_t k = 1; k + 1 < x.size(); ++k) {
    both += x[k] * (x[k + 1] + x[k - 1]);
    square += x[k] * x[k];
  }
  return std::acos(std::clamp(both / (2 * square), -1.0, 1.0)) / dt;
}

std::vector<ClosedForm> closed_forms(const Scene& scene, const Thoroughness& how) {
  return {
      {"collision-speed", "Two grains collide: speed after it", "speed_error",
       [=](const Method& m, double dt) { return collision_error(scene, m, dt, how.phases).speed; },
       true},
      {"collision-end", "Two grains collide: when it ends, in contact times", "time_error",
       [=](const Method& m, double dt) { return collision_error(scene, m, dt, how.phases).time; },
       true},
      {"wall", "One grain swings on a wall: position, in amplitudes", "position_error",
       [=](const Method& m, double dt) { return wall_error(scene, m, dt, how.periods); }},
      {"cage", "One grain swings in a cage: position, in amplitudes", "position_error",
       [=](const Method& m, double dt) { return cage_error(scene, m, dt, how.periods); }},
      {"row", "Waves in a row of grains: worst of their frequencies", "frequency_error",
       [=](const Method& m, double dt) {
         double worst = 0;
         for (int n = 1; n <= how.waves; ++n) {
           const double found = found_row_frequency(scene, m, dt, 2 * how.waves, n, how.wave_steps);
           const double exact = row_frequency(scene, 2 * how.waves, n);
           worst = std::max(worst, std::fabs(found / exact - 1));
         }
         return worst;
       }},
  };
}

double fitted_order(const std::function<double(double dt)>& error, double largest, int count) {
  Eigen::VectorXd x(count), y(count);
  for (int n = 0; n < count; ++n) {
    const double dt = largest * std::exp2(-n / 4.0);
    x[n] = std::log(dt);
    y[n] = std::log(error(dt));
  }
  x.array() -= x.mean();
  return x.dot(y) / x.squaredNorm();
}

}  // namespace shearcell::accuracy
