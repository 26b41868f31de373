// SPDX-License-Identifier: GPL-3.0-or-later
// Random numbers, trigonometry, tilt and contact law: the arithmetic below everything else.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/contact.hpp"
#include "core/drive.hpp"
#include "core/random.hpp"
#include "core/trigonometry.hpp"

namespace shearcell {
namespace {

// Known answers published with the Random123 library (file kat_vectors, philox4x32 10 rounds).
TEST(Philox, KnownAnswers) {
  using W = std::array<std::uint32_t, 4>;
  EXPECT_EQ(philox4x32({0, 0, 0, 0}, {0, 0}), (W{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  const std::uint32_t f = 0xffffffff;
  EXPECT_EQ(philox4x32({f, f, f, f}, {f, f}), (W{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox4x32({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (W{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Philox, UniformNumbersFillTheUnitInterval) {
  double sum = 0, square = 0;
  constexpr int n = 20000;
  for (std::uint32_t i = 0; i < n; ++i) {
    for (const double u : uniform_pair({i, 0, 0, 0}, 1)) {
      ASSERT_GE(u, 0);
      ASSERT_LT(u, 1);
      sum += u;
      square += u * u;
    }
  }
  EXPECT_NEAR(sum / (2 * n), 0.5, 5 / std::sqrt(12.0 * 2 * n));
  EXPECT_NEAR(square / (2 * n), 1.0 / 3, 0.01);
}

TEST(Trigonometry, AgreesWithTheCLibrary) {
  for (int i = -1000; i <= 1000; ++i) {
    const double x = i * 1e-3 * std::numbers::pi / 2;
    const SineCosine sc = sine_cosine(x);
    EXPECT_NEAR(sc.sine, std::sin(x), 2.3e-16) << x;
    EXPECT_NEAR(sc.cosine, std::cos(x), 2.3e-16) << x;
  }
  EXPECT_TRUE(std::isnan(sine_cosine(2).sine));
  EXPECT_TRUE(std::isnan(sine_cosine(std::nan("")).cosine));
}

TEST(Trigonometry, TurnsAreExactAtTheQuartersAndPeriodic) {
  const std::uint64_t period = 45600;
  const double quarters[4][2] = {{0, 1}, {1, 0}, {0, -1}, {-1, 0}};
  for (std::uint64_t q = 0; q < 4; ++q) {
    const SineCosine sc = turn_sine_cosine(q * period / 4 + 1000000007 * period, period);
    EXPECT_EQ(sc.sine, quarters[q][0]) << q;
    EXPECT_EQ(sc.cosine, quarters[q][1]) << q;
  }
  for (std::uint64_t step = 0; step < 91; ++step) {
    const double x = 2 * std::numbers::pi * static_cast<double>(step) / 91;
    EXPECT_NEAR(turn_sine_cosine(step, 91).sine, std::sin(x), 1e-15) << step;
    EXPECT_NEAR(turn_sine_cosine(step, 91).cosine, std::cos(x), 1e-15) << step;
  }
}

TEST(Tilt, EndsEachCycleUprightAndRestsInThePause) {
  const Drive drive{0.0833, 100, 40};
  EXPECT_EQ(tilt(drive, 25).theta, 0.0833);
  EXPECT_EQ(tilt(drive, 75).theta, -0.0833);
  for (std::uint64_t cycle = 0; cycle < 3; ++cycle) {
    EXPECT_EQ(tilt(drive, 140 * cycle).theta, 0);
    EXPECT_EQ(tilt(drive, 140 * cycle).rate, 0.0833);
    for (std::uint64_t step = 100; step < 140; ++step) {
      EXPECT_EQ(tilt(drive, 140 * cycle + step).theta, 0);
      EXPECT_EQ(tilt(drive, 140 * cycle + step).rate, 0);
    }
  }
}

// The factor (1/r - 1) against its definition in extended precision.
TEST(ContactLaw, FactorIsAccurateToAFewUnitsInTheLastPlace) {
  double worst = 0;
  for (int i = 1; i < 4000; ++i) {
    const double s = i / 4000.0;
    const long double exact = 1 / std::sqrt(1 - static_cast<long double>(s)) - 1;
    const double error =
        std::fabs(static_cast<double>((contact_factor(s) - exact) / exact)) / 0x1p-53;
    // Beyond the series the subtraction costs at most a factor of r/(1-r) < 41.
    worst = std::max(worst, s <= kSeriesEnd ? error : error / 42);
  }
  EXPECT_LT(worst, 17) << "in units of 2^-53";
}

TEST(ContactLaw, SeriesJoinsTheClosedForm) {
  const double below = contact_factor(kSeriesEnd);
  const double above = contact_factor(std::nextafter(kSeriesEnd, 1));
  EXPECT_NEAR(below, above, 1e-14 * below);
  EXPECT_GT(contact_factor(1e-300), 0);
  EXPECT_EQ(contact_factor(0), 0);
  EXPECT_EQ(contact_factor(-1e30), 0);
  EXPECT_TRUE(std::isinf(contact_factor(1)));
}

}  // namespace
}  // namespace shearcell
