// SPDX-License-Identifier: GPL-3.0-or-later
// Curves: their names and styles, where their means end; plots and claims of a manifest.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "analysis/figure.hpp"
#include "analysis/plots.hpp"
#include "provenance/errors.hpp"
#include "tests/analysis/made_up_runs.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

/// Runs of a sweep of drag and fluid, named as the program names them.
std::vector<FrameRun> two_parameters(const std::vector<double>& drags = {0.001, 0.002, 0.004}) {
  std::vector<FrameRun> runs;
  for (const char* fluid : {"still", "cell"}) {
    for (const double drag : drags) {
      for (const std::uint64_t seed : {1U, 2U, 3U}) {
        FrameRun run = rising_run(fluid, seed, 3, 1000 * drag + 0.001 * static_cast<double>(seed));
        run.place.swept["drag_kg_per_s"] = drag;
        run.place.variant = fmt::format("fluid={},drag_kg_per_s={}", fluid, drag);
        run.name = fmt::format("fluid={}, b={} kg/s", fluid, drag);
        run.stage.id = fmt::format("{}/{}", run.place.variant, seed);
        runs.push_back(std::move(run));
      }
    }
  }
  return runs;
}

/// The number of different styles.
std::size_t looks(const Table& table) {
  std::set<std::tuple<std::string, int, Join>> different;
  for (const Series& one : table.chart.series) different.emplace(one.colour, one.point, one.join);
  return different.size();
}

TEST(Curves, AreNamedAndStyledByWhatVaries) {
  const Table table = s2(two_parameters())[0];
  std::set<std::string> titles;
  for (const Series& one : table.chart.series) titles.insert(plain_text(one.title));
  EXPECT_EQ(titles.size(), 6U);
  EXPECT_TRUE(titles.contains("fluid=cell, b=0.002 kg/s"));
  EXPECT_EQ(looks(table), 6U);
  const Verdict phi = find_figure("S2")->make(two_parameters()).verdicts.at(0);
  EXPECT_TRUE(has(phi.note, "18 of 18 runs end too early for cycles 1 to 15"))
      << phi.note << ": of three drags";
}

/// The key of a drawing: the titles of its series.
std::vector<std::string> key_of(Table table) {
  const std::string numbers = to_csv(table);
  name_run_counts(table);
  EXPECT_EQ(to_csv(table), numbers);
  std::vector<std::string> titles;
  for (const Series& one : table.chart.series) titles.push_back(plain_text(one.title));
  return titles;
}
using Key = std::vector<std::string>;

/// Five runs of ten cycles in each fluid.
std::vector<FrameRun> ten_runs() {
  std::vector<FrameRun> runs;
  for (const char* fluid : {"cell", "still"}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      runs.push_back(rising_run(fluid, seed, 10, 0.0001 * static_cast<double>(seed)));
    }
  }
  return runs;
}

/// Removes checkpoints of the run, as if nobody had measured them before a prune.
void remove_where(FrameRun& run, const std::function<bool(double cycle)>& removed) {
  std::erase_if(run.checkpoints, [&](const auto& c) { return removed(c.cycle); });
}

TEST(Curves, TheKeySaysWhereTheNumberOfRunsChanges) {
  const std::vector<PlotSpec> plots = {
      {.name = "own", .columns = {{"phi"}}},
      {.name = "own", .columns = {{"phi"}}, .x = "mean_overlap_d"},
      {.name = "own", .columns = {{"phi"}}, .x = "cycle", .by = "fluid"}};
  const auto keys = [&](const std::vector<FrameRun>& runs) {
    std::vector<Key> found = {key_of(s2(runs).at(0)), key_of(s2(runs).at(1)),
                              key_of(find_figure("walls")->make(runs).tables.at(0))};
    for (const PlotSpec& plot : plots) {
      found.push_back(key_of(plot_figure(plot).make(runs).tables.at(0)));
    }
    return found;
  };
  std::vector<FrameRun> runs = ten_runs();
  for (const Key& key : keys(runs)) {
    for (const std::string& title : key) EXPECT_FALSE(has(title, "runs")) << title;
  }
  std::vector<FrameRun> clones = runs;  // a mean over one packing
  for (FrameRun& run : clones) run.packing = "of all";
  for (const Table& table : s2(clones)) {
    for (const std::string& title : key_of(table)) EXPECT_FALSE(has(title, "runs")) << title;
    for (const TableRow& row : table.rows) EXPECT_EQ(row.back(), TableCell(std::size_t{1}));
  }
  for (const std::size_t k : {0U, 1U}) {
    remove_where(runs[k], [](double cycle) { return cycle >= 3 && cycle <= 5; });
  }
  for (const Key& key : keys(runs)) {
    ASSERT_EQ(key.size(), 2U);
    EXPECT_EQ(std::ranges::count_if(key, [](auto& t) { return has(t, "(3 to 5 runs)"); }), 1);
    EXPECT_EQ(std::ranges::count_if(key, [](auto& t) { return has(t, "runs"); }), 1);
  }
}

TEST(Curves, TheKeySaysWhereDifferentRunsAreAsMany) {
  std::vector<FrameRun> runs = ten_runs();
  runs = {runs[0], runs[1]};
  remove_where(runs[0], [](double cycle) { return std::fmod(cycle, 2) == 1; });
  remove_where(runs[1], [](double cycle) { return std::fmod(cycle, 2) == 0 && cycle < 10; });
  EXPECT_TRUE(has(key_of(s2(runs)[0]).at(0), "(1 to 2 runs)")) << "cycle 10 is of both";
  remove_where(runs[0], [](double cycle) { return cycle == 10; });
  remove_where(runs[1], [](double cycle) { return cycle > 8; });
  runs[0].checkpoints.back().cycle = runs[1].checkpoints.back().cycle = 7.5;  // no cycle's end
  EXPECT_TRUE(has(key_of(s2(runs)[0]).at(0), "(1 of 2 runs)")) << key_of(s2(runs)[0]).at(0);
}

// Runs that `until` ends: the mean ends with the first of them.
TEST(Curves, TheKeyIsSilentWhereAMeanEndsWithTheFirstRun) {
  std::vector<FrameRun> runs = ten_runs();
  for (std::size_t k = 0; k < 5; ++k) {
    remove_where(runs[k], [&](double cycle) { return cycle > 5 + static_cast<double>(k); });
  }
  for (const std::string& title : key_of(s2(runs)[0])) EXPECT_FALSE(has(title, "runs")) << title;
  remove_where(runs[4], [](double cycle) { return cycle == 2; });
  EXPECT_EQ(
      std::ranges::count_if(key_of(s2(runs)[0]), [](auto& t) { return has(t, "(4 to 5 runs)"); }),
      1);
}

TEST(Curves, TheKeyCountsRunsThatHaveTheMeasure) {
  std::vector<FrameRun> runs = ten_runs();
  for (CheckpointMeasures& c : runs[0].checkpoints) c.measures.numbers["phi"] = std::nan("");
  const Key key =
      key_of(plot_figure({.name = "own", .columns = {{"phi"}}}).make(runs).tables.at(0));
  EXPECT_EQ(std::ranges::count_if(key, [](auto& t) { return has(t, "(4 of 5 runs)"); }), 1);
}

TEST(Curves, TheKeyCountsRunsAtEachParameterAndOfEachCurve) {
  std::vector<FrameRun> runs = two_parameters();
  const PlotSpec by_drag = {.name = "own", .columns = {{"phi"}}, .x = "drag_kg_per_s"};
  const auto key = [&](const PlotSpec& plot) {
    return key_of(plot_figure(plot).make(runs).tables.at(0));
  };
  for (const std::string& title : key(by_drag)) EXPECT_FALSE(has(title, "runs")) << title;
  runs.erase(runs.begin());  // of three runs with this fluid and drag
  EXPECT_EQ(std::ranges::count_if(key(by_drag), [](auto& t) { return has(t, "(2 to 3 runs)"); }),
            1);
  for (FrameRun& run : runs) {
    for (CheckpointMeasures& c : run.checkpoints) {
      c.measures.curves["phi_profile"] = {{0.5, 1.5}, {0.6, 0.6}};
    }
  }
  remove_where(runs[0], [](double cycle) { return cycle == 2; });
  const PlotSpec profile = {.name = "own", .columns = {{"phi_profile"}}, .cycle = 2};
  EXPECT_EQ(std::ranges::count_if(key(profile), [](auto& t) { return has(t, "(1 of 2 runs)"); }),
            1);
  const std::string variant = runs[0].place.variant;
  std::erase_if(runs, [&](const FrameRun& run) { return run.place.variant != variant; });
  EXPECT_EQ(key(profile), Key{"1 of 2 runs"}) << "a single curve has no other title";
}

TEST(Curves, LookTheSameWhereColoursAndSymbolsRepeat) {
  std::vector<double> drags;
  for (std::size_t k = 1; k <= 140; ++k) drags.push_back(0.001 * static_cast<double>(k));
  std::vector<FrameRun> runs = two_parameters(drags);
  std::erase_if(runs, [](const FrameRun& run) { return run.place.swept["fluid"] == "cell"; });
  const Table table = s2(runs)[0];
  EXPECT_EQ(looks(table), 70U);
  EXPECT_TRUE(table.chart.note.starts_with("Some curves look the same")) << table.chart.note;
}

TEST(Curves, HaveStylesOfTheirOwnWhereManyValuesVary) {
  for (const std::size_t values : {8U, 12U, 30U}) {
    std::vector<double> drags;
    for (std::size_t k = 1; k <= values; ++k) drags.push_back(0.001 * static_cast<double>(k));
    std::vector<FrameRun> runs = two_parameters(drags);
    EXPECT_EQ(looks(s2(runs)[0]), 2 * values);
    std::erase_if(runs, [](const FrameRun& run) { return run.place.swept["fluid"] == "cell"; });
    EXPECT_EQ(looks(s2(runs)[0]), values);
  }
}

// `run --engine lammps` adds runs to an experiment; its claims are on the runs that it states.
TEST(Curves, AnotherEnginesRunsChangeNoVerdict) {
  std::vector<FrameRun> runs = two_variants();
  const nlohmann::json before = to_json(find_figure("S2")->make(runs).verdicts);
  runs.push_back(runs.back());
  runs.back().place.swept["engine"] = "lammps";
  runs.back().place.variant += ",engine=lammps";
  EXPECT_EQ(to_json(find_figure("S2")->make(runs).verdicts), before);
  EXPECT_EQ(s2(runs)[0].chart.series.size(), s2(two_variants())[0].chart.series.size() + 1);
}

TEST(Curves, KeepTheStylesOfTheSupplementForItsOwnVariants) {
  std::vector<FrameRun> runs = two_variants();
  runs[0].name = "fluid=cell", runs[1].name = runs[2].name = "fluid=still";
  EXPECT_EQ(plain_text(s2(runs)[0].chart.series.at(0).title), "v_fluid = 0");
  runs[1].name = runs[2].name = "water at rest";
  runs[1].named = runs[2].named = true;
  const Series still = s2(runs)[0].chart.series.at(0);
  EXPECT_EQ(plain_text(still.title), "water at rest") << "a label of the manifest";
  EXPECT_EQ(still.point, 9) << "the supplement's symbol";
}

TEST(Curves, NeverShareALabel) {
  std::vector<FrameRun> runs = two_parameters();
  for (FrameRun& run : runs) run.name = "the same";
  const std::string message = message_of<AnalysisError>([&] { s2(runs); });
  EXPECT_TRUE(has(message, "in `series` of the plot or in `labels`")) << message;
}

TEST(Curves, EndTheirMeanWithTheFirstRunThatEnds) {
  const std::vector<FrameRun> whole = {rising_run("still", 1, 6, 0),
                                       rising_run("still", 2, 6, 0.01)};
  const Table before = find_figure("S2")->make(whole).tables.at(0);
  ASSERT_EQ(before.chart.series.size(), 1U);
  EXPECT_EQ(points_of(before.chart.series[0]).size(), 7U);
  EXPECT_TRUE(before.chart.note.empty());

  std::vector<FrameRun> runs = whole;
  runs[1].checkpoints.resize(5);  // up to cycle 4
  const Table table = find_figure("S2")->make(runs).tables.at(0);
  EXPECT_EQ(table.rows.size(), before.rows.size()) << "the numbers of those that are left";
  ASSERT_EQ(table.chart.series.size(), 2U) << "the mean and the run that continues";
  const std::vector<ChartPoint> mean = points_of(table.chart.series[0]);
  const std::vector<ChartPoint> rest = points_of(table.chart.series[1]);
  const std::vector<ChartPoint> all = points_of(before.chart.series[0]);
  ASSERT_EQ(mean.size(), 5U);
  for (std::size_t n = 0; n < mean.size(); ++n) {
    EXPECT_EQ(mean[n].x, static_cast<double>(n));
    EXPECT_NEAR(mean[n].y, all[n].y, 1e-9);
    EXPECT_NEAR(mean[n].y_error.value(), all[n].y_error.value(), 1e-9);
  }
  ASSERT_EQ(rest.size(), 3U);
  for (std::size_t n = 0; n < rest.size(); ++n) {
    EXPECT_EQ(rest[n].x, static_cast<double>(4 + n));
    EXPECT_EQ(rest[n].y, runs[0].checkpoints[4 + n].measures.numbers["phi"]);
  }
  EXPECT_TRUE(table.chart.series[1].thin);
  EXPECT_TRUE(table.chart.series[1].title.empty());
  const std::vector<Table> tables = {table};
  EXPECT_TRUE(has(caption_of("A title", tables), " Thin lines: single runs, "));
}

TEST(OwnPlot, DrawsAMeasureAgainstCycleMeasureOrParameter) {
  const std::vector<FrameRun> runs = two_parameters();
  const auto table = [&](const PlotSpec& plot) {
    return plot_figure(plot).make(runs).tables.at(0);
  };
  EXPECT_EQ(table({.name = "own", .columns = {{"phi"}}}).rows.size(), 6U * 4U);
  EXPECT_EQ(table({.name = "own", .columns = {{"crystalline_percent"}}, .x = "phi"}).columns.at(1),
            "phi_low");
  EXPECT_EQ(table({.name = "own", .columns = {{"phi"}}, .x = "mean_overlap_d"}).columns.at(4),
            "mean_overlap_mean_d");
  const Table drag = table({.name = "own", .columns = {{"phi"}}, .x = "drag_kg_per_s", .cycle = 2});
  EXPECT_TRUE(
      to_csv(drag).starts_with("variant,drag_kg_per_s,phi_mean,phi_standard_error,runs,cycle\n"
                               "fluid=cell,0.001,1.6225,0.000577350269,3,2\n"))
      << to_csv(drag);
  EXPECT_EQ(drag.chart.series.size(), 2U) << "a curve for each fluid";
  const Table traces = table({.name = "own", .columns = {{"phi"}}, .show = Show::traces});
  EXPECT_EQ(traces.chart.series.size(), 18U) << "every run";
  EXPECT_EQ(
      std::ranges::count_if(traces.chart.series, [](const Series& s) { return !s.title.empty(); }),
      6)
      << "each variant once in the key";
  EXPECT_TRUE(table({.name = "own", .columns = {{"phi"}}, .log = LogAxes::y}).chart.y.log);
  const PlotSpec by_fluid{.name = "own", .columns = {{"phi"}}, .by = "fluid"};
  EXPECT_THROW(table(by_fluid), UsageError) << "it would average over the drags";
  EXPECT_EQ(plot_figure(by_fluid).make(two_variants()).tables.at(0).chart.series.size(), 2U);
}

TEST(OwnPlot, DrawsEachOfSeveralColumnsLikeTheFirst) {
  const auto table = [](const std::vector<FrameRun>& runs, Show show,
                        const nlohmann::json& minus = nlohmann::json::object()) {
    const PlotSpec plot{.name = "own",
                        .columns = {{"phi"}, {"100*phi", "hundredfold"}},
                        .drawn = 2,
                        .minus = minus,
                        .show = show};
    return plot_figure(plot).make(runs).tables.at(0);
  };
  const auto is_hundredfold = [](const Series& of_phi, const Series& other) {
    const std::vector<ChartPoint> a = points_of(of_phi), b = points_of(other);
    return a.size() > 1 && std::ranges::equal(a, b, [](const ChartPoint& p, const ChartPoint& q) {
             return p.x == q.x && std::abs(q.y - 100 * p.y) < 1e-7;
           });
  };
  std::vector<FrameRun> runs = {rising_run("still", 1, 6, 0), rising_run("still", 2, 6, 0.01)};
  runs[1].checkpoints.resize(5);  // up to cycle 4

  for (const Show show : {Show::traces, Show::scatter}) {
    const Table each = table(runs, show);
    EXPECT_TRUE(to_csv(each).starts_with("variant,seed,cycle,phi,hundredfold\n")) << to_csv(each);
    EXPECT_NEAR(std::get<double>(each.rows.at(3).at(4)),
                100 * std::get<double>(each.rows.at(3).at(3)), 1e-9);
    const std::vector<Series>& drawn = each.chart.series;  // two runs, then the other column
    ASSERT_EQ(drawn.size(), 4U);
    EXPECT_TRUE(is_hundredfold(drawn[0], drawn[2]) && is_hundredfold(drawn[1], drawn[3]));
    EXPECT_NE(drawn[0].colour, drawn[2].colour);
    EXPECT_EQ(plain_text(drawn[2].title), "hundredfold");
    EXPECT_TRUE(drawn[3].title.empty());
  }
  for (const Show show : {Show::mean, Show::rms}) {
    const Table mean = table(runs, show);
    const std::vector<Series>& drawn = mean.chart.series;  // two means, then the run that continues
    ASSERT_EQ(drawn.size(), 4U);
    EXPECT_TRUE(is_hundredfold(drawn[0], drawn[1])) << "both end with the shorter run";
    EXPECT_TRUE(is_hundredfold(drawn[2], drawn[3])) << "both continue";
    EXPECT_EQ(has(to_csv(mean), "hundredfold_rms"), show == Show::rms);
  }

  std::vector<FrameRun> pairs = {rising_run("still", 1, 6, 0), rising_run("cell", 1, 6, 0.01),
                                 rising_run("still", 2, 6, 0), rising_run("cell", 2, 6, 0.03)};
  for (FrameRun& run : pairs) run.packing = fmt::format("{}", run.place.seed);
  const Table less = table(pairs, Show::mean, {{"fluid", "still"}});
  EXPECT_TRUE(has(to_csv(less), "phi_difference_mean,")) << to_csv(less);
  EXPECT_TRUE(has(to_csv(less), "hundredfold_difference_mean,")) << to_csv(less);
  EXPECT_TRUE(is_hundredfold(less.chart.series.at(0), less.chart.series.at(1)));
  EXPECT_NEAR(points_of(less.chart.series.at(1)).at(2).y, 2, 1e-7);

  const Table several = table(two_parameters(), Show::traces);
  EXPECT_EQ(several.chart.series.size(), 36U);
  EXPECT_EQ(looks(several), 12U) << "the columns of a curve differ in symbol";
}

TEST(OwnPlot, NamesTheUnitOfAnAxisOnce) {
  const std::vector<FrameRun> runs = two_parameters();
  const auto x_axis = [&](const char* x, const char* unit) {
    const PlotSpec plot{.name = "own", .columns = {{"phi"}}, .x = x, .x_unit = unit};
    const Axis axis = plot_figure(plot).make(runs).tables.at(0).chart.x;
    return plain_text(axis.name) + " [" + plain_text(axis.unit) + "]";
  };
  EXPECT_EQ(x_axis("pause_s", "s"), "pause [s]");
  EXPECT_EQ(x_axis("shear_rate_per_s", ""), "shear rate [1/s]");
  EXPECT_EQ(x_axis("msd_1_cycle_d2", ""), "msd 1 cycle [d²]");
  EXPECT_EQ(x_axis("max_overlap_diameters", "d"), "max overlap diameters []");
}

TEST(OwnPlot, AgainstAParameterComparesTheLastCycleThatAllRunsHave) {
  std::vector<FrameRun> runs = two_parameters();
  runs.front().checkpoints.pop_back();
  const auto result =
      plot_figure({.name = "own", .columns = {{"phi"}}, .x = "drag_kg_per_s"}).make(runs);
  const Table& table = result.tables.at(0);
  ASSERT_EQ(table.columns.back(), "cycle");
  for (const TableRow& row : table.rows) EXPECT_EQ(row.back(), TableCell(2.0));
  EXPECT_TRUE(has(caption_of("A title", result.tables),
                  "At cycle 2, the last one that all runs have recorded."));
}

TEST(OwnPlot, AtACycleNeedsThatCycleAlone) {
  using Cycles = std::array<std::uint64_t, 2>;
  EXPECT_EQ(
      plot_figure({.name = "own", .columns = {{"phi"}}, .x = "drag_kg_per_s", .cycle = 2}).within,
      Cycles({2, 2}));
  EXPECT_EQ(plot_figure({.name = "own", .columns = {{"phi_profile"}}, .cycle = 2}).within,
            Cycles({2, 2}));
  EXPECT_EQ(plot_figure({.name = "own", .columns = {{"phi"}}}).within, std::nullopt);
}

TEST(OwnPlot, AgainstOneKeyOfAZipIsOneCurve) {
  std::vector<FrameRun> runs;
  for (const double drag : {0.001, 0.002}) {
    runs.push_back(rising_run("still", 1, 3, drag));
    runs.back().place.swept = {{"amplitude_rad", 50 * drag}, {"drag_kg_per_s", drag}};
  }
  for (const char* x : {"amplitude_rad", "drag_kg_per_s"}) {
    const auto result = plot_figure({.name = "own", .columns = {{"phi"}}, .x = x}).make(runs);
    EXPECT_EQ(result.tables.at(0).chart.series.size(), 1U) << x;
  }
}

/// A crystallite grows by one grain a cycle from `first` on.
FrameRun crystallizing(double drag, std::uint64_t seed, int first, int cycles) {
  FrameRun run = made_up_run("drag_kg_per_s", drag, seed, cycles, [=](int n, Measures& m) {
    m.numbers["phi"] = 0.6 + 0.001 * n;
    m.numbers["largest_crystallite"] = std::max(0, n - first);
  });
  return run;
}

TEST(OwnPlot, OfTheOnsetOfEachRunWithAClaim) {
  std::vector<FrameRun> runs;  // the critical size is 16 grains
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    runs.push_back(crystallizing(0.001, seed, 2 * static_cast<int>(seed), 60));
    runs.push_back(crystallizing(0.002, seed, 2 * static_cast<int>(seed) + 20, 60));
  }
  runs.push_back(crystallizing(0.002, 5, 20, 30));
  const auto drawn =
      plot_figure({.name = "own", .columns = {{"onset_size_phi"}}, .x = "drag_kg_per_s"})
          .make(runs);
  EXPECT_TRUE(to_csv(drawn.tables.at(0))
                  .starts_with("variant,drag_kg_per_s,onset_size_phi_mean,"
                               "onset_size_phi_standard_error,runs,runs_ended_before,"
                               "runs_began_after,runs_unclear\nall,0.001,0.621,"))
      << to_csv(drawn.tables.at(0));
  EXPECT_TRUE(has(caption_of("", drawn.tables),
                  "1 of 9 runs end before the onset; the means use their censored values"));
  // An expression is averaged like the measure: a hundred times as much.
  const auto hundredfold =
      plot_figure({.name = "own", .columns = {{"100*onset_size_phi"}}, .x = "drag_kg_per_s"})
          .make(runs);
  for (std::size_t k = 0; k < 2; ++k) {
    const TableRow &of_phi = drawn.tables.at(0).rows.at(k),
                   &of_expression = hundredfold.tables.at(0).rows.at(k);
    EXPECT_NEAR(std::get<double>(of_expression.at(2)), 100 * std::get<double>(of_phi.at(2)), 1e-5);
    EXPECT_EQ(of_expression.at(4), of_phi.at(4)) << "runs, with the censored one";
  }
  EXPECT_TRUE(has(caption_of("", hundredfold.tables),
                  "1 of 9 runs end before the onset; the means use their censored values"));
  ClaimSpec claim{.id = "own",
                  .compare = "onset_size_phi",
                  .between = {{{{"drag_kg_per_s", 0.002}}, {{"drag_kg_per_s", 0.001}}}},
                  .margin = 0.001};
  const Verdict phi = claim_figure(claim).make(runs).verdicts.at(0);
  EXPECT_NEAR(phi.estimate.value().value, 0.02, 1e-8) << "a run ends far before its onset";
  EXPECT_EQ(phi.censored, 1U);
  EXPECT_TRUE(has(to_csv(entered_table({{phi}})), ",ends before,0.63"));
  EXPECT_EQ(phi.ruling, Ruling::differs);
  claim.compare = "onset_size_cycle";
  const Verdict cycle = claim_figure(claim).make(runs).verdicts.at(0);
  EXPECT_TRUE(has(cycle.note, "(1 of 5 runs end before the event)"));
}

TEST(OwnPlot, NamesTheStepsOfAStiffening) {
  std::vector<FrameRun> runs = two_parameters();
  const auto x_name = [&] {
    const Table table = plot_figure({.name = "own", .columns = {{"phi"}}}).make(runs).tables.at(0);
    return plain_text(table.chart.x.name);
  };
  EXPECT_EQ(x_name(), "shear cycle");
  for (FrameRun& run : runs) {
    run.checkpoints.front().measures.numbers["raised_stiffness_N_per_m"] = 654;
    EXPECT_EQ(x_name(),
              &run == &runs.back() ? "step of the stiffening" : "cycle or step of the stiffening");
  }
}

TEST(OwnPlot, OfRunsThatEndBeforeItsCycleIsEmpty) {
  const std::vector<FrameRun> runs = {rising_run("still", 1, 3, 0)};
  for (const char* y : {"phi", "pair_correlation"}) {
    const Table table = plot_figure({.name = "own",
                                     .columns = {{y}},
                                     .x = "amplitude_rad",
                                     .show = Show::traces,
                                     .cycle = 99})
                            .make(runs)
                            .tables.at(0);
    EXPECT_TRUE(table.rows.empty() && table.chart.series.empty()) << y;
  }
}

TEST(OwnClaim, IsDecidedLikeThoseOfTheSupplement) {
  ClaimSpec claim{.id = "own", .compare = "phi", .cycles = {{1, 2}}, .between = {}, .margin = 0.5};
  const nlohmann::json soft = {{"fluid", "still"}, {"drag_kg_per_s", 0.001}};
  const nlohmann::json hard = {{"fluid", "still"}, {"drag_kg_per_s", 0.004}};
  const auto verdict = [&] { return claim_figure(claim).make(two_parameters()).verdicts.at(0); };
  claim.between = {soft, hard};
  EXPECT_EQ(verdict().ruling, Ruling::differs) << "they are 3 apart";
  EXPECT_NEAR(verdict().estimate.value().value, -3, 1e-9);
  claim.between = {hard, soft};
  claim.is = Relation::higher;
  EXPECT_EQ(verdict().ruling, Ruling::supported);
  EXPECT_EQ(verdict().entered.rows.size(), 2 * verdict().runs) << "each run of both sides";
  EXPECT_EQ(verdict().text,
            "own: phi, mean over cycles 1 to 2 is higher by more than 0.5 for fluid=still, b=0.004 "
            "kg/s than for fluid=still, b=0.001 kg/s")
      << "names for people";
  claim.between = {nlohmann::json{{"fluid", "still"}}, hard};
  EXPECT_THROW(verdict(), UsageError) << "three variants";
  claim.between = {hard, nlohmann::json{{"drag_kg_per_s", 0.004}, {"fluid", "still"}}};
  EXPECT_THROW(verdict(), UsageError) << "the same runs";
  claim.between = {hard, nlohmann::json{{"drag_kg_per_s", 0.008}}};
  EXPECT_EQ(verdict().ruling, Ruling::undecided);
  EXPECT_EQ(verdict().note, "no run with drag_kg_per_s=0.008 has a checkpoint of cycles 1 to 2");
}

}  // namespace
}  // namespace shearcell::test
