// SPDX-License-Identifier: GPL-3.0-or-later
// A run has one holder at a time, and a dead holder loses its lease.
#include "provenance/lease.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <thread>

#include "core/threads.hpp"
#include "provenance/io/clock.hpp"
#include "tests/provenance/samples.hpp"

namespace shearcell {
namespace {

using namespace std::chrono_literals;
using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

class LeaseTest : public ::testing::Test {
 protected:
  LeaseTest() {
    Store store(path_, Access::create);
    for (int i = 0; i < 2; ++i) store.declare_stage(sample_run(i));
  }

  Store open(double lease_seconds = 60) { return Store(path_, Access::write, lease_seconds); }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "store";
  const std::string id_ = run_id(1);
};

TEST_F(LeaseTest, KeepsOthersFromARunThatIsHeld) {
  Store first = open();
  Store second = open();
  first.start_stage(id_, {});
  EXPECT_THROW(first.start_stage(id_, {}), ConcurrencyConflict) << "it holds the run already";
  expect_refused<ConcurrencyConflict>(
      [&] { second.start_stage(id_, {}); },
      {"another program is computing it", "process " + std::to_string(getpid())});
  const std::vector<Lease> leases = second.leases();
  ASSERT_EQ(leases.size(), 1u);
  EXPECT_EQ(leases[0].run, id_);
  EXPECT_EQ(leases[0].attempt, 1u);
  EXPECT_EQ(leases[0].holder.pid, static_cast<std::uint64_t>(getpid()));
  second.start_stage(run_id(0), {});  // another run is free
  first.record_checkpoint(id_, sample_checkpoint(id_));
  first.complete_stage(id_);
  EXPECT_EQ(second.leases().size(), 1u);
  EXPECT_THROW(second.start_stage(id_, {}), ConcurrencyConflict) << "it is completed";
}

TEST_F(LeaseTest, IsReleasedWhenTheStoreIsClosed) {
  { open().start_stage(id_, {}); }
  Store second = open();
  EXPECT_TRUE(second.leases().empty());
  EXPECT_EQ(second.start_stage(id_, {}), 2u);
}

TEST_F(LeaseTest, ExpiresUnlessItIsRenewed) {
  Store first = open(0.4);
  Store second = open();
  first.start_stage(id_, {});
  for (int i = 0; i < 6; ++i) {
    std::this_thread::sleep_for(100ms);
    first.renew_leases();
    expect_refused<ConcurrencyConflict>([&] { second.start_stage(id_, {}); },
                                        {"another program is computing it"});
  }
  std::this_thread::sleep_for(500ms);
  EXPECT_TRUE(first.holds(id_)) << "nobody took it";
  EXPECT_EQ(second.start_stage(id_, {}), 2u);
  first.renew_leases();
  EXPECT_FALSE(first.holds(id_));
  EXPECT_THROW(first.record_checkpoint(id_, sample_checkpoint(id_)), ConcurrencyConflict);
  EXPECT_EQ(second.leases().at(0).attempt, 2u) << "the late one renewed what was not its own";
  second.record_checkpoint(id_, sample_checkpoint(id_));
}

TEST_F(LeaseTest, OfARunThatAnotherProgramCompletedIsLost) {
  Store late = open(0);
  late.start_stage(id_, {});
  Store other = open();
  other.start_stage(id_, {});
  other.complete_stage(id_);
  ASSERT_TRUE(other.leases().empty());
  expect_refused<ConcurrencyConflict>([&] { late.record_checkpoint(id_, sample_checkpoint(id_)); },
                                      {"another process continued"});
  EXPECT_FALSE(late.holds(id_));
  EXPECT_THROW(late.interrupt_stage(id_, "late"), ConcurrencyConflict);
  EXPECT_TRUE(other.checkpoints(id_).empty());
}

TEST_F(LeaseTest, IsNotRenewedForARunThatAnotherProgramContinued) {
  Store late = open(0.01);
  late.start_stage(id_, {});
  std::this_thread::sleep_for(20ms);
  Store other = open();
  other.start_stage(id_, {});
  other.interrupt_stage(id_, "SIGTERM");
  late.renew_leases();
  EXPECT_FALSE(late.holds(id_));
  EXPECT_EQ(other.start_stage(id_, {}), 3u);
}

TEST_F(LeaseTest, OfADeadProcessIsFreeAtOnce) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    Store store(path_, Access::write);
    store.start_stage(id_, {});
    raise(SIGKILL);
  }
  // Dead, whether somebody has waited for it or not.
  siginfo_t ended{};
  ASSERT_EQ(waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT), 0);
  Store store = open();
  EXPECT_TRUE(store.leases().empty());
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
  EXPECT_TRUE(store.leases().empty());
  EXPECT_EQ(store.stage(id_).state, StageState::running);
  EXPECT_EQ(store.start_stage(id_, {}), 2u);
}

TEST_F(LeaseTest, OfAnotherMachineMustExpire) {
  const std::uint64_t now = now_ms();
  Lease lease{.run = id_,
              .holder = this_process(),
              .attempt = 1,
              .renewed_at_ms = now,
              .expires_at_ms = now + 60'000};
  EXPECT_FALSE(lapsed(lease, now));
  EXPECT_FALSE(lapsed(lease, now + 59'999));
  EXPECT_TRUE(lapsed(lease, now + 60'000));
  EXPECT_TRUE(lapsed(lease, now - 3'600'000)) << "the clock was set back by an hour";
  lease.expires_at_ms = now + 1'000'000'000'000;
  EXPECT_TRUE(lapsed(lease, now + 60'000)) << "an end that no program writes";
  lease.holder.started += 1;  // another process got the id of one that is dead
  EXPECT_TRUE(lapsed(lease, now));
  lease.holder.place = "another boot or container";
  EXPECT_FALSE(lapsed(lease, now)) << "nothing is known of processes there";
}

TEST_F(LeaseTest, IsGrantedToOneOfMany) {
  std::atomic<int> won = 0, refused = 0;
  start_threads(9, [&](std::size_t) {
    Store store = open();
    try {
      store.start_stage(id_, {});
      ++won;
    } catch (const ConcurrencyConflict& conflict) {
      EXPECT_TRUE(has(conflict.what(), "another program is computing it"));
      ++refused;
    }
    while (won + refused < 8) std::this_thread::sleep_for(1ms);
  });
  EXPECT_EQ(won, 1);
  EXPECT_EQ(refused, 7);
}

TEST_F(LeaseTest, DoesNotStartFromAnOutdatedState) {
  Store first = open();
  Store second = open();
  first.start_stage(id_, {});
  const auto one = first.record_checkpoint(id_, sample_checkpoint(id_, 45600));
  const auto two = first.record_checkpoint(id_, sample_checkpoint(id_, 91200));
  first.interrupt_stage(id_, "SIGTERM");
  EXPECT_THROW(second.start_stage(id_, {}, one.sha256), ConcurrencyConflict);
  EXPECT_EQ(second.start_stage(id_, {}, two.sha256), 2u);
}

TEST_F(LeaseTest, IsNotAProjection) {
  Store first = open();
  first.start_stage(id_, {});
  Store second = open();
  second.rebuild();
  EXPECT_TRUE(second.verify().ok());
  EXPECT_EQ(second.leases().size(), 1u) << "rebuild took the lease away";
  EXPECT_NO_THROW(first.record_checkpoint(id_, sample_checkpoint(id_)));
}

// What `status` reads, again and again, beside a program that records.
TEST_F(LeaseTest, ReadersDelayAWriterByMillisecondsAtMost) {
  Store writer = open();
  writer.start_stage(id_, {});
  std::atomic<bool> done = false;
  std::atomic<int> reads = 0;
  std::thread reader([&] {
    while (!done) {
      const Store store(path_, Access::read);
      store.stages();
      store.leases();
      ++reads;
    }
  });
  double longest = 0;
  for (std::uint64_t step = 1; step <= 50; ++step) {
    const auto start = std::chrono::steady_clock::now();
    writer.record_checkpoint(id_, sample_checkpoint(id_, step));
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    longest = std::max(longest, took.count());
  }
  done = true;
  reader.join();
  std::printf("50 records beside %d reads: the longest took %.1f ms\n", reads.load(),
              1e3 * longest);
  EXPECT_GT(reads, 10);
  EXPECT_LT(longest, 5) << "far from SQLite's 30 s, on a machine that others use too";
}

}  // namespace
}  // namespace shearcell
