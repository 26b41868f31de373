// SPDX-License-Identifier: GPL-3.0-or-later
// Closed or full standard streams, signals that are ignored or arrive at a bad time, programs that
// hang, programs that write to the same places, and unusual texts on the command line.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstring>

#include "tests/experiments/program.hpp"
#include "tests/support/variable.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

const std::string kFails = tiny_manifest("  settle_time_limit_s: 0.1\n");

class Streams : public ProgramTest {
 protected:
  void SetUp() override {
    campaign(tiny_manifest("  grains: 200\n", kBothFluids), {"--cycles", "1"});
    write("fails.yaml", kFails);
    write("bad.yaml", "experiment: bad\nbase: {grains: many}\n");
  }

  /// A hung up terminal as descriptor 9, which programs inherit: each write fails with EIO.
  static void open_hung_up_terminal() {
    const int master = posix_openpt(O_RDWR | O_NOCTTY);
    ASSERT_TRUE(master >= 0 && grantpt(master) == 0 && unlockpt(master) == 0);
    const int slave = open(ptsname(master), O_RDWR | O_NOCTTY);
    ASSERT_TRUE(slave >= 0 && dup2(slave, 9) == 9);
    close(master);
    if (slave != 9) close(slave);
  }
};

TEST_F(Streams, ExitCodesAreTheSameWithoutStandardError) {
  struct Case {
    const char* words;
    int code;
  };
  for (const auto& [words, code] :
       {Case{"status", 0}, Case{"status --json", 0}, Case{"plan m.yaml", 0}, Case{"plan none", 2},
        Case{"plan bad.yaml", 2}, Case{"frobnicate", 2}, Case{"status --frobnicate", 2},
        Case{"figures S99", 2}, Case{"show nothing", 2}, Case{"verify", 0},
        Case{"run fails.yaml --store new", 3}, Case{"run m.yaml --cycles 1 --store new", 0},
        Case{"run m.yaml --cycles 0 --store new -q", 0}, Case{"status --store m.yaml", 2},
        Case{"figures S2 --out out", 0}, Case{"resume", 0}, Case{"new m", 2},
        Case{"report --out m.yaml", 2}, Case{"export none --to vtk --out v", 2}}) {
    for (const char* closed : {"2>&-", "2>/dev/full"}) {
      const Outcome outcome =
          shell("exec \"$0\" " + std::string(words) + " " + closed + " >/dev/null");
      EXPECT_EQ(outcome.code, code) << words << closed << ", signal " << outcome.signal;
      fs::remove_all(path("new"));
    }
  }
}

TEST_F(Streams, LostOutputIsAnError) {
  for (const char* words :
       {"status", "status --json", "plan m.yaml", "plan m.yaml --json", "verify", "verify --json",
        "figures S2 --json --out out", "run m.yaml --cycles 1 --json -q",
        "run m.yaml --cycles 1 -q", "--help", "run --help", "--version", "manual", "log",
        "show RUN", "doctor --no-speed", "new other", "report --out r.html",
        "export RUN --to vtk --out v --json"}) {
    std::string command = "exec \"$0\" " + std::string(words);
    if (const auto at = command.find("RUN"); at != command.npos) {
      command.replace(at, 3, last_run());
    }
    for (const char* streams : {" >/dev/full", " >&-", " >/dev/full 2>/dev/full"}) {
      const Outcome lost = shell(command + streams);
      EXPECT_EQ(lost.code, 1) << words << streams << lost.err << ", signal " << lost.signal;
      const bool heard = !has(streams, "2>");
      EXPECT_EQ(bool(has(lost.err, "standard output")), heard) << words << ": " << lost.err;
      for (const char* file : {"other.yaml", "v"}) fs::remove_all(path(file));
    }
  }
  EXPECT_EQ(shell("exec \"$0\" run fails.yaml -q --json --store new >/dev/full").code, 3)
      << "what was found out counts more";
}

TEST_F(Streams, ACampaignContinuesWithoutItsTerminalAndReaders) {
  const std::string whole = "\"$0\" run m.yaml --store ";
  open_hung_up_terminal();
  EXPECT_EQ(shell("trap '' HUP; exec " + whole + "a --cycles 1 2>&9").code, 0);
  close(9);
  const Outcome piped =
      shell("mkfifo p; grep -qm1 started <p & exec " + whole + "b --cycles 1 2>p");
  EXPECT_EQ(piped.code, 0) << "signal " << piped.signal;
  EXPECT_EQ(hashes("a"), hashes());
  EXPECT_EQ(hashes("b"), hashes());
  EXPECT_EQ(shell("exec \"$0\" verify --store a <&- 2>&-").code, 0);
}

TEST_F(Streams, SignalsIgnoredByTheCallerAreIgnored) {
  for (const int ignored : {SIGCHLD, SIGPIPE, SIGHUP}) {
    fs::remove_all(path("out"));
    const auto before = std::signal(ignored, SIG_IGN);  // the program inherits it
    const Running program = start_beside({"figures", "S2", "--out", "out"}, "ignoring");
    std::signal(ignored, before);
    const Outcome outcome = wait_for(program);
    EXPECT_EQ(outcome.code, 0) << strsignal(ignored) << outcome.err;
    EXPECT_TRUE(listing().contains("out/tiny/base/S2a.svg")) << strsignal(ignored);
  }
}

TEST_F(Streams, TwoProgramsCanDrawIntoOneFolder) {
  for (int round = 0; round < 3; ++round) {
    const Running first = start_beside({"figures", "S2", "--out", "out"}, "first");
    const Running second = start_beside({"figures", "S2", "--out", "out"}, "second");
    for (const Running& each : {first, second}) {
      const Outcome outcome = wait_for(each);
      EXPECT_EQ(outcome.code, 0) << outcome.err;
      EXPECT_EQ(outcome.err, "");
    }
  }
  expect(0, {"figures", "S2", "--out", "alone"});
  std::size_t files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(path("out"))) {
    if (entry.is_directory()) continue;
    const fs::path name = entry.path().lexically_relative(path("out"));
    EXPECT_EQ(read_bytes(entry.path()), read_bytes(path("alone") / name)) << name;
    ++files;
  }
  EXPECT_GE(files, 8U);
  expect(0, {"verify"});
}

class Signals : public ProgramTest {
 protected:
  /// Seconds from the signal to the end.
  double stop(const Running& program, int signal, Outcome& outcome) {
    const auto begun = std::chrono::steady_clock::now();
    kill(program.pid, signal);
    outcome = wait_for(program);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  }
};

TEST_F(Signals, StopTheFillingOfACell) {
  write("m.yaml", tiny_manifest("  grains: 3000000\n"));
  std::signal(SIGHUP, SIG_DFL);  // programs inherit it if it is ignored here
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) {
    const Running program = start_beside({"run", "m.yaml"}, "run");
    wait_for_words(program, "started");
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    Outcome outcome;
    const double seconds = stop(program, signal, outcome);
    EXPECT_EQ(outcome.code, 85) << outcome.signal << outcome.err;
    EXPECT_LT(seconds, 10) << signal;
  }
  EXPECT_EQ(objects(), 0U);
  expect(0, {"verify"});
}

TEST_F(Signals, EndAHangingLammps) {
  const std::string answers =
      "#!/bin/sh\ncase \"$*\" in *-h*) printf '%s\\n' "
      "'Large-scale Massively Parallel Simulator - 1 Jan 2020' gran/hooke;; "
      "*) exec sleep 600;; esac\n";
  for (const std::string& script : {answers, std::string("#!/bin/sh\nexec sleep 600\n")}) {
    const bool begins = script == answers;
    fs::remove_all(path("shearcell-store"));
    write("m.yaml", tiny_manifest("  grains: 200\n"));
    write_script(path("lmp"), script);
    expect(0, {"run", "m.yaml", "--cycles", "0"});
    const Variable lammps("SHEARCELL_LAMMPS", path("lmp"));
    const Running program = start_beside({"run", "m.yaml", "--engine", "lammps"}, "run");
    if (begins) wait_for_words(program, ": started");
    std::this_thread::sleep_for(std::chrono::seconds(1));
    Outcome outcome;
    EXPECT_LT(stop(program, SIGTERM, outcome), 20);
    if (begins) {
      EXPECT_EQ(outcome.code, 85) << outcome.err;
      expect(0, {"verify"});
    } else {
      EXPECT_EQ(outcome.signal, SIGTERM) << "nothing was begun";
    }
  }
}

/// Two programs, a kill of one, and a resume give the states of undisturbed runs.
TEST_F(Signals, AKillOfOneOfTwoProgramsKeepsTheEndByUntil) {
  const std::string text = tiny_manifest(
      "  cycles: 8\n", kBothFluids + "seeds: 2\nuntil: {phi: 0.3, extra_cycles: 3}\n");
  write("m.yaml", text);
  expect(0, {"run", "m.yaml", "-q", "--store", "whole"});
  const Running first = start_beside({"run", "m.yaml", "-q", "-j", "1"}, "first");
  const Running second = start_beside({"run", "m.yaml", "-q", "-j", "1"}, "second");
  wait_for_objects(9);
  kill(first.pid, SIGKILL);
  wait_for(first);
  kill(second.pid, SIGTERM);
  wait_for(second);
  expect(0, {"resume", "-q"});
  EXPECT_EQ(hashes(), hashes("whole"));
  expect(0, {"verify"});
}

class Messages : public ProgramTest {};

TEST_F(Messages, NumbersOfOptionsAreDecimal) {
  for (const char* words :
       {"bench speed --size 010", "bench speed --size 0x10", "bench speed --threads 0x2",
        "bench speed --threads 02", "bench speed --repeats 07", "bench speed --repeats 1e1",
        "bench speed --seconds 0x1", "bench speed --seconds nan", "report --frames 010",
        "report --runs-per-experiment 0x1", "report --packings-mb 0x9", "report --packings-mb -1",
        "run m.yaml --cycles 010", "run m.yaml --seeds 0x2", "run m.yaml -j 01", "run m.yaml -t +2",
        "resume -j 0x1", "prune --keep-every 010", "verify --replay 0x1"}) {
    expect_refused(split(words), {"decimal digits"});
  }
}

TEST_F(Messages, BidirectionalCharactersAreEscaped) {
  const std::string turns[] = {"\u202e", "\u2066", "\u2069", "\u200e",
                               "\u200f", "\u061c", "\u202a", "\u2028"};
  std::string all;
  for (const std::string& turn : turns) all += turn;
  write("m.yaml", "experiment: a" + all + "b\nbase: {gra" + all + "ins: 1, fluid: st" + all +
                      "ill}\nscales: {de" + all + "sk: {}}\n");
  for (const std::string& file : {"no" + all + "ne.yaml", std::string("m.yaml")}) {
    for (const Arguments& words :
         {Arguments{"plan", file}, Arguments{"run", file}, Arguments{"status", "--store", file},
          Arguments{"new", "a" + all}, Arguments{"report", "--out", file + all},
          Arguments{"plan", "m.yaml", "--scale", all}, Arguments{"show", all},
          Arguments{"merge", file}}) {
      const Outcome outcome = run(words);
      for (const std::string& turn : turns) {
        EXPECT_FALSE(has(outcome.out + outcome.err, turn)) << words[0];
      }
    }
  }
  expect(2, {"plan", "m.yaml"}, {"\\u"});
}

TEST_F(Messages, HelpNamesExportedCyclesAndExitCodes) {
  campaign(tiny_manifest("  grains: 200\n", kBothFluids), {"--cycles", "1"});
  const std::string id = last_run();
  for (const char* cycles : {"1e999", "0:1e999", "nan", "inf", "0x1", "1:2:3:4", "-1", "1 "}) {
    expect_refused({"export", id, "--to", "vtk", "--out", "v", "--cycles", cycles},
                   {"--cycles needs A, A:B"});
  }
  for (const char* words : {"--help", "manual"}) expect(0, {words}, {"1 the machine failed"});
}

}  // namespace
}  // namespace shearcell::test
