// SPDX-License-Identifier: GPL-3.0-or-later
// Places of crystallites near the critical size, and their density. Rates of nucleation of runs
// whose rate is known.
#include "analysis/nucleation.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/random.hpp"
#include "tests/analysis/made_up_runs.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

/// In a cell 18 d wide and 20 d high.
CrystalliteMap map_with(std::initializer_list<std::vector<std::int32_t>> crystallites,
                        const Eigen::Vector3d& last_centre) {
  CrystalliteMap map = map_of(crystallites);
  map.centre.back() = last_centre;
  map.width = 18;
  map.bottom = 5;
  map.top = 25;
  return map;
}

CrystalliteMap one_crystallite(std::int32_t size, double x, double y, std::int32_t first = 0) {
  return map_with({grain_ids(first, size)}, {x, y, 0});
}

FrameRun run_with(std::span<const CrystalliteMap> maps) {
  FrameRun run =
      made_up_run("fluid", "still", 1, static_cast<int>(maps.size()) - 1, [](int, Measures&) {});
  for (std::size_t k = 0; k < maps.size(); ++k)
    run.checkpoints[k].measures.crystallite_map = maps[k];
  return run;
}

TEST(NucleusPlaces, AreSharesOfTheCell) {
  const FrameRun run = run_with(std::vector{one_crystallite(15, 9, 10), one_crystallite(14, 1, 6),
                                            one_crystallite(25, 0, 25), one_crystallite(26, 3, 6)});
  EXPECT_EQ(nucleus_places(run, CellAxis::x), (std::vector<double>{0.5, 0.05}));
  EXPECT_EQ(nucleus_places(run, CellAxis::y), (std::vector<double>{0.25, 1}));
}

TEST(NucleusBirths, CountAFollowedNucleusOnce) {
  // 20 grains that were seen, and 15 others.
  const CrystalliteMap two = map_with({grain_ids(0, 20), grain_ids(30, 15)}, {0, 20, 0});
  const FrameRun run =
      run_with(std::vector{one_crystallite(15, 9, 10), one_crystallite(3, 9, 10),
                           one_crystallite(29, 9, 11), one_crystallite(20, 9, 11), two, two});
  EXPECT_EQ(nucleus_places(run, CellAxis::y, Seen::first), (std::vector<double>{0.25, 0.75}));
  EXPECT_TRUE(
      nucleus_places(run_with(std::vector{one_crystallite(40, 9, 10), one_crystallite(20, 9, 10)}),
                     CellAxis::x, Seen::first)
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
std::vector<FrameRun> runs_with_places(int count, const std::function<double(double)>& x,
                                       const std::function<double(double)>& y) {
  std::vector<FrameRun> runs;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    std::vector<CrystalliteMap> maps;
    for (std::uint32_t n = 0; n < static_cast<std::uint32_t>(count); ++n) {
      const auto random = uniform_pair({n, 0, 0, 0}, seed);
      maps.push_back(one_crystallite(20, 20 * x(random[0]) - 1, 5 + 20 * y(random[1]),
                                     static_cast<std::int32_t>(20 * n)));
    }
    runs.push_back(run_with(maps));
    runs.back().stage.id = std::to_string(seed);
  }
  return runs;
}

/// Each run and a copy of it, under another id; `shared`: both begin with the packing of the first.
std::vector<FrameRun> with_copies(std::vector<FrameRun> runs, double amplitude, bool shared) {
  for (std::size_t k = 0, count = runs.size(); k < count; ++k) {
    FrameRun copy = runs[k];
    copy.stage.id += " again";
    copy.parameters["amplitude_rad"] = amplitude;
    if (shared) runs[k].packing = copy.packing = "packing of " + runs[k].stage.id;
    runs.push_back(std::move(copy));
  }
  return runs;
}

FigureResult s7(std::span<const FrameRun> runs) {
  return find_figure("S7")->make(runs);
}

std::vector<Ruling> rulings(std::span<const FrameRun> runs) {
  std::vector<Ruling> all;
  for (const Verdict& verdict : s7(runs).verdicts) all.push_back(verdict.ruling);
  return all;
}

TEST(FigureS7, DecidesCorrectlyForKnownPlaces) {
  const auto even = [](double u) { return u; };
  const auto in_one_spot = [](double u) { return 0.45 + 0.1 * u; };
  const auto near_the_top = [](double u) { return std::sqrt(u); };
  const auto near_the_bottom = [](double u) { return u * u; };
  using R = Ruling;
  EXPECT_EQ(rulings(runs_with_places(100, even, near_the_top)),
            (std::vector{R::agrees, R::supported}));
  EXPECT_EQ(rulings(runs_with_places(100, in_one_spot, near_the_bottom)),
            (std::vector{R::differs, R::refuted}));
  EXPECT_EQ(rulings(runs_with_places(100, even, even)), (std::vector{R::agrees, R::refuted}))
      << "no excess at the top";
  EXPECT_EQ(rulings(runs_with_places(3, even, even)), (std::vector{R::undecided, R::undecided}));
}

// Another amplitude does not make independent runs of those that share a packing.
TEST(FigureS7, CountsRunsOfOnePackingTogether) {
  const auto even = [](double u) { return u; };
  const std::vector<FrameRun> runs = runs_with_places(10, even, even);
  const Verdict once = s7(runs).verdicts[1];
  const Verdict shared = s7(with_copies(runs, 0.1, true)).verdicts[1];
  EXPECT_EQ(shared.estimate.value().value, once.estimate.value().value);
  EXPECT_EQ(shared.estimate.value().interval.low, once.estimate.value().interval.low);
  EXPECT_EQ(shared.estimate.value().interval.high, once.estimate.value().interval.high);
  EXPECT_EQ(shared.runs, 6U);
  EXPECT_TRUE(has(shared.note, "120 nuclei of 15 to 25 grains in 12 of 12 runs; 6 packings"));
  const Verdict apart = s7(with_copies(runs, 0.1, false)).verdicts[1];
  EXPECT_EQ(apart.runs, 12U);
  EXPECT_LT(apart.estimate.value().interval.high - apart.estimate.value().interval.low,
            once.estimate.value().interval.high - once.estimate.value().interval.low);
}

/// Of `grains` interior grains, at one phi, with an onset just before cycle `onset` (0: none).
FrameRun waiting(int grains, std::uint64_t seed, int onset, int cycles, double phi = 0.6451) {
  FrameRun run = made_up_run("grains", grains, seed, cycles, [=](int n, Measures& m) {
    m.numbers["phi"] = phi;
    m.numbers["interior_grains"] = grains;
    m.numbers["largest_crystallite"] = onset > 0 && n >= onset ? 16 : 0;  // critical at A = 0.0833
  });
  run.parameters["grains"] = grains;
  return run;
}

TEST(NucleationRate, IsEventsOverGrainCycles) {
  const std::vector<FrameRun> runs = {waiting(1000, 1, 10, 30), waiting(1000, 2, 20, 30),
                                      waiting(1000, 3, 0, 30), waiting(1000, 4, 0, 30, 0.6401)};
  const auto rates = nucleation_rates(pointers(runs), Region::interior);
  ASSERT_EQ(rates.size(), 2U);
  EXPECT_DOUBLE_EQ(rates[0].phi_low, 0.64);
  EXPECT_EQ(rates[0].events, 0U);
  EXPECT_DOUBLE_EQ(rates[0].grain_cycles, 30e3);
  EXPECT_EQ(rates[0].interval.low, 0);
  EXPECT_NEAR(rates[0].interval.high, 2.9957 / 30e3, 1e-8) << "-ln 0.05: the rule of three";
  EXPECT_DOUBLE_EQ(rates[1].phi_low, 0.644);
  EXPECT_EQ(rates[1].events, 2U);
  EXPECT_DOUBLE_EQ(rates[1].grain_cycles, 60e3);
  EXPECT_DOUBLE_EQ(rates[1].rate, 2 / 60e3);
  EXPECT_NEAR(rates[1].interval.low, 0.35536 / 60e3, 1e-9) << "Garwood, 90 %, two events";
  EXPECT_NEAR(rates[1].interval.high, 6.29579 / 60e3, 1e-9);
}

TEST(NucleationRate, LeavesOutRunsThatBeginWithACriticalCrystallite) {
  std::vector<FrameRun> runs = {waiting(1000, 1, 10, 30)};
  for (CheckpointMeasures& c : runs[0].checkpoints) c.measures.numbers["largest_crystallite"] = 16;
  EXPECT_TRUE(nucleation_rates(pointers(runs), Region::interior).empty());
}

// With one stratum and two sizes the maximum is where each size has its own rate.
TEST(SizeExponent, OfTwoSizesIsTheSlopeBetweenTheirRates) {
  std::vector<FrameRun> runs;
  double cycles[2] = {}, events[2] = {};
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    for (const int size : {0, 1}) {
      const int grains = size == 0 ? 500 : 3000;
      const int onset = static_cast<int>(1 + seed * (size == 0 ? 7 : 2) % 50);
      const bool seen = onset <= 35;
      runs.push_back(waiting(grains, seed, seen ? onset : 0, 35));
      cycles[size] += seen ? onset : 35;
      events[size] += seen ? 1 : 0;
    }
  }
  const auto found = size_exponent(pointers(runs), Region::interior);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->value,
              std::log(events[1] / cycles[1] / (events[0] / cycles[0])) / std::log(6.0), 1e-6);
  EXPECT_LT(found->interval.low, found->value);
  EXPECT_GT(found->interval.high, found->value);
}

/// Runs of three sizes in which phi rises by 0.0004 in a cycle and the rate by a factor e in
/// `rise`, twice as fast below 0.646 as above it: ln c is not a parabola.
std::vector<FrameRun> nucleating_runs(std::uint32_t sample, double exponent, double rise) {
  std::vector<FrameRun> runs;
  for (std::uint32_t seed = 1; seed <= 15; ++seed) {
    for (const int grains : {500, 1500, 4500}) {
      const double u = uniform_pair({sample, seed, static_cast<std::uint32_t>(grains), 0}, 7)[0];
      const double first = 0.638 + 0.0002 * seed;
      double hazard = 0;
      int onset = 0;
      const auto phi = [&](int n) { return first + 0.0004 * n; };
      for (int n = 0; n < 50 && onset == 0; ++n) {
        const double over = (phi(n) - 0.646) / rise;
        hazard += 3e-5 * std::exp(over > 0 ? over / 2 : over) * 4500 *
                  std::pow(grains / 4500.0, exponent);
        if (hazard > -std::log(u)) onset = n + 1;
      }
      runs.push_back(waiting(grains, seed, onset, 50));
      for (CheckpointMeasures& c : runs.back().checkpoints) {
        c.measures.numbers["phi"] = phi(static_cast<int>(c.cycle));
      }
    }
  }
  return runs;
}

TEST(SizeExponent, IsRightWhereTheRateIsSteep) {
  constexpr std::uint32_t samples = 100;
  for (const double rise : {0.002, 0.0008}) {
    for (const double exponent : {1.0, 2.0 / 3}) {
      if (rise == 0.002 && exponent < 1) continue;
      std::uint32_t covered = 0;
      double error = 0, squares = 0;
      for (std::uint32_t sample = 0; sample < samples; ++sample) {
        const std::vector<FrameRun> runs = nucleating_runs(sample, exponent, rise);
        const auto found = size_exponent(pointers(runs), Region::interior);
        ASSERT_TRUE(found);
        const double off = found->value - exponent;
        error += off / samples;
        squares += off * off / samples;
        if (found->interval.low <= exponent && found->interval.high >= exponent) ++covered;
      }
      const double deviation = std::sqrt(squares - error * error);
      std::printf(
          "exponent %.3f, c rises by e in %g: covered %u of %u, mean error %.3f, standard "
          "deviation %.3f\n",
          exponent, rise, covered, samples, error, deviation);
      EXPECT_GE(covered, samples * 0.82);
      EXPECT_LE(covered, samples * 0.98);
      EXPECT_LT(std::abs(error), 0.1) << "a constant c in bins of 0.002 gives -0.16";
    }
  }
}

TEST(SizeExponent, NeedsTwoSizesAtOnePhi) {
  const std::vector<FrameRun> one = {waiting(1000, 1, 5, 30), waiting(1000, 2, 6, 30),
                                     waiting(1000, 3, 7, 30)};
  EXPECT_FALSE(size_exponent(pointers(one), Region::interior));
  const std::vector<FrameRun> apart = {waiting(1000, 1, 5, 30), waiting(1000, 2, 6, 30),
                                       waiting(3000, 3, 7, 30, 0.6501)};
  EXPECT_FALSE(size_exponent(pointers(apart), Region::interior));
  std::vector<FrameRun> seeds;
  for (const int interior : {990, 1010, 1000, 1005, 995}) {
    seeds.push_back(waiting(interior, seeds.size(), 3 + interior % 7, 30));
    seeds.back().place.swept["grains"] = seeds.back().parameters["grains"] = 2000;
  }
  EXPECT_FALSE(size_exponent(pointers(seeds), Region::interior)) << "seeds of one size";
}

// The rate differs from packing to packing, and the runs of one packing share it.
TEST(SizeExponent, TheIntervalCoversTheTruthWithRunsOfOnePacking) {
  constexpr std::uint32_t samples = 300, packings = 15;
  std::uint32_t covered = 0, narrower = 0;
  for (std::uint32_t sample = 0; sample < samples; ++sample) {
    std::vector<FrameRun> runs;
    for (const int grains : {1000, 3000}) {
      const auto key = static_cast<std::uint32_t>(grains);
      const std::vector<double> scatter = normal_numbers(2 * sample + key / 3000, packings);
      for (std::uint32_t seed = 0; seed < packings; ++seed) {
        for (const double amplitude : {0.0833, 0.0834}) {
          const double u = uniform_pair({sample, seed, key, amplitude > 0.0833 ? 1U : 0U}, 3)[0];
          const double rate = 2e-5 * grains * std::exp(0.6 * scatter[seed]);
          const double onset = 1 - std::log(u) / rate;
          runs.push_back(waiting(grains, seed, onset < 60 ? static_cast<int>(onset) : 0, 60));
          runs.back().stage.id += amplitude > 0.0833 ? "b" : "a";
          runs.back().parameters["amplitude_rad"] = amplitude;
        }
      }
    }
    const auto apart = size_exponent(pointers(runs), Region::interior);
    for (FrameRun& run : runs)
      run.packing = fmt::format("{} {}", run.parameters["grains"].dump(), run.place.seed);
    const auto shared = size_exponent(pointers(runs), Region::interior);
    ASSERT_TRUE(apart && shared);
    covered += shared->interval.low <= 1 && shared->interval.high >= 1 ? 1 : 0;
    narrower += shared->interval.low > apart->interval.low ? 1 : 0;
  }
  std::printf("coverage %.3f\n", covered / double{samples});
  EXPECT_NEAR(covered / double{samples}, 0.9, 0.05);
  EXPECT_EQ(narrower, 0U);
}

// By one onset of six small runs, and none.
TEST(SizeExponent, IsMissingWithOnsetsInLargeCellsAlone) {
  std::vector<FrameRun> runs;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    runs.push_back(waiting(1000, seed, seed == 1 ? 9 : 0, 30));
    runs.push_back(waiting(3000, seed, static_cast<int>(3 + seed), 30));
  }
  const auto found = size_exponent(pointers(runs), Region::interior);
  ASSERT_TRUE(found);
  EXPECT_GT(found->interval.low, 0);
  EXPECT_GT(found->interval.high - found->value, found->value - found->interval.low)
      << "one onset says less of how rare they are in small cells than of how frequent";
  runs[0] = waiting(1000, 1, 0, 30);
  EXPECT_FALSE(size_exponent(pointers(runs), Region::interior)) << "none in the small ones";
  for (FrameRun& run : runs) {  // sizes are those of N, whatever number of grains is interior
    for (CheckpointMeasures& c : run.checkpoints)
      c.measures.numbers["interior_grains"] += 5 * static_cast<double>(run.place.seed);
  }
  EXPECT_FALSE(size_exponent(pointers(runs), Region::interior));
}

TEST(FigureNucleation, DrawsEachSizeAndDecidesByTheExponent) {
  std::vector<FrameRun> runs;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    runs.push_back(waiting(1000, seed, static_cast<int>(1 + seed * 7 % 60), 60));
    runs.push_back(waiting(3000, seed, static_cast<int>(1 + seed * 7 % 60) / 3 + 1, 60));
  }
  const FigureResult result = find_figure("nucleation")->make(runs);
  ASSERT_EQ(result.tables.size(), 2U);
  EXPECT_EQ(result.tables[1].rows.size(), 2U);
  EXPECT_TRUE(has(to_csv(result.tables[0]), "A=0.0833 N=1000,"));
  ASSERT_EQ(result.verdicts.size(), 1U);
  ASSERT_TRUE(result.verdicts[0].estimate);
  EXPECT_NEAR(result.verdicts[0].estimate->value, 0, 0.15);
  EXPECT_NEAR(result.verdicts[0].margin, 1.0 / 6, 1e-12) << "all grains are interior ones here";
  EXPECT_TRUE(find_figure("nucleation")->make(std::vector{runs.front()}).verdicts.empty());
  const auto set_interior_of_small = [&](double interior) {
    for (FrameRun& run : runs) {
      if (number_of(run, "grains") > 1000) continue;
      for (CheckpointMeasures& c : run.checkpoints)
        c.measures.numbers["interior_grains"] = interior;
    }
  };
  set_interior_of_small(2000);
  EXPECT_TRUE(find_figure("nucleation")->make(runs).verdicts.empty())
      << "a rate at the walls would rise faster with N_inves than one in the bulk";
  set_interior_of_small(0);
  EXPECT_TRUE(find_figure("nucleation")->make(runs).verdicts.empty()) << "nothing to compare with";
}

// In the core the small cells are denser and have a smaller share of the grains.
TEST(FigureNucleationCore, UsesTheGrainsAndThePhiOfTheCore) {
  std::vector<FrameRun> runs;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const int onset = static_cast<int>(1 + seed * 7 % 60);
    runs.push_back(waiting(1000, seed, onset, 60, 0.6401));
    runs.push_back(waiting(3000, seed, onset / 9 + 1, 60, 0.6421));
  }
  for (FrameRun& run : runs) {
    for (CheckpointMeasures& c : run.checkpoints) {
      c.measures.numbers["core_phi"] = 0.6451;
      c.measures.numbers["core_grains"] = number_of(run, "grains") > 1000 ? 1800 : 200;
    }
  }
  EXPECT_FALSE(size_exponent(pointers(runs), Region::interior)) << "they never have the same phi";
  const FigureResult result = find_figure("nucleation_core")->make(runs);
  ASSERT_EQ(result.tables.size(), 1U);
  ASSERT_EQ(result.tables[0].rows.size(), 2U);
  EXPECT_TRUE(has(to_csv(result.tables[0]), "A=0.0833 N=1000,0.0833,1000,0.644,0.646,30,"));
  ASSERT_EQ(result.verdicts.size(), 1U);
  EXPECT_NEAR(result.verdicts[0].estimate.value().value, 0, 0.1);
  EXPECT_NEAR(result.verdicts[0].margin, 0.5 - std::log(3.0) / std::log(9.0) / 3, 1e-12);
}

// A cell of 1000 grains has next to no core.
TEST(NucleationRate, LeavesOutTimeWithoutPhi) {
  std::vector<FrameRun> runs = {waiting(1000, 1, 10, 30)};
  EXPECT_TRUE(nucleation_rates(pointers(runs), Region::core).empty()) << "it was not measured";
  for (CheckpointMeasures& c : runs[0].checkpoints) {
    c.measures.numbers["core_grains"] = 0;
    c.measures.numbers["core_phi"] = std::nan("");
  }
  EXPECT_TRUE(nucleation_rates(pointers(runs), Region::core).empty());
}

}  // namespace
}  // namespace shearcell::test
