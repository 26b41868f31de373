// SPDX-License-Identifier: GPL-3.0-or-later
// Figures of made-up runs, the bytes of a CSV file, and gnuplot's drawing.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <regex>
#include <string>
#include <string_view>
#include <thread>

#include "analysis/figure.hpp"
#include "analysis/growth.hpp"
#include "analysis/plot.hpp"
#include "provenance/errors.hpp"
#include "provenance/io/child_process.hpp"
#include "provenance/io/file.hpp"
#include "tests/analysis/made_up_runs.hpp"
#include "tests/support/files.hpp"
#include "tests/support/text.hpp"
#include "tests/support/variable.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

TEST(FigureS2, ARowPerVariantAndCycle) {
  const std::vector<Table> tables = s2(two_variants());
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
  std::vector<FrameRun> runs = {rising_run("still", 1, 2, 0), rising_run("still", 2, 2, 0.01)};
  for (Measures* m : {&runs[0].checkpoints[1].measures, &runs[0].checkpoints[2].measures}) {
    m->numbers["phi"] = 0.6105;  // a run that stays in a bin counts once there
  }
  runs[0].checkpoints[0].measures.numbers["phi"] = std::nan("");
  EXPECT_EQ(to_csv(s2(runs)[1]),
            "variant,phi_low,phi_high,phi_mean,phi_standard_error,crystalline_mean_percent,"
            "crystalline_standard_error_percent,runs\n"
            "fluid=still,0.61,0.612,0.6105,0,1.25,0.25,2\n"
            "fluid=still,0.62,0.622,0.6205,,2,,1\n"
            "fluid=still,0.63,0.632,0.6305,,3,,1\n");
}

TEST(FigureS2, HasOneCheckpointOfEachRunAtAWholeCycle) {
  std::vector<FrameRun> runs = {rising_run("still", 1, 1, 0)};
  runs[0].checkpoints[1].cycle = 0.5;
  EXPECT_EQ(s2(runs)[0].rows.size(), 1U) << "one inside a cycle is left out";
  runs[0].checkpoints[1].cycle = 0;
  EXPECT_THROW(s2(runs), AnalysisError) << "two of one cycle";
}

const Table& panel(const FigureResult& result, std::string_view name) {
  for (const Table& table : result.tables) {
    if (table.name == name) return table;
  }
  throw AnalysisError("no panel " + std::string(name));
}

/// A crystallite of 20 grains at x = 3, y = 5 [d] of a cell 10 wide whose planes are at 1 and 17.
FrameRun nucleated(double stiffness) {
  FrameRun run = made_up_run("stiffness_N_per_m", stiffness, 1, 0, [](int, Measures&) {});
  CrystalliteMap map = map_of({std::vector<std::int32_t>(20, 0)});
  map.centre[0] = {3, 5, 0};
  map.width = 10;
  map.bottom = 1;
  map.top = 17;
  run.checkpoints[0].measures.crystallite_map = map;
  return run;
}

TEST(FigureS7, HasBothHeightsAndEachStiffness) {
  const std::vector<FrameRun> runs = {nucleated(6540), nucleated(654)};
  const FigureResult made = find_figure("S7")->make(runs);
  for (const auto& [name, row] : {std::pair("S7", "x/w,0.25,0.375"),  // (3 + 1) / (10 + 2)
                                  std::pair("S7", "y/h,0.25,0.375"),  // 4 / 16, softest only
                                  std::pair("S7_heights", "y/1.675L,0.125,0.25"),  // 4 / 16.75
                                  std::pair("S7_stiffness", "654,0.25,0.375"),
                                  std::pair("S7_stiffness", "6540,0.25,0.375")}) {
    const std::string csv = to_csv(panel(made, name));
    EXPECT_TRUE(has(csv, std::string("\n") + row + ",8,,1,1\n"));
  }
}

TEST(FigureC, DrawsTheLargestCrystalliteAgainstPhi) {
  const auto run = made_up_run("amplitude_rad", 0.1, 1, 1, [](int n, Measures& m) {
    m.numbers["phi"] = 0.6401 + 0.01 * n;
    m.numbers["largest_crystallite"] = 30 * n;
  });
  const FigureResult made = find_figure("C")->make(std::vector{run});
  const Table& table = panel(made, "C_largest");
  EXPECT_EQ(to_csv(table),
            "variant,phi_low,phi_high,phi_mean,phi_standard_error,largest_crystallite_mean,"
            "largest_crystallite_standard_error,runs\n"
            "amplitude_rad=0.1,0.64,0.642,0.6401,,1,,1\n"
            "amplitude_rad=0.1,0.65,0.652,0.6501,,30,,1\n");
  EXPECT_TRUE(table.chart.y.log);
  EXPECT_EQ(table.chart.lines.at(0).at, 20) << "the critical size of the supplement";
}

// Crystallites of s grains gain one with probability s / (s + critical), and else lose one. One
// that has vanished begins again with other grains.
FrameRun biased_walks(std::uint32_t seed, double amplitude = 0.0833, int critical = 6) {
  FrameRun run = made_up_run("amplitude_rad", amplitude, seed, 40, [](int, Measures&) {});
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
      const double grows = walk.size / (walk.size + static_cast<double>(critical));
      walk.size += uniform_pair({seed, n, k, 2}, 7)[0] < grows ? 1 : -1;
      if (walk.size == 0) walk = {walk.start, walk.first_grain + 10'000, walk.start};
    }
    run.checkpoints[n].measures.crystallite_map = map_of(crystallites);
  }
  return run;
}

TEST(FigureC, FollowsCrystallitesOverSeveralNumbersOfCycles) {
  std::vector<FrameRun> runs;
  for (std::uint32_t seed = 1; seed <= 5; ++seed) runs.push_back(biased_walks(seed));
  const FigureResult made = find_figure("C")->make(runs);
  const Table &followed = panel(made, "C_followed"), &critical = panel(made, "C_critical_size");
  std::vector<TableCell> cycles;
  for (const TableRow& row : followed.rows) {
    cycles.push_back(row.at(1));
    if (cycles.back() == TableCell(std::int64_t{40})) continue;  // one pair of checkpoints a run
    EXPECT_NEAR(std::get<double>(row.at(2)), 6, 1.5) << std::get<std::int64_t>(row.at(1));
  }
  EXPECT_EQ(cycles, (std::vector<TableCell>{std::int64_t{1}, std::int64_t{2}, std::int64_t{5},
                                            std::int64_t{10}, std::int64_t{15}, std::int64_t{20},
                                            std::int64_t{40}}));
  EXPECT_EQ(followed.rows.at(4).at(2), critical.rows.at(0).at(3)) << "15 cycles are n_bin";
  const std::vector<ChartPoint> supplement = points_of(followed.chart.series.at(1));
  ASSERT_EQ(supplement.size(), 1U);
  EXPECT_EQ(supplement.front().x, 15);
  EXPECT_EQ(supplement.front().y, 16);
}

TEST(FigureC, TwoRunsOfOnePackingAreOne) {
  std::vector<FrameRun> runs;
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    runs.push_back(biased_walks(seed));
    runs.back().packing = "of seed " + std::to_string((seed + 1) / 2);
  }
  const FigureResult made = find_figure("C")->make(runs);
  EXPECT_EQ(panel(made, "C_critical_size").rows.at(0).back(), TableCell(std::size_t{5}));
}

Verdict verdict_of(const FigureResult& made, const std::string& claim) {
  return *std::ranges::find(made.verdicts, claim, &Verdict::text);
}

/// What the interval and the margin say of a claim that states why it cannot be decided.
Ruling ruling_by_numbers(const Verdict& verdict, Relation claimed) {
  EXPECT_EQ(verdict.ruling, Ruling::undecidable);
  return ruling_of(verdict.estimate.value().interval, verdict.margin, claimed);
}

// Anyone can compute the size again from what entered the verdict.
TEST(FigureC, ComparesAmplitudesAtEqualNumbersOfCycles) {
  for (const bool grows : {true, false}) {
    std::vector<FrameRun> runs;
    for (std::uint32_t seed = 1; seed <= 6; ++seed) {
      runs.push_back(biased_walks(seed, 0.05, grows ? 4 : 9));
      runs.push_back(biased_walks(seed + 10, 0.1, grows ? 9 : 4));
    }
    const Verdict found =
        verdict_of(find_figure("C")->make(runs), "C: the critical size grows with A");
    EXPECT_EQ(ruling_by_numbers(found, Relation::higher),
              grows ? Ruling::supported : Ruling::refuted)
        << numbers_of(found);
    EXPECT_NEAR(found.estimate.value().value, grows ? 9.0 / 4 - 1 : 4.0 / 9 - 1,
                grows ? 0.7 : 0.15);
    std::map<std::string, GrowthBySize> entered;
    for (const TableRow& row : found.entered.rows) {
      EXPECT_EQ(row.at(3), TableCell(std::int64_t{5}));
      const auto count = [&](std::size_t k) {
        return static_cast<std::size_t>(std::get<std::int64_t>(row.at(k)));
      };
      if (std::get<std::string>(row.at(0)) == "amplitude_rad=0.1") {
        entered[std::get<std::string>(row.at(2))][static_cast<std::int32_t>(count(4))] = {
            count(5), count(6), count(7), count(8)};
      }
    }
    std::vector<GrowthBySize> counts;
    for (const auto& [packing, of_run] : entered) counts.push_back(of_run);
    EXPECT_NE(found.note.find(fmt::format("A = 0.1 rad: {:.3g} grains",
                                          GrowthCurve(counts).critical_size()->value)),
              std::string::npos)
        << found.note;
  }
}

// The supplement's number is from few runs, too.
TEST(FigureC, APublishedSizeThatFewRunsMayGiveIsNotContradicted) {
  for (const int critical : {4, 12, 14}) {
    std::vector<FrameRun> runs;
    for (std::uint32_t seed = 1; seed <= 6; ++seed) {
      runs.push_back(biased_walks(seed, 0.0833, critical));
    }
    const FigureResult made = find_figure("C")->make(runs);
    const Table& sizes = panel(made, "C_critical_size");
    const auto number = [&](const std::string& column) {
      const auto place = static_cast<std::ptrdiff_t>(sizes.place(column));
      return std::get<double>(sizes.rows.at(0).at(static_cast<std::size_t>(place)));
    };
    const Verdict found =
        verdict_of(made, "C: the critical size at A = 0.0833 rad is about 16 grains");
    const bool may_be = number("repeated_low_grains") <= 16 && 16 <= number("repeated_high_grains");
    std::printf("critical size %d: %s; %s\n", critical, numbers_of(found).c_str(),
                found.note.c_str());
    const bool differs = ruling_by_numbers(found, Relation::same) == Ruling::differs;
    EXPECT_EQ(differs, critical == 4);
    EXPECT_FALSE(may_be && differs);
  }
}

TEST(FigureC, NoNumberOfRunsDecidesIfTheSupplementsIntervalIsUnbounded) {
  std::vector<FrameRun> runs;
  for (std::uint32_t seed = 1; seed <= 14; ++seed) {
    runs.push_back(biased_walks(seed, 0.0833, seed > 4 ? 0 : 20));  // 0: all grow
  }
  const Verdict found = verdict_of(find_figure("C")->make(runs),
                                   "C: the critical size at A = 0.0833 rad is about 16 grains");
  EXPECT_TRUE(has(found.note, "runs would give less than 1 to")) << found.note;
  EXPECT_EQ(ruling_by_numbers(found, Relation::same), Ruling::undecided);
  EXPECT_FALSE(found.runs_needed) << numbers_of(found);
}

/// Runs of two experiments, as collect_runs() joins them.
std::vector<FrameRun> of_experiment(const std::string& experiment, std::vector<FrameRun> runs) {
  for (FrameRun& run : runs) {
    run.stage.id += experiment;
    run.place.experiment = experiment;
    run.place.swept["experiment"] = experiment;
    run.place.variant = "experiment=" + experiment + "," + run.place.variant;
    run.name = run.place.variant;
  }
  return runs;
}

TEST(FigureSummary, IsOfTheRunsOfSeveralExperiments) {
  std::vector<FrameRun> runs;
  for (const double amplitude : {0.05, 0.1}) {
    const FrameRun run = made_up_run("amplitude_rad", amplitude, 1, 40, [](int n, Measures& m) {
      m.numbers["phi"] = 0.64 + 0.0005 * n;
      m.numbers["largest_crystallite"] = n < 10 ? 2 : 30;
    });
    const auto named = of_experiment("onset_amplitude", {run});
    runs.insert(runs.end(), named.begin(), named.end());
  }
  for (const char* experiment : {"drag", "timestep"}) {
    const auto named = of_experiment(experiment, two_variants());
    runs.insert(runs.end(), named.begin(), named.end());
  }
  const Figure& summary = *find_figure("summary");
  EXPECT_EQ(std::ranges::count(summary.of, "drag"), 1);
  const FigureResult made = summary.make(runs);
  const Table &by_amplitude = panel(made, "summary_a"), &by_phi = panel(made, "summary_c");
  EXPECT_EQ(by_amplitude.rows.size(), 2U);
  EXPECT_EQ(points_of(by_amplitude.chart.series.at(0)).size(), 2U);
  std::map<std::string, std::set<std::string>> colours;  // of the variants
  for (const Series& one : by_phi.chart.series) {
    colours[one.colour].insert(plain_text(one.title));
  }
  EXPECT_EQ(by_phi.chart.series.size(), 4U) << "two variants of two experiments";
  EXPECT_EQ(made.verdicts.size(), 5U);
  EXPECT_EQ(made.verdicts[0].id, "summary.percentage");
}

// 30 variants whose true means scatter by 1; each run by 2.
TEST(SpreadOfVariants, IsTheStandardDeviationOfTheirTrueMeans) {
  ClaimSpec claim{.id = "own",
                  .compare = "crystalline_percent",
                  .estimator = "spread_of_variants",
                  .cycles = {{2, 2}},
                  .margin = 0.1};
  const auto verdict = [&](double scatter) {
    std::vector<FrameRun> runs;
    const std::vector<double> means = normal_numbers(1, 30);
    for (std::uint32_t v = 0; v < means.size(); ++v) {
      const std::vector<double> own = normal_numbers(100 + v, 6);
      for (std::uint32_t k = 0; k < own.size(); ++k) {
        runs.push_back(made_up_run("drag_kg_per_s", v, k, 2, [&](int, Measures& m) {
          m.numbers["crystalline_percent"] = scatter * means[v] + 2 * own[k];
        }));
      }
    }
    return claim_figure(claim).make(runs).verdicts.at(0);
  };
  EXPECT_NEAR(verdict(1).estimate.value().value, 1, 0.4) << verdict(1).note;
  EXPECT_GT(verdict(1).estimate.value().interval.high, 1);
  EXPECT_EQ(verdict(1).ruling, Ruling::undecided) << "0 is in the interval, 0.1 too";
  claim.margin = 2;
  EXPECT_EQ(verdict(1).ruling, Ruling::agrees);
  EXPECT_EQ(verdict(0).ruling, Ruling::agrees) << verdict(0).note;
  EXPECT_LT(verdict(0).estimate.value().value, 0.7);
}

// Runs without a number could hide a spread: a verdict needs three quarters of each variant.
TEST(SpreadOfVariants, IsUnknownIfRunsAreLeftOut) {
  const ClaimSpec claim{.id = "own",
                        .compare = "phi",
                        .estimator = "spread_of_variants",
                        .cycles = {{2, 2}},
                        .margin = 0.1};
  for (const std::size_t missing : {0, 1, 2}) {
    std::vector<FrameRun> runs;
    for (const char* fluid : {"still", "cell"}) {
      for (std::uint64_t seed = 0; seed < 4; ++seed) {
        const bool is_missing = fluid == std::string("cell") && seed < missing;
        runs.push_back(made_up_run("fluid", fluid, seed, is_missing ? 1 : 2, [&](int, Measures& m) {
          m.numbers["phi"] = 0.6 + 1e-3 * static_cast<double>(seed);
        }));
      }
    }
    const Verdict found = claim_figure(claim).make(runs).verdicts.at(0);
    EXPECT_EQ(found.ruling, missing < 2 ? Ruling::agrees : Ruling::undecided) << found.note;
    EXPECT_EQ(found.note.find("2 have no number") != found.note.npos, missing == 2) << found.note;
    EXPECT_FALSE(found.runs_needed);
  }
}

TEST(Csv, QuotingAndNumbers) {
  Table table;
  table.columns = {"a b", "c,d"};
  table.rows = {{std::string("say \"x\""), std::int64_t{-3}},
                {1.0 / 3, std::numeric_limits<double>::infinity()},
                {1e-20, std::monostate{}},
                {-0.0, std::nan("")}};
  EXPECT_EQ(to_csv(table), "a b,\"c,d\"\n\"say \"\"x\"\"\",-3\n0.333333333,\n1e-20,\n0,\n");
}

/// The texts of an SVG in their order, as a reader sees them.
std::vector<std::string> texts_of(const std::string& svg) {
  static const std::regex element("<text[^>]*>(.*?)</text>"), tag("<[^>]*>");
  std::vector<std::string> texts;
  for (std::sregex_iterator found(svg.begin(), svg.end(), element), none; found != none; ++found) {
    std::string text = std::regex_replace(found->str(1), tag, "");
    for (const auto& [name, character] :
         {std::pair("&lt;", "<"), {"&gt;", ">"}, {"&quot;", "\""}, {"&amp;", "&"}}) {
      text = std::regex_replace(text, std::regex(name), character);
    }
    texts.push_back(std::move(text));
  }
  return texts;
}

/// Draws into a folder whose name has characters that are special in shell and gnuplot.
class Plot : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!find_program("gnuplot")) GTEST_SKIP() << "gnuplot is not installed";
  }
  fs::path draw(const Table& table) const {
    write_output(folder_.path() / (table.name + ".csv"), to_csv(table));
    return draw_svg(table, folder_.path());
  }
  /// What visible_points.py finds in a drawing; nothing if it ran out of time.
  std::optional<ProgramOutcome> look_at(const fs::path& svg) const {
    return run_program({"/usr/bin/python3", SHEARCELL_TEST_DATA "/../analysis/visible_points.py",
                        svg, fs::path(svg).replace_extension(".gp")},
                       folder_.path());
  }
  /// What it says when it cannot draw; the data must stay.
  std::string trouble_with(const Table& table) const {
    const std::string message = message_of<AnalysisError>([&] { draw(table); });
    EXPECT_TRUE(fs::exists(folder_.path() / (table.name + ".csv")));
    EXPECT_FALSE(fs::exists(folder_.path() / (table.name + ".svg")));
    return message;
  }

  const TemporaryFolder folder_{"shear cell's $HOME-"};
};

TEST_F(Plot, SameTableSameSvgAndPdf) {
  const Table table = s2(two_variants())[0];
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
  std::vector<FrameRun> few = two_variants();
  few[0].place.variant = "it's_{odd}^`echo`";
  few[1].place.variant = few[2].place.variant = "gravity_m_per_s2=0,amplitude_rad=0.04";
  for (const Figure& figure : all_figures()) {
    if (!figure.make) continue;  // summary, which is made of others
    for (const std::vector<FrameRun>& runs : {few, std::vector<FrameRun>{}}) {
      const FigureResult made = figure.make(runs);
      // The interior grains of the few runs are the published ones (S5b).
      const std::map<Ruling, std::size_t> rulings = rulings_of(made.verdicts);
      EXPECT_FALSE(rulings.contains(Ruling::differs) || rulings.contains(Ruling::refuted));
      const bool open =
          rulings.contains(Ruling::undecided) || rulings.contains(Ruling::undecidable);
      EXPECT_EQ(open, !made.verdicts.empty()) << figure.name;
      for (const Table& table : made.tables) {
        EXPECT_GT(fs::file_size(draw(table)), 1000U) << table.name;
      }
    }
  }
}

// Every pair of characters that are special in gnuplot's strings, its enhanced text, a shell, or
// XML.
TEST_F(Plot, AnyTextIsDrawnAsItIs) {
  std::vector<std::string> texts = {
      "'",         "''",  "'a",         "a''b",       "'''",       "it's",      "a'",
      "\\",        "a\\", "\\U+0041 b", "\\101",      "\\n",       "&#x41;",    "&amp;",
      "a]]>b",     "]]>", "`echo hi`",  "$HOME",      "{/Bold x}", "@home",     "%s %d",
      "a_{b}^{c}", "#1",  "a,b",        "\"quoted\"", "ϕ ⟨δ⟩ €",   "a \u00a0 b"};
  const std::string special = "'\"\\_^@&{}~$#%`<>]U+;0x ";
  Table table{.name = "t", .columns = {}, .rows = {}, .chart = {}, .text = {.widths = {300}}};
  for (const std::string& text : texts) {
    table.chart.series.push_back({.title = text, .colour = "#000000", .points = {{1, 2}}});
  }
  const std::string keys = read_bytes(draw(table));
  for (const std::string& title : texts) {
    EXPECT_EQ(std::ranges::count(texts_of(keys), title), 1) << title;
  }
  EXPECT_NO_THROW(convert_to_pdf(folder_.path() / "t.svg")) << "a reader of XML";
  for (const char a : special) {
    for (const char b : special) texts.push_back({'(', a, b, ')'});
  }
  for (const std::string& text : texts) table.text.rows.push_back({{text}});
  table.text.note = "'the end'";
  const std::vector<std::string> drawn = texts_of(read_bytes(draw(table)));
  texts.emplace_back("'the end'");
  ASSERT_EQ(drawn.size(), texts.size());
  for (std::size_t k = 0; k < texts.size(); ++k) EXPECT_EQ(drawn[k], texts[k]);
  EXPECT_NO_THROW(convert_to_pdf(folder_.path() / "t.svg"));
}

/// Points of several series at each abscissa, whose error bars overlap; the range is that of the
/// data unless the axis ends before.
Table crowded(const Axis& y) {
  Table table{.name = "t", .columns = {}, .rows = {}, .chart = {.y = y}};
  table.chart.x = {.low = 0, .high = 6, .clip = true};
  table.chart.y.clip = true;
  for (int k = 0; k < 3; ++k) {
    Series& series = table.chart.series.emplace_back();
    series.title = fmt::format("series {}", k);
    series.colour = std::array{"#0072b2", "#d55e00", "#009e73"}.at(static_cast<std::size_t>(k));
    for (int x = 1; x <= 5; ++x) {
      const double at = x + 0.02 * k;
      series.points.push_back({at, 2 + 0.05 * k + 0.01 * x, std::nullopt, 0.2 + 0.14 * k});
    }
  }
  return table;
}

// gnuplot 5.4 paints a white disc behind each point of `yerrorbars`. A reaching bar of zero length,
// a point without a bar, and a bar that ends beyond the frame change nothing for the others.
TEST_F(Plot, EveryPointAndEndOfAnErrorBarIsVisible) {
  const Axis plain{.low = 1, .high = 3}, cut{.low = 1.8, .high = 2.5},
      logarithmic{.log = true, .low = 1.3, .high = 3.3};
  std::vector<Table> tables = {crowded(plain), crowded(cut), crowded(logarithmic), crowded(plain),
                               crowded(plain)};
  for (Series& series : tables[3].chart.series) series.points[2].y_error.reset();
  tables[3].chart.series[1].points[3].y_error = 0;
  tables[4].chart.wide = true;
  tables[4].chart.series[0].join = Join::line;
  for (const Table& table : tables) {
    const std::string svg = draw(table);
    EXPECT_EQ(read_bytes(svg).find("color='#FFFFFF'/>"), std::string::npos) << "a disc";
    const auto seen = look_at(svg);
    if (!seen || seen->code == 77) GTEST_SKIP() << "needs rsvg-convert and python3-pil";
    EXPECT_EQ(seen->code, 0) << seen->output << seen->messages;
    std::printf("%s", seen->output.c_str());
  }
}

// A logarithmic axis cannot show the end of such a bar; the other end is where it was.
TEST_F(Plot, AnErrorBarThatReachesZeroIsDrawnOnALogarithmicAxis) {
  Table table = crowded({.log = true, .low = 1.3, .high = 3.3});
  ChartPoint &one = table.chart.series[1].points[1], &other = table.chart.series[2].points[3];
  one.y = 1.5, one.y_error = 1.5;
  other.y = 1.6, other.y_error = 1.7;
  const std::string svg = draw(table);
  const auto seen = look_at(svg);
  if (!seen || seen->code == 77) GTEST_SKIP() << "needs rsvg-convert and python3-pil";
  EXPECT_EQ(seen->code, 0) << seen->output << seen->messages;
}

/// Programs of the test's own that stand before the real ones.
class FakeDrawing : public Plot {
 protected:
  /// `text` of sh may call "$real".
  void fake(const std::string& program, const std::string& text) {
    const auto real = find_program(program);
    if (!real) GTEST_SKIP() << program << " is not installed";
    fs::create_directories(programs_);
    write_script(programs_ / program, "#!/bin/sh\nreal=" + real->string() + "\n" + text);
    path_.emplace("PATH", programs_.string() + ":" + std::getenv("PATH"));
  }

  const fs::path programs_ = folder_.path() / "programs";
  std::optional<Variable> path_;
};

/// Draws into a file of its own and passes on what `filter` leaves of it.
std::string filtered(const std::string& filter) {
  return "sed \"s/^set output '.*/set output 'whole'/\" \"$2\" > own.gp; \"$real\" -d own.gp\n" +
         filter + " < whole > \"${2%.gp}.svg\"\n";
}

TEST_F(FakeDrawing, WhatGnuplotLeavesUnfinishedIsNoDrawing) {
  const Table table = s2(two_variants())[0];
  struct Case {
    std::string script;
    std::vector<std::string> says;
  };
  for (const auto& [script, says] : std::vector<Case>{
           {"echo no paper >&2; exit 3\n", {"ended with code 3", "no paper"}},
           {"kill -KILL $$\n", {"was ended by signal 9"}},
           {filtered("head -c 3000") + "kill -SEGV $$\n", {"was ended by signal 11"}},
           {"exit 0\n", {"wrote 0 bytes"}},
           {filtered("head -c 0"), {"wrote 0 bytes"}},
           {filtered("head -c 3000"), {"wrote 3000 bytes", "</svg>"}},
           {filtered("head -c -8"), {"</svg>"}},
           {filtered("tail -n +3"), {"<?xml"}},
           {"echo '<?xml version=\"1.0\"?><html>full</html>' > \"${2%.gp}.svg\"\n", {"</svg>"}},
           {filtered("cat") + "echo late >&2; exit 1\n", {"ended with code 1", "late"}}}) {
    path_.reset();
    draw(table);
    convert_to_pdf(folder_.path() / "S2a.svg");
    fake("gnuplot", script);
    const std::string message = trouble_with(table);
    EXPECT_TRUE(has(message, "gnuplot could not draw S2a.svg: it ")) << script;
    for (const std::string& part : says) EXPECT_TRUE(has(message, part)) << message;
    EXPECT_FALSE(fs::exists(folder_.path() / "S2a.pdf")) << "it shows other data";
  }
}

TEST_F(FakeDrawing, AWarningIsNoFailure) {
  const Table table = s2(two_variants())[0];
  const std::string whole = read_bytes(draw(table));
  fake("gnuplot", "echo 'warning: odd' >&2; exec \"$real\" \"$@\"\n");
  EXPECT_EQ(read_bytes(draw(table)), whole);
}

TEST_F(FakeDrawing, WhatLibrsvgLeavesUnfinishedIsNoDrawing) {
  const Table table = s2(two_variants())[0];
  struct Case {
    std::string script, says;
  };
  for (const auto& [script, says] :
       std::vector<Case>{{"echo no fonts >&2; exit 1\n", "ended with code 1:\nno fonts"},
                         {"kill -KILL $$\n", "was ended by signal 9"},
                         {"exit 0\n", "wrote 0 bytes"},
                         {"\"$real\" \"$@\" | head -c 2000\n", "wrote 2000 bytes"},
                         {"\"$real\" \"$@\" | head -c -4\n", "%%EOF"},
                         {"\"$real\" --format=png \"$2\"\n", "%PDF-"}}) {
    path_.reset();
    const fs::path svg = draw(table);
    convert_to_pdf(svg);
    fake("rsvg-convert", script);
    const std::string message = message_of<AnalysisError>([&] { convert_to_pdf(svg); });
    EXPECT_TRUE(has(message, "rsvg-convert could not draw S2a.pdf: it ")) << script;
    EXPECT_TRUE(has(message, says)) << message;
    EXPECT_FALSE(fs::exists(folder_.path() / "S2a.pdf"));
    EXPECT_TRUE(fs::exists(svg));
  }
}

TEST_F(Plot, ReportsTheErrorOfGnuplot) {
  Table table = s2(two_variants())[0];
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

}  // namespace
}  // namespace shearcell::test
