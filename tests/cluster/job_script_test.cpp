// SPDX-License-Identifier: GPL-3.0-or-later
// The job scripts, run by bash with stand-ins for the program and for Slurm: signals, exit codes,
// and paths that a shell could misread.
#include <gtest/gtest.h>

#include <fstream>

#include "experiments/cluster/slurm.hpp"
#include "provenance/io/child_process.hpp"
#include "tests/experiments/temporary_store.hpp"
#include "tests/support/text.hpp"

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
          run_program({shell, "-c", "x=" + shell_quoted(text) + "; printf %s \"$x\""}, "/");
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
  EXPECT_EQ(output_pattern("/100%j/%", "task-%a.log"), "/100%%j/%%/task-%a.log");
}

TEST(Values, CannotEndADirective) {
  for (const char* text : {"long", "a,b", "gpu:2", "--mem=4G", "user@host.org", "2-12:00:00"}) {
    EXPECT_EQ(unfit_value(text), "");
  }
  for (const char* text : {"", "a b", "a\n#SBATCH --uid=0", "a'b", "a\"b", "$x", "`x`", "a\\"}) {
    EXPECT_NE(unfit_value(text), "") << text;
  }
}

TEST(TimeLimit, IsReadAsBySlurm) {
  EXPECT_EQ(slurm_seconds("90"), 5400);
  EXPECT_EQ(slurm_seconds("1:30"), 90);
  EXPECT_EQ(slurm_seconds("1:02:03"), 3723);
  EXPECT_EQ(slurm_seconds("2-3"), (2 * 24 + 3) * 3600);
  EXPECT_EQ(slurm_seconds("2-3:04"), (2 * 24 + 3) * 3600 + 240);
  EXPECT_EQ(slurm_seconds("2-3:04:05"), (2 * 24 + 3) * 3600 + 245);
  for (const char* text :
       {"", "-", "1-", "-1", "a", "1h", "1:2:3:4", "1.5", "1:", ":1", "99999999999"}) {
    EXPECT_FALSE(slurm_seconds(text)) << text;
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
    return run_script(task_of(program), restarts);
  }

  std::string task_of(const std::string& program) {
    executable("shearcell", "echo \"shearcell $*\" >> \"$SAID\"\n" + program);
    JobOptions options;
    options.cpus = 6;
    options.threads = 2;
    return array_script(options, places(), 4);
  }

  int run_script(const std::string& text, const std::string& restarts = "") {
    const fs::path script = root_ / "job.sh";
    std::ofstream(script) << text;
    fs::remove(said());
    const char* path = getenv("PATH");
    std::vector<std::string> variables = {"SAID=" + said().string(), "SLURM_ARRAY_JOB_ID=17",
                                          "SLURM_ARRAY_TASK_ID=3", "SLURM_JOB_ID=17",
                                          "PATH=" + (root_ / "bin").string() + ":" + path};
    if (!restarts.empty()) variables.push_back("SLURM_RESTART_COUNT=" + restarts);
    const auto outcome = run_program({"bash", script.string()}, "/", variables);
    messages_ = outcome->output + outcome->messages;
    return outcome->code;
  }

  JobPlaces places() const {
    return {root_ / "bin" / "shearcell", root_ / "store", root_ / "jobs"};
  }
  fs::path said() const { return folder_.path() / "said"; }
  std::string calls() const { return fs::exists(said()) ? read_bytes(said()) : ""; }
  std::string work(const std::string& more = "") const {
    return "shearcell work --store " + (root_ / "jobs" / "task-3").string() +
           " --jobs 3 --threads 2" + more + "\n";
  }

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
    std::string script = task_of("trap 'exit 85' USR1 TERM; while :; do sleep 0.05; done");
    const std::string start = "  program=$!\n";
    ASSERT_NE(script.find(start), script.npos);
    script.insert(script.find(start), "  kill -" + std::string(signal) + " $$\n");
    // Killed, where the program had not come to its own trap.
    EXPECT_GE(run_script(script), 85) << messages_;
    EXPECT_EQ(calls().find("scontrol requeue 17_3\n") != std::string::npos,
              signal == std::string("USR1"))
        << calls();
  }
}

TEST_F(JobScript, RestartsAKilledProgramAFewTimes) {
  EXPECT_EQ(run_task("[ \"$(grep -c work \"$SAID\")\" -ge 3 ] && exit 0; kill -KILL $$"), 0);
  EXPECT_EQ(calls(), work() + work(" --leave-failed") + work(" --leave-failed")) << messages_;
  EXPECT_EQ(run_task("kill -KILL $$"), 137);
  EXPECT_EQ(calls().size(), 4 * work().size() + 3 * std::string(" --leave-failed").size());
}

TEST_F(JobScript, DoesNotRepeatFailedRunsAfterARequeue) {
  EXPECT_EQ(run_task("exit 0", "2"), 0);
  EXPECT_EQ(calls(), work(" --leave-failed"));
}

TEST_F(JobScript, WorksOnScratch) {
  JobOptions options;
  options.cpus = 1;
  options.scratch = (root_ / "scratch").string();
  executable("shearcell", "printf '%s\\n' \"$@\" >> \"$SAID\"\n");
  EXPECT_EQ(run_script(array_script(options, places(), 1)), 0);
  EXPECT_TRUE(has(calls(), "--scratch\n" + options.scratch + "\n"));
}

TEST_F(JobScript, MergesTheOtherTasksIfOneCannotBeMerged) {
  executable("shearcell", "echo \"shearcell $*\" >> \"$SAID\"\n[[ $2 != *task-2 ]] || exit 4\n");
  EXPECT_EQ(run_script(merge_script({}, places(), 3)), 4);
  std::string expected;
  for (const char* task : {"task-1", "task-2", "task-3"}) {
    expected += "shearcell merge " + (root_ / "jobs" / task).string() + " --store " +
                (root_ / "store").string() + "\n";
  }
  EXPECT_EQ(calls(), expected);
}

TEST(Directives, HaveTheRequestedValues) {
  JobOptions options;
  options.partition = "long";
  options.account = "group";
  options.time = "12:00:00";
  options.cpus = 4;
  options.sbatch = {"--qos=low"};
  const std::string script = array_script(options, {"/bin/shearcell", "/s", "/s/x"}, 9);
  for (const char* line :
       {"--partition=long", "--account=group", "--time=12:00:00", "--qos=low", "--array=1-9",
        "--cpus-per-task=4", "--signal=B:USR1@120", "--requeue", "--open-mode=append"}) {
    EXPECT_TRUE(has(script, std::string("\n#SBATCH ") + line + "\n"));
  }
  EXPECT_EQ(script.find("#!/bin/bash\n"), 0U);
}

}  // namespace
}  // namespace shearcell::test
