// SPDX-License-Identifier: GPL-3.0-or-later
// Onsets of analytic curves, and runs that do not show theirs.
#include "analysis/onset.hpp"
#include "analysis/plots.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/analysis/made_up_runs.hpp"

namespace shearcell::test {
namespace {

/// phi rises by 0.0005 a cycle from 0.63; ln(largest) is a step of width 0.002 around `onset`, from
/// 2 to 2000 grains.
FrameRun logistic(double onset, int cycles = 100) {
  return made_up_run("fluid", "still", 1, cycles, [onset](int n, Measures& m) {
    m.numbers["phi"] = 0.63 + 0.0005 * n;
    const double rise = 1 / (1 + std::exp(-(m.numbers["phi"] - onset) / 0.002));
    m.numbers["largest_crystallite"] = std::round(2 * std::exp(std::log(1000.0) * rise));
  });
}

TEST(OnsetBySize, IsInterpolatedBetweenCycles) {
  FrameRun run = made_up_run("fluid", "still", 1, 4, [](int n, Measures& m) {
    m.numbers["phi"] = 0.64 + 0.001 * n;
    m.numbers["largest_crystallite"] = 4 * n;
  });
  run.parameters["amplitude_rad"] = 0.05;  // critical: 10 grains
  const RunOnset found = onset_by_size(run);
  ASSERT_EQ(found.missing, Missing::nothing);
  EXPECT_DOUBLE_EQ(found.phi, 0.6425);
  EXPECT_DOUBLE_EQ(found.cycle, 2.5);
}

TEST(OnsetBySize, IsTheFirstPassage) {
  const std::vector<double> sizes = {2, 16, 3, 40};
  const FrameRun run = made_up_run("fluid", "still", 1, 3, [&](int n, Measures& m) {
    m.numbers["phi"] = 0.64 + 0.001 * n;
    m.numbers["largest_crystallite"] = sizes[static_cast<std::size_t>(n)];
  });
  EXPECT_DOUBLE_EQ(onset_by_size(run).phi, 0.641);
}

TEST(Onset, IsCensoredAtEitherEnd) {
  for (const OnsetMethod method : {onset_by_size, onset_by_slope}) {
    EXPECT_EQ(method(logistic(0.66, 20)).missing, Missing::too_short);
    EXPECT_EQ(method(logistic(0.62, 20)).missing, Missing::too_late);
  }
}

TEST(OnsetBySlope, IsTheSteepestPoint) {
  for (const double onset : {0.644, 0.646, 0.655}) {
    const RunOnset found = onset_by_slope(logistic(onset));
    ASSERT_EQ(found.missing, Missing::nothing);
    EXPECT_NEAR(found.phi, onset, 0.0006);
    EXPECT_NEAR(found.cycle, (onset - 0.63) / 0.0005, 1.5);
  }
}

// Two checkpoints are too few for a slope, though the largest crystallite is critical in one.
TEST(OnsetBySlope, IsUnclearWithoutAWindow) {
  FrameRun run = logistic(0.646);
  run.checkpoints = {run.checkpoints[0], run.checkpoints[60]};
  const RunOnset found = onset_by_slope(run);
  EXPECT_EQ(found.missing, Missing::undefined);
}

TEST(Onset, CountsCensoredRuns) {
  std::vector<FrameRun> runs = {logistic(0.645), logistic(0.647), logistic(0.646),
                                logistic(0.66, 10)};
  for (FrameRun& run : runs) run.packing = fmt::format("of run {}", &run - runs.data());
  const PlotSpec plot{.name = "own", .columns = {{"onset_slope_phi"}}, .x = "amplitude_rad"};
  const auto cell = [&](const char* column) {
    const Table table = plot_figure(plot).make(runs).tables.at(0);
    return table.rows.at(0).at(table.place(column));
  };
  EXPECT_EQ(cell("runs"), TableCell(std::size_t{4})) << "the mean includes the censored run";
  EXPECT_EQ(cell("runs_ended_before"), TableCell(std::size_t{1}));
  EXPECT_NEAR(std::get<double>(cell("onset_slope_phi_mean")), 0.646, 0.0006);
  EXPECT_GT(std::get<double>(cell("onset_slope_phi_standard_error")), 0);
  for (FrameRun& run : runs) run.packing = "of all";
  EXPECT_EQ(cell("runs"), TableCell(std::size_t{0})) << "the mean of the packing is censored, too";
  EXPECT_EQ(cell("onset_slope_phi_mean"), TableCell());
  runs.pop_back();
  EXPECT_EQ(cell("runs"), TableCell(std::size_t{1}));
  EXPECT_EQ(cell("onset_slope_phi_standard_error"), TableCell()) << "of one packing";
}

}  // namespace
}  // namespace shearcell::test
