// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/accuracy/box.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace shearcell::accuracy {
namespace {

// Calls visit(i, j, r, n) for every touching pair: distance, and unit vector from j to i.
template <class Visit>
void for_each_pair(const Box& box, const Eigen::Matrix3Xd& position, Visit&& visit) {
  for (Eigen::Index i = 0; i < position.cols(); ++i) {
    for (Eigen::Index j = i + 1; j < position.cols(); ++j) {
      const Eigen::Vector3d dr = nearest(box, position.col(i) - position.col(j));
      const double r = dr.norm();
      if (r < 1) visit(i, j, r, Eigen::Vector3d(dr / r));
    }
  }
}

// Calls visit(i, axis, inwards, overlap) for every grain that touches a plane.
template <class Visit>
void for_each_wall(const Box& box, const Eigen::Matrix3Xd& position, Visit&& visit) {
  if (!box.walls) return;
  for (Eigen::Index i = 0; i < position.cols(); ++i) {
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      const double low = 0.5 - position(axis, i);
      const double high = 0.5 - (box.size[axis] - position(axis, i));
      if (low > 0) visit(i, axis, 1.0, low);
      if (high > 0) visit(i, axis, -1.0, high);
    }
  }
}

}  // namespace

Box box_of(const Scene& scene, const Eigen::Vector3d& size) {
  return {size, true, scene.stiffness, scene.drag_rate, scene.gravity};
}

Eigen::Vector3d nearest(const Box& box, Eigen::Vector3d difference) {
  for (Eigen::Index axis = box.walls ? 2 : 0; axis < 3; ++axis) {
    difference[axis] -= box.size[axis] * std::nearbyint(difference[axis] / box.size[axis]);
  }
  return difference;
}

Eigen::Matrix3Xd forces(const Box& box, const Eigen::Matrix3Xd& position) {
  Eigen::Matrix3Xd force = Eigen::Matrix3Xd::Zero(3, position.cols());
  force.row(1).array() -= box.gravity;
  for_each_pair(box, position,
                [&](Eigen::Index i, Eigen::Index j, double r, const Eigen::Vector3d& n) {
                  force.col(i) += box.stiffness * (1 - r) * n;
                  force.col(j) -= box.stiffness * (1 - r) * n;
                });
  for_each_wall(box, position, [&](Eigen::Index i, Eigen::Index axis, double inwards, double o) {
    force(axis, i) += box.stiffness * inwards * o;
  });
  return force;
}

double potential_energy(const Box& box, const Eigen::Matrix3Xd& position) {
  double squares = 0;
  for_each_pair(box, position, [&](Eigen::Index, Eigen::Index, double r, const Eigen::Vector3d&) {
    squares += (1 - r) * (1 - r);
  });
  for_each_wall(box, position,
                [&](Eigen::Index, Eigen::Index, double, double o) { squares += o * o; });
  return 0.5 * box.stiffness * squares + box.gravity * position.row(1).sum();
}

Eigen::MatrixXd stiffness_matrix(const Box& box, const Eigen::Matrix3Xd& position) {
  const Eigen::Index size = 3 * position.cols();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
  for_each_pair(box, position,
                [&](Eigen::Index i, Eigen::Index j, double r, const Eigen::Vector3d& n) {
                  const Eigen::Matrix3d along = n * n.transpose();
                  const Eigen::Matrix3d block =
                      box.stiffness * (along - (1 / r - 1) * (Eigen::Matrix3d::Identity() - along));
                  matrix.block<3, 3>(3 * i, 3 * i) += block;
                  matrix.block<3, 3>(3 * j, 3 * j) += block;
                  matrix.block<3, 3>(3 * i, 3 * j) -= block;
                  matrix.block<3, 3>(3 * j, 3 * i) -= block;
                });
  for_each_wall(box, position, [&](Eigen::Index i, Eigen::Index axis, double, double) {
    matrix(3 * i + axis, 3 * i + axis) += box.stiffness;
  });
  return matrix;
}

Modes modes(const Box& box, const Eigen::Matrix3Xd& position) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(stiffness_matrix(box, position));
  return {solver.eigenvalues().cwiseMax(0.0).cwiseSqrt(), solver.eigenvectors()};
}

Eigen::Matrix3Xd relaxed(const Box& box, Eigen::Matrix3Xd position) {
  for (int iteration = 0; iteration < 20; ++iteration) {
    const Eigen::Matrix3Xd force = forces(box, position);
    if (force.cwiseAbs().maxCoeff() < 1e-13 * box.stiffness) return position;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(stiffness_matrix(box, position));
    // Translations cost nothing and must not be divided by.
    const Eigen::VectorXd inverse =
        (solver.eigenvalues().array() > 1e-9 * box.stiffness)
            .select(solver.eigenvalues().cwiseInverse(), Eigen::VectorXd::Zero(force.size()));
    const Eigen::VectorXd step = solver.eigenvectors() * inverse.asDiagonal() *
                                 solver.eigenvectors().transpose() * force.reshaped();
    position.reshaped() += step;
  }
  throw std::runtime_error("a crystal did not come to rest");
}

Crystal fcc(const Scene& scene, int layers, double overlap, bool walls) {
  const double spacing = (1 - overlap) / std::numbers::sqrt2;
  // A surface grain is held by four neighbours, each at 45 degrees to the surface.
  const double first = walls ? 0.5 - 2 * std::numbers::sqrt2 * overlap : 0;
  const double across = walls ? 2 * first + (layers - 1) * spacing : layers * spacing;
  Crystal crystal{box_of(scene, {across, across, layers * spacing}), {}};
  crystal.box.walls = walls;
  crystal.box.gravity = 0;
  std::vector<Eigen::Vector3d> sites;
  for (int x = 0; x < layers; ++x) {
    for (int y = 0; y < layers; ++y) {
      for (int z = 0; z < layers; ++z) {
        if ((x + y + z) % 2 == 0) {
          sites.emplace_back(first + x * spacing, first + y * spacing, z * spacing);
        }
      }
    }
  }
  crystal.position.resize(3, static_cast<Eigen::Index>(sites.size()));
  for (std::size_t i = 0; i < sites.size(); ++i) {
    crystal.position.col(static_cast<Eigen::Index>(i)) = sites[i];
  }
  if (walls) crystal.position = relaxed(crystal.box, crystal.position);
  return crystal;
}

Crystal chain(const Scene& scene, int grains, double overlap) {
  const double across = 1 - 2 * overlap;
  const double spacing = 1 - overlap;
  Crystal crystal{box_of(scene, {across, across, grains * spacing}), {}};
  crystal.box.gravity = 0;
  crystal.position.resize(3, grains);
  for (int i = 0; i < grains; ++i) {
    crystal.position.col(i) << across / 2, across / 2, i * spacing;
  }
  return crystal;
}

}  // namespace shearcell::accuracy
