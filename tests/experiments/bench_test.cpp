// SPDX-License-Identifier: GPL-3.0-or-later
// Convergence of integrators on closed forms; results of `bench speed` compared with the limits of
// the machine; and the overlap that `plan` predicts.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/contact.hpp"
#include "experiments/bench/speed.hpp"
#include "experiments/manifest/conversion.hpp"
#include "tests/bench/closed_forms.hpp"
#include "tests/support/packing.hpp"

namespace shearcell::test {
namespace {

const Scene kScene = shear_scene(Parameters{});
const double kStep = kScene.time_step;  // Table I's

// A contact that opens or closes bends the force, and a step over that bend has an error of dt^2 in
// the velocity: every method is then of second order.
TEST(Accuracy, OrderIsThatOfTheoryForEveryClosedForm) {
  for (const ClosedForm& form : closed_forms(kScene, 256)) {
    for (const Method& m : methods()) {
      std::vector<double> steps, errors;
      for (int n = 0; n <= 6; ++n) {
        steps.push_back(kStep * std::exp2(-0.5 * n));
        errors.push_back(form.error(m, steps.back()));
      }
      const double order = order_of(steps, errors);
      std::printf("%s, %s: order %.2f\n", form.title.c_str(), m.name.c_str(), order);
      EXPECT_NEAR(order, form.smooth && m.name != "engine" ? 4 : 2, 0.15)
          << form.name << ", " << m.name;
    }
  }
}

// Collisions with other parts of a step at their beginning and end gain and lose: the mean energy
// after them is a hundredth as wrong as the speed after one.
TEST(Accuracy, MeanEnergyOfCollisionsIsMoreAccurateThanTheSpeedAfterOne) {
  for (const Method& m : methods()) {
    const Collision coarse = collide(kScene, m, 1.4 * kStep, 1024),
                    fine = collide(kScene, m, kStep, 1024);
    std::printf("%s: speed %.2g, energy %.2g, at 1.4 dt %.2g\n", m.name.c_str(), fine.speed_error,
                fine.energy_change, coarse.energy_change);
    EXPECT_LT(std::fabs(fine.energy_change), 0.2 * fine.speed_error) << m.name;
    EXPECT_GT(std::log(coarse.energy_change / fine.energy_change) / std::log(1.4), 2.5) << m.name;
  }
}

// sin(w' dt/2) = w dt/2, with w = 2 sqrt(k/m) sin(pi n / grains)
TEST(Accuracy, EngineHasTheDispersionOfTheLeapfrog) {
  for (int n = 1; n <= 6; ++n) {
    const double exact = 2 * std::sqrt(kScene.stiffness) * std::sin(std::numbers::pi * n / 12);
    const double found = row_frequency(kScene, methods().front(), kStep, 12, n);
    EXPECT_NEAR(std::sin(found * kStep / 2) / (exact * kStep / 2), 1, 1e-7) << n;
  }
}

TEST(Overlap, IsAsAPlanPredicts) {
  struct Case {
    std::uint64_t grains;
    double pressure, stiffness;
    MovingWall moving;
  };
  for (const Case& c : {Case{600, 1, 1, MovingWall::bottom}, Case{600, 1, 1, MovingWall::top},
                        Case{600, 2, 1, MovingWall::bottom}, Case{600, 1, 4, MovingWall::bottom},
                        Case{2000, 1, 1, MovingWall::bottom}}) {
    Parameters p;
    p.grains = c.grains;
    p.pressure_Pa *= c.pressure;
    p.stiffness_N_per_m *= c.stiffness;
    p.settle_time_step_s /= std::sqrt(c.stiffness);
    p.moving_wall = c.moving;
    const Packing packing = settled_packing(p, 1);
    const double found = numbers_of(packing.cell, packing.scene, packing.state).mean_overlap_d;
    std::printf("N = %d, P x %g, k x %g: %.3e d, expected %.3e d\n", static_cast<int>(c.grains),
                c.pressure, c.stiffness, found, expected_overlap(p));
    EXPECT_NEAR(found / expected_overlap(p), 1, 0.15);
  }
}

// The reference kernel's source, counted: of a slot (add_contacts, contact_factor) and of a grain.
TEST(Speed, CountsTheMultiplicationsOfTheKernel) {
  for (const std::size_t lanes : {1U, 2U, 4U, 8U}) {
    const auto grains = static_cast<double>(lanes);
    const double none = bench::multiplications(lanes, 0);
    EXPECT_NEAR(none, (3 + 3 + 3 + 5) / grains, 1e-12) << lanes;
    EXPECT_NEAR(bench::multiplications(lanes, 10) - none,
                10 * (3 + static_cast<double>(kContactSeries.size()) + 3) / grains, 1e-12)
        << lanes;
  }
}

TEST(Speed, NoKernelIsFasterThanTheMachine) {
  bench::SpeedOptions options;
  options.sizes = {200};
  options.repeats = 1;
  options.seconds_per_repeat = 0.05;
  for (const bench::SpeedResult& result : bench::measure_speed(options)) {
    SCOPED_TRACE(result.simd);
    EXPECT_GT(result.fastest_rate, 0);
    EXPECT_LT(result.fastest_rate, result.limit);
    // Six neighbours in a dense packing at the least, and vectors whose longest list has twenty.
    const auto lanes = result.simd == "AVX-512"  ? 8U
                       : result.simd == "AVX2"   ? 4U
                       : result.simd == "scalar" ? 1U
                                                 : 2U;
    EXPECT_GT(result.multiplications, bench::multiplications(lanes, 6));
    EXPECT_LT(result.multiplications, bench::multiplications(lanes, 20));
  }
}

// A prime number of grains beyond those that the pressure can lift: two packings side by side.
TEST(Speed, OfAPackingRepeatedAlongTheDepth) {
  const bench::SpeedResult result = bench::measure_speed({.sizes = {18211},
                                                          .threads = {1},
                                                          .repeats = 1,
                                                          .seconds_per_repeat = 0.01,
                                                          .report = {}})
                                        .front();
  EXPECT_EQ(result.grains, 18212U);
  EXPECT_GT(result.median_rate, 0);
}

}  // namespace
}  // namespace shearcell::test
