// SPDX-License-Identifier: GPL-3.0-or-later
// Stress, coordination, forces on the walls and energies of one packing.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "provenance/checkpoint.hpp"

namespace shearcell {

/// All units are products of powers of the spring constant k, the mass m and the diameter d of a
/// grain. MechanicalUnits has them in SI. The stress of interior grains is positive in compression:
/// sigma = 1/V sum_i sum_j f_ij (x) l_ij. V is the volume of the Voronoi cells of these grains, and
/// l_ij points from the contact to the centre of grain i (Christoffersen, Mehrabadi, Nemat-Nasser,
/// J. Appl. Mech. 48, 339 (1981)). sigma_xy is negative while the shear strain du_x/dy grows. Means
/// over zero grains are NaN.
struct Mechanics {
  Eigen::Matrix3d stress;  ///< from contacts [k/d]
  double pressure = 0;     ///< trace / 3 [k/d]
  double deviator = 0;     ///< sqrt(s:s / 2), s the deviator [k/d]
  /// Kinetic part of the pressure [m/(d s^2)], from velocities relative to the mean
  /// flow, which is the mean velocity plus a v_x that is linear in y.
  double kinetic_pressure = 0;
  double coordination = 0;  ///< contacts per interior grain
  /// Percentage of interior grains that are rattlers. A rattler has fewer than four contacts with
  /// walls and grains that are not rattlers.
  double rattlers = 0;
  /// Contacts per interior grain that is not a rattler. Contacts with rattlers do not count.
  double coordination_without_rattlers = 0;
  /// Force that the grains exert on each wall [k d]. Rows: x and y; columns: WallSide.
  Eigen::Matrix<double, 2, 4, Eigen::DontAlign> wall_force;
  double elastic_energy = 0;  ///< of all contacts, including walls, per grain [k d^2]
  double kinetic_energy = 0;  ///< per grain, half a time step before the checkpoint [m d^2/s^2]
  double height = 0;          ///< mean height of grains above the plane of the bottom wall [d]
  /// Pressure of each grain [k/d]: the trace of f (x) l, summed over its contacts with grains and
  /// walls, divided by three times the volume of its Voronoi cell.
  std::vector<double> grain_pressure;
};

/// `cell_volume` [d^3] and `interior` (1 or 0) have one entry per grain.
Mechanics mechanics(const Checkpoint& checkpoint, std::span<const double> cell_volume,
                    std::span<const std::uint8_t> interior);

struct MechanicalUnits {
  double stress_Pa;          ///< k/d
  double kinetic_stress_Pa;  ///< m/(d s^2)
  double force_N;            ///< k d
  double elastic_J;          ///< k d^2
  double kinetic_J;          ///< m d^2/s^2
  double weight_J;           ///< m g d
};

}  // namespace shearcell
