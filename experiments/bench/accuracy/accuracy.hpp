// SPDX-License-Identifier: GPL-3.0-or-later
// Error against cost: what `bench accuracy` measures, as tables with a figure each.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "experiments/bench/facts.hpp"

namespace shearcell::accuracy {

struct Options {
  bool quick = false;    ///< seconds instead of minutes: the same tables from fewer runs
  std::size_t jobs = 1;  ///< runs computed at once
  std::function<void(const std::string&)> report;  ///< progress messages
};

struct Section {
  std::string title;
  std::string name;  ///< of its files
  Chart chart;
  std::vector<bench::Facts> results = {};
  std::vector<bench::Facts> summary = {};  ///< printed instead of the results
};

/// All sections, with the grains of Table I. Only the times depend on the machine.
std::vector<Section> measure_accuracy(const Options& options);

}  // namespace shearcell::accuracy
