// SPDX-License-Identifier: GPL-3.0-or-later
// The cost of a campaign by `plan`, compared with its real cost.

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <regex>
#include <sstream>

#include "core/drive.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/runner/outlook.hpp"
#include "protocols/settle.hpp"
#include "provenance/words.hpp"
#include "tests/experiments/temporary_store.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

PlannedRun only_run(const std::string& text) {
  return expand(parse_manifest(text, "t")).runs.at(0);
}

/// What is left of a stage of the run that nobody computed, or up to this cycle.
Outlook left_of(const PlannedRun& run, const Stage& planned, double cycle = -1) {
  Stage stage = planned;
  std::vector<CheckpointRecord> seen;
  if (cycle >= 0) {
    stage.cycle = cycle;
    stage.step = static_cast<std::uint64_t>(std::llround(cycle * kStepsPerCycle));
    seen.emplace_back();
    for (const std::uint64_t step : asked_checkpoints(stage, {&run.ask, 1}, {}, 0, cycle).missing) {
      seen.emplace_back().step = step;
    }
    seen.emplace_back().step = stage.step;
  }
  return outlook(stage, asks_of(run.stage.memberships), seen);
}

double bytes_of(const Store& store, const std::string& run) {
  double bytes = 0;
  for (const CheckpointRecord& record : store.checkpoints(run)) {
    bytes += static_cast<double>(record.size);
    EXPECT_EQ(record.size, std::filesystem::file_size(store.folder() / record.file));
  }
  return bytes;
}

TEST(Cost, AskedCheckpointsAreMadeMissingOrToCome) {
  const PlannedRun run = only_run(tiny_manifest("  cycles: 4\n"));
  constexpr std::uint64_t cycle = kStepsPerCycle;
  Stage stage = run.stage;
  stage.step = 2 * cycle;
  std::vector<CheckpointRecord> seen(3);
  seen[1].step = cycle + 1;  // an interruption left it
  seen[2].step = 2 * cycle;
  const AskedCheckpoints all = asked_checkpoints(stage, {&run.ask, 1}, seen);
  ASSERT_EQ(all.made.size(), 2U);
  EXPECT_EQ(all.made[1].step, 2 * cycle);
  EXPECT_EQ(all.missing, std::vector<std::uint64_t>{cycle});
  EXPECT_EQ(all.to_come, 2);
  const AskedCheckpoints some = asked_checkpoints(stage, {&run.ask, 1}, seen, 2, 3);
  EXPECT_EQ(some.made.size(), 1U);
  EXPECT_TRUE(some.missing.empty());
  EXPECT_EQ(some.to_come, 1);
}

TEST(Cost, CountsParticleSteps) {
  const PlannedRun run = only_run(tiny_manifest());
  EXPECT_EQ(left_of(run, run.stage).particle_steps, 2.0 * kGrains * kStepsPerCycle);
  EXPECT_EQ(left_of(run, run.stage, 0.5).particle_steps, 1.5 * kGrains * kStepsPerCycle);
  EXPECT_EQ(left_of(run, run.stage, 7).particle_steps, 0);
  EXPECT_EQ(left_of(run, run.stage, 7).bytes, 0);
  EXPECT_GT(left_of(run, *run.prepare).particle_steps, 0);
}

TEST(Cost, CountsCheckpoints) {
  const PlannedRun run = only_run(tiny_manifest());
  const double both = left_of(run, run.stage).bytes;  // cycles 0, 1, 2
  const double file = both - left_of(run, run.stage, 1).bytes * 2;
  EXPECT_GT(file, 0);
  EXPECT_NEAR(left_of(run, run.stage, 1).bytes, file, 1e-6 * file);
  const PlannedRun loops = only_run(tiny_manifest("", "checkpoints: {phases: [0.25, 0.5]}\n"));
  const PlannedRun rare = only_run(tiny_manifest("", "checkpoints: {every_cycles: 2}\n"));
  EXPECT_NEAR(left_of(rare, rare.stage).bytes, 2 * file, 1e-6 * file);
  EXPECT_NEAR(left_of(loops, loops.stage).bytes, 7 * file, 1e-6 * file);
  EXPECT_NEAR(left_of(loops, loops.stage, 1).bytes, 3 * file, 1e-6 * file);
}

TEST(Cost, OfStiffeningCountsTheRemainingSpringConstants) {
  const PlannedRun run = only_run(tiny_manifest("  protocol: stiffen\n"));
  const Outlook all = left_of(run, run.stage);
  EXPECT_GT(all.particle_steps, 0);
  EXPECT_NEAR(left_of(run, run.stage, 6).particle_steps, all.particle_steps / 3, 1);
  EXPECT_NEAR(left_of(run, run.stage, 6).bytes, all.bytes * 3 / 10, 1) << "cycles 0 to 9";
  EXPECT_EQ(left_of(run, run.stage, 9).particle_steps, 0);
}

/// Texts of values of a number: both ends of its range, and many inside.
std::vector<std::string> values_of(const Field& field) {
  std::vector<std::string> values;
  const auto add = [&](double value) {
    if (field.whole) value = std::round(value);
    if (!field.range.contains(value)) return;
    values.push_back(field.whole ? fmt::format("{:.0f}", value) : fmt::format("{}", value));
  };
  add(field.range.min);
  add(field.range.max);
  for (const double tiny : {4.9e-324, 1e-320, 1e-308, 1e-300, 1e-150, 1e-30}) add(tiny);
  for (int exponent = -18; exponent <= 15; ++exponent) {
    for (const double digit : {1.0, 4.7}) add(digit * std::pow(10, exponent));
  }
  return values;
}

// What is stated on lines 3 and 4 of this text is either refused there, with a remedy, or leads to
// stages whose size, steps and printed numbers are bounded.
void expect_bounded(const std::string& text) {
  SCOPED_TRACE(text);
  try {
    const Plan plan = expand(parse_manifest(text, "t"));
    for (const std::string& warning : plan.warnings) {
      for (const char* odd : {"nan", "inf "}) EXPECT_FALSE(has(warning, odd));
    }
    for (const PlannedRun& run : plan.runs) {
      const Parameters& p = run.parameters;
      const Geometry shape = geometry(p);
      EXPECT_FALSE(too_large(shape));
      EXPECT_LE(p.settle_time_limit_s / p.settle_time_step_s, kMostSteps);
      EXPECT_LE(
          static_cast<double>(run.ask.target_cycles) * static_cast<double>(cycle_steps(drive(p))),
          2 * kMostSteps);
      EXPECT_TRUE(std::isfinite(expected_overlap(p)));
      for (const TimeStep& step :
           {time_step(p, shear_time_step_s(p)), time_step(p, p.settle_time_step_s)}) {
        EXPECT_TRUE(step.seconds > 0 && std::isfinite(step.over_stability_limit));
      }
      for (const Stage* stage : {&*run.prepare, &run.stage}) {
        const Outlook cost = left_of(run, *stage);
        EXPECT_TRUE(cost.particle_steps >= 0 && cost.particle_steps < 1e25) << cost.particle_steps;
        EXPECT_TRUE(cost.bytes >= 0 && cost.bytes < 1e20) << cost.bytes;
        const std::string time = format_duration(cost.particle_steps / 1e3);
        EXPECT_EQ(time.find_first_of("-?"), std::string::npos) << time;
      }
    }
  } catch (const ManifestError& error) {
    static const std::regex form(R"(t:(\d+):\d+: (\w+): .*\. .+)");  // line, key, remedy
    bool placed = false;
    std::istringstream problems(error.what());
    for (std::string problem; std::getline(problems, problem);) {
      std::smatch found;
      ASSERT_TRUE(std::regex_match(problem, found, form)) << problem;
      EXPECT_NE(find_field(found.str(2)), nullptr) << problem;
      placed = placed || std::stoi(found.str(1)) >= 3;
    }
    EXPECT_TRUE(placed) << error.what();
  }
}

TEST(Cost, OfEveryAllowedValueIsFiniteOrRejected) {
  const std::vector<std::string> others = {"walls: rough",        "walls: smooth",
                                           "protocol: paused",    "protocol: stiffen",
                                           "gravity_m_per_s2: 0", "grains: 100"};
  std::size_t count = 0;
  for (const Field& field : schema()) {
    if (field.is_choice()) continue;
    for (const std::string& value : values_of(field)) {
      for (const std::string& other : others) {
        if (other.starts_with(std::string(field.name) + ":")) continue;
        expect_bounded(
            fmt::format("experiment: a\nbase:\n  {}\n  {}: {}\n", other, field.name, value));
        ++count;
      }
    }
  }
  std::printf("%zu manifests\n", count);
}

TEST(Cost, ADurationIsAlwaysReadable) {
  EXPECT_EQ(format_duration(9.3e27), "2.95e+20 years");
  EXPECT_EQ(format_duration(86400.0 * 365), "365 d 00 h");
}

using CostOfARun = StoreTest;

TEST_F(CostOfARun, IsNearTheMeasuredDiskSpaceAndSettlingTime) {
  for (const char* texture : {"rough", "smooth"}) {
    const std::string text =
        tiny_manifest("  grains: 600\n  walls: " + std::string(texture) + "\n");
    compute(store_, text);
    const PlannedRun run = only_run(text);
    for (const Stage* stage : {&*run.prepare, &run.stage}) {
      const Outlook expected = left_of(run, *stage);
      const double bytes = bytes_of(store_, stage->id);
      const double steps = store_.stage(stage->id).particle_steps;
      std::printf("%s %s: %.4g bytes, expected %.4g; %.4g particle-steps, expected %.4g\n", texture,
                  stage->kind.c_str(), bytes, expected.bytes, steps, expected.particle_steps);
      EXPECT_NEAR(expected.bytes / bytes, 1, 0.3);
      EXPECT_NEAR(expected.particle_steps / steps, 1, 0.4);
    }
  }
}

TEST_F(CostOfARun, CountsTheTimeThatAWeakDragTakesToSettle) {
  const std::string text =
      tiny_manifest("  drag_kg_per_s: 1.28e-4\n  settle_time_step_s: 4.4e-5\n");
  compute(store_, text);
  const PlannedRun run = only_run(text);
  const double steps = store_.stage(run.prepare->id).particle_steps;
  const double expected = left_of(run, *run.prepare).particle_steps;
  std::printf("%.4g particle-steps, expected %.4g\n", steps, expected);
  EXPECT_NEAR(expected / steps, 1, 0.3);
  const PlannedRun undamped = only_run(tiny_manifest("  drag_kg_per_s: 0\n"));
  const Parameters& parameters = undamped.parameters;
  EXPECT_EQ(left_of(undamped, *undamped.prepare).particle_steps,
            static_cast<double>(parameters.grains) *
                std::ceil(parameters.settle_time_limit_s / parameters.settle_time_step_s));
}

// Twice the time passes the limit; the estimate of the time in which the wall presses is a little
// long, so that it warns of no run that settles.
TEST_F(CostOfARun, CountsTheTimeThatAStrongDragTakesToSettle) {
  const auto text = [](double limit_s) {
    return tiny_manifest(fmt::format(
        "  drag_kg_per_s: 5.0e-2\n  settle_time_step_s: 4.4e-5\n  settle_time_limit_s: {}\n",
        limit_s));
  };
  const auto warnings = [](const std::string& manifest) {
    return fmt::format("{}", fmt::join(expand(parse_manifest(manifest, "m"), {}).warnings, "\n"));
  };
  EXPECT_FALSE(has(warnings(text(60)), "presses the grains together"));
  compute(store_, text(60));
  const PlannedRun run = only_run(text(60));
  const Stage settled = store_.stage(run.prepare->id);
  const double seconds = static_cast<double>(settled.step) * run.parameters.settle_time_step_s;
  const double expected = pressing_time_s(run.parameters);
  std::printf("settled after %.3g s, pressed for %.3g s as expected\n", seconds, expected);
  EXPECT_GT(seconds, expected);
  EXPECT_LT(seconds, 2 * expected);
  const std::string too_short = text(0.9 * expected);
  EXPECT_TRUE(has(warnings(too_short), "drag_kg_per_s 0.05"));
  EXPECT_TRUE(has(warnings(too_short), "Change the drag"));
  EXPECT_TRUE(has(warnings(tiny_manifest("  drag_kg_per_s: 1.28e3\n")), "drag_kg_per_s 1280"));
}

TEST(Cost, UsesTheRateMeasuredInTheStore) {
  Stage run;
  run.particle_steps = 3e8;
  run.wall_seconds = 10;
  Stage other = run;
  other.particle_steps = 1e8;
  const Rate rate = Rates({run, other}).of(run);
  EXPECT_TRUE(rate.measured);
  EXPECT_EQ(rate.particle_steps_per_second, 2e7);
}

Stage stage_of(EngineKind engine, double grains) {
  Stage stage;
  stage.resolved = {{"parameters", {{"engine", name_of(engine)}}}};
  stage.grains = static_cast<std::uint64_t>(grains);
  return stage;
}

TEST(Cost, AssumesRatesThatFallWithTheNumberOfGrains) {
  for (const EngineKind engine : {EngineKind::shearcell, EngineKind::lammps}) {
    double before = 1e9;
    for (const double grains : {5200.0, 2e4, 1e5}) {
      const Rate rate = Rates({}).of(stage_of(engine, grains));
      EXPECT_FALSE(rate.measured);
      EXPECT_LT(rate.particle_steps_per_second, before);
      before = rate.particle_steps_per_second;
    }
    const auto at = [engine](double n) {
      return Rates({}).of(stage_of(engine, n)).particle_steps_per_second;
    };
    EXPECT_EQ(at(100), at(5200));
    EXPECT_EQ(at(1e7), at(1e8));
  }
  const auto lammps = [](double n) {
    return Rates({}).of(stage_of(EngineKind::lammps, n)).particle_steps_per_second;
  };
  EXPECT_EQ(lammps(5200), 6.6e6);
  EXPECT_NEAR(lammps(1e5), 3.0e6, 1);
  const double between = 22803, power = std::log(3.0 / 6.6) / std::log(1e5 / 5200);
  EXPECT_NEAR(lammps(between), 6.6e6 * std::pow(between / 5200, power), 1) << "a power of N";
}

}  // namespace
}  // namespace shearcell::test
