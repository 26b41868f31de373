// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/nucleation.hpp"

#include "analysis/onset.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>

#include "analysis/published.hpp"

namespace shearcell {
namespace {

double place(const CrystalliteMap& map, const Eigen::Vector3d& centre, CellAxis axis) {
  if (axis == CellAxis::x) return (centre.x() + 1) / (map.width + 2);
  const double height = axis == CellAxis::y ? map.top - map.bottom : nominal_height * map.width;
  return (centre.y() - map.bottom) / height;
}

Interval poisson_interval(std::size_t events) {
  const auto quantile = [](double probability, double freedom) {
    return boost::math::quantile(boost::math::chi_squared(freedom), probability) / 2;
  };
  const double tail = (1 - confidence_level) / 2;
  const double n = static_cast<double>(events);
  return {events == 0 ? 0 : quantile(tail, 2 * n), quantile(1 - tail, 2 * n + 2)};
}

/// Contribution of one run to the likelihood, in one range of phi.
struct Share {
  double grains;  ///< N
  const std::string* packing;
  double phi;
  double log_cycles;
  double log_size;
  double events;          ///< 0 or 1
  Eigen::Vector3d terms;  ///< terms of ln c: 1, u, u^2; u = (phi - onset phi) / phi_bin
};

using Shares = std::map<double, std::vector<Share>>;  ///< by amplitude

/// 1 / variance of the normal priors on the coefficients of ln c. The standard deviation is 3 for
/// the linear term and 0.5 for the quadratic term. Fits give coefficients of about 1 and 0.1. With
/// these priors the likelihood has a maximum even if there are only a few events. [choice]
const Eigen::Vector3d prior(0, 1.0 / 9, 4);

struct Likelihood {
  double logarithm = 0;                    ///< ln L, up to a constant
  double score = 0;                        ///< d ln L / d exponent; decreases as the exponent grows
  double information = 0;                  ///< -d score / d exponent
  std::map<std::string, double> score_of;  ///< score of each packing
};

/// Adds the log-likelihood of one amplitude, maximized over the coefficients of ln c by Newton's
/// method. The log-likelihood is concave in these coefficients. A Newton step that would lower the
/// log-likelihood is halved.
void add_likelihood(const std::vector<Share>& shares, double exponent, Likelihood& sum) {
  Eigen::Vector3d c = Eigen::Vector3d::Zero();
  const auto log_rate = [&](const Share& share) {
    return share.log_cycles + exponent * share.log_size + c.dot(share.terms);
  };
  double events = 0, expected_events = 0, most = -infinite;
  for (const Share& share : shares) most = std::max(most, log_rate(share));
  for (const Share& share : shares) {
    events += share.events;
    expected_events += std::exp(log_rate(share) - most);
  }
  if (events == 0) return;
  c[0] = std::log(events / expected_events) - most;
  const auto logarithm = [&] {
    double all = -c.cwiseAbs2().dot(prior) / 2;
    for (const Share& share : shares) {
      all += share.events * log_rate(share) - std::exp(log_rate(share));
    }
    return all;
  };
  Eigen::Matrix3d curvature;
  Eigen::Vector3d slope, with_size;  // with_size[k]: -d^2(ln L) / (dc[k] d(exponent))
  double reached = logarithm();
  double moved = 1;
  for (int step = 0; step < 100 && moved > 1e-9; ++step) {
    curvature = prior.asDiagonal();
    slope = -prior.cwiseProduct(c);
    with_size.setZero();
    for (const Share& share : shares) {
      const double expected = std::exp(log_rate(share));
      const Eigen::Vector3d x = share.terms;
      curvature += expected * x * x.transpose();
      slope += (share.events - expected) * x;
      with_size += expected * share.log_size * x;
    }
    Eigen::Vector3d move = curvature.ldlt().solve(slope);
    c += move;
    while (!(logarithm() >= reached) && move.norm() > 1e-9) c -= move /= 2;
    moved = move.norm();
    reached = logarithm();
  }
  const Eigen::Vector3d explained = curvature.ldlt().solve(with_size);
  sum.logarithm += reached;
  for (const Share& share : shares) {
    const double expected = std::exp(log_rate(share));
    const double off = share.log_size - explained.dot(share.terms);
    sum.score += (share.events - expected) * share.log_size;
    sum.information += expected * off * share.log_size;
    sum.score_of[*share.packing] += (share.events - expected) * off;
  }
}

Likelihood likelihood(const Shares& amplitudes, double exponent) {
  Likelihood sum;
  for (const auto& [amplitude, shares] : amplitudes) add_likelihood(shares, exponent, sum);
  return sum;
}

/// Whether the comparison runs that size_exponent() requires exist. Cells are compared by N,
/// because the number of grains in the region differs slightly between cells of the same N.
bool is_bounded(const Shares& amplitudes) {
  bool larger = false, smaller = false;
  for (const auto& [amplitude, shares] : amplitudes) {
    for (const Share& event : shares) {
      if (event.events == 0) continue;
      for (const Share& other : shares) {
        if (std::abs(other.phi - event.phi) > phi_bin) continue;
        larger = larger || other.grains > event.grains;
        smaller = smaller || other.grains < event.grains;
      }
    }
  }
  return larger && smaller;
}

/// Variance of the packings' scores, divided by the variance for independent runs; at least 1.
double variance_between_packings(const Likelihood& at) {
  double squares = 0;
  for (const auto& [packing, score] : at.score_of) squares += score * score;
  return std::max(1.0, squares / at.information);
}

/// Bisection between `low` and `high`: `holds` is false below the result and true above it.
double bisected(double low, double high, const auto& holds) {
  for (int halving = 0; halving < 30; ++halving) {
    const double middle = (low + high) / 2;
    (holds(middle) ? high : low) = middle;
  }
  return (low + high) / 2;
}

}  // namespace

std::vector<double> nucleus_places(const FrameRun& run, CellAxis axis, Seen seen) {
  std::vector<double> places;
  std::set<std::int32_t> known;  // grains that have been in a nucleus
  for (const CheckpointMeasures& checkpoint : run.checkpoints) {
    if (!checkpoint.measures.crystallite_map) continue;
    const CrystalliteMap& map = *checkpoint.measures.crystallite_map;
    std::vector<std::int32_t> known_of(map.size.size());
    for (std::size_t k = 0; k < map.grain.size(); ++k) {
      const auto label = static_cast<std::size_t>(map.label[k]);
      if (map.size[label] < nucleus_smallest) continue;
      if (!known.insert(map.grain[k]).second) ++known_of[label];
    }
    for (std::size_t c = 0; c < map.size.size(); ++c) {
      if (map.size[c] < nucleus_smallest || map.size[c] > nucleus_largest) continue;
      const bool is_new = 2 * known_of[c] < map.size[c];
      if (seen == Seen::always || is_new) places.push_back(place(map, map.centre[c], axis));
    }
  }
  return places;
}

std::vector<DensityBin> density(std::span<const std::vector<double>> groups, std::size_t bins) {
  const auto count = static_cast<double>(bins);
  std::vector<std::size_t> every(groups.size());
  std::iota(every.begin(), every.end(), 0);
  std::vector<DensityBin> result;
  for (std::size_t k = 0; k < bins; ++k) {
    std::vector<std::vector<double>> densities;  // of each place: `bins` in this bin, 0 elsewhere
    for (const std::vector<double>& places : groups) {
      densities.emplace_back();
      for (const double p : places) {
        const auto bin = static_cast<std::size_t>(std::clamp(p * count, 0.0, count - 1));
        densities.back().push_back(bin == k ? count : 0);
      }
    }
    const RunStatistic density_of = mean_of_items(densities);
    const double width = 1 / count, low = static_cast<double>(k) * width;
    result.push_back(
        {low, low + width, density_of(every), bootstrap_error(groups.size(), density_of)});
  }
  if (std::isnan(result.front().density)) result.clear();  // no positions
  return result;
}

std::string grains_of(Region region) {
  return region == Region::core ? "core_grains" : "interior_grains";
}

std::map<std::int64_t, Exposure> exposures_of(const FrameRun& run, Region region, double width) {
  const RunOnset onset = onset_by_size(run);
  std::map<std::int64_t, Exposure> exposures;
  if (onset.missing == Missing::too_late) return exposures;
  for (std::size_t k = 1; k < run.checkpoints.size(); ++k) {
    const CheckpointMeasures &from = run.checkpoints[k - 1], &to = run.checkpoints[k];
    const bool here = onset.missing == Missing::nothing && onset.cycle <= to.cycle;
    const double cycles = (here ? onset.cycle : to.cycle) - from.cycle;
    const double phi = from.measures.number(region == Region::core ? "core_phi" : "phi");
    if (std::isfinite(phi) && cycles > 0) {
      Exposure& one = exposures[std::llround(std::floor(phi / width))];
      one.phi += (phi - one.phi) * cycles / (one.cycles + cycles);
      one.cycles += cycles;
      one.grain_cycles += cycles * from.measures.number(grains_of(region));
      one.onsets += here ? 1 : 0;
    }
    if (here) break;
  }
  return exposures;
}

std::vector<NucleationRate> nucleation_rates(RunGroup runs, Region region) {
  std::map<std::int64_t, Exposure> sums;
  for (const FrameRun* run : runs) {
    for (const auto& [bin, one] : exposures_of(*run, region, phi_bin)) {
      sums[bin].grain_cycles += one.grain_cycles;
      sums[bin].onsets += one.onsets;
    }
  }
  std::vector<NucleationRate> rates;
  for (const auto& [bin, sum] : sums) {
    if (!(sum.grain_cycles > 0)) continue;
    const Interval events = poisson_interval(sum.onsets);
    const auto number = static_cast<double>(bin);
    rates.push_back({number * phi_bin,
                     (number + 1) * phi_bin,
                     sum.onsets,
                     sum.grain_cycles,
                     static_cast<double>(sum.onsets) / sum.grain_cycles,
                     {events.low / sum.grain_cycles, events.high / sum.grain_cycles}});
  }
  return rates;
}

std::optional<Estimate> size_exponent(RunGroup runs, Region region, double level) {
  Shares amplitudes;
  std::set<std::string> packings;
  std::size_t counted = 0;
  for (const FrameRun* run : runs) {
    const auto exposures = exposures_of(*run, region, rate_step);
    if (exposures.empty()) continue;
    ++counted;
    packings.insert(packing_of(*run));
    for (const auto& [step, one] : exposures) {
      if (!(one.grain_cycles > 0)) continue;
      const double u = (one.phi - published_onset_phi) / phi_bin;
      amplitudes[number_of(*run, "amplitude_rad")].push_back(
          {number_of(*run, "grains"),
           &packing_of(*run),
           one.phi,
           std::log(one.cycles),
           std::log(one.grain_cycles / one.cycles),
           static_cast<double>(one.onsets),
           {1, u, u * u}});
    }
  }
  constexpr double widest = 30;  // n^30 does not overflow
  const bool bounded = is_bounded(amplitudes) && likelihood(amplitudes, -widest).score > 1e-9 &&
                       likelihood(amplitudes, widest).score < -1e-9;
  if (packings.size() < least_runs || !bounded) return std::nullopt;
  const double value = bisected(
      -widest, widest, [&](double exponent) { return likelihood(amplitudes, exponent).score < 0; });
  const Likelihood best = likelihood(amplitudes, value);
  const boost::math::chi_squared one_parameter(1);
  const double shared = packings.size() < counted ? variance_between_packings(best) : 1;
  const double least = best.logarithm - shared * boost::math::quantile(one_parameter, level) / 2;
  const auto unlikely = [&](double exponent) {
    return likelihood(amplitudes, exponent).logarithm < least;
  };
  const Interval interval = {
      unlikely(-widest)
          ? bisected(-widest, value, [&](double exponent) { return !unlikely(exponent); })
          : -infinite,
      unlikely(widest) ? bisected(value, widest, unlikely) : infinite};
  return estimate_with(value, interval, normal_quantile((1 + level) / 2), counted);
}

}  // namespace shearcell
