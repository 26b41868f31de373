// SPDX-License-Identifier: GPL-3.0-or-later
// Overlaps, stress, coordination, wall forces and energies: a lattice with a closed form, and sums
// over all pairs of a disordered packing. tests/export compares the stress with LAMMPS.
#include "analysis/mechanics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "analysis/measures.hpp"
#include "core/contact.hpp"
#include "provenance/errors.hpp"
#include "tests/analysis/packings.hpp"

namespace shearcell::test {
namespace {

// n^3 grains of a simple cubic lattice, squeezed so that every contact overlaps by `overlap`.
Checkpoint squeezed_lattice(int n, double overlap) {
  const double spacing = 1 - overlap;
  Packing packing = empty_cell((n - 1) * spacing + 1 - 2 * overlap,
                               (n - 1) * spacing + 1 - 2 * overlap, n * spacing);
  packing.grains.resize(3, n * n * n);
  Eigen::Index i = 0;
  for (int x = 0; x < n; ++x) {
    for (int y = 0; y < n; ++y) {
      for (int z = 0; z < n; ++z) {
        packing.grains.col(i++) =
            Eigen::Vector3d(0.5 - overlap + x * spacing, 0.5 - overlap + y * spacing, z * spacing);
      }
    }
  }
  return checkpoint_of(packing);
}

using WallForces = Eigen::Matrix<double, 2, 4>;  // x and y on each wall, by WallSide

double largest(const Eigen::MatrixXd& difference) {
  return difference.cwiseAbs().maxCoeff();
}

TEST(Mechanics, OfASqueezedLatticeIsKnown) {
  constexpr int n = 6;
  constexpr double overlap = 0.01, spacing = 1 - overlap;
  Checkpoint checkpoint = squeezed_lattice(n, overlap);
  // A linear flow has no temperature.
  checkpoint.state.velocity.row(0) = (3 * checkpoint.state.position.row(1).array() - 7).matrix();
  const Analysis found = analyse(checkpoint);
  const Mechanics& m = found.mechanics;
  ASSERT_EQ(found.measures.interior_grains, static_cast<std::size_t>(2 * 2 * n));
  const double stress = overlap / (spacing * spacing);
  EXPECT_LT(largest(m.stress - stress * Eigen::Matrix3d::Identity()), 1e-12);
  EXPECT_NEAR(m.pressure, stress, 1e-12);
  EXPECT_NEAR(m.deviator, 0, 1e-12);
  for (std::size_t i = 0; i < found.grains.interior.size(); ++i) {
    if (found.grains.interior[i] == 0) continue;
    EXPECT_NEAR(m.grain_pressure[i], stress, 1e-12);
  }
  EXPECT_NEAR(m.kinetic_pressure, 0, 1e-12);
  EXPECT_EQ(m.coordination, 6);
  EXPECT_EQ(m.coordination_without_rattlers, 6);
  EXPECT_EQ(m.rattlers, 0);
  WallForces force;
  force << -1, 1, 0, 0,  //
      0, 0, -1, 1;
  EXPECT_LT(largest(m.wall_force - n * n * overlap * force), 1e-12);
  const double contacts = 2.0 * n * n * (n - 1) + n * n * n + 4 * n * n;
  EXPECT_NEAR(m.elastic_energy, contacts * overlap * overlap / 2 / (n * n * n), 1e-15);
  EXPECT_NEAR(m.kinetic_energy, checkpoint.state.velocity.squaredNorm() / 2 / (n * n * n), 1e-12);
  EXPECT_NEAR(m.height, 0.5 - overlap + (n - 1) * spacing / 2, 1e-12);
}

TEST(Mechanics, TheTemperatureIsThatOfTheFluctuations) {
  Checkpoint checkpoint = squeezed_lattice(6, 0.01);
  const double without = analyse(checkpoint).mechanics.kinetic_pressure;
  EXPECT_EQ(without, 0);
  for (Eigen::Index i = 0; i < checkpoint.state.position.cols(); ++i) {
    checkpoint.state.velocity(2, i) = i % 2 == 0 ? 0.5 : -0.5;  // z alternates
  }
  // One grain a cell: a density of 1 / spacing^3.
  EXPECT_NEAR(analyse(checkpoint).mechanics.kinetic_pressure, 0.25 / 3 / std::pow(0.99, 3), 1e-12);
}

TEST(Mechanics, AGrainWithoutSupportIsARattler) {
  constexpr int n = 7;
  Checkpoint checkpoint = squeezed_lattice(n, 0.01);
  const Eigen::Matrix3Xd all = checkpoint.state.position;
  const Eigen::Vector3d middle = all.col((3 * n + 3) * n + 3);
  std::vector<Eigen::Index> kept;  // without its six neighbours, which leaves theirs five contacts
  for (Eigen::Index i = 0; i < all.cols(); ++i) {
    const double distance = (all.col(i) - middle).norm();
    if (distance < 0.1 || distance > 1.01) kept.push_back(i);
  }
  checkpoint.state.position = all(Eigen::all, kept);
  checkpoint.state.velocity = Eigen::Matrix3Xd::Zero(3, checkpoint.state.position.cols());
  const Analysis found = analyse(checkpoint);
  EXPECT_NEAR(found.mechanics.rattlers, 100.0 / static_cast<double>(found.measures.interior_grains),
              1e-12);
}

// Every pair, every wall grain and every plane, without a grid, term by term.
struct BruteForce {
  Eigen::Matrix3d stress = Eigen::Matrix3d::Zero();
  WallForces force = WallForces::Zero();
  double energy = 0, ends = 0, held_ends = 0, overlaps = 0, pairs = 0;
  std::vector<double> largest_overlap;
  std::vector<std::int32_t> contacts;  // with grains and wall grains
  Eigen::VectorXi rattler;
};

BruteForce brute_force(const Checkpoint& c, const GrainMeasures& grains) {
  BruteForce sums;
  const Eigen::Matrix3Xd& p = c.state.position;
  const WallPose pose = pose_of(c);
  const Eigen::Matrix3Xd walls = wall_grain_positions(c.cell, pose);
  const Eigen::Index n = p.cols();
  Eigen::MatrixXi touching = Eigen::MatrixXi::Zero(n, n);
  Eigen::VectorXi at_walls = Eigen::VectorXi::Zero(n);
  sums.largest_overlap.resize(static_cast<std::size_t>(n));
  sums.contacts.resize(static_cast<std::size_t>(n));
  const auto interior = [&](Eigen::Index i) {
    return grains.interior[static_cast<std::size_t>(i)] != 0;
  };
  double volume = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (interior(i)) volume += grains.cells.volume[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 0; j < n + walls.cols(); ++j) {
      if (i == j) continue;
      Eigen::Vector3d r = p.col(i) - (j < n ? p.col(j) : walls.col(j - n));
      r.z() -= c.cell.depth * std::round(r.z() / c.cell.depth);
      if (r.norm() >= 1) continue;
      const double overlap = 1 - r.norm();
      double& largest = sums.largest_overlap[static_cast<std::size_t>(i)];
      largest = std::max(largest, overlap);
      ++sums.contacts[static_cast<std::size_t>(i)];
      const Eigen::Vector3d on_i = overlap * r.normalized();
      if (interior(i)) sums.stress += 0.5 * on_i * r.transpose();
      sums.energy += (j < n ? 0.25 : 0.5) * overlap * overlap;
      if (j < n) {
        touching(i, j) = 1;
        sums.overlaps += overlap;
        ++sums.pairs;
      } else {
        ++at_walls(i);
        const WallSide side = c.cell.wall_grains[static_cast<std::size_t>(j - n)].side;
        sums.force.col(static_cast<Eigen::Index>(side)) -= on_i.head<2>();
      }
    }
    const auto planes = wall_planes(c.cell, pose);
    for (std::size_t w = 0; w < 4; ++w) {
      const Eigen::Vector3d normal(planes[w].normal[0], planes[w].normal[1], 0);
      const Eigen::Vector3d point(planes[w].point[0], planes[w].point[1], p(2, i));
      const double overlap = 0.5 - (p.col(i) - point).dot(normal);
      if (overlap <= 0) continue;
      ++at_walls(i);
      sums.force.col(static_cast<Eigen::Index>(w)) -= overlap * normal.head<2>();
      sums.energy += 0.5 * overlap * overlap;
    }
  }
  sums.stress /= volume;
  sums.rattler = Eigen::VectorXi::Zero(n);
  for (bool found = true; found;) {
    found = false;
    for (Eigen::Index i = 0; i < n; ++i) {
      const int held = at_walls(i) + touching.row(i).dot((1 - sums.rattler.array()).matrix());
      if (held >= 4 || sums.rattler(i) != 0) continue;
      sums.rattler(i) = 1;
      found = true;
    }
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!interior(i)) continue;
    sums.ends += touching.row(i).sum() + at_walls(i);
    if (sums.rattler(i) != 0) continue;
    sums.held_ends += touching.row(i).dot((1 - sums.rattler.array()).matrix()) + at_walls(i);
  }
  return sums;
}

TEST(Mechanics, EqualsSumsOverAllPairs) {
  for (const double theta : {0.0, 0.08}) {
    SCOPED_TRACE(theta);
    const Checkpoint checkpoint = checkpoint_of(jammed(700, true, theta, 3));
    const Analysis found = analyse(checkpoint);
    const Mechanics& m = found.mechanics;
    const BruteForce all = brute_force(checkpoint, found.grains);
    const double scale = all.stress.norm();
    ASSERT_GT(scale, 0);
    EXPECT_LT(largest(m.stress - all.stress), 1e-12 * scale);
    EXPECT_NEAR(m.pressure, all.stress.trace() / 3, 1e-12 * scale);
    const Eigen::Matrix3d s = all.stress - all.stress.trace() / 3 * Eigen::Matrix3d::Identity();
    EXPECT_NEAR(m.deviator, std::sqrt(0.5 * (s * s).trace()), 1e-12 * scale);
    EXPECT_LT(largest(m.wall_force - all.force), 1e-12);
    EXPECT_NEAR(m.elastic_energy, all.energy / 700, 1e-15);
    for (std::size_t i = 0; i < all.contacts.size(); ++i) {
      EXPECT_NEAR(found.grains.overlaps.largest[i], all.largest_overlap[i], 1e-13);
    }
    EXPECT_EQ(found.grains.overlaps.contacts, all.contacts);
    EXPECT_NEAR(found.measures.mean_overlap_d, all.overlaps / all.pairs, 1e-13);
    const auto interior = static_cast<double>(found.measures.interior_grains);
    double rattlers = 0;
    for (std::size_t i = 0; i < found.grains.interior.size(); ++i) {
      rattlers += found.grains.interior[i] * all.rattler(static_cast<Eigen::Index>(i));
    }
    EXPECT_GT(rattlers, 0) << "the case is too easy";
    EXPECT_NEAR(m.rattlers, 100 * rattlers / interior, 1e-12);
    EXPECT_NEAR(m.coordination, all.ends / interior, 1e-12);
    EXPECT_NEAR(m.coordination_without_rattlers, all.held_ends / (interior - rattlers), 1e-12);
  }
}

TEST(Mechanics, IsKeptBitByBitAndInSIUnits) {
  const Checkpoint checkpoint = checkpoint_of(jammed(300, true, 0, 5));
  const Analysis found = analyse(checkpoint);
  const Provider& mechanics = provider("mechanics");
  EXPECT_EQ((mechanics.measures.size() + 3) * sizeof(double) + sizeof(std::vector<double>),
            sizeof(Mechanics))
      << "a member has no measure, other than the lower half of the stress and the grains";
  const auto measures_of = [&](const RunFacts& run) {
    Measures back;
    EXPECT_TRUE(std::isnan(back.number("coordination"))) << "not measured";
    const nlohmann::json kept = mechanics.compute({&found, &checkpoint, {}, nullptr, &run});
    mechanics.read(decode_result(encode_result(kept)), back);
    return back;
  };
  Measures none;
  EXPECT_THROW(mechanics.read(nlohmann::json::object(), none), AnalysisError);

  const Mechanics& m = found.mechanics;
  EXPECT_TRUE(std::isnan(measures_of({}).number("contact_pressure_Pa"))) << "k and d are unknown";
  EXPECT_EQ(measures_of({}).number("coordination"), m.coordination);
  const Measures back = measures_of({.parameters = {{"stiffness_N_per_m", 654},
                                                    {"mass_kg", 2e-5},
                                                    {"diameter_m", 3e-3},
                                                    {"gravity_m_per_s2", 9.81}}});
  EXPECT_EQ(back.number("stress_xy_Pa"), m.stress(0, 1) * (654 / 3e-3));
  EXPECT_EQ(back.number("rattlers_percent"), m.rattlers);
  const auto expect = [&](const char* name, double value) {
    EXPECT_NEAR(back.number(name), value, 1e-12 * std::fabs(value)) << name;
  };
  expect("contact_pressure_Pa", m.pressure * 654 / 3e-3);
  expect("force_bottom_y_N",
         m.wall_force(1, static_cast<Eigen::Index>(WallSide::bottom)) * 654 * 3e-3);
  expect("elastic_energy_per_grain_J", m.elastic_energy * 654 * 9e-6);
  expect("kinetic_energy_per_grain_J", m.kinetic_energy * 2e-5 * 9e-6);
  expect("gravitational_energy_per_grain_J", m.height * 2e-5 * 9.81 * 3e-3);
  expect("kinetic_pressure_Pa", m.kinetic_pressure * 2e-5 / 3e-3);
}

}  // namespace
}  // namespace shearcell::test
