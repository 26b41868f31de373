// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/hard/hard.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string_view>

#include "core/minimizer.hpp"
#include "experiments/manifest/conversion.hpp"
#include "tests/support/all_pairs.hpp"

namespace shearcell::test {

TEST_P(Hard, EndsAsExpected) {
  const HardCase& hard = GetParam();
  // table.sh reads these lines.
  std::printf("case: %s\ncomputed: %s\nexpected: %s\n", hard.name.c_str(), hard.done.c_str(),
              hard.expected.c_str());
  std::fflush(stdout);
  Answer answer;
  try {
    answer = hard.run();
  } catch (const std::exception& error) {
    answer = {false, std::string("threw: ") + error.what()};
  }
  std::printf("came: %s\n", answer.text.c_str());
  EXPECT_TRUE(answer.as_expected) << hard.name << ", " << hard.done
                                  << "\nexpected: " << hard.expected << "\ncame: " << answer.text;
}

void PrintTo(const HardCase& hard, std::ostream* out) {
  *out << hard.name;
}

std::string test_name(const testing::TestParamInfo<HardCase>& hard) {
  std::string name = hard.param.name;
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return name;
}

bool in_full() {
  const char* set = std::getenv("SHEARCELL_HARD");
  return set != nullptr && std::string_view(set) == "full";
}

Scene table_1() {
  Parameters parameters;
  parameters.pressure_at = PressureAt::moving_wall;  // the closed forms have P A_w as the load
  return shear_scene(parameters);
}

Scene only_springs() {
  Scene scene = table_1();
  scene.drag_rate = scene.gravity = scene.pressure = 0;
  scene.wall_mass = 1e30;
  return scene;
}

State advanced(const Packing& packing, std::uint64_t steps, const Drive& drive) {
  Simulation simulation = simulate(packing);
  simulation.advance(drive, steps);
  return simulation.state();
}

Packing settled() {
  static const Packing packing = [] {
    Parameters parameters;
    parameters.grains = 60;
    parameters.pressure_at = PressureAt::moving_wall;
    Packing made = settled_packing(parameters, 1);
    made.state = advanced(made, 20000);  // closer to rest than settling requires
    made.state.step = 0;
    return made;
  }();
  return packing;
}

Packing crystal(int layers, double overlap, int along, bool vacancy) {
  const double spacing = 1 - overlap, rise = spacing / std::numbers::sqrt2, end = 0.5 - overlap;
  std::vector<V> positions;
  for (int layer = 0; layer < layers; ++layer) {
    const int shift = layer % 2;  // every other layer sits in the hollows of its neighbours
    for (int column = 0; column < along - shift; ++column) {
      for (int k = 0; k < along; ++k) {
        positions.emplace_back(end + spacing * (column + 0.5 * shift), end + rise * layer,
                               spacing * (k + 0.5 * shift));
      }
    }
  }
  const V size(2 * end + spacing * (along - 1), 2 * end + rise * (layers - 1), spacing * along);
  if (vacancy) {
    positions.erase(
        std::ranges::min_element(positions, {}, [&](const V& p) { return (p - size / 2).norm(); }));
  }
  Packing made = placed(only_springs(), positions, size);
  // Each grain of the lowest layer is pressed onto the wall with k times the overlap.
  made.scene.pressure = made.scene.stiffness * overlap / (spacing * spacing);
  made.scene.wall_mass = 10;
  Simulation simulation = simulate(made);
  minimize_enthalpy(simulation, {.force_tolerance = 1e-9});
  made.state = simulation.state();
  made.state.step = 0;
  return made;
}

Packing in_fluid(Packing packing) {
  packing.scene.drag_rate = table_1().drag_rate;
  packing.scene.wall_drag = table_1().wall_drag;
  return packing;
}

void disturb(State& state, const V& speed) {
  for (Eigen::Index i = 0; i < state.velocity.size(); ++i) {
    state.velocity.data()[i] = speed(i % 3) * std::sin(7.0 * static_cast<double>(i * i));
  }
  state.velocity.row(2).array() -= state.velocity.row(2).mean();
}

Packing row_between_walls(int count, const Scene& scene) {
  std::vector<V> positions;
  for (int i = 0; i < count; ++i) positions.emplace_back(0.7 + 1.2 * i, 0.5, 1.5);
  return placed(scene, positions, {4, 1, 3});
}

double kinetic_energy(const State& state) {
  return 0.5 * state.velocity.squaredNorm() / static_cast<double>(state.velocity.cols());
}

double largest_difference(const State& a, const State& b) {
  return std::max(farthest(a, b), std::fabs(a.wall_height - b.wall_height));
}

Answer expect_stop(const Packing& packing, std::uint64_t steps, const std::string& quantity) {
  Simulation simulation = simulate(packing);
  try {
    simulation.advance(Drive{}, steps);
  } catch (const NumericalFailure& failure) {
    return {failure.quantity.find(quantity) != std::string::npos,
            fmt::format("stopped at step {}: {} is {:.4g}, limit {:.4g}", failure.step,
                        failure.quantity, failure.value, failure.limit)};
  }
  return {false, fmt::format("not stopped in {} steps; kinetic energy per grain {:.3g}", steps,
                             kinetic_energy(simulation.state()))};
}

Answer expect_near(const std::string& what, double got, double right, double tolerance) {
  const double off = std::fabs(got - right);
  return {off <= tolerance, fmt::format("{} {:.9g}, right {:.9g}, off by {:.2g} (of {:.2g})", what,
                                        got, right, off, tolerance)};
}

Answer expect_at_most(const std::string& what, double got, double most) {
  return {got <= most, fmt::format("{} {:.2g} (at most {:.2g})", what, got, most)};
}

Answer expect_as_all_pairs(const Packing& packing, const State& end, const Drive& drive) {
  State right = packing.state;
  while (right.step < end.step) step_over_all_pairs(packing.cell, packing.scene, drive, right);
  const double off = largest_difference(end, right);
  if (off == 0) return {true, "the bits of the sum over all pairs"};
  return {false, fmt::format("{:.2g} d from the sum over all pairs", off)};
}

Answer expect_balance(const Packing& packing, const State& state, double most) {
  return expect_at_most("largest net force / P d^2",
                        force_residual(packing.cell, packing.scene, state), most);
}

Answer all_of(const std::vector<Answer>& parts) {
  Answer whole{true, ""};
  std::string last;
  for (const Answer& part : parts) {
    whole.as_expected = whole.as_expected && part.as_expected;
    if (part.text != last) whole.text += (last.empty() ? "" : "; ") + part.text;
    last = part.text;
  }
  return whole;
}

}  // namespace shearcell::test
