// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/growth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace shearcell {
namespace {

using Selection = std::span<const std::size_t>;
using BySize = Eigen::Array<double, GrowthCurve::largest, 1>;
using FromSize = Eigen::Matrix<double, GrowthCurve::largest, GrowthCurve::largest>;

/// Columns of GrowthCurve::Sums: moments 0 to 2 of the number of crystallites, moments 0 and 1 of
/// the excess (growing minus shrinking crystallites), and the excess summed over this row's size
/// and all larger sizes.
enum Column : Eigen::Index { all_0, all_1, all_2, excess_0, excess_1, tail };

double log_size(Eigen::Index k) {
  return std::log(static_cast<double>(k + 1));
}

/// Matrix that turns counts by size into weighted moments of ln(size). A column belongs to the size
/// of the counted crystallites, a row to the size about which the moment is taken.
const FromSize& moment(int power) {
  static const std::array<FromSize, 3> all = [] {
    std::array<FromSize, 3> made;
    for (Eigen::Index k = 0; k < GrowthCurve::largest; ++k) {
      for (Eigen::Index j = 0; j < GrowthCurve::largest; ++j) {
        const double x = log_size(j) - log_size(k), z = x / GrowthCurve::bandwidth;
        made[0](k, j) = std::exp(-z * z / 2);
        made[1](k, j) = x * made[0](k, j);
        made[2](k, j) = x * made[1](k, j);
      }
    }
    return made;
  }();
  return all[static_cast<std::size_t>(power)];
}

/// Smoothed delta_rho for each row of the sums; constant if all crystallites have the same size.
template <class Sums>
auto smooth(const Sums& sums) {
  const auto n = sums.col(all_0), x = sums.col(all_1), xx = sums.col(all_2);
  const auto y = sums.col(excess_0), xy = sums.col(excess_1);
  const auto scatter = n * xx - x * x;
  return (scatter > 1e-9 * n * xx).select((xx * y - x * xy) / scatter, y / n).eval();
}

/// The size that GrowthCurve::critical_size() defines. If there is no such size: minus infinity if
/// delta_rho > 0 at size 1 and the excess, summed over all sizes, is positive; otherwise infinity.
template <class Sums>
double rise(const Sums& sums) {
  const auto delta = smooth(sums);
  double found = infinite, greatest = 0;
  if (delta[0] > 0 && sums(0, tail) > 0) {
    found = -infinite;
    greatest = sums(0, tail);
  }
  for (Eigen::Index k = 1; k < delta.size(); ++k) {
    if (!(delta[k - 1] <= 0 && delta[k] > 0 && sums(k, tail) > greatest)) continue;
    greatest = sums(k, tail);
    const double part = delta[k - 1] / (delta[k - 1] - delta[k]);
    found = std::exp(log_size(k - 1) + part * (log_size(k) - log_size(k - 1)));
  }
  return found;
}

/// The largest size at which the summed excess (column `tail`) has its maximum. Exceptions:
/// infinity if the maximum is not positive; minus infinity if the sum at size 1 is a positive
/// maximum.
template <class Sums>
double best_division(const Sums& sums) {
  const auto excess = sums.col(tail);
  const double greatest = excess.maxCoeff();
  if (!(greatest > 0)) return infinite;
  Eigen::Index k = GrowthCurve::largest - 1;
  while (excess[k] < greatest) --k;
  return excess[0] < greatest ? static_cast<double>(k + 1) : -infinite;
}

/// Standard error for independent crystallites. It is not zero even if all crystallites grew.
double standard_error(const GrowthCount& count) {
  const auto larger = static_cast<double>(count.larger()) + 1;
  const auto smaller = static_cast<double>(count.smaller()) + 1;
  const double n = larger + smaller;
  return 2 * std::sqrt(larger * smaller / (n + 1)) / n;
}

double delta_rho_of(const GrowthCount& count) {
  const auto larger = static_cast<double>(count.larger());
  const auto smaller = static_cast<double>(count.smaller());
  return (larger - smaller) / (larger + smaller);
}

}  // namespace

GrowthCount& GrowthCount::operator+=(const GrowthCount& other) {
  grew += other.grew;
  absorbed += other.absorbed;
  shrank += other.shrank;
  vanished += other.vanished;
  return *this;
}

void follow(const CrystalliteMap& now, const CrystalliteMap& later, GrowthBySize& counts) {
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> shared;  // grains, by labels
  std::size_t l = 0;  // both lists of grains are in ascending order
  for (std::size_t k = 0; k < now.grain.size(); ++k) {
    while (l < later.grain.size() && later.grain[l] < now.grain[k]) ++l;
    if (l == later.grain.size()) break;
    if (later.grain[l] == now.grain[k]) ++shared[{now.label[k], later.label[l]}];
  }
  // The crystallites of `later` that contain the grains of one crystallite C of `now`.
  struct Outcome {
    // Numbers of grains of C whose crystallite in `later` is larger than C, as large as C, or
    // smaller than C.
    std::int32_t larger = 0, same = 0, smaller = 0;
    std::int32_t most = 0;  // largest number of grains of C in one crystallite of `later`
    std::size_t end = 0;    // label of this crystallite of `later`
  };
  std::vector<Outcome> fates(now.size.size());
  // The crystallite of `now` that contributed the most grains to one crystallite of `later`.
  struct Origin {
    std::int32_t most = 0, size = 0;  // number of contributed grains; size in `now`
  };
  std::vector<Origin> origins(later.size.size());
  for (const auto& [labels, grains] : shared) {
    const auto after = static_cast<std::size_t>(labels.second);
    Outcome& fate = fates[static_cast<std::size_t>(labels.first)];
    const std::int32_t size = now.size[static_cast<std::size_t>(labels.first)];
    if (later.size[after] > size) fate.larger += grains;
    if (later.size[after] == size) fate.same += grains;
    if (later.size[after] < size) fate.smaller += grains;
    if (grains > fate.most) {
      fate.most = grains;
      fate.end = after;
    }
    if (grains > origins[after].most) origins[after] = {grains, size};
  }
  for (std::size_t c = 0; c < fates.size(); ++c) {
    const auto& [larger, same, smaller, most, end] = fates[c];
    const std::int32_t size = now.size[c];
    GrowthCount& count = counts[size];
    if (2 * larger > size) {
      ++(origins[end].size > size ? count.absorbed : count.grew);
    } else if (2 * (size - larger - same) > size) {
      // size - larger - same: number of grains in smaller crystallites or in no crystallite.
      ++(2 * smaller > size ? count.shrank : count.vanished);
    }
  }
}

GrowthBySize growth_of(const FrameRun& run, std::int64_t cycles) {
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
    for (const auto& [size, count] : run) all[size] += count;
  }
  std::vector<GrowthRate> rates;
  GrowthRate bin;
  double log_sizes = 0;
  std::vector<GrowthCount> of_run(runs.size());  // counts of each run in the bin
  for (const auto& [size, count] : all) {
    const auto counted = static_cast<double>(count.larger() + count.smaller());
    bin.count += count;
    log_sizes += counted * std::log(size);
    for (std::size_t k = 0; k < runs.size(); ++k) {
      const auto found = runs[k].find(size);
      if (found != runs[k].end()) of_run[k] += found->second;
    }
    const std::size_t n = bin.count.larger() + bin.count.smaller();
    if (n < least_counted) continue;
    const auto error = bootstrap_error(runs.size(), [&](Selection selection) {
      GrowthCount sum;
      for (const std::size_t k : selection) sum += of_run[k];
      return delta_rho_of(sum);
    });
    bin.size = std::exp(log_sizes / static_cast<double>(n));
    bin.delta = delta_rho_of(bin.count);
    bin.delta_error = std::max(standard_error(bin.count), error.value_or(0));
    rates.push_back(std::exchange(bin, {}));
    log_sizes = 0;
    of_run.assign(runs.size(), {});
  }
  return rates;
}

GrowthCurve::GrowthCurve(std::span<const GrowthBySize> runs, double background) {
  for (const GrowthBySize& run : runs) {
    BySize all = BySize::Zero(), excess = BySize::Zero();
    for (const auto& [size, count] : run) {
      if (size > largest) break;
      const auto larger = static_cast<double>(count.larger());
      const auto smaller = static_cast<double>(count.smaller());
      all[size - 1] = larger + smaller;
      excess[size - 1] = larger - smaller - background * (larger + smaller);
    }
    Sums& sums = runs_.emplace_back();
    for (const int power : {0, 1, 2}) sums.col(all_0 + power) = moment(power) * all.matrix();
    for (const int power : {0, 1}) sums.col(excess_0 + power) = moment(power) * excess.matrix();
    double above = 0;
    for (Eigen::Index k = largest; k-- > 0;) sums(k, tail) = above += excess[k];
  }
}

GrowthCurve::Sums GrowthCurve::over(Selection selection) const {
  Sums sums = Sums::Zero();
  for (const std::size_t run : selection) sums += runs_[run];
  return sums;
}

double GrowthCurve::delta_rho(std::int32_t size) const {
  return smooth(std::accumulate(runs_.begin(), runs_.end(), Sums(Sums::Zero())))[size - 1];
}

std::optional<double> GrowthCurve::delta_rho_error(std::int32_t size) const {
  return bootstrap_error(runs_.size(), [&](Selection selection) {
    Eigen::Array<double, 1, 6> sums = Eigen::Array<double, 1, 6>::Zero();
    for (const std::size_t run : selection) sums += runs_[run].row(size - 1);
    return smooth(sums)[0];
  });
}

std::optional<Estimate> GrowthCurve::critical_size() const {
  return bootstrapped(runs_.size(), [&](Selection selection) { return rise(over(selection)); });
}

std::optional<Estimate> GrowthCurve::monotone_critical_size() const {
  return bootstrapped(runs_.size(),
                      [&](Selection selection) { return best_division(over(selection)); });
}

Interval GrowthCurve::repeated_critical_size(std::size_t runs) const {
  return repetitions(runs_.size(), runs,
                     [&](Selection selection) { return rise(over(selection)); });
}

void add_size_columns(const std::string& name, std::vector<TableColumn>& columns) {
  for (const char* ending : {"", "_low", "_high", "_standard_error"}) {
    columns.push_back(name + ending + "_grains");
  }
}

void add_size(const std::optional<Estimate>& size, TableRow& row) {
  if (!size) {
    row.resize(row.size() + 4);
    return;
  }
  row.insert(row.end(),
             {size->value, size->interval.low, size->interval.high, point_of(0, *size).y_error});
}

ChartPoint point_of(double x, const Estimate& size) {
  return {
      .x = x, .y = size.value, .y_error = size.spread / std::sqrt(static_cast<double>(size.runs))};
}

}  // namespace shearcell
