// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/nucleation.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <utility>

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

/// Density of bin k over the selected runs.
std::optional<double> pooled(std::span<const std::vector<double>> histograms,
                             std::span<const std::size_t> selection, std::size_t k) {
  double inside = 0;
  double all = 0;
  for (const std::size_t run : selection) {
    inside += histograms[run][k];
    for (const double count : histograms[run]) all += count;
  }
  if (all <= 0) return std::nullopt;
  return inside / all * static_cast<double>(histograms.front().size());
}

/// What one run spent in one bin of phi before its onset.
struct Stay {
  double cycles = 0;
  double grain_cycles = 0;
  std::size_t events = 0;  ///< 0 or 1
};
using Stays = std::map<std::int64_t, Stay>;  ///< by the bin's number

Stays stays_of(const FigureRun& run) {
  const RunOnset onset = onset_by_size(run, critical_size_for(run));
  Stays stays;
  if (onset.observed == Observed::before_start) return stays;
  for (std::size_t k = 1; k < run.checkpoints.size(); ++k) {
    const CheckpointMeasures &from = run.checkpoints[k - 1], &to = run.checkpoints[k];
    const bool here = onset.observed == Observed::yes && onset.cycle <= to.cycle;
    const double cycles = (here ? onset.cycle : to.cycle) - from.cycle;
    if (std::isfinite(from.measures.phi)) {
      Stay& stay = stays[std::llround(std::floor(from.measures.phi / phi_bin))];
      stay.cycles += cycles;
      stay.grain_cycles += cycles * static_cast<double>(from.measures.interior_grains);
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
  std::size_t stratum;
  double cycles;
  double log_size;
  bool event;
};

using Strata = std::map<std::size_t, std::vector<const Share*>>;

/// Derivative of the log likelihood by the exponent, with each stratum's c at its maximum: the sum
/// over events of ln N less its mean over the stratum, weighted by cycles N^a.
double score(const Strata& strata, double exponent) {
  double sum = 0;
  for (const auto& [stratum, shares] : strata) {
    double weights = 0, weighted = 0, logs = 0, events = 0;
    for (const Share* share : shares) {
      const double weight = share->cycles * std::exp(exponent * share->log_size);
      weights += weight;
      weighted += weight * share->log_size;
      logs += share->event ? share->log_size : 0;
      events += share->event ? 1 : 0;
    }
    if (events > 0 && weights > 0) sum += logs - events * weighted / weights;
  }
  return sum;
}

/// The exponent of maximum likelihood; the score falls with it. Infinite where all events are in
/// the largest or the smallest cells; none where no bin compares two sizes.
std::optional<double> most_likely(const Strata& strata) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  double low = -10, high = 10;
  const bool rises = score(strata, low) > 1e-9, falls = score(strata, high) < -1e-9;
  if (!rises && !falls) return std::nullopt;
  if (!falls) return infinite;
  if (!rises) return -infinite;
  for (int halving = 0; halving < 40; ++halving) {
    const double middle = (low + high) / 2;
    (score(strata, middle) > 0 ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace

std::vector<double> nucleus_places(const FigureRun& run, CellAxis axis) {
  std::vector<double> places;
  for (const CheckpointMeasures& checkpoint : run.checkpoints) {
    if (!checkpoint.crystallites) continue;
    const CrystalliteMap& map = *checkpoint.crystallites;
    for (std::size_t c = 0; c < map.size.size(); ++c) {
      if (map.size[c] < nucleus_smallest || map.size[c] > nucleus_largest) continue;
      places.push_back(place(map, map.centre[c], axis));
    }
  }
  return places;
}

std::vector<double> nucleus_births(const FigureRun& run, CellAxis axis) {
  std::vector<double> places;
  std::set<std::int32_t> known;  // grains that have been in a nucleus
  for (const CheckpointMeasures& checkpoint : run.checkpoints) {
    if (!checkpoint.crystallites) continue;
    const CrystalliteMap& map = *checkpoint.crystallites;
    std::vector<std::int32_t> seen(map.size.size());
    for (std::size_t k = 0; k < map.grain.size(); ++k) {
      if (known.contains(map.grain[k])) ++seen[static_cast<std::size_t>(map.label[k])];
    }
    for (std::size_t k = 0; k < map.grain.size(); ++k) {
      if (map.size[static_cast<std::size_t>(map.label[k])] >= nucleus_smallest) {
        known.insert(map.grain[k]);
      }
    }
    for (std::size_t c = 0; c < map.size.size(); ++c) {
      const bool is_new = map.size[c] >= nucleus_smallest && 2 * seen[c] < map.size[c];
      if (is_new && map.size[c] <= nucleus_largest) {
        places.push_back(place(map, map.centre[c], axis));
      }
    }
  }
  return places;
}

std::vector<DensityBin> density(std::span<const std::vector<double>> runs, std::size_t bins) {
  std::vector<std::vector<double>> histograms;
  std::vector<std::size_t> every;
  for (const std::vector<double>& places : runs) {
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
                      bootstrap_error(runs.size(), [&](std::span<const std::size_t> selection) {
                        return pooled(histograms, selection, k);
                      })});
  }
  return result;
}

std::vector<NucleationRate> nucleation_rates(RunGroup runs) {
  Stays sums;
  for (const FigureRun* run : runs) {
    for (const auto& [bin, stay] : stays_of(*run)) {
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

std::optional<Estimate> size_exponent(RunGroup runs) {
  std::map<std::pair<double, std::int64_t>, std::size_t> strata;
  std::vector<std::vector<Share>> shares;
  for (const FigureRun* run : runs) {
    std::vector<Share> of_run;
    for (const auto& [bin, stay] : stays_of(*run)) {
      if (!(stay.grain_cycles > 0)) continue;
      const auto stratum =
          strata.emplace(std::pair(number_of(*run, "amplitude_rad"), bin), strata.size());
      of_run.push_back({stratum.first->second, stay.cycles,
                        std::log(stay.grain_cycles / stay.cycles), stay.events > 0});
    }
    if (!of_run.empty()) shares.push_back(std::move(of_run));
  }
  if (shares.size() < least_runs) return std::nullopt;
  return bootstrapped(shares.size(), [&](std::span<const std::size_t> selected) {
    Strata by_stratum;
    for (const std::size_t run : selected) {
      for (const Share& share : shares[run]) by_stratum[share.stratum].push_back(&share);
    }
    return most_likely(by_stratum);
  });
}

}  // namespace shearcell
