// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/growth.hpp"

#include <cmath>

#include "analysis/statistics.hpp"

namespace shearcell {
namespace {

void add(const GrowthBySize& from, GrowthBySize& to) {
  for (const auto& [size, count] : from) {
    GrowthCount& sum = to[size];
    sum.grew += count.grew;
    sum.shrank += count.shrank;
    sum.vanished += count.vanished;
    sum.same += count.same;
    sum.undecided += count.undecided;
  }
}

struct Step {
  double weight;
  double size;   // mean
  double delta;  // mean
};

/// Pool-adjacent-violators.
std::vector<Step> isotonic(std::span<const GrowthRate> rates) {
  std::vector<Step> steps;
  for (const GrowthRate& rate : rates) {
    if (rate.size > largest_size_for_zero) break;
    steps.push_back(
        {static_cast<double>(rate.counted), static_cast<double>(rate.size), rate.delta});
    while (steps.size() > 1 && steps[steps.size() - 2].delta >= steps.back().delta) {
      const Step last = steps.back();
      steps.pop_back();
      Step& into = steps.back();
      const double weight = into.weight + last.weight;
      into.size = (into.weight * into.size + last.weight * last.size) / weight;
      into.delta = (into.weight * into.delta + last.weight * last.delta) / weight;
      into.weight = weight;
    }
  }
  return steps;
}

}  // namespace

void follow(const CrystalliteMap& now, const CrystalliteMap& later, GrowthBySize& counts) {
  struct Fate {
    std::int32_t larger = 0;
    std::int32_t same = 0;
    std::int32_t smaller = 0;
  };
  std::vector<Fate> fates(now.size.size());
  std::size_t l = 0;  // both lists of grains ascend
  for (std::size_t k = 0; k < now.grain.size(); ++k) {
    while (l < later.grain.size() && later.grain[l] < now.grain[k]) ++l;
    if (l == later.grain.size()) break;
    if (later.grain[l] != now.grain[k]) continue;
    const auto label = static_cast<std::size_t>(now.label[k]);
    const std::int32_t before = now.size[label];
    const std::int32_t after = later.size[static_cast<std::size_t>(later.label[l])];
    if (after > before) ++fates[label].larger;
    if (after == before) ++fates[label].same;
    if (after < before) ++fates[label].smaller;
  }
  for (std::size_t c = 0; c < fates.size(); ++c) {
    const std::int32_t size = now.size[c];
    const std::int32_t smaller_or_none = size - fates[c].larger - fates[c].same;
    GrowthCount& count = counts[size];
    if (2 * fates[c].larger > size) {
      ++count.grew;
    } else if (2 * smaller_or_none > size) {
      ++count.shrank;
      if (2 * fates[c].smaller <= size) ++count.vanished;
    } else if (2 * fates[c].same > size) {
      ++count.same;
    } else {
      ++count.undecided;
    }
  }
}

GrowthBySize growth_of(const FigureRun& run, std::int64_t cycles) {
  std::map<std::int64_t, const CrystalliteMap*> maps;
  for (const CheckpointMeasures& checkpoint : run.checkpoints) {
    if (!checkpoint.crystallites || std::floor(checkpoint.cycle) != checkpoint.cycle) continue;
    maps[static_cast<std::int64_t>(checkpoint.cycle)] = &*checkpoint.crystallites;
  }
  GrowthBySize counts;
  for (const auto& [cycle, map] : maps) {
    const auto later = maps.find(cycle + cycles);
    if (later != maps.end()) follow(*map, *later->second, counts);
  }
  return counts;
}

std::vector<GrowthRate> growth_rates(std::span<const GrowthBySize> runs) {
  GrowthBySize all;
  for (const GrowthBySize& run : runs) add(run, all);
  std::vector<GrowthRate> rates;
  for (const auto& [size, count] : all) {
    GrowthRate rate;
    rate.size = size;
    rate.counted = count.grew + count.shrank;
    if (rate.counted == 0) continue;
    const auto n = static_cast<double>(rate.counted);
    rate.grow = static_cast<double>(count.grew) / n;
    rate.shrink = static_cast<double>(count.shrank) / n;
    const double grew = static_cast<double>(count.grew) + 1;
    const double shrank = static_cast<double>(count.shrank) + 1;
    rate.grow_error = std::sqrt(grew * shrank / (n + 3)) / (n + 2);
    rate.delta = rate.grow - rate.shrink;
    rate.delta_error = 2 * rate.grow_error;
    rates.push_back(rate);
  }
  return rates;
}

std::optional<double> critical_size(std::span<const GrowthRate> rates) {
  const std::vector<Step> steps = isotonic(rates);
  for (std::size_t k = 1; k < steps.size(); ++k) {
    if (!(steps[k - 1].delta <= 0 && steps[k].delta > 0)) continue;
    const double part = -steps[k - 1].delta / (steps[k].delta - steps[k - 1].delta);
    return steps[k - 1].size + part * (steps[k].size - steps[k - 1].size);
  }
  return std::nullopt;
}

CriticalSize critical_size_over(std::span<const GrowthBySize> runs) {
  const auto of = [&](std::span<const std::size_t> selection) {
    std::vector<GrowthBySize> selected;
    for (const std::size_t run : selection) selected.push_back(runs[run]);
    return critical_size(growth_rates(selected));
  };
  return {critical_size(growth_rates(runs)), bootstrap_error(runs.size(), of)};
}

}  // namespace shearcell
