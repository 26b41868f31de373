// SPDX-License-Identifier: GPL-3.0-or-later
// Random numbers, trigonometry, tilt, walls and contact law: the arithmetic below everything else.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/cell.hpp"
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
  for (std::uint64_t step = 0; step < 100; ++step) {
    const double turned = 2 * std::numbers::pi * static_cast<double>(step) / 100;
    EXPECT_NEAR(tilt(drive, 140 + step).theta, 0.0833 * std::sin(turned), 1e-16) << step;
    EXPECT_NEAR(tilt(drive, 140 + step).rate, 0.0833 * std::cos(turned), 1e-16) << step;
  }
}

// The walls tilt about the top one, which is fixed in x; the bottom one moves as one body.
TEST(WallPose, IsThatOfASimpleShear) {
  for (const MovingWall moving : {MovingWall::bottom, MovingWall::top}) {
    Cell cell{.width = 7, .depth = 5, .bottom = 1, .top = 9, .moving = moving};
    for (const WallSide side : {WallSide::left, WallSide::right, WallSide::bottom, WallSide::top}) {
      cell.wall_grains.push_back({side, {0.25, 3, 2}});
    }
    for (const double theta : {-0.5, -1e-3, 0.0, 1e-9, 0.0833, 0.4}) {
      SCOPED_TRACE(theta);
      const double height = moving == MovingWall::bottom ? 1.75 : 8.5;
      const double bottom = moving == MovingWall::bottom ? height : 1;
      const double top = moving == MovingWall::top ? height : 9;
      const WallPose pose = wall_pose(cell, theta, height);
      EXPECT_NEAR(pose.sin_theta, std::sin(theta), 1e-15);
      EXPECT_NEAR(pose.cos_theta, std::cos(theta), 1e-15);
      EXPECT_NEAR(pose.tan_theta, std::tan(theta), 1e-15);
      EXPECT_EQ(pose.bottom, bottom);
      EXPECT_EQ(pose.top, top);
      const auto displaced = [&](double y) { return (y - top) * std::tan(theta); };
      const Eigen::Vector3d right[] = {{0.25 + displaced(3), 3, 2},
                                       {0.25 + displaced(3), 3, 2},
                                       {0.25 + displaced(bottom), 3 + bottom - 1, 2},
                                       {0.25, 3 + top - 9, 2}};
      const Eigen::Matrix3Xd grains = wall_grain_positions(cell, pose);
      for (Eigen::Index i = 0; i < 4; ++i) EXPECT_LT((grains.col(i) - right[i]).norm(), 1e-14) << i;
      const std::array planes = wall_planes(cell, pose);
      for (const double y : {0.0, 2.5, 11.0}) {
        EXPECT_NEAR(distance_to(planes[0], displaced(y), y), 0, 1e-14);
        EXPECT_NEAR(distance_to(planes[1], 7 + displaced(y), y), 0, 1e-14);
        EXPECT_GT(distance_to(planes[0], displaced(y) + 1, y), 0.8);
        EXPECT_GT(distance_to(planes[1], 6 + displaced(y), y), 0.8);
        EXPECT_EQ(distance_to(planes[2], 3, y), y - bottom);
        EXPECT_EQ(distance_to(planes[3], 3, y), top - y);
      }
    }
  }
}

TEST(NearestImage, IsTheSmallestOfAll) {
  for (const double depth : {3.0, 5.7, 1e4}) {
    for (int i = -300; i <= 300; ++i) {
      const double dz = depth * (0.01 * i + 1e-3);
      double smallest = dz;
      for (int image = -4; image <= 4; ++image) {
        const double one = dz + image * depth;
        if (std::fabs(one) < std::fabs(smallest)) smallest = one;
      }
      EXPECT_NEAR(nearest_image(dz, depth, 1 / depth), smallest, 1e-14 * depth) << dz;
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
