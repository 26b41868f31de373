// SPDX-License-Identifier: GPL-3.0-or-later
// Parameters: the schema and the struct agree, conversion to the engine's units, and the time step
// and overlap that follow from a manifest.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <set>
#include <string>

#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/suggest.hpp"
#include "provenance/json_text.hpp"
#include "tests/experiments/plan_of.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

using nlohmann::json;

TEST(Schema, NamesAreUniqueAndDefaultsAllowed) {
  std::set<std::string_view> names;
  for (const Field& field : schema()) {
    EXPECT_TRUE(names.insert(field.name).second) << field.name;
    EXPECT_EQ(check_value(field, field.get(Parameters{})), std::nullopt) << field.name;
    EXPECT_FALSE(field.doc.empty()) << field.name;
    if (const std::string_view omitted = field.identity.omitted_at; !omitted.empty()) {
      const auto value = read_value(field, omitted, false);
      ASSERT_TRUE(std::holds_alternative<json>(value)) << field.name;
      EXPECT_EQ(value_text(std::get<json>(value)), omitted) << field.name;
    }
  }
}

TEST(Suggest, FindsTheIntendedName) {
  const auto names = names_of(schema());
  EXPECT_EQ(suggest_name("stifness_N_per_m", names), "stiffness_N_per_m");
  EXPECT_EQ(suggest_name("grians", names), "grains");
  EXPECT_EQ(suggest_name("Mass_KG", names), "mass_kg");
  EXPECT_EQ(suggest_name("k", names), "stiffness_N_per_m");
  EXPECT_EQ(suggest_name("mass", names), "mass_kg");
  EXPECT_EQ(suggest_name("stiffness", names), "stiffness_N_per_m");
  EXPECT_EQ(suggest_name("settle", names), "settle_time_step_s") << "the first with a unit";
  EXPECT_EQ(suggest_name("colour", names), "");
  EXPECT_EQ(suggest_name("omega", names), "period_s");
  EXPECT_EQ(suggest_name("Angular frequency", names), "period_s");
  EXPECT_EQ(suggest_name("number_of_particles", names), "grains");
  EXPECT_EQ(suggest_name("", names), "");
  EXPECT_EQ(suggest_name(std::string(100'000, 'm'), names), "");
}

TEST(Suggest, KnowsWhatPeopleTry) {
  const auto names = names_of(schema());
  const auto remark = [&](const char* name) {
    const Tried* found = find_tried(name, names);
    return found == nullptr ? "" : std::string(found->remark);
  };
  EXPECT_TRUE(has(remark("coefficient_of_friction"), "Grains are frictionless."));
  EXPECT_TRUE(has(remark("frequency_Hz"), "1 divided by the frequency"));
  EXPECT_TRUE(has(remark("gamma_dot"), "The walls oscillate"));
  EXPECT_EQ(find_tried("z", names), nullptr) << "a measure, and no parameter";
}

// Whatever a manifest states, its values in units of d, m and s are numbers.
TEST(Conversion, StaysFiniteAtTheEndsOfTheRanges) {
  const std::vector<std::string> keys = {"mass_kg",       "diameter_m",       "stiffness_N_per_m",
                                         "drag_kg_per_s", "gravity_m_per_s2", "pressure_Pa",
                                         "period_s",      "steps_per_cycle",  "pause_s"};
  for (unsigned ends = 0; ends < 1U << keys.size(); ++ends) {
    Parameters p;
    for (std::size_t k = 0; k < keys.size(); ++k) {
      const Field& field = *find_field(keys[k]);
      const double end = (ends >> k & 1U) != 0 ? field.range.max : field.range.min;
      field.set(p, field.whole ? json(static_cast<std::uint64_t>(end)) : json(end));
    }
    const Scene scene = shear_scene(p);
    for (const double value : {scene.stiffness, scene.time_step, scene.pressure,
                               scene.pressure / scene.stiffness, stability_limit_s(p)}) {
      EXPECT_TRUE(std::isnormal(value) && value > 0) << value;
    }
    for (const double value :
         {scene.drag_rate, scene.gravity, pause_time_steps(p), expected_overlap(p),
          time_step(p, p.settle_time_step_s).over_stability_limit,
          time_step(p, shear_time_step_s(p)).over_contact_time}) {
      EXPECT_TRUE(std::isfinite(value)) << value;
    }
  }
}

// Table I in units of d, m and s.
TEST(Conversion, GivesTheNumbersOfTableOne) {
  const Scene scene = shear_scene({});
  EXPECT_NEAR(scene.stiffness, 3.27e7, 1);
  EXPECT_NEAR(scene.drag_rate, 64, 1e-9);
  EXPECT_NEAR(scene.gravity, 3270, 1e-9);
  EXPECT_NEAR(scene.pressure, 1.431e5, 1e-6);
  EXPECT_EQ(scene.time_step, 2.0 / 45600);
  EXPECT_EQ(scene.wall_mass, 10);
  EXPECT_EQ(scene.wall_drag, 1000);
  EXPECT_EQ(units({}).diameter_m, 3e-3);
  EXPECT_EQ(units({}).mass_kg, 2e-5);
  EXPECT_EQ(drive({}).amplitude, 0.0833);
  EXPECT_EQ(drive({}).steps_per_cycle, 45600U);
  EXPECT_EQ(drive({}).pause_steps, 0U);
}

TEST(Conversion, APauseHasAWholeNumberOfSteps) {
  Parameters parameters{.protocol = ProtocolKind::paused};
  EXPECT_EQ(drive(parameters).pause_steps, 45600U) << "2 s, as long as a cycle";
  parameters.pause_s = 1.00003;  // 22800.7 steps
  EXPECT_EQ(drive(parameters).pause_steps, 22801U);
  parameters.pause_s = 1e-9;
  EXPECT_EQ(drive(parameters).pause_steps, 1U);
  // From a record of a store, which no manifest's check has seen.
  parameters.pause_s = 1e6;
  parameters.period_s = 1e-300;
  EXPECT_EQ(drive(parameters).pause_steps, 1'000'000'000U);
}

TEST(Conversion, SettlesInAFluidAtRestWithItsOwnTimeStep) {
  const Parameters parameters{.fluid = Fluid::cell, .steps_per_cycle = 100'000};
  EXPECT_EQ(shear_scene(parameters).fluid, Fluid::cell);
  const Scene settle = settle_scene(parameters);
  EXPECT_EQ(settle.fluid, Fluid::still);
  EXPECT_EQ(settle.time_step, 2.0 / 45600);
  EXPECT_EQ(settle.stiffness, shear_scene(parameters).stiffness);
}

TEST(Conversion, KeepsTheGeometry) {
  const Geometry shape = geometry(
      {.walls = WallTexture::smooth, .moving_wall = MovingWall::top, .wall_grain_draw = 1'000'000});
  EXPECT_EQ(shape.grains, 7900U);
  EXPECT_EQ(shape.height_over_width, 1.675);
  EXPECT_EQ(shape.nominal_packing_fraction, 0.64);
  EXPECT_EQ(shape.fill_packing_fraction, 0.28);
  EXPECT_EQ(shape.walls, WallTexture::smooth);
  EXPECT_EQ(shape.wall_grain_area_fraction, 0.52);
  EXPECT_EQ(shape.wall_grain_recess, 0.25);
  EXPECT_EQ(shape.wall_grain_draw, 1'000'000U);
  EXPECT_EQ(geometry({}).wall_grain_draw, 0U);
  EXPECT_EQ(shape.moving, MovingWall::top);
}

// The largest eigenvalue of the dynamical matrix of an FCC crystal of springs, over the Brillouin
// zone: 8 k/m, on which the limit of the time step rests.
TEST(Conversion, StabilityLimitIsThatOfAnFccCrystal) {
  double largest = 0;
  constexpr int n = 16;
  for (int a = 0; a <= n; ++a) {
    for (int b = 0; b <= n; ++b) {
      for (int c = 0; c <= n; ++c) {
        const Eigen::Vector3d q = 2 * std::numbers::pi / n * Eigen::Vector3d(a, b, c);
        Eigen::Matrix3d dynamical = Eigen::Matrix3d::Zero();
        for (int axis = 0; axis < 3; ++axis) {
          for (const double sign : {1.0, -1.0}) {
            Eigen::Vector3d bond = Eigen::Vector3d::Zero();
            bond[axis] = 1;
            bond[(axis + 1) % 3] = sign;
            // Bond and opposite bond together, lattice constant 2.
            dynamical += 2 * (1 - std::cos(q.dot(bond))) * bond * bond.transpose() / 2;
          }
        }
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> modes(dynamical);
        largest = std::max(largest, modes.eigenvalues().maxCoeff());
      }
    }
  }
  EXPECT_NEAR(largest, 8, 1e-9);
  EXPECT_NEAR(stability_limit_s({}), 2 / std::sqrt(largest * 3.27e7), 1e-12);
}

TEST(TimeStep, OfTableI) {
  const TimeStep step = time_step({}, shear_time_step_s({}));
  EXPECT_NEAR(step.seconds, 4.386e-5, 1e-8);
  // k/m = 3.27e7 /s^2: pi/sqrt(2 k/m) = 3.885e-4 s, 2/sqrt(8 k/m) = 1.2365e-4 s.
  EXPECT_NEAR(step.over_contact_time, 0.1129, 1e-4);
  EXPECT_NEAR(step.over_stability_limit, 0.3547, 1e-4);
  EXPECT_EQ(step.seconds, Parameters{}.settle_time_step_s);
}

TEST(TimeStep, FollowsTheStiffnessIfAuto) {
  const auto runs_of = [](const std::string& base, const std::string& sweep = "") {
    return plan_of("grains: 600, " + base, sweep).runs;
  };
  const std::string autos = "steps_per_cycle: auto, settle_time_step_s: auto";
  // Table I's own numbers, and so the ids of runs that state them.
  EXPECT_EQ(runs_of(autos).front().stage.id, runs_of("cycles: 200").front().stage.id);
  const auto swept =
      runs_of(autos, "sweep: {grid: {stiffness_N_per_m: [654, 2616, 65400], period_s: [2, 4]}}");
  ASSERT_EQ(swept.size(), 6U);
  const std::uint64_t steps[] = {45600, 91200, 91200, 182400, 456000, 912000};
  for (std::size_t i = 0; i < swept.size(); ++i) {
    const Parameters& p = swept[i].parameters;
    EXPECT_EQ(p.steps_per_cycle, steps[i]);
    EXPECT_EQ(p.settle_time_step_s, 2.0 / static_cast<double>(steps[i / 2 * 2]));
    EXPECT_NEAR(time_step(p, shear_time_step_s(p)).over_stability_limit, 0.3547, 1e-4);
    EXPECT_FALSE(has(swept[i].place.variant, "steps_per_cycle"));
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

TEST(TimeStep, HasAWarningIfTooSmallOrTooLarge) {
  for (const double part : {0.15, 0.21, 0.355, 0.566, 0.7}) {
    EXPECT_FALSE(time_step_advice({1e-5, 0.1, part}, "steps_per_cycle")) << part;
  }
  const auto small = time_step_advice({1e-6, 0.003, 0.01}, "steps_per_cycle");
  const auto large = time_step_advice({1e-4, 0.3, 0.8}, "settle_time_step_s");
  ASSERT_TRUE(small && large);
  EXPECT_TRUE(has(*small,
                  "steps_per_cycle: the time step 1e-06 s is 0.01 times the stability limit "
                  "(below 0.15)"));
  EXPECT_TRUE(has(*large, "settle_time_step_s"));
  EXPECT_TRUE(has(*large, "above 0.7"));
}

TEST(TimeStep, HasNoWarningInAPlanWithoutTimeSteps) {
  const auto warnings = [](const std::string& base) { return plan_of(base).warnings; };
  EXPECT_TRUE(warnings("grains: 600").empty());
  EXPECT_EQ(warnings("grains: 600, steps_per_cycle: 1000000").size(), 1U);
  EXPECT_EQ(warnings("grains: 600, steps_per_cycle: 18000").size(), 1U);
  EXPECT_EQ(warnings("grains: 600, settle_time_step_s: 1e-6").size(), 1U);
  EXPECT_EQ(warnings("grains: 600, protocol: stiffen, steps_per_cycle: 1000000"),
            std::vector<std::string>{"test.yaml:2:57: steps_per_cycle: has no effect under "
                                     "protocol stiffen. Leave it out."});
}

TEST(Overlap, FollowsPressureStiffnessAndWeight) {
  Parameters p{.gravity_m_per_s2 = 0};
  // 0.75 P d/k, with P d/k = 4.376e-3.
  EXPECT_NEAR(expected_overlap(p), 3.282e-3, 1e-6);
  p.pressure_Pa *= 2;
  p.stiffness_N_per_m *= 4;
  EXPECT_NEAR(expected_overlap(p), 1.641e-3, 1e-6);
  const Parameters bottom, weightless{.gravity_m_per_s2 = 0};
  const Parameters lifting{.pressure_at = PressureAt::moving_wall};
  const Parameters top{.moving_wall = MovingWall::top};
  EXPECT_LT(expected_overlap(lifting), expected_overlap(weightless));
  EXPECT_EQ(expected_overlap(bottom), expected_overlap(top));
  EXPECT_NEAR(expected_overlap(lifting) + expected_overlap(top), 2 * expected_overlap(weightless),
              1e-12);
}

}  // namespace
}  // namespace shearcell::test
