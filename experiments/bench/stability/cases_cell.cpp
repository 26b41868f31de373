// SPDX-License-Identifier: GPL-3.0-or-later
// Very few grains, and cells so shallow that a grain meets itself.
#include <fmt/format.h>

#include <cstring>
#include <stdexcept>

#include "core/filling.hpp"
#include "experiments/bench/stability/oracle.hpp"
#include "experiments/bench/stability/scenes.hpp"

namespace shearcell::stability {
namespace {

bool same_bits(const State& a, const State& b) {
  const auto bytes = sizeof(double) * static_cast<std::size_t>(a.position.size());
  return std::memcmp(a.position.data(), b.position.data(), bytes) == 0 &&
         std::memcmp(a.velocity.data(), b.velocity.data(), bytes) == 0 &&
         a.wall_height == b.wall_height;
}

// Sheared under all loads of Table I, on every kernel, with more threads than grains.
Outcome few_grains(int count) {
  const Drive drive{0.0833, 2000, 0};
  Packing row = row_between_walls(count, table_1());
  row.cell.top = 1.6;  // falls and is caught
  State right = row.state;
  advance_all_pairs(row.cell, row.scene, drive, 2000, right);
  Simulation simulation(row.cell, row.scene, row.state);
  simulation.advance(drive, 400);
  const State early = simulation.state();
  simulation.advance(drive, 1600);
  bool same = true;
  for (const Simd simd : {Simd::scalar, Simd::avx2, Simd::avx512}) {
    EngineSettings settings;
    settings.kernels = find_kernels(simd);
    settings.threads = 4;
    if (settings.kernels == nullptr) continue;
    Simulation other(row.cell, row.scene, row.state, settings);
    other.advance(drive, 400);
    same = same && same_bits(other.state(), early);
  }
  return all_of({expect_at_most("moved otherwise than by all pairs by",
                                largest_difference(simulation.state(), right), 1e-9),
                 {same, same ? "every kernel and four threads alike" : "kernels differ"}});
}

// A ring of grains through the seam, with hardly room for its list.
Outcome ring(double depth) {
  const Cell cell = smooth_cell(4, 4, depth);
  std::vector<Eigen::Vector3d> positions;
  for (int i = 0; i < 3; ++i) positions.emplace_back(2 + 0.1 * i, 2, depth / 3 * i);
  const State start = at_rest(cell, positions);
  const Scene scene = only_springs();
  Simulation simulation(cell, scene, start);
  State right = start;
  simulation.advance(Drive{}, 500);
  advance_all_pairs(cell, scene, Drive{}, 500, right);
  return all_of(
      {expect_at_most("moved otherwise than by all pairs by",
                      largest_difference(simulation.state(), right), 1e-10),
       expect_near("momentum along z", simulation.state().velocity.row(2).sum(), 0, 1e-9)});
}

// `grains` along the depth; at one diameter and below each touches its own image.
Outcome shallow(double depth, int grains) {
  const Cell cell = smooth_cell(4, 4, depth);
  std::vector<Eigen::Vector3d> positions;
  for (int i = 0; i < grains; ++i) positions.emplace_back(2, 2, depth / grains * i);
  try {
    Simulation simulation(cell, table_1(), at_rest(cell, positions));
  } catch (const std::invalid_argument& reason) {
    const std::string text = reason.what();
    return {text.find("depth") != std::string::npos, "refused: " + text};
  }
  return {false, fmt::format("a cell {} d deep was taken", depth)};
}

Outcome no_cell(std::size_t grains) {
  Geometry geometry;
  geometry.grains = grains;
  try {
    make_cell(geometry, 1);
  } catch (const GeometryError& reason) {
    const std::string text = reason.what();
    return {text.find("more grains") != std::string::npos, "refused: " + text};
  }
  return {false, fmt::format("a cell for {} grains was made", grains)};
}

}  // namespace

Cases cell_cases() {
  Cases cases;
  for (const int count : {1, 2, 3}) {
    cases.push_back(
        {fmt::format("grains-{}", count),
         fmt::format("{} grain{} sheared under all loads", count, count == 1 ? "" : "s"),
         "as by the sum over all pairs and images, the same bits on every kernel",
         [count](bool) { return few_grains(count); }});
  }
  cases.push_back({"grains-1-manifest", "a cell as manifests make it, for 1, 3 and 40 grains",
                   "refused: less than 3 d deep", [](bool) {
                     return all_of({no_cell(1), no_cell(3), no_cell(40)});
                   }});
  cases.push_back({"depth-2.9", "a ring of three grains in a cell 2.9 d deep",
                   "as by the sum over all pairs and images", [](bool) { return ring(2.9); }});
  for (const double depth : {2.0, 1.5, 1.0}) {
    const int grains = depth < 2 ? 1 : 2;
    cases.push_back({fmt::format("depth-{:g}", depth), fmt::format("a cell {:g} d deep", depth),
                     "refused: a grain would meet a neighbour, or itself, through both seams",
                     [=](bool) { return shallow(depth, grains); }});
  }
  cases.push_back({"own-image", "a grain in contact with its own image, 0.95 d deep",
                   "refused: a grain would meet itself", [](bool) { return shallow(0.95, 1); }});
  return cases;
}

}  // namespace shearcell::stability
