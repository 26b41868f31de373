// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/growth.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace shearcell {
namespace {

/// Counts of each size from 1 on, in one column per run.
struct Cases {
  Eigen::ArrayXd log_size;
  Eigen::ArrayXXd grew;    ///< sizes x runs
  Eigen::ArrayXXd shrank;  ///< likewise
};

Cases cases_of(std::span<const GrowthBySize> runs, Vanished vanished) {
  Cases cases;
  std::int32_t largest = 1;
  for (const GrowthBySize& run : runs) {
    if (!run.empty())
      largest = std::max(largest, std::min(largest_size_fitted, run.rbegin()->first));
  }
  cases.log_size = Eigen::ArrayXd::LinSpaced(largest, 1, largest).log();
  cases.grew.setZero(largest, static_cast<Eigen::Index>(runs.size()));
  cases.shrank = cases.grew;
  Eigen::Index column = 0;
  for (const GrowthBySize& run : runs) {
    for (const auto& [size, count] : run) {
      if (size > largest_size_fitted) break;
      const std::size_t out = vanished == Vanished::left_out ? count.vanished : 0;
      cases.grew(size - 1, column) = static_cast<double>(count.grew);
      cases.shrank(size - 1, column) = static_cast<double>(count.shrank - out);
    }
    ++column;
  }
  return cases;
}

/// Newton's method on the log-likelihood, which is concave; a step that would lower it is halved.
std::optional<GrowthFit> fit(const Eigen::ArrayXd& log_size, const Eigen::ArrayXd& grew,
                             const Eigen::ArrayXd& shrank) {
  const Eigen::ArrayXd all = grew + shrank;
  if (grew.sum() <= 0 || shrank.sum() <= 0) return std::nullopt;
  const double mean = (all * log_size).sum() / all.sum();
  const Eigen::ArrayXd x = log_size - mean;
  if ((all * x.square()).sum() <= 1e-12 * all.sum()) return std::nullopt;
  const auto log_likelihood = [&](const Eigen::Vector2d& theta) {
    const Eigen::ArrayXd odds = theta[0] + theta[1] * x;
    return (grew * odds - all * (odds.max(0) + (-odds.abs()).exp().log1p())).sum();
  };
  Eigen::Vector2d theta(std::log(grew.sum() / shrank.sum()), 0);
  for (int step = 0; step < 50; ++step) {
    const Eigen::ArrayXd p = 1 / (1 + (-(theta[0] + theta[1] * x)).exp());
    const Eigen::ArrayXd residual = grew - all * p;
    const Eigen::ArrayXd weight = all * p * (1 - p);
    const Eigen::Vector2d gradient(residual.sum(), (residual * x).sum());
    Eigen::Matrix2d curvature;
    curvature << weight.sum(), (weight * x).sum(), (weight * x).sum(), (weight * x.square()).sum();
    Eigen::Vector2d move = curvature.ldlt().solve(gradient);
    if (!move.allFinite()) break;  // sizes that grew and sizes that shrank do not mix
    if (move.norm() > 2) move *= 2 / move.norm();
    const double before = log_likelihood(theta), rounding = 1e-9 * std::abs(before);
    while (move.norm() > 1e-10 && log_likelihood(theta + move) < before - rounding) move /= 2;
    theta += move;
    if (move.norm() < 1e-10) break;
  }
  return GrowthFit{theta[0] - theta[1] * mean, theta[1]};
}

using Selection = std::span<const std::size_t>;

/// Sums of the counts, which are `cases.grew` or `cases.shrank`, over the selected runs.
Eigen::ArrayXd sum_over(const Eigen::ArrayXXd& counts, Selection selection) {
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(counts.rows());
  for (const std::size_t run : selection) sum += counts.col(static_cast<Eigen::Index>(run));
  return sum;
}

/// The fits to selections of the runs, each made once.
class Fits {
 public:
  explicit Fits(Cases cases) : cases_(std::move(cases)) {}

  /// Bootstrap of `value`, a function of the fit.
  template <class Value>
  std::optional<Estimate> estimate(const Value& value) {
    const auto statistic = [&](Selection selection) -> std::optional<double> {
      const auto [known, first] = fits_.try_emplace({selection.begin(), selection.end()});
      if (first) {
        known->second = fit(cases_.log_size, sum_over(cases_.grew, selection),
                            sum_over(cases_.shrank, selection));
      }
      return known->second ? value(*known->second) : std::nullopt;
    };
    return bootstrapped(static_cast<std::size_t>(cases_.grew.cols()), statistic);
  }

 private:
  Cases cases_;
  std::map<std::vector<std::size_t>, std::optional<GrowthFit>> fits_;
};

/// Pools neighbouring sizes until the share that grew rises from pool to pool. Returns the smallest
/// size of the first pool of which more than half grew; infinite if there is no such pool.
double first_that_grows(const Eigen::ArrayXd& grew, const Eigen::ArrayXd& shrank) {
  struct Pool {
    double size, grew, all;
  };
  std::vector<Pool> pools;
  for (Eigen::Index k = 0; k < grew.size(); ++k) {
    if (!(grew[k] + shrank[k] > 0)) continue;
    pools.push_back({static_cast<double>(k + 1), grew[k], grew[k] + shrank[k]});
    while (pools.size() > 1) {
      const Pool last = pools.back();
      Pool& before = pools[pools.size() - 2];
      if (last.grew * before.all > before.grew * last.all) break;
      before.grew += last.grew;
      before.all += last.all;
      pools.pop_back();
    }
  }
  const auto found =
      std::ranges::find_if(pools, [](const Pool& pool) { return 2 * pool.grew > pool.all; });
  return found == pools.end() ? std::numeric_limits<double>::infinity() : found->size;
}

}  // namespace

void follow(const CrystalliteMap& now, const CrystalliteMap& later, GrowthBySize& counts) {
  struct Fate {
    std::int32_t larger = 0;
    std::int32_t same = 0;
    std::int32_t smaller = 0;
  };
  std::vector<Fate> fates(now.size.size());
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> shared;  // grains, by both labels
  std::size_t l = 0;  // both lists of grains ascend
  for (std::size_t k = 0; k < now.grain.size(); ++k) {
    while (l < later.grain.size() && later.grain[l] < now.grain[k]) ++l;
    if (l == later.grain.size()) break;
    if (later.grain[l] != now.grain[k]) continue;
    const auto label = static_cast<std::size_t>(now.label[k]);
    ++shared[{now.label[k], later.label[l]}];
    const std::int32_t before = now.size[label];
    const std::int32_t after = later.size[static_cast<std::size_t>(later.label[l])];
    if (after > before) ++fates[label].larger;
    if (after == before) ++fates[label].same;
    if (after < before) ++fates[label].smaller;
  }
  // The crystallite that each later one has most grains of, and the later one of each.
  struct Most {
    std::int32_t grains = 0, of = -1;
  };
  std::vector<Most> origin(later.size.size()), end(now.size.size());
  for (const auto& [labels, grains] : shared) {
    const auto [before_label, after_label] = labels;
    Most &from = origin[static_cast<std::size_t>(after_label)],
         &to = end[static_cast<std::size_t>(before_label)];
    if (grains > from.grains) from = {grains, before_label};
    if (grains > to.grains) to = {grains, after_label};
  }
  for (std::size_t c = 0; c < fates.size(); ++c) {
    const std::int32_t size = now.size[c];
    const std::int32_t smaller_or_none = size - fates[c].larger - fates[c].same;
    GrowthCount& count = counts[size];
    if (2 * fates[c].larger > size) {
      ++count.grew;
      const std::int32_t from = origin[static_cast<std::size_t>(end[c].of)].of;
      if (now.size[static_cast<std::size_t>(from)] > size) ++count.absorbed;
    } else if (2 * smaller_or_none > size) {
      ++count.shrank;
      if (2 * fates[c].smaller <= size) ++count.vanished;
    }
  }
}

GrowthBySize growth_of(const FigureRun& run, std::int64_t cycles) {
  std::map<std::int64_t, const CrystalliteMap*> maps;
  for (const CheckpointMeasures& checkpoint : run.checkpoints) {
    if (!checkpoint.measures.crystallite_map || std::floor(checkpoint.cycle) != checkpoint.cycle)
      continue;
    maps[static_cast<std::int64_t>(checkpoint.cycle)] = &*checkpoint.measures.crystallite_map;
  }
  GrowthBySize counts;
  for (const auto& [cycle, map] : maps) {
    const auto later = maps.find(cycle + cycles);
    if (later != maps.end()) follow(*map, *later->second, counts);
  }
  return counts;
}

std::vector<GrowthRate> growth_rates(std::span<const GrowthBySize> runs,
                                     std::size_t least_counted) {
  GrowthBySize all;
  for (const GrowthBySize& run : runs) {
    for (const auto& [size, count] : run) {
      all[size].grew += count.grew;
      all[size].shrank += count.shrank;
    }
  }
  std::vector<GrowthRate> rates;
  GrowthCount bin;
  double log_sizes = 0;
  for (const auto& [size, count] : all) {
    log_sizes += static_cast<double>(count.grew + count.shrank) * std::log(size);
    bin.grew += count.grew;
    bin.shrank += count.shrank;
    GrowthRate rate;
    rate.counted = bin.grew + bin.shrank;
    if (rate.counted < least_counted) continue;
    const auto n = static_cast<double>(rate.counted);
    rate.size = std::exp(log_sizes / n);
    rate.grow = static_cast<double>(bin.grew) / n;
    rate.shrink = static_cast<double>(bin.shrank) / n;
    const double grew = static_cast<double>(bin.grew) + 1;
    const double shrank = static_cast<double>(bin.shrank) + 1;
    rate.grow_error = std::sqrt(grew * shrank / (n + 3)) / (n + 2);
    rate.delta = rate.grow - rate.shrink;
    rate.delta_error = 2 * rate.grow_error;
    rates.push_back(rate);
    bin = {};
    log_sizes = 0;
  }
  return rates;
}

double GrowthFit::delta_rho(double size) const {
  return std::tanh((intercept + slope * std::log(size)) / 2);
}

std::optional<double> GrowthFit::critical_size() const {
  if (!(slope > 0)) return std::nullopt;
  return std::exp(-intercept / slope);
}

std::optional<GrowthFit> fit_growth(std::span<const GrowthBySize> runs) {
  const Cases cases = cases_of(runs, Vanished::shrank);
  return fit(cases.log_size, cases.grew.rowwise().sum(), cases.shrank.rowwise().sum());
}

std::optional<Estimate> critical_size(std::span<const GrowthBySize> runs, Vanished vanished) {
  const Cases cases = cases_of(runs, vanished);
  const auto found = Fits(cases).estimate([](const GrowthFit& fit) { return fit.critical_size(); });
  const auto largest = static_cast<double>(cases.log_size.size());
  if (!found || found->value < 1 || found->value > largest) return std::nullopt;
  return found;
}

std::optional<Estimate> monotone_critical_size(std::span<const GrowthBySize> runs) {
  const Cases cases = cases_of(runs, Vanished::shrank);
  const auto found = bootstrapped(runs.size(), [&](Selection selection) {
    return std::optional<double>(
        first_that_grows(sum_over(cases.grew, selection), sum_over(cases.shrank, selection)));
  });
  if (!found) return std::nullopt;
  const Eigen::ArrayXd all = (cases.grew + cases.shrank).rowwise().sum();
  const bool some_do_not = (all.head(static_cast<Eigen::Index>(found->value) - 1) > 0).any();
  return some_do_not ? found : std::nullopt;
}

std::vector<std::optional<Estimate>> fitted_delta_rho(std::span<const GrowthBySize> runs,
                                                      std::span<const double> sizes) {
  Fits fits(cases_of(runs, Vanished::shrank));
  std::vector<std::optional<Estimate>> all;
  for (const double size : sizes) {
    auto& found = all.emplace_back(fits.estimate(
        [size](const GrowthFit& fit) { return std::optional<double>(fit.delta_rho(size)); }));
    if (!found) continue;
    found->interval.low = std::max(-1.0, found->interval.low);
    found->interval.high = std::min(1.0, found->interval.high);
  }
  return all;
}

}  // namespace shearcell
