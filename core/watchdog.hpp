// SPDX-License-Identifier: GPL-3.0-or-later
// Checks that stop a simulation whose state is not valid.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/cell.hpp"
#include "core/kernel.hpp"
#include "core/scene.hpp"

namespace shearcell {

/// Thrown if a quantity exceeds its limit. what() gives the value and the limit, and says what to
/// change.
class NumericalFailure : public std::runtime_error {
 public:
  NumericalFailure(std::string quantity, double value, double limit, std::int64_t grain,
                   std::uint64_t step, const std::string& remedy);
  std::string quantity;
  double value;
  double limit;
  std::int64_t grain;  ///< permanent id, or -1
  std::uint64_t step;
};

struct WatchdogLimits {
  double overlap = 0.1;  ///< allowed overlap of two grains, or of a grain and a wall plane [d]
  double escape = 0.5;   ///< allowed distance of a grain centre outside a wall plane [d]
  double time_step = 1;  ///< allowed time step, divided by the stability limit (see check_grains)
};

/// Input of the checks. The arrays are laid out as in kernel.hpp.
struct WatchTask {
  const Cell& cell;
  const Scene& scene;
  std::array<WallPlane, 4> planes;  ///< indexed by WallSide
  const WatchdogLimits& limits;
  const double* rows;
  const double* velocity[3];
  const std::vector<std::int32_t>& id;
  NeighbourRows neighbours;
  std::size_t lanes;
  std::uint64_t step;
  double time_step;      ///< [s]; 0 skips the time-step check
  double wall_height;    ///< height of the moving wall [d]
  double wall_velocity;  ///< velocity of the moving wall [d/s]
};

/// Checks that all numbers are finite, all grains are inside the walls, and no overlap exceeds its
/// limit. The kinetic energy of a grain may not exceed the elastic energy of twelve contacts at the
/// overlap limit. The time step must be below 2/omega for each frequency omega of the contact
/// network. No omega^2 exceeds the largest of these bounds:
///   each grain: k/m times the largest eigenvalue of the sum of w n n^T over its contacts, where w
///     is 2 for contacts with grains, 1 for contacts with fixed walls, and 5/4 for contacts with
///     the moving wall;
///   moving wall: 5 k / (mass of the wall) times the sum of n_y^2 over its contacts.
/// The bounds follow from (a - b)^2 <= (1 + c) a^2 + (1 + 1/c) b^2, where a and b are the
/// displacements of the two partners of a contact along its normal; c is 1 for two grains, and 1/4
/// for a grain (a) and the moving wall (b). The largest bound is exact for a pair (2 k/m) and for
/// an FCC crystal (8 k/m). The checks take as long as about four time steps. Throws
/// NumericalFailure for the failing grain that is stored first in memory.
void check_grains(const WatchTask& task);

}  // namespace shearcell
