// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of runs, filters, and exports of several runs, as a user sees them.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/experiments/program.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

class CommandLineTable : public ProgramTest {
 protected:
  void SetUp() override { campaign(tiny_manifest("", kBothFluids), {"--cycles", "1"}); }

  nlohmann::json table(const Arguments& options) {
    return json(joined({"table", "--format", "json"}, options));
  }
};

TEST_F(CommandLineTable, HasARowForEachCheckpointAndEachRun) {
  const nlohmann::json rows = table({});
  ASSERT_EQ(rows.size(), 4U) << "two runs at cycles 0 and 1";
  for (const auto& row : rows) {
    const nlohmann::json shown = json({"show", row.at("checkpoint"), "--json"});
    EXPECT_EQ(shown.at("run"), row.at("run"));
    for (const char* key : {"cycle", "phi", "mean_overlap_d", "cell_height_d"}) {
      EXPECT_EQ(shown.at("measures").at(key), row.at(key)) << key;
    }
    EXPECT_EQ(row.at("variant"), "fluid=" + row.at("fluid").get<std::string>());
  }
  const nlohmann::json runs = table({"--per", "run"});
  ASSERT_EQ(runs.size(), 2U);
  for (std::size_t r = 0; r < 2; ++r) {
    const nlohmann::json& last = rows[2 * r + 1];
    for (const auto& [key, value] : last.items()) EXPECT_EQ(runs[r].at(key), value) << key;
    const nlohmann::json run = json({"show", runs[r].at("run"), "--json"});
    EXPECT_EQ(run.at("measures").at("phi"), runs[r].at("phi"));
    EXPECT_EQ(runs[r].at("state"), run.at("state"));
    EXPECT_EQ(runs[r].at("state_hash"), run.at("checkpoints").back().at("state_hash"));
    EXPECT_EQ(runs[r].at("onset_size"), "never") << "no crystallite grows within a cycle";
    EXPECT_TRUE(runs[r].at("onset_size_phi").is_null());
    EXPECT_GT(runs[r].at("wall_time_s"), 0);
  }
  const Outcome help = run({"table", "--help"});
  for (const auto& [key, value] : runs[0].items()) {
    EXPECT_TRUE(key == "fluid" || has(help.out, "  " + key + " ")) << key;
  }
}

TEST_F(CommandLineTable, HasARowForEachValueOfACurve) {
  for (const nlohmann::json& row : table({"--curve", "pair_correlation", "--seed", "1"})) {
    EXPECT_GE(row.at("distance_d").get<double>(), 0);
    EXPECT_GE(row.at("pair_correlation").get<double>(), 0);
    EXPECT_TRUE(row.contains("fluid"));
  }
  // The layers' means, weighted by nothing, are near the pressure of the interior.
  double mean = 0, layers = 0;
  for (const nlohmann::json& row : table({"--curve", "pressure_profile_Pa"})) {
    if (row.at("cycle") != 1 || row.at("pressure_profile_Pa").is_null()) continue;
    mean += row.at("pressure_profile_Pa").get<double>();
    ++layers;
  }
  ASSERT_GT(layers, 5);
  const double pressure = table({}).at(1).at("contact_pressure_Pa").get<double>();
  EXPECT_NEAR(mean / layers, pressure, 0.5 * pressure) << "in Pa, not in k/d";
  expect_refused({"table", "--curve", "g_of_r"}, {"pair_correlation"});
  expect_refused({"table", "--curve", "structure_factor", "--per", "run"}, {});
}

TEST_F(CommandLineTable, HasTheMotionOverThePreviousCycle) {
  const nlohmann::json rows = table({"--variant", "fluid=cell"});
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_TRUE(rows[0].at("msd_1_cycle_d2").is_null()) << "cycle 0 has none before it";
  EXPECT_GT(rows[1].at("msd_1_cycle_d2"), 0);
  EXPECT_GT(rows[1].at("d2min_1_cycle_d2"), 0);
  EXPECT_TRUE(rows[1].at("msd_10_cycles_d2").is_null());
  EXPECT_GE(rows[1].at("cna_crystalline_percent"), 0);
}

TEST_F(CommandLineTable, KeepsValuesMeasuredBeforeAPrune) {
  fs::remove_all(path("shearcell-store"));
  campaign(tiny_manifest("", kBothFluids), {"--cycles", "4"});
  const nlohmann::json before = table({});
  ASSERT_EQ(before.size(), 10U);
  expect(0, {"prune", "--keep-every", "2", "--yes"});
  EXPECT_EQ(table({}), before);
  // What needs a pruned file and was not kept is empty; the rest is measured again.
  fs::remove(path("shearcell-store/derived.sqlite"));
  const nlohmann::json after = table({});
  for (std::size_t r = 0; r < 5; ++r) {
    const bool kept = r % 2 == 0;
    EXPECT_EQ(after[r].at("phi"), kept ? before[r].at("phi") : nlohmann::json()) << r;
    EXPECT_TRUE(after[r].at("msd_1_cycle_d2").is_null()) << r;
  }
}

TEST_F(CommandLineTable, AndExportHaveThePhases) {
  fs::remove_all(path("shearcell-store"));
  campaign(tiny_manifest("", "checkpoints: {phases: [0.333333]}\n"), {"--cycles", "1"});
  const nlohmann::json rows = table({});
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[1].at("cycle"), 0.3333) << "the nearest step of 10000";
  EXPECT_GT(rows[1].at("shear_strain"), 0.07);
  EXPECT_FALSE(rows[2].contains("dissipation_per_cycle_J"));
  EXPECT_GT(table({"--ledger", "--per", "run"})[0].at("dissipation_per_cycle_J"), 0);
  const std::string id = rows[0].at("run");
  expect(0, {"export", id, "--cycles", "0.333333", "--to", "extxyz", "--out", "third"});
  expect(2, {"export", id, "--cycles", "0.3", "--to", "extxyz", "--out", "other"});
}

TEST_F(CommandLineTable, UsesTheLabelsOfTheNewestManifest) {
  write("labelled.yaml",
        tiny_manifest("", kBothFluids + "labels: {\"fluid=still\": \"water at rest\"}\n"));
  expect(0, {"run", "labelled.yaml", "--cycles", "1"});
  expect(0, {"status"}, {"  water at rest  "});
  std::set<std::string> in_status, in_table;
  const nlohmann::json status = json({"status", "--json"});
  for (const auto& one : status.at("runs")) {
    if (one.at("kind") == "prepare") continue;
    in_status.insert(one.at("name").get<std::string>() + "/" +
                     one.at("variant").get<std::string>());
  }
  EXPECT_EQ(in_status.size(), 2U);
  const nlohmann::json rows = table({"--per", "run"});
  EXPECT_EQ(rows.size(), 2U) << "a run of two versions of a manifest is listed once";
  for (const auto& row : rows) in_table.insert(row.at("variant"));
  EXPECT_TRUE(in_table.contains("water at rest"));
}

TEST_F(CommandLineTable, ReportsThatAnEditedManifestHasFewerCyclesThanTheStore) {
  expect(0, {"run", "m.yaml", "--cycles", "2", "-q"});
  write("m.yaml", read_bytes(path("m.yaml")) + "# edited\n");
  expect(0, {"run", "m.yaml", "--cycles", "1", "-q"});
  const Outcome said = expect(0, {"table"});
  EXPECT_TRUE(has(said.err, "2 runs are not shown to the end (stored up to cycle 2)"));
  EXPECT_TRUE(has(said.err, "raise the manifest's `cycles` to show all"));
}

TEST_F(CommandLineTable, HasTheRunsOfTheNewestVersionOfAManifest) {
  write("other.yaml",
        tiny_manifest("  drag_kg_per_s: 2.0e-3\n", "sweep: {grid: {fluid: [still]}}\n"));
  expect(0, {"run", "other.yaml", "--cycles", "1", "-q"});
  const nlohmann::json rows = table({"--per", "run"});
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_FALSE(rows[0].contains("manifest"));
  const Outcome said = expect(0, {"table", "--per", "run"});
  EXPECT_TRUE(has(said.err, "left out: 2 runs of manifest version"));
  EXPECT_FALSE(has(said.err, "To show all runs")) << "a user may hide runs on purpose";
  expect(0, {"status"}, {"fluid=cell (older version "});
  const nlohmann::json with_notes = json({"table", "--per", "run", "--json"});
  EXPECT_EQ(with_notes.at("rows"), rows);
  ASSERT_EQ(with_notes.at("notes").size(), 1U);
  EXPECT_TRUE(
      has(with_notes.at("notes")[0].get<std::string>(), "left out: 2 runs of manifest version"));
  const Outcome report = expect(0, {"report", "--out", "report.html"}, {"tiny: left out: 2 runs"});
  EXPECT_FALSE(has(report.err, "left out: experiment"));
  // A manifest that defines the runs of both versions.
  write("both.yaml", tiny_manifest("",
                                   "sweep: {zip: {drag_kg_per_s: [1.28e-3, 1.28e-3, 2.0e-3], "
                                   "fluid: [still, cell, still]}}\n"));
  const Outcome union_of_both = expect(0, {"run", "both.yaml", "--cycles", "1"});
  EXPECT_TRUE(has(union_of_both.out, "0 stages computed")) << union_of_both.out;
  EXPECT_EQ(table({"--per", "run"}).size(), 3U);
}

// `grains` is the number that a table always has, and as x of a plot a parameter.
TEST_F(CommandLineTable, ANumberOfGrainsIsAParameter) {
  write("sizes.yaml",
        "experiment: sizes\nbase: {cycles: 1, period_s: 1, steps_per_cycle: auto}\n"
        "sweep: {grid: {grains: [300, 400], pressure_Pa: [700, 954]}}\n"
        "plots: [{name: n, y: phi, x: grains, at_cycle: 1}]\n");
  expect(0, {"run", "sizes.yaml", "-q"});
  const Outcome printed = expect(0, {"table", "--experiment", "sizes"});
  std::istringstream header(printed.out.substr(0, printed.out.find('\n')));
  std::multiset<std::string> columns;
  for (std::string column; std::getline(header, column, ',');) columns.insert(column);
  for (const std::string& column : columns) EXPECT_EQ(columns.count(column), 1U) << column;
  EXPECT_TRUE(columns.contains("pressure_Pa") && columns.contains("contact_pressure_Pa"));
  expect(0, {"figures", "n", "--out", "figures"});
  const std::string csv = read_bytes(path("figures/sizes/base/n.csv"));
  for (const char* row : {"pressure_Pa=700,300,", "pressure_Pa=700,400,", "pressure_Pa=954,400,"}) {
    EXPECT_TRUE(has(csv, row));
  }
}

TEST_F(CommandLineTable, OverwritesOnlyItsOwnCsvFiles) {
  const Outcome printed = expect(0, {"table", "--per", "run"}, {"\ntiny,base,fluid=cell,"});
  EXPECT_TRUE(
      printed.out.starts_with("experiment,scale,variant,run,seed,grains,fluid,cycle,checkpoint,"))
      << printed.out;
  for (int k = 0; k < 2; ++k) {
    expect(0, {"table", "--per", "run", "--out", "runs.csv"});
    EXPECT_EQ(read_bytes(path("runs.csv")), printed.out);
  }
  expect_refused({"table", "--out", "/"}, {"/: this is a folder, link or device"});
  const std::string rows = expect(0, {"table"}).out;
  for (const char* name : {"-", "/dev/stdout"}) {
    EXPECT_EQ(expect(0, {"table", "--out", name}).out, rows) << name;
  }
  EXPECT_FALSE(std::filesystem::exists(path("-")));
  for (int k = 0; k < 2; ++k) expect(0, {"table", "--json", "--out", "runs.json"});
  expect(0, {"table", "--format", "json", "--out", "runs.json"});
  write("mine.csv", "a,b\n");
  expect_refused({"table", "--out", "mine.csv"}, {"mine.csv"});
  EXPECT_EQ(read_bytes(path("mine.csv")), "a,b\n");
}

TEST_F(CommandLineTable, SelectsRuns) {
  struct Case {
    Arguments filters;
    std::size_t runs;
  };
  for (const Case& c : {Case{{"--variant", "fluid=cell"}, 1},
                        Case{{"--variant", "fluid=cell", "--variant", "fluid=still"}, 2},
                        Case{{"--experiment", "tiny", "--seed", "1"}, 2}}) {
    EXPECT_EQ(table(joined({"--per", "run"}, c.filters)).size(), c.runs);
    std::size_t sheared = 0;
    const nlohmann::json listed =
        json(joined({"status", "--json", "--state", "completed"}, c.filters));
    for (const auto& run : listed.at("runs")) sheared += run.at("kind") == "shear" ? 1 : 0;
    EXPECT_EQ(sheared, c.runs);
  }
  expect_refused({"table", "--variant", "fluid=cel"}, {"did you mean fluid=cell?"});
  expect_refused({"table", "--variant", "packing"}, {"known are fluid=still, fluid=cell\n"});
  EXPECT_EQ(json({"status", "--json", "--variant", "packing"}).at("runs").size(), 1U);
  expect_refused({"status", "--experiment", "other"}, {"other"});
  expect_refused({"status", "--state", "lost"}, {"lost"});
}

TEST_F(CommandLineTable, EstimatesTheRemainingWork) {
  EXPECT_TRUE(json({"status", "--json"}).at("estimate").is_null());
  write("longer.yaml", tiny_manifest("  cycles: 4000\n", kBothFluids));
  const Outcome stopped = run_until({"run", "longer.yaml", "-q"}, 8, SIGINT);
  ASSERT_EQ(stopped.code, 85) << stopped.err;
  const nlohmann::json left = json({"status", "--json"}).at("estimate");
  EXPECT_EQ(left.at("stages_left"), 2);
  EXPECT_EQ(left.at("running"), false);
  const double steps = left.at("particle_steps_left");
  EXPECT_NEAR(steps, 2 * 3999 * 300 * 1e4, 2 * 1000 * 300 * 1e4);
  EXPECT_GT(left.at("seconds_left"), 0);
  expect(0, {"status"}, {"\nleft: 2 stages, "});
  for (const auto& row : table({})) {  // without what the interruption left within a cycle
    EXPECT_EQ(row.at("cycle"), std::floor(row.at("cycle").get<double>()));
  }
}

TEST_F(CommandLineTable, ExportsSelectedRunsCompletelyOrNotAtAll) {
  const std::set<std::string> before = listing();
  const nlohmann::json done =
      json({"export", "--experiment", "tiny", "--to", "extxyz", "--out", "all", "--json"});
  ASSERT_EQ(done.size(), 2U);
  for (const auto& one : done) {
    const std::string text = read_bytes(one.at("out").get<std::string>());
    EXPECT_TRUE(has(text, "run=\"" + one.at("run").get<std::string>() + '"'));
    EXPECT_TRUE(has(text, "length_unit=d ") && has(text, " amplitude_rad=0.0833 "));
  }
  const std::string id = done[0].at("run");
  expect(0, {"export", id, id, "--to", "vtk", "--out", "frames/"});  // one run
  EXPECT_TRUE(fs::exists(path("frames/run.json")) && fs::exists(path("frames/frames.pvd")));
  expect(2, {"export", id, "--seed", "1", "--to", "vtk", "--out", "other"});
  expect(2, {"export", id, "--to", "extxyz", "--out", "frames"}, {"already exists"});
  for (const Arguments& command :
       {Arguments{"report"}, {"table"}, {"figures"}, {"export", id, "--to", "extxyz"}}) {
    expect_refused(joined(command, {"--out", "shearcell-store/objects/x/y"}),
                   {"objects is where a store keeps its checkpoints"});
    expect_refused(joined(command, {"--out", ""}), {"--out: is empty; give a file or folder"});
  }

  // The limit on file sizes kills it, or makes write() fail as on a full disk.
  for (const std::string trap : {"", "trap '' XFSZ; "}) {
    for (const std::string format : {"extxyz", "h5md", "vtk", "lammps"}) {
      const Outcome cut =
          shell(trap + "ulimit -f 8; exec \"$0\" export " + id + " --to " + format + " --out cut");
      EXPECT_FALSE(fs::exists(path("cut"))) << format << cut.err;
      if (trap.empty()) {
        EXPECT_NE(cut.signal, 0) << format;
      } else {
        EXPECT_EQ(cut.code, 1) << format;
        EXPECT_TRUE(has(cut.err, "cut"));
      }
    }
  }
}

TEST_F(CommandLineTable, ExportsTheOtherRunsIfOneIsDamaged) {
  const auto damage = [&](const nlohmann::json& run) {
    const Store store(path("shearcell-store"), Access::read);
    truncate_file(path("shearcell-store/" + store.checkpoints(run.at("id")).back().file));
    return run.at("id").get<std::string>().substr(0, 8);
  };
  const auto runs = json({"status", "--json"}).at("runs");
  std::vector<nlohmann::json> sheared;
  for (const auto& run : runs) {
    if (run.at("kind") == "shear" && run.at("experiment") == "tiny") sheared.push_back(run);
  }
  ASSERT_EQ(sheared.size(), 2U);
  const std::string first = damage(sheared[0]);
  const auto export_all = [&](const std::string& format, const std::string& out) {
    return Arguments{"export", "--experiment", "tiny", "--to", format, "--out", out};
  };
  for (const std::string format : {"extxyz", "vtk", "ro-crate"}) {
    expect(4, export_all(format, format), {"left out: run " + first, "objects/"});
    EXPECT_EQ(std::distance(fs::directory_iterator(path(format)), {}), 1) << format;
  }
  damage(sheared[1]);
  expect(4, export_all("extxyz", "none"), {"left out: run " + first});
  EXPECT_FALSE(fs::exists(path("none")));
}

}  // namespace
}  // namespace shearcell::test
