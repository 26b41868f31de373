// SPDX-License-Identifier: GPL-3.0-or-later
// Each protocol and cell of the supplement, from manifest to recorded states: paused shear (B.5),
// the top wall moving (B.6), no gravity (D), stiffening (B.2).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "core/simulation.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/runner/stage.hpp"
#include "protocols/rest.hpp"
#include "tests/experiments/temporary_store.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

class Protocols : public StoreTest {
 protected:
  std::vector<Checkpoint> states(const Stage& run) {
    std::vector<Checkpoint> found;
    for (const CheckpointRecord& record : store_.checkpoints(run.id)) {
      found.push_back(store_.load_checkpoint(record));
    }
    return found;
  }

  void expect_completed(const CampaignResult& result, std::size_t stages) {
    EXPECT_EQ(result.completed, stages);
    EXPECT_EQ(result.failed + result.damaged + result.blocked, 0U);
  }

  void expect_replays(const Stage& run) {
    for (const CheckpointRecord& record : store_.checkpoints(run.id)) {
      const Replay replay = verify_by_replay(store_, record, 2);
      EXPECT_FALSE(replay.divergence) << record.cycle << ": " << replay.divergence->message;
    }
  }
};

TEST_F(Protocols, PausedShearRecordsTheEndsOfItsPauses) {
  const std::string pause = "  pause_s: 0.3\n";
  expect_completed(
      compute(store_, tiny_manifest(pause, "sweep: {grid: {protocol: [continuous, paused]}}\n")),
      3);
  const auto runs = runs_of_kind(store_, "shear");
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_EQ(runs[0].parent, runs[1].parent);
  EXPECT_FALSE(runs[0].resolved.at("parameters").contains("pause_s"));
  EXPECT_EQ(runs[1].resolved.at("parameters").at("pause_s"), 0.3);

  const auto continuous = states(runs[0]), paused = states(runs[1]);
  ASSERT_EQ(paused.size(), 3U);
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_EQ(paused[n].cycle, static_cast<double>(n));
    EXPECT_EQ(paused[n].state.step, n * (kStepsPerCycle + 3000));
    EXPECT_EQ(paused[n].theta, 0) << "upright";
    EXPECT_NEAR(paused[n].time_s, 1.3 * static_cast<double>(n), 1e-12);
  }
  // The first cycles are the same; then one of the two rests between walls at rest.
  const Parameters p = read_stage(runs[0].resolved).parameters;
  const State rest = rested(continuous[1].cell, shear_scene(p), continuous[1].state, 0.3);
  EXPECT_EQ(rest.position, paused[1].state.position);
  EXPECT_EQ(rest.velocity, paused[1].state.velocity);
  EXPECT_EQ(rest.wall_height, paused[1].state.wall_height);
  EXPECT_LT(paused[1].observables.at("kinetic_energy_per_grain_m_d2_per_s2"),
            0.1 * continuous[1].observables.at("kinetic_energy_per_grain_m_d2_per_s2"));
  expect_replays(runs[1]);
}

TEST_F(Protocols, InterruptingAPauseChangesNothing) {
  const std::string text = tiny_manifest("  protocol: paused\n  cycles: 1\n");
  const std::vector<StageJob> jobs = declared(store_, text);
  EXPECT_EQ(run_stage(store_, jobs.at(0).id, {}), StageOutcome::completed);
  bool within_pause = false;
  interrupt_to_the_end(store_, jobs.at(1).id, [&] {
    const std::uint64_t step = store_.checkpoints(jobs[1].id).back().step;
    within_pause = within_pause || (step > kStepsPerCycle && step < 3 * kStepsPerCycle);
  });
  EXPECT_TRUE(within_pause);
  EXPECT_EQ(final_hashes(store_), undisturbed(text));
}

TEST_F(Protocols, EitherWallMovesWithAndWithoutGravity) {
  expect_completed(compute(store_, tiny_manifest("  cycles: 1\n",
                                                 "sweep: {grid: {moving_wall: [bottom, top], "
                                                 "gravity_m_per_s2: [9.81, 0]}}\n")),
                   8);
  std::vector<double> heights;
  for (const Stage& run : runs_of_kind(store_, "shear")) {
    const Parameters p = read_stage(run.resolved).parameters;
    const auto recorded = states(run);
    ASSERT_EQ(recorded.size(), 2U);
    const Checkpoint& settled = recorded.front();
    const Checkpoint& end = recorded.back();
    const bool top = p.moving_wall == MovingWall::top;
    EXPECT_EQ(settled.cell.moving, p.moving_wall);
    const double fixed = top ? settled.cell.bottom : settled.cell.top;
    for (const Checkpoint& c : recorded) {
      EXPECT_NEAR(c.observables.at("cell_height_d"), std::fabs(c.state.wall_height - fixed), 1e-12);
    }
    EXPECT_LE(std::fabs(settled.observables.at("wall_force_imbalance")), p.settle_force_tolerance);
    // The wall follows the grains as they compact, upwards or downwards.
    const double way = (end.state.wall_height - settled.state.wall_height) * (top ? -1 : 1);
    std::printf("%s moves, g = %g: settled at %.3f d, %.4f d in a cycle\n", top ? "top" : "bottom",
                p.gravity_m_per_s2, settled.observables.at("cell_height_d"), way);
    EXPECT_GT(way, 0);
    heights.push_back(settled.observables.at("cell_height_d"));
  }
  ASSERT_EQ(heights.size(), 4U);
  for (const double height : heights) EXPECT_NEAR(height / heights.front(), 1, 0.05);
}

const std::string kStiffen = "  protocol: stiffen\n";

TEST_F(Protocols, StiffeningRecordsEachSpringConstantAtRest) {
  expect_completed(compute(store_, tiny_manifest(kStiffen)), 2);
  const Stage run = runs_of_kind(store_, "stiffen").at(0);
  EXPECT_EQ(run.target_cycles, 9U);
  EXPECT_EQ(run.cycle, 9);
  EXPECT_EQ(cycles_of(store_, run.id), (std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
  const auto recorded = states(run);
  double before = 1;
  for (std::size_t n = 0; n < recorded.size(); ++n) {
    const auto& facts = recorded[n].observables;
    const double decades = n == 0 ? 0 : static_cast<double>(n - 1) / 4;
    EXPECT_NEAR(facts.at("stiffness_N_per_m"), 654 * std::pow(10, decades), 1e-8);
    if (n == 0) continue;
    EXPECT_LE(facts.at("force_residual_P_d2"), 1.001e-4);
    EXPECT_LE(std::fabs(facts.at("wall_force_imbalance")), 1.001e-4);
    EXPECT_LT(facts.at("mean_overlap_d"), before);
    EXPECT_EQ(recorded[n].theta, 0);
    EXPECT_EQ(recorded[n].time_s, 0);
    before = facts.at("mean_overlap_d");
  }
  EXPECT_GT(recorded[9].observables.at("cell_height_d"),
            1.005 * recorded[0].observables.at("cell_height_d"));
  EXPECT_GT(run.particle_steps, 1000.0 * kGrains) << "counts the evaluations of the forces";
  expect_replays(run);
}

TEST_F(Protocols, ExtendingAndInterruptingStiffeningChangesNothing) {
  compute(store_, tiny_manifest(kStiffen + "  stiffness_decades: 1\n"));
  EXPECT_EQ(runs_of_kind(store_, "stiffen").at(0).cycle, 5);

  const std::vector<StageJob> jobs = declared(store_, tiny_manifest(kStiffen));
  EXPECT_EQ(interrupt_to_the_end(store_, jobs.at(1).id), 3U)
      << "once after each stiffness but the last";
  EXPECT_EQ(final_hashes(store_), undisturbed(tiny_manifest(kStiffen)));
}

TEST_F(Protocols, AnUnreachableToleranceFailsTheRunWithARemedy) {
  // Forces of 1e-25 P d^2 are lost in the rounding of the contact sums.
  const CampaignResult result = compute(
      store_, tiny_manifest(kStiffen + "  grains: 80\n  minimize_force_tolerance: 1.0e-25\n"));
  EXPECT_EQ(result.failed, 1U);
  const Stage run = runs_of_kind(store_, "stiffen").at(0);
  EXPECT_EQ(run.state, StageState::failed);
  EXPECT_TRUE(has(run.error, "minimize_force_tolerance"));
  EXPECT_EQ(cycles_of(store_, run.id), (std::vector<double>{0}));
}

}  // namespace
}  // namespace shearcell::test
