// SPDX-License-Identifier: GPL-3.0-or-later
// The job scripts, run by bash with stand-ins for the program and for Slurm: signals, exit codes,
// and paths that a shell could misread.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <limits>

#include "experiments/cluster/submission.hpp"
#include "provenance/errors.hpp"
#include "provenance/io/child_process.hpp"
#include "tests/experiments/temporary_store.hpp"
#include "tests/support/text.hpp"
#include "tests/support/variable.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kHostileNames = {"plain",
                                                "with space",
                                                "it's",
                                                "a\"b",
                                                "$HOME",
                                                "`id`",
                                                "$(touch x)",
                                                "a;b",
                                                "100%j",
                                                "-n",
                                                "*",
                                                "!x",
                                                "\xc3\xa9t\xc3\xa9",
                                                "#SBATCH",
                                                "a&b|c>d<e",
                                                "'\"'\"'$\"'",
                                                "{a,b}",
                                                "~"};

TEST(Quoting, GivesTheTextItselfInAShell) {
  for (const std::string& text : kHostileNames) {
    for (const char* shell : {"sh", "bash"}) {
      const auto said =
          run_program({shell, "-c", "x=" + shell_word(text) + "; printf %s \"$x\""}, "/");
      ASSERT_TRUE(said.has_value());
      EXPECT_EQ(said->output, text) << shell;
    }
  }
}

TEST(Paths, ThatSlurmWouldMisreadAreRejected) {
  for (const std::string& text : kHostileNames) EXPECT_EQ(unfit_path("/" + text), "");
  for (const char* text : {"/a\nb", "/a\\b", "/a\tb", "/a\x7f", "/\x1b[31m"}) {
    EXPECT_NE(unfit_path(text), "") << text;
  }
  const Job job = array_job({"0123456789ab", {{}}, "", "", {}}, "/100%j/%", {});
  EXPECT_EQ(
      std::ranges::count(job.command, "--output=/100%%j/%%/submissions/0123456789ab/task-%a.log"),
      1);
}

TEST(Scratch, IsAnAbsolutePathThatMayHaveVariables) {
  for (const char* text :
       {"/scratch", "/", "/my scratch", "/it's", "/a\"b", "/a;b&c", "/~x", "/*", "$TMPDIR",
        "${TMPDIR}", "$SLURM_TMPDIR/x", "${A_1}/$B/${C}d", "/scratch/$USER/${SLURM_JOB_ID}"}) {
    EXPECT_EQ(unfit_scratch(text), "");
  }
  for (const char* text : {"",
                           "scratch",
                           "./x",
                           "~",
                           "~/x",
                           "~me",
                           "$(rm -rf /)",
                           "`id`",
                           "/tmp/`id`",
                           "/tmp/$(id)",
                           "$((1+1))",
                           "$[1]",
                           "$",
                           "/a$",
                           "/$/b",
                           "$1",
                           "$$",
                           "/$?",
                           "$@",
                           "${}",
                           "${1}",
                           "${A",
                           "$A$",
                           "${TMPDIR:-/tmp}",
                           "${A:-$(id)}",
                           "${A[0]}",
                           "'$TMPDIR'",
                           "\"$TMPDIR\"",
                           " $TMPDIR",
                           "\\$TMPDIR",
                           "$TMPDIR\n#SBATCH",
                           "$TMPDIR`id`"}) {
    EXPECT_NE(unfit_scratch(text), "") << text;
  }
}

// A regular expression of the standard library recurses for each character.
TEST(LongTexts, AreRefusedAndOverflowNoStack) {
  const std::string a(100'000, 'a'), ones(100'000, '1');
  for (const std::string& text : {"/" + a, "$" + a, "${" + a + "}", "/$" + a + "/x", a}) {
    EXPECT_TRUE(has(unfit_scratch(text), " bytes")) << text.size();
    EXPECT_THROW(scratch_here(text), UsageError);
  }
  EXPECT_EQ(unfit_scratch("/" + a.substr(0, 900)), "");
  for (const std::string& text :
       {ones, ones + "-1", "1-" + ones, "1:" + ones, ones + ":1:1", a, ones.substr(0, 1000)}) {
    EXPECT_EQ(slurm_seconds(text), std::numeric_limits<double>::infinity());
  }
}

TEST(Scratch, HasTheValuesOfVariablesHereAndRunsNothing) {
  const Variable disk("NODE_DISK", "/node's \"disk\" $(touch x)`id`/$HOME"), user("ME", "me");
  const std::string value = "/node's \"disk\" $(touch x)`id`/$HOME";
  const auto here = [](const char* text) { return scratch_here(text).string(); };
  EXPECT_EQ(here("/a b/'c'"), "/a b/'c'");
  EXPECT_EQ(here("$NODE_DISK"), value);
  EXPECT_EQ(here("${NODE_DISK}/x y"), value + "/x y");
  EXPECT_EQ(here("/tmp/$ME/${ME}2"), "/tmp/me/me2");
  const Variable empty("EMPTY", "");
  for (const char* text : {"$NODE_DISK_2/x", "/tmp/${NO_SUCH_VARIABLE}", "$EMPTY", "/a/$EMPTY/b"}) {
    expect_refused<UsageError>([&] { scratch_here(text); }, {text, "is not set on this node"});
  }
  expect_refused<UsageError>([&] { scratch_here("$ME/x"); }, {"'me/x' is not an absolute path"});
}

TEST(TimeLimit, IsReadAsBySlurm) {
  EXPECT_EQ(slurm_seconds("90"), 5400);
  EXPECT_EQ(slurm_seconds("1:30"), 90);
  EXPECT_EQ(slurm_seconds("1:02:03"), 3723);
  EXPECT_EQ(slurm_seconds("2-3"), (2 * 24 + 3) * 3600);
  EXPECT_EQ(slurm_seconds("2-3:04"), (2 * 24 + 3) * 3600 + 240);
  EXPECT_EQ(slurm_seconds("2-3:04:05"), (2 * 24 + 3) * 3600 + 245);
  for (const char* text : {"0", "0:00", "UNLIMITED", "infinite", "", "-", "1-", "-1", "a", "1h",
                           "1:2:3:4", "1.5", "1:", ":1"}) {
    EXPECT_EQ(slurm_seconds(text), std::numeric_limits<double>::infinity()) << text;
  }
}

/// A job's script in a folder with a hostile name. `shearcell` is what the script runs instead of
/// the program; it and `scontrol` note their words in `said`, one call a line.
class JobScript : public testing::Test {
 protected:
  JobScript() : root_(folder_.path() / "it's \"100%j\" $HOME;x") {
    fs::create_directories(root_ / "bin");
    executable("scontrol", "echo \"scontrol $*\" >> \"$SAID\"\n");
  }

  void executable(const std::string& name, const std::string& body) {
    write_script(root_ / "bin" / name, "#!/bin/bash\n" + body);
  }

  /// Runs an array task whose program does this; returns its exit code.
  int run_task(const std::string& program, const std::string& restarts = "") {
    return run_job(task_of(program), restarts);
  }

  Job task_of(const std::string& program) {
    executable("shearcell", "echo \"shearcell $*\" >> \"$SAID\"\n" + program);
    JobOptions options;
    options.cpus = 6;
    options.threads = 2;
    return array_job(submission_, root_ / "store", options);
  }

  /// Runs the script as Slurm does, with another program in place of shearcell.
  int run_job(const Job& job, const std::string& restarts = "") {
    const fs::path script = root_ / job.file;
    std::ofstream(script) << job.script;
    fs::remove(said());
    const char* path = getenv("PATH");
    std::vector<std::string> variables = {"SAID=" + said().string(), "SLURM_ARRAY_JOB_ID=17",
                                          "SLURM_ARRAY_TASK_ID=3", "SLURM_JOB_ID=17",
                                          "PATH=" + (root_ / "bin").string() + ":" + path};
    if (!restarts.empty()) variables.push_back("SLURM_RESTART_COUNT=" + restarts);
    const auto file = std::ranges::find(job.command, job.file);
    std::vector<std::string> words = {"bash", script, root_ / "bin" / "shearcell"};
    words.insert(words.end(), file + 2, job.command.end());
    const auto outcome = run_program(words, "/", variables);
    messages_ = outcome->output + outcome->messages;
    return outcome->code;
  }

  std::string store_of_task(std::size_t task) const {
    return submission_.task_store(root_ / "store", task).string();
  }
  fs::path said() const { return folder_.path() / "said"; }
  std::string calls() const { return fs::exists(said()) ? read_bytes(said()) : ""; }
  std::string work(const std::string& more = "") const {
    return "shearcell resume --task --store " + store_of_task(3) + " --jobs 3 --threads 2" + more +
           "\n";
  }

  Submission submission_{"0123456789ab", {{}, {}, {}, {}}, "", "", {}};
  TemporaryFolder folder_;
  fs::path root_;
  std::string messages_;
};

TEST_F(JobScript, EndsWithTheProgramsCode) {
  for (const int code : {0, 1, 2, 3, 4, 85}) {
    EXPECT_EQ(run_task("exit " + std::to_string(code)), code) << messages_;
    EXPECT_EQ(calls(), work()) << "begun once, and not queued again";
  }
}

TEST_F(JobScript, RequeuesItsTaskOnlyAfterATimeoutWithWorkLeft) {
  const std::string wait = "while :; do sleep 0.05; done";
  struct Case {
    std::string program;
    int code;
    std::string after;  // calls after the first
  };
  for (const Case& c :
       {Case{"trap 'exit 85' USR1; kill -USR1 $PPID; ", 85, "scontrol requeue 17_3\n"},
        Case{"trap 'exit 0' USR1; kill -USR1 $PPID; ", 0, ""},
        Case{"trap 'exit 85' TERM; kill -TERM $PPID; ", 85, ""},  // cancelled
        Case{"trap 'sleep 0.5; echo saved >> \"$SAID\"; exit 85' USR1; kill -USR1 $PPID; ", 85,
             "saved\nscontrol requeue 17_3\n"}}) {  // it waits for the program to end
    EXPECT_EQ(run_task(c.program + wait), c.code) << c.program;
    EXPECT_EQ(calls(), work() + c.after) << messages_;
  }
}

TEST_F(JobScript, ForwardsASignalWhileTheProgramStarts) {
  for (const char* signal : {"USR1", "TERM"}) {
    Job job = task_of("trap 'exit 85' USR1 TERM; while :; do sleep 0.05; done");
    const std::string start = "  program=$!\n";
    ASSERT_NE(job.script.find(start), std::string::npos);
    job.script.insert(job.script.find(start), "  kill -" + std::string(signal) + " $$\n");
    // Killed, where the program had not come to its own trap.
    EXPECT_GE(run_job(job), 85) << messages_;
    EXPECT_EQ(calls().find("scontrol requeue 17_3\n") != std::string::npos,
              signal == std::string("USR1"))
        << calls();
  }
}

TEST_F(JobScript, RestartsAKilledProgramAFewTimes) {
  EXPECT_EQ(run_task("[ \"$(grep -c resume \"$SAID\")\" -ge 3 ] && exit 0; kill -KILL $$"), 0);
  EXPECT_EQ(calls(), work() + work(" --leave-failed") + work(" --leave-failed")) << messages_;
  EXPECT_EQ(run_task("kill -KILL $$"), 137);
  EXPECT_EQ(calls().size(), 4 * work().size() + 3 * std::string(" --leave-failed").size());
}

TEST_F(JobScript, DoesNotRepeatFailedRunsAfterARequeue) {
  EXPECT_EQ(run_task("exit 0", "2"), 0);
  EXPECT_EQ(calls(), work(" --leave-failed"));
}

// The program on the node replaces its variables; no shell reads it.
TEST_F(JobScript, GivesTheProgramScratchAsItIs) {
  executable("shearcell", "printf '%s\\n' \"$@\" >> \"$SAID\"\n");
  for (const std::string& text : kHostileNames) {
    JobOptions options;
    options.cpus = 1;
    options.scratch = "/" + text;
    EXPECT_EQ(run_job(array_job(submission_, root_ / "store", options)), 0);
    EXPECT_TRUE(has(calls(), "--scratch=" + options.scratch + "\n"));
  }
}

TEST_F(JobScript, MergesTheOtherTasksIfOneCannotBeMerged) {
  executable("shearcell", "echo \"shearcell $*\" >> \"$SAID\"\n[[ $2 != *task-2 ]] || exit 4\n");
  EXPECT_EQ(run_job(merge_job(submission_, root_ / "store", {}, "17")), 4);
  std::string expected;
  for (const std::size_t task : {1U, 2U, 3U, 4U}) {
    expected +=
        "shearcell merge " + store_of_task(task) + " --store " + (root_ / "store").string() + "\n";
  }
  EXPECT_EQ(calls(), expected);
}

// A word on the command line overrides the variable of sbatch, and of two equal words the last one
// counts.
TEST_F(JobScript, IsQueuedWithWordsThatNothingOverrides) {
  JobOptions options;
  options.cpus = 4;
  options.sbatch = {"--qos=low",    "--no-requeue",       "--open-mode=truncate",
                    "--nodes=2",    "--ntasks=3",         "--cpus-per-task=9",
                    "--job-name=z", "--output=/dev/null", "--signal=KILL@10",
                    "--export=NONE"};
  const Job array = array_job(submission_, "/s", options);
  const Job merging = merge_job(submission_, "/s", options, "17");
  const std::string folder = "/s/submissions/0123456789ab";
  const std::vector<std::string> both = {"--nodes=1", "--ntasks=1", "--requeue",
                                         "--open-mode=append"};
  const auto expect_last = [](const Job& job, const std::vector<std::string>& words) {
    const auto file = std::ranges::find(job.command, job.file);
    for (const std::string& word : words) {
      const auto own = std::find(job.command.begin(), file, word);
      EXPECT_NE(own, file) << word;
      const std::string name = word.substr(0, word.find('='));
      for (auto later = own; later != file; ++later) {
        EXPECT_TRUE(later == own || !later->starts_with(name)) << *later << " after " << word;
        EXPECT_FALSE(own->starts_with("--requeue") && *later == "--no-requeue");
      }
    }
  };
  expect_last(array, both);
  expect_last(merging, both);
  expect_last(array, {"--array=1-4", "--cpus-per-task=4", "--signal=B:USR1@120",
                      "--job-name=shearcell-0123456789ab", "--output=" + folder + "/task-%a.log",
                      "--qos=low"});
  expect_last(merging, {"--dependency=afterany:17", "--job-name=shearcell-0123456789ab-fold",
                        "--output=" + folder + "/fold.log", "--qos=low"});
  // The user's --export counts, and otherwise not that of the environment.
  const auto exported = std::ranges::find(array.command, "--export=ALL");
  EXPECT_NE(std::find(exported, array.command.end(), "--export=NONE"), array.command.end());
  EXPECT_FALSE(has(array.script + merging.script, "#SBATCH"));
}

}  // namespace
}  // namespace shearcell::test
