// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/looks.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/random.hpp"

namespace shearcell {
namespace {

/// Probability that the standard normal test statistic lies in [-limit, limit] at every look.
double probability_within(double limit, std::span<const std::size_t> looks) {
  const auto share_of_next = [&](std::size_t k) {
    return static_cast<double>(looks[k - 1]) / static_cast<double>(looks[k]);
  };
  double step = 0.05;  // at most a quarter of the narrowest kernel's width
  for (std::size_t k = 1; k < looks.size(); ++k) {
    step = std::min(step, std::sqrt(1 - share_of_next(k)) / 4);
  }
  const auto half = static_cast<Eigen::Index>(std::ceil(limit / step));
  const Eigen::ArrayXd at = Eigen::ArrayXd::LinSpaced(2 * half + 1, -limit, limit);
  Eigen::ArrayXd weight(at.size());  // Simpson's rule
  for (Eigen::Index j = 0; j < at.size(); ++j) weight[j] = j % 2 == 1 ? 4 : 2;
  weight[0] = weight[at.size() - 1] = 1;
  weight *= limit / static_cast<double>(3 * half) / std::sqrt(2 * std::numbers::pi);
  Eigen::ArrayXd density = (-at.square() / 2).exp();
  for (std::size_t k = 1; k < looks.size(); ++k) {
    const double rho = std::sqrt(share_of_next(k)), variance = 1 - share_of_next(k);
    const Eigen::ArrayXd mass = weight * density / std::sqrt(variance);
    for (Eigen::Index j = 0; j < at.size(); ++j) {
      density[j] = (mass * (-(at[j] - rho * at).square() / (2 * variance)).exp()).sum();
    }
  }
  return (weight * density).sum();
}

}  // namespace

double look_level(std::span<const std::size_t> looks, double level) {
  if (looks.size() < 2) return level;
  const double least = normal_quantile((1 + level) / 2);
  const double most = normal_quantile(1 - (1 - level) / (2 * static_cast<double>(looks.size())));
  std::uintmax_t steps = 50;
  const auto [below, above] = boost::math::tools::toms748_solve(
      [&](double limit) { return probability_within(limit, looks) - level; }, least, most,
      boost::math::tools::eps_tolerance<double>(30), steps);
  return std::erf((below + above) / std::sqrt(8.0));
}

std::vector<LookPower> power_of(const Claim& claim, double truth, double spread, std::size_t groups,
                                std::span<const std::size_t> looks) {
  constexpr std::uint32_t campaigns = 4000;
  const double level = look_level(looks);
  std::vector<LookPower> power;
  for (const std::size_t runs : looks) power.push_back({runs});
  for (std::uint32_t campaign = 0; campaign < campaigns; ++campaign) {
    std::vector<double> values[2];
    for (std::uint32_t k = 0; k < groups * looks.back(); ++k) {
      const double deviate = spread / std::sqrt(groups) * normal_number({campaign, k, 0, 0}, 73);
      values[k % groups].push_back(k % groups == 0 ? truth + deviate : deviate);
    }
    Ruling ruling = Ruling::undecided;
    for (LookPower& look : power) {
      const std::span<const double> a(values[0].data(), look.runs);
      const auto estimate =
          groups == 1 ? mean_of(a, level)
                      : difference_of_means(a, std::span(values[1].data(), look.runs), level);
      if (ruling == Ruling::undecided && estimate) {
        ruling = ruling_of(estimate->interval, claim.margin, claim.claimed);
      }
      if (ruling == Ruling::agrees || ruling == Ruling::supported)
        look.as_claimed += 1.0 / campaigns;
      if (ruling == Ruling::differs || ruling == Ruling::refuted) look.against += 1.0 / campaigns;
    }
  }
  return power;
}

}  // namespace shearcell
