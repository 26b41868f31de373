// SPDX-License-Identifier: GPL-3.0-or-later
// The small scenes of `bench accuracy`, and how fast integrators converge on them.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "experiments/manifest/conversion.hpp"
#include "experiments/bench/accuracy/closed_forms.hpp"
#include "experiments/bench/accuracy/crystal.hpp"
#include "experiments/bench/accuracy/fit.hpp"
#include "experiments/bench/accuracy/near_neighbours.hpp"

namespace shearcell::accuracy {
namespace {

const Scene kScene = shear_scene(Parameters{});
const double kStep = kScene.time_step;  // Table I's
constexpr double kOverlap = 0.003;

const Method& method(const std::string& name) {
  for (const Method& m : methods()) {
    if (m.name == name) return m;
  }
  throw std::runtime_error("no method " + name);
}

// Order of convergence of error(dt) from `largest` down, in factors of the fourth root of 2: where
// a contact ends within a step makes single errors irregular.
template <class Error>
double order(double largest, int steps, Error&& error) {
  std::vector<double> dt, found;
  for (int n = 0; n < steps; ++n) {
    dt.push_back(largest * std::exp2(-n / 4.0));
    found.push_back(error(dt.back()));
  }
  return fitted_order(dt, found);
}

TEST(Box, StiffnessMatrixIsTheDerivativeOfTheForces) {
  const Crystal crystal = fcc(kScene, 4, kOverlap, true);
  const Eigen::MatrixXd matrix = stiffness_matrix(crystal.box, crystal.position);
  const double h = 1e-6;
  double worst = 0;
  for (Eigen::Index c = 0; c < crystal.position.size(); c += 5) {
    Eigen::Matrix3Xd there = crystal.position, back = crystal.position;
    there.reshaped()[c] += h;
    back.reshaped()[c] -= h;
    const Eigen::Matrix3Xd slope =
        (forces(crystal.box, there) - forces(crystal.box, back)) / (2 * h);
    worst = std::max(worst, (slope.reshaped() + matrix.col(c)).cwiseAbs().maxCoeff());
  }
  std::printf("largest difference %.2g k\n", worst / kScene.stiffness);
  EXPECT_LT(worst, 1e-8 * kScene.stiffness);
}

TEST(Box, CrystalBetweenWallsIsAtRestAndStable) {
  const Crystal crystal = fcc(kScene, 6, kOverlap, true);
  EXPECT_EQ(crystal.position.cols(), 108);
  EXPECT_LT(forces(crystal.box, crystal.position).cwiseAbs().maxCoeff(), 1e-12 * kScene.stiffness);
  const Modes all = modes(crystal.box, crystal.position);
  const double highest = all.frequency[all.frequency.size() - 1];
  std::printf("highest frequency %.4f of sqrt(8 k/m)\n", highest / std::sqrt(8 * kScene.stiffness));
  // One mode costs nothing, the translation along z; a surface is no stiffer than the inside.
  EXPECT_LT(all.frequency[0], 1e-4 * highest);
  EXPECT_GT(all.frequency[1], 0.1 * highest);
  EXPECT_LT(highest, std::sqrt(8 * kScene.stiffness));
  EXPECT_GT(highest, 0.95 * std::sqrt(8 * kScene.stiffness));
}

TEST(Box, PeriodicCrystalHasTheFrequenciesOfTheDispersion) {
  const Crystal crystal = fcc(kScene, 6, kOverlap, false);
  const Modes all = modes(crystal.box, crystal.position);
  const Eigen::MatrixXd matrix = stiffness_matrix(crystal.box, crystal.position);
  const double edge = std::numbers::pi / (crystal.box.size.z() / 6);
  EXPECT_NEAR(all.frequency[all.frequency.size() - 1] / fcc_longitudinal(kScene, kOverlap, edge), 1,
              1e-9);
  for (int n = 1; n <= 3; ++n) {
    const double q = 2 * std::numbers::pi * n / crystal.box.size.z();
    for (const Eigen::Index axis : {0, 2}) {
      Eigen::Matrix3Xd shape = Eigen::Matrix3Xd::Zero(3, crystal.position.cols());
      shape.row(axis) = (q * crystal.position.row(2)).array().cos();
      const Eigen::VectorXd wave = shape.reshaped().normalized();
      const double exact =
          axis == 2 ? fcc_longitudinal(kScene, kOverlap, q) : fcc_transverse(kScene, kOverlap, q);
      EXPECT_LT((matrix * wave - exact * exact * wave).norm(), 1e-9 * kScene.stiffness) << n;
    }
  }
}

TEST(PlainCopy, FollowsTheEngineToRounding) {
  Crystal crystal = fcc(kScene, 6, kOverlap, true);
  crystal.box.gravity = kScene.gravity;
  const Motion start = shaken(crystal, 40, 3);
  Motion of_engine, of_copy;
  integrate(crystal.box, engine(), start, kStep, 50, 50,
            [&](std::uint64_t, const Motion& m) { of_engine = m; });
  integrate(crystal.box, method("leapfrog"), start, kStep, 50, 50,
            [&](std::uint64_t, const Motion& m) { of_copy = m; });
  const double apart = (of_engine.position - of_copy.position).cwiseAbs().maxCoeff();
  std::printf("largest distance after 50 steps %.2g d\n", apart);
  EXPECT_LT(apart, 1e-12);
  EXPECT_GT((of_engine.position - start.position).norm(), 1e-2);
}

TEST(Order, IsTheTheorysWhereContactsStayClosed) {
  const Crystal crystal = fcc(kScene, 4, kOverlap, true);
  const Motion start = shaken(crystal, 0.5, 1);
  for (const Method& m : methods()) {
    if (m.precision != Precision::twofold) continue;
    const double wall = order(kStep, 9, [&](double dt) { return wall_error(kScene, m, dt, 3); });
    const double cage = order(kStep, 9, [&](double dt) { return cage_error(kScene, m, dt, 3); });
    const double mode =
        order(kStep, 5, [&](double dt) { return frequency_error(crystal, m, dt, 3, 300); });
    const double path = order(kStep, 9, [&](double dt) {
      return trajectory_error(crystal, start, m, dt, 2 * contact_time(kScene));
    });
    std::printf("%s: wall %.2f, cage %.2f, frequencies %.2f, paths %.2f; theory %d\n",
                m.name.c_str(), wall, cage, mode, path, m.order);
    EXPECT_NEAR(wall, m.order, 0.1) << m.name;
    EXPECT_NEAR(cage, m.order, 0.1) << m.name;
    EXPECT_NEAR(mode, m.order, 0.25) << m.name;
    EXPECT_NEAR(path, m.order, 0.3) << m.name;
  }
}

// A contact that opens or closes bends the force: whatever the order elsewhere, a step over that
// bend is wrong by dt^2 in the velocity.
TEST(Order, IsTwoForEveryMethodWhereContactsOpen) {
  const Crystal crystal = fcc(kScene, 4, kOverlap, true);
  const Motion start = shaken(crystal, 100, 1);
  for (const Method& m : methods()) {
    if (m.precision != Precision::twofold) continue;
    const double speed =
        order(kStep, 17, [&](double dt) { return collision_error(kScene, m, dt, 8).speed; });
    const double path = order(kStep / 2, 9, [&](double dt) {
      return trajectory_error(crystal, start, m, dt, 2 * contact_time(kScene));
    });
    std::printf("%s: speed after a collision %.2f, paths %.2f\n", m.name.c_str(), speed, path);
    EXPECT_NEAR(speed, 2, 0.35) << m.name;
    EXPECT_NEAR(path, 2, 0.5) << m.name;
  }
}

TEST(Engine, VibratesWithTheLeapfrogsOwnDispersion) {
  const Crystal row = chain(kScene, 12, kOverlap);
  for (int n = 1; n <= 6; ++n) {
    const double q = 2 * std::numbers::pi * n / row.box.size.z();
    Eigen::Matrix3Xd shape = Eigen::Matrix3Xd::Zero(3, 12);
    shape.row(2) = (q * row.position.row(2)).array().cos();
    const Eigen::VectorXd wave = shape.reshaped().normalized();
    const double exact = chain_longitudinal(kScene, kOverlap, q);
    const double found = measured_frequency(row, wave, engine(), kStep, 500);
    EXPECT_NEAR(std::sin(found * kStep / 2) / (exact * kStep / 2), 1, 1e-7) << n;
  }
}

TEST(Engine, KeepsEnergyAndMomentumOfAVibratingCrystalForAMillionSteps) {
  const Crystal crystal = fcc(kScene, 6, kOverlap, true);
  const DriftResult r = energy_drift(crystal, shaken(crystal, 0.5, 1), engine(), kStep, 1'000'000);
  std::printf("drift %.2g, scatter %.2g, momentum %.2g\n", r.drift, r.scatter, r.momentum);
  EXPECT_LT(std::fabs(r.drift), 1e-4);
  EXPECT_LT(r.momentum, 1e-12);
}

// Why the product computes in double.
TEST(Precision, SingleForcesLoseMomentumAndEnergy) {
  const Crystal crystal = fcc(kScene, 4, kOverlap, true);
  const Motion start = shaken(crystal, 0.5, 1);
  const DriftResult twofold = energy_drift(crystal, start, method("leapfrog"), kStep, 20'000);
  for (const char* name : {"leapfrog single", "leapfrog mixed"}) {
    const DriftResult r = energy_drift(crystal, start, method(name), kStep, 20'000);
    std::printf("%s: drift %.2g, momentum %.2g; in double %.2g, %.2g\n", name, r.drift, r.momentum,
                twofold.drift, twofold.momentum);
    EXPECT_GT(std::fabs(r.drift), 10 * std::fabs(twofold.drift));
    EXPECT_GT(r.momentum, 1e6 * twofold.momentum);
  }
}

TEST(NearNeighbours, FindTheBondOrderOfACrystal) {
  Scene scene;
  scene.stiffness = 1;
  const Crystal crystal = fcc(scene, 8, 0.001, true);
  Cell cell;
  cell.width = crystal.box.size.x();
  cell.top = crystal.box.size.y();
  cell.depth = crystal.box.size.z();
  const WallPose pose = wall_pose(cell, 0, 0);
  for (const NeighbourRule rule : {NeighbourRule{1.2, 0}, NeighbourRule{1.6, 12}}) {
    const OrderError error = order_error(cell, pose, crystal.position, rule);
    EXPECT_LT(error.q6, 1e-3);
    EXPECT_NEAR(error.percent, 0, 1e-9);
  }
  // Those within 1.2 d of a grain in a corner are three.
  EXPECT_GT(q6_of_near(cell, pose, crystal.position, {1.2, 0})[0], 0.0);
  EXPECT_EQ(q6_of_near(cell, pose, crystal.position, {0.5, 0})[0], 0.0);
}

}  // namespace
}  // namespace shearcell::accuracy
