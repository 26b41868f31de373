// SPDX-License-Identifier: GPL-3.0-or-later
// Hard cases: at and beyond the limits of the engine. Each has a right answer that is known without
// the engine, or must be stopped or refused with the numbers that say why. ctest runs each case in
// a process of its own with a time limit, so a crash or a hang is an outcome as well.
// table.sh makes the tables of core/STABILITY.md and outcomes.csv from what the cases print.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "tests/support/packing.hpp"

namespace shearcell::test {

using bench::simulate;
using V = Eigen::Vector3d;

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

void PrintTo(const HardCase& hard, std::ostream* out);

/// Each file of cases instantiates it with its own.
class Hard : public testing::TestWithParam<HardCase> {};

/// The case's name with '_' for what a test's name cannot hold.
std::string test_name(const testing::TestParamInfo<HardCase>& hard);

/// The state after `steps`. Throws NumericalFailure.
State advanced(const Packing& packing, std::uint64_t steps, const Drive& drive = {});

/// Whether the very long cases take all of their steps: if SHEARCELL_HARD is "full", as in
/// table.sh.
bool in_full();

/// Table I of the supplement, in units of d, m and s.
Scene table_1();

/// Contacts only: no drag, gravity or pressure, and a moving wall too heavy to move.
Scene only_springs();

/// 60 grains between rough walls, settled under Table I.
Packing settled();

/// An FCC crystal of `layers` (odd) square layers of `along` by `along` grains, every other layer
/// with one row less, between smooth walls. It is at its minimum of energy under a pressure that
/// makes overlaps of about `overlap` [d], without gravity or drag. `vacancy` leaves out the grain
/// nearest the middle.
Packing crystal(int layers, double overlap, int along = 5, bool vacancy = false);

/// With the drags of Table I on grains and wall.
Packing in_fluid(Packing packing);

/// Irregular velocities up to `speed` along x, y and z, with no momentum along z, because no wall
/// stops a motion along z.
void disturb(State& state, const V& speed);

/// `count` grains side by side, apart, each touching the bottom and the top wall.
Packing row_between_walls(int count, const Scene& scene);

/// Largest distance [d] between the positions of a grain, or of the moving wall, in two states.
double largest_difference(const State& a, const State& b);

/// Mean kinetic energy of a grain [m d^2/s^2], at the half step.
double kinetic_energy(const State& state);

/// Expects the watchdog to stop the run within `steps`, for a quantity with this in its name.
Answer expect_stop(const Packing& packing, std::uint64_t steps, const std::string& quantity);

/// Expects |got - right| <= tolerance, or got <= most.
Answer expect_near(const std::string& what, double got, double right, double tolerance);
Answer expect_at_most(const std::string& what, double got, double most);

/// Expects the run to end with the positions of step_over_all_pairs(), to the last bit.
Answer expect_as_all_pairs(const Packing& packing, const State& end, const Drive& drive);

/// Expects no net force over `most` P d^2 on any grain.
Answer expect_balance(const Packing& packing, const State& state, double most);

/// As expected if all parts are as expected. Equal results in a row are printed once.
Answer all_of(const std::vector<Answer>& parts);

/// Adds one case.
inline void add(Cases& cases, const std::string& name, const std::string& done,
                const std::string& expected, std::function<Answer()> run) {
  cases.push_back({name, done, expected, std::move(run)});
}

/// Adds a case for each value, which appears in its name and description.
template <class Value>
void add_each(Cases& cases, const std::vector<Value>& values, const std::string& name,
              const std::string& done, const std::string& expected, Answer (*compute)(Value)) {
  for (const Value value : values) {
    cases.push_back({fmt::format(fmt::runtime(name), value), fmt::format(fmt::runtime(done), value),
                     expected, [compute, value] { return compute(value); }});
  }
}

}  // namespace shearcell::test
