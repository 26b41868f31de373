// SPDX-License-Identifier: GPL-3.0-or-later
// Which checkpoints a report shows as packings, and what it shows of them.
#pragma once

#include <cstddef>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "provenance/store.hpp"

namespace shearcell {

struct PackingChoice {
  std::vector<std::string> runs;  ///< ids of those to show; none for the default
  std::size_t runs_per_experiment =
      6;                           ///< by default the last run of each variant, so many of them
  std::size_t frames = 40;         ///< checkpoints of a run, at most
  std::size_t budget = 9'000'000;  ///< bytes of all packings in the page
};

struct Packings {
  /// [{id, label, experiment, grains, wall_grains, checkpoints, frames: [{name, sha256, facts,
  /// cell, fields, profiles, origin, step, data}]}]; the front end reads it (web/src/viewer.js).
  nlohmann::json runs = nlohmann::json::array();
  std::size_t frames = 0;
  double largest_step = 0;         ///< to which coordinates are rounded [d]
  std::vector<std::string> notes;  ///< what was left out, one line each
};

/// `experiments` in the order of the report, `scale` as in a figure. Where all chosen checkpoints
/// would not fit the budget each run shows fewer, evenly over its length, the first and the last
/// among them; where not even the last ones fit, the last runs are left out. The same store gives
/// the same value.
Packings collect_packings(const Store& store, const std::vector<std::string>& experiments,
                          const std::optional<std::string>& scale, const PackingChoice& choice,
                          std::size_t workers,
                          const std::function<void(std::size_t, std::size_t)>& report);

/// `count` of 0 .. size - 1, evenly, the first and the last among them (the last one alone for 1).
std::vector<std::size_t> evenly(std::size_t size, std::size_t count);

}  // namespace shearcell
