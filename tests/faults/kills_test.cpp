// SPDX-License-Identifier: GPL-3.0-or-later
// Two programs share a store and one of them is killed repeatedly, at random times: together they
// end in the same bits as one undisturbed program.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <cstdio>
#include <random>
#include <thread>

#include "tests/experiments/temporary_store.hpp"
#include "tests/faults/campaign.hpp"

namespace shearcell::test {
namespace {

class Kills : public testing::Test {
 protected:
  void kill_and_go_on(std::size_t kills) {
    // Runs long enough that a kill finds work in progress, and seeds enough that there is always
    // more.
    const std::string text = small_manifest("seeds: " + std::to_string(2 + kills) + "\n", 40);
    const auto golden = undisturbed(text);
    const TemporaryFolder shared;
    write_bytes(shared.path() / "small.yaml", text);
    std::mt19937 random(4);
    pid_t programs[2] = {start_campaign(shared.path(), {}), start_campaign(shared.path(), {})};
    std::size_t found_at_work = 0;
    for (std::size_t i = 0; i < kills; ++i) {
      std::this_thread::sleep_for(std::chrono::microseconds(1000 + random() % 120000));
      pid_t& victim = programs[random() % 2];
      kill(victim, SIGKILL);
      found_at_work += wait_for_exit(victim) == -SIGKILL ? 1 : 0;
      if (i % 10 == 0) {  // it takes a while, in which the other one comes forward undisturbed
        for (const std::string& wrong : check_left_behind(shared.path(), false))
          ADD_FAILURE() << wrong;
      }
      victim = start_campaign(shared.path(), {});
    }
    for (const pid_t program : programs) {
      EXPECT_EQ(wait_for_exit(program), 0) << read_bytes(shared.path() / "said");
    }
    const Store store(shared.path() / "store", Access::read);
    EXPECT_EQ(final_hashes(store), golden);
    std::size_t interrupted = 0;
    for (const Stage& run : store.stages()) {
      EXPECT_EQ(run.state, StageState::completed);
      interrupted += run.attempts - 1;
    }
    EXPECT_TRUE(store.verify().ok());
    std::printf("%zu kills, %zu of them at work, %zu runs cut short; %zu runs, the golden states\n",
                kills, found_at_work, interrupted, golden.size());
    EXPECT_GE(2 * found_at_work, kills) << "too little work for so many kills";
  }
};

TEST_F(Kills, OfTwoProgramsLeaveNoTrace) {
  kill_and_go_on(4);
}

// With the label `sweep`.
TEST_F(Kills, DISABLED_HundredOfTwoProgramsLeaveNoTrace) {
  kill_and_go_on(100);
}

}  // namespace
}  // namespace shearcell::test
