// SPDX-License-Identifier: GPL-3.0-or-later
// `submit` and `work` as a user meets them where there is no Slurm, or one that refuses.
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <csignal>
#include <cstdlib>

#include "tests/experiments/program.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Slurm's programs are what the test puts into a folder of its own; nothing else is in PATH.
class Submit : public ProgramTest {
 protected:
  Submit() : manifest_(write("m.yaml", tiny_manifest("", kBothFluids))) {
    const char* path = std::getenv("PATH");
    if (path != nullptr) before_ = path;
    setenv("PATH", programs_.path().c_str(), 1);
  }
  ~Submit() override { setenv("PATH", before_.c_str(), 1); }

  void program(const std::string& name, const std::string& body) const {
    const fs::path file = programs_.path() / name;
    std::ofstream(file) << "#!/bin/sh\n" << body;
    fs::permissions(file, fs::perms::owner_all);
  }

  /// Jobs get the numbers 100, 101, ...; the queue holds what is in `queue`.
  void slurm_that_works() const {
    const std::string folder = programs_.path().string();
    program("sbatch",
            "[ \"$1\" = --version ] && exit 0\n"
            "echo x >> '" +
                folder +
                "/jobs'\n"
                "for word; do echo \"$word\" >> '" +
                folder +
                "/words'; done\n"
                "n=$(/usr/bin/wc -l < '" +
                folder + "/jobs'); echo $((99 + n))\n");
    program("squeue", "/bin/cat '" + folder + "/queue' 2>/dev/null; exit 0\n");
  }
  void queue(const std::string& lines) const { std::ofstream(programs_.path() / "queue") << lines; }
  std::string words() const { return read_bytes(programs_.path() / "words"); }

  std::string manifest_, before_;
  TemporaryFolder programs_;
};

TEST_F(Submit, ShowsAllWithoutSlurmAndWritesNothing) {
  const auto before = listing();
  const Outcome shown =
      run({"submit", manifest_, "--seeds", "3", "--time", "2:00:00", "--dry-run"});
  EXPECT_EQ(shown.code, 0) << shown.err;
  EXPECT_TRUE(contains(shown.out, "6 runs in 3 tasks; cores of each: 2")) << shown.out;
  EXPECT_TRUE(contains(shown.out, "#SBATCH --array=1-3\n"));
  EXPECT_TRUE(contains(shown.out, "#SBATCH --time=2:00:00\n"));
  EXPECT_TRUE(contains(
      shown.out, "store='" + path("shearcell-store/submissions/SUBMISSION/task-").string() + "'"));
  const Outcome options =
      run({"submit", "--sbatch=--mem=2G", "--sbatch", "--qos=low", manifest_, "--dry-run"});
  EXPECT_TRUE(contains(options.out, "#SBATCH --mem=2G\n#SBATCH --qos=low\n")) << options.err;
  const auto facts =
      json({"submit", manifest_, "--seeds", "5", "--array-size", "2", "--dry-run", "--json"});
  EXPECT_EQ(facts.at("tasks").size(), 2U);
  EXPECT_EQ(facts.at("tasks")[0].at("runs").size(), 6U);
  EXPECT_EQ(listing(), before);
}

TEST_F(Submit, SaysWhatToDoWithoutSlurm) {
  const auto before = listing();
  const Outcome refused = run({"submit", manifest_});
  EXPECT_EQ(refused.code, 1);
  EXPECT_TRUE(contains(refused.err, "sbatch is not installed here")) << refused.err;
  EXPECT_TRUE(contains(refused.err, "--dry-run"));
  EXPECT_EQ(listing(), before) << "nothing was written";
}

TEST_F(Submit, RefusesWhatSlurmWouldMisread) {
  for (const Arguments& words :
       {Arguments{"--partition", "a b"}, Arguments{"--account", "x\n#SBATCH --uid=0"},
        Arguments{"--time", "soon"}, Arguments{"--time", "2", "--warn", "90"},
        Arguments{"--sbatch=qos"}, Arguments{"--sbatch=--wrap=a b"}, Arguments{"--engine", "pbs"},
        Arguments{"--scratch", "/a\nb"}, Arguments{"--array-size", "0"},
        Arguments{"--cpus-per-task", "-1"}}) {
    Arguments all = {"submit", manifest_, "--dry-run"};
    all.insert(all.end(), words.begin(), words.end());
    const Outcome refused = run(all);
    EXPECT_EQ(refused.code, 2) << words.back() << "\n" << refused.err;
  }
  const Outcome short_limit = run({"submit", manifest_, "--dry-run", "--time", "2"});
  EXPECT_TRUE(contains(short_limit.err, "120 s leave no time")) << short_limit.err;
}

TEST_F(Submit, QueuesBothJobsOnceAndKnowsThemAfterwards) {
  slurm_that_works();
  const auto said = json({"submit", manifest_, "--seeds", "2", "--json"});
  const std::string id = said.at("submission");
  EXPECT_EQ(said.at("job"), "100");
  EXPECT_EQ(said.at("fold_job"), "101");
  EXPECT_TRUE(contains(words(), "--job-name=shearcell-" + id + "\n"));
  EXPECT_TRUE(contains(words(), "--dependency=afterany:100\n"));
  queue("shearcell-" + id + "|100|1|RUNNING|None|n1\nshearcell-" + id +
        "|100|2|PENDING|Priority|\nshearcell-" + id + "-fold|101|N/A|PENDING|Dependency|\n");
  const auto status = json({"status", "--json"});
  EXPECT_EQ(status.at("submissions")[0].at("in_queue"), 3);
  std::map<std::string, int> states;
  for (const auto& known : status.at("runs")) ++states[known.at("queue").at("state")];
  EXPECT_EQ(states, (std::map<std::string, int>{{"pending", 3}, {"running", 3}}));
  const Outcome shown = run({"status"});
  EXPECT_TRUE(contains(shown.out, "100_2 pending Priority")) << shown.out;
  EXPECT_TRUE(contains(shown.out, "100_1 running n1"));
  // In the queue already: nothing is submitted. A new seed is.
  const auto again = json({"submit", manifest_, "--seeds", "2", "--json"});
  EXPECT_TRUE(again.at("submission").is_null());
  EXPECT_EQ(again.at("left_out"), 4);
  const auto more = json({"submit", manifest_, "--seeds", "3", "--json"});
  EXPECT_EQ(more.at("tasks").size(), 1U);
  EXPECT_EQ(more.at("left_out"), 4);
}

TEST_F(Submit, LeavesNothingOfASubmissionThatSlurmRefused) {
  slurm_that_works();
  program(
      "sbatch",
      "[ \"$1\" = --version ] && exit 0\necho 'sbatch: error: invalid partition' >&2; exit 1\n");
  const Outcome refused = run({"submit", manifest_, "--partition", "none"});
  EXPECT_EQ(refused.code, 1);
  EXPECT_TRUE(contains(refused.err, "invalid partition")) << refused.err;
  EXPECT_TRUE(fs::is_empty(path("shearcell-store/submissions")));
  slurm_that_works();
  EXPECT_FALSE(json({"submit", manifest_, "--json"}).at("submission").is_null()) << "and goes on";
}

TEST_F(Submit, FoldsWhatNoJobFoldedAndSubmitsTheRest) {
  slurm_that_works();
  const auto said = json({"submit", manifest_, "--seeds", "2", "--json"});
  const std::string folder = said.at("folder");
  EXPECT_EQ(run({"work", "--store", folder + "/task-1"}).code, 0);
  // The queue is empty: all was cancelled.
  const auto rest = json({"submit", manifest_, "--seeds", "2", "--json"});
  EXPECT_EQ(rest.at("tasks").size(), 1U);
  EXPECT_EQ(rest.at("tasks")[0].at("runs"), said.at("tasks")[1].at("runs"));
  EXPECT_EQ(run({"work", "--store", rest.at("folder").get<std::string>() + "/task-1"}).code, 0);
  EXPECT_TRUE(json({"submit", manifest_, "--seeds", "2", "--json"}).at("submission").is_null());
  ASSERT_EQ(run({"run", manifest_, "--seeds", "2", "-q", "--store", "here"}).code, 0);
  EXPECT_EQ(hashes(), hashes("here"));
  EXPECT_EQ(run({"verify"}).code, 0);
}

TEST_F(Submit, TasksRunWhatWasSubmitted) {
  slurm_that_works();
  const std::string folder = json({"submit", manifest_, "--json"}).at("folder");
  write("m.yaml", "changed: since\n");
  EXPECT_EQ(run({"work", "--store", folder + "/task-1", "-j", "2"}).code, 0);
}

TEST_F(Submit, WorkStopsWhenItIsWarnedHoweverOftenAndGoesOn) {
  slurm_that_works();
  const std::string folder = json({"submit", manifest_, "--cycles", "16", "--json"}).at("folder");
  const std::string task = folder + "/task-1";
  const Running worker = start_beside({"work", "--store", task, "-j", "2"}, "worker");
  while (objects(task) < 4) usleep(10000);
  for (const int signal : {SIGUSR1, SIGTERM, SIGTERM}) kill(worker.pid, signal);
  EXPECT_EQ(wait_for(worker).code, 85) << "the second signal does not kill";
  const std::size_t recorded = objects(task);
  ASSERT_LT(recorded, 30U);
  EXPECT_EQ(run({"work", "--store", task, "-j", "2", "--leave-failed"}).code, 0);
  ASSERT_EQ(run({"run", manifest_, "--cycles", "16", "-q", "--store", "here"}).code, 0);
  EXPECT_EQ(hashes(task), hashes("here"));
}

TEST_F(Submit, WorkOnScratchBringsEverythingBack) {
  slurm_that_works();
  const std::string folder = json({"submit", manifest_, "--cycles", "16", "--json"}).at("folder");
  const std::string task = folder + "/task-1";
  fs::create_directory(path("scratch"));
  const Arguments words = {
      "work", "--store", task, "-j", "2", "--scratch", path("scratch").string()};
  const Running killed = start_beside(words, "killed");
  const std::string copy = "scratch/shearcell-" + fs::path(folder).filename().string() + "-task-1";
  while (!fs::exists(path(copy)) || objects(copy) < 4) usleep(10000);
  kill(killed.pid, SIGKILL);
  wait_for(killed);
  EXPECT_EQ(objects(task), 0U);
  // On the same node the copy is found again; then it goes away.
  const Running worker = start_beside(words, "worker");
  while (objects(copy) < 8) usleep(10000);
  kill(worker.pid, SIGUSR1);
  EXPECT_EQ(wait_for(worker).code, 85);
  EXPECT_TRUE(fs::is_empty(path("scratch")));
  EXPECT_GE(objects(task), 8U);
  EXPECT_EQ(run(words).code, 0);
  ASSERT_EQ(run({"run", manifest_, "--cycles", "16", "-q", "--store", "here"}).code, 0);
  EXPECT_EQ(hashes(task), hashes("here"));
}

TEST_F(Submit, WorkLeavesFailedRunsAlone) {
  slurm_that_works();
  // No contact may overlap by this little: each run fails as soon as it is looked at.
  const std::string failing = write("f.yaml", tiny_manifest("  max_overlap_diameters: 1.0e-6\n"));
  const std::string folder = json({"submit", failing, "--json"}).at("folder");
  const Outcome first = run({"work", "--store", folder + "/task-1"});
  EXPECT_EQ(first.code, 3) << first.err;
  const Outcome second = run({"work", "--store", folder + "/task-1", "--leave-failed"});
  EXPECT_EQ(second.code, 3) << second.err;
  EXPECT_TRUE(contains(second.out, "0 stages computed, 0 were done already, 0 failed"))
      << second.out;
}

// Beside a task's store lies what others put there.
TEST_F(Submit, ProgressFilesAreNeitherWaitedForNorFollowed) {
  slurm_that_works();
  const fs::path task =
      json({"submit", manifest_, "--json"}).at("folder").get<std::string>() + "/task-1";
  const fs::path progress = task.string() + ".progress.json";
  ASSERT_EQ(mkfifo(progress.c_str(), 0600), 0);
  EXPECT_EQ(run({"status"}).code, 0) << "waited for a pipe";
  fs::remove(progress);
  write("precious", "mine");
  fs::create_symlink(path("precious"), progress);
  fs::create_symlink(path("precious"), progress.string() + ".new");
  EXPECT_EQ(run({"work", "--store", task, "-j", "2"}).code, 0);
  EXPECT_EQ(read_bytes(path("precious")), "mine");
  EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(progress)));
}

TEST_F(Submit, AQueueThatDoesNotAnswerIsNotWaitedForLong) {
  slurm_that_works();
  EXPECT_FALSE(json({"submit", manifest_, "--json"}).at("submission").is_null());
  program("squeue", "exec /bin/sleep 600\n");
  const Outcome status = run({"status"});
  EXPECT_EQ(status.code, 0) << status.err;
  EXPECT_TRUE(contains(status.out, "squeue did not answer within 15 s")) << status.out;
}

// What the tasks measured is not measured again.
TEST_F(Submit, KeptMeasuresComeAlong) {
  slurm_that_works();
  const std::string until =
      write("u.yaml", tiny_manifest("", "until: {phi: 0.9, extra_cycles: 0}\n"));
  const std::string folder = json({"submit", until, "--json"}).at("folder");
  EXPECT_EQ(run({"work", "--store", folder + "/task-1"}).code, 0);
  EXPECT_EQ(run({"merge", folder + "/task-1"}).code, 0);
  const Outcome figure = run({"figures", "S2", "--out", "."});
  EXPECT_EQ(figure.code, 1) << "no gnuplot in this PATH: " << figure.err;
  EXPECT_TRUE(contains(figure.out, "0 of them measured now")) << figure.out;
}

TEST_F(Submit, WorkNeedsAStore) {
  EXPECT_EQ(run({"work", "--store", "nowhere"}).code, 2);
  EXPECT_EQ(run({"work", "--store", "nowhere", "--scratch", "x"}).code, 2);
  EXPECT_FALSE(fs::exists(path("x")));
}

}  // namespace
}  // namespace shearcell::test
