// SPDX-License-Identifier: GPL-3.0-or-later
// The map of hard cases: each computed in a process of its own, so that a crash or a hang of one is
// an outcome like any other.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/bench/stability/hard_case.hpp"

namespace shearcell {

struct StabilityOptions {
  bool quick = false;             ///< fewer steps where there are very many
  std::vector<std::string> only;  ///< names of cases or their beginnings; all where it is empty
  double seconds_per_case = 300;  ///< a case that takes longer is taken for one that hangs
  std::function<void(const std::string&)> report;  ///< what is being done now; may be empty
};

struct StabilityResult {
  std::string name, done, expected;
  std::string outcome;  ///< in words, with the numbers
  bool as_expected = false;
  double seconds = 0;
};

/// Why no case is named so or begins so, with the nearest name; empty where one does.
std::string unknown_case(const std::string& name);

/// Computes the cases one after the other. Throws std::invalid_argument for an unknown name, and
/// std::system_error when no process can be started.
std::vector<StabilityResult> map_stability(const StabilityOptions& options);

/// One case in a process of its own, killed after `seconds`.
StabilityResult map_case(const stability::HardCase& hard, bool quick, double seconds);

}  // namespace shearcell
