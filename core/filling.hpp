// SPDX-License-Identifier: GPL-3.0-or-later
// The initial cell of a run and its loose grains. Both depend only on the seed, the number of
// grains and the geometry.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <stdexcept>

#include "core/cell.hpp"
#include "core/state.hpp"

namespace shearcell {

/// Thrown if a cell is too small or too large for its grains. The message says what to change.
class GeometryError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Geometry {
  std::size_t grains = 0;
  double height_over_width = 1.675;        ///< aspect ratio of the settled cell (supplement E)
  double nominal_packing_fraction = 0.64;  ///< determines the width of the cell
  double fill_packing_fraction = 0.28;     ///< packing fraction of the loose initial grains
  WallTexture walls = WallTexture::rough;
  double wall_grain_area_fraction = 0.52;  ///< target area fraction of wall grains on a rough wall
  double wall_grain_recess = 0.25;         ///< largest depth of centres behind a wall plane [d]
  std::uint32_t wall_grain_draw = 0;       ///< each value gives different wall grains
  MovingWall moving = MovingWall::bottom;
};

/// Width L [d] of a cell that holds the grains at nominal_packing_fraction. The depth is also L,
/// and the height is height_over_width * L. A layer of 0.175 d at each rough wall holds no grains.
double cell_width(const Geometry& geometry);

/// Callback, called about once per millisecond while grains are placed. It may throw to stop.
using Poll = std::function<void()>;

/// Distance [d] between the bottom and the top plane when the loose grains are placed.
double fill_height(const Geometry& geometry);

/// Expected number of wall grains; 0 for smooth walls.
double wall_grain_count(const Geometry& geometry);

/// Whether the cell is too large for its grains: if the width or height exceeds kLongestCell, if
/// V / (N + 100) exceeds half of kLoosestCell (half, because the moving wall may move outwards), or
/// if there are more than 10^4 + 1000 N wall grains (each may need 6000 attempts).
bool too_large(const Geometry& geometry);

/// Makes a cell of height fill_height(). The wall grains of rough walls are placed by random
/// sequential addition. Throws GeometryError.
Cell make_cell(const Geometry& geometry, std::uint64_t seed, const Poll& poll = {});

/// Places grains at rest at random positions where they touch no other grain and no wall. Throws
/// GeometryError if not all grains can be placed.
State fill_cell(const Cell& cell, const Geometry& geometry, std::uint64_t seed,
                const Poll& poll = {});

/// Displaces each grain along x, y and z by independent normal noise of standard deviation `noise`
/// [d]. The noise of a grain depends only on the seed and the grain's index.
void add_noise(State& state, double noise, std::uint64_t seed);

}  // namespace shearcell
