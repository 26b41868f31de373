// SPDX-License-Identifier: GPL-3.0-or-later
// Stress, coordination, forces on the walls and energies of one packing.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "provenance/checkpoint.hpp"

namespace shearcell {

/// Units are the spring constant k and the grain's mass m and diameter d; MechanicalUnits has their
/// SI values. The stress of the interior grains is positive in compression: sigma = 1/V sum_i sum_j
/// f_ij (x) l_ij, with V the volume of their Voronoi cells and l_ij from the contact to the centre
/// of the grain (Christoffersen, Mehrabadi, Nemat-Nasser, J. Appl. Mech. 48, 339 (1981)). A growing
/// shear strain du_x/dy is resisted by a negative sigma_xy. Means over no grain are not a number.
struct Mechanics {
  double stress_xx = 0, stress_yy = 0, stress_zz = 0;  ///< of contacts [k/d]
  double stress_xy = 0, stress_xz = 0, stress_yz = 0;  ///< [k/d]
  double pressure = 0;                                 ///< trace / 3 [k/d]
  double deviator = 0;                                 ///< sqrt(s:s / 2), s the deviator [k/d]
  /// Kinetic part of the pressure [m/(d s^2)], from velocities minus their mean; from v_x its
  /// linear profile in y is subtracted.
  double kinetic_pressure = 0;
  double coordination = 0;  ///< contacts per interior grain
  /// Interior grains [%] with fewer than four contacts with walls and grains that are not rattlers.
  double rattlers = 0;
  /// Contacts of interior grains that are not rattlers with walls and such grains, per such grain.
  double coordination_without_rattlers = 0;
  double force_bottom_x = 0, force_bottom_y = 0;  ///< of all grains on a wall [k d]
  double force_top_x = 0, force_top_y = 0;
  double force_left_x = 0, force_left_y = 0;
  double force_right_x = 0, force_right_y = 0;
  double elastic_energy = 0;  ///< of contacts, those with walls included, per grain [k d^2]
  double kinetic_energy = 0;  ///< per grain, half a step earlier [m d^2/s^2]
  double height = 0;          ///< mean, above the bottom wall's plane [d]
};

struct PackingMechanics {
  Mechanics packing;
  /// Pressure of each grain [k/d]: trace / 3 of the sum over the contacts of the grain, also with
  /// walls, over the volume of its cell.
  std::vector<double> grain_pressure;
};

/// `cell_volume` [d^3] and `interior` (1 or 0) have one entry per grain.
PackingMechanics mechanics(const Checkpoint& checkpoint, std::span<const double> cell_volume,
                           std::span<const std::uint8_t> interior);

/// SI values of the units of Mechanics; not a number until the grains' properties are known.
struct MechanicalUnits {
  double stress_Pa = std::numeric_limits<double>::quiet_NaN();          ///< k/d
  double kinetic_stress_Pa = std::numeric_limits<double>::quiet_NaN();  ///< m/(d s^2)
  double force_N = std::numeric_limits<double>::quiet_NaN();            ///< k d
  double elastic_J = std::numeric_limits<double>::quiet_NaN();          ///< k d^2
  double kinetic_J = std::numeric_limits<double>::quiet_NaN();          ///< m d^2/s^2
  double weight_J = std::numeric_limits<double>::quiet_NaN();           ///< m g d
};
MechanicalUnits mechanical_units(double stiffness_N_per_m, double mass_kg, double diameter_m,
                                 double gravity_m_per_s2);

}  // namespace shearcell
