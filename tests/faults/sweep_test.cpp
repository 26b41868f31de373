// SPDX-License-Identifier: GPL-3.0-or-later
// Wherever the machine fails or the process dies, what was recorded stays, and running on ends in
// the same bits. Each operation on the store's files goes wrong in turn, in each way that fits it.
#include <gtest/gtest.h>
#include <signal.h>

#include <cstdio>
#include <set>

#include "tests/experiments/temporary_store.hpp"
#include "tests/faults/campaign.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

using Hashes = std::map<std::string, std::string>;

class Faults : public testing::Test {
 protected:
  Faults() {
    const TemporaryFolder folder;
    std::ofstream(folder.path() / "small.yaml") << small_manifest();
    operations_ = list_operations(folder.path());
    golden_ = run_on(folder.path());
  }

  std::vector<Fault> points() const { return fault_points(operations_); }

  void survive(const Fault& fault) {
    const TemporaryFolder folder;
    std::ofstream(folder.path() / "small.yaml") << small_manifest();
    const int code = wait_for_exit(start_campaign(folder.path(), fault));
    ++outcomes_[code];
    const std::string where =
        fault.kind + " at " + operations_.at(static_cast<std::size_t>(fault.at - 1));
    EXPECT_TRUE(code >= 0 || code == -SIGKILL) << where << ": signal " << -code;
    const bool dies = fault.kind == "kill" || fault.kind == "torn";
    EXPECT_TRUE(!dies || code == -SIGKILL) << where << ": code " << code;
    for (const std::string& wrong : check_left_behind(folder.path())) {
      ADD_FAILURE() << where << " (ended with " << code << "): " << wrong << "\n"
                    << read_bytes(folder.path() / "said");
    }
    try {
      EXPECT_EQ(run_on(folder.path()), golden_) << where;
      const Store store(folder.path() / "store", Access::read);
      EXPECT_TRUE(store.verify().ok()) << where;
      EXPECT_TRUE(store.leases().empty()) << where;
    } catch (const std::exception& error) {
      ADD_FAILURE() << where << ": running on: " << error.what();
    }
  }

  void sweep(std::size_t every) {
    ASSERT_EQ(golden_.size(), 3U);
    const std::vector<Fault> all = points();
    std::size_t tried = 0;
    for (std::size_t i = 0; i < all.size(); i += every) {
      survive(all[i]);
      ++tried;
      if (testing::Test::HasFailure() && ++failures_ > 5) break;
    }
    std::printf("%zu of %zu fault points (%zu operations) tried; the program ended", tried,
                all.size(), operations_.size());
    for (const auto& [code, count] : outcomes_) {
      std::printf(" %d times with %s%d,", count, code < 0 ? "signal " : "code ", std::abs(code));
    }
    std::printf(" and ran on to the golden states\n");
  }

  std::vector<std::string> operations_;
  Hashes golden_;
  std::map<int, int> outcomes_;
  int failures_ = 0;
};

TEST_F(Faults, SomePointsLeaveNoTrace) {
  sweep(points().size() / 40);
}

// With the label `sweep`.
TEST_F(Faults, DISABLED_EveryPointLeavesNoTrace) {
  ASSERT_GE(points().size(), 1000U);
  sweep(1);
}

}  // namespace
}  // namespace shearcell::test
