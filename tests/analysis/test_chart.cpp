// SPDX-License-Identifier: GPL-3.0-or-later
// The gnuplot script and the report's chart show the numbers of the table.
#include "analysis/chart.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include <limits>
#include <sstream>

#include "analysis/figure.hpp"
#include "analysis/plot.hpp"
#include "provenance/errors.hpp"
#include "tests/analysis/made_up_runs.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

Table table_with(std::vector<TableRow> rows, Chart chart) {
  return {.name = "t",
          .columns = {"variant", "cycle", "phi", "error"},
          .rows = std::move(rows),
          .chart = std::move(chart)};
}

TEST(Chart, LeavesOutPointsWithoutANumber) {
  const double none = std::nan("");
  EXPECT_EQ(points_of({.points = {{1, none}, {none, 2}, {3, 4}}}).size(), 1U);
}

TEST(Chart, HasFifteenDigits) {
  const Table table = table_with(
      {}, {.x = {.name = "x", .symbol = formula("$n$"), .unit = "s", .low = 0},
           .y = {.name = "y", .log = true},
           .series = {{.title = "t", .colour = "#123456", .points = {{1.0 / 3, 2, {}, 0.25}}}},
           .lines = {{0.646}}});
  EXPECT_EQ(
      chart_json(table).dump(),
      R"({"lines":[{"at":0.646,"colour":"#888888","stub":false,"vertical":false}],)"
      R"("series":[{"band":false,"colour":"#123456","dashed":false,"line":false,"point":7,)"
      R"("points":[[0.333333333333333,2.0,null,0.25]],"shift":0.0,"title":[["t",""]]}],"title":[],)"
      R"("x":{"clip":false,"high":null,"label":[["x",""],["  ",""],["n","i"]],"log":false,)"
      R"("low":0.0,"unit":[["s",""]],"whole":false},)"
      R"("y":{"clip":false,"high":null,"label":[["y",""]],"log":true,"low":null,"unit":[],)"
      R"("whole":false}})");
}

// Values that differ by little beside their size are no steps: each is printed so that its
// difference from the least has at least four digits. Rounding errors are not printed.
TEST(Chart, PrintsDigitsThatShowTheSpread) {
  constexpr int rows = 50;
  const auto field = [](const std::string& line, std::size_t number) {
    std::istringstream fields(line);
    std::string text;
    for (std::size_t k = 0; k <= number; ++k) std::getline(fields, text, ',');
    return text;
  };
  for (const auto& [offset, scale] :
       {std::pair{1.0, 1e-7}, {-1.0, 1e-11}, {1e6, 1e-3}, {0.64, 1.0}, {0.0, 1e-20}}) {
    const auto value = [&, offset = offset, scale = scale](int k) {
      return offset + scale * std::sin(k);
    };
    std::vector<TableRow> table;
    Series series;
    for (int k = 0; k < rows; ++k) {
      series.points.push_back({static_cast<double>(k), value(k)});
      table.push_back({std::string("a"), std::int64_t{k}, value(k),
                       0.1 + (k % 2) * std::numeric_limits<double>::epsilon() / 8});
    }
    const Table figure = table_with(table, {.series = {series}});
    const nlohmann::json points = chart_json(figure)["series"][0]["points"];
    const std::string script = gnuplot_script(figure);
    std::istringstream csv(to_csv(figure)), data(script.substr(script.find("EOD\n") + 4));
    std::string line, drawn;
    std::getline(csv, line);
    for (int k = 0; k < rows; ++k) {
      std::getline(csv, line);
      std::getline(data, drawn);
      const double spread = 2 * scale;
      EXPECT_NEAR(std::stod(field(line, 2)), value(k), 1e-4 * spread) << line;
      EXPECT_NEAR(std::stod(field(drawn, 1)), value(k), 1e-4 * spread) << drawn;
      if (scale > 1e-9) {
        EXPECT_NEAR(points[static_cast<std::size_t>(k)][1].get<double>(), value(k), 1e-4 * spread);
      }
      EXPECT_EQ(field(line, 3), "0.1");
    }
  }
}

// The script and the chart come from one description: what one shows, the other shows too.
TEST(GnuplotScript, StatesEverySeriesLineAndLabel) {
  const Table table = table_with(
      {{std::string("it's"), std::int64_t{1}, 0.5, 0.1},
       {std::string("b"), std::int64_t{2}, 0.6, {}}},
      {.x = {.name = "shear cycle", .symbol = formula("$n$"), .whole = true},
       .y = {.name = "a_b", .unit = "%", .low = 0},
       .series = {{.title = formula("$ϕ_u$"),
                   .colour = "#123456",
                   .join = Join::line,
                   .variant = "it's",
                   .points = {{1, 0.5, {}, 0.1}}},
                  {.title = "experiment", .colour = "#654321", .points = {{1, 0.25}}, .shift = 0.5},
                  {.title = "nothing", .colour = "#000000", .point = 4}},
       .lines = {{0.1}, {2, true, true}}});
  const std::string script = gnuplot_script(table);
  for (const char* part :
       {"set xlabel 'shear cycle  {/:Italic n}'\n", "set xtics 1\n", "set ylabel 'a\\_b  [%]'\n",
        "set yrange [0:0.625]\n", "$series0 << EOD\n1,0.5,,0.1\nEOD\n",
        "$series1 << EOD\n1.5,0.25,,\nEOD\n",
        "$series0 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads",
        "title '{/:Italic ϕ}_{u}'", "$series1 every 1 using 1:2 with points lc rgb '#654321'",
        "keyentry with points lc rgb '#000000' lw 1.2 pt 4", "first 0.1 to graph 1, first 0.1",
        "from 2, graph 0 to 2, graph 0.06"}) {
    EXPECT_TRUE(has(script, part));
  }
}

TEST(GnuplotScript, LongTitlesTakeTwoColumns) {
  const auto script_for = [](const std::string& title) {
    return gnuplot_script(table_with({}, {.series = {{.title = title}}}));
  };
  EXPECT_TRUE(has(script_for("no gravity"), "size 325,230 "));
  EXPECT_TRUE(
      has(script_for("b=0.00256 kg/s, g=9.81 m/s^2, P=1908 Pa, A=0.0667 rad"), "size 673,230 "));
  EXPECT_TRUE(has(gnuplot_script(table_with({}, {})), "size 325,215 "));
}

// "0.70" beside "0.75"; about five steps.
TEST(GnuplotScript, TicksHaveOneNumberOfDecimals) {
  const auto script_for = [](double low, double high) {
    return gnuplot_script({.name = "t",
                           .columns = {},
                           .rows = {},
                           .chart = {.series = {{.points = {{low, 1}, {high, 2}}}}}});
  };
  EXPECT_TRUE(has(script_for(0.64, 0.71), "set xtics 0.01\nset format x '%.2f'"));
  EXPECT_TRUE(has(script_for(0.6, 0.9), "set xtics 0.05\nset format x '%.2f'"));
  EXPECT_TRUE(has(script_for(0, 20), "set xtics 5\nset format x '%.0f'"));
}

TEST(GnuplotScript, RangesAndTicksHoldHorizontalLines) {
  const auto script_for = [](std::vector<ReferenceLine> lines, bool log) {
    return gnuplot_script({.name = "t",
                           .columns = {},
                           .rows = {},
                           .chart = {.y = {.log = log},
                                     .series = {{.points = {{1, 0.62}, {2, 0.63}}}},
                                     .lines = std::move(lines)}});
  };
  const std::string linear = script_for({{0.739}, {0.741}}, false);
  EXPECT_TRUE(has(linear, "set ytics 0.02\nset format y '%.2f'")) << linear;
  EXPECT_TRUE(has(linear, "set yrange [0.61395:0.74705]")) << linear;
  const std::string log = script_for({{0.03}, {-1}}, true);
  EXPECT_TRUE(has(log, "set yrange [0.02576")) << log;
  EXPECT_TRUE(has(log, "set ytics (0.05,0.1,0.2,0.5)")) << log;
  EXPECT_FALSE(has(log, "first -1")) << log;
  EXPECT_TRUE(has(script_for({}, true), "set yrange [*:*]\nset offsets graph 0.03"));
}

// A label takes 6 pixels a letter and a gap of 8, and the frame has 260.
TEST(GnuplotScript, TickLabelsBelowTheFrameDoNotTouch) {
  for (const double low : {0.636, 0.64013, -0.0021}) {
    for (double length = 0.0011; length < 0.01; length *= 1.07) {
      const std::string text =
          gnuplot_script({.name = "t",
                          .columns = {},
                          .rows = {},
                          .chart = {.series = {{.points = {{low, 1}, {low + length, 2}}}}}});
      const double step = std::stod(text.substr(text.find("set xtics 0.") + 10));
      const int decimals = std::stoi(text.substr(text.find("set format x '%.") + 16));
      const double label = 6 * (2 + decimals + (low < 0 ? 1 : 0)) + 8;
      EXPECT_LT(length / step * label, 260) << low << " " << length;
      EXPECT_GE(length / step, 1) << low << " " << length;
    }
  }
}

// gnuplot alone would label none of these.
TEST(GnuplotScript, LogarithmicAxesWithFewPowersOfTenHaveTicks) {
  const auto script_for = [](double low, double high) {
    return gnuplot_script(
        {.name = "t",
         .columns = {},
         .rows = {},
         .chart = {.x = {.log = true}, .series = {{.points = {{0, 3}, {low, 1}, {high, 2}}}}}});
  };
  EXPECT_TRUE(has(script_for(0.0032, 0.0041), "set xtics (0.0032,0.0034,0.0036,0.0038,0.004)\n"));
  EXPECT_TRUE(has(script_for(3, 70), "set xtics (5,10,20,50)\n"));
  EXPECT_TRUE(has(script_for(3, 700), "set format x '10^{%T}'"));
  EXPECT_TRUE(has(script_for(0.3, 0.30000000000000004), "set xtics (0.3)\n"));
  EXPECT_TRUE(has(script_for(3, 70), "EOD\n3,1,,\n70,2,,\nEOD\n"));  // no point at zero
  const std::string none =
      gnuplot_script({.name = "t",
                      .columns = {},
                      .rows = {},
                      .chart = {.y = {.log = true}, .series = {{.points = {{1, 0}, {2, 0}}}}}});
  EXPECT_TRUE(has(none, "no data"));
}

TEST(Chart, TheCaptionNamesPanelsErrorsAndLines) {
  Chart chart{.x = {.name = "cycle"},
              .y = {.name = "overlap", .unit = "d"},
              .series = {{.band = true, .points = {{1, 2, {}, 0.5}}}},
              .lines = {{.at = 1, .title = "the limit"}, {.at = 2, .title = "the limit"}},
              .letter = "b"};
  const Table table{.name = "t", .columns = {}, .rows = {}, .chart = std::move(chart)};
  EXPECT_EQ(caption_of("A title", std::span(&table, 1)),
            "A title. (b) overlap [d] against cycle. Bands: standard errors over runs. Verdicts "
            "give 90 % intervals, not standard errors. Reference lines: the limit.");
}

TEST(Chart, TheCaptionSaysWhichPanelANoteIsOf) {
  Table a{.name = "a", .columns = {}, .rows = {}, .chart = {.series = {{.points = {{1, 2}}}}}};
  Table b = a;
  a.chart.letter = "a";
  b.chart.letter = "b";
  b.chart.note = "Means over 2 runs each";
  EXPECT_TRUE(has(caption_of("T", std::vector{a, b}), " (b) Means over 2 runs each."));
  a.chart.note = b.chart.note;
  EXPECT_TRUE(has(caption_of("T", std::vector{a, b}), ". Means over 2 runs each."));
}

TEST(Chart, TheCaptionCountsWhatALogarithmicAxisLeavesOut) {
  const Table table{
      .name = "t",
      .columns = {},
      .rows = {},
      .chart = {.y = {.name = "grains", .log = true}, .series = {{.points = {{1, 0}, {2, 3}}}}}};
  EXPECT_TRUE(has(caption_of("A title", std::span(&table, 1)),
                  " Values that are not positive are not drawn: 1."));
}

TEST(Chart, AShiftMovesNoPointOntoALogarithmicAxis) {
  const Table table{.name = "t",
                    .chart = {.x = {.name = "x", .log = true},
                              .series = {{.points = {{0, 1}, {2, 3}}, .shift = 0.5}}}};
  const std::string script = gnuplot_script(table);
  EXPECT_TRUE(has(script, "\n2.5,3,,\n")) << script;
  EXPECT_FALSE(has(script, "\n0.5,1,,\n")) << "the caption says that it is not drawn\n" << script;
}

TEST(Chart, EveryPanelOfEveryFigureHasOne) {
  std::vector<FrameRun> runs;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    runs.push_back(rising_run("still", seed, 4, 0.03));
  }
  for (const Figure& figure : all_figures()) {
    if (figure.form == FigureForm::table) continue;  // a table, not a chart
    if (!figure.make) continue;                      // summary, which is made of others
    for (const Table& table : figure.make(runs).tables) {
      for (const Axis* axis : {&table.chart.x, &table.chart.y}) {
        EXPECT_FALSE(axis->name.empty() && axis->symbol.empty()) << table.name;
      }
      std::size_t points = 0;
      for (const Series& one : table.chart.series) points += points_of(one).size();
      EXPECT_TRUE(!table.name.starts_with("S2") || points == table.rows.size()) << table.name;
    }
  }
}

}  // namespace
}  // namespace shearcell::test
