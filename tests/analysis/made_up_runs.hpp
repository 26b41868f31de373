// SPDX-License-Identifier: GPL-3.0-or-later
// Runs that nobody simulated, for figures and statistics with known answers.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "analysis/crystallite_map.hpp"
#include "analysis/figure.hpp"

namespace shearcell::testing {

/// Cycles 0 .. cycles, each filled by `fill`.
inline FigureRun made_up_run(const std::string& key, const nlohmann::json& value,
                             std::uint64_t seed, int cycles,
                             const std::function<void(int, Measures&)>& fill) {
  FigureRun run;
  const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  run.variant = key + "=" + text;
  run.run_id = run.variant + "/" + std::to_string(seed);
  run.labels = {{key, value}};
  run.parameters = {{"amplitude_rad", 0.0833}, {"grains", 5200}, {"pressure_at", "top"}};
  run.seed = seed;
  for (int n = 0; n <= cycles; ++n) {
    CheckpointMeasures checkpoint;
    checkpoint.cycle = n;
    checkpoint.measures.interior_grains = 3335;
    fill(n, checkpoint.measures);
    run.checkpoints.push_back(checkpoint);
  }
  return run;
}

/// A map in which each list of grains is a crystallite. Grains need not be in order.
inline CrystalliteMap map_of(std::initializer_list<std::vector<std::int32_t>> crystallites) {
  CrystalliteMap map;
  std::vector<std::pair<std::int32_t, std::int32_t>> grains;
  for (const std::vector<std::int32_t>& members : crystallites) {
    for (const std::int32_t grain : members) {
      grains.emplace_back(grain, static_cast<std::int32_t>(map.size.size()));
    }
    map.size.push_back(static_cast<std::int32_t>(members.size()));
    map.centre.emplace_back(0, 0, 0);
  }
  std::sort(grains.begin(), grains.end());
  for (const auto& [grain, label] : grains) {
    map.grain.push_back(grain);
    map.label.push_back(label);
  }
  return map;
}

}  // namespace shearcell::testing
