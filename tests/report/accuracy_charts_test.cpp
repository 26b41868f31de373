// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of `bench accuracy --out` become diagrams; what is no such table is named.
#include "experiments/report/accuracy_charts.hpp"

#include <gtest/gtest.h>

#include "provenance/errors.hpp"
#include "tests/experiments/temporary_store.hpp"

namespace shearcell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

class AccuracyCharts : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name, std::ios::binary) << text;
  }
  std::vector<ReportPanel> read() const { return read_accuracy_charts(folder_.path()); }
  std::string trouble() const {
    try {
      read();
    } catch (const NotFound& error) {
      return error.what();
    }
    return "";
  }
  TemporaryFolder folder_;
};

TEST_F(AccuracyCharts, DrawACurveForEachMethod) {
  write("accuracy-bounce.csv",
        "method,time_step_s,seconds_per_cycle,exit_speed_error\n"
        "engine,1e-5,12,1e-6\nengine,2e-5,6,4e-6\n"
        "\"leapfrog, \"\"exact\"\"\",1e-5,13,2e-7\nPEFRL,1e-5,,\n");
  const auto panels = read();
  ASSERT_EQ(panels.size(), 1U);
  EXPECT_EQ(panels[0].name, "accuracy-bounce");
  const nlohmann::json& chart = panels[0].chart;
  EXPECT_TRUE(chart.at("x").at("log") && chart.at("y").at("log"));
  const nlohmann::json& series = chart.at("series");
  ASSERT_EQ(series.size(), 3U);
  ASSERT_EQ(series[0].at("points").size(), 2U);
  EXPECT_EQ(series[0].at("points")[1][0], 6);
  EXPECT_EQ(series[0].at("points")[1][1], 4e-6);
  EXPECT_EQ(series[1].at("title")[0][0], "leapfrog, \"exact\"");
  EXPECT_TRUE(series[2].at("points").empty());
}

TEST_F(AccuracyCharts, DrawMeansWithTheirErrors) {
  write("accuracy-stiffness.csv",
        "stiffness_factor,seconds_per_cycle,phi_bias,phi_bias_error\n1,10,-1e-4,2e-5\n");
  const auto panels = read();
  ASSERT_EQ(panels[0].chart.at("series").size(), 1U);
  EXPECT_EQ(panels[0].chart["series"][0]["points"][0][3], 2e-5);
}

TEST_F(AccuracyCharts, GiveOnlyNumbersOfOtherTables) {
  write("b.csv", "anything\n1\n");
  write("a.csv", "x,y\n1,2\n");
  write("a.gp", "plot\n");
  const auto panels = read();
  ASSERT_EQ(panels.size(), 2U);
  EXPECT_EQ(panels[0].name, "a");
  EXPECT_TRUE(panels[0].chart.is_null());
  EXPECT_EQ(panels[0].csv, "x,y\n1,2\n");
}

TEST_F(AccuracyCharts, NameTheLineThatIsWrong) {
  EXPECT_NE(trouble().find("0 CSV files"), std::string::npos) << trouble();
  write("a.csv", "x,y\n1,2\n3\n");
  EXPECT_NE(trouble().find("a.csv:3: "), std::string::npos) << trouble();
  write("a.csv", "x,y\n\"1,2\n");
  EXPECT_NE(trouble().find("never closed"), std::string::npos) << trouble();
  write("a.csv", "x,y\n\"1\"2,3\n");
  EXPECT_NE(trouble().find("after a quoted field"), std::string::npos) << trouble();
  write("a.csv", std::string(3'000'000, '1'));
  EXPECT_NE(trouble().find("larger"), std::string::npos) << trouble();
  EXPECT_THROW(read_accuracy_charts(folder_.path() / "none"), NotFound);
}

TEST_F(AccuracyCharts, ReadAnEmptyFile) {
  write("a.csv", "");
  EXPECT_EQ(read().size(), 1U);
}

}  // namespace
}  // namespace shearcell
