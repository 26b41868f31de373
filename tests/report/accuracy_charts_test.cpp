// SPDX-License-Identifier: GPL-3.0-or-later
// Charts of `bench accuracy --out` are shown; malformed files are named.
#include "experiments/report/report_data.hpp"

#include <gtest/gtest.h>

#include "provenance/errors.hpp"
#include "tests/experiments/temporary_store.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

class AccuracyCharts : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const {
    write_bytes(folder_.path() / name, text);
  }
  std::vector<ReportPanel> read() const { return read_accuracy_charts(folder_.path()); }
  std::string trouble() const {
    return message_of<UsageError>([this] { read(); });
  }
  TemporaryFolder folder_;
};

/// As `bench accuracy --out` writes it.
nlohmann::json chart() {
  return chart_json({.name = "a",
                     .columns = {"cost", "error"},
                     .rows = {{1.0, 1e-3}, {2.0, 1e-4}},
                     .chart = {.x = {.name = "cost", .unit = "s", .log = true},
                               .y = {.name = "error", .log = true},
                               .series = {{.title = "engine",
                                           .colour = "#000000",
                                           .columns = {.x = "cost", .y = "error"}}},
                               .lines = {{1e-3}}}});
}

TEST_F(AccuracyCharts, HaveTheChartAndTheDrawingBesideTheNumbers) {
  write("b.csv", "anything\n1\n");
  write("a.csv", "cost,error\n1,0.001\n2,0.0001\n");
  write("a.chart.json", chart().dump());
  write("a.svg", "<svg/>");
  const auto panels = read();
  ASSERT_EQ(panels.size(), 2U);
  EXPECT_EQ(panels[0].name, "a");
  EXPECT_EQ(panels[0].csv, "cost,error\n1,0.001\n2,0.0001\n");
  EXPECT_EQ(panels[0].chart, chart());
  EXPECT_EQ(panels[0].drawing, "<svg/>");
  EXPECT_TRUE(panels[1].chart.is_null());
  EXPECT_EQ(panels[1].drawing, "");
}

// The front end would stumble over each of these.
TEST_F(AccuracyCharts, RejectAMalformedChart) {
  write("a.csv", "");
  for (const auto& [place, value] : std::initializer_list<std::pair<const char*, nlohmann::json>>{
           {"", nullptr},
           {"/x", nullptr},
           {"/x/label", "cost"},
           {"/y/log", 1},
           {"/y/low", "0"},
           {"/title", {{"text"}}},
           {"/series", 3},
           {"/series/0/points", {{1, 2}}},
           {"/series/0/points/0/1", nullptr},
           {"/series/0/point", "square"},
           {"/lines/0/at", "here"}}) {
    nlohmann::json bad = chart();
    bad[nlohmann::json::json_pointer(place)] = value;
    write("a.chart.json", bad.dump());
    EXPECT_TRUE(has(trouble(), "a.chart.json: not a chart")) << place;
  }
  write("a.chart.json", std::string(100'000, '['));
  EXPECT_TRUE(has(trouble(), "not a chart"));
}

TEST_F(AccuracyCharts, NameTheWrongFileOrFolder) {
  EXPECT_TRUE(has(trouble(), "0 CSV files"));
  write("a.csv", std::string(3'000'000, '1'));
  EXPECT_TRUE(has(trouble(), "a.csv: not a readable file of at most 2 MB"));
  EXPECT_THROW(read_accuracy_charts(folder_.path() / "none"), UsageError);
}

}  // namespace
}  // namespace shearcell::test
