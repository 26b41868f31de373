// SPDX-License-Identifier: GPL-3.0-or-later
// The lineage of a published figure names every checkpoint, run, manifest line, seed, build and
// host.
#include "experiments/figures/lineage.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "experiments/runner/host.hpp"
#include "provenance/errors.hpp"
#include "tests/experiments/drawing.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

const std::string kText = tiny_manifest("", kBothFluids + "seeds: [4, 9]\n");

std::string line_of(const std::string& text, int line) {
  std::istringstream in(text);
  std::string found;
  for (int l = 0; l < line; ++l) std::getline(in, found);
  return found;
}

class FigureLineageTest : public DrawingTest {
 protected:
  void SetUp() override {
    compute(store_, kText, {.cycles = 1});
    draw("out");
  }
  std::filesystem::path file(const std::string& name) const { return folder_.path() / name; }
};

TEST_F(FigureLineageTest, NamesEveryCheckpointAndItsOrigin) {
  const FigureLineage lineage = figure_lineage(store_, figure_records(store_).at(0));
  ASSERT_EQ(lineage.inputs.size(), 4U);
  EXPECT_EQ(lineage.record.provenance.at("made"), host_facts());
  ASSERT_EQ(lineage.manifests.size(), 1U);
  EXPECT_EQ(lineage.manifests[0].text, kText);
  EXPECT_EQ(lineage.runs.size(), 6U) << "four sheared, two packings";
  for (const FigureInput& input : lineage.inputs) {
    EXPECT_TRUE(input.seed == 4 || input.seed == 9);
    EXPECT_EQ(input.checkpoints.size(), 2U);
    const RunLineage& run = lineage.runs.at(input.run);
    for (const std::string& sha256 : input.checkpoints) {
      const CheckpointHistory* checkpoint = run.find(sha256);
      ASSERT_NE(checkpoint, nullptr);
      EXPECT_EQ(run.attempts.at(checkpoint->attempt.value()).host, host_facts());
    }
    const Attempt& first = run.attempts.at(0);
    EXPECT_NE(lineage.runs.at(first.from_run).find(first.from_checkpoint), nullptr);
    for (const ManifestLine& line : input.lines) {
      EXPECT_TRUE(has(line_of(kText, line.line), line.text)) << line.key;
    }
    ASSERT_EQ(input.lines.size(), 4U);
    EXPECT_EQ(input.lines[0].key, "experiment");
    EXPECT_EQ(input.lines[1].key, "sweep.grid.fluid");
    EXPECT_EQ(input.lines[2].text, "cycles: 2") << "given at the command line";
    EXPECT_EQ(input.lines[3].text, "seeds: [4, 9]");
  }
  EXPECT_TRUE(check_inputs(store_, lineage).empty());
  const nlohmann::json all = to_json(lineage);
  EXPECT_EQ(all.at("inputs").at(0).at("checkpoints").at(0).at("attempt"), 1);
  EXPECT_EQ(all.at("outputs").size(), lineage.outputs.size());
}

// Continuous shear has no pauses, so both variants are one run; the name of one begins the other's.
TEST_F(FigureLineageTest, NamesTheLineOfItsOwnVariant) {
  compute(store_, renamed(tiny_manifest("",
                                        "sweep:\n  grid:\n    pause_s:\n      - 0.1\n"
                                        "      - 0.15\n"),
                          "pauses"));
  draw("out", {*find_figure("S2"), "pauses"});
  const auto records = figure_records(store_);
  std::map<std::string, std::string> lines;
  for (const FigureInput& input : figure_lineage(store_, records.back()).inputs) {
    for (const ManifestLine& line : input.lines) {
      if (line.key == "sweep.grid.pause_s") lines[input.variant] = line.text;
    }
  }
  EXPECT_EQ(lines, (std::map<std::string, std::string>{{"pause_s=0.1", "- 0.1"},
                                                       {"pause_s=0.15", "- 0.15"}}));
}

TEST_F(FigureLineageTest, FindsTheRecordOfAFile) {
  const std::string old = read_bytes(file("out/tiny/base/S2a.csv"));
  const std::string old_lineage = read_bytes(file("out/tiny/base/S2.lineage.json"));
  for (const char* name :
       {"out/tiny/base/S2a.csv", "out/tiny/base/S2b.csv", "out/tiny/base/S2.lineage.json"}) {
    const auto found = find_published(store_, file(name));
    ASSERT_TRUE(found.has_value()) << name;
    EXPECT_TRUE(found->matches()) << name;
  }
  // A longer figure takes its place; the old file, renamed, still finds the old record.
  compute(store_, kText);
  draw("out");
  std::ofstream(file("published.csv"), std::ios::binary) << old;
  ASSERT_EQ(figure_records(store_).size(), 2U);
  const auto found = find_published(store_, file("published.csv"));
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->record.seq, figure_records(store_).at(0).seq);
  EXPECT_EQ(find_published(store_, file("out/tiny/base/S2a.csv"))->record.seq,
            figure_records(store_).at(1).seq);

  // Changed, its name fits both records: the lineage beside it decides.
  const std::filesystem::path beside = file("out/tiny/base/S2.lineage.json");
  std::ofstream(file("out/tiny/base/S2a.csv"), std::ios::app) << "\n";
  std::ofstream(beside, std::ios::binary) << old_lineage;
  EXPECT_EQ(find_published(store_, file("out/tiny/base/S2a.csv"))->record.seq,
            figure_records(store_).at(0).seq);
  std::filesystem::remove(beside);
  EXPECT_EQ(find_published(store_, file("out/tiny/base/S2a.csv"))->record.seq,
            figure_records(store_).at(1).seq);
}

TEST_F(FigureLineageTest, DistinguishesChangedFromUnknownFiles) {
  const std::string bytes = read_bytes(file("out/tiny/base/S2a.csv"));
  for (const std::size_t at : {std::size_t{0}, bytes.size() / 2, bytes.size() - 1}) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 1);
    std::ofstream(file("out/tiny/base/S2a.csv"), std::ios::binary) << changed;
    const auto found = find_published(store_, file("out/tiny/base/S2a.csv"));
    ASSERT_TRUE(found.has_value());
    EXPECT_FALSE(found->matches());
    EXPECT_EQ(found->recorded,
              found->record.provenance.at("outputs").at("S2a.csv").get<std::string>());
  }
  std::ofstream(file("else.csv")) << "a,b\n1,2\n";
  EXPECT_FALSE(find_published(store_, file("else.csv")).has_value());
  EXPECT_THROW(find_published(store_, file("missing.csv")), NotFound);
  EXPECT_THROW(find_published(store_, folder_.path()), NotFound);
}

TEST_F(FigureLineageTest, MissingAndDamagedInputsAreNamed) {
  const FigureLineage lineage = figure_lineage(store_, figure_records(store_).at(0));
  const auto path = [&](std::size_t i) {
    return store_.folder() / ObjectStore::file_of(lineage.inputs.at(i).checkpoints.at(0));
  };
  std::filesystem::remove(path(0));
  truncate_file(path(3));
  const std::vector<Finding> faults = check_inputs(store_, lineage);
  ASSERT_EQ(faults.size(), 2U);
  for (const Finding& fault : faults) std::printf("%s\n", fault.message.c_str());
  EXPECT_EQ(faults[0].subject, lineage.inputs[0].checkpoints[0]);
  EXPECT_TRUE(has(faults[0].message, "missing"));
  EXPECT_EQ(faults[1].subject, lineage.inputs[3].checkpoints[0]);
}

// As earlier versions recorded them: the SHA-256 of every file in place of the states.
TEST_F(FigureLineageTest, ReadsARecordOfFiles) {
  const FigureLineage now = figure_lineage(store_, figure_records(store_).at(0));
  nlohmann::json old = now.record.provenance;
  for (std::size_t i = 0; i < now.inputs.size(); ++i) {
    nlohmann::json& input = old.at("inputs").at(i);
    for (const char* key : {"cycles", "state_hash", "states_sha256"}) input.erase(key);
    input["checkpoints"] = now.inputs[i].checkpoints;
  }
  store_.record("figure/S2", {"FigureGenerated", old});
  const FigureLineage lineage = figure_lineage(store_, figure_records(store_).back());
  ASSERT_EQ(lineage.inputs.size(), now.inputs.size());
  for (std::size_t i = 0; i < now.inputs.size(); ++i) {
    EXPECT_EQ(lineage.inputs[i].states, now.inputs[i].states);
    EXPECT_EQ(lineage.inputs[i].checkpoints, now.inputs[i].checkpoints);
    EXPECT_EQ(lineage.inputs[i].fault, "");
  }
  EXPECT_TRUE(check_inputs(store_, lineage).empty());
  old["inputs"][0]["checkpoints"][1] = std::string(64, 'a');
  store_.record("figure/S2", {"FigureGenerated", old});
  const auto faults = check_inputs(store_, figure_lineage(store_, figure_records(store_).back()));
  ASSERT_EQ(faults.size(), 2U);
  EXPECT_EQ(faults[0].run, now.inputs[0].run);
  EXPECT_EQ(faults[1].subject, std::string(64, 'a'));
}

TEST_F(FigureLineageTest, NamesRunsWhoseStatesDiffer) {
  nlohmann::json facts = figure_records(store_).at(0).provenance;
  const nlohmann::json others = {
      {"cycles", Cycles{{0, 0, 1}}}, {"state_hash", "another"}, {"states_sha256", "another"}};
  for (const auto& [key, value] : others.items()) {
    nlohmann::json changed = facts;
    changed["inputs"][1][key] = value;
    store_.record("figure/S2", {"FigureGenerated", changed});
    const FigureLineage lineage = figure_lineage(store_, figure_records(store_).back());
    const std::vector<Finding> faults = check_inputs(store_, lineage);
    ASSERT_EQ(faults.size(), 1U) << key;
    EXPECT_EQ(faults[0].run, lineage.inputs[1].run);
    EXPECT_EQ(faults[0].message,
              "the checkpoint states in the log differ from those in the figure's record");
  }
}

TEST(Cycles, AreRanges) {
  for (const auto& [cycles, ranges] : std::vector<std::pair<std::vector<double>, Cycles>>{
           {{}, {}},
           {{3}, {{3, 3, 1}}},
           {{0, 1}, {{0, 1, 1}}},
           {{0, 1, 2, 3}, {{0, 3, 1}}},
           {{0, 0.25, 0.5, 0.75, 1, 1.25}, {{0, 1.25, 0.25}}},
           {{0, 10, 20, 30, 33.5}, {{0, 30, 10}, {33.5, 33.5, 1}}},
           {{0, 1, 2, 4, 6, 8, 9}, {{0, 2, 1}, {4, 8, 2}, {9, 9, 1}}}}) {
    std::vector<CheckpointRecord> records;
    for (const double cycle : cycles) records.emplace_back().cycle = cycle;
    EXPECT_EQ(states_of(records).cycles, ranges);
  }
}

// Of the run's cycles 0 and 1 each record names those that it holds.
TEST_F(FigureLineageTest, FindsTheCyclesOfTheRecord) {
  nlohmann::json facts = figure_records(store_).at(0).provenance;
  for (const auto& [cycles, held] :
       std::vector<std::pair<Cycles, std::size_t>>{{{{0, 1, 1}}, 2},
                                                   {{{0, 0, 1}, {1, 1, 1}}, 2},
                                                   {{{1, 9, 1}}, 1},
                                                   {{{0, 9, 2}}, 1},
                                                   {{{0, 9, 0}}, 0},
                                                   {{{-1, 1e300, 1e-300}}, 2},
                                                   {{}, 0}}) {
    facts["inputs"][1]["cycles"] = cycles;
    store_.record("figure/S2", {"FigureGenerated", facts});
    const FigureLineage lineage = figure_lineage(store_, figure_records(store_).back());
    EXPECT_EQ(lineage.inputs.at(1).checkpoints.size(), held) << to_text(cycles);
  }
}

// As the program recorded them before it recorded who made a figure.
TEST_F(FigureLineageTest, ReadsAnOldRecordAndRejectsABrokenOne) {
  nlohmann::json old = figure_records(store_).at(0).provenance;
  old.erase("made");
  old.erase("analysis_version");
  store_.record("figure/S2", {"FigureGenerated", old});
  const FigureLineage lineage = figure_lineage(store_, figure_records(store_).back());
  EXPECT_EQ(lineage.inputs.size(), 4U);
  EXPECT_TRUE(to_json(lineage).at("made").is_null());
  const auto with_cycles = [&](const nlohmann::json& cycles) {
    nlohmann::json facts = old;
    facts["inputs"][0]["cycles"] = cycles;
    return facts;
  };
  for (const nlohmann::json& broken :
       {nlohmann::json{{"inputs", 3}}, with_cycles({"0"}),
        nlohmann::json{{"inputs", {{{"run", "x"}}}}}, nlohmann::json::object()}) {
    store_.record("figure/S2", {"FigureGenerated", broken});
    EXPECT_THROW(figure_lineage(store_, figure_records(store_).back()), StoreDamaged)
        << broken.dump();
  }
}

TEST(ManifestLines, FollowTheScale) {
  const std::string text =
      "experiment: e\nquestion: q\nbase:\n  grains: 300\nsweep:\n  grid:\n    fluid:\n"
      "      - still\n      - cell\nseeds: 3\nscales:\n  small:\n    seeds: 2\n"
      "  other: {sweep: {zip: {amplitude_rad: [0.05, 0.08]}}}\n"
      "checkpoints: {every_cycles: 2}\nlabels: {fluid=cell: moving}\nplots:\n"
      "  - {name: p, y: phi}\n";
  const auto at = [&](const std::string& scale, const nlohmann::json& labels,
                      const std::string& figure = "S2") {
    std::string found;
    for (const ManifestLine& line : manifest_lines(text, scale, labels, figure)) {
      found += line.key + ":" + std::to_string(line.line) + " ";
    }
    return found;
  };
  EXPECT_EQ(at("", {{"fluid", "cell"}}),
            "experiment:1 sweep.grid.fluid:9 seeds:10 checkpoints:15 labels:16 ");
  EXPECT_EQ(
      at("small", {{"fluid", "still"}}),
      "experiment:1 scales.small:12 sweep.grid.fluid:8 scales.small.seeds:13 checkpoints:15 ");
  EXPECT_EQ(at("other", {{"amplitude_rad", 0.08}}),
            "experiment:1 scales.other:14 scales.other.sweep.zip.amplitude_rad:14 seeds:10 "
            "checkpoints:15 ");
  EXPECT_EQ(at("gone", {{"gone", 1}}, "p"), "experiment:1 seeds:10 checkpoints:15 plots:18 ");
  EXPECT_TRUE(manifest_lines("not: [a", "", nlohmann::json::object(), "").empty());
}

}  // namespace
}  // namespace shearcell::test
