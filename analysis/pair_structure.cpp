// SPDX-License-Identifier: GPL-3.0-or-later
// g(r) and S(k) of interior grains.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <numbers>
#include <tuple>
#include <vector>

#include "analysis/measures.hpp"
#include "analysis/near_grains.hpp"
#include "analysis/packing_fraction.hpp"

namespace shearcell {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double pair_bin_d = 0.02;        // width of the bins in r [d]
constexpr double pair_reach_d = 5;         // largest r [d]; smaller in small regions
constexpr double wave_bin_per_d = 0.25;    // width of the bins in |k| [1/d]
constexpr double largest_wave_per_d = 25;  // largest |k| [1/d]

Eigen::Matrix3Xd interior_sites(const MeasureInput& input) {
  const std::vector<std::uint8_t>& interior = input.analysis->grains.interior;
  std::vector<std::size_t> sites;
  for (std::size_t i = 0; i < interior.size(); ++i) {
    if (interior[i] != 0) sites.push_back(i);
  }
  return input.checkpoint->state.position(Eigen::all, sites);
}

// Volume [d^6] of the set of pairs (r, r + s) for which r and r + s are in the region and |s| is in
// the range [from, to). The set covariance of the region (width W, height H, depth D), averaged
// over the directions n of s, is D <(W - |s| |a n|)(H - |s| |b n|)>. Here a = (1, -tan theta, 0)
// and b = (0, 1, 0).
double pair_volume(const InteriorRegion& region, double from, double to) {
  const double a = std::sqrt(1 + region.tan_theta * region.tan_theta);
  const double cosine = -region.tan_theta / a;
  // <|a n||b n|> over the unit sphere.
  const double both =
      2 * a / (3 * kPi) * (std::sqrt(1 - cosine * cosine) + cosine * std::asin(cosine));
  const double constant = region.width * region.height;
  const double linear = 0.5 * (a * region.height + region.width);
  const auto integral = [&](double s) {
    return s * s * s * (constant / 3 - s * (linear / 4 - s * both / 5));
  };
  return 4 * kPi * region.depth * (integral(to) - integral(from));
}

/// A curve with x in the middles of equal bins. The y of each bin is NaN until this bin is filled.
MeasuredCurve empty_bins(double width, std::size_t count) {
  MeasuredCurve function;
  for (std::size_t b = 0; b < count; ++b) {
    function.x.push_back((static_cast<double>(b) + 0.5) * width);
  }
  function.y.assign(count, std::numeric_limits<double>::quiet_NaN());
  return function;
}

// Values of a plane wave at two sites.
struct TwoSites {
  Eigen::Array2d re = {0, 0}, im = {0, 0};
};

inline TwoSites operator*(const TwoSites& a, const TwoSites& b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

// Values of a plane wave at a block of sites. Blocks are small, so that all waves fit into the
// cache.
using Wave = std::array<TwoSites, 16>;
constexpr auto kBlock = static_cast<Eigen::Index>(2 * std::tuple_size_v<Wave>);

// exp(2 pi i n s) for each n from -`most` to `most`, at the fractional coordinates s of up to
// kBlock sites. If there are fewer sites, the remaining values are 0.
std::vector<Wave> waves(const Eigen::ArrayXd& s, int most) {
  std::vector<Wave> found(2 * static_cast<std::size_t>(most) + 1);
  const auto middle = found.begin() + most;
  Wave unit;
  for (Eigen::Index i = 0; i < s.size(); ++i) {
    const auto pair = static_cast<std::size_t>(i / 2);
    const std::complex<double> value = std::exp(std::complex<double>(0, 2 * kPi * s[i]));
    unit[pair].re[i % 2] = value.real();
    unit[pair].im[i % 2] = value.imag();
    (*middle)[pair].re[i % 2] = 1;
  }
  for (int n = 1; n <= most; ++n) {
    for (std::size_t pair = 0; pair < unit.size(); ++pair) {
      const TwoSites& power = middle[n][pair] = middle[n - 1][pair] * unit[pair];
      middle[-n][pair] = {power.re, -power.im};
    }
  }
  return found;
}

using WaveVector = std::array<int, 3>;  // components in the basis of the reciprocal lattice

// For each axis, the largest component of a wave vector with |k| up to largest_wave_per_d.
WaveVector largest_components(const InteriorRegion& region) {
  const auto within = [](double length) {
    return static_cast<int>(largest_wave_per_d * length / (2 * kPi));
  };
  // If the walls are tilted, the first component of a wave vector contributes to k_y, too.
  return {within(region.width), within(region.height * (1 + std::abs(region.tan_theta))),
          within(region.depth)};
}

constexpr auto kWaveBins = static_cast<std::size_t>(largest_wave_per_d / wave_bin_per_d);

// Calls visit(bin, n) for each wave vector k with |k| < largest_wave_per_d. n has the integer
// components of k, and the calls are in the order of n. Only one of k and -k is visited.
template <class Visit>
void for_each_wave_vector(const InteriorRegion& region, const WaveVector& most,
                          const Visit& visit) {
  for (int a = 0; a <= most[0]; ++a) {
    const double x = 2 * kPi * a / region.width;
    for (int b = a == 0 ? 0 : -most[1]; b <= most[1]; ++b) {
      const double y = 2 * kPi * b / region.height - region.tan_theta * x;
      for (int c = a == 0 && b == 0 ? 1 : -most[2]; c <= most[2]; ++c) {
        const double z = 2 * kPi * c / region.depth;
        const auto bin =
            static_cast<std::size_t>(std::sqrt(x * x + y * y + z * z) / wave_bin_per_d);
        if (bin < kWaveBins) visit(bin, WaveVector{a, b, c});
      }
    }
  }
}

/// g(r) of the interior grains: the number of pairs at a distance r, divided by the number expected
/// if the grains were placed at random in the region. The expected number follows exactly from the
/// set covariance of the region, a parallelepiped (Ohser, Math. Operationsforsch. Statist. 14, 63
/// (1983)).
MeasuredCurve pair_correlation(const MeasureInput& input) {
  const Cell& cell = input.checkpoint->cell;
  const WallPose pose = pose_of(*input.checkpoint);
  const InteriorRegion region = interior_region(cell, pose);
  const Eigen::Matrix3Xd sites = interior_sites(input);
  const double reach =
      std::min({pair_reach_d, 0.5 * region.depth, region.height, region.width * pose.cos_theta});
  if (!(reach > 0) || sites.cols() < 2) return {};
  MeasuredCurve g = empty_bins(pair_bin_d, static_cast<std::size_t>(reach / pair_bin_d));
  std::vector<double> pairs(g.x.size(), 0);
  for_each_pair(cell, pose, sites, reach,
                [&](std::int32_t, std::int32_t, const Eigen::Vector3d& r) {
                  const auto bin = static_cast<std::size_t>(r.norm() / pair_bin_d);
                  if (bin < pairs.size()) ++pairs[bin];
                });
  const auto count = static_cast<double>(sites.cols());
  const double density = count * (count - 1) / (2 * region.volume() * region.volume());
  for (std::size_t b = 0; b < pairs.size(); ++b) {
    const double from = static_cast<double>(b) * pair_bin_d;
    g.y[b] = pairs[b] / (density * pair_volume(region, from, from + pair_bin_d));
  }
  return g;
}

/// S(k) of the interior grains: |sum exp(i k r)|^2 / n, averaged over wave vectors in bins of |k|.
/// The wave vectors are reciprocal lattice vectors of the region, so a uniform density gives S = 0.
/// In each bin, the wave vectors are sorted by their components and every m-th one is used, where m
/// is the smallest number for which at most 48 are used.
MeasuredCurve structure_factor(const MeasureInput& input) {
  const InteriorRegion region = interior_region(input.checkpoint->cell, pose_of(*input.checkpoint));
  const Eigen::Matrix3Xd sites = interior_sites(input);
  if (!(region.width > 0 && region.height > 0) || sites.cols() == 0) return {};
  const WaveVector most = largest_components(region);
  // Limits the computing time for a forged file whose cell is far larger than the grains need. In a
  // real packing, most[0] + most[1] + most[2] is at most a third of the limit.
  const double largest_sum = 60 * std::cbrt(static_cast<double>(sites.cols()));
  if (most[0] + most[1] + most[2] > std::max(1000.0, largest_sum)) return {};
  const Eigen::ArrayXd y = sites.row(1).array() - region.bottom;
  const Eigen::ArrayXd x = sites.row(0).transpose().array() - region.left - region.tan_theta * y;
  const Eigen::ArrayXd z = sites.row(2).transpose().array();
  constexpr std::size_t most_of_bin = 48;
  std::vector<std::size_t> vectors(kWaveBins), seen(kWaveBins), taken(kWaveBins);
  for_each_wave_vector(region, most, [&](std::size_t bin, const WaveVector&) { ++vectors[bin]; });
  struct Sum {
    std::size_t bin;
    WaveVector n;
    TwoSites at;  // sums over sites with even and with odd index
  };
  std::vector<Sum> sums;
  for_each_wave_vector(region, most, [&](std::size_t bin, const WaveVector& n) {
    const std::size_t stride = (vectors[bin] + most_of_bin - 1) / most_of_bin;
    if (seen[bin]++ % stride != 0) return;
    ++taken[bin];
    sums.push_back({bin, n, {}});
  });
  // If the number of sites is odd, the last block has one site. The sums over even and odd indices
  // are combined before this block is added.
  for (Eigen::Index from = 0, size = 0; from < sites.cols(); from += size) {
    size = std::min(kBlock, sites.cols() - from);
    if (size > 1) size -= size % 2;
    const std::array along = {waves(x.segment(from, size) / region.width, most[0]),
                              waves(y.segment(from, size) / region.height, most[1]),
                              waves(z.segment(from, size) / region.depth, most[2])};
    for (Sum& sum : sums) {
      if (size == 1) sum.at = {{sum.at.re.sum(), 0}, {sum.at.im.sum(), 0}};
      const auto wave = [&](std::size_t axis) -> const Wave& {
        return along[axis][static_cast<std::size_t>(sum.n[axis] + most[axis])];
      };
      const Wave &of_x = wave(0), &of_y = wave(1), &of_z = wave(2);
      for (std::size_t pair = 0; pair < of_x.size(); ++pair) {
        const TwoSites product = of_x[pair] * of_y[pair] * of_z[pair];
        sum.at.re += product.re;
        sum.at.im += product.im;
      }
    }
  }
  std::vector<double> squares(kWaveBins);
  for (const Sum& sum : sums) {
    squares[sum.bin] += std::norm(std::complex<double>(sum.at.re.sum(), sum.at.im.sum()));
  }
  MeasuredCurve s = empty_bins(wave_bin_per_d, kWaveBins);
  for (std::size_t b = 0; b < kWaveBins; ++b) {
    const double count = static_cast<double>(taken[b]) * static_cast<double>(sites.cols());
    if (count > 0) s.y[b] = squares[b] / count;
  }
  return s;
}

}  // namespace

std::vector<Provider> pair_structure_providers() {
  return {
      {.name = "pair_correlation",
       .parameters = with(interior_criteria(), {{"bin_d", pair_bin_d}, {"reach_d", pair_reach_d}}),
       .measures = {{"pair_correlation", "1", "g(r) of interior grains", MeasureKind::curve, "",
                     "distance_d", "d"}},
       .compute =
           [](const MeasureInput& input) {
             return nlohmann::json{{"pair_correlation", pair_correlation(input)}};
           }},
      {.name = "structure_factor",
       .parameters = with(interior_criteria(),
                          {{"bin_per_d", wave_bin_per_d}, {"largest_per_d", largest_wave_per_d}}),
       .measures = {{"structure_factor", "1", "S(k) of interior grains", MeasureKind::curve, "",
                     "wave_number_per_d", "1/d"}},
       .compute = [](const MeasureInput& input) {
         return nlohmann::json{{"structure_factor", structure_factor(input)}};
       }}};
}

}  // namespace shearcell
