// SPDX-License-Identifier: GPL-3.0-or-later
// Verdicts at their thresholds, and verdicts of figures from synthetic runs with a known answer.
#include "analysis/verdict.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "core/random.hpp"
#include "tests/analysis/made_up_runs.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

Estimate between(double low, double high, std::size_t runs = 6, double spread = 1) {
  return {(low + high) / 2, {low, high}, runs, 1, spread};
}

Ruling ruling(double low, double high, Relation claimed = Relation::same) {
  return decide({"c", 2, claimed}, "q", between(low, high), 6, "").ruling;
}

using Rulings = std::vector<Ruling>;
constexpr Ruling agrees = Ruling::agrees;
constexpr Ruling differs = Ruling::differs;
constexpr Ruling undecided = Ruling::undecided;
constexpr Ruling supported = Ruling::supported;
constexpr Ruling refuted = Ruling::refuted;

TEST(Verdict, IsDecidedByIntervalAndMargin) {
  EXPECT_EQ(ruling(-2, 1.9), agrees);
  EXPECT_EQ(ruling(-2.1, 1.9), undecided);
  EXPECT_EQ(ruling(1.9, 5), undecided);
  EXPECT_EQ(ruling(2.1, 5), differs);
  EXPECT_EQ(ruling(-5, -2.1), differs);
  EXPECT_EQ(ruling(-5, 5), undecided) << "too wide";
  EXPECT_EQ(ruling(2.1, 5, Relation::higher), supported);
  EXPECT_EQ(ruling(-5, 1.9, Relation::higher), refuted);
  EXPECT_EQ(ruling(1, 3, Relation::higher), undecided);
  EXPECT_EQ(ruling(-5, 1.9, Relation::lower), supported);
  EXPECT_EQ(ruling(2.1, 5, Relation::lower), refuted);
  EXPECT_EQ(decide({"c", 2}, "q", std::nullopt, 0, "").ruling, undecided);
}

TEST(Verdict, StatesHowManyRunsWouldDecide) {
  const auto needed = [](const Estimate& estimate) {
    return decide({"c", 2}, "q", estimate, estimate.runs, "").runs_needed;
  };
  EXPECT_FALSE(needed(between(-1, 1)).has_value()) << "decided";
  EXPECT_EQ(needed(between(-3, 3, 4, 2)), runs_to_resolve(between(0, 0, 4, 2), 2, true));
  EXPECT_EQ(needed(between(1, 2.5, 4, 2)), runs_to_resolve(between(0, 0, 4, 2), 0.25, false))
      << "not zero, so a truth of zero is not asked about";
  EXPECT_EQ(needed(between(1, 2.5, 40, 2)), runs_to_resolve(between(0, 0, 4, 2), 0.25, false))
      << "enough runs for most truths, but the estimate is near the margin";
}

// Both sides together would say 36 runs, the longer one alone says more than there are.
TEST(Verdict, NeedsMoreRunsIfOneSideOfTheIntervalIsLong) {
  Estimate skewed = between(0.98, 2.05, 40, 2);
  skewed.value = 1;
  EXPECT_LE(runs_to_resolve(skewed, 1, false).value(), 40U);
  EXPECT_EQ(decide({"c", 2}, "q", skewed, 40, "").runs_needed, 41U);
}

TEST(Verdict, HeadlineCountsTheRulings) {
  const Verdict good = decide({"c", 2}, "q", between(0, 1), 6, "");
  const Verdict bad = decide({"c", 2}, "q", between(3, 4), 6, "");
  const Verdict unknown = decide({"c", 2}, "q", std::nullopt, 0, "");
  const Verdict false_direction = decide({"c", 2, Relation::higher}, "q", between(0, 1), 6, "");
  const auto headline = [](const std::vector<Verdict>& verdicts) {
    return headline_of(rulings_of(verdicts));
  };
  EXPECT_EQ(headline({}), "");
  EXPECT_EQ(headline({good, good}), "2 agrees");
  EXPECT_EQ(headline({unknown, good}), "1 agrees, 1 undecided");
  EXPECT_EQ(headline({unknown, bad, false_direction, good}),
            "1 agrees, 1 differs, 1 refuted, 1 undecided");
}

TEST(Verdict, WhatEnteredIsOneTable) {
  Verdict first = decide({.text = "a, b", .margin = 2, .id = "S2.a"}, "q", between(0, 1), 6, "");
  first.entered = {.columns = {"group", "value"}, .rows = {{"x", 1.5}, {"y", TableCell()}}};
  Verdict second = decide({"c", 2}, "q", between(0, 1), 6, "");
  second.entered = {.columns = {"group", "size", "grew"},
                    .rows = {{"z", std::int64_t{3}, std::int64_t{4}}}};
  EXPECT_EQ(
      to_csv(entered_table(std::vector{first, second})),
      "id,claim,group,value,size,grew\nS2.a,\"a, b\",x,1.5,,\nS2.a,\"a, b\",y,,,\n,c,z,,3,4\n");
}

TEST(Verdict, WordsHaveNoInfinities) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Verdict verdict;
  verdict.margin = 1;
  verdict.estimate = Estimate{infinity, {-infinity, infinity}};
  EXPECT_EQ(numbers_of(verdict), "no finite value, 90 % interval unbounded, margin 1, 0 runs");
  verdict.estimate = Estimate{2, {1.5, infinity}};
  verdict.runs_needed = 9;
  EXPECT_EQ(numbers_of(verdict), "2, 90 % interval 1.5 to unbounded, margin 1, 0 runs (9 needed)");
}

TEST(Verdict, WaitsAreComparedInWords) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Verdict verdict;
  verdict.margin = 1;
  verdict.quantity = "log2 of the ratio of the cycles of the onset, log-rank";
  verdict.waits_for = "the onset";
  verdict.runs = 6;
  verdict.counted = Counted::runs_per_variant;
  EXPECT_EQ(result_of(verdict),
            "cycle of the onset (log-rank test): not measured, margin: twice, 6 runs per variant");
  const auto words = [&](double estimate, double low, double high) {
    verdict.estimate = Estimate{estimate, {low, high}};
    const std::string numbers = numbers_of(verdict);
    return numbers.substr(0, numbers.find(", margin"));
  };
  EXPECT_EQ(words(infinity, 1.74, infinity),
            "no finite value, 90 % interval 3.3 times later to unbounded");
  EXPECT_EQ(words(-infinity, -infinity, -4),
            "no finite value, 90 % interval unbounded to 16 times earlier");
  EXPECT_EQ(words(3, -1, infinity),
            "the events of the first group come 8.0 times later, 90 % interval 2.0 times earlier "
            "to unbounded");
  EXPECT_EQ(words(-3, -infinity, 1),
            "the events of the first group come 8.0 times earlier, 90 % interval unbounded to 2.0 "
            "times later");
  EXPECT_EQ(words(1, -infinity, infinity),
            "the events of the first group come 2.0 times later, 90 % interval unbounded");
  EXPECT_EQ(words(1, 0.5, 3),
            "the events of the first group come 2.0 times later, 90 % interval 1.4 times later to "
            "8.0 times later");
  EXPECT_EQ(words(-1, -3, -0.5),
            "the events of the first group come 2.0 times earlier, 90 % interval 8.0 times earlier "
            "to 1.4 times earlier");
  EXPECT_EQ(words(0.1, -1, 1.5),
            "the events of the first group come 1.1 times later, 90 % interval 2.0 times earlier "
            "to 2.8 times later");
  verdict.margin = 1.585;
  verdict.note = "a note";
  EXPECT_TRUE(has(result_of(verdict), "margin: 3.0 times, 6 runs per variant; a note"));
  EXPECT_TRUE(has(to_json(std::span(&verdict, 1)).dump(), "\"estimate\":0.1"))
      << "JSON keeps the logarithm";
}

TEST(Verdict, JsonHasSixDigitsAndNull) {
  Estimate half = between(-1, 1, 5);
  half.value = 1.0 / 3;
  half.interval.high = infinite;
  half.spread = infinite;
  EXPECT_EQ(
      to_json(std::vector{decide({"c", 0.5, Relation::same, "S2.c"}, "q", half, 5, "n")}).dump(),
      R"({"claims":[{"claim":"c","counted":"runs","estimate":0.333333,"id":"S2.c",)"
      R"("interval":[-1.0,null],)"
      R"("level":0.9,"margin":0.5,"note":"n","quantity":"q","runs":5,"runs_needed":null,)"
      R"("verdict":"undecided"}],"verdict":"1 undecided"})");
  const auto none = to_json(std::vector{decide({"c", 2}, "q", std::nullopt, 0, "")});
  EXPECT_TRUE(none["claims"][0]["estimate"].is_null() && none["claims"][0]["interval"].is_null());
  EXPECT_TRUE(to_json(std::span<const Verdict>())["verdict"].is_null());
  const auto tiny = to_json(std::vector{decide({"c", 1e-310}, "q", std::nullopt, 0, "")});
  EXPECT_EQ(tiny["claims"][0]["margin"], 1e-310);
}

double noise(std::uint64_t seed, int n) {
  return uniform_pair({static_cast<std::uint32_t>(n), 0, 0, 0}, seed)[0] - 0.5;
}

/// Percentage is a function of phi alone, plus `excess`; phi rises with the cycle at `speed`.
FrameRun crystallizing(const std::string& key, const nlohmann::json& value, std::uint64_t seed,
                       double speed, double excess) {
  return made_up_run(key, value, seed, 110, [=](int n, Measures& m) {
    m.numbers["phi"] = 0.6301 + speed * n + 0.0005 * noise(seed, n);
    const double rise = std::max(0.0, m.numbers["phi"] - 0.646) * 900;
    m.numbers["crystalline_percent"] =
        rise * (1 + 0.1 * noise(seed + 100, 0)) + (rise > 0 ? excess : 0);
    m.numbers["largest_crystallite"] = std::floor(std::max(0.0, m.numbers["phi"] - 0.64) * 3000);
    m.numbers["mean_overlap_d"] = 0.0027 * (1 + 0.001 * noise(seed + 200, n));
    m.numbers["contacts_per_grain"] = 6 * (1 + excess / 100) * (1 + 0.001 * noise(seed + 300, n));
  });
}

std::vector<FrameRun> two_groups(const std::string& key, const nlohmann::json& a,
                                 const nlohmann::json& b, std::uint64_t runs, double speed,
                                 double excess) {
  std::vector<FrameRun> all;
  for (std::uint64_t seed = 1; seed <= runs; ++seed) {
    all.push_back(crystallizing(key, a, seed, 0.0005, 0));
    all.push_back(crystallizing(key, b, seed + 20, speed, excess));
  }
  return all;
}

Rulings rulings(const char* figure, std::span<const FrameRun> runs) {
  Rulings found;
  for (const Verdict& v : find_figure(figure)->make(runs).verdicts) {
    std::printf("%s: %s: %s; %s: %s; %s\n", figure, name_of(v.ruling).data(), v.text.c_str(),
                v.quantity.c_str(), numbers_of(v).c_str(), v.note.c_str());
    found.push_back(v.ruling);
  }
  return found;
}

TEST(Comparisons, FindOnlyRealDifferences) {
  const auto fluids = [](double speed) {
    return rulings("S2", two_groups("fluid", "still", "cell", 6, speed, 0));
  };
  const auto moving_walls = [](std::uint64_t runs, double excess) {
    return rulings("S4", two_groups("moving_wall", "bottom", "top", runs, 0.0005, excess));
  };
  EXPECT_EQ(fluids(0.0005), (Rulings{agrees, agrees, agrees}));
  EXPECT_EQ(fluids(0.0008), (Rulings{differs, agrees, agrees})) << "phi, but not the percentage";
  EXPECT_EQ(fluids(0.0025), (Rulings{differs, differs, agrees}));
  EXPECT_EQ(moving_walls(3, 0), (Rulings{agrees, agrees, agrees, agrees, agrees}));
  EXPECT_EQ(moving_walls(6, 5), (Rulings{agrees, agrees, differs, agrees, differs}));
}

TEST(Comparisons, TwoRunsAreTooFewAndSoAreShortOnes) {
  const Rulings none = {undecided, undecided, undecided};
  EXPECT_EQ(rulings("S2", two_groups("fluid", "still", "cell", 2, 0.0005, 0)), none);
  std::vector<FrameRun> runs = two_groups("fluid", "still", "cell", 6, 0.0005, 0);
  for (FrameRun& run : runs) run.checkpoints.resize(20);
  EXPECT_EQ(rulings("S2", runs), (Rulings{agrees, undecided, undecided}));
  for (FrameRun& run : runs) run.checkpoints.clear();
  EXPECT_EQ(rulings("S2", runs), none);
}

TEST(FigureS3, EachTimeStepAgainstThatOfTheMainText) {
  const auto against = [](int steps, double excess) {
    return rulings("S3", two_groups("steps_per_cycle", 45600, steps, 6, 0.0005, excess));
  };
  EXPECT_EQ(against(76923, 0), (Rulings{agrees, agrees, agrees, refuted}))
      << "the overlap is not below 1e-3";
  const auto larger = [&](double excess) {
    const Rulings all = against(20000, excess);
    return Rulings(all.begin() + 1, all.end());  // onset, percentage and overlap
  };
  EXPECT_EQ(larger(0), (Rulings{agrees, agrees, agrees}));
  EXPECT_EQ(larger(5), (Rulings{agrees, differs, agrees}));
}

TEST(FigureB5, PausesCompactFaster) {
  for (const auto& [speed, ruling] : {std::pair{0.0006, supported}, std::pair{0.0005, refuted}}) {
    std::vector<FrameRun> runs = two_groups("protocol", "continuous", "paused", 6, speed, 0);
    for (FrameRun& run : runs) {
      run.place.seed %= 20;
      run.packing = std::to_string(run.place.seed);
      for (CheckpointMeasures& c : run.checkpoints)
        c.measures.numbers["phi_at_rest"] = c.measures.numbers["phi"];
      run.parameters["protocol"] = run.place.swept["protocol"];
    }
    EXPECT_EQ(rulings("B5", runs), (Rulings{ruling, ruling, ruling, agrees, agrees}))
        << "as drawn, at rest, and its growth";
  }
}

/// A run whose largest crystallite has the critical size at `onset`, and 20 % at cycle `fifth`.
FrameRun between_walls(const char* walls, std::uint64_t seed, double onset, int fifth, int last) {
  return made_up_run("walls", walls, seed, last, [=](int n, Measures& m) {
    m.numbers["phi"] = onset - 0.0095 + 0.001 * n;
    m.numbers["largest_crystallite"] = n < 10 ? 15 : 17;
    m.numbers["crystalline_percent"] = 20.0 * n / fifth;
    m.numbers["interior_grains"] = 3395 + static_cast<double>(seed);
  });
}

std::vector<FrameRun> walls(int smooth, int rough, int last, double onset = 0.646) {
  std::vector<FrameRun> runs;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    runs.push_back(between_walls("smooth", seed, 0.64, smooth, std::min(smooth, last)));
    runs.push_back(between_walls("rough", seed, onset, rough, last));
  }
  return runs;
}

TEST(FigureWalls, RoughOnesDelayCrystallization) {
  EXPECT_EQ(rulings("walls", walls(8, 60, 80)), (Rulings{supported, agrees, agrees}));
  EXPECT_EQ(rulings("walls", walls(8, 60, 40)), (Rulings{supported, agrees, agrees})) << "censored";
  EXPECT_EQ(rulings("walls", walls(40, 50, 80)), (Rulings{refuted, agrees, agrees}));
  EXPECT_EQ(rulings("walls", walls(40, 60, 18)), (Rulings{undecided, agrees, agrees}))
      << "all end before 20 %, smooth ones too";
  EXPECT_EQ(rulings("walls", walls(8, 60, 80, 0.651)), (Rulings{supported, differs, agrees}));
}

TEST(FigureChoices, FindsAChoiceThatMatters) {
  std::vector<FrameRun> runs;
  const auto add = [&](double mass, double drag, int draw, double speed) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      FrameRun run = crystallizing("choice", runs.size() / 6, seed + 10 * runs.size(), speed, 0);
      run.place.swept = {{"wall_mass_grains_per_d2", mass}, {"wall_drag_grains_per_d2_s", drag}};
      run.parameters = run.place.swept;
      run.parameters["wall_grain_draw"] = draw;
      runs.push_back(std::move(run));
    }
  };
  add(10, 1000, 0, 0.0005);
  add(10, 1000, 1, 0.0005);
  EXPECT_EQ(rulings("choices", runs),
            (Rulings{undecided, undecided, undecided, undecided, agrees}));
  add(30, 1000, 0, 0.0005);
  add(10.0 / 3, 1000, 0, 0.0007);
  add(10, 3000, 0, 0.0005);
  add(10, 333.3333, 0, 0.0005);
  EXPECT_EQ(rulings("choices", runs), (Rulings{agrees, differs, agrees, agrees, agrees}));
  runs.erase(runs.begin(), runs.begin() + 6);
  EXPECT_EQ(rulings("choices", runs), Rulings(5, undecided)) << "nothing to compare with";
}

FrameRun of_table_1(const char* experiment, const std::string& key, const nlohmann::json& value) {
  FrameRun run = made_up_run(key, value, 1, 0, [](int, Measures&) {});
  run.place.experiment = experiment;
  run.parameters = {
      {"mass_kg", 2e-5},          {"diameter_m", 3e-3},      {"stiffness_N_per_m", 654.0},
      {"drag_kg_per_s", 1.28e-3}, {"pressure_Pa", 954.0},    {"period_s", 2.0},
      {"steps_per_cycle", 45600}, {"gravity_m_per_s2", 9.81}};
  run.parameters[key] = value;
  return run;
}

void expect_rows(std::span<const FrameRun> runs, std::initializer_list<const char*> rows) {
  const std::string csv = to_csv(find_figure("table1")->make(runs).tables.at(0));
  for (const char* row : rows) EXPECT_TRUE(has(csv, row));
}

TEST(FigureTable1, OnlySweptParametersMayDiffer) {
  std::vector<FrameRun> runs = {of_table_1("gravity", "gravity_m_per_s2", 9.81),
                                of_table_1("gravity", "gravity_m_per_s2", 0.0),
                                of_table_1("other", "pressure_Pa", 955.0),
                                of_table_1("timestep", "steps_per_cycle", 57143)};
  runs[2].place.swept = {{"fluid", "still"}};
  EXPECT_EQ(rulings("table1", runs), Rulings{}) << "inputs are not claims";
  expect_rows(runs,
              {"gravity,gravity_m_per_s2,9.81,0,9.81,2,varied\n",
               "other,pressure_Pa,954,955,955,1,differs\n",
               "other,omega_rad_per_s,3.14159265,3.14159265,3.14159265,1,equal\n",
               "timestep,time_step_s,4.38596491e-05,3.49999125e-05,3.49999125e-05,1,differs\n"});
}

TEST(FigureTable1, AStiffeningVariesTheSpringsAndHasNoTimeStep) {
  FrameRun run = of_table_1("spring_constant", "protocol", "stiffen");
  for (const char* key : {"period_s", "steps_per_cycle"}) run.parameters.erase(key);
  run.checkpoints.back().measures.numbers["raised_stiffness_N_per_m"] = 65400;
  expect_rows(std::vector{run},
              {",stiffness_N_per_m,654,654,65400,1,varied\n", ",steps_per_cycle,45600,,,0,none\n",
               ",mass_kg,2e-05,2e-05,2e-05,1,equal\n"});
  run.checkpoints.clear();
  EXPECT_TRUE(find_figure("table1")->make(std::vector{run}).tables.at(0).rows.empty())
      << "declared, not computed";
}

void load_at(const char* where, FrameRun& run) {
  run.place.swept = {{"pressure_at", where}};
  run.place.variant = words_of(run.place.swept);
}

/// Cycle 0 is the packing as it settled, cycles 1 to 9 are minima at k/k0 = 1 .. 100.
std::vector<FrameRun> stiffened(std::size_t systems, double fall, double drift) {
  std::vector<FrameRun> runs;
  for (std::size_t seed = 1; seed <= systems; ++seed) {
    FrameRun run = made_up_run("protocol", "stiffen", seed, 9, [=](int n, Measures& m) {
      m.numbers["phi"] = n == 0 ? 0.6 : 0.635 + drift * (n - 1) / 8;
      m.numbers["phi_uncorrected"] = 0.655 - fall * (n - 1) / 8;
      m.numbers["mean_overlap_d"] = 0.002 * std::pow(10, -0.25 * (n - 1));
    });
    load_at("top", run);
    run.parameters["stiffness_N_per_m"] = 654.0;
    for (CheckpointMeasures& c : run.checkpoints) {
      c.measures.numbers["raised_stiffness_N_per_m"] =
          654 * std::pow(10, 0.25 * std::max(0.0, c.cycle - 1));
    }
    runs.push_back(run);
  }
  return runs;
}

const TableCell& cell(const Table& table, std::size_t row, const std::string& column) {
  return table.rows.at(row).at(table.place(column));
}

TEST(FigureS1, PhiIsConstantWhilePhiUFalls) {
  EXPECT_EQ(rulings("S1", stiffened(3, 0.012, 0.0015)), (Rulings{agrees, agrees, differs, differs}))
      << "Eq. S4 overcorrects by more than 0.001";
  EXPECT_EQ(rulings("S1", stiffened(3, 0.035, 0.0025)),
            (Rulings{differs, differs, differs, differs}));
  const Rulings none(4, undecided);
  EXPECT_EQ(rulings("S1", stiffened(2, 0.02, 0)), none);
  std::vector<FrameRun> part = stiffened(3, 0.02, 0);
  for (FrameRun& run : part) run.checkpoints.pop_back();
  EXPECT_EQ(rulings("S1", part), none) << "not the whole hundredfold";
  const Table table = find_figure("S1")->make(stiffened(3, 0.02, 0)).tables.at(0);
  ASSERT_EQ(table.rows.size(), 9U);
  EXPECT_EQ(json_of(cell(table, 0, "phi_mean")), 0.635) << "the minimum at k0";
  EXPECT_EQ(json_of(cell(table, 0, "runs")), 3);
  EXPECT_EQ(json_of(cell(table, 8, "log10_k_over_k0_mean")), 2.0);
}

TEST(FigureS1, ClaimsAreAboutTheHundredfoldAlone) {
  std::vector<FrameRun> runs = stiffened(3, 0.012, 0.0015);
  for (FrameRun& run : runs) {
    CheckpointMeasures harder = run.checkpoints.back();
    harder.cycle += 1;
    harder.measures.numbers["raised_stiffness_N_per_m"] *= 10;
    harder.measures.numbers["phi"] = harder.measures.numbers["phi_uncorrected"] = 0.5;
    run.checkpoints.push_back(harder);
  }
  EXPECT_EQ(rulings("S1", runs), (Rulings{agrees, agrees, differs, differs}))
      << "harder ones do not enter";
  for (FrameRun& run : runs) run.checkpoints[9].measures.numbers["phi"] = std::nan("");
  EXPECT_EQ(rulings("S1", runs), (Rulings{agrees, undecided, undecided, undecided}))
      << "no interior grains";
  for (FrameRun& run : runs)
    run.checkpoints.erase(run.checkpoints.begin(), run.checkpoints.begin() + 2);
  EXPECT_EQ(rulings("S1", runs), Rulings(4, undecided)) << "k0 is lost";
  const Table table = find_figure("S1")->make(runs).tables.at(0);
  EXPECT_NEAR(json_of(cell(table, 0, "log10_k_over_k0_mean")).get<double>(), 0.25, 1e-12);
}

TEST(FigureS1, LoadsAreNotPooled) {
  std::vector<FrameRun> runs = stiffened(3, 0.012, 0.0015);
  for (FrameRun run : stiffened(3, 0.035, 0.0025)) {
    load_at("moving_wall", run);
    runs.push_back(run);
  }
  EXPECT_EQ(rulings("S1", runs), (Rulings{agrees, agrees, differs, differs, differs, differs}))
      << "four claims of the load on top, two of the load on the moving wall";
  EXPECT_EQ(find_figure("S1")->make(runs).tables.at(0).rows.size(), 18U);
}

/// ln(largest) steps at `onset` in phi.
FrameRun nucleating(double amplitude, double gravity, std::uint64_t seed, double onset) {
  FrameRun run = made_up_run("amplitude_rad", amplitude, seed, 110, [=](int n, Measures& m) {
    m.numbers["phi"] = 0.63 + 0.0004 * n;
    m.numbers["crystalline_percent"] =
        std::max(0.0, m.numbers["phi"] - 0.646) * (900 + 10 * noise(seed + 100, 0));
    const double at = onset + 0.0004 * noise(seed, 0);
    m.numbers["largest_crystallite"] =
        std::round(1 + 200 / (1 + std::exp(-(m.numbers["phi"] - at) / 0.0006)));
    m.numbers["interior_grains"] = 8100;
  });
  run.place.swept["gravity_m_per_s2"] = gravity;
  run.parameters["grains"] = 11400;
  run.place.variant = run.name = words_of(run.place.swept);
  return run;
}

std::vector<FrameRun> nucleating_runs(double with, double without) {
  std::vector<FrameRun> runs;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    runs.push_back(nucleating(0.05, 9.81, seed, with));
    runs.push_back(nucleating(0.05, 0, seed + 10, without));
  }
  return runs;
}

TEST(FigureS6, GravityDoesNotMatter) {
  EXPECT_EQ(rulings("S6", nucleating_runs(0.6475, 0.6475)), (Rulings{agrees, agrees, agrees}));
  EXPECT_EQ(rulings("S6", nucleating_runs(0.6475, 0.655)), (Rulings{differs, differs, agrees}));
  std::vector<FrameRun> late = nucleating_runs(0.6475, 0.6475);
  for (std::size_t k : {1U, 3U}) late[k].checkpoints.resize(20);
  EXPECT_EQ(rulings("S6", late), (Rulings{agrees, agrees, undecided}))
      << "censored onsets; too short for the percentage";
}

TEST(FigureS5, OnsetAndInteriorGrainsAreThoseOfTheSupplement) {
  const auto falling = [](double onset) {
    std::vector<FrameRun> runs = nucleating_runs(onset, onset);
    std::erase_if(runs,
                  [](const FrameRun& run) { return number_of(run, "gravity_m_per_s2") == 0; });
    return runs;
  };
  // Interior grains, onset, two slopes (undecided, since all cells have one size), prediction.
  EXPECT_EQ(rulings("S5b", falling(0.6475)),
            (Rulings{agrees, agrees, undecided, undecided, agrees}));
  EXPECT_EQ(rulings("S5b", falling(0.656)),
            (Rulings{agrees, differs, undecided, undecided, differs}));
  EXPECT_EQ(rulings("S5a", falling(0.656)), (Rulings{differs, agrees, differs}))
      << "the last one: these onsets are long before cycle 300";
  EXPECT_EQ(rulings("S5a", falling(0.6475)).at(0), agrees);
}

TEST(FigureS5, TheSlopeOfTheOnsetIsTakenAgainstLnOfTheInteriorGrains) {
  const auto verdict = [](double slope) {
    std::vector<FrameRun> runs;
    for (const double grains : {5200, 7900, 18200}) {
      for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const double interior = 0.7 * grains;
        FrameRun run = nucleating(0.05, 9.81, seed + static_cast<std::uint64_t>(grains),
                                  0.6475 + slope * std::log(interior / 5000));
        for (CheckpointMeasures& one : run.checkpoints) {
          one.measures.numbers["interior_grains"] = interior;
        }
        run.parameters["grains"] = grains;
        run.place.variant = "grains=" + std::to_string(grains);
        runs.push_back(run);
      }
    }
    const std::vector<Verdict> verdicts = find_figure("S5b")->make(runs).verdicts;
    return *std::ranges::find(verdicts, "S5b.slope", &Verdict::id);
  };
  Verdict found = verdict(-0.0017);
  EXPECT_EQ(found.text, "C: phi at the onset does not depend on the size of the cell");
  EXPECT_NEAR(found.estimate.value().value, -0.0017, 0.0003);
  EXPECT_EQ(found.ruling, differs);
  EXPECT_EQ(found.runs, 15U);
  EXPECT_EQ(found.entered.rows.size(), 15U);
  EXPECT_EQ(verdict(0).ruling, agrees);
}

}  // namespace
}  // namespace shearcell::test
