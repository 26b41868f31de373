// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/nucleation_rate.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include "analysis/onset.hpp"

namespace shearcell {
namespace {

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

/// Derivative of the log likelihood by the exponent, with each stratum's c at its maximum: the sum
/// over events of ln N less its mean over the stratum, weighted by cycles N^a.
class Score {
 public:
  Score(const std::vector<std::vector<Share>>& runs, std::span<const std::size_t> selected) {
    for (const std::size_t run : selected) {
      for (const Share& share : runs[run]) strata_[share.stratum].push_back(&share);
    }
  }
  double at(double exponent) const {
    double score = 0;
    for (const auto& [stratum, shares] : strata_) {
      double weights = 0, weighted = 0, logs = 0, events = 0;
      for (const Share* share : shares) {
        const double weight = share->cycles * std::exp(exponent * share->log_size);
        weights += weight;
        weighted += weight * share->log_size;
        logs += share->event ? share->log_size : 0;
        events += share->event ? 1 : 0;
      }
      if (events > 0 && weights > 0) score += logs - events * weighted / weights;
    }
    return score;
  }

 private:
  std::map<std::size_t, std::vector<const Share*>> strata_;
};

/// The score falls with the exponent. None where it has no zero: then no bin compares two sizes, or
/// all events are in the largest or the smallest cells.
std::optional<double> zero_of(const Score& score) {
  double low = -10, high = 10;
  if (!(score.at(low) > 1e-9) || !(score.at(high) < -1e-9)) return std::nullopt;
  for (int halving = 0; halving < 40; ++halving) {
    const double middle = (low + high) / 2;
    (score.at(middle) > 0 ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace

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
    return zero_of(Score(shares, selected));
  });
}

}  // namespace shearcell
