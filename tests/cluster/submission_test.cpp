// SPDX-License-Identifier: GPL-3.0-or-later
// Stores for tasks, folding them, and the events that record it; without Slurm.
#include <gtest/gtest.h>

#include <fstream>

#include "experiments/cluster/proposal.hpp"
#include "experiments/cluster/queue_view.hpp"
#include "experiments/runner/run_end.hpp"
#include "tests/experiments/temporary_store.hpp"

namespace shearcell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests
namespace fs = std::filesystem;

class Submitted : public testing::Test {
 protected:
  Submitted() : store_(folder_.path() / "store", Access::create) {}

  std::vector<Share> shares(std::uint64_t cycles = 2) {
    const std::string text = tiny_manifest("", kBothFluids);
    ExpandOptions options;
    options.seeds = 2;
    options.cycles = cycles;
    const Manifest manifest = parse_manifest(text, "tiny.yaml");
    const Plan plan = expand(manifest, options);
    declare(store_, manifest, plan);
    return share_out(work_left({plan}, store_.runs()), 2);
  }

  Submission submit(const std::vector<Share>& parts) {
    return prepare_submission(store_, parts, {{"engine", "test"}},
                              store_.events(kSubmissions).size());
  }

  std::map<std::string, std::string> computed_here(std::uint64_t cycles) {
    Store whole(folder_.path() / ("whole" + std::to_string(cycles)), Access::create);
    ExpandOptions options;
    options.seeds = 2;
    options.cycles = cycles;
    compute(whole, tiny_manifest("", kBothFluids), options);
    return final_hashes(whole);
  }

  TemporaryFolder folder_;
  Store store_;
};

TEST_F(Submitted, TasksComputeTheirSharesAndTheirStoresFoldIntoTheWhole) {
  const Submission made = submit(shares());
  for (std::size_t task = 1; task <= 2; ++task) {
    Store own(made.task_store(store_.folder(), task), Access::write);
    EXPECT_EQ(own.runs().size(), 3U) << "two runs and their packing, nothing else";
    EXPECT_EQ(resume(own).completed, 3U);
    EXPECT_TRUE(own.verify().ok());
  }
  EXPECT_EQ(fold(store_, made).size(), 2U);
  EXPECT_EQ(final_hashes(store_), computed_here(2));
  EXPECT_TRUE(store_.verify().ok());
  const Head head = store_.head();
  fold(store_, made);
  EXPECT_EQ(store_.head().hash, head.hash) << "folding twice changes nothing";
  EXPECT_TRUE(unfinished_submissions(store_).empty());
}

TEST_F(Submitted, ATaskGoesOnFromWhatTheStoreHolds) {
  const Submission first = submit(shares(1));
  for (std::size_t task = 1; task <= 2; ++task) {
    Store own(first.task_store(store_.folder(), task), Access::write);
    resume(own);
  }
  fold(store_, first);
  const auto parts = shares(3);
  const Submission second = submit(parts);
  for (std::size_t task = 1; task <= 2; ++task) {
    Store own(second.task_store(store_.folder(), task), Access::write);
    const CampaignResult result = resume(own);
    EXPECT_EQ(result.completed, 2U) << "the packing is there, and the first cycle";
  }
  fold(store_, second);
  EXPECT_EQ(final_hashes(store_), computed_here(3));
  for (const RunRecord& run : store_.runs()) {
    const auto records = store_.checkpoints(run.id);
    EXPECT_EQ(count_events(store_, "CheckpointRecorded", "run/" + run.id), records.size());
    if (run.kind == "prepare") {
      EXPECT_EQ(run.attempts, 1U);
    } else {
      EXPECT_EQ(run.particle_steps, 3.0 * kStepsPerCycle * kGrains) << "no step was made twice";
    }
  }
}

TEST_F(Submitted, TasksEndRunsWhereUntilSays) {
  const Manifest manifest =
      parse_manifest(tiny_manifest("", "until: {phi: 0.1, extra_cycles: 1}\n"), "tiny.yaml");
  const Plan plan = expand(manifest);
  declare(store_, manifest, plan);
  const Submission made = submit(share_out(work_left({plan}, store_.runs()), 1));
  Store own(made.task_store(store_.folder(), 1), Access::write);
  EXPECT_EQ(resume(own).completed, 2U);
  fold(store_, made);
  const RunRecord run = runs_of_kind(store_, "shear").front();
  EXPECT_EQ(run.state, RunState::completed);
  EXPECT_EQ(run.cycle, 1);
  EXPECT_EQ(describe_end(end_of(store_, run)), "phi >= 0.1 at cycle 0 and 1 cycles more");
  EXPECT_TRUE(work_left({plan}, store_.runs()).empty());
}

TEST_F(Submitted, RunsInTheQueueAreBusyWithTheirPackings) {
  const Submission made = submit(shares());
  EXPECT_TRUE(busy_runs(store_, {{made, {}}}).empty()) << "its jobs have ended";
  const QueuedTask waiting{
      .name = made.name(), .job = "17", .task = 2, .state = "PENDING", .reason = {}, .node = {}};
  EXPECT_EQ(busy_runs(store_, {{made, {waiting}}}).size(), 6U)
      << "nothing is folded before the end";
}

TEST_F(Submitted, RunsAtWorkHereAreBusyWithTheirPackings) {
  const std::string run = shares().at(0).runs.at(0), packing = store_.run(run).parent;
  EXPECT_TRUE(busy_runs(store_, {}).empty());
  store_.start_run(run, nlohmann::json::object());
  EXPECT_EQ(busy_runs(store_, {}), (std::set<std::string>{run, packing}));
  store_.start_run(packing, nlohmann::json::object());
  store_.complete_run(packing);
  EXPECT_EQ(busy_runs(store_, {}), (std::set<std::string>{run})) << "others may start from it";
}

TEST(Proposed, LeavesOutBundlesThatAreBusyAndGivesACoreToEachRun) {
  ExpandOptions options;
  options.seeds = 3;
  const std::vector<Plan> plans = {
      expand(parse_manifest(tiny_manifest("", kBothFluids), "tiny.yaml"), options)};
  const Proposal all = propose(plans, {}, {}, 1000, {});
  EXPECT_EQ(all.shares.size(), 3U);
  EXPECT_EQ(all.job.cpus, 2U);
  JobOptions threaded, single;
  threaded.threads = 4;
  single.cpus = 1;
  const Proposal rest = propose(plans, {}, {all.shares[1].runs[0]}, 1000, threaded);
  EXPECT_EQ(rest.shares.size(), 2U);
  EXPECT_EQ(rest.left_out, 2U);
  EXPECT_EQ(rest.job.cpus, 8U);
  const Proposal few = propose(plans, {}, {}, 1, single);
  EXPECT_EQ(few.shares.size(), 1U);
  EXPECT_EQ(few.job.cpus, 1U);
}

TEST_F(Submitted, TwoAtOnceAreToldApart) {
  const auto parts = shares();
  const std::size_t seen = store_.events(kSubmissions).size();
  const Submission one = prepare_submission(store_, parts, nlohmann::json::object(), seen);
  EXPECT_THROW(prepare_submission(store_, parts, nlohmann::json::object(), seen),
               ConcurrencyConflict);
  std::size_t folders = 0;
  for ([[maybe_unused]] const auto& entry :
       fs::directory_iterator(store_.folder() / "submissions")) {
    ++folders;
  }
  EXPECT_EQ(folders, 1U) << "the late one left nothing";
  EXPECT_TRUE(fs::exists(one.folder(store_.folder())));
}

TEST_F(Submitted, IsReadBackFromTheLog) {
  const Submission made = submit(shares());
  store_.record_submission("JobQueued",
                           {{"submission", made.id}, {"job", "17"}, {"fold_job", "18"}});
  const auto known = read_submissions(store_);
  ASSERT_EQ(known.size(), 1U);
  EXPECT_EQ(known[0].id, made.id);
  EXPECT_EQ(known[0].tasks, made.tasks);
  EXPECT_EQ(known[0].job, "17");
  EXPECT_EQ(known[0].fold_job, "18");
  EXPECT_EQ(unfinished_submissions(store_).size(), 1U);
  fs::remove_all(made.folder(store_.folder()));
  EXPECT_TRUE(unfinished_submissions(store_).empty()) << "it is not of this folder";
}

TEST_F(Submitted, RefusesAnEventThatNamesAPathOrHasNoTasks) {
  for (const char* id : {"../../../x", "0123456789ab"}) {
    Store store(folder_.path() / std::to_string(id[0]), Access::create);
    store.record_submission("CampaignSubmitted", {{"submission", id}});
    EXPECT_THROW(read_submissions(store), StoreDamaged);
  }
}

TEST(Queue, IsReadLineByLine) {
  const auto queue = read_queue(
      "shearcell-0123456789ab|17|3|RUNNING|None|node7\n"
      "shearcell-0123456789ab|17|4|PENDING|Priority|\n"
      "shearcell-0123456789ab-fold|18|N/A|PENDING|Dependency|\n"
      "slurm_load_jobs error: nothing of this is a job\n"
      "a|b|c\n\n|||||\n");
  ASSERT_EQ(queue.size(), 3U);
  EXPECT_EQ(queue[0].task, 3U);
  EXPECT_EQ(queue[0].node, "node7");
  EXPECT_EQ(queue[0].reason, "");
  EXPECT_EQ(queue[1].state, "PENDING");
  EXPECT_EQ(queue[1].reason, "Priority");
  EXPECT_EQ(queue[2].task, std::nullopt);
  EXPECT_EQ(queue[2].job, "18");
}

TEST(TaskReport, ComesBackAndIsNotTrusted) {
  const TemporaryFolder folder;
  const fs::path task = folder.path() / "task-1";
  EXPECT_TRUE(read_task_report(task).empty());
  RunRecord run;
  run.id = "abc";
  run.state = RunState::interrupted;
  run.cycle = 1.5;
  write_task_report(task, {run});
  ASSERT_EQ(read_task_report(task).count("abc"), 1U);
  EXPECT_EQ(read_task_report(task).at("abc").state, RunState::interrupted);
  EXPECT_EQ(read_task_report(task).at("abc").cycle, 1.5);
  for (const char* text :
       {"", "{", "[]", "3", "{\"runs\":3}", "{\"runs\":[3]}", "{\"runs\":[{\"id\":1}]}",
        "{\"runs\":[{\"id\":\"a\",\"state\":\"\\u001b[31m\",\"cycle\":1}]}",
        "{\"runs\":[{\"id\":\"a\",\"state\":\"running\",\"cycle\":\"1\"}]}"}) {
    std::ofstream(folder.path() / "task-1.progress.json", std::ios::trunc) << text;
    EXPECT_TRUE(read_task_report(task).empty()) << text;
  }
}

}  // namespace
}  // namespace shearcell
