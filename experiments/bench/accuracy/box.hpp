// SPDX-License-Identifier: GPL-3.0-or-later
// Small scenes for measuring integrators: a few grains in a box whose walls rest, with the forces,
// the energy and the exact small vibrations by the most direct route.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/scene.hpp"

namespace shearcell::accuracy {

/// Periodic in z. In x and y there are smooth planes at 0 and at the size, touched at distance 1/2,
/// or it is periodic there as well.
struct Box {
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< [d]
  bool walls = true;
  double stiffness = 0;  ///< k/m [1/s^2]
  double drag_rate = 0;  ///< b/m [1/s]
  double gravity = 0;    ///< g/d [1/s^2], along -y
};

/// Springs, drag and gravity of a scene in a box of this size.
Box box_of(const Scene& scene, const Eigen::Vector3d& size);

/// Column i is grain i.
struct Motion {
  Eigen::Matrix3Xd position;  ///< [d]
  Eigen::Matrix3Xd velocity;  ///< [d/s]
};

/// From grain j to the nearest image of grain i, given the difference of their centres [d].
Eigen::Vector3d nearest(const Box& box, Eigen::Vector3d difference);

/// Forces of contacts and gravity [m d/s^2], over all pairs.
Eigen::Matrix3Xd forces(const Box& box, const Eigen::Matrix3Xd& position);

/// Energy of springs and gravity [m d^2/s^2], over all pairs.
double potential_energy(const Box& box, const Eigen::Matrix3Xd& position);

/// Second derivatives of that energy, 3N x 3N [m/s^2]: with n the unit vector of a contact at
/// distance r, each adds k [n n^T - (1/r - 1) (1 - n n^T)]; the second part is the pre-stress.
Eigen::MatrixXd stiffness_matrix(const Box& box, const Eigen::Matrix3Xd& position);

/// Frequencies [rad/s], ascending, and unit displacements (columns, 3N) of small vibrations.
struct Modes {
  Eigen::VectorXd frequency;
  Eigen::MatrixXd shape;
};
Modes modes(const Box& box, const Eigen::Matrix3Xd& position);

/// The positions of zero force nearest to these, by Newton's method. Throws std::runtime_error when
/// it does not converge.
Eigen::Matrix3Xd relaxed(const Box& box, Eigen::Matrix3Xd position);

/// A face-centred cubic crystal of overlapping spheres, cubic axes along x, y and z, in a box that
/// holds it: between walls (where it has been relaxed, surfaces and edges included), or periodic.
struct Crystal {
  Box box;
  Eigen::Matrix3Xd position;  ///< at rest [d]
};

/// `layers` of half a cubic cell in each direction (even along z, and everywhere when periodic),
/// so layers^3/2 grains; `overlap` [d] of neighbours inside.
Crystal fcc(const Scene& scene, int layers, double overlap, bool walls);

/// Grains in a row along z, `overlap` deep in each other, in a square duct whose four planes hold
/// each grain as deep.
Crystal chain(const Scene& scene, int grains, double overlap);

}  // namespace shearcell::accuracy
