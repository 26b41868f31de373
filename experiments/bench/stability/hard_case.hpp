// SPDX-License-Identifier: GPL-3.0-or-later
// Cases at and beyond the limits of what the engine can compute. Each has a right answer that is
// known without the engine, or must be stopped or refused with the numbers that say why.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace shearcell::stability {

struct Outcome {
  bool as_expected = false;
  std::string text;  ///< the result, with its numbers
};

struct HardCase {
  std::string name;
  std::string done;      ///< what is computed
  std::string expected;  ///< the right answer, or the check that stops it
  /// With `quick` a case of very many steps takes fewer. An exception counts as not as expected.
  std::function<Outcome(bool quick)> run;
};

using Cases = std::vector<HardCase>;

Cases time_step_cases();
Cases load_cases();
Cases motion_cases();
Cases crystal_cases();

/// All of them. `shearcell bench stability` and the tests `stability.*` run this table.
const Cases& hard_cases();

}  // namespace shearcell::stability
