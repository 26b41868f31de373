// SPDX-License-Identifier: GPL-3.0-or-later
// Commands on a store: verify, prune, regenerate, merge, show, status, plan. Several programs on
// one store, signals, and damaged stores.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdio>

#include "tests/experiments/program.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

class Commands : public ProgramTest {
 protected:
  const std::string manifest_ = tiny_manifest("", kBothFluids);

  std::string head() {
    const nlohmann::json verified = json({"verify", "--json"}).at("head");
    return std::to_string(verified.at("seq").get<std::uint64_t>()) + ":" +
           verified.at("hash").get<std::string>();
  }
};

TEST_F(Commands, PruneOnlyListsByDefaultAndRegenerateRestores) {
  campaign(manifest_, {"--cycles", "4"});
  expect(2, {"prune"});  // nothing was said to go
  expect(2, {"prune", "--state", "lost"});
  expect(0, {"figures", "S2", "--out", "out"});
  const std::size_t files = objects();
  expect(0, {"prune", "--keep-every", "2"}, {"4 checkpoints", "Nothing was freed"});
  EXPECT_EQ(objects(), files);
  const nlohmann::json done = json({"prune", "--keep-every", "2", "--yes", "--json"});
  EXPECT_EQ(done.at("bytes_freed"), done.at("bytes"));
  EXPECT_EQ(objects(), files - 4);
  expect(0, {"verify"});

  const std::string sha = done.at("checkpoints").at(0).at("sha256");
  expect(0, {"show", "out/tiny/base/S2a.csv"},
         {"10 checkpoints: 6 present and unchanged, 4 pruned"});
  fs::remove(path("shearcell-store/derived.sqlite"));
  expect(0, {"figures", "S2"}, {"shearcell regenerate " + sha.substr(0, 12)});
  expect(0, {"show", sha}, {"pruned; `shearcell regenerate"});
  EXPECT_EQ(json({"show", sha, "--json"}).at("state"), "pruned");
  for (const auto& checkpoint : done.at("checkpoints")) {
    expect(0, {"regenerate", checkpoint.at("sha256")}, {"the same bytes"});
  }
  EXPECT_EQ(objects(), files);
  expect(0, {"figures", "S2"});
  expect(0, {"verify"});
  expect(0, {"regenerate", sha}, {"the file is intact"});
  expect(2, {"regenerate", "no-such"});
}

TEST_F(Commands, TheMostSevereFaultDecidesTheExitCode) {
  campaign(tiny_manifest("",
                         "sweep: {grid: {fluid: [still, cell], walls: [rough, smooth]}}\n"
                         "plots: [{name: mixed, y: phi, x: cycle, by: fluid}]\n"),
           {"--cycles", "1"});
  truncate_file(path(newest_file(last_run())));
  expect(4, {"figures"}, {"left out: ", "figure mixed would average"});
  fs::remove(path("shearcell-store/derived.sqlite"));
  expect(4, {"show", last_run()}, {"not measured: "});
  expect(4, {"show", last_run(), "--json"}, {"not measured: "});
}

TEST_F(Commands, ShowChecksTheNewestFileEvenIfItsMeasuresAreCached) {
  campaign(manifest_, {"--cycles", "1"});
  expect(0, {"show", last_run()}, {"newest checkpoint:"});  // caches all measures
  const fs::path newest = path(newest_file(last_run()));
  truncate_file(newest);
  expect(4, {"show", last_run()}, {"damaged: ", "newest checkpoint:"});
  fs::remove(newest);
  expect(4, {"show", last_run(), "--json"}, {"damaged: ", "the file is missing"});
  fs::create_directory(newest);
  expect(4, {"show", last_run()}, {"damaged: ", "it is not a regular file"});
}

// Displacements of cycle 2 need the checkpoint of cycle 1.
TEST_F(Commands, ExportSaysWhichMeasuresItLacks) {
  campaign(manifest_, {"--cycles", "2"});
  const std::string run = last_run();
  truncate_file(path("shearcell-store") /
                Store(path("shearcell-store"), Access::read).checkpoints(run).at(1).file);
  expect(4, {"export", run, "--to", "extxyz", "--cycles", "2", "--out", "a.xyz"},
         {"not measured: ", "1 file in a.xyz"});
  expect(0, {"export", run, "--to", "extxyz", "--cycles", "0", "--out", "b.xyz"});
}

TEST_F(Commands, ShowRejectsAPrefixOfARunAndACheckpoint) {
  campaign(manifest_, {"--cycles", "0"});
  const std::string run = last_run(), brief = run.substr(0, 8);
  sqlite::Database(path("shearcell-store/store.sqlite"), Access::write)
      .execute(
          "CREATE TEMP TABLE more AS SELECT * FROM checkpoints LIMIT 1; UPDATE more SET step = "
          "step + 1, sha256 = '" +
          brief + std::string(56, '0') + "'; INSERT INTO checkpoints SELECT * FROM more");
  expect_refused({"show", brief},
                 {"the id of a run and the hash of a checkpoint begin with '" + brief, run});
  expect(0, {"show", run});
}

TEST_F(Commands, VerifyReplaysAndComparesWithAHead) {
  campaign(manifest_);
  const std::string before = head(), seq = before.substr(0, before.find(':'));
  const std::string hash = before.substr(seq.size() + 1);
  const nlohmann::json verified = json({"verify", "--replay", "3", "--seed", "5", "--json"});
  ASSERT_EQ(verified.at("replay").at("replayed").size(), 3U);
  for (const auto& replay : verified.at("replay").at("replayed")) {
    EXPECT_EQ(replay.at("same"), true);
    EXPECT_GT(replay.at("steps"), 0) << "where a stage begins nothing is computed";
  }
  expect(0, {"verify", "--against", seq, hash});
  expect(4, {"verify", "--against", "3", hash});
  expect(4, {"verify", "--against", "9999", hash});
  for (const std::string wrong : {"yesterday", "yesterday 3", "3 yesterday"}) {
    expect(2, joined({"verify", "--against"}, split(wrong)));
  }
  expect(0, {"rebuild"}, {"3 runs"});
  expect(0, {"verify", "--against", seq, hash});
}

TEST_F(Commands, MergeRejectsConflicts) {
  campaign(tiny_manifest(), {"--cycles", "1"}, "a");
  campaign(manifest_, {}, "b");
  const auto whole = hashes("b");
  expect(0, {"merge", "a", "b", "--store", "all"});
  EXPECT_EQ(hashes("all"), whole);
  expect(0, {"verify", "--replay", "2", "--store", "all"});
  expect(2, {"merge", "all", "--store", "all"});
  expect(2, {"merge", "nowhere", "--store", "all"});
  expect_refused({"merge", "a", "nowhere", "--store", "new"},
                 {"nowhere", "this folder contains no store"});
  expect_refused({"merge", "", "--store", "new"}, {"this folder contains no store"});
  expect_refused({"run", "m.yaml", "--store", ""}, {"--store", "is empty; give a file or folder"});
  {
    // Somebody's own arithmetic: another state for a step that is known.
    Store store(path("odd"), Access::create);
    const Store other(path("b"), Access::read);
    store.merge({path("a")});
    const Stage sheared = runs_of_kind(store, "shear").at(0);
    Checkpoint wrong = other.load_checkpoint(other.checkpoints(sheared.id).at(2));
    wrong.state.position(0, 0) += 1e-9;
    Stage longer = declaration_of(sheared);
    longer.memberships[0].ask.target_cycles = 2;
    store.declare_stage(longer);
    store.start_stage(sheared.id, {}, store.checkpoints(sheared.id).back().sha256);
    store.record_checkpoint(sheared.id, wrong);
    store.interrupt_stage(sheared.id, "a test");
  }
  expect(4, {"merge", "odd", "--store", "all"}, {"Nothing was merged"});
  EXPECT_EQ(hashes("all"), whole);
}

TEST_F(Commands, StatusListsASharedRunUnderEachExperiment) {
  const std::string text = tiny_manifest("", "sweep: {grid: {grains: [200, 300]}}\n");
  campaign(text, {"--cycles", "0"});
  write("twin.yaml", renamed(text, "twin"));
  expect(0, {"run", "twin.yaml", "--cycles", "0", "-q"});
  const std::string status =
      expect(0, {"status"},
             {"tiny\n", "\ntwin\n", "packing N=200 ", "packing N=300 ", "4 stages: 4 completed"})
          .out;
  const std::string run = last_run().substr(0, 8);
  EXPECT_NE(status.find(run), status.rfind(run)) << status;
  EXPECT_EQ(json({"status", "--json"}).at("runs").size(), 4U) << "each once";
}

TEST_F(Commands, AnExperimentHasOneManifestAtATime) {
  campaign(tiny_manifest(), {"--cycles", "0"});  // of m.yaml
  write("same.yaml", tiny_manifest());
  write("other.yaml", tiny_manifest("  pressure_Pa: 700\n"));
  write("comment.yaml", "# a comment\n" + tiny_manifest("  pressure_Pa: 700\n"));
  const std::string warning =
      "newest manifest of experiment tiny differs from this file and has 1 run that the plan of "
      "this file lacks";
  for (const char* store : {"shearcell-store", "none"}) {
    expect(0, {"plan", "m.yaml", "other.yaml", "--store", store}, {"other.yaml: the " + warning});
    EXPECT_FALSE(has(run({"plan", "m.yaml", "same.yaml", "--store", store}).err, warning));
  }
  expect(0, {"plan", "other.yaml"}, {warning});
  expect(0, {"run", "other.yaml", "--cycles", "0", "-q"}, {warning});
  for (const char* manifest : {"other.yaml", "comment.yaml"}) {
    EXPECT_FALSE(has(expect(0, {"plan", manifest}).err, warning)) << manifest;
  }
  expect(0, {"plan", "m.yaml"}, {warning});
}

TEST_F(Commands, NamesIncludeValuesThatARecordLeavesOut) {
  const auto swept = [](const std::string& zip) {
    return tiny_manifest("", "sweep: {zip: {" + zip + "}}\n");
  };
  campaign(swept("moving_wall: [bottom, top], pressure_at: [top, top]"), {"--cycles", "0"});
  const std::string status =
      expect(0, {"status"}, {"packing moving_wall=bottom ", "packing moving_wall=top "}).out;
  EXPECT_EQ(status.find("pressure_at"), status.npos) << status;
  write("lighter.yaml", swept("moving_wall: [bottom], pressure_at: [moving_wall]"));
  expect(0, {"run", "lighter.yaml", "--cycles", "0", "-q"});
  expect(0, {"show", last_run()}, {"\npressure_at                  \"moving_wall\"\n"});
  write("draws.yaml", renamed(swept("wall_grain_draw: [0, 1]"), "draws"));
  expect(0, {"run", "draws.yaml", "--cycles", "0", "-q"});
  expect(0, {"status"}, {"packing wall_grain_draw=0 ", "packing wall_grain_draw=1 "});
}

TEST_F(Commands, PlanShowsWhatIsDoneAndShared) {
  campaign(manifest_, {"--cycles", "1"});
  const auto stage = [](const nlohmann::json& plan, const std::string& kind,
                        std::uint64_t seed) -> nlohmann::json {
    for (const auto& line : plan.at("stages")) {
      if (line.at("stage") == kind && line.at("seed") == seed) return line;
    }
    ADD_FAILURE() << "no such stage: " << plan.dump(1);
    return {};
  };
  // The same again: done. Longer: to extend. More seeds: to do.
  const auto again = json({"plan", "m.yaml", "--cycles", "1", "--json"});
  for (const auto& line : again.at("stages")) {
    EXPECT_EQ(line.at("state"), "done");
    EXPECT_TRUE(line.at("shared_with").empty());
  }
  expect(0, {"plan", "m.yaml", "--cycles", "1"}, {"\nleft: nothing\n"});
  expect(0, {"show", again.at("stages").at(0).at("id")}, {", 1 attempt\n"});
  const auto more = json({"plan", "m.yaml", "--cycles", "3", "--seeds", "2", "--json"});
  EXPECT_EQ(stage(more, "prepare", 1).at("state"), "done");
  EXPECT_EQ(stage(more, "shear", 1).at("state"), "to extend");
  EXPECT_EQ(stage(more, "shear", 1).at("particle_steps_left"), 300.0 * 2 * 10000);
  EXPECT_EQ(stage(more, "shear", 2).at("state"), "to do");
  EXPECT_EQ(stage(more, "shear", 2).at("particle_steps_left"), 300.0 * 3 * 10000);
  EXPECT_GE(stage(more, "shear", 2).at("memory_bytes"), 300.0 * 100);

  // A run that ended early is complete for every manifest with that `until`.
  const std::string early = tiny_manifest("", "until: {phi: 0.1}\n");
  write("early.yaml", early);
  expect(0, {"run", "early.yaml", "--cycles", "5", "-q"});
  write("early.yaml", early + "# edited\n");
  EXPECT_EQ(stage(json({"plan", "early.yaml", "--cycles", "5", "--json"}), "shear", 1).at("state"),
            "done");
  EXPECT_EQ(stage(json({"plan", "early.yaml", "--cycles", "6", "--json"}), "shear", 1).at("state"),
            "to extend");

  // Another experiment: one run is shared, one is new by its amplitude.
  const auto twin = [](const std::string& base) {
    return renamed(tiny_manifest(base, "sweep: {grid: {amplitude_rad: [0.0833, 0.1]}}\n"), "twin");
  };
  write("twin.yaml", twin(""));
  const auto other = json({"plan", "twin.yaml", "--cycles", "1", "--json"});
  EXPECT_EQ(stage(other, "shear", 1).at("state"), "done");
  EXPECT_EQ(stage(other, "shear", 1).at("shared_with"), nlohmann::json::parse(R"(["tiny"])"));
  EXPECT_EQ(other.at("stages").at(2).at("state"), "to do");
  expect(0, {"plan", "twin.yaml", "--cycles", "1"}, {"also in tiny"});

  // Both: the shared run counts once, as long as the one that asks for more of it.
  write("twin.yaml", twin("  cycles: 4\n"));
  const auto both = json({"plan", "m.yaml", "twin.yaml", "--json"});
  EXPECT_EQ(both.at("experiment"), "tiny, twin");
  EXPECT_EQ(both.at("runs"), 3);
  EXPECT_EQ(both.at("stages").size(), 4U);
  EXPECT_EQ(stage(both, "shear", 1).at("cycles"), 4);
  EXPECT_EQ(both.at("particle_steps_left"), 300.0 * (3 + 1 + 4) * 10000);
  expect(0, {"plan", "m.yaml", "twin.yaml"}, {"experiment", "tiny, twin: 3 runs"});
  EXPECT_EQ(json({"plan", "m.yaml", "m.yaml", "--json"}).at("experiment"), "tiny");
}

TEST_F(Commands, PlanSaysWhatTheNextLookTakes) {
  const std::string text = tiny_manifest("", "seeds: 4\nlooks: [3, 4]\n");
  write("m.yaml", text);
  expect(0, {"plan", "m.yaml", "--cycles", "1"},
         {"tiny: the next planned look (interim analysis) uses 3 of 4 seeds "});
  expect(0, {"run", "m.yaml", "--cycles", "1", "--seeds", "2", "-q"});
  expect(0, {"plan", "m.yaml", "--cycles", "1"},
         {"tiny: the next planned look (interim analysis) uses 3 of 4 seeds "});
  // A run whose packing failed counts as ended, as in verdicts.
  Store store(path("shearcell-store"), Access::write);
  ExpandOptions all;
  all.cycles = 1;
  declared(store, text, all);
  for (const Stage& stage : runs_of_kind(store, "prepare")) {
    if (stage.memberships.front().place.seed != 3) continue;
    store.start_stage(stage.id, {});
    store.fail_stage(stage.id, "blew up");
  }
  expect(0, {"plan", "m.yaml", "--cycles", "1"},
         {"tiny: the next planned look (interim analysis) uses 4 of 4 seeds "});
}

/// Before `figures` has measured runs, nothing is known about them, and `plan` reads no checkpoint.
TEST_F(Commands, PlanPrintsThePowerOfTheNextLook) {
  write("m.yaml", tiny_manifest("",
                                "seeds: 6\nlooks: [4, 6]\n"
                                "claims: [{id: tiny.overlap, compare: mean_overlap_d, cycles: [1, "
                                "1], published: {value: 0.001, source: none}, margin: 1e-6}]\n"));
  expect(0, {"run", "m.yaml", "--cycles", "1", "--seeds", "3", "-q"});
  const auto expect_plan = [&](const std::string& look, const std::string& power) {
    expect(0, {"plan", "m.yaml", "--cycles", "1"},
           {look, "are the true values: tiny.overlap " + power});
  };
  expect_plan("uses 4 of 6 seeds ", "unknown (3 runs not measured yet: `figures` measures them)");
  expect(0, {"figures", "tiny", "--out", path("out")}, {"with probability 1.00"});
  expect_plan("uses 4 of 6 seeds ", "1.00");
  expect(0, {"run", "m.yaml", "--cycles", "1", "--seeds", "4", "-q"});
  expect_plan("uses 6 of 6 seeds ", "unknown (1 run not measured yet");
}

/// A manifest may start from runs of one that is named after it.
TEST_F(Commands, PlanReadsManifestsInTheOrderOfTheirStarts) {
  const auto after = [](const std::string& name, const std::string& other) {
    return renamed(tiny_manifest("", "start: {experiment: " + other + ", seed: 1, cycle: 1}\n"),
                   name);
  };
  write("a.yaml", after("a", "b"));
  write("b.yaml", after("b", "tiny"));
  write("m.yaml", tiny_manifest());
  expect(0, {"plan", "a.yaml", "b.yaml", "m.yaml"}, {"tiny, b, a"});
  write("b.yaml", after("b", "a"));
  expect(2, {"plan", "a.yaml", "m.yaml", "b.yaml"}, {"the store has no run of b"});
}

class SharedStore : public Commands {
 protected:
  static std::string many_runs() {
    return tiny_manifest("  cycles: 6\n", kBothFluids + "seeds: 3\n");
  }

  void expect_each_run_once(const std::map<std::string, std::string>& expected) {
    EXPECT_EQ(hashes(), expected);
    const Store store(path("shearcell-store"), Access::read);
    for (const Stage& run : store.stages()) {
      EXPECT_EQ(run.attempts, 1U) << run.id << " was done twice";
      EXPECT_EQ(run.particle_steps, static_cast<double>(kGrains * run.step));
    }
    EXPECT_TRUE(store.leases().empty());
    expect(0, {"verify"});
  }
};

TEST_F(SharedStore, TwoProgramsComputeEachRunOnce) {
  const std::string text = write("many.yaml", many_runs());
  expect(0, {"run", text, "-q", "--store", "whole"});
  const Running first = start_beside({"run", text, "-j", "1", "--json"}, "first");
  const Running second = start_beside({"run", text, "-j", "1", "--json"}, "second");
  // Meanwhile `status` shows which program holds the run.
  bool seen_two = false;
  for (int look = 0; look < 400 && !seen_two; ++look) {
    const Outcome status = run({"status", "--json"});
    const auto facts = nlohmann::json::parse(status.out, nullptr, false);
    std::set<std::uint64_t> pids;
    if (facts.is_object()) {
      for (const auto& run : facts.at("runs")) {
        if (run.at("holder").is_object()) {
          pids.insert(run.at("holder").at("pid").get<std::uint64_t>());
        }
      }
    }
    seen_two = pids.size() == 2;
  }
  EXPECT_TRUE(seen_two);
  const Outcome one = wait_for(first), two = wait_for(second);
  EXPECT_EQ(one.code, 0) << one.err;
  EXPECT_EQ(two.code, 0) << two.err;
  const auto a = nlohmann::json::parse(one.out), b = nlohmann::json::parse(two.out);
  std::printf("computed by the first %d, by the second %d of 9 stages\n",
              a.at("completed").get<int>(), b.at("completed").get<int>());
  EXPECT_EQ(a.at("completed").get<int>() + b.at("completed").get<int>(), 9);
  EXPECT_GE(a.at("completed").get<int>(), 1);
  EXPECT_GE(b.at("completed").get<int>(), 1);
  for (const auto& each : {a, b}) {
    EXPECT_EQ(each.at("completed").get<int>() + each.at("already_done").get<int>() +
                  each.at("done_elsewhere").get<int>(),
              9);
  }
  expect_each_run_once(hashes("whole"));
}

TEST_F(SharedStore, AProgramContinuesTheRunsOfAKilledOne) {
  const std::string text = write("one.yaml", tiny_manifest("  cycles: 20\n"));
  expect(0, {"run", text, "-q", "--store", "whole"});
  const Running first = start_beside({"run", text, "-q"}, "first");
  wait_for_objects(5);
  const Running second = start_beside({"run", text}, "second");
  wait_for_words(second, "waiting");
  kill(first.pid, SIGKILL);
  EXPECT_EQ(wait_for(first).signal, SIGKILL);
  const Outcome rest = wait_for(second);
  EXPECT_EQ(rest.code, 0) << rest.err;
  EXPECT_TRUE(has(rest.err, "waiting for 1 stage"));
  EXPECT_EQ(hashes(), hashes("whole"));
  expect(0, {"verify"});
}

class CommandLineStore : public ProgramTest {};

TEST_F(CommandLineStore, ShowsARunOfAKilledProgramAsInterrupted) {
  write("m.yaml", tiny_manifest("  cycles: 4000\n"));
  EXPECT_EQ(run_until({"run", "m.yaml", "-q"}, 4, SIGKILL).signal, SIGKILL);
  const std::string shown = expect(0, {"status"}, {"1 interrupted, 1 completed"}).out;
  EXPECT_FALSE(has(shown, "running")) << shown;
  const nlohmann::json run = json({"status", "--json"}).at("runs").back();
  EXPECT_EQ(run.at("state"), "running");
  EXPECT_TRUE(run.at("holder").is_null());
}

TEST_F(CommandLineStore, NamesATruncatedCheckpointAndContinues) {
  campaign(tiny_manifest(), {"--cycles", "1", "--seeds", "2"});
  const auto expected = hashes();
  std::string victim;
  for (const Stage& run : Store(path("shearcell-store"), Access::read).stages()) {
    if (run.kind == "shear" && run.memberships.front().place.seed == 1) victim = run.id;
  }
  const std::string file = newest_file(victim);
  truncate_file(path(file));
  const Arguments more = {"run", "m.yaml", "--cycles", "1", "--seeds", "3", "-q"};
  expect(4, more, {fs::path(file).filename()});

  const auto after = hashes();  // all are completed
  EXPECT_EQ(after.size(), expected.size() + 2);
  for (const auto& [id, hash] : expected) EXPECT_EQ(after.at(id), hash);
  expect(0, more);
  expect(0, {"verify"});
}

TEST_F(CommandLineStore, ReportsWhyARunFailed) {
  const std::string manifest =
      write("m.yaml", tiny_manifest("",
                                    "sweep: {grid: {settle_time_limit_s: [60, 0.1]}}\n"
                                    "plots: [{name: own, y: phi}]\n"));
  expect(3, {"run", manifest, "--cycles", "1", "-q"}, {"over its limit of 0.1"});
  expect(0, {"figures", "own"}, {"1 run without a checkpoint yet", "seed 1 (failed)"});
  expect(0, {"status"}, {"over its limit of 0.1", "completed"});
}

// About a second, long enough for a signal to arrive during the work.
const std::string kCycles = "20";

class Signals : public CommandLineStore, public testing::WithParamInterface<int> {};

TEST_P(Signals, LeaveNoTrace) {
  campaign(tiny_manifest(), {"--cycles", kCycles}, "whole");
  const Outcome stopped = run_until({"run", "m.yaml", "--cycles", kCycles, "-q"}, 4, GetParam());
  const bool killed = GetParam() == SIGKILL;
  if (killed) {
    EXPECT_EQ(stopped.signal, SIGKILL);
  } else {
    EXPECT_EQ(stopped.code, 85) << stopped.err;
    EXPECT_TRUE(has(stopped.err, "shearcell resume --store"));
  }
  const nlohmann::json sheared = json({"status", "--json"}).at("runs").back();
  EXPECT_EQ(sheared.at("state"), killed ? "running" : "interrupted");
  EXPECT_LT(sheared.at("cycle"), 20);
  EXPECT_GE(sheared.at("cycle"), 1);
  expect(0, {"resume", "-q"});
  EXPECT_EQ(hashes(), hashes("whole"));
  expect(0, {"verify"});
}

INSTANTIATE_TEST_SUITE_P(Of, Signals, testing::Values(SIGINT, SIGTERM, SIGKILL));

}  // namespace
}  // namespace shearcell::test
