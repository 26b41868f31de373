// SPDX-License-Identifier: GPL-3.0-or-later
// Synthetic numbers and runs, for figures and statistics with known results.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "analysis/crystal.hpp"
#include "analysis/figure.hpp"
#include "core/random.hpp"
#include "experiments/manifest/shipped.hpp"

namespace shearcell::test {

/// Normal, of mean 0 and variance 1, by Box and Muller; each `sample` is independent of the others.
inline std::vector<double> normal_numbers(std::uint32_t sample, std::size_t count) {
  std::vector<double> values;
  for (std::uint32_t k = 0; k < count; ++k) {
    const auto [u, v] = uniform_pair({sample, k, 0, 1}, 7);
    values.push_back(std::sqrt(-2 * std::log1p(-u)) * std::cos(2 * std::numbers::pi * v));
  }
  return values;
}

/// The mean of the selected values.
inline RunStatistic mean_over(std::vector<double> values) {
  return [values = std::move(values)](std::span<const std::size_t> selection) {
    std::vector<double> selected;
    for (const std::size_t k : selection) selected.push_back(values[k]);
    return over_runs(selected).mean.value_or(std::nan(""));
  };
}

/// Cycles 0 .. cycles, each filled by `fill`.
inline FrameRun made_up_run(const std::string& key, const nlohmann::json& value, std::uint64_t seed,
                            int cycles, const std::function<void(int, Measures&)>& fill) {
  FrameRun run;
  const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  run.place.variant = key + "=" + text;
  run.stage.id = run.place.variant + "/" + std::to_string(seed);
  run.place.swept = {{key, value}};
  run.parameters = {{"amplitude_rad", 0.0833}, {"grains", 5200}, {"pressure_at", "top"}};
  run.place.seed = seed;
  for (int n = 0; n <= cycles; ++n) {
    CheckpointMeasures checkpoint;
    checkpoint.cycle = n;
    checkpoint.measures.numbers = {{"interior_grains", 3335},  {"largest_crystallite", 0},
                                   {"crystalline_percent", 0}, {"phi", 0},
                                   {"phi_uncorrected", 0},     {"mean_overlap_d", 0},
                                   {"contacts_per_grain", 0}};
    fill(n, checkpoint.measures);
    run.checkpoints.push_back(checkpoint);
  }
  return run;
}

/// phi and the percentage rise from cycle to cycle, and are higher by `shift`.
inline FrameRun rising_run(const std::string& fluid, std::uint64_t seed, int cycles, double shift) {
  return made_up_run("fluid", fluid, seed, cycles, [shift](int n, Measures& m) {
    m.numbers["phi"] = 0.6005 + 0.01 * n + shift;
    m.numbers["phi_uncorrected"] = 0.61 + 0.01 * n + shift;
    m.numbers["mean_overlap_d"] = 0.002;
    m.numbers["crystalline_percent"] = n + 100 * shift;
  });
}

/// One run with a moving fluid and two in a fluid at rest.
inline std::vector<FrameRun> two_variants() {
  return {rising_run("cell", 1, 2, 0), rising_run("still", 1, 1, 0),
          rising_run("still", 2, 1, 0.02)};
}

/// Figure S2 of these runs.
inline std::vector<Table> s2(std::span<const FrameRun> runs) {
  return find_figure("S2")->make(runs).tables;
}

inline std::vector<std::int32_t> grain_ids(std::int32_t first, std::int32_t count) {
  std::vector<std::int32_t> ids(static_cast<std::size_t>(count));
  std::iota(ids.begin(), ids.end(), first);
  return ids;
}

/// A map in which each list of grains is a crystallite. Grains need not be in order.
inline CrystalliteMap map_of(const std::vector<std::vector<std::int32_t>>& crystallites) {
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

}  // namespace shearcell::test
