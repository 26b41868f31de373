// SPDX-License-Identifier: GPL-3.0-or-later
// The initial cell and loose grains of a run. They depend on seed, number of grains and geometry
// only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <stdexcept>

#include "core/cell.hpp"
#include "core/state.hpp"

namespace shearcell {

/// The geometry cannot hold the grains; the message says what to change.
class GeometryError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Geometry {
  std::size_t grains = 0;
  double height_over_width = 1.675;        ///< of the settled cell (supplement E)
  double nominal_packing_fraction = 0.64;  ///< sets the width for a given number of grains
  double fill_packing_fraction = 0.28;     ///< of the loose initial grains; sets the fill height
  WallTexture walls = WallTexture::rough;
  double wall_grain_area_fraction = 0.52;  ///< target of the sequential addition
  double wall_grain_recess = 0.25;         ///< largest distance of a centre behind its plane [d]
  std::uint32_t wall_grain_draw = 0;  ///< other values give other wall grains for the same seed
  MovingWall moving = MovingWall::bottom;
};

/// Width L [d] of a cell of height_over_width * L by L by L that holds the grains at the nominal
/// volume fraction. Rough walls take up a layer of 0.175 d each: the volume of their grains.
double cell_width(const Geometry& geometry);

/// Called about every millisecond during a long placement. It may throw to stop the placement.
using Poll = std::function<void()>;

/// Distance [d] between the bottom and the top plane when the loose grains are placed.
double fill_height(const Geometry& geometry);

/// Expected number of wall grains; 0 for smooth walls.
double wall_grain_count(const Geometry& geometry);

/// Whether the cell is too large for its grains. It is if its width or height exceeds kLongestCell,
/// if its volume per grain exceeds half of kLoosestCell (the wall may still move outwards), or if
/// it has more than 10^4 + 1000 N wall grains, each of which may take 6000 attempts to place.
bool too_large(const Geometry& geometry);

/// The cell at its fill height, with its wall grains placed by random sequential addition.
/// Throws GeometryError.
Cell make_cell(const Geometry& geometry, std::uint64_t seed, const Poll& poll = {});

/// Grains at rest at random places, none touching another, a wall grain or a plane.
/// Throws GeometryError when they cannot be placed.
State fill_cell(const Cell& cell, const Geometry& geometry, std::uint64_t seed,
                const Poll& poll = {});

/// Moves each grain by independent normal noise of standard deviation `noise` [d] along x, y and z.
/// The noise depends on the seed and the number of the grain only.
void add_noise(State& state, double noise, std::uint64_t seed);

}  // namespace shearcell
