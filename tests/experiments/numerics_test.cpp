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

TEST(TimeStep, FollowsTheStiffnessWhereItIsAuto) {
  const auto runs_of = [](const std::string& base, const std::string& sweep = "") {
    return expand(parse_manifest("experiment: a\nbase: {grains: 600, " + base + "}\n" + sweep,
                                 "test.yaml"))
        .runs;
  };
  const std::string autos = "steps_per_cycle: auto, settle_time_step_s: auto";
  // Table I's own numbers, and so the ids of runs that state them.
  EXPECT_EQ(runs_of(autos).front().last.key, runs_of("cycles: 200").front().last.key);
  const auto swept =
      runs_of(autos, "sweep: {grid: {stiffness_N_per_m: [654, 2616, 65400], period_s: [2, 4]}}");
  ASSERT_EQ(swept.size(), 6U);
  const std::uint64_t steps[] = {45600, 91200, 91200, 182400, 456000, 912000};
  for (std::size_t i = 0; i < swept.size(); ++i) {
    const Parameters& p = swept[i].parameters;
    EXPECT_EQ(p.steps_per_cycle, steps[i]);
    EXPECT_EQ(p.settle_time_step_s, 2.0 / static_cast<double>(steps[i / 2 * 2]));
    EXPECT_NEAR(shear_time_step(p).over_stability_limit, 0.3547, 1e-4);
    EXPECT_EQ(swept[i].variant.find("steps_per_cycle"), std::string::npos) << swept[i].variant;
  }
  // A swept key and a scale's number override it.
  EXPECT_EQ(runs_of(autos, "sweep: {grid: {steps_per_cycle: [91200, 45600]}}")
                .front()
                .parameters.steps_per_cycle,
            91200U);
  EXPECT_EQ(
      runs_of(autos, "scales: {desk: {steps_per_cycle: 50000}}").front().parameters.steps_per_cycle,
      50000U);
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
  Parameters bottom, lifting, top;
  lifting.pressure_at = PressureAt::moving_wall;
  top.moving_wall = MovingWall::top;
  Parameters weightless;
  weightless.gravity_m_per_s2 = 0;
  EXPECT_LT(expected_overlap(lifting), expected_overlap(weightless));
  EXPECT_EQ(expected_overlap(bottom), expected_overlap(top));
  EXPECT_NEAR(expected_overlap(lifting) + expected_overlap(top), 2 * expected_overlap(weightless),
              1e-12);
}

}  // namespace
}  // namespace shearcell
