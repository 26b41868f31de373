// SPDX-License-Identifier: GPL-3.0-or-later
// Cases at and beyond the edge of what the engine can compute. Each has a right answer that is
// known without it, or must be stopped or refused with the numbers that say why.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace shearcell::stability {

struct Outcome {
  bool as_expected = false;
  std::string text;  ///< what came out, with its numbers
};

struct HardCase {
  std::string name;
  std::string done;      ///< what is done
  std::string expected;  ///< the right answer, or by what it is stopped
  /// With `quick` a case of very many steps takes fewer of them. What it throws is not as expected.
  std::function<Outcome(bool quick)> run;
};

using Cases = std::vector<HardCase>;

Cases stability_limit_cases();
Cases time_step_cases();
Cases stiffness_cases();
Cases load_cases();
Cases drive_cases();
Cases placement_cases();
Cases cell_cases();
Cases crystal_cases();
Cases long_cases();

/// All of them, in the order in which they are told.
const Cases& hard_cases();

}  // namespace shearcell::stability
