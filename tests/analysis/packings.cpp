// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/analysis/packings.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "core/diagnostics.hpp"

namespace shearcell::test {
namespace {

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// Forces between overlapping soft spheres of unit stiffness, and on them from wall planes.
Eigen::Matrix3Xd forces(const Packing& p) {
  Eigen::Matrix3Xd force = Eigen::Matrix3Xd::Zero(3, p.grains.cols());
  for_each_contact(p.cell, p.grains, p.pose, [&](const Contact& contact) {
    force.col(contact.grain) += contact.overlap * contact.normal;
    if (contact.kind == Contact::Kind::grain) {
      force.col(contact.other) -= contact.overlap * contact.normal;
    }
  });
  return force;
}

/// Fast inertial relaxation: momentum while the power is positive, a stop when it is not.
void relax(Packing& p, int steps) {
  Eigen::Matrix3Xd velocity = Eigen::Matrix3Xd::Zero(3, p.grains.cols());
  double step = 0.15;
  double mixing = 0.1;
  int downhill = 0;
  for (int k = 0; k < steps; ++k) {
    const Eigen::Matrix3Xd force = forces(p);
    const double power = force.cwiseProduct(velocity).sum();
    const double ratio = force.norm() > 0 ? velocity.norm() / force.norm() : 0;
    if (power > 0) {
      if (++downhill > 5) {
        step = std::min(1.1 * step, 0.4);
        mixing *= 0.99;
      }
    } else {
      downhill = 0;
      step *= 0.5;
      mixing = 0.1;
      velocity.setZero();
    }
    velocity = (1 - mixing) * velocity + (mixing * ratio + step) * force;
    p.grains += step * velocity;
  }
}

struct UnitCell {
  Eigen::Vector3d size;
  std::vector<Eigen::Vector3d> sites;
};

UnitCell unit_cell(Lattice kind) {
  const double a = std::sqrt(2.0);
  const double b = 2 / std::sqrt(3.0);
  const double h = std::sqrt(3.0);
  const double c = std::sqrt(8.0 / 3.0);
  switch (kind) {
    case Lattice::simple_cubic:
      return {{1, 1, 1}, {{0, 0, 0}}};
    case Lattice::bcc:
      return {{b, b, b}, {{0, 0, 0}, {b / 2, b / 2, b / 2}}};
    case Lattice::fcc:
      return {{a, a, a}, {{0, 0, 0}, {0, a / 2, a / 2}, {a / 2, 0, a / 2}, {a / 2, a / 2, 0}}};
    case Lattice::hcp:
      return {{1, h, c},
              {{0, 0, 0}, {0.5, h / 2, 0}, {0.5, h / 6, c / 2}, {0, h / 2 + h / 6, c / 2}}};
  }
  return {};
}

}  // namespace

Checkpoint checkpoint_of(const Packing& packing) {
  Checkpoint checkpoint;
  checkpoint.cell = packing.cell;
  checkpoint.theta = std::atan(packing.pose.tan_theta);
  checkpoint.state.position = packing.grains;
  checkpoint.state.velocity = Eigen::Matrix3Xd::Zero(3, packing.grains.cols());
  checkpoint.state.wall_height = packing.pose.bottom;
  return checkpoint;
}

double volume_of(const Packing& p) {
  return p.cell.width * p.cell.depth * (p.pose.top - p.pose.bottom);
}

Measures measured_by(std::string_view name, MeasureInput input) {
  static const RunFacts units{
      .parameters = {{"stiffness_N_per_m", 1}, {"mass_kg", 1}, {"diameter_m", 1}}};
  if (input.run == nullptr) input.run = &units;
  Measures measures;
  provider(name).read(provider(name).compute(input), measures);
  return measures;
}

std::vector<double> q6_of(const VoronoiDiagram& diagram) {
  std::vector<double> q6;
  for (std::size_t i = 0; i < diagram.volume.size(); ++i) {
    q6.push_back(bond_order_q6(diagram.faces_of(i), diagram.surface[i]));
  }
  return q6;
}

Packing empty_cell(double width, double height, double depth, double theta) {
  Packing p;
  p.cell.width = width;
  p.cell.depth = depth;
  p.cell.bottom = 0;
  p.cell.top = height;
  p.pose = wall_pose(p.cell, theta, 0);
  p.grains.resize(3, 0);
  return p;
}

void roughen(Packing& p, std::uint64_t seed) {
  Random random(seed);
  for (const WallSide side : {WallSide::left, WallSide::right, WallSide::bottom, WallSide::top}) {
    const bool upright = side == WallSide::left || side == WallSide::right;
    const double length = upright ? p.cell.top - p.cell.bottom : p.cell.width;
    std::vector<Eigen::Vector2d> placed;
    for (int attempt = 0; attempt < static_cast<int>(40 * length * p.cell.depth); ++attempt) {
      const Eigen::Vector2d at(uniform(random, 0, length), uniform(random, 0, p.cell.depth));
      const bool free = std::ranges::none_of(placed, [&](const Eigen::Vector2d& other) {
        Eigen::Vector2d gap = at - other;
        gap.y() -= p.cell.depth * std::round(gap.y() / p.cell.depth);
        return gap.norm() < 1;
      });
      if (!free) continue;
      placed.push_back(at);
      const double behind = uniform(random, 0, 0.25);
      Eigen::Vector3d centre(at.x(), at.x() + p.cell.bottom, at.y());
      if (side == WallSide::left) centre.x() = -behind;
      if (side == WallSide::right) centre.x() = p.cell.width + behind;
      if (side == WallSide::bottom) centre.y() = p.cell.bottom - behind;
      if (side == WallSide::top) centre.y() = p.cell.top + behind;
      p.cell.wall_grains.push_back({side, centre});
    }
  }
}

void fill(Packing& p, int count, int steps, std::uint64_t seed) {
  Random random(seed);
  p.grains.resize(3, count);
  for (int i = 0; i < count; ++i) {
    const double y = uniform(random, p.pose.bottom + 0.6, p.pose.top - 0.6);
    const double x = uniform(random, 0.6, p.cell.width - 0.6);
    p.grains.col(i) << x + (y - p.pose.top) * p.pose.tan_theta, y,
        uniform(random, -p.cell.depth, 2 * p.cell.depth);
  }
  relax(p, steps);
}

Packing jammed(int count, bool rough, double theta, std::uint64_t seed) {
  // Rough walls keep the grains about 0.4 d farther off, which takes some of the volume.
  const double filled = rough ? 0.56 : 0.635;
  const double width = std::cbrt(count * 0.5235987755982989 / filled / 1.675);
  Packing p = empty_cell(width, 1.675 * width, width, theta);
  if (rough) roughen(p, seed + 1);
  fill(p, count, 300, seed);
  return p;
}

Packing lattice(Lattice kind, int cells) {
  const UnitCell unit = unit_cell(kind);
  const Eigen::Vector3d size = cells * unit.size;
  Packing p = empty_cell(size.x(), size.y(), size.z());
  const auto sites = static_cast<Eigen::Index>(unit.sites.size());
  p.grains.resize(3, sites * cells * cells * cells);
  // Every site inside the walls and none on one.
  const Eigen::Vector3d shift(unit.size.x() / 8, unit.size.y() / 8, 0);
  Eigen::Index column = 0;
  for (int i = 0; i < cells; ++i) {
    for (int j = 0; j < cells; ++j) {
      for (int k = 0; k < cells; ++k) {
        for (const Eigen::Vector3d& site : unit.sites) {
          p.grains.col(column++) = Eigen::Vector3d(i, j, k).cwiseProduct(unit.size) + site + shift;
        }
      }
    }
  }
  return p;
}

void jitter(Packing& p, double amplitude, std::uint64_t seed) {
  Random random(seed);
  for (double& x : p.grains.reshaped()) x += uniform(random, -amplitude, amplitude);
}

}  // namespace shearcell::test
