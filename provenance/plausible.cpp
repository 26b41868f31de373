// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/plausible.hpp"

#include <cmath>

#include "provenance/errors.hpp"

namespace shearcell {

namespace {

constexpr double kFarthest = 1e9;  // [d]; grains may drift along the period
constexpr double kSteepest = 1.5;  // [rad]

[[noreturn]] void fail(const char* where, const char* why) {
  throw StoreDamaged(std::string("checkpoint: /restart/") + where + ": " + why);
}

}  // namespace

void require_plausible(const Checkpoint& checkpoint) {
  const Cell& cell = checkpoint.cell;
  if (!(cell.width > 0 && cell.depth > 0)) fail("cell", "has no width or no depth");
  for (const double length :
       {cell.width, cell.depth, cell.bottom, cell.top, checkpoint.state.wall_height}) {
    if (std::abs(length) > kFarthest) fail("cell", "is larger than any cell");
  }
  if (std::abs(checkpoint.theta) > kSteepest) fail("theta", "is no tilt of a cell");
  if (!(checkpoint.state.position.array().abs() <= kFarthest).all()) {
    fail("position", "has a grain far outside of any cell");
  }
  for (const WallGrain& grain : cell.wall_grains) {
    if (grain.position.cwiseAbs().maxCoeff() > kFarthest) {
      fail("cell/wall_grain_position", "has a grain far outside of any cell");
    }
  }
}

}  // namespace shearcell
