// SPDX-License-Identifier: GPL-3.0-or-later
// What a reader zooms into is what gnuplot draws: the same numbers as in the table.
#include "analysis/chart.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <limits>

#include "analysis/figure.hpp"
#include "tests/analysis/made_up_runs.hpp"

namespace shearcell {
namespace {

TEST(Chart, TakesItsPointsFromTheRowsOfOneCurve) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const TableRows rows = {{std::string("a"), std::int64_t{1}, 0.5, 0.1},
                          {std::string("b"), std::int64_t{1}, 0.6, {}},
                          {std::string("a"), std::int64_t{2}, {}, 0.1},
                          {std::string("a"), std::int64_t{3}, nan, 0.1},
                          {std::string("a"), std::int64_t{4}, 0.7, nan}};
  const CurveColumns columns{.x = 2, .x_error = 0, .y = 3, .y_error = 4};
  const auto points = chart_points(rows, columns, 1, std::string("a"));
  ASSERT_EQ(points.size(), 2U) << "without a y there is no point";
  EXPECT_EQ(points[0].x, 1);
  EXPECT_EQ(points[0].y, 0.5);
  EXPECT_EQ(points[0].y_error, 0.1);
  EXPECT_EQ(points[0].x_error, std::nullopt);
  EXPECT_EQ(points[1].y_error, std::nullopt);
  EXPECT_EQ(chart_points(rows, columns).size(), 3U);
}

TEST(Chart, HasTheDigitsOfTheCsv) {
  Chart chart{{.label = "x", .low = 0}, {.label = "y", .log = true}, {}, {0.646}};
  chart.series.push_back({"t", "#123456", 7, true, {{1.0 / 3, 2, std::nullopt, 0.25}}});
  EXPECT_EQ(to_json(chart).dump(),
            R"({"levels":[0.646],"series":[{"colour":"#123456","line":true,"point":7,)"
            R"("points":[[0.333333333,2.0,null,0.25]],"title":"t"}],)"
            R"("x":{"high":null,"label":"x","log":false,"low":0.0},)"
            R"("y":{"high":null,"label":"y","log":true,"low":null}})");
}

TEST(Chart, EveryPanelOfEveryFigureHasOne) {
  std::vector<FigureRun> runs;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    runs.push_back(testing::made_up_run("fluid", "still", seed, 4, [](int n, Measures& m) {
      m.phi = 0.63 + 0.01 * n;
      m.phi_uncorrected = 0.64 + 0.01 * n;
      m.mean_overlap = 0.002;
      m.crystalline_percent = n;
    }));
  }
  for (const Figure& figure : all_figures()) {
    for (const FigureTable& table : figure.make(runs).tables) {
      if (figure.needs == FigureNeeds::none) continue;  // a table, not a chart
      EXPECT_FALSE(table.chart.x.label.empty()) << table.name;
      EXPECT_FALSE(table.chart.y.label.empty()) << table.name;
      std::size_t points = 0;
      for (const ChartSeries& series : table.chart.series) points += series.points.size();
      if (table.rows.empty()) continue;
      std::printf("%s: %zu rows, %zu points\n", table.name.c_str(), table.rows.size(), points);
      const bool one_a_row = table.name.starts_with("S2");
      EXPECT_TRUE(!one_a_row || points == table.rows.size()) << table.name;
    }
  }
}

}  // namespace
}  // namespace shearcell
