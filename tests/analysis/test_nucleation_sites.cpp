// SPDX-License-Identifier: GPL-3.0-or-later
// Places of crystallites near the critical size, and their density.
#include "analysis/nucleation_sites.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "analysis/figures/figures.hpp"
#include "core/random.hpp"
#include "tests/analysis/made_up_runs.hpp"

namespace shearcell::testing {
namespace {

CrystalliteMap one_crystallite(std::int32_t size, double x, double y, std::int32_t first = 0) {
  std::vector<std::int32_t> grains(static_cast<std::size_t>(size));
  std::iota(grains.begin(), grains.end(), first);
  CrystalliteMap map = map_of({grains});
  map.centre[0] = {x, y, 0};
  map.width = 18;
  map.bottom = 5;
  map.top = 25;
  return map;
}

FigureRun run_with(std::span<const CrystalliteMap> maps) {
  FigureRun run =
      made_up_run("fluid", "still", 1, static_cast<int>(maps.size()) - 1, [](int, Measures&) {});
  for (std::size_t k = 0; k < maps.size(); ++k) run.checkpoints[k].crystallites = maps[k];
  return run;
}

TEST(NucleusPlaces, AreSharesOfTheCell) {
  const FigureRun run =
      run_with(std::vector{one_crystallite(15, 9, 10), one_crystallite(14, 1, 6),
                           one_crystallite(25, 0, 25), one_crystallite(26, 3, 6)});
  EXPECT_EQ(nucleus_places(run, CellAxis::x), (std::vector<double>{0.5, 0.05}));
  EXPECT_EQ(nucleus_places(run, CellAxis::y), (std::vector<double>{0.25, 1}));
}

TEST(NucleusBirths, OneThatIsFollowedCountsOnce) {
  CrystalliteMap two = map_of(  // 20 grains that were seen, and 15 others
      {{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19},
       {30, 31, 32, 33, 34, 35, 36, 37, 38, 39, 40, 41, 42, 43, 44}});
  two.centre[1] = {0, 20, 0};
  two.width = 18;
  two.bottom = 5;
  two.top = 25;
  const FigureRun run =
      run_with(std::vector{one_crystallite(15, 9, 10), one_crystallite(3, 9, 10),
                           one_crystallite(29, 9, 11), one_crystallite(20, 9, 11), two, two});
  EXPECT_EQ(nucleus_births(run, CellAxis::y), (std::vector<double>{0.25, 0.75}));
  EXPECT_TRUE(
      nucleus_births(run_with(std::vector{one_crystallite(40, 9, 10), one_crystallite(20, 9, 10)}),
                     CellAxis::x)
          .empty())
      << "first seen with more than 25 grains";
}

TEST(Density, IntegratesToOneAndHasErrorsOverRuns) {
  const std::vector<std::vector<double>> runs = {{0.1, 0.2, 0.9}, {0.6, 1.0}, {0.3}};
  const std::vector<DensityBin> bins = density(runs, 4);
  ASSERT_EQ(bins.size(), 4U);
  const std::vector<double> expected = {2.0 / 6 * 4, 1.0 / 6 * 4, 1.0 / 6 * 4, 2.0 / 6 * 4};
  double integral = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_DOUBLE_EQ(bins[k].density, expected[k]);
    EXPECT_TRUE(bins[k].error.has_value());
    integral += bins[k].density * (bins[k].high - bins[k].low);
  }
  EXPECT_NEAR(integral, 1, 1e-15);
  EXPECT_FALSE(density(std::span(runs).first(1), 4)[0].error.has_value());
  EXPECT_TRUE(density({}, 4).empty());
}

/// Six runs of so many nuclei each, at x/w and y/h as two functions of random numbers in [0,
/// 1) say.
std::vector<FigureRun> runs_with_places(int count, const std::function<double(double)>& x,
                                        const std::function<double(double)>& y) {
  std::vector<FigureRun> runs;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    std::vector<CrystalliteMap> maps;
    for (std::uint32_t n = 0; n < static_cast<std::uint32_t>(count); ++n) {
      const auto random = uniform_pair({n, 0, 0, 0}, seed);
      maps.push_back(one_crystallite(20, 20 * x(random[0]) - 1, 5 + 20 * y(random[1]),
                                     static_cast<std::int32_t>(20 * n)));
    }
    runs.push_back(run_with(maps));
  }
  return runs;
}

std::vector<Ruling> rulings(std::span<const FigureRun> runs) {
  std::vector<Ruling> all;
  for (const Verdict& verdict : figure_s7(runs).verdicts) all.push_back(verdict.ruling);
  return all;
}

TEST(FigureS7, JudgesPlacesWhoseTruthIsKnown) {
  const auto even = [](double u) { return u; };
  const auto in_one_spot = [](double u) { return 0.45 + 0.1 * u; };
  const auto near_the_top = [](double u) { return std::sqrt(u); };
  const auto near_the_bottom = [](double u) { return u * u; };
  using R = Ruling;
  EXPECT_EQ(rulings(runs_with_places(100, even, near_the_top)),
            (std::vector{R::agrees, R::agrees}));
  EXPECT_EQ(rulings(runs_with_places(100, in_one_spot, near_the_bottom)),
            (std::vector{R::differs, R::differs}));
  EXPECT_EQ(rulings(runs_with_places(100, even, even)), (std::vector{R::agrees, R::differs}))
      << "no excess at the top";
  EXPECT_EQ(rulings(runs_with_places(3, even, even)), (std::vector{R::undecided, R::undecided}));
}

}  // namespace
}  // namespace shearcell::testing
