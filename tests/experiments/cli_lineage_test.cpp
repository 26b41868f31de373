// SPDX-License-Identifier: GPL-3.0-or-later
// The lineage that the program prints for published figures, and the crates that it exports.
#include <gtest/gtest.h>

#include "tests/experiments/program.hpp"

namespace shearcell::test {
namespace {

class CommandLineLineage : public ProgramTest {
 protected:
  void SetUp() override {
    campaign(tiny_manifest("", kBothFluids), {"--cycles", "1"});
    expect(0, {"figures", "S2", "--out", "out"});
  }
};

TEST_F(CommandLineLineage, ShowsAFigureUncutInAPipe) {
  // The manifest's 2 cycles were overridden.
  const Outcome shown = expect(0, {"show", "tiny/S2", "--checkpoints"},
                               {"m.yaml", "experiment: tiny", "  cycles: 2",
                                "given at the command line: cycles 1 (manifest: 2)",
                                "0:1:1: 2 checkpoints, whose states match the figure's record"});
  const Outcome brief = expect(0, {"show", "tiny/S2"}, {"experiment: tiny"});
  EXPECT_FALSE(has(shown.out, "..."));
  const nlohmann::json all = json({"show", "tiny/S2", "--json"});
  EXPECT_EQ(all.at("inputs").size(), 2U);
  for (const auto& input : all.at("inputs")) {
    EXPECT_TRUE(has(shown.out, input.at("run").get<std::string>()));
    EXPECT_TRUE(has(brief.out, input.at("run").get<std::string>()));
    EXPECT_TRUE(has(brief.out, input.at("state_hash").get<std::string>()));
    EXPECT_EQ(input.at("checkpoints").size(), 2U);
    for (const auto& c : input.at("checkpoints")) {
      EXPECT_TRUE(has(shown.out, c.at("sha256").get<std::string>()));
      EXPECT_FALSE(has(brief.out, c.at("sha256").get<std::string>()));
    }
  }
  const nlohmann::json overrides = {{"cycles", {{"run", 1}, {"manifest", 2}}}};
  const nlohmann::json lineage =
      nlohmann::json::parse(read_bytes(path("out/tiny/base/S2.lineage.json")));
  for (std::size_t i = 0; i < 2; ++i) {
    const nlohmann::json& input = all.at("inputs").at(i);
    EXPECT_EQ(input.at("overrides"), overrides);
    EXPECT_EQ(lineage.at("inputs").at(i).at("overrides"), overrides);
    const nlohmann::json run = json({"show", input.at("run"), "--json"});
    EXPECT_EQ(run.at("memberships").at(0).at("overrides"), overrides);
  }
  for (const char* fact : {"commit", "flags"}) {
    EXPECT_TRUE(has(shown.out, all.at("made").at("build").at(fact).get<std::string>()));
  }
}

// As a store from elsewhere may hold them.
TEST_F(CommandLineLineage, EscapesNamesFromTheLog) {
  const std::string name = "S2\x1b[2J\u202e";
  {
    Store store(path("shearcell-store"), Access::write);
    nlohmann::json facts = store.figures().at(0).provenance;
    facts["outputs"] = {{"S2a\x1b[2J.csv", "\u202e"}};
    facts["inputs"].clear();
    facts["analysis_version"] = "\x1b]0;1\x07";
    store.record("figure/" + name, {"FigureGenerated", facts});
  }
  const Outcome shown = expect(0, {"show", name}, {"S2\\x1b[2J\\u202e"});
  EXPECT_EQ(shown.out.find_first_of("\x1b\x07"), std::string::npos) << shown.out;
  EXPECT_FALSE(has(shown.out, "\u202e"));
}

// A record from elsewhere may name states that the log does not have; its checkpoints are intact.
TEST_F(CommandLineLineage, CountsCheckpointsApartFromRuns) {
  for (const auto& [file, cycles, counts] :
       {std::tuple("four.csv", "[[0,1,1]]", "4 checkpoints: 4 present and unchanged"),
        {"none.csv", "[[77,77,1]]", "0 checkpoints: 0 present and unchanged"}}) {
    std::filesystem::copy(path("out/tiny/base/S2a.csv"), path(file));
    {
      Store store(path("shearcell-store"), Access::write);
      nlohmann::json facts = store.figures().back().provenance;
      facts["outputs"] = {{file, facts.at("outputs").at("S2a.csv")}};
      for (nlohmann::json& input : facts.at("inputs")) {
        input["cycles"] = nlohmann::json::parse(cycles);
        input["states_sha256"] = std::string(64, '0');
      }
      store.record("figure/other", {"FigureGenerated", facts});
    }
    expect(4, {"show", file}, {counts, "the checkpoint states in the log differ"});
  }
}

TEST_F(CommandLineLineage, ChecksAPublishedFile) {
  expect(0, {"show", "out/tiny/base/S2a.csv"},
         {"matches", "4 checkpoints, all present and unchanged"});
  const nlohmann::json all = json({"show", "out/tiny/base/S2a.csv", "--json"});
  EXPECT_EQ(all.at("check").at("verdict"), "matches");
  const std::string input = all.at("inputs").at(0).at("checkpoints").at(0).at("file");
  std::filesystem::remove(path("shearcell-store/" + input));
  expect(4, {"show", "out/tiny/base/S2a.csv"}, {"3 present and unchanged, 1 missing or changed"});

  write("out/tiny/base/S2b.csv", read_bytes(path("out/tiny/base/S2b.csv")) + "x");
  expect(4, {"show", "out/tiny/base/S2b.csv"}, {"CHANGED"});

  write("other.csv", "a,b\n");
  expect_refused({"show", "other.csv"}, {"this store has no record of the file"});
  expect_refused({"show", "missing.csv"}, {});
}

// An early record lacks parameters that later programs name, and states constants.
TEST_F(CommandLineLineage, ACrateHasTheParametersThatShowHas) {
  const std::string store = path("early").string(), id = "a61190aacbad";
  std::filesystem::copy(std::string(SHEARCELL_TEST_DATA) + "/store_v1", store,
                        std::filesystem::copy_options::recursive);
  expect(0, {"export", id, "--to", "ro-crate", "--out", "old", "--store", store});
  const nlohmann::json shown = json({"show", id, "--store", store, "--json"});
  std::map<std::string, nlohmann::json> stated;
  const auto crate = nlohmann::json::parse(read_bytes(path("old/ro-crate-metadata.json")));
  for (const nlohmann::json& entity : crate.at("@graph")) {
    if (entity.at("@id").get<std::string>().starts_with("#parameter-" + id)) {
      stated[entity.at("name")] = entity.at("value");
    }
  }
  const nlohmann::json &parameters = shown.at("parameters"), &record = shown.at("resolved");
  for (const auto& [name, value] : parameters.items()) EXPECT_EQ(stated[name], value) << name;
  std::size_t constants = 0;
  for (const auto& [name, value] : record.at("parameters").items()) {
    if (parameters.contains(name)) continue;
    EXPECT_FALSE(stated.contains(name)) << name;
    ++constants;
  }
  EXPECT_GT(constants, 0U);
}

TEST_F(CommandLineLineage, ExportsACrateAndOverwritesNothing) {
  const std::string id = last_run();
  expect(0, {"export", id.substr(0, 12), "--to", "ro-crate", "--out", "a/crate"});
  EXPECT_TRUE(std::filesystem::exists(path("a/crate/ro-crate-metadata.json")));
  const nlohmann::json again =
      json({"export", id, "--to", "ro-crate", "--out", "a/crate/", "--json", "--license",
            "https://creativecommons.org/licenses/by/4.0/"});
  EXPECT_EQ(again.at("files").size(), 3U + 2U)
      << "a packing and two states; the manifest and the metadata";
  EXPECT_TRUE(has(read_bytes(path("a/crate/ro-crate-metadata.json")),
                  "creativecommons.org/licenses/by/4.0/"));

  for (const std::string out : {"a", "m.yaml", "shearcell-store", "."}) {
    expect_refused({"export", id, "--to", "ro-crate", "--out", out}, {out});
  }
  expect_refused({"export", id, "--to", "zip", "--out", "b"}, {});
  expect_refused({"export", id, "--to", "ro-crate", "--out", "b", "--license", "MIT"}, {"MIT"});
  expect_refused({"export", "xyz", "--to", "ro-crate", "--out", "b"}, {"xyz"});

  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(path("shearcell-store/objects"))) {
    if (entry.is_regular_file()) std::filesystem::resize_file(entry, 100);
  }
  expect(4, {"export", id, "--to", "ro-crate", "--out", "a/damaged"}, {"objects/"});
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(path("a")), {}), 1) << "the crate";
}

TEST_F(CommandLineLineage, WritesAReportAndChangesNothingElse) {
  const nlohmann::json log = json({"log", "--json"});
  std::set<std::string> before = listing();
  const nlohmann::json facts = json({"report", "--out", "out/report.html", "--json"});
  EXPECT_EQ(facts.at("experiments"), 1);
  EXPECT_EQ(facts.at("figures"), 2);  // S2, and Table I of all experiments
  EXPECT_EQ(facts.at("bytes"), std::filesystem::file_size(path("out/report.html")));
  before.insert("out/report.html");
  EXPECT_EQ(listing(), before);
  EXPECT_EQ(json({"log", "--json"}), log);
  expect(0, {"log"}, {" figure/tiny/base/S2 "});
  EXPECT_TRUE(has(read_bytes(path("out/report.html")), "as recorded"));

  const std::string first = read_bytes(path("out/report.html"));
  expect(0, {"report", "--out", "out/report.html"});
  EXPECT_EQ(read_bytes(path("out/report.html")), first);

  expect(2, {"report", "--run", "nothing"});
  expect(1, {"report", "--out", "out/report.html/below.html"});

  const std::string file = newest_file(last_run());
  std::filesystem::remove(path("shearcell-store/derived.sqlite"));
  truncate_file(path(file));
  expect(4, {"report", "--out", "out/report.html"}, {"left out: "});
}

TEST_F(CommandLineLineage, AReportEndsWithTheCodeOfTheFiguresThatItLeavesOut) {
  std::string averaged = renamed(tiny_manifest("  cycles: 1\n", kBothFluids), "averaged");
  averaged.replace(averaged.find("[S2]"), 4, "[S7]");
  expect(0, {"run", write("averaged.yaml", averaged), "-q"});
  expect(2, {"figures", "--out", "out"}, {"S7"});
  expect(2, {"report", "--out", "out/report.html"}, {"figure averaged/S7: "});
  EXPECT_EQ(
      json({"report", "--experiment", "tiny", "--out", "out/tiny.html", "--json"})["problems"],
      nlohmann::json::array());
}

}  // namespace
}  // namespace shearcell::test
