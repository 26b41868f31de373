// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/accuracy/crystal.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/random.hpp"
#include "experiments/bench/accuracy/fit.hpp"

namespace shearcell::accuracy {
namespace {

const Method& reference_method() {
  return *std::ranges::find(methods(), "PEFRL", &Method::name);
}

Crystal without_drag(Crystal crystal) {
  crystal.box.drag_rate = 0;
  return crystal;
}

}  // namespace

double fcc_longitudinal(const Scene& scene, double overlap, double q) {
  const double stress = overlap / (1 - overlap), layer = (1 - overlap) / std::numbers::sqrt2;
  return std::sqrt(8 * scene.stiffness * (1 - stress)) * std::fabs(std::sin(q * layer / 2));
}

double fcc_transverse(const Scene& scene, double overlap, double q) {
  const double stress = overlap / (1 - overlap), layer = (1 - overlap) / std::numbers::sqrt2;
  return std::sqrt(4 * scene.stiffness * (1 - 3 * stress)) * std::fabs(std::sin(q * layer / 2));
}

double chain_longitudinal(const Scene& scene, double overlap, double q) {
  return 2 * std::sqrt(scene.stiffness) * std::fabs(std::sin(q * (1 - overlap) / 2));
}

double measured_frequency(const Crystal& crystal, const Eigen::VectorXd& shape,
                          const Method& method, double dt, std::uint64_t steps) {
  constexpr double amplitude = 1e-6;
  const Crystal free = without_drag(crystal);
  Motion start{free.position, Eigen::Matrix3Xd::Zero(3, free.position.cols())};
  start.position.reshaped() += amplitude * shape;
  std::vector<double> x;
  integrate(free.box, method, start, dt, steps, 1, [&](std::uint64_t, const Motion& m) {
    x.push_back(shape.dot((m.position - free.position).reshaped()));
  });
  double both = 0, square = 0;
  for (std::size_t n = 1; n + 1 < x.size(); ++n) {
    both += x[n] * (x[n + 1] + x[n - 1]);
    square += x[n] * x[n];
  }
  return std::acos(std::clamp(both / (2 * square), -1.0, 1.0)) / dt;
}

double frequency_error(const Crystal& crystal, const Method& method, double dt, int count,
                       std::uint64_t steps) {
  const Modes all = modes(crystal.box, crystal.position);
  const Eigen::Index size = all.frequency.size();
  Eigen::Index first = 0;
  while (all.frequency[first] < 1e-3 * all.frequency[size - 1]) ++first;
  double worst = 0;
  for (int c = 0; c < count; ++c) {
    const Eigen::Index mode = first + (size - 1 - first) * c / std::max(1, count - 1);
    const double exact = all.frequency[mode];
    const double found = measured_frequency(crystal, all.shape.col(mode), method, dt, steps);
    worst = std::max(worst, std::fabs(found / exact - 1));
  }
  return worst;
}

Motion shaken(const Crystal& crystal, double speed, std::uint64_t seed) {
  const Eigen::Index grains = crystal.position.cols();
  Motion motion{crystal.position, Eigen::Matrix3Xd(3, grains)};
  for (Eigen::Index i = 0; i < grains; ++i) {
    const auto a = uniform_pair({static_cast<std::uint32_t>(i), 0, 0, 0}, seed);
    const auto b = uniform_pair({static_cast<std::uint32_t>(i), 1, 0, 0}, seed);
    motion.velocity.col(i) << a[0] - 0.5, a[1] - 0.5, b[0] - 0.5;
  }
  motion.velocity.colwise() -= Eigen::Vector3d(motion.velocity.rowwise().mean());
  motion.velocity *= speed / std::sqrt(motion.velocity.squaredNorm() / static_cast<double>(grains));
  return motion;
}

DriftResult energy_drift(const Crystal& crystal, const Motion& start, const Method& method,
                         double dt, std::uint64_t steps) {
  constexpr std::uint64_t stretches = 100, samples = 50;
  const std::uint64_t every = std::max<std::uint64_t>(1, steps / (stretches * samples));
  const Crystal free = without_drag(crystal);
  const double at_rest = potential_energy(free.box, free.position);
  std::vector<double> at, mean;
  DriftResult result;
  double sum = 0;
  std::uint64_t count = 0;
  integrate(free.box, method, start, dt, steps, every, [&](std::uint64_t n, const Motion& m) {
    sum += energy(free.box, method, m, dt) - at_rest;
    result.momentum = std::max(
        result.momentum, std::fabs(m.velocity.row(2).sum()) / m.velocity.row(2).cwiseAbs().sum());
    if (++count % samples != 0) return;
    at.push_back(static_cast<double>(n));
    mean.push_back(sum / samples);
    sum = 0;
  });
  const Line line = fitted_line(at, mean);
  const double middle = line.at(static_cast<double>(steps) / 2);
  result.drift = line.slope * static_cast<double>(steps) / middle;
  result.scatter = line.scatter / middle;
  return result;
}

double trajectory_error(const Crystal& crystal, const Motion& start, const Method& method,
                        double dt, double time) {
  const auto steps =
      std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(time / dt)));
  Eigen::Matrix3Xd exact, found;
  integrate(crystal.box, reference_method(), start, dt / 32, 32 * steps, 32 * steps,
            [&](std::uint64_t, const Motion& m) { exact = m.position; });
  integrate(crystal.box, method, start, dt, steps, steps,
            [&](std::uint64_t, const Motion& m) { found = m.position; });
  return std::sqrt((found - exact).squaredNorm() / static_cast<double>(exact.cols()));
}

}  // namespace shearcell::accuracy
