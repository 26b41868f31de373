// SPDX-License-Identifier: GPL-3.0-or-later
// Where a shear begins: with a packing that settles under parameters of its own (`settle`), or with
// the recorded state of another run (`start`).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/filling.hpp"
#include "experiments/figures/collect.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/runner/audit.hpp"
#include "experiments/runner/stage.hpp"
#include "provenance/errors.hpp"
#include "provenance/sha256.hpp"
#include "tests/experiments/temporary_store.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

const std::string kTwoDrags = "sweep: {grid: {drag_kg_per_s: [1.28e-3, 1.28e-2]}}\n";

class Started : public StoreTest {
 protected:
  /// Computes a manifest whose `start` may name runs of the store.
  CampaignResult compute_here(const std::string& text, ExpandOptions options = {}) {
    const std::vector<Stage> known = store_.stages();
    options.known = known;
    return compute(store_, text, options);
  }

  std::string refusal(const std::string& text) {
    const std::vector<Stage> known = store_.stages();
    const Manifest manifest = parse_manifest(text, "tiny.yaml");
    return message_of<ManifestError>([&] { expand(manifest, {.known = known}); });
  }

  std::vector<Stage> runs_of(const std::string& experiment) {
    std::vector<Stage> found = runs_of_kind(store_, "shear");
    std::erase_if(found, [&](const Stage& run) {
      return run.memberships.front().place.experiment != experiment;
    });
    return found;
  }

  Checkpoint state_at(const Stage& run, double cycle) {
    for (const CheckpointRecord& record : store_.checkpoints(run.id)) {
      if (record.cycle == cycle) return store_.load_checkpoint(record);
    }
    throw NotFound("no such cycle");
  }

  /// Starts from cycle 1 of `tiny`, with other keys of `start` and of `base`.
  static std::string clones(const std::string& keys, const std::string& base = "",
                            const std::string& rest = "") {
    return renamed(
        tiny_manifest(
            base, fmt::format("start: {{experiment: tiny, seed: 1, cycle: 1{}}}\n", keys) + rest),
        "clones");
  }
};

using Settled = Started;

TEST_F(Settled, VariantsOfTheShearShareAPackingAndEachSettlesItsOwnWithoutSettle) {
  const auto packings = [](const std::string& rest) {
    std::set<std::string> ids;
    const Manifest manifest = parse_manifest(tiny_manifest("", kTwoDrags + rest), "tiny.yaml");
    for (const PlannedRun& run : expand(manifest).runs) ids.insert(run.prepare->id);
    return ids;
  };
  EXPECT_EQ(packings("").size(), 2U);
  EXPECT_EQ(packings("settle: {drag_kg_per_s: 1.28e-3}\n").size(), 1U);
  const std::string other = tiny_manifest("  drag_kg_per_s: 2.0e-3\n");
  EXPECT_EQ(packings("settle: {drag_kg_per_s: 2.0e-3}\n"),
            std::set{expand(parse_manifest(other, "tiny.yaml")).runs.front().prepare->id})
      << "the packing of a shear with that drag";
}

TEST_F(Settled, WhatSettleStatesIsTheDefaultOfNothing) {
  const auto ids = [](const std::string& rest) {
    const Plan plan = expand(parse_manifest(tiny_manifest("", rest), "tiny.yaml"));
    return plan.runs.front().prepare->id + plan.runs.front().stage.id;
  };
  EXPECT_EQ(ids(""), ids("settle: {drag_kg_per_s: 1.28e-3, gravity_m_per_s2: 9.81}\n"))
      << "the ids of what could be stated before do not change";
  EXPECT_NE(ids(""), ids("settle: {gravity_m_per_s2: 0}\n"));
}

TEST_F(Settled, AScaleReplacesSettleAsAWhole) {
  const Manifest manifest =
      parse_manifest(tiny_manifest("",
                                   "settle: {drag_kg_per_s: 2.0e-3}\n"
                                   "scales: {one: {}, two: {settle: {pressure_Pa: 500}}}\n"),
                     "tiny.yaml");
  const Parameters one = expand(manifest, {.scale = "one"}).runs.front().packing;
  const Parameters two = expand(manifest, {.scale = "two"}).runs.front().packing;
  EXPECT_EQ(one.drag_kg_per_s, 2.0e-3);
  EXPECT_EQ(two.drag_kg_per_s, Parameters{}.drag_kg_per_s);
  EXPECT_EQ(two.pressure_Pa, 500);
}

TEST_F(Settled, AutomaticTimeStepsFollowThePackingsOwnStiffness) {
  const Manifest manifest =
      parse_manifest(tiny_manifest("  steps_per_cycle: auto\n  settle_time_step_s: auto\n",
                                   "settle: {stiffness_N_per_m: 2616}\n"),
                     "tiny.yaml");
  const PlannedRun run = expand(manifest).runs.front();
  EXPECT_NEAR(run.packing.settle_time_step_s, run.parameters.settle_time_step_s / 2, 1e-8);
  EXPECT_EQ(run.packing.steps_per_cycle, 2 * run.parameters.steps_per_cycle);
}

TEST_F(Settled, DragUnderShearAloneIsComparedInPairs) {
  EXPECT_EQ(
      compute_here(tiny_manifest("", kTwoDrags + "settle: {drag_kg_per_s: 1.28e-3}\n")).completed,
      3U);
  const auto runs = runs_of("tiny");
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_EQ(state_at(runs[0], 0).state.position, state_at(runs[1], 0).state.position);
  EXPECT_NE(state_at(runs[0], 1).state.position, state_at(runs[1], 1).state.position);
}

// Forces depend on positions alone, and the walls are where they were: the same bits.
TEST_F(Started, WithoutNoiseTheRunGoesOnAsBefore) {
  compute_here(tiny_manifest("  cycles: 3\n"));
  EXPECT_EQ(compute_here(clones("")).completed, 1U) << "nothing settles";
  const Stage whole = runs_of("tiny").at(0), part = runs_of("clones").at(0);
  EXPECT_EQ(part.parent, whole.id);
  for (const double cycle : {0.0, 1.0, 2.0}) {
    const State had = state_at(whole, cycle + 1).state, has = state_at(part, cycle).state;
    EXPECT_EQ(has.position, had.position) << cycle;
    EXPECT_EQ(has.velocity, had.velocity);
    EXPECT_EQ(has.wall_height, had.wall_height);
    EXPECT_EQ(has.wall_velocity, had.wall_velocity);
    EXPECT_EQ(has.step, had.step - kStepsPerCycle);
  }
}

TEST_F(Started, EachSeedDrawsNoiseOfItsOwn) {
  compute_here(tiny_manifest());
  const std::string text = clones(", noise_d: 1.0e-6", "", "seeds: 2\n");
  EXPECT_EQ(compute_here(text).completed, 2U);
  const std::vector<Stage> known = store_.stages();
  const auto is_warned = [&](const std::string& planned) {
    return std::ranges::any_of(
        expand(parse_manifest(planned, "tiny.yaml"), {.known = known}).warnings,
        [](const std::string& w) { return has(w, "start: all 2 seeds give the same run."); });
  };
  EXPECT_FALSE(is_warned(text));
  EXPECT_TRUE(is_warned(clones("", "", "seeds: 2\n")));
  const auto two = runs_of("clones");
  const Checkpoint from = state_at(runs_of("tiny").at(0), 1);
  const Eigen::Matrix3Xd first = state_at(two[0], 0).state.position - from.state.position;
  const Eigen::Matrix3Xd second = state_at(two[1], 0).state.position - from.state.position;
  const auto count = static_cast<double>(first.size());
  EXPECT_NEAR(std::sqrt(first.squaredNorm() / count), 1e-6, 0.1e-6);
  EXPECT_NEAR(first.mean(), 0, 4e-6 / std::sqrt(count));
  EXPECT_LT(std::abs(first.cwiseProduct(second).mean()), 4e-12 / std::sqrt(count));
  EXPECT_EQ(state_at(two[0], 0).state.velocity, from.state.velocity);
}

TEST_F(Started, InterruptedAndComputedAgainItHasTheSameBits) {
  compute_here(tiny_manifest("  cycles: 1\n"));
  const std::vector<Stage> known = store_.stages();
  for (const StageJob& job : declared(store_, clones(", noise_d: 1.0e-13"), {.known = known})) {
    EXPECT_GT(interrupt_to_the_end(store_, job.id), 1U);
  }
  const Stage run = runs_of("clones").at(0);
  for (const CheckpointRecord& record : store_.checkpoints(run.id)) {
    EXPECT_FALSE(verify_by_replay(store_, record).divergence) << record.cycle;
  }
  EXPECT_TRUE(store_.verify().ok());
  EXPECT_TRUE(check_runs(store_).empty());
}

TEST_F(Started, CyclesAndSeedsOfTheRecordedRunsCanBeSwept) {
  compute_here(tiny_manifest("", "seeds: 2\n"));
  const std::string text = renamed(
      tiny_manifest("  cycles: 1\n",
                    "start: {experiment: tiny, noise_d: 1.0e-13}\n"
                    "sweep: {zip: {start_seed: [1, 2, 2], start_cycle: [0, 1, 2]}}\nseeds: 2\n"),
      "clones");
  EXPECT_EQ(compute_here(text).completed, 6U);
  std::set<std::string> parents;
  for (const Stage& run : runs_of("clones")) {
    const Stage parent = store_.stage(run.parent);
    EXPECT_EQ(parent.memberships.front().place.seed,
              run.memberships.front().place.swept.at("start_seed"));
    parents.insert(run.parent);
  }
  EXPECT_EQ(parents.size(), 2U);
  const auto found =
      collect_runs(store_, wanted_figures(store_, {"S2"}, {"clones"}).figures.at(0), {});
  for (const FrameRun& run : found.runs) {
    EXPECT_EQ(run.packing, store_.stage(run.stage.parent).parent) << "one packing";
  }
}

TEST_F(Started, RunsOfAnotherPlanAreKnownBeforeTheyAreComputed) {
  const std::string amplitudes = "sweep: {grid: {amplitude_rad: [0.05, 0.1]}}\n";
  const Plan first = expand(parse_manifest(tiny_manifest("", amplitudes), "tiny.yaml"));
  std::vector<Stage> known;
  add_as_computed(first, known);
  const auto second = [&](const std::string& keys, const std::string& sweep) {
    return expand(parse_manifest(clones(keys, "", sweep), "tiny.yaml"), {.known = known}).runs;
  };
  const auto runs = second("", amplitudes);
  ASSERT_EQ(runs.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(runs[k].stage.parent, first.runs[k].stage.id) << "of the same amplitude";
  }
  for (const char* variant : {"\"amplitude_rad=0.05\"", "{amplitude_rad: 0.05}", "\"A = 0.05 rad\"",
                              "{amplitude_rad: {max: 0.07}}"}) {
    EXPECT_EQ(second(fmt::format(", variant: {}", variant), amplitudes)[1].stage.parent,
              first.runs[0].stage.id)
        << variant;
  }
  const auto refused = [&](const std::string& sweep) {
    return message_of<ManifestError>([&] { second("", sweep); });
  };
  EXPECT_NE(refused("").find("more than one run of tiny"), std::string::npos);
  EXPECT_NE(refused("sweep: {grid: {amplitude_rad: [0.07]}}\n").find("has no run of tiny"),
            std::string::npos);
  EXPECT_NE(refused("sweep: {zip: {amplitude_rad: [0.1], start_cycle: [3]}}\n")
                .find("has no checkpoint at cycle 3. The newest checkpoint is at cycle 2."),
            std::string::npos);
  const Plan newer =
      expand(parse_manifest(tiny_manifest("  drag_kg_per_s: 2.0e-3\n", amplitudes), "tiny.yaml"));
  add_as_computed(newer, known);
  EXPECT_EQ(second("", amplitudes)[0].stage.parent, newer.runs[0].stage.id);
  const std::string sparse = tiny_manifest("  cycles: 3\n", "checkpoints: {every_cycles: 2}\n");
  known.clear();
  add_as_computed(expand(parse_manifest(sparse, "tiny.yaml")), known);
  EXPECT_NE(refused("").find(
                "has no checkpoint at cycle 1. The newest checkpoint is at cycle 3. Extend the "
                "run, name another cycle"),
            std::string::npos);
  EXPECT_EQ(second("", "sweep: {grid: {start_cycle: [0, 2, 3]}}\n").size(), 3U);
}

TEST_F(Started, AnIdNamesTheRecordedRunAsWell) {
  compute_here(tiny_manifest());
  const Stage run = runs_of("tiny").at(0);
  const std::string by_id = renamed(
      tiny_manifest("", fmt::format("start: {{checkpoint: {:.10}@1, noise_d: 1.0e-13}}\n", run.id)),
      "clones");
  const std::vector<Stage> known = store_.stages();
  const auto id_of = [&](const std::string& text) {
    return expand(parse_manifest(text, "tiny.yaml"), {.known = known}).runs.front().stage.id;
  };
  EXPECT_EQ(id_of(by_id), id_of(clones(", noise_d: 1.0e-13")));
}

TEST_F(Started, ThePruneKeepsItsStateOrItIsRecomputed) {
  compute_here(tiny_manifest("  cycles: 3\n"));
  const Stage whole = runs_of("tiny").at(0);
  const auto at_cycle_1 = [&] { return store_.checkpoints(whole.id, Listed::and_pruned).at(1); };
  const auto is_prunable = [&](const PruneChoice& choice) {
    const std::vector<CheckpointRecord> chosen = store_.prunable(choice);
    return std::ranges::count(chosen, at_cycle_1().sha256, &CheckpointRecord::sha256) > 0;
  };
  const PruneChoice sparse = {.runs = {}, .keep_every = 3}, all = {.runs = {}, .last_too = true};
  EXPECT_TRUE(is_prunable(sparse));
  const std::vector<Stage> known = store_.stages();
  const std::vector<StageJob> jobs = declared(store_, clones(""), {.known = known});
  EXPECT_FALSE(is_prunable(sparse)) << "a run that is declared will begin with it";
  EXPECT_FALSE(is_prunable(all));
  store_.prune({at_cycle_1()});
  ASSERT_EQ(at_cycle_1().state, CheckpointState::pruned);
  EXPECT_EQ(run_campaign(store_, jobs, 2, {}, true).completed, 1U);
  EXPECT_EQ(at_cycle_1().state, CheckpointState::recorded);
  EXPECT_FALSE(is_prunable(sparse)) << "a run began with it";
  EXPECT_TRUE(is_prunable(all));
}

TEST_F(Started, WhatWasPrunedIsRecomputedWhereItIsNeeded) {
  compute_here(tiny_manifest("  cycles: 3\n"));
  const std::string longer = tiny_manifest("  cycles: 4\n");
  const std::string whole = undisturbed(longer).at(runs_of("tiny").at(0).id);
  const std::string run = runs_of("tiny").at(0).id;
  EXPECT_GT(store_.prune(store_.prunable({.runs = {}, .last_too = true}), true), 0U);
  ASSERT_TRUE(cycles_of(store_, run).empty());
  const auto record = [&](std::size_t k) {
    return store_.checkpoints(run, Listed::and_pruned).at(k);
  };
  EXPECT_THROW(verify_by_replay(store_, record(2)), FilePruned) << "it writes no packing";
  EXPECT_FALSE(regenerate_checkpoint(store_, record(2)).divergence);
  EXPECT_EQ(cycles_of(store_, run), std::vector{2.0});
  EXPECT_EQ(compute_here(longer).completed, 1U);
  EXPECT_EQ(cycles_of(store_, run), (std::vector{2.0, 3.0, 4.0}));
  EXPECT_EQ(store_.stage(run).state_hash, whole);
  EXPECT_TRUE(store_.verify().ok());
}

TEST_F(Started, ClonesOfTwoMachinesMerge) {
  compute_here(tiny_manifest());
  const std::string text = clones(", noise_d: 1.0e-13", "", "seeds: 2\n");
  std::vector<std::filesystem::path> parts;
  for (const std::uint64_t seed : {1, 2}) {
    const auto& part = parts.emplace_back(folder_.path() / fmt::format("part{}", seed));
    Store store(part, Access::create);
    store.merge({store_.folder()});
    const std::vector<Stage> known = store.stages();
    EXPECT_EQ(compute(store, text, {.only_seeds = {seed}, .known = known}).completed, 1U);
  }
  store_.merge(parts);
  EXPECT_EQ(runs_of("clones").size(), 2U);
  EXPECT_EQ(compute_here(text).already, 2U);
  EXPECT_TRUE(check_runs(store_).empty());
}

TEST_F(Started, FromAnotherStateThanItNamesIsFoundOut) {
  compute_here(tiny_manifest());
  compute_here(clones(""));
  const Stage run = runs_of("clones").at(0);
  const std::vector<CheckpointRecord> states = store_.checkpoints(run.parent);
  Store forged(folder_.path() / "forged", Access::create);
  forged.merge({store_.folder()}, {run.parent, store_.stage(run.parent).parent});
  Stage declared = declaration_of(run);
  forged.declare_stage(declared);
  forged.start_stage(run.id, {}, std::nullopt, states.at(2).sha256);
  const auto findings = check_runs(forged);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_NE(findings[0].message.find("from the wrong state"), std::string::npos);
}

TEST_F(Started, WhatDoesNotFitTheStoreIsRefused) {
  const std::string none = refusal(clones(""));
  EXPECT_NE(none.find("start: the store has no run of tiny with seed 1. Compute this "
                      "run first, or use --store to open the store that contains it."),
            std::string::npos)
      << none;
  compute_here(tiny_manifest("", kBothFluids));
  EXPECT_NE(refusal(clones(""))
                .find("more than one run of tiny with seed 1. Select one: `variant: "
                      "\"KEY=VALUE\"`. Put commas between pairs."),
            std::string::npos);
  EXPECT_EQ(refusal(clones(", variant: \"fluid=cell\"")), "");
  EXPECT_EQ(refusal(clones(", variant: {fluid: cell}")), "");
  EXPECT_NE(refusal(clones(", variant: \"fluid=cell,grains=5\""))
                .find("has no run of tiny with seed 1 and fluid=cell, grains=5"),
            std::string::npos);
  const std::string late = ", variant: \"fluid=cell\"";
  EXPECT_NE(refusal(clones(late, "", "sweep: {grid: {start_cycle: [1, 3]}}\n"))
                .find("has no checkpoint at cycle 3. The newest checkpoint is at cycle 2. Extend "
                      "the run, "),
            std::string::npos);
  EXPECT_NE(refusal(clones(late, "  height_over_width: 1.5\n"))
                .find("height_over_width: differs from the value of run "),
            std::string::npos);
  EXPECT_EQ(refusal(clones(late, "  drag_kg_per_s: 1.28e-2\n  stiffness_N_per_m: 600\n")), "")
      << "what acts on the grains may change";
  EXPECT_NE(refusal(tiny_manifest("", "start: {experiment: tiny, seed: 1, cycle: 1}\n"))
                .find("start: must name another experiment or scale."),
            std::string::npos);
}

/// A manifest in a folder of its own, beside a file of grains.
class FromAFile : public Started {
 protected:
  void write_grains(const std::string& text) { write_bytes(folder_.path() / "grains.csv", text); }

  Manifest manifest(const std::string& rest, const std::string& base = "") {
    const std::filesystem::path file = folder_.path() / "tiny.yaml";
    write_bytes(file, renamed(tiny_manifest(base, "start: {file: grains.csv}\n" + rest), "placed"));
    return load_manifest(file);
  }

  CampaignResult compute_placed(Store& store, const Manifest& stated) {
    return run_campaign(store, declare(store, expand(stated)), 2, {}, true);
  }

  /// The grains of a state as a CSV file, without a box.
  static std::string as_csv(const State& state, double depth) {
    std::string text = "x_d,y_d,z_d,vx_d_per_s,vy_d_per_s,vz_d_per_s\n";
    for (Eigen::Index i = 0; i < state.position.cols(); ++i) {
      const auto r = state.position.col(i), v = state.velocity.col(i);
      text += fmt::format("{},{},{},{},{},{}\n", r.x(), r.y(),
                          r.z() - depth * std::floor(r.z() / depth), v.x(), v.y(), v.z());
    }
    return text;
  }

  std::string refusal_of(const Manifest& stated) {
    return message_of<ManifestError>([&] { expand(stated); });
  }
};

TEST_F(FromAFile, ThePositionsOfASettledPackingAreShearedAtOnce) {
  compute_here(tiny_manifest("  walls: smooth\n"));
  const Stage packing = runs_of_kind(store_, "prepare").at(0);
  const Checkpoint recorded = store_.load_checkpoint(store_.checkpoints(packing.id).back());
  const State& settled = recorded.state;
  write_grains(as_csv(settled, recorded.cell.depth));
  const Manifest stated = manifest("", "  walls: smooth\n");
  EXPECT_EQ(compute_placed(store_, stated).completed, 2U);
  const Stage placed_packing = runs_of_kind(store_, "prepare").at(1);
  const State read = store_.load_checkpoint(store_.checkpoints(placed_packing.id).back()).state;
  EXPECT_EQ(read.step, 0U);
  // Without a box the walls touch the outermost grains: they move by an overlap at most.
  EXPECT_LT((read.position - settled.position).cwiseAbs().rowwise().maxCoeff().head(2).maxCoeff(),
            0.05);
  EXPECT_EQ(read.velocity, settled.velocity);
  EXPECT_NEAR(read.wall_height, settled.wall_height, 0.05);
  for (const Stage& run : store_.stages()) {
    for (const CheckpointRecord& record : store_.checkpoints(run.id)) {
      EXPECT_FALSE(verify_by_replay(store_, record).divergence) << run.kind << record.cycle;
    }
  }
  EXPECT_TRUE(check_runs(store_).empty());
  EXPECT_TRUE(store_.verify().ok());
}

TEST_F(FromAFile, TheStoreKeepsTheTextAndMergesIt) {
  const std::string loose = "x_d,y_d,z_d\n1,1,1\n3,1,1\n1,3,1\n3,3,1\n";
  write_grains(loose);
  const std::string base =
      "  walls: smooth\n  grains: 4\n  nominal_packing_fraction: 0.05\n"
      "  fill_packing_fraction: 0.04\n  height_over_width: 1\n";
  const Manifest stated = manifest("settle: {}\n", base);
  const std::vector<StageJob> jobs = declare(store_, expand(stated));
  std::filesystem::remove(folder_.path() / "grains.csv");
  Store other(folder_.path() / "other", Access::create);
  other.merge({store_.folder()});
  EXPECT_EQ(other.packing_text(sha256_hex(loose)).first, loose);
  EXPECT_EQ(run_stage(other, jobs.front().id, {}), run_stage(store_, jobs.front().id, {}));
  EXPECT_EQ(other.stage(jobs.front().id).state_hash, store_.stage(jobs.front().id).state_hash);
  EXPECT_EQ(count_events(store_, "PackingRegistered"), 1U);
  store_.register_packing(loose, "elsewhere");
  EXPECT_EQ(count_events(store_, "PackingRegistered"), 1U) << "once";
  EXPECT_TRUE(other.verify().ok());
}

TEST_F(FromAFile, AFileThatIsChangedBackIsShownAgain) {
  const std::string base =
      "  walls: smooth\n  grains: 2\n  nominal_packing_fraction: 0.03\n"
      "  fill_packing_fraction: 0.02\n  height_over_width: 1\n  cycles: 0\n";
  const auto declare_with = [&](const std::string& grains) {
    write_grains("x_d,y_d,z_d\n1,1,1\n" + grains);
    const Manifest stated = manifest("", base);
    const Plan plan = expand(stated);
    declare(store_, plan);
    return plan.runs.front().stage.id;
  };
  const auto shown = [&] {
    const NewestRuns newest = newest_runs(select_runs(store_, {}));
    EXPECT_EQ(newest.runs.size(), 1U);
    return newest.runs.front().stage.id;
  };
  for (const char* grains : {"3,1,1\n", "2.5,1,1\n", "3,1,1\n"}) {
    const std::string declared = declare_with(grains);
    EXPECT_EQ(shown(), declared) << grains;
  }
  const Head head = store_.head();
  declare_with("3,1,1\n");
  EXPECT_EQ(store_.head().seq, head.seq) << "it was declared already";
  EXPECT_TRUE(store_.verify().ok());
}

TEST_F(FromAFile, TheIdHoldsTextUnitAndWhetherItSettles) {
  const auto id = [](const std::optional<StartFile>& file) {
    return prepare_stage({}, 1, file).id;
  };
  const std::string a = sha256_hex("a"), b = sha256_hex("b");
  const std::set<std::string> ids = {id({}), id(StartFile{a, {}, false}),
                                     id(StartFile{b, {}, false}), id(StartFile{a, {}, true}),
                                     id(StartFile{a, LengthUnit::m, false})};
  EXPECT_EQ(ids.size(), 5U);
  const Stage stage = prepare_stage({}, 1, StartFile{a, LengthUnit::d, true});
  EXPECT_EQ(read_stage(stage.resolved).file->unit, LengthUnit::d);
  for (const char* key : {"file", "settles", "unit"}) {
    nlohmann::json damaged = stage.resolved;
    damaged["start"][key] = 7;
    EXPECT_THROW(read_stage(damaged), UnreadableRecord) << key;
  }
  nlohmann::json more = stage.resolved;
  more["start"]["more"] = 1;
  EXPECT_THROW(read_stage(more), UnreadableRecord);
}

TEST_F(FromAFile, WhatDoesNotFitTheCellIsRefusedWithTheRemedy) {
  write_grains("x_d,y_d,z_d\n1,1,1\n3,1,1\n");
  EXPECT_NE(refusal_of(manifest(""))
                .find("has 2 grains, but the manifest asks for 300. Write `grains: 2`."),
            std::string::npos);
  const std::string two =
      "  walls: smooth\n  grains: 2\n  nominal_packing_fraction: 0.03\n"
      "  fill_packing_fraction: 0.02\n  height_over_width: 1\n";
  EXPECT_EQ(refusal_of(manifest("", two)), "");
  write_grains("x_d,y_d,z_d\n1,1,1\n9,1,1\n");
  const std::string wide = refusal_of(manifest("", two));
  EXPECT_NE(
      wide.find(
          "grains.csv: the grains together are 9 d wide (x), but the cell of the manifest is "),
      std::string::npos)
      << wide;
  const std::size_t at = wide.find("`nominal_packing_fraction: ");
  ASSERT_NE(at, std::string::npos) << wide;
  const std::string remedy = wide.substr(at + 1, wide.find('`', at + 1) - at - 1);
  std::string other = two;
  other.replace(other.find("nominal_packing_fraction: 0.03"), 30, remedy);
  other.replace(other.find("fill_packing_fraction: 0.02"), 27, "fill_packing_fraction: 0.001");
  EXPECT_EQ(refusal_of(manifest("", other)), "") << "the remedy helps";
  write_grains("x_d,y_d,z_d\n1,1,1\n3,1,1\n");
  const std::string rough = two.substr(two.find("  grains")) + "  max_overlap_diameters: 1.0e-6\n";
  EXPECT_NE(refusal_of(manifest("", rough)).find("a grain overlaps a wall by 0."),
            std::string::npos)
      << refusal_of(manifest("", rough));
  std::filesystem::remove(folder_.path() / "grains.csv");
  EXPECT_NE(refusal_of(manifest("", two)).find("grains.csv: there is no such file"),
            std::string::npos);
}

TEST_F(FromAFile, AWrongUnitIsAskedAbout) {
  const std::string two =
      "  walls: smooth\n  grains: 2\n  nominal_packing_fraction: 0.03\n"
      "  fill_packing_fraction: 0.02\n  height_over_width: 1\n";
  write_grains("x_d,y_d,z_d\n1,1,1\n3,1,1\n");
  EXPECT_EQ(refusal_of(manifest("", two)), "");
  write_grains("x_m,y_m,z_m\n3,3,3\n9,3,3\n");
  const std::string in_mm = refusal_of(manifest("", two));
  EXPECT_NE(in_mm.find("the grains together are 2001 d wide (x)"), std::string::npos) << in_mm;
  EXPECT_NE(in_mm.find("Are the lengths in m? If not, write the unit in the file (columns x_mm, "
                       "y_mm, z_mm; or length_unit=mm) or in the manifest (`unit: mm`)."),
            std::string::npos)
      << in_mm;
  write_grains("x_mm,y_mm,z_mm\n3,3,3\n9,3,3\n");
  EXPECT_EQ(refusal_of(manifest("", two)), "") << "the remedy helps";
}

/// A simple cubic lattice of 4 x 6 x 4 grains. Along z, the grains have another spacing.
std::string lattice(double spacing, double along_z) {
  std::string text = "x_d,y_d,z_d\n";
  for (int k = 0; k < 96; ++k) {
    text += fmt::format("{},{},{}\n", spacing * (k % 4), spacing * (k / 16), along_z * (k / 4 % 4));
  }
  return text;
}

TEST_F(FromAFile, ACellNarrowerThanTheGrainsIsRefused) {
  const std::string base = "  walls: smooth\n  grains: 96\n";
  const auto with_remedy_of = [&](const std::string& message) {
    const std::size_t at = message.find("`nominal_packing_fraction: ");
    EXPECT_NE(at, std::string::npos) << message;
    const std::string remedy = message.substr(at + 1, message.find('`', at + 1) - at - 1);
    return base + "  fill_packing_fraction: 0.1\n  " + remedy + "\n";
  };
  for (const double spacing : {0.92, 1.0, 1.1}) {
    write_grains(lattice(spacing, spacing));
    const std::string settling = refusal_of(manifest("settle: {}\n", base));
    if (spacing < 1) {
      EXPECT_EQ(settling, "") << "the grains overlap each other as deeply as the walls";
      continue;
    }
    EXPECT_NE(
        settling.find(spacing == 1 ? "the grains together are 4 d wide (x), but the cell of the "
                                     "manifest is 3.60599"
                                   : "the grains together are 4.3 d wide (x)"),
        std::string::npos)
        << settling;
    const std::string at_once = refusal_of(manifest("", base));
    for (const char* rest : {"", "settle: {}\n"}) {
      EXPECT_EQ(refusal_of(manifest(rest, with_remedy_of(settling))), "");
      EXPECT_EQ(refusal_of(manifest(rest, with_remedy_of(at_once))), "");
    }
  }
  write_grains(lattice(1, 1));
  // A cell that fits along x but not along z.
  const std::string wide = with_remedy_of(refusal_of(manifest("", base)));
  write_grains(lattice(1, 1.1));
  const std::string images = refusal_of(manifest("", wide));
  EXPECT_NE(images.find("a grain overlaps a periodic image of another grain by 0.3 d, more than "
                        "0.25 d. The cell of the manifest is 4 d deep (z). Write "
                        "`nominal_packing_fraction: "),
            std::string::npos)
      << images;
  EXPECT_EQ(refusal_of(manifest("settle: {}\n", wide)), "") << "settling presses them apart";
  write_grains(lattice(1, 4.0 / 3));
  EXPECT_NE(refusal_of(manifest("settle: {}\n", wide)).find(" a periodic image of another grain"),
            std::string::npos);
}

TEST_F(FromAFile, ACellMuchWiderThanTheGrainsIsWarnedOf) {
  write_grains(lattice(1, 1));
  for (const auto& [fraction, warned] : {std::pair(0.4689, false), {0.4, false}, {0.2, true}}) {
    const std::vector<std::string> warnings =
        expand(manifest("", fmt::format("  walls: smooth\n  grains: 96\n  fill_packing_fraction: "
                                        "0.1\n  nominal_packing_fraction: {}\n",
                                        fraction)))
            .warnings;
    EXPECT_EQ(
        std::ranges::count_if(warnings,
                              [](const std::string& one) {
                                return one.find(
                                           "grains.csv: the grains together are 4 d wide (x), "
                                           "but the cell of the manifest is ") != one.npos;
                              }),
        warned ? 1 : 0)
        << fraction;
  }
}

TEST_F(FromAFile, ACellTooHighToSettleIsWarnedOf) {
  const std::string two =
      "  walls: smooth\n  grains: 2\n  nominal_packing_fraction: 0.03\n"
      "  fill_packing_fraction: 0.02\n  height_over_width: 1\n";
  for (const auto& [y, rest, warned] : {std::tuple("90000", "settle: {}\n", true),
                                        {"3", "settle: {}\n", false},
                                        {"90000", "", false}}) {
    write_grains(std::string("x_d,y_d,z_d\n1,1,1\n1,") + y + ",1\n");
    const std::vector<std::string> warnings = expand(manifest(rest, two)).warnings;
    EXPECT_EQ(std::ranges::count_if(
                  warnings,
                  [](const std::string& one) {
                    return one.find("grains.csv: the packing of this file is 90000 d high.") !=
                           one.npos;
                  }),
              warned ? 1 : 0)
        << y << rest;
  }
}

TEST(Noise, DependsOnSeedAndGrainAlone) {
  State few, many;
  few.position = Eigen::Matrix3Xd::Zero(3, 2);
  many.position = Eigen::Matrix3Xd::Zero(3, 5);
  add_noise(few, 1, 7);
  add_noise(many, 1, 7);
  EXPECT_EQ(few.position, many.position.leftCols(2));
  State other = few;
  add_noise(other, 0, 7);
  EXPECT_EQ(other.position, few.position);
}

}  // namespace
}  // namespace shearcell::test
