// SPDX-License-Identifier: GPL-3.0-or-later
// Verdicts at their thresholds, and those of figures whose truth is known.
#include "analysis/verdict.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "core/random.hpp"
#include "tests/analysis/made_up_runs.hpp"

namespace shearcell::testing {
namespace {

TEST(Verdict, PassesBelowItsLimitOnly) {
  EXPECT_EQ(below("c", "q", 1.999, 2).ruling, Ruling::pass);
  EXPECT_EQ(below("c", "q", 2, 2).ruling, Ruling::fail);
  EXPECT_EQ(below("c", "q", std::nullopt, 2).ruling, Ruling::too_few_runs);
  EXPECT_EQ(below("c", "q", std::nan(""), 2).ruling, Ruling::too_few_runs);
  EXPECT_EQ(below_if(false, "c", "q", 1, 2).ruling, Ruling::too_few_runs);
}

TEST(Verdict, OverallIsTheWorst) {
  const Verdict pass = below("c", "q", 1, 2);
  const Verdict fail = below("c", "q", 3, 2);
  const Verdict unknown = below("c", "q", std::nullopt, 2);
  EXPECT_EQ(overall({}), Ruling::too_few_runs);
  EXPECT_EQ(overall(std::vector{pass, pass}), Ruling::pass);
  EXPECT_EQ(overall(std::vector{pass, unknown}), Ruling::too_few_runs);
  EXPECT_EQ(overall(std::vector{unknown, fail, pass}), Ruling::fail);
}

TEST(Verdict, JsonHasSixDigitsAndNull) {
  const nlohmann::json json = to_json(std::vector{below("c", "q", 1.0 / 3, 2, "n")});
  EXPECT_EQ(json.dump(),
            R"({"claims":[{"claim":"c","limit":2.0,"note":"n","quantity":"q","value":0.333333,)"
            R"("verdict":"pass"}],"verdict":"pass"})");
  EXPECT_TRUE(
      to_json(std::vector{below("c", "q", std::nullopt, 2)})["claims"][0]["value"].is_null());
}

double noise(std::uint64_t seed, int n) {
  return uniform_pair({static_cast<std::uint32_t>(n), 0, 0, 0}, seed)[0] - 0.5;
}

/// Percentage is a function of phi alone, plus `excess`; phi rises with the cycle at `speed`.
FigureRun crystallizing(const std::string& key, const nlohmann::json& value, std::uint64_t seed,
                        double speed, double excess) {
  return made_up_run(key, value, seed, 80, [=](int n, Measures& m) {
    m.phi = 0.6301 + speed * n + 0.0005 * noise(seed, n);
    const double rise = std::max(0.0, m.phi - 0.646) * 900;
    m.crystalline_percent = rise * (1 + 0.1 * noise(seed + 100, 0)) + (rise > 0 ? excess : 0);
    m.mean_overlap = 0.0027;
  });
}

std::vector<FigureRun> two_groups(const std::string& key, const nlohmann::json& a,
                                  const nlohmann::json& b, std::uint64_t runs, double speed,
                                  double excess) {
  std::vector<FigureRun> all;
  for (std::uint64_t seed = 1; seed <= runs; ++seed) {
    all.push_back(crystallizing(key, a, seed, 0.0005, 0));
    all.push_back(crystallizing(key, b, seed + 20, speed, excess));
  }
  return all;
}

std::vector<Ruling> rulings(const char* figure, std::span<const FigureRun> runs) {
  std::vector<Ruling> found;
  for (const Verdict& v : find_figure(figure)->make(runs).verdicts) {
    std::printf("%s: %s: %s = %g (limit %g); %s\n", figure, name_of(v.ruling), v.claim.c_str(),
                v.value.value_or(std::nan("")), v.limit.value_or(std::nan("")), v.note.c_str());
    found.push_back(v.ruling);
  }
  return found;
}

using Rulings = std::vector<Ruling>;
constexpr Ruling pass = Ruling::pass;
constexpr Ruling fail = Ruling::fail;
constexpr Ruling too_few = Ruling::too_few_runs;

TEST(TwoPanels, OneCurveForBothPasses) {
  EXPECT_EQ(rulings("S2", two_groups("fluid", "still", "cell", 6, 0.0005, 0)),
            (Rulings{pass, pass}));
  EXPECT_EQ(rulings("S4", two_groups("moving_wall", "bottom", "top", 3, 0.0005, 0)),
            (Rulings{pass, pass}));
}

TEST(TwoPanels, PhiMayDifferWherePercentageDoesNot) {
  EXPECT_EQ(rulings("S2", two_groups("fluid", "still", "cell", 6, 0.0006, 0)),
            (Rulings{fail, pass}));
}

TEST(TwoPanels, AnExcessIsFound) {
  EXPECT_EQ(rulings("S2", two_groups("fluid", "still", "cell", 6, 0.0005, 5)),
            (Rulings{pass, fail}));
}

TEST(TwoPanels, TwoRunsAreTooFewAndSoAreShortOnes) {
  EXPECT_EQ(rulings("S2", two_groups("fluid", "still", "cell", 2, 0.0005, 0)),
            (Rulings{too_few, too_few}));
  std::vector<FigureRun> runs = two_groups("fluid", "still", "cell", 6, 0.0005, 0);
  for (FigureRun& run : runs) run.checkpoints.resize(20);
  EXPECT_EQ(rulings("S2", runs), (Rulings{too_few, too_few}));
  for (FigureRun& run : runs) run.checkpoints.clear();
  EXPECT_EQ(rulings("S2", runs), (Rulings{too_few, too_few}));
}

TEST(FigureS3, OverlapAtTheTimeStepOfTheMainText) {
  EXPECT_EQ(rulings("S3", two_groups("steps_per_cycle", 45600, 76923, 6, 0.0005, 0)),
            (Rulings{pass, pass, fail}));
}

TEST(FigureB5, PausesCompactFaster) {
  EXPECT_EQ(rulings("B5", two_groups("protocol", "continuous", "paused", 4, 0.0005, 0))[0], too_few)
      << "other seeds, nothing to pair";
  for (const auto& [speed, ruling] : {std::pair{0.0006, pass}, std::pair{0.0004, fail}}) {
    std::vector<FigureRun> runs = two_groups("protocol", "continuous", "paused", 4, speed, 0);
    for (FigureRun& run : runs) run.seed %= 20;
    EXPECT_EQ(rulings("B5", runs)[0], ruling);
  }
}

TEST(FigureWalls, SmoothOnesCrystallizeAtOnce) {
  const auto run = [](const char* walls, double percent) {
    return made_up_run("walls", walls, 1, 20, [percent](int n, Measures& m) {
      m.phi = 0.63 + 0.001 * n;
      m.crystalline_percent = percent * n / 20;
    });
  };
  // Then what becomes of the rough runs, too short here, and N_inves.
  EXPECT_EQ(rulings("walls", std::vector{run("smooth", 40), run("rough", 1)}),
            (Rulings{pass, pass, too_few, pass}));
  EXPECT_EQ(rulings("walls", std::vector{run("smooth", 10), run("rough", 30)}),
            (Rulings{fail, fail, too_few, pass}));
  EXPECT_EQ(rulings("walls", std::vector{run("smooth", 40)}), (Rulings{pass, too_few, too_few}));
}

TEST(FigureWalls, RoughOnesCrystallizeInTheBulkLater) {
  // A crystallite of 16 grains, the first, at `cycle`.
  const auto rough = [](std::uint64_t seed, int cycle, double phi, int last) {
    return made_up_run("walls", "rough", seed, last, [=](int n, Measures& m) {
      m.phi = n < cycle ? 0.63 : phi;
      m.crystalline_percent = 0;
      m.largest_crystallite = n < cycle ? 15 : 16;
      m.interior_grains = 3436;
    });
  };
  const auto ruling = [](const std::vector<FigureRun>& runs) {
    return rulings("walls", runs).at(2);
  };
  EXPECT_EQ(ruling({rough(1, 30, 0.641, 120), rough(2, 119, 0.651, 119)}), pass);
  EXPECT_EQ(ruling({rough(1, 30, 0.641, 120), rough(2, 130, 0.651, 119)}), pass) << "censored";
  EXPECT_EQ(ruling({rough(2, 130, 0.651, 119)}), too_few);
  EXPECT_EQ(ruling({rough(1, 30, 0.641, 120), rough(2, 130, 0.651, 120)}), fail) << "never";
  EXPECT_EQ(ruling({rough(1, 120, 0.645, 130)}), fail) << "too late";
  EXPECT_EQ(ruling({rough(1, 30, 0.653, 120)}), fail);
  EXPECT_EQ(ruling({rough(1, 30, 0.639, 120)}), fail);
  EXPECT_EQ(ruling({rough(1, 0, 0.645, 120)}), fail) << "from the start";
  EXPECT_EQ(rulings("walls", std::vector{rough(1, 30, 0.641, 120)}).at(3), fail)
      << "N_inves 3.03 % too large";
}

TEST(FigureChoices, OneThatShowsIsFound) {
  std::vector<FigureRun> runs;
  const auto add = [&](double mass, double drag, int draw, double speed) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      FigureRun run = crystallizing("choice", runs.size() / 6, seed + 10 * runs.size(), speed, 0);
      run.labels = {{"wall_mass_grains_per_d2", mass}, {"wall_drag_grains_per_d2_s", drag}};
      run.parameters = run.labels;
      if (draw != 0) run.parameters["wall_grain_draw"] = draw;
      runs.push_back(std::move(run));
    }
  };
  add(10, 1000, 0, 0.0005);
  add(10, 1000, 1, 0.0005);
  EXPECT_EQ(rulings("choices", runs), (Rulings{too_few, too_few, too_few, too_few, pass}));
  add(30, 1000, 0, 0.0005);
  add(10.0 / 3, 1000, 0, 0.0006);
  add(10, 3000, 0, 0.0005);
  add(10, 333.3333, 0, 0.0005);
  EXPECT_EQ(rulings("choices", runs), (Rulings{pass, fail, pass, pass, pass}));
  runs.erase(runs.begin(), runs.begin() + 6);
  EXPECT_EQ(rulings("choices", runs), (Rulings{too_few, too_few, too_few, too_few, too_few}))
      << "nothing to compare with";
}

FigureRun of_table_1(const char* experiment, const std::string& key, const nlohmann::json& value) {
  FigureRun run = made_up_run(key, value, 1, 0, [](int, Measures&) {});
  run.experiment = experiment;
  run.parameters = {
      {"mass_kg", 2e-5},          {"diameter_m", 3e-3},      {"stiffness_N_per_m", 654.0},
      {"drag_kg_per_s", 1.28e-3}, {"pressure_Pa", 954.0},    {"period_s", 2.0},
      {"steps_per_cycle", 45600}, {"gravity_m_per_s2", 9.81}};
  run.parameters[key] = value;
  return run;
}

TEST(FigureTable1, WhatIsSweptMayDifferAndNothingElse) {
  std::vector<FigureRun> runs = {of_table_1("gravity", "gravity_m_per_s2", 9.81),
                                 of_table_1("gravity", "gravity_m_per_s2", 0.0),
                                 of_table_1("other", "pressure_Pa", 955.0),
                                 of_table_1("timestep", "steps_per_cycle", 57143)};
  runs[2].labels = {{"fluid", "still"}};
  EXPECT_EQ(rulings("table1", runs), Rulings{}) << "inputs are not claims";
  const FigureTable table = find_figure("table1")->make(runs).tables.at(0);
  const std::string csv = to_csv(table);
  for (const char* row :
       {"gravity,gravity_m_per_s2,9.81,0,9.81,2,varied\n",
        "other,pressure_Pa,954,955,955,1,differs\n",
        "other,omega_rad_per_s,3.14159265,3.14159265,3.14159265,1,equal\n",
        "timestep,time_step_s,4.38596491e-05,3.49999125e-05,3.49999125e-05,1,varied\n"}) {
    EXPECT_NE(csv.find(row), std::string::npos) << row << csv;
  }
}

TEST(FigureTable1, AStiffeningVariesTheSpringsAndHasNoTime) {
  FigureRun run = of_table_1("spring_constant", "protocol", "stiffen");
  for (const char* key : {"period_s", "steps_per_cycle"}) run.parameters.erase(key);
  run.checkpoints.back().stiffness_N_per_m = 65400;
  const std::string csv = to_csv(find_figure("table1")->make(std::vector{run}).tables.at(0));
  for (const char* row :
       {",stiffness_N_per_m,654,654,65400,1,varied\n", ",steps_per_cycle,45600,,,0,none\n",
        ",mass_kg,2e-05,2e-05,2e-05,1,equal\n"}) {
    EXPECT_NE(csv.find(row), std::string::npos) << row << csv;
  }
  run.checkpoints.clear();
  EXPECT_TRUE(find_figure("table1")->make(std::vector{run}).tables.at(0).rows.empty())
      << "declared, not computed";
}

/// Cycle 0 is the packing as it settled, cycles 1 to 9 are minima at k/k0 = 1 .. 100.
std::vector<FigureRun> stiffened(std::size_t systems, double fall, double drift) {
  std::vector<FigureRun> runs;
  for (std::size_t seed = 1; seed <= systems; ++seed) {
    FigureRun run = made_up_run("protocol", "stiffen", seed, 9, [=](int n, Measures& m) {
      m.phi = n == 0 ? 0.6 : 0.635 + drift * (n - 1) / 8;
      m.phi_uncorrected = 0.655 - fall * (n - 1) / 8;
      m.mean_overlap = 0.002 * std::pow(10, -0.25 * (n - 1));
    });
    for (CheckpointMeasures& c : run.checkpoints) {
      c.stiffness_N_per_m = 654 * std::pow(10, 0.25 * std::max(0.0, c.cycle - 1));
    }
    runs.push_back(run);
  }
  return runs;
}

TEST(FigureS1, PhiStaysWherePhiUFalls) {
  EXPECT_EQ(rulings("S1", stiffened(3, 0.013, 0.0015)), (Rulings{pass, pass}));
  EXPECT_EQ(rulings("S1", stiffened(3, 0.035, 0.0025)), (Rulings{fail, fail}));
  EXPECT_EQ(rulings("S1", stiffened(2, 0.02, 0)), (Rulings{too_few, too_few}));
  std::vector<FigureRun> part = stiffened(3, 0.02, 0);
  for (FigureRun& run : part) run.checkpoints.pop_back();
  EXPECT_EQ(rulings("S1", part), (Rulings{too_few, too_few})) << "not the whole hundredfold";
  const FigureTable table = find_figure("S1")->make(stiffened(3, 0.02, 0)).tables.at(0);
  ASSERT_EQ(table.rows.size(), 9U);
  EXPECT_EQ(std::get<double>(table.rows.front().at(5)), 0.635) << "the minimum at k0";
  EXPECT_EQ(std::get<std::int64_t>(table.rows.front().at(7)), 3);
  EXPECT_EQ(std::get<double>(table.rows.back().at(0)), 2.0);
}

/// ln(largest) steps at `onset` in phi.
FigureRun nucleating(double amplitude, double gravity, std::uint64_t seed, double onset) {
  FigureRun run = made_up_run("amplitude_rad", amplitude, seed, 100, [=](int n, Measures& m) {
    m.phi = 0.63 + 0.0004 * n;
    const double at = onset + 0.0004 * noise(seed, 0);
    m.largest_crystallite =
        static_cast<std::size_t>(std::lround(1 + 200 / (1 + std::exp(-(m.phi - at) / 0.0006))));
    m.interior_grains = 8100;
  });
  run.parameters["gravity_m_per_s2"] = gravity;
  run.parameters["grains"] = 11400;
  run.variant += gravity != 0 ? "" : ",gravity off";
  return run;
}

std::vector<FigureRun> nucleating_runs(double with, double without) {
  std::vector<FigureRun> runs;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    runs.push_back(nucleating(0.05, 9.81, seed, with));
    runs.push_back(nucleating(0.05, 0, seed + 10, without));
  }
  return runs;
}

TEST(FigureS6, GravityDoesNotMatter) {
  EXPECT_EQ(rulings("S6", nucleating_runs(0.647, 0.647)), (Rulings{pass, pass}));
  EXPECT_EQ(rulings("S6", nucleating_runs(0.647, 0.655)), (Rulings{fail, fail}));
}

TEST(FigureS5, OnsetAndInteriorGrainsAreThoseOfTheSupplement) {
  // The last one is N_inves of N = 5200, which these runs do not have.
  EXPECT_EQ(rulings("S5b", nucleating_runs(0.6475, 0.6475)), (Rulings{pass, pass, too_few}));
  EXPECT_EQ(rulings("S5b", nucleating_runs(0.656, 0.656)), (Rulings{pass, fail, too_few}));
  EXPECT_EQ(rulings("S5a", nucleating_runs(0.656, 0.656))[0], fail);
  EXPECT_EQ(rulings("S5a", nucleating_runs(0.6475, 0.6475))[0], pass);
}

}  // namespace
}  // namespace shearcell::testing
