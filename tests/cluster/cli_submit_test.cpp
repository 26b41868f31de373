// SPDX-License-Identifier: GPL-3.0-or-later
// `submit` and `work` without Slurm, and with a Slurm that rejects jobs.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <csignal>

#include "tests/experiments/program.hpp"
#include "tests/support/variable.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

/// Slurm's programs are what the test puts into a folder of its own; nothing else is in PATH.
class Submit : public ProgramTest {
 protected:
  void program(const std::string& name, const std::string& body) const {
    write_script(programs_.path() / name, "#!/bin/sh\n" + body);
  }

  /// Jobs get the numbers 100, 101, ...; the queue holds what is in `queue`.
  void slurm_that_works() const {
    const std::string folder = programs_.path().string();
    program("sbatch", "[ \"$1\" = --version ] && exit 0\ncd '" + folder + R"('
echo x >> jobs
for word; do echo "$word" >> words; done
echo $((99 + $(/usr/bin/wc -l < jobs)))
)");
    program("squeue", "/bin/cat '" + folder + "/queue' 2>/dev/null; exit 0\n");
  }
  /// Submits the manifest, and returns the folder of the submission.
  std::string submitted(const Arguments& options = {}) {
    slurm_that_works();
    return json(joined({"submit", manifest_, "--json"}, options)).at("folder");
  }
  void queue(const std::string& lines) const { std::ofstream(programs_.path() / "queue") << lines; }
  std::string words() const { return read_bytes(programs_.path() / "words"); }

  std::string manifest_ = write("m.yaml", tiny_manifest("", kBothFluids));
  TemporaryFolder programs_;
  const Variable path_{"PATH", programs_.path()};
};

TEST_F(Submit, ADryRunNeedsNoSlurmAndWritesNothing) {
  const auto before = listing();
  expect(
      0, {"submit", manifest_, "--seeds", "3", "--time", "2:00:00", "--dry-run"},
      {"6 runs in 3 tasks; cores of each: 2", "#SBATCH --array=1-3\n", "#SBATCH --time=2:00:00\n",
       "store='" + path("shearcell-store/submissions/SUBMISSION/task-").string() + "'"});
  expect(0, {"submit", "--sbatch=--mem=2G", "--sbatch", "--qos=low", manifest_, "--dry-run"},
         {"#SBATCH --mem=2G\n#SBATCH --qos=low\n"});
  const auto facts =
      json({"submit", manifest_, "--seeds", "5", "--array-size", "2", "--dry-run", "--json"});
  EXPECT_EQ(facts.at("tasks").size(), 2U);
  EXPECT_EQ(facts.at("tasks")[0].at("runs").size(), 6U);
  EXPECT_EQ(listing(), before);
}

TEST_F(Submit, RejectsAFolderThatIsNotAStoreAsPlanDoes) {
  std::filesystem::create_directory(path("papers"));
  write("papers/draft.txt", "");
  const Outcome plan = run({"plan", manifest_, "--store", "papers"});
  const Outcome submit = run({"submit", manifest_, "--dry-run", "--store", "papers"});
  EXPECT_NE(submit.code, 0);
  EXPECT_EQ(submit.code, plan.code);
  EXPECT_EQ(submit.err, plan.err);
}

TEST_F(Submit, NamesARemedyWithoutSlurm) {
  const auto before = listing();
  expect(1, {"submit", manifest_}, {"sbatch is not installed here", "--dry-run"});
  EXPECT_EQ(listing(), before) << "something was written";
}

TEST_F(Submit, RejectsPathsThatSlurmWouldMisread) {
  for (const Arguments& words :
       {Arguments{"--partition", "a b"}, Arguments{"--account", "x\n#SBATCH --uid=0"},
        Arguments{"--time", "soon"}, Arguments{"--time", "2", "--warn", "90"},
        Arguments{"--sbatch=qos"}, Arguments{"--sbatch=--wrap=a b"}, Arguments{"--engine", "slurm"},
        Arguments{"--scratch", "/a\nb"}, Arguments{"--array-size", "0"},
        Arguments{"--cpus-per-task", "-1"}}) {
    expect(2, joined({"submit", manifest_, "--dry-run"}, words));
  }
  expect(2, {"submit", manifest_, "--dry-run", "--time", "2"}, {"120 s leave no time"});
}

TEST_F(Submit, QueuesBothJobsOnceAndRecordsThem) {
  slurm_that_works();
  const auto said = json({"submit", manifest_, "--seeds", "2", "--json"});
  const std::string id = said.at("submission");
  EXPECT_EQ(said.at("job"), "100");
  EXPECT_EQ(said.at("fold_job"), "101");
  EXPECT_TRUE(has(words(), "--job-name=shearcell-" + id + "\n"));
  EXPECT_TRUE(has(words(), "--dependency=afterany:100\n"));
  queue("shearcell-" + id + "|100|1|RUNNING|None|n1\nshearcell-" + id +
        "|100|2|PENDING|Priority|\nshearcell-" + id + "-fold|101|N/A|PENDING|Dependency|\n");
  const auto status = json({"status", "--json"});
  EXPECT_EQ(status.at("submissions")[0].at("in_queue"), 3);
  std::map<std::string, int> states;
  for (const auto& known : status.at("runs")) ++states[known.at("queue").at("state")];
  EXPECT_EQ(states, (std::map<std::string, int>{{"pending", 3}, {"running", 3}}));
  expect(0, {"status"}, {"100_2 pending Priority", "100_1 running n1"});
  // In the queue already: nothing is submitted. A new seed is.
  const auto again = json({"submit", manifest_, "--seeds", "2", "--json"});
  EXPECT_TRUE(again.at("submission").is_null());
  EXPECT_EQ(again.at("left_out"), 4);
  const auto more = json({"submit", manifest_, "--seeds", "3", "--json"});
  EXPECT_EQ(more.at("tasks").size(), 1U);
  EXPECT_EQ(more.at("left_out"), 4);
}

TEST_F(Submit, LeavesNothingOfARejectedSubmission) {
  slurm_that_works();
  program(
      "sbatch",
      "[ \"$1\" = --version ] && exit 0\necho 'sbatch: error: invalid partition' >&2; exit 1\n");
  expect(1, {"submit", manifest_, "--partition", "none"}, {"invalid partition"});
  EXPECT_TRUE(fs::is_empty(path("shearcell-store/submissions")));
  slurm_that_works();
  EXPECT_FALSE(json({"submit", manifest_, "--json"}).at("submission").is_null()) << "and goes on";
}

TEST_F(Submit, MergesLeftTasksAndSubmitsTheRest) {
  slurm_that_works();
  const auto said = json({"submit", manifest_, "--seeds", "2", "--json"});
  const std::string folder = said.at("folder");
  expect(0, {"work", "--store", folder + "/task-1"});
  // The queue is empty: all was cancelled.
  const auto rest = json({"submit", manifest_, "--seeds", "2", "--json"});
  EXPECT_EQ(rest.at("tasks").size(), 1U);
  EXPECT_EQ(rest.at("tasks")[0].at("runs"), said.at("tasks")[1].at("runs"));
  expect(0, {"work", "--store", rest.at("folder").get<std::string>() + "/task-1"});
  EXPECT_TRUE(json({"submit", manifest_, "--seeds", "2", "--json"}).at("submission").is_null());
  expect(0, {"run", manifest_, "--seeds", "2", "-q", "--store", "here"});
  EXPECT_EQ(hashes(), hashes("here"));
  expect(0, {"verify"});
}

TEST_F(Submit, TasksRunWhatWasSubmitted) {
  const std::string folder = submitted();
  write("m.yaml", "changed: since\n");
  expect(0, {"work", "--store", folder + "/task-1", "-j", "2"});
}

TEST_F(Submit, ATrailingSlashChangesNothing) {
  const std::string folder = submitted();
  fs::create_directory(path("scratch"));
  expect(0, {"work", "--store", folder + "/task-1/", "--scratch", path("scratch").string()});
  EXPECT_TRUE(fs::exists(folder + "/task-1.progress.json"));
  EXPECT_FALSE(fs::exists(folder + "/task-1/.progress.json"));
}

TEST_F(Submit, WorkStopsAfterAnyNumberOfWarningsAndContinues) {
  const std::string task = submitted({"--cycles", "16"}) + "/task-1";
  const Running worker = start_beside({"work", "--store", task, "-j", "2"}, "worker");
  wait_for_objects(4, task);
  for (const int signal : {SIGUSR1, SIGTERM, SIGTERM}) kill(worker.pid, signal);
  EXPECT_EQ(wait_for(worker).code, 85) << "the second signal does not kill";
  const std::size_t recorded = objects(task);
  ASSERT_LT(recorded, 30U);
  expect(0, {"work", "--store", task, "-j", "2", "--leave-failed"});
  expect(0, {"run", manifest_, "--cycles", "16", "-q", "--store", "here"});
  EXPECT_EQ(hashes(task), hashes("here"));
}

TEST_F(Submit, WorkOnScratchCopiesEverythingBack) {
  const std::string folder = submitted({"--cycles", "16"});
  const std::string task = folder + "/task-1";
  fs::create_directory(path("scratch"));
  const Arguments words = {
      "work", "--store", task, "-j", "2", "--scratch", path("scratch").string()};
  const Running killed = start_beside(words, "killed");
  const std::string copy = "scratch/shearcell-" + fs::path(folder).filename().string() + "-task-1";
  wait_for_objects(4, copy);
  kill(killed.pid, SIGKILL);
  wait_for(killed);
  EXPECT_EQ(objects(task), 0U);
  // On the same node the copy is found again; then it goes away.
  const Running worker = start_beside(words, "worker");
  wait_for_objects(8, copy);
  kill(worker.pid, SIGUSR1);
  EXPECT_EQ(wait_for(worker).code, 85);
  EXPECT_TRUE(fs::is_empty(path("scratch")));
  EXPECT_GE(objects(task), 8U);
  expect(0, words);
  expect(0, {"run", manifest_, "--cycles", "16", "-q", "--store", "here"});
  EXPECT_EQ(hashes(task), hashes("here"));
}

TEST_F(Submit, WorkDoesNotRepeatFailedRuns) {
  // No contact may overlap by this little: each run fails as soon as it is looked at.
  manifest_ = write("f.yaml", tiny_manifest("  max_overlap_diameters: 1.0e-6\n"));
  const std::string task = submitted() + "/task-1";
  expect(3, {"work", "--store", task});
  expect(3, {"work", "--store", task, "--leave-failed"}, {"nothing is left to compute"});
}

// Others may have put files beside a task's store.
TEST_F(Submit, IgnoresPipesAndLinksInPlaceOfProgressFiles) {
  const fs::path task = submitted() + "/task-1";
  const fs::path progress = task.string() + ".progress.json";
  ASSERT_EQ(mkfifo(progress.c_str(), 0600), 0);
  expect(0, {"status"});  // which does not wait for a pipe
  fs::remove(progress);
  write("precious", "mine");
  fs::create_symlink(path("precious"), progress);
  fs::create_symlink(path("precious"), progress.string() + ".new");
  expect(0, {"work", "--store", task, "-j", "2"});
  EXPECT_EQ(read_bytes(path("precious")), "mine");
  EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(progress)));
}

TEST_F(Submit, GivesUpOnAQueueThatDoesNotAnswer) {
  submitted();
  program("squeue", "exec /bin/sleep 600\n");
  expect(0, {"status"}, {"squeue did not answer within 15 s"});
}

// What the tasks measured is not measured again; the checkpoint at the last cycle asked for ends a
// run without being measured.
TEST_F(Submit, CopiesCachedMeasuresToo) {
  manifest_ = write("u.yaml", tiny_manifest("", "until: {phi: 0.9, extra_cycles: 0}\n"));
  const std::string task = submitted() + "/task-1";
  expect(0, {"work", "--store", task});
  expect(0, {"merge", task});
  // There is no gnuplot in this PATH.
  expect(1, {"figures", "S2", "--out", "."}, {"3 checkpoints, 1 of them newly measured"});
}

TEST_F(Submit, WorkNeedsAStore) {
  expect_refused({"work", "--store", "nowhere"}, {"nowhere"});
  expect_refused({"work", "--store", "nowhere", "--scratch", "x"}, {"nowhere"});
}

}  // namespace
}  // namespace shearcell::test
