// SPDX-License-Identifier: GPL-3.0-or-later
// g(r) and S(k): sums over all pairs and all grains, grains at random, a lattice. tests/export
// compares pair counts with LAMMPS.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "analysis/packing_fraction.hpp"
#include "core/contact.hpp"
#include "tests/analysis/packings.hpp"

namespace shearcell::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double pair_bin_d = 0.02, wave_bin_per_d = 0.25;

std::vector<std::uint8_t> interior_of(const Packing& p) {
  return interior_grains(p.cell, p.pose, p.grains);
}

TEST(PairStructure, TheInteriorRegionHoldsTheInteriorGrains) {
  for (const double theta : {0.0, 0.1, -0.2}) {
    Packing p = empty_cell(14, 12, 8, theta);
    fill(p, 3000, 0, 5);
    const InteriorRegion region = interior_region(p.cell, p.pose);
    const std::vector<std::uint8_t> interior = interior_of(p);
    for (Eigen::Index i = 0; i < p.grains.cols(); ++i) {
      const double y = p.grains(1, i) - region.bottom;
      const double x = p.grains(0, i) - region.left - region.tan_theta * y;
      const bool inside = x >= 0 && x <= region.width && y >= 0 && y <= region.height;
      EXPECT_EQ(inside, interior[static_cast<std::size_t>(i)] != 0);
    }
  }
}

/// The curve of a provider of that name.
MeasuredCurve measured(const char* name, const Packing& p,
                       const std::vector<std::uint8_t>& interior) {
  const Checkpoint checkpoint = checkpoint_of(p);
  Analysis analysis;
  analysis.grains.interior = interior;
  return measured_by(name, {&analysis, &checkpoint}).curves.at(name);
}

// In a tilted cell, where the shape of the region shows most.
TEST(PairStructure, GrainsAtRandomHaveNoCorrelation) {
  Packing p = empty_cell(14, 12, 10, 0.3);
  fill(p, 20000, 0, 7);
  const MeasuredCurve g = measured("pair_correlation", p, interior_of(p));
  ASSERT_EQ(g.x.size(), 250U);
  double mean_far = 0;
  for (std::size_t b = 25; b < g.y.size(); ++b) {
    EXPECT_NEAR(g.y[b], 1, 0.06) << "r = " << g.x[b];
    mean_far += (g.y[b] - 1) / 225;
  }
  EXPECT_NEAR(mean_far, 0, 0.004) << "the shape of the region is not taken out";
}

TEST(PairStructure, CountsEveryPairOnce) {
  Packing p = jammed(600, true, 0.05, 2);
  const std::vector<std::uint8_t> interior = interior_of(p);
  const MeasuredCurve g = measured("pair_correlation", p, interior);
  std::vector<double> pairs(g.x.size(), 0);
  double count = 0;
  for (Eigen::Index i = 0; i < p.grains.cols(); ++i) {
    if (interior[static_cast<std::size_t>(i)] == 0) continue;
    ++count;
    for (Eigen::Index j = 0; j < i; ++j) {
      if (interior[static_cast<std::size_t>(j)] == 0) continue;
      Eigen::Vector3d r = p.grains.col(i) - p.grains.col(j);
      r.z() = nearest_image(r.z(), p.cell.depth, 1 / p.cell.depth);
      const auto bin = static_cast<std::size_t>(r.norm() / pair_bin_d);
      if (bin < pairs.size()) ++pairs[bin];
    }
  }
  // Of one bin the volume of pairs is the same, so ratios are those of the counts.
  const InteriorRegion region = interior_region(p.cell, p.pose);
  const double t = region.tan_theta, a = std::sqrt(1 + t * t), b = -t / a;
  const double both = 2 * a / (3 * kPi) * (std::sqrt(1 - b * b) + b * std::asin(b));
  for (std::size_t n = 0; n < pairs.size(); ++n) {
    // Simpson's rule for the volume of pairs, exact for a cubic and close for this quintic.
    const auto shell = [&](double s) {
      return 4 * kPi * s * s * region.depth *
             (region.width * region.height - s * (a * region.height + region.width) / 2 +
              s * s * both);
    };
    const double from = g.x[n] - pair_bin_d / 2, to = g.x[n] + pair_bin_d / 2;
    const double volume = pair_bin_d / 6 * (shell(from) + 4 * shell(g.x[n]) + shell(to));
    const double expected = count * (count - 1) / 2 * volume / (region.volume() * region.volume());
    EXPECT_NEAR(g.y[n], pairs[n] / expected, 1e-5 * (1 + g.y[n]));
  }
}

TEST(PairStructure, StructureFactorOfGrainsAtRandomIsOne) {
  Packing p = empty_cell(14, 12, 8, 0.1);
  fill(p, 4000, 0, 3);
  const MeasuredCurve s = measured("structure_factor", p, interior_of(p));
  ASSERT_EQ(s.x.size(), 100U);
  double mean = 0;
  for (std::size_t b = 20; b < s.y.size(); ++b) mean += s.y[b] / 80;
  EXPECT_NEAR(mean, 1, 0.02);
}

// Where a bin has few vectors, they are all taken: the sum over them is repeated in full.
TEST(PairStructure, StructureFactorIsTheSumOverWaveVectors) {
  Packing p = jammed(600, false, 0.1, 4);
  const std::vector<std::uint8_t> interior = interior_of(p);
  const InteriorRegion region = interior_region(p.cell, p.pose);
  const MeasuredCurve s = measured("structure_factor", p, interior);
  std::vector<double> sum(8, 0), count(8, 0);
  double grains = 0;
  for (const std::uint8_t inside : interior) grains += inside;
  for (int a = -4; a <= 4; ++a) {
    for (int b = -4; b <= 4; ++b) {
      for (int c = -4; c <= 4; ++c) {
        if (a == 0 && b == 0 && c == 0) continue;
        const double kx = 2 * kPi * a / region.width;
        const Eigen::Vector3d k(kx, 2 * kPi * b / region.height - region.tan_theta * kx,
                                2 * kPi * c / region.depth);
        const auto bin = static_cast<std::size_t>(k.norm() / wave_bin_per_d);
        if (bin >= sum.size()) continue;
        std::complex<double> wave = 0;
        for (Eigen::Index i = 0; i < p.grains.cols(); ++i) {
          if (interior[static_cast<std::size_t>(i)] == 0) continue;
          wave += std::polar(1.0, k.dot(p.grains.col(i)));
        }
        sum[bin] += std::norm(wave) / grains;
        ++count[bin];
      }
    }
  }
  int compared = 0;
  for (std::size_t b = 0; b < sum.size(); ++b) {
    if (count[b] == 0 || count[b] > 96) continue;
    EXPECT_NEAR(s.y[b], sum[b] / count[b], 1e-9);
    ++compared;
  }
  EXPECT_GT(compared, 3);
}

}  // namespace
}  // namespace shearcell::test
