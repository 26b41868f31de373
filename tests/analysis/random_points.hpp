// SPDX-License-Identifier: GPL-3.0-or-later
// Random grains in random cells, for properties (tests/property.hpp).
#pragma once

#include <cmath>
#include <set>
#include <tuple>

#include "analysis/voronoi.hpp"
#include "tests/analysis/packings.hpp"
#include "tests/property.hpp"

namespace shearcell::test {

/// Moves the grains to a lattice of a quarter d, where many sites share a sphere.
inline void snap(Packing& p) {
  p.grains = (4 * p.grains).array().round() / 4;
}

/// Leaves out grains that were pushed through a wall, and all but the first at one place.
inline void drop_unfit(Packing& p) {
  std::set<std::tuple<double, double, double>> taken;
  Eigen::Index kept = 0;
  for (Eigen::Index i = 0; i < p.grains.cols(); ++i) {
    const Eigen::Vector3d at = p.grains.col(i);
    const double wrapped = at.z() - p.cell.depth * std::floor(at.z() / p.cell.depth);
    const bool inside = wall_distances(p.cell, p.pose, at).minCoeff() > 0.01;
    if (inside && taken.emplace(at.x(), at.y(), wrapped).second) p.grains.col(kept++) = at;
  }
  p.grains.conservativeResize(Eigen::NoChange, kept);
}

/// Up to 200 grains, some of them overlapping, in a smooth or rough, upright or tilted cell.
inline Packing any_points() {
  const auto quarters = [](const char* name, int low, int high) {
    return *rc::gen::inRange(low, high).as(std::string("4 ") + name) / 4.0;
  };
  const double width = quarters("width", 8, 32), height = quarters("height", 8, 48),
               depth = quarters("depth", 6, 32);
  const bool on_lattice = *rc::gen::inRange(0, 3).as("on a lattice if 2") == 2;
  const double theta = on_lattice ? 0 : *rc::gen::inRange(-30, 31).as("100 theta") / 100.0;
  const auto seed = *rc::gen::inRange<std::uint64_t>(0, 100000).as("seed");
  Packing p = empty_cell(width, height, depth, theta);
  if (*rc::gen::arbitrary<bool>().as("rough")) roughen(p, seed + 1);
  const int grains = *rc::gen::inRange(1, 200).as("grains");
  fill(p, grains, on_lattice ? 0 : *rc::gen::inRange(0, 10).as("steps apart"), seed);
  if (on_lattice) snap(p);
  drop_unfit(p);
  RC_PRE(p.grains.cols() > 0);
  return p;
}

}  // namespace shearcell::test
