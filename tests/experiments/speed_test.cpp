// SPDX-License-Identifier: GPL-3.0-or-later
// The measured speed beside the limits of the machine.
#include "experiments/bench/speed.hpp"

#include <gtest/gtest.h>

#include "experiments/bench/machine_limit.hpp"

namespace shearcell {
namespace {

TEST(Speed, WorkOfAStepGrowsWithItsSlots) {
  for (const std::size_t lanes : {1, 2, 4, 8}) {
    const auto grains = static_cast<double>(lanes);
    const bench::StepWork none = bench::step_work(lanes, 0);
    const bench::StepWork ten = bench::step_work(lanes, 10);
    // An offset of four bytes in each slot of each lane, and at least a position's difference (3)
    // and its square (3) for each vector.
    EXPECT_NEAR(ten.bytes - none.bytes, 40, 1e-9) << lanes;
    EXPECT_GE(ten.vector_operations - none.vector_operations, 10 * 6 / grains) << lanes;
    // Two positions, two velocities, and the reference in single precision.
    EXPECT_GE(none.bytes, 2 * 24 + 2 * 24 + 12) << lanes;
    EXPECT_LT(bench::step_footprint(lanes, 10), ten.bytes) << lanes;
  }
}

TEST(Speed, NoKernelIsFasterThanTheMachine) {
  SpeedOptions options;
  options.sizes = {200};
  options.repeats = 1;
  options.seconds_per_repeat = 0.05;
  for (const SpeedResult& result : measure_speed(options)) {
    SCOPED_TRACE(result.simd);
    EXPECT_GT(result.fastest_rate, 0);
    EXPECT_LT(result.fastest_rate, result.arithmetic_limit);
    EXPECT_LT(result.fastest_rate, result.memory_limit);
    // Six neighbours in a dense packing, at the least.
    EXPECT_GT(result.bytes_per_step, bench::step_work(1, 6).bytes - 9);
    EXPECT_LT(result.bytes_per_step, 300);
  }
}

}  // namespace
}  // namespace shearcell
