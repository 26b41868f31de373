// SPDX-License-Identifier: GPL-3.0-or-later
// `bench accuracy` at its quickest: every section, table and figure.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "analysis/measures.hpp"
#include "analysis/plot.hpp"
#include "experiments/manifest/numerics.hpp"
#include "experiments/bench/accuracy/accuracy.hpp"
#include "experiments/bench/accuracy/sheared.hpp"
#include "tests/experiments/temporary_store.hpp"

namespace shearcell::accuracy {
namespace {

TEST(AccuracyReport, HasEverySectionWithItsTableAndFigure) {
  const test::TemporaryFolder folder;
  const std::vector<Section> sections = measure_accuracy({.quick = true, .jobs = 2, .report = {}});
  std::set<std::string> names;
  for (const Section& s : sections) {
    SCOPED_TRACE(s.table.name);
    names.insert(s.table.name);
    EXPECT_FALSE(s.table.rows.empty());
    EXPECT_FALSE(s.summary.empty());
    for (const auto& row : s.table.rows) EXPECT_EQ(row.size(), s.table.columns.size());
    for (const auto& row : s.summary) EXPECT_EQ(row.size(), s.header.size());
    write_csv(s.table, folder.path());
    if (s.table.plot.empty()) continue;
    EXPECT_TRUE(std::filesystem::exists(draw_svg(s.table, folder.path())));
  }
  EXPECT_EQ(names,
            (std::set<std::string>{
                "accuracy-cage", "accuracy-collision-end", "accuracy-collision-speed",
                "accuracy-crystal-closed", "accuracy-crystal-frequency", "accuracy-crystal-opening",
                "accuracy-dispersion", "accuracy-drift", "accuracy-order", "accuracy-seeds",
                "accuracy-separation", "accuracy-stiffness", "accuracy-wall"}));
}

TEST(Overlap, IsWhatAPlanExpects) {
  struct Case {
    std::uint64_t grains;
    double pressure, stiffness;
    MovingWall moving;
  };
  for (const Case& c : {Case{600, 1, 1, MovingWall::bottom}, Case{600, 1, 1, MovingWall::top},
                        Case{600, 2, 1, MovingWall::bottom}, Case{600, 1, 4, MovingWall::bottom},
                        Case{2000, 1, 1, MovingWall::bottom}}) {
    Parameters p;
    p.grains = c.grains;
    p.pressure_Pa *= c.pressure;
    p.stiffness_N_per_m *= c.stiffness;
    p.settle_time_step_s /= std::sqrt(c.stiffness);
    p.moving_wall = c.moving;
    const Packing packing = settled(p, 1);
    const double found =
        analyse(packing.cell, wall_pose(packing.cell, 0, packing.state.wall_height),
                packing.state.position)
            .measures.mean_overlap;
    std::printf("N = %d, P x %g, k x %g, %s wall: %.3e d, expected %.3e d\n",
                static_cast<int>(c.grains), c.pressure, c.stiffness,
                c.moving == MovingWall::top ? "top" : "bottom", found, expected_overlap(p));
    EXPECT_NEAR(found / expected_overlap(p), 1, 0.1);
  }
}

TEST(Sheared, RunsPartAsTheSquareOfTheTimeStepAndThenExponentially) {
  Parameters parameters;
  parameters.grains = 300;
  const Packing packing = settled(parameters, 1);
  const Chaos chaos = separate(packing, {182400, 45600}, 0.1, 20);
  const double fine = chaos.runs[0].distance[1], coarse = chaos.runs[1].distance[1];
  std::printf("after %.3g s: %.2g d, %.2g d; Lyapunov time %.2g s\n", chaos.runs[0].time[1], fine,
              coarse, chaos.lyapunov_time);
  EXPECT_NEAR(std::log(coarse / fine) / std::log(4.0), 2, 0.5);
  EXPECT_GT(chaos.lyapunov_time, 1e-3);
  EXPECT_LT(chaos.lyapunov_time, 5e-2);
  EXPECT_THROW(separate(packing, {45601}, 0.01, 2), std::invalid_argument);
}

TEST(Sheared, StopsWhereTheTimeStepIsFarOverTheLimit) {
  Parameters parameters;
  parameters.grains = 300;
  const Packing packing = settled(parameters, 1);
  // 1.6 times 2/sqrt(8 k/m).
  const RunMeans means = sheared_means(packing, 10000, 1, 1);
  std::printf("%s\n", means.failure.c_str());
  EXPECT_FALSE(means.failure.empty());
  EXPECT_TRUE(std::isnan(means.phi));
}

}  // namespace
}  // namespace shearcell::accuracy
