// SPDX-License-Identifier: GPL-3.0-or-later
// Each scale of an experiment has its own folder of figures.
#include <gtest/gtest.h>

#include "tests/experiments/program.hpp"

namespace shearcell::test {
namespace {

class Scales : public ProgramTest {
 protected:
  const std::string scales_ =
      kBothFluids +
      "plots: [{name: own, y: phi, x: cycle}]\n"
      "scales: {small: {cycles: 1}, large: {cycles: 1, seeds: 2}, 2nd_-Large: {cycles: 2}}\n";
  const Arguments names_ = {"small", "large", "2nd_-Large"};

  /// The bytes of all files of figures, by path.
  std::map<std::string, std::string> drawn() const {
    std::map<std::string, std::string> files;
    for (const std::string& file : listing()) {
      if (file.starts_with("out/") && std::filesystem::is_regular_file(path(file))) {
        files[file] = read_bytes(path(file));
      }
    }
    return files;
  }
};

TEST_F(Scales, NeverOverwriteEachOther) {
  const std::string manifest = write("m.yaml", tiny_manifest("", scales_));
  std::map<std::string, std::string> before;
  for (const std::string& scale : names_) {
    expect(0, {"run", manifest, "--scale", scale, "-q"});
    expect(0, {"figures", "--scale", scale, "--out", "out"});
    const std::map<std::string, std::string> now = drawn();
    for (const auto& [file, bytes] : before) EXPECT_EQ(now.at(file), bytes) << file;
    for (const std::string name : {"S2a.csv", "S2b.svg", "S2.lineage.json", "own.csv"}) {
      EXPECT_TRUE(now.contains("out/tiny/" + scale + "/" + name)) << scale << " " << name;
    }
    EXPECT_TRUE(now.contains("out/" + scale + "/table1.csv")) << "of all experiments";
    before = now;
  }
  for (const std::string& scale : names_) {
    const std::string record = "tiny/" + scale + "/S2", file = "out/tiny/" + scale + "/S2a.csv";
    EXPECT_EQ(json({"show", record, "--json"}).at("scale"), scale);
    expect(0, {"show", file}, {"matches", record, "all present and unchanged"});
    expect(0, {"show", scale + "/table1"}, {"figure       " + scale + "/table1,"});
  }
  expect(2, {"show", "S2"},
         {"several figures", "tiny/2nd_-Large/S2, tiny/large/S2, tiny/small/S2"});
  expect(2, {"show", "tiny/S2"}, {"several figures"});
  expect(0, {"figures", "--out", "out"}, {"at scale large: "});  // of the run added last
  EXPECT_EQ(drawn(), before);
  EXPECT_EQ(json({"table", "--json"}).at("rows").at(0).at("scale"), "2nd_-Large");
}

TEST_F(Scales, AReportNamesTheScalesThatItsFiguresDoNotShow) {
  const std::string manifest = write("m.yaml", tiny_manifest("", scales_));
  for (const char* scale : {"small", "large"}) {
    expect(0, {"run", manifest, "--scale", scale, "-q"});
  }
  expect(0, {"report", "--drawings", "--out", "all.html"},
         {"the figures show scale large; choose another with --scale: small"});
  const Outcome of_one =
      expect(0, {"report", "--drawings", "--scale", "large", "--out", "one.html"});
  EXPECT_FALSE(has(of_one.out + of_one.err, "choose another"));
  EXPECT_TRUE(has(read_bytes(path("one.html")), "(large scale)"));
}

TEST_F(Scales, WithoutScalesTheFolderIsBase) {
  campaign(tiny_manifest("", kBothFluids), {"--cycles", "1"});
  expect(0, {"figures", "--out", "out"}, {"out/tiny/base/S2a.csv", "tiny/S2: 2 runs"});
  EXPECT_EQ(json({"figures", "S2", "--json"}).at("figures").at(0).at("scale"), "base");
  EXPECT_EQ(json({"status", "--json"}).at("runs").at(0).at("scale"), "base");
  EXPECT_TRUE(std::filesystem::exists(path("out/base/table1.csv")));
  EXPECT_EQ(json({"show", "tiny/base/S2", "--json"}), json({"show", "S2", "--json"}));
  expect(0, {"status", "--scale", "base"});
}

TEST_F(Scales, FiguresLeaveOutExperimentsWithoutTheScale) {
  std::string other = tiny_manifest("", kBothFluids);
  other.replace(other.find("tiny"), 4, "other");
  expect(0, {"run", write("m.yaml", tiny_manifest("", scales_)), "--scale", "small", "-q"});
  expect(0, {"run", write("other.yaml", other), "--cycles", "1", "-q"});
  expect(0, {"figures", "--scale", "small", "--out", "out"},
         {"out/tiny/small/S2a.csv", "left out: experiments without a selected run: other"});
  expect(2, {"figures", "--scale", "small", "--scale", "large"}, {"--scale"});
  expect(2, {"figures", "--experiment", "other", "--scale", "small"}, {"other/S2"});
}

// An older version recorded "tiny/S2" for every scale.
TEST_F(Scales, ShowFindsRecordsOfAnOlderVersion) {
  campaign(tiny_manifest("", kBothFluids), {"--cycles", "1"});
  expect(0, {"figures", "S2", "--out", "out"});
  {
    Store store(path("shearcell-store"), Access::write);
    store.record("figure/tiny/S2", {"FigureGenerated", store.figures().at(0).provenance});
  }
  const auto event = [&](const std::string& name) {
    return json({"show", name, "--json"}).at("event").get<std::uint64_t>();
  };
  const std::uint64_t old = event("tiny/S2");
  for (const char* name : {"S2", "tiny/base/S2"}) EXPECT_EQ(event(name), old) << "the newest";
  {
    Store store(path("shearcell-store"), Access::write);
    store.record("figure/tiny/base/S2", {"FigureGenerated", store.figures().at(0).provenance});
  }
  for (const char* name : {"S2", "tiny/S2", "tiny/base/S2"}) EXPECT_GT(event(name), old) << name;
  expect(0, {"show", "out/tiny/base/S2a.csv"}, {"matches"});
}

}  // namespace
}  // namespace shearcell::test
