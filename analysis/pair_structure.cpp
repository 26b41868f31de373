// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/pair_structure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <numbers>

#include "analysis/near_grains.hpp"
#include "analysis/packing_fraction.hpp"

namespace shearcell {
namespace {

constexpr double kPi = std::numbers::pi;

Eigen::Matrix3Xd selected(const Eigen::Matrix3Xd& grains, std::span<const std::uint8_t> interior) {
  Eigen::Matrix3Xd found(3, std::count(interior.begin(), interior.end(), std::uint8_t{1}));
  Eigen::Index next = 0;
  for (Eigen::Index i = 0; i < grains.cols(); ++i) {
    if (interior[static_cast<std::size_t>(i)] != 0) found.col(next++) = grains.col(i);
  }
  return found;
}

// Volume of the pairs (r, r + s) with both ends in the region and |s| between two distances [d^6].
// Averaged over directions n, the set covariance is D <(W - s |a n|)(H - s |b n|)>, with a = (1,
// -tan theta, 0) and b = (0, 1, 0).
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

BinnedFunction bins(double width, std::size_t count) {
  BinnedFunction function;
  for (std::size_t b = 0; b < count; ++b) {
    function.x.push_back((static_cast<double>(b) + 0.5) * width);
  }
  function.y.assign(count, std::numeric_limits<double>::quiet_NaN());
  return function;
}

// exp(2 pi i n s) for n = 0 ... of each fractional coordinate.
class Waves {
 public:
  Waves(const Eigen::VectorXd& fraction, int most) {
    const Eigen::ArrayXcd unit =
        (std::complex<double>(0, 2 * kPi) * fraction.array().cast<std::complex<double>>()).exp();
    powers_.push_back(Eigen::ArrayXcd::Ones(unit.size()));
    for (int n = 1; n <= most; ++n) powers_.push_back(powers_.back() * unit);
  }
  Eigen::ArrayXcd of(int n) const {
    const Eigen::ArrayXcd& power = powers_[static_cast<std::size_t>(std::abs(n))];
    return n < 0 ? Eigen::ArrayXcd(power.conjugate()) : power;
  }

 private:
  std::vector<Eigen::ArrayXcd> powers_;
};

struct WaveVector {
  std::array<int, 3> n;
};

// One of each pair k, -k up to the largest |k|, by bins.
class WaveVectors {
 public:
  explicit WaveVectors(const InteriorRegion& region)
      : region_(region), bins_(static_cast<std::size_t>(largest_wave_per_d / wave_bin_per_d)) {
    most_[0] = static_cast<int>(largest_wave_per_d * region.width / (2 * kPi));
    // The second component of k has a share of the first one's where the walls are tilted.
    most_[1] = static_cast<int>(largest_wave_per_d * region.height *
                                (1 + std::abs(region.tan_theta)) / (2 * kPi));
    most_[2] = static_cast<int>(largest_wave_per_d * region.depth / (2 * kPi));
    std::vector<std::size_t> count(bins_.size(), 0), seen(bins_.size(), 0);
    each([&](std::size_t bin, const WaveVector&) { ++count[bin]; });
    each([&](std::size_t bin, const WaveVector& k) {
      const std::size_t stride = (count[bin] + kMost - 1) / kMost;
      if (seen[bin]++ % stride == 0) bins_[bin].push_back(k);
    });
  }

  const std::array<int, 3>& most() const { return most_; }
  const std::vector<std::vector<WaveVector>>& bins() const { return bins_; }

 private:
  static constexpr std::size_t kMost = 48;

  template <class Visit>
  void each(const Visit& visit) const {
    for (int a = 0; a <= most_[0]; ++a) {
      const double x = 2 * kPi * a / region_.width;
      for (int b = a == 0 ? 0 : -most_[1]; b <= most_[1]; ++b) {
        const double y = 2 * kPi * b / region_.height - region_.tan_theta * x;
        for (int c = a == 0 && b == 0 ? 1 : -most_[2]; c <= most_[2]; ++c) {
          const double z = 2 * kPi * c / region_.depth;
          const double bin = std::sqrt(x * x + y * y + z * z) / wave_bin_per_d;
          if (bin < static_cast<double>(bins_.size())) {
            visit(static_cast<std::size_t>(bin), {{a, b, c}});
          }
        }
      }
    }
  }

  InteriorRegion region_;
  std::array<int, 3> most_{};
  std::vector<std::vector<WaveVector>> bins_;
};

}  // namespace

InteriorRegion interior_region(const Cell& cell, const WallPose& pose) {
  const double margin = interior_distance + (cell.wall_grains.empty() ? 0 : rough_wall_surface);
  InteriorRegion region;
  region.tan_theta = pose.tan_theta;
  region.bottom = pose.bottom + margin;
  region.height = pose.top - pose.bottom - 2 * margin;
  region.depth = cell.depth;
  region.width = cell.width - 2 * margin / pose.cos_theta;
  region.left = (region.bottom - pose.top) * pose.tan_theta + margin / pose.cos_theta;
  return region;
}

BinnedFunction pair_correlation(const Cell& cell, const WallPose& pose,
                                const Eigen::Matrix3Xd& grains,
                                std::span<const std::uint8_t> interior) {
  const InteriorRegion region = interior_region(cell, pose);
  const Eigen::Matrix3Xd sites = selected(grains, interior);
  const double reach =
      std::min({pair_reach_d, 0.5 * region.depth, region.height, region.width * pose.cos_theta});
  if (!(reach > 0) || sites.cols() < 2) return {};
  BinnedFunction g = bins(pair_bin_d, static_cast<std::size_t>(reach / pair_bin_d));
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

BinnedFunction structure_factor(const Cell& cell, const WallPose& pose,
                                const Eigen::Matrix3Xd& grains,
                                std::span<const std::uint8_t> interior) {
  const InteriorRegion region = interior_region(cell, pose);
  const Eigen::Matrix3Xd sites = selected(grains, interior);
  if (!(region.width > 0 && region.height > 0) || sites.cols() == 0) return {};
  const WaveVectors vectors(region);
  const Eigen::ArrayXd y = sites.row(1).array() - region.bottom;
  const Eigen::ArrayXd x = sites.row(0).transpose().array() - region.left - region.tan_theta * y;
  const Waves along_x(x / region.width, vectors.most()[0]);
  const Waves along_y(y / region.height, vectors.most()[1]);
  const Waves along_z(sites.row(2).transpose() / region.depth, vectors.most()[2]);
  BinnedFunction s = bins(wave_bin_per_d, vectors.bins().size());
  for (std::size_t b = 0; b < s.x.size(); ++b) {
    double sum = 0;
    for (const auto& [n] : vectors.bins()[b]) {
      sum += std::norm((along_x.of(n[0]) * along_y.of(n[1]) * along_z.of(n[2])).sum());
    }
    const auto count = static_cast<double>(vectors.bins()[b].size());
    if (count > 0) s.y[b] = sum / (count * static_cast<double>(sites.cols()));
  }
  return s;
}

}  // namespace shearcell
