// SPDX-License-Identifier: GPL-3.0-or-later
// Figures of made-up runs, the bytes of a CSV file, and gnuplot's drawing.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <thread>

#include "analysis/error.hpp"
#include "analysis/figure.hpp"
#include "analysis/plot.hpp"
#include "provenance/io/child_process.hpp"
#include "tests/analysis/made_up_runs.hpp"
#include "tests/support/files.hpp"
#include "tests/support/text.hpp"
#include "tests/support/variable.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

TEST(FigureS2, ARowPerVariantAndCycle) {
  const std::vector<FigureTable> tables = s2(two_variants());
  ASSERT_EQ(tables.size(), 2U);
  EXPECT_EQ(to_csv(tables[0]),
            "variant,cycle,phi_mean,phi_standard_error,phi_u_mean,phi_u_standard_error,"
            "overlap_mean_d,overlap_standard_error_d,runs\n"
            "fluid=still,0,0.6105,0.01,0.62,0.01,0.002,0,2\n"
            "fluid=still,1,0.6205,0.01,0.63,0.01,0.002,0,2\n"
            "fluid=cell,0,0.6005,,0.61,,0.002,,1\n"
            "fluid=cell,1,0.6105,,0.62,,0.002,,1\n"
            "fluid=cell,2,0.6205,,0.63,,0.002,,1\n");
}

TEST(FigureS2, ARowPerVariantAndBinOfPhi) {
  std::vector<FigureRun> runs = {rising_run("still", 1, 2, 0), rising_run("still", 2, 2, 0.01)};
  for (Measures* m : {&runs[0].checkpoints[1].measures, &runs[0].checkpoints[2].measures}) {
    m->phi = 0.6105;  // a run that stays in a bin counts once there
  }
  runs[0].checkpoints[0].measures.phi = std::nan("");
  EXPECT_EQ(to_csv(s2(runs)[1]),
            "variant,phi_low,phi_high,phi_mean,phi_standard_error,crystalline_mean_percent,"
            "crystalline_standard_error_percent,runs\n"
            "fluid=still,0.61,0.612,0.6105,0,1.25,0.25,2\n"
            "fluid=still,0.62,0.622,0.6205,,2,,1\n"
            "fluid=still,0.63,0.632,0.6305,,3,,1\n");
}

TEST(FigureS2, HasOneCheckpointOfEachRunAtAWholeCycle) {
  std::vector<FigureRun> runs = {rising_run("still", 1, 1, 0)};
  runs[0].checkpoints[1].cycle = 0.5;
  EXPECT_EQ(s2(runs)[0].rows.size(), 1U) << "one inside a cycle is left out";
  runs[0].checkpoints[1].cycle = 0;
  EXPECT_THROW(s2(runs), AnalysisError) << "two of one cycle";
}

const FigureTable& panel(const FigureResult& result, std::string_view name) {
  for (const FigureTable& table : result.tables) {
    if (table.name == name) return table;
  }
  throw AnalysisError("no panel " + std::string(name));
}

/// A crystallite of 20 grains at x = 3, y = 5 [d] of a cell 10 wide whose planes are at 1 and 17.
FigureRun nucleated(double stiffness) {
  FigureRun run = made_up_run("stiffness_N_per_m", stiffness, 1, 0, [](int, Measures&) {});
  CrystalliteMap map = map_of({std::vector<std::int32_t>(20, 0)});
  map.centre[0] = {3, 5, 0};
  map.width = 10;
  map.bottom = 1;
  map.top = 17;
  run.checkpoints[0].measures.crystallite_map = map;
  return run;
}

TEST(FigureS7, HasBothHeightsAndEachStiffness) {
  const std::vector<FigureRun> runs = {nucleated(6540), nucleated(654)};
  const FigureResult made = find_figure("S7")->make(runs);
  for (const auto& [name, row] :
       {std::pair("S7", "x/w,0.3,0.35"),               // (3 + 1) / (10 + 2)
        std::pair("S7", "y/h,0.25,0.3"),               // 4 / 16, softest only
        std::pair("S7_heights", "y/1.675L,0.2,0.25"),  // 4 / 16.75
        std::pair("S7_stiffness", "654,0.25,0.3"), std::pair("S7_stiffness", "6540,0.25,0.3")}) {
    const std::string csv = to_csv(panel(made, name));
    EXPECT_TRUE(has(csv, std::string("\n") + row + ",20,,1,1\n"));
  }
}

TEST(FigureC, DrawsTheLargestCrystalliteAgainstPhi) {
  const auto run = made_up_run("amplitude_rad", 0.1, 1, 1, [](int n, Measures& m) {
    m.phi = 0.6401 + 0.01 * n;
    m.largest_crystallite = 30 * static_cast<std::size_t>(n);
  });
  const FigureResult made = find_figure("C")->make(std::vector{run});
  const FigureTable& table = panel(made, "C_largest");
  EXPECT_EQ(to_csv(table),
            "variant,phi_low,phi_high,phi_mean,phi_standard_error,largest_crystallite_mean_grains,"
            "largest_crystallite_standard_error_grains,runs\n"
            "amplitude_rad=0.1,0.64,0.642,0.6401,,1,,1\n"
            "amplitude_rad=0.1,0.65,0.652,0.6501,,30,,1\n");
  EXPECT_TRUE(table.chart.y.log);
  EXPECT_EQ(table.chart.lines.at(0).at, 20) << "the critical size of the supplement";
}

// Crystallites of s grains gain one with probability s / (s + 6), and else lose one. One that has
// vanished begins again with other grains.
FigureRun biased_walks(std::uint32_t seed) {
  FigureRun run = made_up_run("amplitude_rad", 0.0833, seed, 40, [](int, Measures&) {});
  struct Walk {
    std::int32_t start, first_grain, size;
  };
  std::vector<Walk> walks;
  for (std::int32_t k = 0; k < 24; ++k) walks.push_back({1 + k / 2, 100 * k, 1 + k / 2});
  for (std::uint32_t n = 0; n < run.checkpoints.size(); ++n) {
    std::vector<std::vector<std::int32_t>> crystallites;
    for (std::uint32_t k = 0; k < walks.size(); ++k) {
      Walk& walk = walks[k];
      crystallites.push_back(grain_ids(walk.first_grain, walk.size));
      const double grows = walk.size / (walk.size + 6.0);
      walk.size += uniform_pair({seed, n, k, 2}, 7)[0] < grows ? 1 : -1;
      if (walk.size == 0) walk = {walk.start, walk.first_grain + 10'000, walk.start};
    }
    run.checkpoints[n].measures.crystallite_map = map_of(crystallites);
  }
  return run;
}

TEST(FigureC, FollowsCrystallitesOverSeveralNumbersOfCycles) {
  std::vector<FigureRun> runs;
  for (std::uint32_t seed = 1; seed <= 5; ++seed) runs.push_back(biased_walks(seed));
  const FigureResult made = find_figure("C")->make(runs);
  const FigureTable &followed = panel(made, "C_followed"),
                    &critical = panel(made, "C_critical_size");
  std::vector<TableValue> cycles;
  for (const TableRow& row : followed.rows) {
    cycles.push_back(row.at(1));
    EXPECT_NEAR(std::get<double>(row.at(2)), 6, 1.5) << std::get<std::int64_t>(row.at(1));
  }
  EXPECT_EQ(cycles,
            (std::vector<TableValue>{std::int64_t{1}, std::int64_t{2}, std::int64_t{5},
                                     std::int64_t{10}, std::int64_t{15}, std::int64_t{20}}));
  EXPECT_EQ(followed.rows.at(4).at(2), critical.rows.at(0).at(3)) << "15 cycles are n_bin";
}

// As the supplement does: one experiment, with the standard deviation of runs at A = 0.05.
TEST(FigureS5, TheExperimentHasTheStandardDeviationOfOurRuns) {
  std::vector<FigureRun> runs;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    runs.push_back(made_up_run("amplitude_rad", 0.05, seed, 40, [seed](int n, Measures& m) {
      m.phi = 0.64 + 0.0005 * n + 0.001 * static_cast<double>(seed);
      m.largest_crystallite = n < 10 ? 9 : 11;
    }));
  }
  const FigureResult made = find_figure("S5a")->make(runs);
  const FigureTable& table = panel(made, "S5a");
  const ChartPoint experiment = table.chart.series.at(0).points.at(0);
  EXPECT_EQ(experiment.x, 0.01);
  EXPECT_EQ(experiment.y, 0.645);
  EXPECT_NEAR(experiment.y_error.value(), 0.001, 1e-9) << "onsets 0.001 apart";
}

TEST(Csv, QuotingAndNumbers) {
  FigureTable table;
  table.columns = {"a b", "c,d"};
  table.rows = {{std::string("say \"x\""), std::int64_t{-3}},
                {1.0 / 3, std::numeric_limits<double>::infinity()},
                {1e-20, std::monostate{}},
                {-0.0, std::nan("")}};
  EXPECT_EQ(to_csv(table), "a b,\"c,d\"\n\"say \"\"x\"\"\",-3\n0.333333333,\n1e-20,\n0,\n");
}

/// Draws into a folder whose name has characters that are special in shell and gnuplot.
class Plot : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!find_program("gnuplot")) GTEST_SKIP() << "gnuplot is not installed";
  }
  fs::path draw(const FigureTable& table) const {
    write_csv(table, folder_.path());
    return draw_svg(table, folder_.path());
  }
  /// What it says when it cannot draw; the data must stay.
  std::string trouble_with(const FigureTable& table) const {
    const std::string message = message_of<AnalysisError>([&] { draw(table); });
    EXPECT_TRUE(fs::exists(folder_.path() / (table.name + ".csv")));
    EXPECT_FALSE(fs::exists(folder_.path() / (table.name + ".svg")));
    return message;
  }

  const TemporaryFolder folder_{"shear cell's $HOME-"};
};

TEST_F(Plot, SameTableSameSvgAndPdf) {
  const FigureTable table = s2(two_variants())[0];
  const fs::path svg = draw(table);
  const std::string first = read_bytes(svg);
  EXPECT_TRUE(has(first, "</svg>"));
  EXPECT_TRUE(has(first, "ϕ"));
  EXPECT_FALSE(has(first, folder_.path().string()));
  EXPECT_FALSE(has(first, "<text>")) << "librsvg would drop spaces";
  const auto pdf = convert_to_pdf(svg);
  const std::string first_pdf = pdf ? read_bytes(*pdf) : "";
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // a date in them would differ
  draw(table);
  EXPECT_EQ(read_bytes(svg), first);
  if (!pdf) GTEST_SKIP() << "rsvg-convert is not installed";
  EXPECT_EQ(first_pdf.substr(0, 5), "%PDF-");
  convert_to_pdf(svg);
  EXPECT_EQ(read_bytes(*pdf), first_pdf);
}

// Names of variants may hold what is special in gnuplot, and a comma where two parameters vary.
TEST_F(Plot, EveryFigureIsDrawnWithFewRunsAndWithoutRuns) {
  std::vector<FigureRun> few = two_variants();
  few[0].variant = "it's_{odd}^`echo`";
  few[1].variant = few[2].variant = "gravity_m_per_s2=0,amplitude_rad=0.04";
  for (const Figure& figure : all_figures()) {
    for (const std::vector<FigureRun>& runs : {few, std::vector<FigureRun>{}}) {
      const FigureResult made = figure.make(runs);
      EXPECT_EQ(overall(made.verdicts).value_or(Ruling::undecided), Ruling::undecided)
          << figure.name;
      for (const FigureTable& table : made.tables) {
        EXPECT_GT(fs::file_size(draw(table)), 1000U) << table.name;
      }
    }
  }
}

TEST_F(Plot, ReportsTheErrorOfGnuplot) {
  FigureTable table = s2(two_variants())[0];
  table.chart.series[0].colour = "'no such colour";
  EXPECT_TRUE(has(trouble_with(table), "could not draw S2a"));
}

TEST_F(Plot, WithoutGnuplotNamesThePackageKeepsDataAndDeletesOldDrawings) {
  const fs::path svg = draw(s2(two_variants())[0]);
  convert_to_pdf(svg);
  const Variable nowhere("PATH", "/nonexistent");
  const std::string message = trouble_with(s2(two_variants())[0]);
  EXPECT_TRUE(has(message, "gnuplot-nox"));
  EXPECT_FALSE(fs::exists(fs::path(svg).replace_extension(".pdf")));
}

TEST_F(Plot, RejectsNamesThatAreNotFileNames) {
  FigureTable table;
  for (const char* name : {"", "../x", "a b", "a'b", "-d"}) {
    table.name = name;
    EXPECT_THROW(draw_svg(table, "."), AnalysisError) << name;
  }
}

}  // namespace
}  // namespace shearcell::test
