// SPDX-License-Identifier: GPL-3.0-or-later
// The command line's contract: exit codes, help, messages, and nothing written for bad input.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "tests/experiments/program.hpp"
#include "tests/support/bad_manifests.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

const std::string kDrag =
    (fs::path(SHEARCELL_TEST_DATA) / ".." / ".." / "experiments" / "drag.yaml").string();

class CommandLine : public ProgramTest {};

TEST_F(CommandLine, EverySubcommandHasHelpWithAnExample) {
  expect(0, {"--help"},
         {"Exit codes", "\nCompute:\n  new ", "\nLook:\n  status ", "\nKeep:\n  verify ",
          "\nShare:\n  merge "});
  for (const std::string& command : commands()) {
    EXPECT_EQ(expect(0, {command, "--help"}, {"Example"}).err, "") << command;
  }
  EXPECT_TRUE(expect(0, {"--version"}).out.starts_with("shearcell "));
  EXPECT_TRUE(listing().empty());
}

TEST_F(CommandLine, RejectsUnknownOptions) {
  expect_refused({}, {"\n  shearcell new mine ", "\n  shearcell --help "});
  expect_refused({"shake"}, {"shake"});
  expect_refused({"plam", kDrag}, {"no command plam; did you mean plan?"});
  expect_refused({"plan", kDrag, "--scal"}, {"not expected: --scal", "the nearest is --scale"});
  expect_refused({"run", kDrag, "--mpi", "2"}, {"--mpi", "has no effect"});
  expect_refused({"run"}, {"manifest"});
  expect_refused({"run", kDrag, "--colour"}, {"--colour"});
  for (const char* number : {"-1", "010", "0x10", "1e2", "ten", ""}) {
    expect_refused({"run", kDrag, "--cycles", number}, {"decimal digits"});
  }
  expect_refused({"run", kDrag, "--seeds", "0"}, {"seeds"});
  expect_refused({"run", kDrag, "--jobs", "0"}, {"jobs"});
  expect_refused({"run", kDrag, "--scale", "desc"}, {"the nearest is desk"});
  expect_refused({"run", "nowhere.yaml"}, {"nowhere.yaml"});
  for (const char* command : {"status", "resume", "log", "verify", "figures", "report"}) {
    expect_refused({command}, {"there is no store here"});
  }
}

// The messages are tested with the manifests; here, that the program prints them.
TEST_F(CommandLine, RejectsABadManifestBeforeItWritesAnything) {
  const auto manifests = bad_manifests(SHEARCELL_TEST_DATA);
  for (const char* name : {"several", "terminal_escape", "alias_bomb"}) {
    const auto& [text, message] = manifests.at(name);
    const std::string file = write("bad.yaml", text);
    for (const char* command : {"run", "plan"}) {
      expect_refused({command, file}, {"shearcell: " + message + "\n"});
    }
  }
  expect_refused({"run", "."}, {"is a directory"});
  // One bad manifest among good ones stops all of them.
  write("bad.yaml", manifests.at("negative_mass").text);
  expect_refused({"run", write("good.yaml", tiny_manifest()), "bad.yaml"}, {"is out of range"});
}

TEST_F(CommandLine, UsesTheNamedStoreOrThatOfTheEnvironment) {
  name_store("from-environment");
  expect_refused({"status"}, {"from-environment"});
  const Outcome named = expect(2, {"status", "--store", "named"}, {"named"});
  EXPECT_FALSE(has(named.err, "from-environment"));
}

TEST_F(CommandLine, RejectsAnUnknownFigureOrRun) {
  campaign(tiny_manifest(), {"--cycles", "0"});
  expect_refused({"figures", "S99"}, {"there is no figure S99"});
  const std::string no_scale = "no run of the store has scale paper";
  expect_refused({"figures", "S2", "--scale", "paper"}, {no_scale});
  const std::string said = run({"figures", "--scale", "paper"}).err;
  EXPECT_EQ(said.find(no_scale), said.rfind(no_scale)) << "once for all figures";
  expect_refused({"show", "0123456789abcdef"}, {"no run"});
  expect_refused({"log", "zzz"}, {"no run"});
  expect_refused({"resume", "zzz"}, {"no run"});
}

TEST_F(CommandLine, FindsARunByAUniquePrefix) {
  campaign(tiny_manifest(), {"--cycles", "0", "--seeds", "9"});
  std::vector<std::string> ids;
  for (const auto& [id, hash] : hashes()) ids.push_back(id);  // sorted
  ASSERT_EQ(ids.size(), 18U);  // more than hexadecimal digits, so two have the same first digit
  const auto twin = std::adjacent_find(ids.begin(), ids.end(),
                                       [](const auto& a, const auto& b) { return a[0] == b[0]; });
  ASSERT_NE(twin, ids.end());
  const std::string ambiguous = twin->substr(0, 1);
  for (const char* command : {"show", "log", "resume"}) {
    expect_refused({command, ambiguous}, {"several runs begin with", *twin});
  }
  const std::string prefix = twin->substr(0, 12);
  EXPECT_EQ(json({"show", prefix, "--json"}).at("id"), *twin);
  const nlohmann::json events = json({"log", prefix, "--json"}).at("events");
  EXPECT_GE(events.size(), 4U);
  for (const auto& event : events) EXPECT_EQ(event.at("stream"), "run/" + *twin);
  expect(0, {"resume", prefix, "-q"});
}

TEST_F(CommandLine, PrintsFactsAsJson) {
  const std::string manifest = write("m.yaml", tiny_manifest("", kBothFluids));
  const nlohmann::json done = json({"run", manifest, "--cycles", "1", "--json", "-q"});
  EXPECT_EQ(done.at("completed"), 3);

  const nlohmann::json runs = json({"status", "--json"}).at("runs");
  ASSERT_EQ(runs.size(), 3U);
  for (const auto& record : runs) {
    for (const char* key :
         {"id", "experiment", "variant", "seed", "state", "cycle", "target_cycles", "N",
          "wall_seconds", "particle_steps_per_second", "state_hash", "error"}) {
      EXPECT_TRUE(record.contains(key)) << key;
    }
    EXPECT_EQ(record.at("experiment"), "tiny");
    EXPECT_EQ(record.at("N"), 300);
    EXPECT_EQ(record.at("state_hash").get<std::string>().size(), 64U);
    EXPECT_GT(record.at("particle_steps_per_second"), 1e4);
    EXPECT_EQ(record.at("cycle"), record.at("target_cycles"));

    const nlohmann::json shown = json({"show", record.at("id"), "--json"});
    EXPECT_EQ(shown.at("checkpoints").back().at("state_hash"), record.at("state_hash"));
    const nlohmann::json checkpoint =
        json({"show", shown.at("checkpoints").back().at("sha256"), "--json"});
    EXPECT_EQ(checkpoint.at("grains"), 300);
  }
  EXPECT_GT(json({"log", "--json"}).at("events").size(), 9U);
  const nlohmann::json verified = json({"verify", "--json"});
  EXPECT_TRUE(verified.at("ok"));
  EXPECT_EQ(verified.at("checkpoints"), 5);
  const nlohmann::json plan = json({"plan", manifest, "--cycles", "2", "--json"});
  EXPECT_EQ(plan.at("runs"), 2);
  EXPECT_EQ(plan.at("particle_steps_left"), 2 * 300 * 10000);
  expect(0, {"log"}, {"CheckpointRecorded"});
}

TEST_F(CommandLine, MakesAllFigures) {
  campaign(tiny_manifest("", kBothFluids));
  expect(0, {"figures", "--all", "--out", "all"});
  EXPECT_TRUE(fs::exists(path("all/tiny/base/S2a.csv")) && fs::exists(path("all/base/table1.csv")));
  EXPECT_EQ(json({"show", "S2", "--json"}).at("figure"), "S2");
}

// What `plan` cannot know: the values of a computed figure's claims.
TEST_F(CommandLine, NotesAPrimaryClaimThatNoVerdictHas) {
  const std::string none = "C.critical_size@amplitude_rad=0.9";
  std::string text = tiny_manifest("", "primary: [" + none + "]\n");
  text.replace(text.find("[S2]"), 4, "[C]");
  campaign(text);
  expect(0, {"figures", "C", "--out", "all"}, {"primary: no verdict has the id " + none});
}

TEST_F(CommandLine, PlansTheDragExperimentAtEveryScale) {
  struct Expected {
    const char* scale;
    int runs, stages;
    double particle_steps;  // of the shear
  };
  for (const Expected& expected : {Expected{"smoke", 4, 6, 4.0 * 600 * 5 * 45600},
                                   Expected{"desk", 12, 18, 12.0 * 5200 * 120 * 45600},
                                   Expected{"paper", 20, 30, 20.0 * 5200 * 120 * 45600}}) {
    const nlohmann::json plan = json({"plan", kDrag, "--scale", expected.scale, "--json"});
    EXPECT_EQ(plan.at("runs"), expected.runs);
    EXPECT_EQ(plan.at("stages").size(), static_cast<std::size_t>(expected.stages));
    const double steps = plan.at("particle_steps_left");
    std::printf("%s: %.3g particle-steps, %.0f s, %.3g MB\n", expected.scale, steps,
                plan.at("seconds_left").get<double>(), plan.at("bytes_left").get<double>() * 1e-6);
    EXPECT_GT(steps, expected.particle_steps);
    EXPECT_LT(steps, 1.2 * expected.particle_steps);
    EXPECT_GT(plan.at("seconds_left"), 0);
    EXPECT_GT(plan.at("bytes_left"), 0);
    expect(0, {"plan", kDrag, "--scale", expected.scale},
           {std::to_string(expected.runs) + " runs", "on disk"});
  }
  EXPECT_TRUE(listing().empty()) << "a plan wrote something";
  fs::create_directory(path("shearcell-store"));  // in which `run` would make its store
  EXPECT_EQ(json({"plan", kDrag, "--scale", "smoke", "--json"}).at("runs"), 4);
  EXPECT_TRUE(fs::is_empty(path("shearcell-store")));
}

}  // namespace
}  // namespace shearcell::test
