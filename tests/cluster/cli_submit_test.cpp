// SPDX-License-Identifier: GPL-3.0-or-later
// `submit` and `resume --task` without Slurm, and with a Slurm that rejects jobs.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <csignal>
#include <functional>
#include <memory>

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

  /// Jobs get the numbers 100, 101, ..., and sbatch prints this; the queue holds what is in
  /// `queue`.
  void slurm_that_works(const std::string& answer = "echo $number") const {
    const std::string folder = programs_.path().string();
    program("sbatch", "[ \"$1\" = --version ] && exit 0\ncd '" + folder + R"('
echo x >> jobs
for word; do
  echo "$word" >> words
  case $word in --job-name=*) name=${word#--job-name=};; esac
done
number=$((99 + $(/usr/bin/wc -l < jobs)))
/usr/bin/env > "environment-$number"
)" + answer + "\n");
    program("squeue", "cd '" + folder + R"('
for word; do echo "$word" >> asked; done
/usr/bin/env > environment-squeue
/bin/cat queue 2>/dev/null; exit 0
)");
  }
  std::string said(const std::string& file) const { return read_bytes(programs_.path() / file); }
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
  expect(0, {"submit", manifest_, "--seeds", "3", "--time", "2:00:00", "--dry-run"},
         {"6 runs in 3 tasks; cores per task: 2", " --array=1-3 ", " --time=2:00:00 ",
          path("shearcell-store/submissions/SUBMISSION").string() + "/task-%a.log"});
  expect(0, {"submit", "--sbatch=--mem=2G", "--sbatch", "--qos=low", manifest_, "--dry-run"},
         {" --mem=2G --qos=low "});
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
  const auto refusal = [](const std::string& said) {
    return said.substr(said.find("shearcell: "));
  };
  EXPECT_EQ(refusal(submit.err), refusal(plan.err)) << "`plan` prints every warning before it";
}

TEST_F(Submit, NamesARemedyWithoutSlurm) {
  const auto before = listing();
  expect(1, {"submit", manifest_}, {"sbatch is not installed here", "--dry-run"});
  EXPECT_EQ(listing(), before) << "something was written";
}

TEST_F(Submit, RejectsPathsThatSlurmWouldMisread) {
  for (const Arguments& words :
       {Arguments{"--time", "2", "--warn", "90"}, Arguments{"--sbatch=--time=2"},
        Arguments{"--sbatch=qos"}, Arguments{"--sbatch=--wrap=a b"}, Arguments{"--engine", "slurm"},
        Arguments{"--scratch", "/a\nb"}, Arguments{"--scratch", "~/x"},
        Arguments{"--scratch", "$(rm -rf x)"}, Arguments{"--array-size", "0"},
        Arguments{"--sbatch=--array=1-2"}, Arguments{"--sbatch=--arr=1"},
        Arguments{"--sbatch=--clusters=b"}, Arguments{"--sbatch=--wait"},
        Arguments{"--sbatch=--test-only"}, Arguments{"--sbatch=--wrap=x"},
        Arguments{"--cpus-per-task", "-1"}, Arguments{"--sbatch=" + std::string(60'000, 'a')}}) {
    const Outcome refused = expect(2, joined({"submit", manifest_, "--dry-run"}, words));
    EXPECT_LT(refused.err.size(), 1000U);
  }
  expect(2, {"submit", manifest_, "--dry-run", "--time", "2"}, {"120 s leaves no time"});
  expect(0, {"submit", manifest_, "--dry-run", "--time", "0"}, {"--time=0"});
}

// sbatch itself refuses values that it does not know.
TEST_F(Submit, GivesSbatchTheValuesOfTheUser) {
  submitted({"--sbatch=--partition=x", "--time", "soon", "-p", "a b", "-A", "x\n#SBATCH --uid=0",
             "--sbatch=--qos=low", "--sbatch=--comment="});
  EXPECT_TRUE(has(words(),
                  "--partition=x\n--qos=low\n--comment=\n--partition=a b\n"
                  "--account=x\n#SBATCH --uid=0\n--time=soon\n--nodes=1\n"))
      << words();
  const std::string text(60'000, 'a');
  expect(0, {"submit", manifest_, "--account", text, "--store", "long"});
  EXPECT_TRUE(has(words(), "--account=" + text + "\n"));
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

// Variables of Slurm's programs that the user, a site, or the job in which `submit` runs has set.
TEST_F(Submit, RemovesVariablesThatWouldChangeWhatItAsksForAndNoOthers) {
  slurm_that_works();
  const std::vector<std::string> removed = {
      "SQUEUE_PARTITION",    "SQUEUE_USERS",          "SQUEUE_STATES",       "SQUEUE_FORMAT",
      "SQUEUE_FORMAT2",      "SQUEUE_ACCOUNT",        "SQUEUE_NAMES",        "SQUEUE_QOS",
      "SQUEUE_LOCAL",        "SQUEUE_NOT_YET_KNOWN",  "SLURM_CLUSTERS",      "SBATCH_CLUSTERS",
      "SBATCH_ARRAY_INX",    "SBATCH_NO_REQUEUE",     "SBATCH_REQUEUE",      "SBATCH_TIMELIMIT",
      "SBATCH_SIGNAL",       "SBATCH_OUTPUT",         "SBATCH_ERROR",        "SBATCH_INPUT",
      "SBATCH_OPEN_MODE",    "SBATCH_JOB_NAME",       "SBATCH_WAIT",         "SBATCH_EXPORT",
      "SBATCH_GET_USER_ENV", "SBATCH_OVERCOMMIT",     "SBATCH_CPUS_PER_GPU", "SBATCH_NO_KILL",
      "SLURM_RESTART_COUNT", "SLURM_ARRAY_TASK_ID",   "SLURM_ARRAY_JOB_ID",  "SLURM_MEM_PER_CPU",
      "SLURM_MEM_PER_NODE",  "SLURM_NTASKS_PER_NODE", "SLURM_TRES_PER_TASK"};
  const std::vector<std::string> kept = {
      "SLURM_CONF",         "SLURM_JWT",         "SBATCH_ACCOUNT",     "SBATCH_PARTITION",
      "SBATCH_QOS",         "SBATCH_CONSTRAINT", "SBATCH_RESERVATION", "SBATCH_MEM_PER_CPU",
      "SBATCH_GRES",        "SBATCH_WCKEY",      "MODULEPATH",         "LOADEDMODULES",
      "OMPI_MCA_btl",       "OMP_NUM_THREADS",   "LD_LIBRARY_PATH",    "SQUEUE",
      "MY_SQUEUE_PARTITION"};
  std::vector<std::unique_ptr<Variable>> set;
  for (const auto& names : {removed, kept}) {
    for (const std::string& name : names) {
      set.push_back(std::make_unique<Variable>(name.c_str(), "hostile"));
    }
  }
  submitted();
  expect(0, {"status"});
  for (const char* file : {"environment-100", "environment-101", "environment-squeue"}) {
    const std::string environment = "\n" + said(file);
    for (const std::string& name : removed) {
      EXPECT_FALSE(has(environment, "\n" + name + "=")) << file;
    }
    for (const std::string& name : kept) EXPECT_TRUE(has(environment, "\n" + name + "=hostile\n"));
  }
  for (const char* word :
       {"--noheader\n", "--array\n", "--all\n", "--states=PENDING,RUNNING,SUSPENDED,COMPLETING\n",
        "--format=%j|%F|%K|%T|%r|%N\n"}) {
    EXPECT_TRUE(has(said("asked"), word));
  }
}

// A site's wrapper prints its own lines, or sbatch ends with an error after it queued the job.
TEST_F(Submit, KnowsTheNumberOfAJobWhateverIsPrintedWithIt) {
  const std::string queued = "echo \"$name|$number|1|PENDING|Priority|\" >> queue\n";
  for (const std::string& answer :
       {std::string("echo $number"), std::string("echo; echo \" $number \"; echo"),
        std::string("echo \"$number;cluster\""),
        std::string("echo 'Welcome! 3 nodes are down.'; echo 7; echo $number"),
        std::string(
            "echo 'sbatch: warning: quota' >&2; echo \"$number;cluster\"; echo 'Good luck'"),
        queued + "echo \"Submitted batch job $number\"", queued + "echo $number; echo 7",
        queued + "echo thanks", queued,
        queued + "echo 'sbatch: error: Socket timed out on send/recv operation' >&2; exit 1"}) {
    slurm_that_works(answer);
    const std::string store = "store " + std::to_string(std::hash<std::string>()(answer));
    for (const char* file : {"jobs", "queue"}) fs::remove(programs_.path() / file);
    const auto first = json({"submit", manifest_, "--json", "--store", store});
    EXPECT_EQ(first.at("job"), "100") << answer;
    EXPECT_EQ(first.at("fold_job"), "101") << answer;
    const std::string name = "shearcell-" + first.at("submission").get<std::string>();
    EXPECT_TRUE(has(words(), "--dependency=afterany:100\n"));
    queue(name + "|100|1|RUNNING|None|n1\n");
    const auto second = json({"submit", manifest_, "--json", "--store", store});
    EXPECT_TRUE(second.at("submission").is_null()) << answer;
    EXPECT_EQ(second.at("left_out"), 2);
    fs::remove(programs_.path() / "words");
  }
}

TEST_F(Submit, EndsWithOneIfNoJobMerges) {
  slurm_that_works("[ $number = 100 ] || exit 1; echo $number");
  expect(1, {"submit", manifest_}, {"are not merged automatically", "Submitted as job 100"});
}

TEST_F(Submit, NeverQueuesTwiceWhatItMayHaveQueued) {
  const std::string hides = "echo \"$name|$number|1|PENDING|Priority|\" >> hidden\n";
  for (const auto& [answer, says] :
       {std::pair(hides + "echo thanks", "printed 'thanks' instead of a job number"),
        {hides + "echo 'sbatch: error: Socket timed out' >&2; exit 1", "Socket timed out"},
        {hides + "exit 0", "printed '' instead of a job number"}}) {
    slurm_that_works(answer);
    program("squeue", "echo 'slurm_load_jobs error: Unable to contact controller' >&2; exit 1\n");
    const std::string store = "store " + std::string(says);
    fs::remove(programs_.path() / "jobs");
    const Outcome first = expect(1, {"submit", manifest_, "--store", store},
                                 {says, "Unable to contact controller", "scancel --name=shearcell-",
                                  "squeue --name=shearcell-"});
    EXPECT_EQ(said("jobs"), "x\n") << "no merge job without a number to wait for";
    // While nobody knows, nothing is queued.
    expect(1, {"submit", manifest_, "--store", store}, {"Unable to contact controller"});
    slurm_that_works(answer);
    fs::rename(programs_.path() / "hidden", programs_.path() / "queue");
    const auto second = json({"submit", manifest_, "--json", "--store", store});
    EXPECT_TRUE(second.at("submission").is_null());
    EXPECT_EQ(second.at("left_out"), 2);
    EXPECT_EQ(said("jobs"), "x\n");
    // The job has ended without its merge job.
    fs::remove(programs_.path() / "queue");
    slurm_that_works();
    for (const auto& task : fs::recursive_directory_iterator(path(store) / "submissions")) {
      if (task.path().filename() == "task-1")
        expect(0, {"resume", "--task", "--store", task.path().string()});
    }
    EXPECT_TRUE(json({"submit", manifest_, "--json", "--store", store}).at("submission").is_null());
    EXPECT_EQ(hashes(store).size(), 3U);
  }
}

TEST_F(Submit, SaysSoIfNoJobIsQueuedThoughSlurmDidNotRefuse) {
  slurm_that_works("echo 'sbatch: Job would start tomorrow'");
  expect(1, {"submit", manifest_},
         {"printed 'sbatch: Job would start tomorrow' instead of a job number",
          "no job of this name is in the queue", "scancel --name="});
  slurm_that_works();
  EXPECT_FALSE(json({"submit", manifest_, "--json"}).at("submission").is_null()) << "and goes on";
}

TEST_F(Submit, CutsLongMessages) {
  const std::string print = "printf '%0300000d' 0";
  for (const auto& [answer, says] :
       {std::pair(print, "000...' instead of a job number"), {print + " >&2; exit 1", "000..."}}) {
    slurm_that_works(answer);
    EXPECT_LT(expect(1, {"submit", manifest_}, {says}).err.size(), 4000U) << answer;
  }
}

TEST_F(Submit, LeavesNothingOfARejectedSubmission) {
  slurm_that_works();
  program(
      "sbatch",
      "[ \"$1\" = --version ] && exit 0\necho 'sbatch: error: invalid partition' >&2; exit 1\n");
  expect(1, {"submit", manifest_, "--partition", "none"},
         {"sbatch failed for job shearcell-", "invalid partition", "The job is not queued"});
  EXPECT_TRUE(fs::is_empty(path("shearcell-store/submissions")));
  EXPECT_EQ(json({"status", "--json"}).at("submissions"), nlohmann::json::array());
  expect(0, {"verify"});
  slurm_that_works();
  EXPECT_FALSE(json({"submit", manifest_, "--json"}).at("submission").is_null()) << "and goes on";
}

TEST_F(Submit, MergesLeftTasksAndSubmitsTheRest) {
  slurm_that_works();
  const auto said = json({"submit", manifest_, "--seeds", "2", "--json"});
  const std::string folder = said.at("folder");
  expect(0, {"resume", "--task", "--store", folder + "/task-1"});
  // The queue is empty: all was cancelled.
  const auto rest = json({"submit", manifest_, "--seeds", "2", "--json"});
  EXPECT_EQ(rest.at("tasks").size(), 1U);
  EXPECT_EQ(rest.at("tasks")[0].at("runs"), said.at("tasks")[1].at("runs"));
  expect(0, {"resume", "--task", "--store", rest.at("folder").get<std::string>() + "/task-1"});
  EXPECT_TRUE(json({"submit", manifest_, "--seeds", "2", "--json"}).at("submission").is_null());
  expect(0, {"run", manifest_, "--seeds", "2", "-q", "--store", "here"});
  EXPECT_EQ(hashes(), hashes("here"));
  expect(0, {"verify"});
}

TEST_F(Submit, TasksRunWhatWasSubmitted) {
  const std::string folder = submitted();
  write("m.yaml", "changed: since\n");
  expect(0, {"resume", "--task", "--store", folder + "/task-1", "-j", "2"});
}

TEST_F(Submit, ATrailingSlashChangesNothing) {
  const std::string folder = submitted();
  fs::create_directory(path("scratch"));
  expect(0, {"resume", "--task", "--store", folder + "/task-1/", "--scratch",
             path("scratch").string()});
  EXPECT_TRUE(fs::exists(folder + "/task-1.progress.json"));
  EXPECT_FALSE(fs::exists(folder + "/task-1/.progress.json"));
}

TEST_F(Submit, WorkStopsAfterAnyNumberOfWarningsAndContinues) {
  const std::string task = submitted({"--cycles", "16"}) + "/task-1";
  const Running worker = start_beside({"resume", "--task", "--store", task, "-j", "2"}, "worker");
  wait_for_objects(4, task);
  for (const int signal : {SIGUSR1, SIGTERM, SIGTERM}) kill(worker.pid, signal);
  EXPECT_EQ(wait_for(worker).code, 85) << "the second signal does not kill";
  const std::size_t recorded = objects(task);
  ASSERT_LT(recorded, 30U);
  expect(0, {"resume", "--task", "--store", task, "-j", "2", "--leave-failed"});
  expect(0, {"run", manifest_, "--cycles", "16", "-q", "--store", "here"});
  EXPECT_EQ(hashes(task), hashes("here"));
}

TEST_F(Submit, WorkOnScratchCopiesEverythingBack) {
  const std::string folder = submitted({"--cycles", "16"});
  const std::string task = folder + "/task-1";
  fs::create_directory(path("scratch"));
  const Arguments words = {"resume", "--task", "--store",   task,
                           "-j",     "2",      "--scratch", path("scratch").string()};
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

TEST_F(Submit, WorkReplacesTheVariablesOfScratch) {
  const std::string task = submitted() + "/task-1";
  fs::create_directory(path("node disk"));
  const Variable disk("NODE_DISK", path("node disk")), relative("RELATIVE", "node disk");
  const auto before = listing();
  expect(2, {"resume", "--task", "--store", task, "--scratch", "$NO_SUCH_VARIABLE/x"},
         {"the variable NO_SUCH_VARIABLE is not set on this node"});
  expect(2, {"resume", "--task", "--store", task, "--scratch", "$RELATIVE"},
         {"not an absolute path"});
  EXPECT_EQ(listing(), before) << "something was written";
  expect(0, {"resume", "--task", "--store", task, "-j", "2", "--scratch",
             "${NODE_DISK}/my $(touch x)"});
  EXPECT_TRUE(fs::is_empty(path("node disk/my $(touch x)"))) << "used, and emptied";
  EXPECT_FALSE(fs::exists(path("x")));
  EXPECT_EQ(hashes(task).size(), 3U);
}

TEST_F(Submit, WorkDoesNotRepeatFailedRuns) {
  // No contact may overlap by this little: each run fails as soon as it is looked at.
  manifest_ = write("f.yaml", tiny_manifest("  max_overlap_diameters: 1.0e-6\n"));
  const std::string task = submitted() + "/task-1";
  expect(3, {"resume", "--task", "--store", task});
  expect(3, {"resume", "--task", "--store", task, "--leave-failed"},
         {"nothing is left to compute"});
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
  expect(0, {"resume", "--task", "--store", task, "-j", "2"});
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
  expect(0, {"resume", "--task", "--store", task});
  expect(0, {"merge", task});
  // There is no gnuplot in this PATH.
  expect(1, {"figures", "S2", "--out", "."}, {"3 checkpoints, 1 of them newly measured"});
}

TEST_F(Submit, WorkNeedsAStore) {
  expect_refused({"resume", "--task", "--store", "nowhere"}, {"nowhere"});
  expect_refused({"resume", "--task", "--store", "nowhere", "--scratch", "x"}, {"nowhere"});
}

}  // namespace
}  // namespace shearcell::test
