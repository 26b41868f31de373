// SPDX-License-Identifier: GPL-3.0-or-later
// The lineage that the program prints for published figures, and the crates that it exports.
#include <gtest/gtest.h>

#include <cstdio>
#include <sstream>

#include "tests/experiments/program.hpp"

namespace shearcell::test {
namespace {

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

class CommandLineLineage : public ProgramTest {
 protected:
  void SetUp() override {
    campaign(tiny_manifest("", kBothFluids), {"--cycles", "1"});
    ASSERT_EQ(run({"figures", "S2", "--out", "out"}).code, 0);
  }
};

TEST_F(CommandLineLineage, ShowsAFigureWithoutCuttingItInAPipe) {
  const Outcome shown = run({"show", "tiny/S2"});
  ASSERT_EQ(shown.code, 0) << shown.err;
  EXPECT_FALSE(contains(shown.out, "...")) << shown.out;
  const nlohmann::json all = json({"show", "tiny/S2", "--json"});
  EXPECT_EQ(all.at("inputs").size(), 2U);
  for (const auto& input : all.at("inputs")) {
    EXPECT_TRUE(contains(shown.out, input.at("run")));
    for (const auto& c : input.at("checkpoints")) EXPECT_TRUE(contains(shown.out, c.at("sha256")));
  }
  EXPECT_TRUE(contains(shown.out, "m.yaml"));
  EXPECT_TRUE(contains(shown.out, "experiment: tiny"));
  // The manifest's 2 cycles were overridden.
  EXPECT_TRUE(contains(shown.out, "given at the command line: cycles 1 (manifest: 2)"))
      << shown.out;
  EXPECT_TRUE(contains(shown.out, "  cycles: 2")) << shown.out;
  const nlohmann::json overrides = {{"cycles", {{"run", 1}, {"manifest", 2}}}};
  const nlohmann::json lineage =
      nlohmann::json::parse(read_bytes(path("out/tiny/S2.lineage.json")));
  for (std::size_t i = 0; i < 2; ++i) {
    const nlohmann::json& input = all.at("inputs").at(i);
    EXPECT_EQ(input.at("overrides"), overrides);
    EXPECT_EQ(lineage.at("inputs").at(i).at("overrides"), overrides);
    const nlohmann::json run = json({"show", input.at("run"), "--json"});
    EXPECT_EQ(run.at("memberships").at(0).at("overrides"), overrides);
  }
  for (const char* fact : {"commit", "flags"}) {
    EXPECT_TRUE(contains(shown.out, all.at("made").at("build").at(fact))) << fact;
  }
}

// As a store from elsewhere may hold them.
TEST_F(CommandLineLineage, ShowsNamesOfTheLogEscaped) {
  const std::string name = "S2\x1b[2J\u202e";
  {
    Store store(path("shearcell-store"), Access::write);
    nlohmann::json facts = store.figures().at(0).provenance;
    facts["outputs"] = {{"S2a\x1b[2J.csv", "\u202e"}};
    facts["inputs"].clear();
    facts["analysis_version"] = "\x1b]0;1\x07";
    store.record_figure(name, facts);
  }
  const Outcome shown = run({"show", name});
  ASSERT_EQ(shown.code, 0) << shown.err;
  EXPECT_EQ(shown.out.find_first_of("\x1b\x07"), std::string::npos) << shown.out;
  EXPECT_FALSE(contains(shown.out, "\u202e")) << shown.out;
  EXPECT_TRUE(contains(shown.out, "S2\\x1b[2J\\u202e")) << shown.out;
}

TEST_F(CommandLineLineage, JudgesAPublishedFile) {
  const Outcome sound = run({"show", "out/tiny/S2a.csv"});
  EXPECT_EQ(sound.code, 0) << sound.err;
  EXPECT_TRUE(contains(sound.out, "matches")) << sound.out;
  EXPECT_TRUE(contains(sound.out, "4 checkpoints, all present and right")) << sound.out;

  const nlohmann::json all = json({"show", "out/tiny/S2a.csv", "--json"});
  EXPECT_EQ(all.at("check").at("verdict"), "matches");
  const std::string input = all.at("inputs").at(0).at("checkpoints").at(0).at("file");
  std::filesystem::remove(path("shearcell-store/" + input));
  const Outcome missing = run({"show", "out/tiny/S2a.csv"});
  EXPECT_EQ(missing.code, 4);
  EXPECT_TRUE(contains(missing.out, "1 of them")) << missing.out;
  EXPECT_TRUE(contains(missing.out, "missing")) << missing.out;

  write("out/tiny/S2b.csv", read_bytes(path("out/tiny/S2b.csv")) + "x");
  const Outcome changed = run({"show", "out/tiny/S2b.csv"});
  EXPECT_EQ(changed.code, 4);
  EXPECT_TRUE(contains(changed.out, "CHANGED")) << changed.out;

  write("other.csv", "a,b\n");
  const Outcome unknown = run({"show", "other.csv"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_TRUE(contains(unknown.err, "unknown to this store")) << unknown.err;
  EXPECT_EQ(run({"show", "missing.csv"}).code, 2);
}

TEST_F(CommandLineLineage, ExportsACrateAndOverwritesNothing) {
  const nlohmann::json status = json({"status", "--json"});
  const std::string id = status.at("runs").back().at("id");
  const Outcome exported =
      run({"export", id.substr(0, 12), "--to", "ro-crate", "--out", "a/crate"});
  EXPECT_EQ(exported.code, 0) << exported.err;
  EXPECT_TRUE(std::filesystem::exists(path("a/crate/ro-crate-metadata.json")));
  EXPECT_TRUE(std::filesystem::exists(path("a/crate/prov.json")));
  const nlohmann::json again =
      json({"export", id, "--to", "ro-crate", "--out", "a/crate/", "--json", "--license",
            "https://creativecommons.org/licenses/by/4.0/"});
  EXPECT_EQ(again.at("files").size(), 3U + 3U) << "a packing and two states; three that describe";
  EXPECT_TRUE(contains(read_bytes(path("a/crate/ro-crate-metadata.json")),
                       "creativecommons.org/licenses/by/4.0/"));

  const auto before = listing();
  for (const std::string out : {"a", "m.yaml", "shearcell-store", "."}) {
    const Outcome refused = run({"export", id, "--to", "ro-crate", "--out", out});
    EXPECT_EQ(refused.code, 2) << out;
    EXPECT_TRUE(contains(refused.err, out)) << refused.err;
  }
  EXPECT_EQ(run({"export", id, "--to", "zip", "--out", "b"}).code, 2);
  EXPECT_EQ(run({"export", id, "--to", "ro-crate", "--out", "b", "--license", "MIT"}).code, 2);
  EXPECT_EQ(run({"export", "xyz", "--to", "ro-crate", "--out", "b"}).code, 2);
  EXPECT_EQ(listing(), before);
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
  EXPECT_TRUE(contains(read_bytes(path("out/report.html")), "as recorded"));

  const std::string first = read_bytes(path("out/report.html"));
  ASSERT_EQ(run({"report", "--out", "out/report.html"}).code, 0);
  EXPECT_EQ(read_bytes(path("out/report.html")), first);

  EXPECT_EQ(run({"report", "--run", "nothing"}).code, 2);
  EXPECT_EQ(run({"report", "--accuracy", "nowhere"}).code, 2);
  EXPECT_EQ(run({"report", "--out", "no/such/folder.html"}).code, 1);

  const std::string file = newest_file(json({"status", "--json"})["runs"].back()["id"]);
  std::filesystem::remove(path("shearcell-store/derived.sqlite"));
  truncate_file(path(file));
  const Outcome damaged = run({"report", "--out", "out/report.html"});
  EXPECT_EQ(damaged.code, 4) << damaged.err;
  EXPECT_TRUE(contains(damaged.err, "left out: ")) << damaged.err;
}

}  // namespace
}  // namespace shearcell::test
