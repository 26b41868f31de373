// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/nucleation.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "analysis/binning.hpp"
#include "analysis/published.hpp"

namespace shearcell {
namespace {

double place(const CrystalliteMap& map, const Eigen::Vector3d& centre, CellAxis axis) {
  if (axis == CellAxis::x) return (centre.x() + 1) / (map.width + 2);
  const double height = axis == CellAxis::y ? map.top - map.bottom : nominal_height * map.width;
  return (centre.y() - map.bottom) / height;
}

std::vector<double> histogram(std::span<const double> places, std::size_t bins) {
  std::vector<double> counts(bins);
  for (const double p : places) {
    const double k = std::clamp(p * static_cast<double>(bins), 0.0, static_cast<double>(bins - 1));
    ++counts[static_cast<std::size_t>(k)];
  }
  return counts;
}

/// Density of bin k over the selected groups.
std::optional<double> pooled(std::span<const std::vector<double>> histograms,
                             std::span<const std::size_t> selection, std::size_t k) {
  double inside = 0;
  double all = 0;
  for (const std::size_t group : selection) {
    inside += histograms[group][k];
    for (const double count : histograms[group]) all += count;
  }
  if (all <= 0) return std::nullopt;
  return inside / all * static_cast<double>(histograms.front().size());
}

/// The time of one run in one bin of phi before its onset.
struct Stay {
  double cycles = 0;
  double grain_cycles = 0;
  std::size_t events = 0;  ///< 0 or 1
};
using Stays = std::map<std::int64_t, Stay>;  ///< by the bin's number

Stays stays_of(const FigureRun& run, Region region) {
  const RunOnset onset = onset_by_size(run);
  Stays stays;
  if (onset.observed == Observed::before_start) return stays;
  for (std::size_t k = 1; k < run.checkpoints.size(); ++k) {
    const CheckpointMeasures &from = run.checkpoints[k - 1], &to = run.checkpoints[k];
    const bool here = onset.observed == Observed::yes && onset.cycle <= to.cycle;
    const double cycles = (here ? onset.cycle : to.cycle) - from.cycle;
    if (const double phi = from.measures.number(region == Region::core ? "core_phi" : "phi");
        std::isfinite(phi)) {
      Stay& stay = stays[std::llround(std::floor(phi / phi_bin))];
      stay.cycles += cycles;
      stay.grain_cycles += cycles * from.measures.number(grains_of(region));
      stay.events += here ? 1 : 0;
    }
    if (here) break;
  }
  return stays;
}

Interval poisson_interval(std::size_t events) {
  const auto quantile = [](double probability, double freedom) {
    return boost::math::quantile(boost::math::chi_squared(freedom), probability) / 2;
  };
  const double tail = (1 - confidence_level) / 2;
  const double n = static_cast<double>(events);
  return {events == 0 ? 0 : quantile(tail, 2 * n), quantile(1 - tail, 2 * n + 2)};
}

/// One run's share of the likelihood in one stratum: an amplitude and a bin of phi.
struct Share {
  double grains;  ///< N
  const std::string* packing;
  double cycles;
  double log_size;
  bool event;
};

using Strata = std::map<std::pair<double, std::int64_t>, std::vector<Share>>;

struct Likelihood {
  double logarithm = 0;    ///< up to a constant
  double score = 0;        ///< its derivative by the exponent, which falls with the exponent
  double information = 0;  ///< the slope of that fall
  std::map<std::string, double> score_of;  ///< the part of each packing
};

/// Likelihood of the exponent, with the most likely c of each stratum. The score is a sum over
/// events: ln n less its mean over the stratum with the weights cycles n^a.
Likelihood likelihood(const Strata& strata, double exponent) {
  Likelihood sum;
  for (const auto& [stratum, shares] : strata) {
    const auto weight_of = [&](const Share& share) {
      return share.cycles * std::exp(exponent * share.log_size);
    };
    double weights = 0, weighted = 0, logs = 0, events = 0;
    for (const Share& share : shares) {
      weights += weight_of(share);
      weighted += weight_of(share) * share.log_size;
      logs += share.event ? share.log_size : 0;
      events += share.event ? 1 : 0;
    }
    if (!(events > 0 && weights > 0)) continue;
    sum.logarithm += exponent * logs - events * std::log(weights);
    for (const Share& share : shares) {
      const double off = share.log_size - weighted / weights;
      const double expected = events * weight_of(share) / weights;
      sum.score += share.event ? off : 0;
      sum.score_of[*share.packing] += ((share.event ? 1 : 0) - expected) * off;
      sum.information += expected * off * off;
    }
  }
  return sum;
}

/// Whether an event could have been in a larger cell of its stratum, and one in a smaller cell:
/// only then has the likelihood a maximum. Sizes are those of N. Seeds of one N differ a little in
/// their number of interior grains, which says nothing about the size.
bool is_bounded(const Strata& strata) {
  bool larger = false, smaller = false;
  for (const auto& [stratum, shares] : strata) {
    const auto [least, most] = std::ranges::minmax(shares, {}, &Share::grains);
    for (const Share& share : shares) {
      larger = larger || (share.event && share.grains < most.grains);
      smaller = smaller || (share.event && share.grains > least.grains);
    }
  }
  return larger && smaller;
}

/// What the drop of the logarithm is multiplied by for runs that share a packing.
double variance_between_packings(const Likelihood& at) {
  double squares = 0;
  for (const auto& [packing, score] : at.score_of) squares += score * score;
  return std::max(1.0, squares / at.information);
}

/// The point between the ends from which on `holds` is true.
double bisected(double low, double high, const auto& holds) {
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = (low + high) / 2;
    (holds(middle) ? high : low) = middle;
  }
  return (low + high) / 2;
}

}  // namespace

std::vector<double> nucleus_places(const FigureRun& run, CellAxis axis, Seen seen) {
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
  std::vector<std::vector<double>> histograms;
  std::vector<std::size_t> every;
  for (const std::vector<double>& places : groups) {
    every.push_back(histograms.size());
    histograms.push_back(histogram(places, bins));
  }
  std::vector<DensityBin> result;
  const double width = 1 / static_cast<double>(bins);
  for (std::size_t k = 0; k < bins; ++k) {
    const std::optional<double> value = pooled(histograms, every, k);
    if (!value) return {};
    const auto low = static_cast<double>(k) * width;
    result.push_back({low, low + width, *value,
                      bootstrap_error(groups.size(), [&](std::span<const std::size_t> selection) {
                        return pooled(histograms, selection, k);
                      })});
  }
  return result;
}

std::string grains_of(Region region) {
  return region == Region::core ? "core_grains" : "interior_grains";
}

std::vector<Exposure> exposures_of(const FigureRun& run, Region region) {
  std::vector<Exposure> exposures;
  for (const auto& [bin, stay] : stays_of(run, region)) {
    exposures.push_back(
        {static_cast<double>(bin) * phi_bin, stay.cycles, stay.grain_cycles, stay.events});
  }
  return exposures;
}

std::vector<NucleationRate> nucleation_rates(RunGroup runs, Region region) {
  Stays sums;
  for (const FigureRun* run : runs) {
    for (const auto& [bin, stay] : stays_of(*run, region)) {
      sums[bin].grain_cycles += stay.grain_cycles;
      sums[bin].events += stay.events;
    }
  }
  std::vector<NucleationRate> rates;
  for (const auto& [bin, sum] : sums) {
    if (!(sum.grain_cycles > 0)) continue;
    const Interval events = poisson_interval(sum.events);
    const auto number = static_cast<double>(bin);
    rates.push_back({number * phi_bin,
                     (number + 1) * phi_bin,
                     sum.events,
                     sum.grain_cycles,
                     static_cast<double>(sum.events) / sum.grain_cycles,
                     {events.low / sum.grain_cycles, events.high / sum.grain_cycles}});
  }
  return rates;
}

std::optional<Estimate> size_exponent(RunGroup runs, Region region) {
  Strata strata;
  std::size_t counted = 0;
  std::set<std::string> packings;
  for (const FigureRun* run : runs) {
    const Stays stays = stays_of(*run, region);
    if (stays.empty()) continue;
    ++counted;
    packings.insert(packing_of(*run));
    for (const auto& [bin, stay] : stays) {
      if (!(stay.grain_cycles > 0)) continue;
      strata[{number_of(*run, "amplitude_rad"), bin}].push_back(
          {number_of(*run, "grains"), &packing_of(*run), stay.cycles,
           std::log(stay.grain_cycles / stay.cycles), stay.events > 0});
    }
  }
  constexpr double widest = 30;  // n^30 is still a number
  const bool bounded = is_bounded(strata) && likelihood(strata, -widest).score > 1e-9 &&
                       likelihood(strata, widest).score < -1e-9;
  if (packings.size() < least_runs || !bounded) return std::nullopt;
  const double value = bisected(
      -widest, widest, [&](double exponent) { return likelihood(strata, exponent).score < 0; });
  const Likelihood best = likelihood(strata, value);
  const boost::math::chi_squared one_parameter(1);
  const double shared = packings.size() < counted ? variance_between_packings(best) : 1;
  const double least =
      best.logarithm - shared * boost::math::quantile(one_parameter, confidence_level) / 2;
  const auto unlikely = [&](double exponent) {
    return likelihood(strata, exponent).logarithm < least;
  };
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Interval interval = {
      unlikely(-widest)
          ? bisected(-widest, value, [&](double exponent) { return !unlikely(exponent); })
          : -infinity,
      unlikely(widest) ? bisected(value, widest, unlikely) : infinity};
  return estimate_with(value, interval, normal_quantile((1 + confidence_level) / 2), counted);
}

}  // namespace shearcell
