// SPDX-License-Identifier: GPL-3.0-or-later
// What the program makes of signals and of stores that are not what they should be.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdio>

#include "tests/experiments/program.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

const std::string kDrag =
    (fs::path(SHEARCELL_TEST_DATA) / ".." / ".." / "experiments" / "drag.yaml").string();

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

class CommandLineStore : public ProgramTest {
 protected:
  void expect_damage(const Arguments& arguments, const std::string& says) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 4) << arguments[0];
    EXPECT_TRUE(contains(outcome.err, says)) << outcome.err;
  }
};

TEST_F(CommandLineStore, NamesATruncatedCheckpointAndGoesOnWithTheOthers) {
  const std::string manifest = "m.yaml";
  campaign(tiny_manifest(), {"--cycles", "1", "--seeds", "2"});
  const auto expected = hashes();
  std::string victim;
  const nlohmann::json status = json({"status", "--json"});
  for (const auto& record : status.at("runs")) {
    if (record.at("kind") == "shear" && record.at("seed") == 1) victim = record.at("id");
  }
  const std::string file = newest_file(victim);
  truncate_file(path(file));
  expect_damage({"run", manifest, "--cycles", "1", "--seeds", "3", "-q"},
                fs::path(file).filename());

  const auto after = hashes();  // all are completed
  EXPECT_EQ(after.size(), expected.size() + 2);
  for (const auto& [id, hash] : expected) EXPECT_EQ(after.at(id), hash);
  EXPECT_EQ(run({"run", manifest, "--cycles", "1", "--seeds", "3", "-q"}).code, 0);
  EXPECT_EQ(run({"verify"}).code, 0);
}

TEST_F(CommandLineStore, SaysWhyARunFailed) {
  const std::string manifest =
      write("m.yaml", tiny_manifest("", "sweep: {grid: {settle_time_limit_s: [60, 0.1]}}\n"));
  const Outcome outcome = run({"run", manifest, "--cycles", "1", "-q"});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_TRUE(contains(outcome.err, "over its limit of 0.1")) << outcome.err;
  const Outcome status = run({"status"});
  EXPECT_TRUE(contains(status.out, "over its limit of 0.1")) << status.out;
  EXPECT_TRUE(contains(status.out, "completed"));
}

// Long enough that a signal finds it at work: about a second.
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
    EXPECT_TRUE(contains(stopped.err, "shearcell resume --store")) << stopped.err;
  }
  const nlohmann::json sheared = json({"status", "--json"}).at("runs").back();
  EXPECT_EQ(sheared.at("state"), killed ? "running" : "interrupted");
  EXPECT_LT(sheared.at("cycle"), 20);
  EXPECT_GE(sheared.at("cycle"), 1);
  EXPECT_EQ(run({"resume", "-q"}).code, 0);
  EXPECT_EQ(hashes(), hashes("whole"));
  EXPECT_EQ(run({"verify"}).code, 0);
}

INSTANTIATE_TEST_SUITE_P(Of, Signals, testing::Values(SIGINT, SIGTERM, SIGKILL));

// One cycle of the smoke scale: what it takes on disk, against what the plan says.
TEST_F(CommandLineStore, DragTakesTheDiskThatItsPlanSays) {
  const nlohmann::json plan = json({"plan", kDrag, "--scale", "smoke", "--cycles", "1", "--json"});
  ASSERT_EQ(run({"run", kDrag, "--scale", "smoke", "--cycles", "1", "-q"}).code, 0);
  double bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(path("shearcell-store/objects"))) {
    if (entry.is_regular_file()) bytes += static_cast<double>(entry.file_size());
  }
  const double expected = plan.at("bytes_left");
  std::printf("checkpoints: %.4g MB, expected %.4g MB\n", bytes * 1e-6, expected * 1e-6);
  EXPECT_NEAR(expected / bytes, 1, 0.3);
}

}  // namespace
}  // namespace shearcell::test
