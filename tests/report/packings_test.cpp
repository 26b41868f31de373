// SPDX-License-Identifier: GPL-3.0-or-later
// Which checkpoints a report shows.
#include "experiments/report/packings.hpp"

#include <gtest/gtest.h>

#include "provenance/errors.hpp"
#include "tests/experiments/temporary_store.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

using List = std::vector<std::size_t>;

TEST(Evenly, TakesTheFirstAndTheLast) {
  EXPECT_EQ(evenly(6, 3), (List{0, 3, 5}));
  EXPECT_EQ(evenly(121, 4), (List{0, 40, 80, 120}));
  EXPECT_EQ(evenly(3, 9), (List{0, 1, 2}));
  EXPECT_EQ(evenly(5, 1), List{4});
  EXPECT_EQ(evenly(0, 3), List{});
  EXPECT_EQ(evenly(3, 0), List{});
}

class PackingsOf : public StoreTest {
 protected:
  PackingsOf() {
    // Two variants of two seeds each, cycles 0 to 2.
    compute(store_, tiny_manifest("", kBothFluids + "seeds: 2\n"));
  }

  Packings collect(const PackingChoice& choice) {
    return collect_packings(store_, {"tiny"}, {}, choice, 2, {});
  }
};

TEST_F(PackingsOf, ShowTheLastRunOfEachVariant) {
  const Packings packings = collect({});
  ASSERT_EQ(packings.runs.size(), 2U);
  EXPECT_EQ(packings.frames, 6U);
  for (const auto& run : packings.runs) {
    EXPECT_TRUE(has(run.at("label").get<std::string>(), "seed 2"));
    EXPECT_EQ(run.at("frames").size(), 3U);
    EXPECT_EQ(run.at("grains"), kGrains);
  }
  EXPECT_GT(packings.largest_step, 0);
  EXPECT_TRUE(packings.notes.empty());
}

TEST_F(PackingsOf, DoNotDependOnTheNumberOfWorkers) {
  const auto with = [&](std::size_t workers) {
    return collect_packings(store_, {"tiny"}, {}, {}, workers, {}).runs.dump();
  };
  EXPECT_EQ(with(1), with(4));
}

TEST_F(PackingsOf, KeepToTheirBudget) {
  const std::size_t all = collect({}).runs.dump().size();
  PackingChoice choice;
  choice.budget = all / 2;
  const Packings half = collect(choice);
  EXPECT_LT(half.runs.dump().size(), choice.budget);
  ASSERT_EQ(half.runs.size(), 2U);
  EXPECT_EQ(half.runs[0]["frames"].back()["name"], "cycle 2") << "the last one is kept";

  choice.budget = all / 4;
  const Packings one = collect(choice);
  EXPECT_EQ(one.runs.size(), 1U);
  EXPECT_EQ(one.notes.size(), 1U);

  choice.budget = 0;
  const Packings none = collect(choice);
  EXPECT_TRUE(none.runs.empty());
  ASSERT_EQ(none.notes.size(), 1U);
  EXPECT_TRUE(has(none.notes[0], "no room for the packings of 2 runs"));
}

TEST_F(PackingsOf, CanBeSelectedByName) {
  PackingChoice choice;
  choice.runs = {runs_of_kind(store_, "shear").front().id};
  const Packings packings = collect(choice);
  ASSERT_EQ(packings.runs.size(), 1U);
  EXPECT_EQ(packings.runs[0]["id"], choice.runs[0]);
  choice.runs = {std::string(64, '0')};
  EXPECT_THROW(collect(choice), NotFound);
}

TEST_F(PackingsOf, LeaveOutAndReportDamagedCheckpoints) {
  const std::string run = runs_of_kind(store_, "shear").back().id;
  truncate_file(store_.folder() / store_.checkpoints(run).back().file);
  const Packings packings = collect({});
  ASSERT_EQ(packings.damage.size(), 1U);
  EXPECT_EQ(packings.frames, 5U);
}

}  // namespace
}  // namespace shearcell::test
