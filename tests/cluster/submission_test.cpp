// SPDX-License-Identifier: GPL-3.0-or-later
// Runs are distributed over tasks: each run once, each packing once, always the same way, with
// about equal work. Stores of tasks, merging them, and the events that record this; without Slurm.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>

#include "experiments/cluster/submission.hpp"
#include "experiments/runner/outlook.hpp"
#include "tests/experiments/temporary_store.hpp"
#include "tests/support/files.hpp"
#include "tests/support/variable.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

class Submitted : public StoreTest {
 protected:
  std::vector<Share> shares(std::uint64_t cycles = 2) {
    const Manifest manifest = parse_manifest(tiny_manifest("", kBothFluids), "tiny.yaml");
    const Plan plan = expand(manifest, {.cycles = cycles, .seeds = 2});
    declare(store_, plan);
    return share_out(shares_of({plan}, &store_), 2);
  }

  Submission submit(const std::vector<Share>& parts) {
    return prepare_submission(store_, {parts, 0, {}}, {{"engine", "test"}},
                              store_.events(kSubmissions).size());
  }

  static std::map<std::string, std::string> computed_here(std::uint64_t cycles) {
    return undisturbed(tiny_manifest("", kBothFluids), {.cycles = cycles, .seeds = 2});
  }

  Store store_of(const Submission& made, std::size_t task) const {
    return {made.task_store(store_.folder(), task), Access::write};
  }
};

TEST_F(Submitted, TasksComputeTheirSharesAndTheirStoresMergeIntoTheWhole) {
  const Submission made = submit(shares());
  for (std::size_t task = 1; task <= 2; ++task) {
    Store own = store_of(made, task);
    EXPECT_EQ(own.stages().size(), 3U) << "two runs and their packing, nothing else";
    EXPECT_EQ(resume(own).completed, 3U);
    EXPECT_TRUE(own.verify().ok());
  }
  EXPECT_EQ(merge_tasks(store_, made), 14U) << "checkpoints";
  EXPECT_EQ(final_hashes(store_), computed_here(2));
  EXPECT_TRUE(store_.verify().ok());
  const Head head = store_.head();
  merge_tasks(store_, made);
  EXPECT_EQ(store_.head().hash, head.hash) << "merging twice changes nothing";
  EXPECT_TRUE(unfinished_submissions(store_).empty());
}

TEST_F(Submitted, ATaskContinuesFromTheStore) {
  const Submission first = submit(shares(1));
  for (std::size_t task = 1; task <= 2; ++task) {
    Store own = store_of(first, task);
    resume(own);
  }
  merge_tasks(store_, first);
  const Submission second = submit(shares(3));
  for (std::size_t task = 1; task <= 2; ++task) {
    Store own = store_of(second, task);
    EXPECT_EQ(resume(own).completed, 2U) << "the packing is there, and the first cycle";
  }
  merge_tasks(store_, second);
  EXPECT_EQ(final_hashes(store_), computed_here(3));
  for (const Stage& run : store_.stages()) {
    const auto records = store_.checkpoints(run.id);
    EXPECT_EQ(count_events(store_, "CheckpointRecorded", "run/" + run.id), records.size());
    if (run.kind == "prepare") {
      EXPECT_EQ(run.attempts, 1U);
    } else {
      EXPECT_EQ(run.particle_steps, 3.0 * kStepsPerCycle * kGrains) << "no step was made twice";
    }
  }
}

TEST_F(Submitted, HaveWorkLeftWhileACompletedRunLacksCheckpoints) {
  const std::string text = tiny_manifest("  cycles: 4\n");
  compute(store_, text + "checkpoints: {every_cycles: 2}\n");
  const Manifest manifest = parse_manifest(text, "tiny.yaml");
  const Plan plan = expand(manifest);
  declare(store_, plan);
  const Submission made = submit(share_out(shares_of({plan}, &store_), 1));
  EXPECT_EQ(unfinished_submissions(store_).size(), 1U) << "its tasks have only begun";
  Store own = store_of(made, 1);
  EXPECT_EQ(resume(own).completed, 1U);
  merge_tasks(store_, made);
  EXPECT_TRUE(unfinished_submissions(store_).empty());
  EXPECT_EQ(store_.checkpoints(sheared(store_).id).size(), 5U);
}

TEST_F(Submitted, ClonesAreTasksOfThePackingOfTheirState) {
  const Manifest tiny = parse_manifest(tiny_manifest(), "tiny.yaml");
  const Manifest clones = parse_manifest(
      renamed(tiny_manifest("", "start: {experiment: tiny, seed: 1, cycle: 1}\n"), "clones"),
      "clones.yaml");
  const Plan first = expand(tiny);
  std::vector<Stage> known;
  add_as_computed(first, known);
  const Plan second = expand(clones, {.known = known});
  const std::string packing = first.runs[0].prepare->id;
  const std::vector<Share> both = shares_of({first, second}, &store_);
  ASSERT_EQ(both.size(), 1U);
  EXPECT_EQ(both[0].packings, std::vector{packing});
  EXPECT_EQ(both[0].runs, (std::vector{first.runs[0].stage.id, second.runs[0].stage.id}));
  compute(store_, tiny.text);
  declare(store_, second);
  const std::vector<Share> rest = shares_of({second}, &store_);
  ASSERT_EQ(rest.size(), 1U);
  EXPECT_EQ(rest[0].runs, std::vector{second.runs[0].stage.id});
  const Submission made = submit(rest);
  Store own = store_of(made, 1);
  EXPECT_EQ(resume(own).completed, 1U);
  merge_tasks(store_, made);
  EXPECT_EQ(store_.stage(second.runs[0].stage.id).state, StageState::completed);
}

TEST_F(Submitted, TasksEndRunsByUntil) {
  const std::string text = tiny_manifest("", "until: {phi: 0.1, extra_cycles: 1}\n");
  const Manifest manifest = parse_manifest(text, "tiny.yaml");
  const Plan plan = expand(manifest);
  declare(store_, plan);
  const Submission made = submit(share_out(shares_of({plan}, &store_), 1));
  Store own = store_of(made, 1);
  EXPECT_EQ(resume(own).completed, 2U);
  merge_tasks(store_, made);
  const Stage run = runs_of_kind(store_, "shear").front();
  EXPECT_EQ(run.state, StageState::completed);
  EXPECT_EQ(run.cycle, 1);
  EXPECT_EQ(describe_end(end_of(run)), "phi >= 0.1 at cycle 0, then 1 more cycle");
  EXPECT_TRUE(shares_of({plan}, &store_).empty());
  const Plan edited = expand(parse_manifest(text + "# edited\n", "tiny.yaml"));
  EXPECT_TRUE(shares_of({edited}, &store_).empty()) << "its `until` is the same";
  const Plan longer = expand(manifest, {.cycles = 9});
  EXPECT_EQ(shares_of({longer}, &store_).size(), 1U) << "nobody asked for this length yet";
  const std::size_t recorded = count_events(store_, "CheckpointRecorded");
  declare(store_, longer);
  resume(store_);
  EXPECT_EQ(count_events(store_, "CheckpointRecorded"), recorded) << "it ends by `until` again";
}

TEST_F(Submitted, WorkIsThatOfTheLongestTarget) {
  const std::vector<Share> longest = shares(9);
  const std::vector<Share> shorter = shares(1);
  ASSERT_EQ(shorter.size(), longest.size());
  EXPECT_EQ(shorter[0].particle_steps, longest[0].particle_steps);
}

TEST_F(Submitted, RunsInTheQueueAreBusyWithTheirPackings) {
  Submission made = submit(shares());
  EXPECT_TRUE(busy_runs(store_, {made}).empty()) << "its jobs have ended";
  made.queue = {{made.name(), "17", 2, "PENDING", {}, {}}};
  EXPECT_EQ(busy_runs(store_, {made}).size(), 6U) << "nothing is merged before the end";
}

TEST_F(Submitted, RunsAtWorkHereAreBusyWithTheirPackings) {
  const std::string run = shares().at(0).runs.at(0), packing = store_.stage(run).parent;
  EXPECT_TRUE(busy_runs(store_, {}).empty());
  store_.start_stage(run, nlohmann::json::object());
  EXPECT_EQ(busy_runs(store_, {}), (std::set<std::string>{run, packing}));
  store_.start_stage(packing, nlohmann::json::object());
  store_.complete_stage(packing);
  EXPECT_EQ(busy_runs(store_, {}), (std::set<std::string>{run})) << "others may start from it";
}

TEST(Proposed, LeavesOutBundlesThatAreBusyAndGivesACoreToEachRun) {
  const std::vector<Plan> plans = {
      expand(parse_manifest(tiny_manifest("", kBothFluids), "tiny.yaml"), {.seeds = 3})};
  const Proposal all = propose(plans, nullptr, {}, 1000, {});
  EXPECT_EQ(all.shares.size(), 3U);
  EXPECT_EQ(all.job.cpus, 2U);
  JobOptions threaded, single;
  threaded.threads = 4;
  single.cpus = 1;
  const Proposal rest = propose(plans, nullptr, {all.shares[1].runs[0]}, 1000, threaded);
  EXPECT_EQ(rest.shares.size(), 2U);
  EXPECT_EQ(rest.left_out, 2U);
  EXPECT_EQ(rest.job.cpus, 8U);
  const Proposal few = propose(plans, nullptr, {}, 1, single);
  EXPECT_EQ(few.shares.size(), 1U);
  EXPECT_EQ(few.job.cpus, 1U);
}

TEST_F(Submitted, TwoAtOnceAreDistinguished) {
  const auto parts = shares();
  const std::size_t seen = store_.events(kSubmissions).size();
  const Submission one = prepare_submission(store_, {parts, 0, {}}, nlohmann::json::object(), seen);
  EXPECT_THROW(prepare_submission(store_, {parts, 0, {}}, nlohmann::json::object(), seen),
               ConcurrencyConflict);
  EXPECT_EQ(std::distance(fs::directory_iterator(store_.folder() / "submissions"), {}), 1)
      << "the late one left nothing";
  EXPECT_TRUE(fs::exists(one.folder(store_.folder())));
}

TEST_F(Submitted, CanBeReadFromTheLog) {
  const Submission made = submit(shares());
  store_.record(kSubmissions,
                {"JobQueued", {{"submission", made.id}, {"job", "17"}, {"fold_job", "18"}}});
  const auto known = read_submissions(store_);
  ASSERT_EQ(known.size(), 1U);
  EXPECT_EQ(known[0].id, made.id);
  EXPECT_EQ(known[0].tasks, made.tasks);
  EXPECT_EQ(known[0].job, "17");
  EXPECT_EQ(known[0].merge_job, "18");
  EXPECT_EQ(unfinished_submissions(store_).size(), 1U);
  fs::remove_all(made.folder(store_.folder()));
  EXPECT_TRUE(unfinished_submissions(store_).empty()) << "it is not of this folder";
}

TEST_F(Submitted, RejectsAnEventThatNamesAPathOrHasNoTasks) {
  for (const char* id : {"../../../x", "0123456789ab"}) {
    Store store(folder_.path() / std::to_string(id[0]), Access::create);
    store.record(kSubmissions, {"CampaignSubmitted", {{"submission", id}}});
    EXPECT_THROW(read_submissions(store), StoreDamaged);
  }
}

TEST(Queue, IsReadLineByLine) {
  const TemporaryFolder folder;
  const std::string name = "shearcell-0123456789ab";
  write_script(folder.path() / "squeue", "#!/bin/sh\n/bin/cat << END\nWelcome to the cluster!\n" +
                                             name + "|17|3|RUNNING|None|node7\n" + name +
                                             "|17|4|PENDING|Priority|\n" + name +
                                             "-fold|18|N/A|PENDING|Dependency|\n"
                                             "slurm_load_jobs error: nothing of this is a job\n"
                                             "other|19|1|RUNNING|None|node7\n"
                                             "a|b|c\n\n|||||\nEND\n");
  const Variable path("PATH", folder.path());
  EXPECT_TRUE(ask_queue({}).empty());
  const auto queue = ask_queue({name, name + "-fold"});
  ASSERT_EQ(queue.size(), 3U);
  EXPECT_EQ(queue[0].task, 3U);
  EXPECT_EQ(queue[0].node, "node7");
  EXPECT_EQ(queue[0].reason, "");
  EXPECT_EQ(queue[1].state, "PENDING");
  EXPECT_EQ(queue[1].reason, "Priority");
  EXPECT_EQ(queue[2].task, std::nullopt);
  EXPECT_EQ(queue[2].job, "18");
}

TEST(Described, NamesTheArrayWhileOnlyTheMergeJobWaits) {
  Submission made;
  made.id = "0123456789ab";
  made.tasks.resize(4);
  made.job = "17";
  made.merge_job = "18";
  made.queue = {{made.merge_name(), "18", {}, "PENDING", "Dependency", ""}};
  EXPECT_EQ(
      describe(made),
      "submission 0123456789ab: job 17, none of 4 tasks in the queue; job 18 will merge the task "
      "stores");
  made.job = "";  // a crash before it was recorded
  made.queue.insert(made.queue.begin(), {made.name(), "17", 1, "RUNNING", "", "node7"});
  EXPECT_TRUE(describe(made).starts_with("submission 0123456789ab: job 17, 1 running of 4"));
}

TEST(TaskReport, IsReturnedAndValidated) {
  const TemporaryFolder folder;
  const fs::path task = folder.path() / "task-1";
  EXPECT_TRUE(read_task_report(task).empty());
  Stage run;
  run.id = "abc";
  run.state = StageState::interrupted;
  run.cycle = 1.5;
  write_task_report(task, {run});
  ASSERT_EQ(read_task_report(task).count("abc"), 1U);
  EXPECT_EQ(read_task_report(task).at("abc").state, StageState::interrupted);
  EXPECT_EQ(read_task_report(task).at("abc").cycle, 1.5);
  for (const char* text :
       {"", "{", "[]", "3", "{\"runs\":3}", "{\"runs\":[3]}", "{\"runs\":[{\"id\":1}]}",
        "{\"runs\":[{\"id\":\"a\",\"state\":\"\\u001b[31m\",\"cycle\":1}]}",
        "{\"runs\":[{\"id\":\"a\",\"state\":\"running\",\"cycle\":\"1\"}]}"}) {
    std::ofstream(folder.path() / "task-1.progress.json", std::ios::trunc) << text;
    EXPECT_TRUE(read_task_report(task).empty()) << text;
  }
}

std::vector<Plan> plans(const std::string& text, const ExpandOptions& options = {}) {
  return {expand(parse_manifest(text, "tiny.yaml"), options)};
}

ExpandOptions of(std::uint64_t seeds, std::uint64_t cycles = 2) {
  return {.cycles = cycles, .seeds = seeds};
}

TEST(WorkLeft, BundlesRunsByTheirPacking) {
  const auto bundles = shares_of(plans(tiny_manifest("", kBothFluids), of(3)), nullptr);
  ASSERT_EQ(bundles.size(), 3U);
  for (const Share& bundle : bundles) {
    EXPECT_EQ(bundle.runs.size(), 2U) << "both fluids shear one packing";
    EXPECT_GT(bundle.particle_steps, 2 * 2 * kStepsPerCycle * kGrains)
        << "and it must settle first";
  }
}

TEST(WorkLeft, HasARunOfTwoManifestsOnceAtItsLongerLength) {
  const std::string both = tiny_manifest("", kBothFluids);
  std::vector<Plan> two = plans(both, of(2));
  const auto shorter = shares_of(two, nullptr);
  two.push_back(plans(tiny_manifest(), of(2, 9)).front());  // the still fluid, longer
  const auto bundles = shares_of(two, nullptr);
  ASSERT_EQ(bundles.size(), 2U);
  EXPECT_EQ(bundles[0].runs, shorter[0].runs);
  EXPECT_NEAR(bundles[0].particle_steps - shorter[0].particle_steps, 7.0 * kStepsPerCycle * kGrains,
              1);
}

TEST(WorkLeft, HasTheCheckpointsOfEveryManifestThatSharesARun) {
  const TemporaryFolder folder;
  Store store(folder.path() / "store", Access::create);
  const std::string dense = tiny_manifest("  cycles: 4\n");
  const std::string sparse = renamed(dense, "sparse") + "checkpoints: {every_cycles: 2}\n";
  compute(store, sparse);
  std::vector<Plan> both = plans(sparse);
  EXPECT_TRUE(shares_of(both, &store).empty());
  both.push_back(plans(dense).front());
  EXPECT_EQ(shares_of(both, &store).size(), 1U) << "cycles 1 and 3 are missing";
  compute(store, dense);
  EXPECT_TRUE(shares_of(both, &store).empty());
}

TEST(WorkLeft, LeavesOutFinishedWork) {
  const TemporaryFolder folder;
  Store store(folder.path() / "store", Access::create);
  const std::string text = tiny_manifest("", kBothFluids);
  compute(store, text, of(1));
  EXPECT_TRUE(shares_of(plans(text, of(1)), &store).empty());
  const auto more = shares_of(plans(text, of(2)), &store);
  ASSERT_EQ(more.size(), 1U);
  EXPECT_EQ(more[0].runs.size(), 2U);
  // A longer run continues: its packing and its first cycles cost nothing.
  const auto longer = shares_of(plans(text, of(1, 5)), &store);
  ASSERT_EQ(longer.size(), 1U);
  EXPECT_NEAR(longer[0].particle_steps, 2 * 3.0 * kStepsPerCycle * kGrains, 1);
}

TEST(Proposed, UsesTheRateOfEachStagesEngine) {
  const auto seconds = [](const std::string& engine) {
    const auto made =
        propose(plans(tiny_manifest("  engine: " + engine + "\n"), of(1)), nullptr, {}, 1, {});
    return made.seconds(made.shares.at(0));
  };
  const auto shear = [](EngineKind engine) {
    Stage stage;
    stage.resolved = {{"parameters", {{"engine", name_of(engine)}}}};
    stage.grains = kGrains;
    return 2.0 * kStepsPerCycle * kGrains / Rates({}).of(stage).particle_steps_per_second;
  };
  EXPECT_NEAR(seconds("lammps") - seconds("shearcell"),
              shear(EngineKind::lammps) - shear(EngineKind::shearcell), 1e-6)
      << "both settle the packing in this program";
}

Share bundle(const std::string& name, double seconds, double particle_steps = 0) {
  return {{name}, {name + "a", name + "b"}, particle_steps, seconds};
}

TEST(SharingOut, GivesEveryRunToOneTaskWithItsPacking) {
  std::vector<Share> bundles;
  for (int b = 0; b < 23; ++b) bundles.push_back(bundle(fmt::format("p{}", b), 1 + b % 5));
  for (const std::size_t tasks : {1U, 2U, 7U, 22U, 23U, 500U}) {
    const auto shares = share_out(bundles, tasks);
    EXPECT_EQ(shares.size(), std::min<std::size_t>(tasks, 23));
    std::map<std::string, int> times;
    double least = 1e9, most = 0;
    for (const Share& share : shares) {
      EXPECT_FALSE(share.runs.empty());
      EXPECT_EQ(share.runs.size(), 2 * share.packings.size());
      for (const std::string& run : share.runs) ++times[run];
      least = std::min(least, share.core_seconds);
      most = std::max(most, share.core_seconds);
    }
    EXPECT_EQ(times.size(), 46U);
    for (const auto& [run, count] : times) EXPECT_EQ(count, 1) << run;
    EXPECT_LE(most - least, 5) << "tasks differ by no more than the largest bundle";
  }
}

TEST(SharingOut, TakesTurnsIfAllCostTheSame) {
  const std::vector<Share> bundles = {bundle("p", 3), bundle("q", 3), bundle("r", 3),
                                      bundle("s", 3)};
  const auto shares = share_out(bundles, 2);
  EXPECT_EQ(shares[0].runs, (std::vector<std::string>{"pa", "pb", "ra", "rb"}));
  EXPECT_EQ(shares[1].runs, (std::vector<std::string>{"qa", "qb", "sa", "sb"}));
}

TEST(SharingOut, BalancesTimeNotSteps) {
  const auto shares = share_out({bundle("fast", 1, 8), bundle("slow", 2, 1), bundle("q", 1, 8)}, 2);
  EXPECT_EQ(shares[0].packings, (std::vector<std::string>{"slow"}));
  EXPECT_EQ(shares[1].packings, (std::vector<std::string>{"fast", "q"}));
}

TEST(SharingOut, LeavesNoTaskEmptyIfNothingCosts) {
  const auto shares = share_out({bundle("p", 0), bundle("q", 0), bundle("r", 0)}, 3);
  ASSERT_EQ(shares.size(), 3U);
  for (const Share& share : shares) EXPECT_EQ(share.packings.size(), 1U);
  EXPECT_TRUE(share_out({}, 5).empty());
}

}  // namespace
}  // namespace shearcell::test
