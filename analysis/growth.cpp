// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/growth.hpp"

#include <cmath>

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

}  // namespace shearcell
