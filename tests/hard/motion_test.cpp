// SPDX-License-Identifier: GPL-3.0-or-later
// Amplitudes of the shear, unusual placements and impacts, few grains, and cells so shallow that a
// grain could touch itself.
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <stdexcept>

#include "core/filling.hpp"
#include "tests/hard/hard.hpp"

namespace shearcell::test {
namespace {

// A cycle of 2000 steps is 23 times as fast as that of Table I.
Answer shear(double amplitude, std::uint64_t start, Fluid fluid) {
  const Drive drive{amplitude, 2000, 0};
  Packing packing = settled();
  packing.scene.fluid = fluid;
  Simulation simulation = simulate(packing);
  simulation.advance(drive, start);
  packing.state = simulation.state();
  simulation.advance(drive, 200);
  return expect_as_all_pairs(packing, simulation.state(), drive);
}

// A grain held by two inclined walls stays half way between them.
Answer held_grain(double amplitude) {
  constexpr double overlap = 1e-3;
  Scene scene = only_springs();
  scene.drag_rate = 640;
  const Packing packing = placed(scene, {{0.5 - overlap, 1, 2}}, {1 - 2 * overlap, 4, 4});
  const Drive drive{amplitude, 400000, 0};
  const V at = advanced(packing, 100000, drive).position.col(0);
  const double tangent = wall_pose(packing.cell, tilt(drive, 100000).theta, 0).tan_theta;
  return expect_near("displacement", at.x() - (0.5 - overlap), tangent * (at.y() - 4),
                     1e-6 * amplitude);
}

Answer sheared(double amplitude) {
  return all_of({shear(amplitude, 0, Fluid::still), shear(amplitude, 400, Fluid::still),
                 shear(amplitude, 400, Fluid::cell), shear(amplitude, 1400, Fluid::cell),
                 held_grain(amplitude)});
}

Answer two_apart(double apart) {
  return expect_stop(placed(table_1(), {{20, 20, 20}, {20 + apart, 20, 20}}), 1,
                     "the overlap [d] of two grains");
}

bool same_bits(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

Answer stays(const std::vector<V>& positions) {
  const Packing packing = placed(only_springs(), positions);
  const State end = advanced(packing, 5000);
  if (same_bits(end.position, packing.state.position)) return {true, "no bit moved"};
  return {false, fmt::format("moved by {:.2g}", largest_difference(end, packing.state))};
}

Answer on_plane() {
  std::vector<Answer> parts;
  for (const V& place : {V(20, 0, 20), V(0, 20, 20), V(40, 20, 20), V(20, 40, 20)}) {
    parts.push_back(expect_stop(placed(table_1(), {place}), 1, "wall plane"));
  }
  return all_of(parts);
}

Answer corner() {
  Scene scene = only_springs();
  scene.time_step /= 10;
  const V into(0.08, 0.05, 0);
  const V v = advanced(placed(scene, {V(0.5, 0.5, 20) - into}), 1000).velocity.col(0);
  const V right = std::sqrt(scene.stiffness) * into;
  return all_of({expect_near("leaves at", v.x(), right.x(), 2e-3 * right.x()),
                 expect_near("and", v.y(), right.y(), 2e-3 * right.y()),
                 expect_near("along z", v.z(), 0, 0)});
}

// The same collision in the middle of the cell and across the seam, up to two depths away.
Answer seam() {
  const auto collide = [&](double z) {
    Packing packing = placed(only_springs(), {{20, 20, z - 0.53}, {20.1, 20.2, z + 0.53}});
    packing.state.velocity.row(2) << 40, -60;
    return advanced(packing, 100);
  };
  const State right = collide(20);
  std::vector<Answer> parts;
  for (const double z : {0.0, 40.0, -40.0, 80.1}) {
    State state = collide(z);
    state.position.row(2).array() += 20 - z;
    parts.push_back(expect_at_most(fmt::format("difference at z = {:g}", z),
                                   largest_difference(state, right), 1e-11));
  }
  parts.push_back(expect_near("momentum", right.velocity.row(2).sum(), -20, 1e-12));
  return all_of(parts);
}

// The watchdog's check before the first step must see what one step would jump over.
Answer head_on(double diameters_per_step) {
  Packing packing = placed(only_springs(), {{18.9, 20, 20}, {21.1, 20.2, 20.3}});
  const double speed = diameters_per_step / packing.scene.time_step;
  packing.state.velocity.row(0) << speed, -speed;
  if (diameters_per_step > 0.1) return expect_stop(packing, 1, "speed");
  const State end = advanced(packing, 60);
  return all_of(
      {expect_as_all_pairs(packing, end, {}),
       expect_near("momentum / speed", end.velocity.row(0).sum() / speed, 0, 1e-13),
       expect_near("energy kept", kinetic_energy(end) / kinetic_energy(packing.state), 1, 0.05)});
}

Answer flies_into_row() {
  std::vector<V> positions;
  for (int i = 0; i < 8; ++i) positions.emplace_back(20 + i, 20, 20);
  positions.emplace_back(15.05, 20, 20);
  Packing packing = placed(only_springs(), positions);
  const double speed = packing.state.velocity(0, 8) = 0.01 / packing.scene.time_step;
  const State end = advanced(packing, 800);
  return all_of({expect_as_all_pairs(packing, end, {}),
                 expect_at_most("speed of the first grain / before",
                                std::fabs(end.velocity(0, 8)) / speed, 0.5),
                 expect_near("momentum kept", end.velocity.row(0).sum() / speed, 1, 1e-12)});
}

// Sheared under all loads of Table I, on every kernel, with more threads than grains.
Answer few_grains(int count) {
  const Drive drive{0.0833, 2000, 0};
  Packing row = row_between_walls(count, table_1());
  row.cell.top = 1.6;  // falls and is caught
  const State early = advanced(row, 400, drive);
  bool same = true;
  for (const Kernels* kernels : kernels_here()) {
    Simulation other = simulate(row, {kernels, 4, {}, {}});
    other.advance(drive, 400);
    const State state = other.state();
    same = same && same_bits(state.position, early.position) &&
           same_bits(state.velocity, early.velocity) && state.wall_height == early.wall_height;
  }
  return all_of({expect_as_all_pairs(row, advanced(row, 2000, drive), drive),
                 {same, same ? "the same bits on every kernel" : "kernels differ"}});
}

// A ring of grains through the seam, in a cell hardly deeper than the reach of its list.
Answer ring(double depth) {
  std::vector<V> positions;
  for (int i = 0; i < 3; ++i) positions.emplace_back(2 + 0.1 * i, 2, depth / 3 * i);
  const Packing packing = placed(only_springs(), positions, {4, 4, depth});
  const State end = advanced(packing, 500);
  return all_of({expect_as_all_pairs(packing, end, {}),
                 expect_near("momentum along z", end.velocity.row(2).sum(), 0, 1e-9)});
}

template <class Error, class Make>
Answer expect_refusal(const std::string& what, Make&& make) {
  try {
    make();
  } catch (const Error& error) {
    const std::string text = error.what();
    return {text.find(what) != std::string::npos, "refused: " + text};
  }
  return {false, "accepted"};
}

// Grains along the depth; at one diameter and below each touches its own image.
Answer shallow(double depth) {
  std::vector<V> positions = {{2, 2, 0}};
  if (depth >= 2) positions.emplace_back(2, 2, depth / 2);
  return expect_refusal<std::invalid_argument>("depth", [&] {
    simulate(placed(table_1(), positions, {4, 4, depth}));
  });
}

Answer no_cell(std::size_t grains) {
  Geometry geometry;
  geometry.grains = grains;
  return expect_refusal<GeometryError>("more grains", [&] { make_cell(geometry, 1); });
}

Cases motion_cases() {
  Cases cases;
  const std::string as_oracle = "the bits of the sum over all pairs";
  const std::string overlapping = "stopped before the first step: the overlap over its limit";
  add_each(cases, {1e-6, 1e-4, 1e-2, 0.0833, 0.5}, "amplitude-{:g}",
           "a packing sheared by {:g} rad", as_oracle + "; a held grain follows the walls",
           sheared);
  add(cases, "equal-positions", "two grains at the same position", overlapping,
      [] { return two_apart(0); });
  add(cases, "nearly-equal-positions", "two grains 1e-300 and 1e-9 d apart", overlapping, [] {
    return all_of({two_apart(1e-300), two_apart(1e-9)});
  });
  add(cases, "touching", "three grains that touch exactly", "stay", [] {
    return stays({{20, 20, 20}, {21, 20, 20}, {22, 20, 20}});
  });
  add(cases, "touching-seam", "grains that touch exactly across the seam", "stay", [] {
    return stays({{20, 20, 0}, {20, 20, 39}, {20, 20, 38}, {10, 9, 40}, {10, 9, 1}});
  });
  add(cases, "touching-walls", "grains that touch one or two walls exactly", "stay", [] {
    return stays({{0.5, 20, 20}, {20, 0.5, 20}, {0.5, 0.5, 5}, {39.5, 39.5, 9}});
  });
  add(cases, "on-wall-plane", "a grain with its centre on each of the wall planes",
      "stopped before the first step: the overlap with the plane over its limit", on_plane);
  add(cases, "corner", "a grain pressed into a corner and released",
      "leaves at overlap times sqrt(k/m)", corner);
  add(cases, "seam", "an oblique collision across the periodic seam",
      "as in the middle of the cell", seam);
  add(cases, "head-on-1", "two grains approach, each at one diameter per step",
      "stopped before the first step: the speed over its limit", [] { return head_on(1); });
  add(cases, "head-on-0.02", "two grains approach, each at 0.02 diameters per step", as_oracle,
      [] { return head_on(0.02); });
  add(cases, "impact-row", "a grain hits a row of eight", as_oracle, flies_into_row);
  const std::string on_every_kernel = as_oracle + ", the same bits on every kernel";
  add_each(cases, {1}, "grains-{}", "{} grain sheared under all loads", on_every_kernel,
           few_grains);
  add_each(cases, {2, 3}, "grains-{}", "{} grains sheared under all loads", on_every_kernel,
           few_grains);
  add(cases, "grains-1-manifest", "a cell as manifests define it, for 1, 3 and 40 grains",
      "refused: less than 3 d deep", [] {
        return all_of({no_cell(1), no_cell(3), no_cell(40)});
      });
  add_each(cases, {2.9}, "depth-{:g}", "a ring of three grains in a cell {:g} d deep", as_oracle,
           ring);
  add_each(cases, {2.0, 1.5, 1.0}, "depth-{:g}", "a cell {:g} d deep",
           "refused: a grain would meet a neighbour, or itself, through both seams", shallow);
  add_each(cases, {0.95}, "own-image", "a grain in contact with its own image, {:g} d deep",
           "refused: a grain would meet itself", shallow);
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Motion, Hard, testing::ValuesIn(motion_cases()), test_name);

}  // namespace
}  // namespace shearcell::test
