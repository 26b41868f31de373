// SPDX-License-Identifier: GPL-3.0-or-later
// Convergence of the integrators of `bench accuracy` on closed forms, and the overlap that `plan`
// expects.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "experiments/bench/accuracy/closed_forms.hpp"
#include "experiments/bench/packing.hpp"
#include "experiments/manifest/conversion.hpp"

namespace shearcell::accuracy {
namespace {

const Scene kScene = shear_scene(Parameters{});
const double kStep = kScene.time_step;  // Table I's

// A contact that opens or closes bends the force, and a step over that bend has an error of dt^2 in
// the velocity: every method is then of second order.
TEST(Accuracy, OrderIsThatOfTheoryOnEveryClosedForm) {
  const Thoroughness quick{.phases = 8, .periods = 3, .waves = 3, .wave_steps = 300};
  for (const ClosedForm& form : closed_forms(kScene, quick)) {
    if (form.name == "collision-end") continue;
    for (const Method& m : methods()) {
      const double order = fitted_order([&](double dt) { return form.measure(m, dt); }, kStep,
                                        form.irregular ? 17 : 9);
      std::printf("%s, %s: order %.2f\n", form.title.c_str(), m.name.c_str(), order);
      EXPECT_NEAR(order, form.irregular ? 2 : m.order, form.irregular ? 0.35 : 0.25)
          << form.name << ", " << m.name;
    }
  }
}

// sin(w' dt/2) = w dt/2
TEST(Accuracy, EngineHasTheDispersionOfTheLeapfrog) {
  for (int n = 1; n <= 6; ++n) {
    const double exact = row_frequency(kScene, 12, n);
    const double found = found_row_frequency(kScene, methods().front(), kStep, 12, n, 500);
    EXPECT_NEAR(std::sin(found * kStep / 2) / (exact * kStep / 2), 1, 1e-7) << n;
  }
}

TEST(Overlap, IsWhatAPlanExpects) {
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
    const bench::Packing packing = bench::settled_packing(p, 1);
    const double found = bench::numbers_of(packing.cell, packing.scene, 0, packing.state).overlap;
    std::printf("N = %d, P x %g, k x %g: %.3e d, expected %.3e d\n", static_cast<int>(c.grains),
                c.pressure, c.stiffness, found, expected_overlap(p));
    EXPECT_NEAR(found / expected_overlap(p), 1, 0.15);
  }
}

}  // namespace
}  // namespace shearcell::accuracy
