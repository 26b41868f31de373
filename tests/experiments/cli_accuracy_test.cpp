// SPDX-License-Identifier: GPL-3.0-or-later
// `bench accuracy` as a user runs it, and what `plan` prints about time steps.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "tests/experiments/program.hpp"

namespace shearcell::test {
namespace {

class BenchAccuracy : public ProgramTest {};

TEST_F(BenchAccuracy, PrintsJsonAndWritesTablesAndFigures) {
  const nlohmann::json all = json({"bench", "accuracy", "--quick", "--json", "--out", "made/here"});
  EXPECT_EQ(all.at("quick"), true);
  std::set<std::string> names;
  for (const nlohmann::json& section : all.at("sections")) {
    const std::string name = section.at("name");
    names.insert(name);
    EXPECT_FALSE(section.at("rows").empty()) << name;
    EXPECT_TRUE(std::filesystem::exists(path("made/here/" + name + ".csv"))) << name;
    EXPECT_TRUE(std::filesystem::exists(path("made/here/" + name + ".svg"))) << name;
  }
  EXPECT_EQ(names, (std::set<std::string>{"accuracy-collision-speed", "accuracy-stiffness",
                                          "accuracy-wall"}));
}

TEST_F(BenchAccuracy, SaysWhatIsWrongBeforeItMeasures) {
  const Outcome none = run({"bench", "accuracy", "--quick", "--jobs", "0"});
  EXPECT_EQ(none.code, 2);
  EXPECT_NE(none.err.find("--jobs"), std::string::npos) << none.err;
  write("file", "");
  const Outcome in_the_way = run({"bench", "accuracy", "--quick", "--out", "file/figures"});
  EXPECT_NE(in_the_way.code, 0);
  EXPECT_NE(in_the_way.err.find("file/figures"), std::string::npos) << in_the_way.err;
  EXPECT_EQ(in_the_way.out, "");
}

TEST_F(BenchAccuracy, PlanPrintsTimeStepsAndWarns) {
  const std::string head = "experiment: a\nbase: {grains: 600, cycles: 1, ";
  const std::string sound = write("sound.yaml", head + "steps_per_cycle: 45600}\n");
  const Outcome words = run({"plan", sound});
  EXPECT_NE(words.out.find("0.355"), std::string::npos) << words.out;
  EXPECT_NE(words.out.find("expected overlap"), std::string::npos) << words.out;
  EXPECT_EQ(words.err, "");
  const nlohmann::json stage = json({"plan", sound, "--json"}).at("stages").at(1);
  EXPECT_NEAR(stage.at("time_step").at("over_contact_time"), 0.1129, 1e-4);
  EXPECT_NEAR(stage.at("expected_overlap_d"), 3.797e-3, 1e-5);
  const std::string small = write("small.yaml", head + "steps_per_cycle: 200000}\n");
  const std::string large = write("large.yaml", head + "steps_per_cycle: 20000}\n");
  const std::string stiffened =
      write("stiffen.yaml", "experiment: a\nbase: {grains: 600, protocol: stiffen}\n");
  EXPECT_NE(run({"plan", small}).err.find("below 0.15"), std::string::npos);
  EXPECT_NE(run({"plan", large}).err.find("above 0.7"), std::string::npos);
  EXPECT_EQ(json({"plan", stiffened, "--json"}).at("stages").at(1).at("time_step"), nullptr);
}

}  // namespace
}  // namespace shearcell::test
