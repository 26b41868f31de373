// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/mechanics.hpp"

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/diagnostics.hpp"

namespace shearcell {
namespace {

using Selected = std::span<const std::uint8_t>;

// A frictionless sphere is held by four contacts or more.
constexpr int kHeld = 4;

struct Touch {
  std::int32_t grain, other;  // other: -1 for a wall
};

// Grains that fewer than four contacts hold, those with rattlers not counted: they are removed one
// after the other until none is left.
std::vector<std::uint8_t> find_rattlers(std::size_t grains, std::span<const Touch> touches) {
  std::vector<int> held(grains, 0);
  std::vector<std::vector<std::int32_t>> neighbours(grains);
  for (const Touch& touch : touches) {
    ++held[static_cast<std::size_t>(touch.grain)];
    if (touch.other < 0) continue;
    ++held[static_cast<std::size_t>(touch.other)];
    neighbours[static_cast<std::size_t>(touch.grain)].push_back(touch.other);
    neighbours[static_cast<std::size_t>(touch.other)].push_back(touch.grain);
  }
  std::vector<std::uint8_t> rattler(grains, 0);
  std::vector<std::size_t> loose;
  for (std::size_t i = 0; i < grains; ++i) {
    if (held[i] < kHeld) loose.push_back(i);
  }
  while (!loose.empty()) {
    const std::size_t i = loose.back();
    loose.pop_back();
    if (rattler[i] != 0) continue;
    rattler[i] = 1;
    for (const std::int32_t j : neighbours[i]) {
      const auto n = static_cast<std::size_t>(j);
      if (--held[n] < kHeld && rattler[n] == 0) loose.push_back(n);
    }
  }
  return rattler;
}

// Everything that contacts alone give.
class ContactSums {
 public:
  ContactSums(const Checkpoint& checkpoint, Selected interior)
      : interior_(interior), trace_(interior.size(), 0.0) {
    const WallPose pose =
        wall_pose(checkpoint.cell, checkpoint.theta, checkpoint.state.wall_height);
    for_each_contact(checkpoint.cell, checkpoint.state.position, pose,
                     [this](const Contact& contact) { add(contact); });
  }

  const Eigen::Matrix3d& virial() const { return virial_; }  // [k d^2]
  double elastic_energy() const { return 0.5 * squares_; }   // [k d^2]
  const Eigen::Vector3d& force_on(WallSide side) const {
    return force_[static_cast<std::size_t>(side)];
  }
  std::span<const Touch> touches() const { return touches_; }
  const std::vector<double>& trace() const { return trace_; }  // per grain [k d^2]

 private:
  bool inside(std::int32_t grain) const { return interior_[static_cast<std::size_t>(grain)] != 0; }

  void add(const Contact& contact) {
    squares_ += contact.overlap * contact.overlap;
    // The contact is in the middle of the overlap; that with a plane is on the plane.
    const double arm = contact.kind == Contact::Kind::wall_plane ? 0.5 - contact.overlap
                                                                 : 0.5 * (1 - contact.overlap);
    const double moment = contact.overlap * arm;
    trace_[static_cast<std::size_t>(contact.grain)] += moment;
    if (contact.kind != Contact::Kind::grain) {
      force_[static_cast<std::size_t>(contact.side)] -= contact.overlap * contact.normal;
      touches_.push_back({contact.grain, -1});
      return;
    }
    trace_[static_cast<std::size_t>(contact.other)] += moment;
    touches_.push_back({contact.grain, contact.other});
    const int ends = (inside(contact.grain) ? 1 : 0) + (inside(contact.other) ? 1 : 0);
    if (ends > 0) virial_ += ends * moment * contact.normal * contact.normal.transpose();
  }

  Selected interior_;
  Eigen::Matrix3d virial_ = Eigen::Matrix3d::Zero();
  double squares_ = 0;
  std::array<Eigen::Vector3d, 4> force_ = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                                           Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  std::vector<Touch> touches_;
  std::vector<double> trace_;
};

// Sum over the interior grains of the squares of their velocities less the mean flow [d^2/s^2].
double fluctuation(const State& state, Selected interior) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double count = 0, height = 0;
  const auto each = [&](auto&& visit) {
    for (Eigen::Index i = 0; i < state.position.cols(); ++i) {
      if (interior[static_cast<std::size_t>(i)] != 0) visit(i);
    }
  };
  each([&](Eigen::Index i) {
    mean += state.velocity.col(i);
    height += state.position(1, i);
    ++count;
  });
  mean /= count;
  height /= count;
  double product = 0, square = 0;
  each([&](Eigen::Index i) {
    const double y = state.position(1, i) - height;
    product += y * (state.velocity(0, i) - mean.x());
    square += y * y;
  });
  const double rate = square > 0 ? product / square : 0;
  double sum = 0;
  each([&](Eigen::Index i) {
    Eigen::Vector3d v = state.velocity.col(i) - mean;
    v.x() -= rate * (state.position(1, i) - height);
    sum += v.squaredNorm();
  });
  return sum;
}

void set_stress(const Eigen::Matrix3d& stress, Mechanics& m) {
  m.stress_xx = stress(0, 0);
  m.stress_yy = stress(1, 1);
  m.stress_zz = stress(2, 2);
  m.stress_xy = stress(0, 1);
  m.stress_xz = stress(0, 2);
  m.stress_yz = stress(1, 2);
  m.pressure = stress.trace() / 3;
  m.deviator = std::sqrt(0.5 * (stress - m.pressure * Eigen::Matrix3d::Identity()).squaredNorm());
}

void set_coordination(std::size_t grains, std::span<const Touch> touches, Selected interior,
                      Mechanics& m) {
  const std::vector<std::uint8_t> rattler = find_rattlers(grains, touches);
  double count = 0, rattlers = 0, ends = 0, held_ends = 0;
  for (std::size_t i = 0; i < grains; ++i) {
    if (interior[i] == 0) continue;
    ++count;
    rattlers += rattler[i];
  }
  for (const auto& [grain, other] : touches) {
    const auto free = [&](std::int32_t i) {
      return i >= 0 && rattler[static_cast<std::size_t>(i)] != 0;
    };
    const bool held = !free(grain) && !free(other);
    for (const std::int32_t i : {grain, other}) {
      if (i < 0 || interior[static_cast<std::size_t>(i)] == 0) continue;
      ++ends;
      held_ends += held ? 1 : 0;
    }
  }
  m.coordination = ends / count;
  m.rattlers = 100 * rattlers / count;
  m.coordination_without_rattlers = held_ends / (count - rattlers);
}

}  // namespace

PackingMechanics mechanics(const Checkpoint& checkpoint, std::span<const double> cell_volume,
                           Selected interior) {
  const State& state = checkpoint.state;
  const auto grains = static_cast<std::size_t>(state.position.cols());
  double volume = 0;
  for (std::size_t i = 0; i < grains; ++i) volume += interior[i] != 0 ? cell_volume[i] : 0;

  const ContactSums sums(checkpoint, interior);
  PackingMechanics found;
  found.grain_pressure = sums.trace();
  for (std::size_t i = 0; i < grains; ++i) found.grain_pressure[i] /= 3 * cell_volume[i];
  Mechanics& m = found.packing;
  set_stress(sums.virial() / volume, m);
  m.kinetic_pressure = fluctuation(state, interior) / (3 * volume);
  set_coordination(grains, sums.touches(), interior, m);
  const auto set_force = [&](WallSide side, double& x, double& y) {
    x = sums.force_on(side).x();
    y = sums.force_on(side).y();
  };
  set_force(WallSide::bottom, m.force_bottom_x, m.force_bottom_y);
  set_force(WallSide::top, m.force_top_x, m.force_top_y);
  set_force(WallSide::left, m.force_left_x, m.force_left_y);
  set_force(WallSide::right, m.force_right_x, m.force_right_y);
  const auto count = static_cast<double>(grains);
  m.elastic_energy = sums.elastic_energy() / count;
  m.kinetic_energy = 0.5 * state.velocity.squaredNorm() / count;
  const WallPose pose = wall_pose(checkpoint.cell, checkpoint.theta, state.wall_height);
  m.height = state.position.row(1).mean() - pose.bottom;
  return found;
}

MechanicalUnits mechanical_units(double stiffness_N_per_m, double mass_kg, double diameter_m,
                                 double gravity_m_per_s2) {
  const double k = stiffness_N_per_m, m = mass_kg, d = diameter_m;
  return {k / d, m / d, k * d, k * d * d, m * d * d, m * gravity_m_per_s2 * d};
}

std::span<const MechanicalQuantity> all_mechanical_quantities() {
  using M = Mechanics;
  static constexpr MechanicalQuantity quantities[] = {
      {"stress_xx_k_per_d", &M::stress_xx},
      {"stress_yy_k_per_d", &M::stress_yy},
      {"stress_zz_k_per_d", &M::stress_zz},
      {"stress_xy_k_per_d", &M::stress_xy},
      {"stress_xz_k_per_d", &M::stress_xz},
      {"stress_yz_k_per_d", &M::stress_yz},
      {"pressure_k_per_d", &M::pressure},
      {"deviator_k_per_d", &M::deviator},
      {"kinetic_pressure_m_per_d_s2", &M::kinetic_pressure},
      {"coordination", &M::coordination},
      {"rattlers_percent", &M::rattlers},
      {"coordination_without_rattlers", &M::coordination_without_rattlers},
      {"force_bottom_x_k_d", &M::force_bottom_x},
      {"force_bottom_y_k_d", &M::force_bottom_y},
      {"force_top_x_k_d", &M::force_top_x},
      {"force_top_y_k_d", &M::force_top_y},
      {"force_left_x_k_d", &M::force_left_x},
      {"force_left_y_k_d", &M::force_left_y},
      {"force_right_x_k_d", &M::force_right_x},
      {"force_right_y_k_d", &M::force_right_y},
      {"elastic_energy_per_grain_k_d2", &M::elastic_energy},
      {"kinetic_energy_per_grain_m_d2_per_s2", &M::kinetic_energy},
      {"height_d", &M::height}};
  return quantities;
}

}  // namespace shearcell
