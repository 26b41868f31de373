// SPDX-License-Identifier: GPL-3.0-or-later
// Crystallites with known fates in clones: splitting, flicker, swallowing. The figure on fates that
// are drawn from a known probability.
#include "analysis/committor.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "tests/analysis/made_up_runs.hpp"

namespace shearcell::test {
namespace {

using Crystallite = std::vector<std::int32_t>;
using State = std::vector<Crystallite>;

/// Follows the first crystallite of the first state.
Followed follow_first(const std::vector<State>& states) {
  std::vector<CrystalliteMap> maps;
  for (const State& state : states) maps.push_back(map_of(state));
  std::vector<const CrystalliteMap*> pointers;
  for (const CrystalliteMap& map : maps) pointers.push_back(&map);
  return followed(pointers, 0);
}

Crystallite joined(Crystallite a, const Crystallite& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

using Sizes = std::vector<std::int32_t>;

TEST(Committor, FollowsTheCrystallitesThatHaveItsGrains) {
  const State start = {grain_ids(0, 5)};
  EXPECT_EQ(follow_first({start, {grain_ids(2, 9)}, {grain_ids(8, 70)}}).sizes, (Sizes{9, 70}));
  EXPECT_EQ(follow_first({start, {}, {grain_ids(4, 3)}}).sizes, (Sizes{0, 3})) << "flicker";
  EXPECT_EQ(follow_first({start, {grain_ids(0, 2)}}).sizes, Sizes{0}) << "two grains are too few";
  EXPECT_EQ(follow_first({start, {grain_ids(5, 40)}}).sizes, Sizes{0}) << "another place";
  EXPECT_FALSE(follow_first({start, {grain_ids(5, 40)}}).merged);
}

TEST(Committor, APieceOfASplitCrystalliteIsADescendant) {
  const State start = {grain_ids(0, 10)}, split = {grain_ids(0, 5), grain_ids(5, 4)};
  EXPECT_EQ(follow_first({start, split, {grain_ids(6, 60)}}).sizes, (Sizes{5, 60}));
  EXPECT_EQ(follow_first({start, split, {grain_ids(0, 12)}}).sizes, (Sizes{5, 12})) << "rejoined";
}

TEST(Committor, RemembersTheGrainsOfTheLastThreeCyclesWithADescendant) {
  const std::vector<State> moving = {
      {grain_ids(0, 4)}, {grain_ids(2, 4)}, {grain_ids(4, 4)}, {grain_ids(6, 4)}};
  const auto then = [&](const State& last) {
    std::vector<State> states = moving;
    states.push_back(last);
    return follow_first(states).sizes.back();
  };
  EXPECT_EQ(then({joined({2}, grain_ids(20, 3))}), 4);
  EXPECT_EQ(then({joined({0, 1}, grain_ids(20, 3))}), 0);
  EXPECT_EQ(follow_first({{grain_ids(0, 4)}, {}, {}, {}, {}, {grain_ids(3, 4)}}).sizes.back(), 4)
      << "cycles without a descendant are not counted";
}

TEST(Committor, TheLargerOfTwoThatMergeSwallowsTheOther) {
  const Crystallite small = grain_ids(0, 5), large = grain_ids(20, 9), both = joined(small, large);
  EXPECT_TRUE(follow_first({{small, large}, {both}}).merged);
  EXPECT_FALSE(follow_first({{large, small}, {both}}).merged);
  EXPECT_EQ(follow_first({{large, small}, {both}}).sizes, Sizes{14});
  const Crystallite as_large = grain_ids(20, 5);
  EXPECT_EQ(follow_first({{small, as_large}, {joined(small, as_large)}}).sizes, Sizes{10});
  EXPECT_EQ(follow_first({{small, large}, {joined({0, 1}, large)}}).sizes, Sizes{0})
      << "two of its five grains";
  EXPECT_FALSE(follow_first({{small, large}, {joined({0, 1}, large)}}).merged);
  const Followed later = follow_first({{small, large}, {small, large}, {both}, {both}});
  EXPECT_EQ(later.sizes, Sizes{5});
  EXPECT_TRUE(later.merged);
  EXPECT_FALSE(follow_first({{small, large}, {grain_ids(2, 3), joined({0, 1}, large)}}).merged)
      << "a piece goes on";
}

TEST(Committor, OneCrystalliteOfEachBinIsFollowed) {
  const CrystalliteMap map = map_of({grain_ids(0, 2), grain_ids(10, 6), grain_ids(20, 7),
                                     grain_ids(30, 3), grain_ids(40, 20), grain_ids(70, 21)});
  EXPECT_EQ(followed_in(map), (std::vector<std::int32_t>{3, 1, 4}));
}

TEST(Committor, TheFirstFateCounts) {
  const auto of = [](const Sizes& sizes, std::size_t cycles, bool merged = false) {
    return ending({sizes, merged}, cycles);
  };
  EXPECT_EQ(of({4, 59, 60, 0, 0}, 2).fate, Fate::grown);
  EXPECT_EQ(of({4, 0, 5, 0, 6}, 2).fate, Fate::undecided) << "not in a row";
  EXPECT_EQ(of({4, 0, 5, 0, 6}, 1).fate, Fate::gone);
  EXPECT_EQ(of({0, 0, 0}, 3).fate, Fate::gone);
  EXPECT_EQ(of({0, 0}, 3).fate, Fate::undecided);
  EXPECT_EQ(of({0, 0}, 3, true).fate, Fate::merged);
  EXPECT_EQ(of({0, 0}, 2, true).fate, Fate::gone) << "it was gone before";
  EXPECT_TRUE(of({0, 9, 60}, 1).revived);
  EXPECT_EQ(of({0, 9, 60}, 1).fate, Fate::gone);
  EXPECT_EQ(of({0, 9, 60}, 2).fate, Fate::grown);
  EXPECT_FALSE(of({0, 9, 59}, 1).revived);
}

// --- The figure ---

/// Clones of the states of one amplitude.
class Clones {
 public:
  explicit Clones(double amplitude) : amplitude_(amplitude) {}

  /// Four clones of a state with one crystallite of that size, or a control of size 0.
  void add(std::uint32_t packing, std::int32_t size, const std::function<Fate(double)>& fate) {
    const std::string variant = fmt::format("{},{},{}", amplitude_, packing, size);
    for (std::uint32_t clone = 0; clone < 4; ++clone) {
      const double u = uniform_pair({packing, static_cast<std::uint32_t>(size), clone, 3}, 11)[0];
      FrameRun run = made_up_run("state", variant, clone + 1, 3, [&, of = fate(u)](int n, auto& m) {
        m.crystallite_map = map_of(state(size, of, n));
      });
      run.packing = fmt::format("packing{}", packing);
      run.parameters["amplitude_rad"] = amplitude_;
      runs_.push_back(std::move(run));
    }
  }

  const std::vector<FrameRun>& runs() const { return runs_; }

 private:
  static State state(std::int32_t size, Fate fate, int cycle) {
    const Crystallite other = grain_ids(200, 40), own = grain_ids(0, size);
    State start = {other};
    if (size > 0) start.push_back(own);
    if (size == 0) start = {};
    if (cycle == 0 || fate == Fate::undecided) return start;
    if (fate == Fate::grown) return {grain_ids(0, 70)};
    if (fate == Fate::merged) return {joined(own, other)};
    return size == 0 ? State{} : State{other};
  }

  double amplitude_;
  std::vector<FrameRun> runs_;
};

double share_that_grows(std::int32_t size, double half, double slope = 2) {
  return 1 / (1 + std::pow(half / size, slope));
}

/// 40 packings with states of each size, whose clones grow with that probability unless `u` is
/// above `decided`.
void add_states(Clones& clones, const std::function<double(std::int32_t)>& p, double decided = 1,
                Fate otherwise = Fate::undecided) {
  for (std::uint32_t packing = 0; packing < 40; ++packing) {
    for (const std::int32_t size : {3, 4, 6, 9, 12, 18}) {
      clones.add(packing, size, [&](double u) {
        if (u > decided) return otherwise;
        return u < decided * p(size) ? Fate::grown : Fate::gone;
      });
    }
  }
}

void add_controls(Clones& clones, double grown) {
  for (std::uint32_t packing = 0; packing < 40; ++packing) {
    clones.add(packing, 0, [&](double u) { return u < grown ? Fate::grown : Fate::gone; });
  }
}

FigureResult figure_of(std::vector<FrameRun> runs) {
  return find_figure("committor")->make(runs);
}

/// A number of the row of that amplitude and rule.
double number_at(const FigureResult& figure, double amplitude, std::int64_t rule,
                 const std::string& column) {
  const Table& table = figure.tables.at(1);
  const auto k = static_cast<std::ptrdiff_t>(table.place(column));
  for (const TableRow& row : table.rows) {
    if (std::get<double>(row[0]) != amplitude || std::get<std::int64_t>(row[1]) != rule) continue;
    const TableCell& value = row.at(static_cast<std::size_t>(k));
    if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
    return std::holds_alternative<double>(value) ? std::get<double>(value) : std::nan("");
  }
  ADD_FAILURE() << "no such row";
  return 0;
}

TEST(CommittorFigure, FindsTheSizeOfAKnownProbability) {
  Clones clones(0.0833);
  add_states(clones, [](auto size) { return share_that_grows(size, 8); });
  add_controls(clones, 0);
  std::vector<FrameRun> others = clones.runs();  // seeds that settle packings of their own
  for (FrameRun& run : others) run.stage.parent = fmt::format("packing of {}", run.stage.id);
  EXPECT_EQ(number_at(figure_of(others), 0.0833, 2, "states"), 4 * 280) << "no clones";
  const FigureResult figure = figure_of(clones.runs());
  const auto at = [&](const char* column) { return number_at(figure, 0.0833, 2, column); };
  EXPECT_NEAR(at("half_size_grains"), 8, 0.8);
  EXPECT_LT(at("half_size_low_grains"), 8);
  EXPECT_GT(at("half_size_high_grains"), 8);
  EXPECT_LT(at("half_size_high_grains") - at("half_size_low_grains"), 2.5);
  EXPECT_EQ(at("half_size_grains"), at("not_corrected_grains"));
  EXPECT_EQ(at("states"), 280);
  EXPECT_EQ(at("packings"), 40);
  EXPECT_EQ(at("crystallites"), 240);
  EXPECT_EQ(at("grown") + at("gone"), 960);
  EXPECT_EQ(at("control_states"), 40);
  ASSERT_EQ(figure.verdicts.size(), 1U);
  EXPECT_EQ(figure.verdicts[0].ruling, Ruling::differs) << "the supplement has 16";
  EXPECT_EQ(figure.verdicts[0].runs, 40U) << "packings";
}

TEST(CommittorFigure, UndecidedAndMergedClonesAreLeftOutAndCounted) {
  for (const Fate otherwise : {Fate::undecided, Fate::merged}) {
    Clones clones(0.0833);
    add_states(
        clones, [](auto size) { return share_that_grows(size, 8); }, 0.7, otherwise);
    add_controls(clones, 0);
    const FigureResult figure = figure_of(clones.runs());
    const auto at = [&](const char* column) { return number_at(figure, 0.0833, 2, column); };
    EXPECT_NEAR(at("half_size_grains"), 8, 1);
    EXPECT_NEAR(at(otherwise == Fate::merged ? "merged" : "undecided"), 0.3 * 960, 60);
    if (otherwise == Fate::merged) continue;
    EXPECT_LT(at("undecided_as_grown_grains"), at("half_size_grains"));
    EXPECT_GT(at("undecided_as_gone_grains"), at("half_size_grains"));
  }
}

// p = q + (1 - q) p0, with p0 = 1/2 at 8 grains.
TEST(CommittorFigure, SubtractsTheBackgroundOfTheControls) {
  const double q = 0.3;
  Clones clones(0.0833);
  add_states(clones, [](auto size) { return 0.3 + 0.7 * share_that_grows(size, 8, 4); });
  add_controls(clones, q);
  const FigureResult figure = figure_of(clones.runs());
  EXPECT_NEAR(number_at(figure, 0.0833, 2, "half_size_grains"), 8, 1.5);
  EXPECT_LT(number_at(figure, 0.0833, 2, "not_corrected_grains"), 7);
  EXPECT_NEAR(number_at(figure, 0.0833, 2, "control_share"), q, 0.1);
}

TEST(CommittorFigure, SaysThatNoSizeIsDefinedWhereTheControlsGrowAsOften) {
  Clones clones(0.1);
  add_states(clones, [](auto size) { return size < 5 ? 0.3 : 0.7; });
  add_controls(clones, 0.45);
  const FigureResult figure = figure_of(clones.runs());
  EXPECT_TRUE(std::isnan(number_at(figure, 0.1, 2, "half_size_grains")));
  EXPECT_GT(number_at(figure, 0.1, 2, "not_corrected_grains"), 3);
  const Verdict& verdict = figure.verdicts.at(0);
  EXPECT_FALSE(verdict.estimate);
  EXPECT_NE(verdict.note.find("no critical size is defined"), std::string::npos) << verdict.note;
}

TEST(CommittorFigure, ComparesTheTwoLargestAmplitudes) {
  for (const double half : {6.0, 12.0}) {
    Clones low(0.0833), high(0.1);
    add_states(low, [](auto size) { return share_that_grows(size, 8.5); });
    add_states(high, [&](auto size) { return share_that_grows(size, half); });
    add_controls(low, 0);
    add_controls(high, 0);
    std::vector<FrameRun> runs = low.runs();
    runs.insert(runs.end(), high.runs().begin(), high.runs().end());
    const FigureResult figure = figure_of(runs);
    ASSERT_EQ(figure.verdicts.size(), 3U);
    EXPECT_EQ(figure.verdicts[2].ruling, half > 8.5 ? Ruling::supported : Ruling::refuted);
    EXPECT_EQ(figure.verdicts[2].runs, 40U) << "packings of each";
  }
}

TEST(CommittorFigure, AStateThatHasGrownIsLeftOut) {
  Clones clones(0.1);
  add_states(clones, [](auto size) { return share_that_grows(size, 8); });
  clones.add(50, 70, [](double) { return Fate::gone; });
  EXPECT_EQ(number_at(figure_of(clones.runs()), 0.1, 2, "states_left_out"), 1);
  EXPECT_NE(
      figure_of(clones.runs()).verdicts[0].note.find("fraction of controls that grow is unknown"),
      std::string::npos)
      << "no controls";
}

}  // namespace
}  // namespace shearcell::test
