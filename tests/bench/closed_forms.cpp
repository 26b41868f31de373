// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/closed_forms.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "tests/support/all_pairs.hpp"

namespace shearcell::test {
namespace {

using std::numbers::pi;

// Contacts alone: no drag, gravity or pressure, and a moving wall too heavy to move.
Scene contacts_only(double stiffness) {
  Scene scene;
  scene.stiffness = stiffness;
  scene.wall_mass = 1e30;
  return scene;
}

// Accelerations by contacts and gravity.
Eigen::Matrix3Xd forces(const Packing& box, const Eigen::Matrix3Xd& x) {
  const WallPose pose = wall_pose(box.cell, 0, box.state.wall_height);
  Eigen::Matrix3Xd a = box.scene.stiffness * pushes_over_all_pairs(box.cell, pose, x).on_grain;
  a.row(1).array() -= box.scene.gravity;
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

// Called with the number of steps done and the state after them.
using Visit = std::function<void(std::uint64_t step, const State& state)>;

// The state after `steps` time steps of `dt` from that of `box`, whose positions and velocities are
// of one instant; visits each step. The engine gets its first velocity from a Runge-Kutta step of
// -dt/2. Throws NumericalFailure as the engine does.
State integrate(const Packing& box, const Method& method, double dt, std::uint64_t steps,
                const Visit& visit = {}) {
  State now = box.state;
  if (method.step != nullptr) {
    for (std::uint64_t n = 1; n <= steps; ++n) {
      method.step(box, dt, now);
      if (visit) visit(n, now);
    }
    return now;
  }
  runge_kutta(box, -dt / 2, now);
  Packing start = box;
  start.scene.time_step = dt;
  start.state.velocity = now.velocity;
  Simulation simulation = bench::simulate(start);
  if (!visit) simulation.advance(Drive{}, steps);
  for (std::uint64_t n = 1; visit && n <= steps; ++n) {
    simulation.advance(Drive{}, 1);
    visit(n, simulation.state());
  }
  return simulation.state();
}

// One grain on the bottom plane under gravity, lifted by half of its overlap g/k, so that it stays
// in contact: the root mean square error of its position over the first `periods`, over its
// amplitude at the start. The motion is
//   y - y_0 = a exp(-b t/2m) (cos w t + b/(2 m w) sin w t),   w^2 = k/m - (b/2m)^2
double wall_error(const Scene& scene, const Method& method, double dt, double periods) {
  const double overlap = scene.gravity / scene.stiffness, decay = scene.drag_rate / 2;
  const Eigen::Vector3d rest(10, 0.5 - overlap, 10), amplitude(0, overlap / 2, 0);
  Packing box = placed(contacts_only(scene.stiffness), {rest + amplitude}, {20, 20, 20});
  box.scene.drag_rate = scene.drag_rate;
  box.scene.gravity = scene.gravity;
  const double omega = std::sqrt(scene.stiffness - decay * decay);
  const auto steps = static_cast<std::uint64_t>(std::ceil(periods * 2 * pi / omega / dt));
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

const std::vector<Method>& methods() {
  static const std::vector<Method> all = {
      {"engine", 1, nullptr}, {"PEFRL", 4, pefrl}, {"Runge-Kutta", 4, runge_kutta}};
  return all;
}

double contact_time(const Scene& scene) {
  return pi / std::sqrt(2 * scene.stiffness - scene.drag_rate * scene.drag_rate / 4);
}

// While the grains touch, the overlap is
//   (u/w) exp(-b t/2m) sin(w t),   w^2 = 2 k/m - (b/2m)^2;
// before and after, drag slows them down exponentially. The stiffness sets the contact time, and so
// the part of a step in which a contact ends. Both parts are those of a golden lattice, which fills
// the square evenly.
Collision collide(const Scene& scene, const Method& method, double dt, int samples) {
  const double u = 10, b = scene.drag_rate;
  const Eigen::Vector3d n = Eigen::Vector3d(2, 3, 6) / 7;  // oblique to the axes
  const Eigen::Vector3d middle(10, 10, 10);
  Collision mean;
  for (int k = 0; k < samples; ++k) {
    const double begins = (k + 0.5) / samples;
    const double ends = std::fmod((k + 0.5) * (std::numbers::phi - 1), 1);
    const double lasts = contact_time(scene) + (ends - 0.5) * dt;
    const double omega = pi / lasts;
    Packing box =
        placed(contacts_only((omega * omega + b * b / 4) / 2), {middle, middle}, 2 * middle);
    box.scene.drag_rate = b;
    box.state.velocity.col(0) = u / 2 * n;
    box.state.velocity.col(1) = -u / 2 * n;
    // Far enough apart that half a step backwards is free of contact as well.
    const double gap = (2 + begins) * u * dt;
    box.state.position.col(0) = middle - (1 + gap) / 2 * n;
    box.state.position.col(1) = middle + (1 + gap) / 2 * n;
    const double touch_at = b == 0 ? gap / u : -std::log1p(-b * gap / u) / b;
    const double leave_at = touch_at + lasts,
                 leave_with = u * std::exp(-b * (touch_at + lasts / 2));
    const double steps = std::ceil((leave_at + lasts / 2) / dt) + 2;
    const State end = integrate(box, method, dt, static_cast<std::uint64_t>(steps));
    const double t = dt * (method.step == nullptr ? steps - 0.5 : steps);
    const Eigen::Vector3d apart = end.position.col(1) - end.position.col(0);
    const double speed = (end.velocity.col(1) - end.velocity.col(0)).dot(apart.normalized());
    const double right = leave_with * std::exp(-b * (t - leave_at));
    mean.speed_error += std::pow((speed - right) / u, 2) / samples;
    mean.energy_change += ((speed / right) * (speed / right) - 1) / samples;
  }
  mean.speed_error = std::sqrt(mean.speed_error);
  return mean;
}

double row_frequency(const Scene& scene, const Method& method, double dt, int grains, int n) {
  constexpr double overlap = 0.003, amplitude = 1e-6, seconds = 0.02;
  constexpr double across = 1 - 2 * overlap;  // the planes of the duct hold each grain as deep
  Eigen::Matrix3Xd rest(3, grains);
  Eigen::RowVectorXd wave(grains);
  for (int i = 0; i < grains; ++i) {
    rest.col(i) << across / 2, across / 2, i * (1 - overlap);
    wave[i] = std::cos(2 * pi * n * i / grains);
  }
  wave.normalize();
  Packing box =
      placed(contacts_only(scene.stiffness), {}, {across, across, grains * (1 - overlap)});
  box.state.position = rest;
  box.state.position.row(2) += amplitude * wave;
  box.state.velocity = Eigen::Matrix3Xd::Zero(3, grains);
  std::vector<double> x;
  integrate(box, method, dt, static_cast<std::uint64_t>(seconds / dt),
            [&](std::uint64_t, const State& state) {
              x.push_back(wave.dot(state.position.row(2) - rest.row(2)));
            });
  double both = 0, square = 0;  // cos(w dt) = sum x_k (x_(k+1) + x_(k-1)) / (2 sum x_k^2)
  for (std::size_t k = 1; k + 1 < x.size(); ++k) {
    both += x[k] * (x[k + 1] + x[k - 1]);
    square += x[k] * x[k];
  }
  return std::acos(both / (2 * square)) / dt;
}

std::vector<ClosedForm> closed_forms(const Scene& scene, int samples) {
  const auto collision = [=](const Method& m, double dt) {
    return collide(scene, m, dt, samples).speed_error;
  };
  const auto wall = [=](const Method& m, double dt) { return wall_error(scene, m, dt, 10); };
  const auto wave = [=](const Method& m, double dt) {  // neighbours against each other
    return std::fabs(row_frequency(scene, m, dt, 8, 4) / (2 * std::sqrt(scene.stiffness)) - 1);
  };
  return {{"collision", "two grains collide: speed after it", false, collision},
          {"wall", "one grain swings on a wall, ten periods: position over amplitude", true, wall},
          {"wave", "fastest wave in a row of 8 grains: frequency", true, wave}};
}

double order_of(std::span<const double> steps, std::span<const double> errors) {
  const auto count = static_cast<Eigen::Index>(steps.size());
  Eigen::ArrayXd x = Eigen::Map<const Eigen::ArrayXd>(steps.data(), count).log();
  const Eigen::ArrayXd y = Eigen::Map<const Eigen::ArrayXd>(errors.data(), count).log();
  x -= x.mean();
  return (x * y).sum() / x.square().sum();
}

}  // namespace shearcell::test
