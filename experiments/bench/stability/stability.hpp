// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the hard cases, each in a process of its own, so that a crash or a hang is reported as its
// outcome.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/bench/stability/hard_case.hpp"

namespace shearcell {

struct StabilityOptions {
  bool quick = false;             ///< fewer steps in the very long cases
  std::vector<std::string> only;  ///< names of cases or their beginnings; all if empty
  double seconds_per_case = 300;  ///< a case that takes longer counts as hanging
  std::function<void(const std::string&)> report;  ///< progress messages; may be empty
};

struct StabilityResult {
  std::string name, done, expected;
  std::string outcome;  ///< with the numbers
  bool as_expected = false;
  double seconds = 0;
};

/// Error message with the nearest name if no case has a name that begins so; empty otherwise.
std::string unknown_case(const std::string& name);

/// Throws std::invalid_argument for an unknown name and std::system_error if no process can be
/// started.
std::vector<StabilityResult> map_stability(const StabilityOptions& options);

/// One case in a process of its own, which is killed after `seconds`.
StabilityResult map_case(const stability::HardCase& hard, bool quick, double seconds);

}  // namespace shearcell
