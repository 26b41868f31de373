// SPDX-License-Identifier: GPL-3.0-or-later
// What a manifest's numbers say of a run before it is run.
#include "experiments/manifest/numerics.hpp"

#include <gtest/gtest.h>

#include "experiments/manifest/expand.hpp"

namespace shearcell {
namespace {

TEST(TimeStep, OfTableI) {
  const TimeStep step = shear_time_step({});
  EXPECT_NEAR(step.seconds, 4.386e-5, 1e-8);
  // k/m = 3.27e7 /s^2: pi/sqrt(2 k/m) = 3.885e-4 s, 2/sqrt(8 k/m) = 1.2365e-4 s.
  EXPECT_NEAR(step.over_contact_time, 0.1129, 1e-4);
  EXPECT_NEAR(step.over_stability_limit, 0.3547, 1e-4);
  EXPECT_EQ(step.seconds, settle_time_step({}).seconds);
}

TEST(TimeStep, IsAdvisedAgainstWhereItIsTooSmallOrTooLarge) {
  for (const double part : {0.15, 0.21, 0.355, 0.566, 0.7}) {
    EXPECT_FALSE(time_step_advice({1e-5, 0.1, part}, "steps_per_cycle")) << part;
  }
  const auto small = time_step_advice({1e-6, 0.003, 0.01}, "steps_per_cycle");
  const auto large = time_step_advice({1e-4, 0.3, 0.8}, "settle_time_step_s");
  ASSERT_TRUE(small && large);
  EXPECT_NE(small->find("steps_per_cycle: the time step of 1e-06 s is 0.01 of the stability limit, "
                        "below 0.15"),
            std::string::npos)
      << *small;
  EXPECT_NE(large->find("settle_time_step_s"), std::string::npos) << *large;
  EXPECT_NE(large->find("above 0.7"), std::string::npos) << *large;
}

TEST(TimeStep, WarnsInAPlanUnlessNoTimePasses) {
  const auto warnings = [](const std::string& base) {
    return expand(parse_manifest("experiment: a\nbase: {" + base + "}\n", "test.yaml")).warnings;
  };
  EXPECT_TRUE(warnings("grains: 600").empty());
  EXPECT_EQ(warnings("grains: 600, steps_per_cycle: 1000000").size(), 1U);
  EXPECT_EQ(warnings("grains: 600, steps_per_cycle: 18000").size(), 1U);
  EXPECT_EQ(warnings("grains: 600, settle_time_step_s: 1e-6").size(), 1U);
  EXPECT_EQ(warnings("grains: 600, protocol: stiffen, steps_per_cycle: 1000000"),
            std::vector<std::string>{"test.yaml:2:57: steps_per_cycle: has no effect: not under "
                                     "protocol stiffen. Leave it out."});
}

TEST(Overlap, FollowsPressureStiffnessAndWeight) {
  Parameters p;
  p.gravity_m_per_s2 = 0;
  // 0.75 P d/k, with P d/k = 4.376e-3.
  EXPECT_NEAR(expected_overlap(p), 3.282e-3, 1e-6);
  p.pressure_Pa *= 2;
  p.stiffness_N_per_m *= 4;
  EXPECT_NEAR(expected_overlap(p), 1.641e-3, 1e-6);
  Parameters bottom, top;
  top.moving_wall = MovingWall::top;
  Parameters weightless;
  weightless.gravity_m_per_s2 = 0;
  EXPECT_LT(expected_overlap(bottom), expected_overlap(weightless));
  EXPECT_NEAR(expected_overlap(bottom) + expected_overlap(top), 2 * expected_overlap(weightless),
              1e-12);
}

}  // namespace
}  // namespace shearcell
