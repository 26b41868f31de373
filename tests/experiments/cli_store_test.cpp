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

TEST_F(CommandLineStore, RefusesAPlainFile) {
  write("shearcell-store", "not a store\n");
  const std::string manifest = write("m.yaml", tiny_manifest());
  for (const Arguments& words :
       {Arguments{"run", manifest}, Arguments{"status"}, Arguments{"plan", manifest},
        Arguments{"resume"}, Arguments{"verify"}, Arguments{"figures"}}) {
    expect_damage(words, "shearcell-store");
  }
  EXPECT_EQ(read_bytes(path("shearcell-store")), "not a store\n");
}

TEST_F(CommandLineStore, RefusesANewerSchema) {
  const std::string manifest = write("m.yaml", tiny_manifest());
  ASSERT_EQ(run({"run", manifest, "--cycles", "0", "-q"}).code, 0);
  {
    // SQLite's user_version is the big-endian number at byte 60 of the file.
    std::fstream file(path("shearcell-store/store.sqlite"),
                      std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(60);
    file.write("\x00\x00\x03\xe7", 4);
    ASSERT_TRUE(file.good());
  }
  const std::string before = read_bytes(path("shearcell-store/store.sqlite"));
  for (const Arguments& words : {Arguments{"status"}, Arguments{"run", manifest},
                                 Arguments{"resume"}, Arguments{"verify"}}) {
    expect_damage(words, "999");
  }
  EXPECT_EQ(read_bytes(path("shearcell-store/store.sqlite")), before);
}

TEST_F(CommandLineStore, RefusesALogThatIsNoDatabase) {
  fs::create_directory(path("shearcell-store"));
  write("shearcell-store/store.sqlite", std::string(8192, 'x'));
  expect_damage({"status"}, "store.sqlite");
  expect_damage({"run", write("m.yaml", tiny_manifest())}, "store.sqlite");
}

TEST_F(CommandLineStore, NamesATruncatedCheckpointAndGoesOnWithTheOthers) {
  const std::string manifest = write("m.yaml", tiny_manifest());
  ASSERT_EQ(run({"run", manifest, "--cycles", "1", "--seeds", "2", "-q"}).code, 0);
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

TEST_F(CommandLineStore, VerifyAndFiguresNameADamagedFile) {
  const std::string manifest = write("m.yaml", tiny_manifest("", kBothFluids));
  ASSERT_EQ(run({"run", manifest, "--cycles", "1", "-q"}).code, 0);
  const nlohmann::json status = json({"status", "--json"});
  const std::string file = newest_file(status.at("runs").back().at("id"));
  std::string bytes = read_bytes(path(file));
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write(file, bytes);
  const std::string name = fs::path(file).filename();
  const Outcome verified = run({"verify"});
  EXPECT_EQ(verified.code, 4);
  EXPECT_TRUE(contains(verified.out, name)) << verified.out;
  expect_damage({"figures", "S2"}, name);
  EXPECT_TRUE(fs::exists(path("shearcell-figures/S2a.csv")));
}

TEST_F(CommandLineStore, SaysWhyARunFailed) {
  const std::string manifest =
      write("m.yaml", tiny_manifest("", "sweep: {grid: {max_overlap_diameters: [0.1, 0.02]}}\n"));
  const Outcome outcome = run({"run", manifest, "--cycles", "1", "-q"});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_TRUE(contains(outcome.err, "over its limit of 0.02")) << outcome.err;
  const Outcome status = run({"status"});
  EXPECT_TRUE(contains(status.out, "over its limit of 0.02")) << status.out;
  EXPECT_TRUE(contains(status.out, "completed"));
}

// Long enough that a signal finds it at work: about a second.
const std::string kCycles = "20";

class Signals : public CommandLineStore {
 protected:
  void expect_no_trace(int signal) {
    const std::string manifest = write("m.yaml", tiny_manifest());
    ASSERT_EQ(run({"run", manifest, "--cycles", kCycles, "-q", "--store", "whole"}).code, 0);
    const Outcome stopped = run_until({"run", manifest, "--cycles", kCycles, "-q"}, 4, signal);
    if (signal == SIGKILL) {
      EXPECT_EQ(stopped.signal, SIGKILL);
    } else {
      EXPECT_EQ(stopped.code, 85) << stopped.err;
      EXPECT_TRUE(contains(stopped.err, "shearcell resume --store")) << stopped.err;
    }
    const nlohmann::json runs = json({"status", "--json"}).at("runs");
    const nlohmann::json& sheared = runs.back();
    std::printf("stopped at cycle %g of %s\n", sheared.at("cycle").get<double>(), kCycles.c_str());
    EXPECT_EQ(sheared.at("state"), signal == SIGKILL ? "running" : "interrupted");
    EXPECT_LT(sheared.at("cycle"), 20);
    EXPECT_GE(sheared.at("cycle"), 1);
    EXPECT_EQ(run({"verify"}).code, 0);

    EXPECT_EQ(run({"resume", "-q"}).code, 0);
    EXPECT_EQ(hashes(), hashes("whole"));
    EXPECT_EQ(run({"verify"}).code, 0);
  }
};

TEST_F(Signals, AnInterruptLeavesNoTrace) {
  expect_no_trace(SIGINT);
}

TEST_F(Signals, ATerminationLeavesNoTrace) {
  expect_no_trace(SIGTERM);
}

TEST_F(Signals, AKillLeavesNoTrace) {
  expect_no_trace(SIGKILL);
}

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
