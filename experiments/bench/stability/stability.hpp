// SPDX-License-Identifier: GPL-3.0-or-later
// Cases at and beyond the limits of the engine. Each has a right answer that is known without the
// engine, or must be stopped or refused with the numbers that say why. Each runs in a process of
// its own, so that a crash or a hang is reported as its outcome.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace shearcell::stability {

struct Answer {
  bool as_expected = false;
  std::string text;  ///< the result, with its numbers
};

struct HardCase {
  std::string name;
  std::string done;             ///< what is computed
  std::string expected;         ///< the right answer, or the check that stops it
  std::function<Answer()> run;  ///< an exception counts as not as expected
};

using Cases = std::vector<HardCase>;

void add_time_step_cases(Cases& cases);
void add_load_cases(Cases& cases, bool quick);
void add_motion_cases(Cases& cases);
void add_crystal_cases(Cases& cases, bool quick);

/// All of them; with `quick` those of very many steps take fewer. `shearcell bench stability` and
/// the tests `stability.*` run this table.
Cases hard_cases(bool quick);

struct Options {
  bool quick = false;             ///< fewer steps in the very long cases
  std::vector<std::string> only;  ///< names of cases or their beginnings; all if empty
  double seconds_per_case = 300;  ///< a case that takes longer counts as hanging
  std::function<void(const std::string&)> report;  ///< progress messages
};

struct Result {
  HardCase hard;
  Answer outcome;
  double seconds = 0;
};

/// Error message with the nearest name if no case has a name that begins so; empty otherwise.
std::string unknown_case(const std::string& name);

/// Throws std::system_error if no process can be started.
std::vector<Result> map_stability(const Options& options);

/// The outcome of one case in a process of its own, which is killed after `seconds`.
Answer compute_apart(const HardCase& hard, double seconds);

}  // namespace shearcell::stability
