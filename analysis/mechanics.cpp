// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/mechanics.hpp"

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "analysis/measures.hpp"
#include "core/diagnostics.hpp"

namespace shearcell {
namespace {

using GrainMask = std::span<const std::uint8_t>;

// A frictionless sphere needs at least four contacts to be held in place.
constexpr int kHeld = 4;

struct Touch {
  std::int32_t grain, other;  // other: -1 for a wall
};

// Contacts of each grain with walls and with grains that are not rattlers; 0 for a rattler. A grain
// with fewer than four contacts is a rattler. Contacts with rattlers do not count, so rattlers are
// removed until each remaining grain has at least four contacts.
std::vector<int> held_contacts(std::size_t grains, std::span<const Touch> touches) {
  std::vector<std::uint8_t> rattler(grains, 0);
  while (true) {
    std::vector<int> held(grains, 0);
    for (const Touch& touch : touches) {
      const auto a = static_cast<std::size_t>(touch.grain);
      const auto b = touch.other < 0 ? a : static_cast<std::size_t>(touch.other);
      if (rattler[a] != 0 || rattler[b] != 0) continue;
      ++held[a];
      held[b] += a == b ? 0 : 1;
    }
    bool any_more = false;
    for (std::size_t i = 0; i < grains; ++i) {
      if (rattler[i] != 0 || held[i] >= kHeld) continue;
      rattler[i] = 1;
      any_more = true;
    }
    if (!any_more) return held;
  }
}

struct ContactSums {
  Eigen::Matrix3d virial = Eigen::Matrix3d::Zero();             // of interior grains [k d^2]
  double squares = 0;                                           // of overlaps [d^2]
  Eigen::Matrix<double, 3, 4> force = decltype(force)::Zero();  // force on each wall [k d]
  std::vector<Touch> touches;
  std::vector<int> contacts;  // of each grain
  std::vector<double> trace;  // virial trace of each grain [k d^2]
};

ContactSums sums_of(const Checkpoint& checkpoint, GrainMask interior) {
  ContactSums sums;
  sums.contacts.assign(interior.size(), 0);
  sums.trace.assign(interior.size(), 0.0);
  const auto grain = [](std::int32_t id) { return static_cast<std::size_t>(id); };
  const auto add = [&](const Contact& contact) {
    sums.squares += contact.overlap * contact.overlap;
    // arm: from the grain's centre to the middle of the overlap or, for a wall plane, to the plane.
    const double arm = contact.kind == Contact::Kind::wall_plane ? 0.5 - contact.overlap
                                                                 : 0.5 * (1 - contact.overlap);
    const double moment = contact.overlap * arm;
    ++sums.contacts[grain(contact.grain)];
    sums.trace[grain(contact.grain)] += moment;
    if (contact.kind != Contact::Kind::grain) {
      sums.force.col(static_cast<Eigen::Index>(contact.side)) -= contact.overlap * contact.normal;
      sums.touches.push_back({contact.grain, -1});
      return;
    }
    ++sums.contacts[grain(contact.other)];
    sums.trace[grain(contact.other)] += moment;
    sums.touches.push_back({contact.grain, contact.other});
    const int ends = (interior[grain(contact.grain)] != 0 ? 1 : 0) +
                     (interior[grain(contact.other)] != 0 ? 1 : 0);
    if (ends > 0) sums.virial += ends * moment * contact.normal * contact.normal.transpose();
  };
  for_each_contact(checkpoint.cell, checkpoint.state.position, pose_of(checkpoint), add);
  return sums;
}

// Sum over interior grains of (velocity - mean flow)^2 [d^2/s^2]. The mean flow is linear in y.
double fluctuation(const State& state, GrainMask interior) {
  const auto sum = [&](const auto& value_of) {
    double total = 0;
    for (Eigen::Index i = 0; i < state.position.cols(); ++i) {
      if (interior[static_cast<std::size_t>(i)] != 0) total += value_of(i);
    }
    return total;
  };
  const double count = sum([](Eigen::Index) { return 1; });
  Eigen::Vector3d mean;
  for (const int axis : {0, 1, 2}) {
    mean[axis] = sum([&](Eigen::Index i) { return state.velocity(axis, i); }) / count;
  }
  const double height = sum([&](Eigen::Index i) { return state.position(1, i); }) / count;
  const auto y = [&](Eigen::Index i) { return state.position(1, i) - height; };
  const double square = sum([&](Eigen::Index i) { return y(i) * y(i); });
  const double product =
      sum([&](Eigen::Index i) { return y(i) * (state.velocity(0, i) - mean.x()); });
  const double rate = square > 0 ? product / square : 0;
  return sum([&](Eigen::Index i) {
    Eigen::Vector3d v = state.velocity.col(i) - mean;
    v.x() -= rate * y(i);
    return v.squaredNorm();
  });
}

}  // namespace

Mechanics mechanics(const Checkpoint& checkpoint, std::span<const double> cell_volume,
                    GrainMask interior) {
  const State& state = checkpoint.state;
  const auto grains = static_cast<std::size_t>(state.position.cols());
  double volume = 0;
  for (std::size_t i = 0; i < grains; ++i) volume += interior[i] != 0 ? cell_volume[i] : 0;

  ContactSums sums = sums_of(checkpoint, interior);
  for (std::size_t i = 0; i < grains; ++i) sums.trace[i] /= 3 * cell_volume[i];
  Mechanics m;
  m.stress = sums.virial / volume;
  m.pressure = m.stress.trace() / 3;
  m.deviator = std::sqrt(0.5 * (m.stress - m.pressure * Eigen::Matrix3d::Identity()).squaredNorm());
  m.kinetic_pressure = fluctuation(state, interior) / (3 * volume);
  const std::vector<int> held = held_contacts(grains, sums.touches);
  m.coordination = mean_over(interior, [&](std::size_t i) { return sums.contacts[i]; });
  m.rattlers = percent_of(interior, [&](std::size_t i) { return held[i] == 0; });
  m.coordination_without_rattlers =
      mean_over(interior, [&](std::size_t i) { return held[i] > 0 ? held[i] : std::nan(""); });
  m.wall_force = sums.force.topRows<2>();
  const auto count = static_cast<double>(grains);
  m.elastic_energy = 0.5 * sums.squares / count;
  m.kinetic_energy = 0.5 * state.velocity.squaredNorm() / count;
  m.height = state.position.row(1).mean() - pose_of(checkpoint).bottom;
  m.grain_pressure = std::move(sums.trace);
  return m;
}

MechanicalUnits mechanical_units(const MeasureInput& input) {
  const RunFacts none, &run = input.run == nullptr ? none : *input.run;
  double k = run.number("stiffness_N_per_m");
  if (input.checkpoint != nullptr) {
    const auto& recorded = input.checkpoint->observables;
    const auto raised = recorded.find("stiffness_N_per_m");
    if (raised != recorded.end()) k = raised->second;
  }
  const double m = run.number("mass_kg"), d = run.number("diameter_m");
  return {k / d, m / d, k * d, k * d * d, m * d * d, m * run.number("gravity_m_per_s2") * d};
}

std::vector<Provider> mechanics_providers() {
  const auto compute = [](const MeasureInput& input) -> nlohmann::json {
    const Mechanics& m = input.analysis->mechanics;
    const MechanicalUnits units = mechanical_units(input);
    const auto stress = [&](int a, int b) { return m.stress(a, b) * units.stress_Pa; };
    const auto force = [&](WallSide side, int axis) {
      return m.wall_force(axis, static_cast<Eigen::Index>(side)) * units.force_N;
    };
    return {{"contact_pressure_Pa", m.pressure * units.stress_Pa},
            {"deviator_Pa", m.deviator * units.stress_Pa},
            {"stress_xx_Pa", stress(0, 0)},
            {"stress_yy_Pa", stress(1, 1)},
            {"stress_zz_Pa", stress(2, 2)},
            {"stress_xy_Pa", stress(0, 1)},
            {"stress_xz_Pa", stress(0, 2)},
            {"stress_yz_Pa", stress(1, 2)},
            {"kinetic_pressure_Pa", m.kinetic_pressure * units.kinetic_stress_Pa},
            {"coordination", m.coordination},
            {"rattlers_percent", m.rattlers},
            {"coordination_without_rattlers", m.coordination_without_rattlers},
            {"force_bottom_x_N", force(WallSide::bottom, 0)},
            {"force_bottom_y_N", force(WallSide::bottom, 1)},
            {"force_top_x_N", force(WallSide::top, 0)},
            {"force_top_y_N", force(WallSide::top, 1)},
            {"force_left_x_N", force(WallSide::left, 0)},
            {"force_left_y_N", force(WallSide::left, 1)},
            {"force_right_x_N", force(WallSide::right, 0)},
            {"force_right_y_N", force(WallSide::right, 1)},
            {"elastic_energy_per_grain_J", m.elastic_energy * units.elastic_J},
            {"kinetic_energy_per_grain_J", m.kinetic_energy * units.kinetic_J},
            {"gravitational_energy_per_grain_J", m.height * units.weight_J}};
  };
  return {
      {.name = "mechanics",
       .parameters = with(interior_criteria(), {{"units", "SI"}}),
       .measures =
           {{"contact_pressure_Pa", "Pa", "mean normal stress of interior grains, from contacts"},
            {"deviator_Pa", "Pa", "sqrt(s:s / 2) of the deviatoric stress s of interior grains"},
            {"stress_xx_Pa", "Pa", "normal stress of interior grains, positive in compression"},
            {"stress_yy_Pa", "Pa", "normal stress of interior grains, positive in compression"},
            {"stress_zz_Pa", "Pa", "normal stress of interior grains, positive in compression"},
            {"stress_xy_Pa", "Pa",
             "shear stress of interior grains, negative while shear_strain grows"},
            {"stress_xz_Pa", "Pa", "shear stress of interior grains"},
            {"stress_yz_Pa", "Pa", "shear stress of interior grains"},
            {"kinetic_pressure_Pa", "Pa",
             "kinetic part of the pressure, from velocities minus the mean flow"},
            {"coordination", "1", "contacts per interior grain"},
            {"rattlers_percent", "%",
             "percentage of interior grains that are rattlers; a rattler has fewer than four "
             "contacts, not counting contacts with rattlers"},
            {"coordination_without_rattlers", "1",
             "contacts per interior grain that is not a rattler, excluding contacts with rattlers"},
            {"force_bottom_x_N", "N", "x component of the grains' force on the bottom wall"},
            {"force_bottom_y_N", "N", "y component of the grains' force on the bottom wall"},
            {"force_top_x_N", "N", "x component of the grains' force on the top wall"},
            {"force_top_y_N", "N", "y component of the grains' force on the top wall"},
            {"force_left_x_N", "N", "x component of the grains' force on the left wall"},
            {"force_left_y_N", "N", "y component of the grains' force on the left wall"},
            {"force_right_x_N", "N", "x component of the grains' force on the right wall"},
            {"force_right_y_N", "N", "y component of the grains' force on the right wall"},
            {"elastic_energy_per_grain_J", "J",
             "elastic energy of all contacts, divided by the number of grains"},
            {"kinetic_energy_per_grain_J", "J",
             "kinetic energy per grain, half a time step before the checkpoint"},
            {"gravitational_energy_per_grain_J", "J",
             "weight of a grain times the grains' mean height above the bottom wall"}},
       .compute = compute}};
}

}  // namespace shearcell
