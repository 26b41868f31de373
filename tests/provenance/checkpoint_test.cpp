// SPDX-License-Identifier: GPL-3.0-or-later
// A checkpoint returns every bit of the state, and equal states give equal bytes.
#include "provenance/checkpoint.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <thread>
#include <tuple>

#include "provenance/errors.hpp"
#include "provenance/limits.hpp"
#include "tests/provenance/samples.hpp"

namespace shearcell {
namespace {

using test::sample_checkpoint;
using Limits = std::numeric_limits<double>;

Checkpoint hard_checkpoint() {
  Checkpoint c = sample_checkpoint(test::run_id(1));
  c.state.position.col(0) << -0.0, Limits::denorm_min(), -Limits::denorm_min();
  c.state.position.col(1) << Limits::max(), -Limits::max(), Limits::min();
  c.state.velocity.col(2) << -0.0, 0.1, std::nextafter(1.0, 2.0);
  c.state.wall_velocity = -0.0;
  c.state.step = std::numeric_limits<std::uint64_t>::max();
  c.cell.moving = MovingWall::top;
  return c;
}

void expect_same(const Checkpoint& a, const Checkpoint& b) {
  EXPECT_EQ(state_hash(a), state_hash(b));  // of the state and the cell
  const auto rest = [](const Checkpoint& c) {
    const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
    return std::tuple(c.run, bits(c.time_s), bits(c.cycle), bits(c.theta), bits(c.units.diameter_m),
                      bits(c.units.mass_kg), c.observables);
  };
  EXPECT_EQ(rest(a), rest(b));
}

TEST(Checkpoint, RestoresEveryBit) {
  const Checkpoint written = hard_checkpoint();
  expect_same(decode_checkpoint(encode_checkpoint(written)), written);
}

TEST(Checkpoint, HoldsACellWithoutWallGrainsGrainsOrObservables) {
  Checkpoint bare = sample_checkpoint("", 0, 0);
  bare.cell.wall_grains.clear();
  bare.observables.clear();
  expect_same(decode_checkpoint(encode_checkpoint(bare)), bare);
}

// An analysis of such a cell would take memory for each of its layers or periodic images.
TEST(Checkpoint, OfACellThatNoRunCanHaveIsRefused) {
  const Checkpoint sound = sample_checkpoint("", 0, 20);
  EXPECT_NO_THROW(require_plausible(sound));
  Checkpoint tall = sound, flat = sound, wide = sound;
  tall.cell.top = 5e5;
  flat.cell.depth = 1e-3 * flat.cell.width;
  wide.cell.width = wide.cell.depth = 1e5;
  for (const Checkpoint& forged : {tall, flat, wide}) {
    EXPECT_THROW(require_plausible(forged), StoreDamaged);
  }
}

TEST(Checkpoint, GivesTheSameBytesEachTime) {
  const Checkpoint c = hard_checkpoint();
  const std::vector<std::byte> first = encode_checkpoint(c);
  encode_checkpoint(sample_checkpoint("other", 1, 500));  // leaves other bytes in freed memory
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // times are kept in seconds
  EXPECT_EQ(encode_checkpoint(c), first);
  std::printf("%zu bytes for %d grains and %zu wall grains\n", first.size(),
              static_cast<int>(c.state.position.cols()), c.cell.wall_grains.size());
}

TEST(Checkpoint, TakesAboutAHundredAndTwentyBytesPerGrain) {
  const std::size_t small = encode_checkpoint(sample_checkpoint("a", 1, 1000)).size();
  const std::size_t large = encode_checkpoint(sample_checkpoint("a", 1, 3000)).size();
  const double per_grain = static_cast<double>(large - small) / 2000;
  std::printf("%.1f bytes per grain, %zu bytes for the rest\n", per_grain,
              small - static_cast<std::size_t>(per_grain * 1000));
  EXPECT_LT(per_grain, 125);
}

TEST(Checkpoint, StateHashCoversWhatARunContinuesFrom) {
  const Checkpoint c = hard_checkpoint();
  Checkpoint same = c;
  same.observables.clear();
  same.run = "another";
  EXPECT_EQ(state_hash(same), state_hash(c));
  const auto changed = [&c](auto&& change) {
    Checkpoint other = c;
    change(other);
    return state_hash(other) != state_hash(c);
  };
  EXPECT_TRUE(changed([](Checkpoint& o) { o.state.step -= 1; }));
  EXPECT_TRUE(changed([](Checkpoint& o) { o.state.position(0, 0) = 0.0; }));  // it was -0.0
  EXPECT_TRUE(changed([](Checkpoint& o) { o.state.velocity(2, 5) += 1e-15; }));
  EXPECT_TRUE(changed([](Checkpoint& o) { o.state.wall_velocity = 0.0; }));
  EXPECT_TRUE(changed([](Checkpoint& o) { o.cell.moving = MovingWall::bottom; }));
  EXPECT_TRUE(changed([](Checkpoint& o) { o.state.wall_height += 1e-9; }));
  for (double Cell::*length : {&Cell::width, &Cell::depth, &Cell::bottom, &Cell::top}) {
    EXPECT_TRUE(changed([length](Checkpoint& o) { o.cell.*length += 1e-9; }));
  }
  EXPECT_TRUE(changed([](Checkpoint& o) { o.cell.wall_grains.pop_back(); }));
  EXPECT_TRUE(changed([](Checkpoint& o) { o.cell.wall_grains[2].position.z() += 1e-9; }));
  EXPECT_TRUE(changed([](Checkpoint& o) { o.cell.wall_grains[0].side = WallSide::right; }));
}

TEST(Checkpoint, DoesNotWriteWhatItCouldNotRead) {
  const auto refused = [](auto&& change) {
    Checkpoint c = sample_checkpoint("a");
    change(c);
    EXPECT_THROW(encode_checkpoint(c), std::invalid_argument);
  };
  refused([](Checkpoint& c) { c.state.position(1, 3) = Limits::quiet_NaN(); });
  refused([](Checkpoint& c) { c.state.velocity(1, 3) = Limits::infinity(); });
  refused([](Checkpoint& c) { c.state.velocity.conservativeResize(3, 4); });
  refused([](Checkpoint& c) { c.theta = Limits::quiet_NaN(); });
  refused([](Checkpoint& c) { c.observables["phi"] = Limits::quiet_NaN(); });
  refused([](Checkpoint& c) { c.observables["a/b"] = 1; });
  refused([](Checkpoint& c) { c.observables[""] = 1; });
  refused([](Checkpoint& c) { c.observables[std::string(StoreLimits::text + 1, 'x')] = 0; });
  refused([](Checkpoint& c) {
    for (std::size_t k = 0; k <= StoreLimits::observables; ++k)
      c.observables[std::to_string(k)] = 0;
  });
}

}  // namespace
}  // namespace shearcell
