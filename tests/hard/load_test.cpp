// SPDX-License-Identifier: GPL-3.0-or-later
// Stiffness, pressure, drag and weight from zero to far beyond those of Table I.
#include <fmt/format.h>

#include <cmath>

#include "core/diagnostics.hpp"
#include "tests/hard/hard.hpp"

namespace shearcell::test {
namespace {

// In a unit of time that is s times smaller every rate is s times larger along the same paths.
Packing faster(Packing packing, double s) {
  Scene& scene = packing.scene;
  scene.stiffness *= s * s;
  scene.gravity *= s * s;
  scene.pressure *= s * s;
  scene.drag_rate *= s;
  scene.wall_drag *= s;
  scene.time_step /= s;
  packing.state.velocity *= s;
  packing.state.wall_velocity *= s;
  return packing;
}

Answer similar(double ratio) {
  const Drive drive{0.0833, 2000, 0};
  const auto after = [&](double s, std::uint64_t steps) {
    return advanced(faster(settled(), s), steps, drive);
  };
  // Powers of four scale every number by a power of two, which is exact.
  const double power = std::exp2(std::round(std::log2(ratio) / 2));
  const double exact = largest_difference(after(power, 2000), after(1, 2000));
  const double near = largest_difference(after(std::sqrt(ratio), 300), after(1, 300));
  return all_of(
      {expect_at_most(fmt::format("difference after a cycle at {:g} k0", power * power), exact, 0),
       expect_at_most(fmt::format("after 300 steps at {:g} k0", ratio), near, 1e-9)});
}

// Grains side by side between two walls carry P A and their weight.
Answer balance(double ratio) {
  Scene scene = table_1();
  scene.stiffness *= ratio;
  scene.time_step /= std::sqrt(ratio);
  const Packing row = row_between_walls(3, scene);
  const State end =
      advanced(row, static_cast<std::uint64_t>((in_full() ? 1.5 : 0.6) / scene.time_step));
  const double load = scene.pressure * row.cell.width * row.cell.depth / 3;
  const double below = load / scene.stiffness, above = (load - scene.gravity) / scene.stiffness;
  const double tolerance = in_full() ? 1e-8 : 1e-6;
  return all_of(
      {expect_near("overlap below / (P A / 3 k)",
                   (0.5 - (end.position(1, 1) - end.wall_height)) / below, 1, tolerance),
       expect_near("above", (0.5 - (row.cell.top - end.position(1, 1))) / above, 1, tolerance)});
}

// The time step of Table I is 0.355 of 2/sqrt(8 k/m), so it allows at most 7.95 k0.
Answer fixed_step(double ratio) {
  Packing packing = settled();
  packing.scene.stiffness *= ratio;
  if (ratio > 8) return expect_stop(packing, 20000, "time step");
  const State end = advanced(packing, 60000);
  return all_of({expect_balance(packing, end, 1e-6),
                 expect_at_most("kinetic energy per grain", kinetic_energy(end), 1e-12)});
}

// Without pressure the wall sinks under the grains' weight, at the speed that the drags allow.
Answer no_pressure() {
  Scene scene = table_1();
  scene.pressure = 0;
  const Packing row = row_between_walls(3, scene);
  const State end = advanced(row, 40000);
  const double area = row.cell.width * row.cell.depth;
  const double speed = -3 * scene.gravity / (scene.wall_drag * area + 3 * scene.drag_rate);
  return all_of({expect_near("speed of the wall", end.wall_velocity, speed, 1e-9),
                 expect_near("of a grain", end.velocity(1, 2), speed, 1e-9)});
}

// One grain between two walls, at the pressure that makes this overlap.
Answer pressed_grain(double overlap) {
  Packing row = row_between_walls(1, table_1());
  row.scene.gravity = 0;
  row.scene.pressure = overlap * row.scene.stiffness / (row.cell.width * row.cell.depth);
  row.scene.wall_drag = 2e4;  // slow, so that the wall does not overshoot
  if (overlap > 0.1) return expect_stop(row, 200000, "overlap");
  const State end = advanced(row, 200000);
  return expect_near("overlap", 0.5 - (end.position(1, 0) - end.wall_height), overlap,
                     1e-9 * overlap + 1e-14);
}

Answer pressed_packing(double ratio) {
  Packing packing = settled();
  packing.scene.pressure *= ratio;
  if (ratio < 1) packing.scene.gravity = 0;  // the wall could not carry the weight
  if (ratio > 5) return expect_stop(packing, 60000, "overlap");
  const State end = advanced(packing, 60000);
  const Diagnostics facts =
      diagnose(packing.cell, packing.scene, end, wall_pose(packing.cell, 0, end.wall_height));
  return all_of({expect_balance(packing, end, 1e-5),
                 expect_at_most("largest overlap", facts.largest_overlap, 0.1)});
}

// Ten thousand times the drag of Table I, b dt/2m = 14: free fall at g m/b, and a contact that
// opens as exp(-2 k t / b).
Answer much_drag() {
  constexpr double overlap = 0.05;
  Scene scene = only_springs();
  scene.drag_rate = 64e4;
  const State pair = advanced(placed(scene, {{20, 20, 20}, {21 - overlap, 20, 20}}), 200);
  // Starting from rest half a step earlier, the velocity overshoots once in each direction, which
  // shifts the time by (b dt/2m - 1) / (b dt/m) of a step. Inertia adds 2 k m / b^2 = 1.6e-4.
  const double step = scene.drag_rate * scene.time_step;
  const double time = (200 + (0.5 * step - 1) / step) * scene.time_step;
  const double right = overlap * std::exp(-2 * scene.stiffness / scene.drag_rate * time);
  scene.gravity = table_1().gravity;
  const State fall = advanced(placed(scene, {{20, 20, 20}}), 1000);
  const double left = 1 - (pair.position(0, 1) - pair.position(0, 0));
  return all_of(
      {expect_near("overlap", left, right, 3e-4 * right),
       expect_near("falls at", -fall.velocity(1, 0), scene.gravity / scene.drag_rate, 1e-12)});
}

Scene heavy(double ratio) {
  Scene scene = only_springs();
  scene.gravity = ratio * table_1().gravity;
  scene.drag_rate = 640;
  return scene;
}

Answer heavy_grain(double ratio) {
  const Scene scene = heavy(ratio);
  const State end = advanced(placed(scene, {{2, 0.5, 2}}, {4, 4, 4}), 20000);
  return expect_near("overlap with the wall", 0.5 - end.position(1, 0),
                     scene.gravity / scene.stiffness, 1e-12);
}

// Twelve grains stacked in a shaft: the lowest would carry 1200 m g, an overlap of 0.12.
Answer heavy_stack() {
  std::vector<V> positions;
  for (int i = 0; i < 12; ++i) positions.emplace_back(2, 0.5 + i, 2);
  return expect_stop(placed(heavy(100), positions, {4, 14, 4}), 40000, "overlap");
}

Answer no_gravity() {
  Packing packing = settled();
  packing.scene.gravity = 0;
  return expect_balance(packing, advanced(packing, 100000), 1e-5);
}

Answer light_wall() {
  Packing packing = settled();
  packing.scene.wall_mass = 0.01;
  return expect_stop(packing, 20000, "time step");
}

Cases load_cases() {
  Cases cases;
  const std::string overlap_stop = "stopped: the overlap over its limit";
  const std::string balanced = "all forces in balance";
  for (const double ratio : {1.0, 10.0, 100.0, 1e3, 1e4}) {
    add_each(cases, {ratio}, "k-{:g}-similar", "{:g} k0, dt and all loads scaled alike",
             "the same paths, scaled; equal to the last bit for a power of four", similar);
    add_each(cases, {ratio}, "k-{:g}-scaled-dt",
             "{:g} k0 with dt ~ 1/sqrt(k) under the loads of Table I",
             "overlaps P A / 3 k below and that less m g / k above", balance);
  }
  const std::string fixed_dt = "{:g} k0 at the time step of Table I";
  add_each(cases, {1.0, 4.0}, "k-{:g}-fixed-dt", fixed_dt, "at rest with " + balanced, fixed_step);
  add_each(cases, {10.0, 100.0, 1e3, 1e4}, "k-{:g}-fixed-dt", fixed_dt,
           "stopped: the time step over its limit", fixed_step);
  add(cases, "pressure-0", "three grains on the moving wall, P = 0",
      "all sink at 3 m g / (B A + 3 b)", no_pressure);
  const std::string grain = "a grain under P = {:g} k d / A";
  add_each(cases, {1e-6, 1e-3, 0.05, 0.099}, "pressure-overlap-{:g}", grain, "that overlap",
           pressed_grain);
  add_each(cases, {0.101, 0.3}, "pressure-overlap-{:g}", grain, overlap_stop, pressed_grain);
  const std::string packing = "a packing under {:g} times the pressure of Table I";
  add_each(cases, {0.01, 3.0}, "pressure-packing-{:g}", packing, balanced, pressed_packing);
  add_each(cases, {10.0, 100.0}, "pressure-packing-{:g}", packing, overlap_stop, pressed_packing);
  add(cases, "drag-1e4", "ten thousand times the drag of Table I",
      "creep and fall at the speeds that b allows", much_drag);
  add(cases, "gravity-0", "a packing whose weight is removed", balanced, no_gravity);
  add(cases, "gravity-100g", "a grain of 100 times its weight on a wall", "overlap m g / k", [] {
    return all_of({heavy_grain(1), heavy_grain(100)});
  });
  add(cases, "gravity-100g-stack", "twelve grains of 100 times their weight in a stack",
      overlap_stop, heavy_stack);
  add(cases, "light-wall", "a moving wall of 0.01 m per d^2",
      "stopped: the time step over the limit of the wall", light_wall);
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Load, Hard, testing::ValuesIn(load_cases()), test_name);

}  // namespace
}  // namespace shearcell::test
