// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/watchdog.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <utility>

#include "core/contact.hpp"

namespace shearcell {
namespace {

std::string message(const std::string& quantity, double value, double limit, std::int64_t grain,
                    std::uint64_t step, const std::string& remedy) {
  std::ostringstream text;
  text << quantity << " is " << value << ", over its limit of " << limit;
  if (grain >= 0) text << ", at grain " << grain;
  text << ", step " << step << ". " << remedy;
  return text.str();
}

// Calls visit(offset, separation, moving) for every neighbour of grain g. `offset` is the row
// offset of the neighbour. `moving` says whether the neighbour belongs to the moving wall.
template <class Visit>
void for_each_neighbour(const WatchTask& task, std::size_t g, Visit&& visit) {
  const double* own = task.rows + 4 * g;
  const double depth = task.cell.depth;
  const std::size_t block = g / task.lanes;
  const std::int32_t* list = task.neighbours.list + task.neighbours.begin[block] + g % task.lanes;
  const std::size_t wall_slots = task.neighbours.moving_wall_slots[block];
  const std::size_t slots = wall_slots + task.neighbours.other_slots[block];
  for (std::size_t k = 0; k < slots; ++k) {
    const std::int32_t offset = list[k * task.lanes];
    const double* other = task.rows + offset;
    const double dz = nearest_image(own[2] - other[2], depth, 1 / depth);
    visit(offset, Eigen::Vector3d(own[0] - other[0], own[1] - other[1], dz), k < wall_slots);
  }
}

double largest_overlap(const WatchTask& task, std::size_t g) {
  double nearest = 1;
  for_each_neighbour(task, g, [&](std::int32_t, const Eigen::Vector3d& dr, bool) {
    nearest = std::min(nearest, dr.squaredNorm());
  });
  return 1 - std::sqrt(nearest);
}

// The weights w (first three) and the factor 5 in the bounds on omega^2 (see watchdog.hpp).
constexpr double kOfGrain = 2, kOfFixedWall = 1, kOfMovingWall = 1.25, kOnMovingWall = 5;

// Calls visit(unit normal, weight w, moving) for every contact of grain g. `moving` says whether
// the contact is with the moving wall.
template <class Visit>
void for_each_contact_of(const WatchTask& task, std::size_t g, Visit&& visit) {
  const std::int32_t first_wall = wall_offset(task.id.size());
  for_each_neighbour(task, g, [&](std::int32_t offset, const Eigen::Vector3d& dr, bool moving) {
    const double square = dr.squaredNorm();
    if (!(square < 1)) return;
    const double wall = moving ? kOfMovingWall : kOfFixedWall;
    visit(dr / std::sqrt(square), offset < first_wall ? kOfGrain : wall, moving);
  });
  const double* own = task.rows + 4 * g;
  const auto moving_wall = static_cast<std::size_t>(moving_side(task.cell));
  for (std::size_t side = 0; side < 4; ++side) {
    const WallPlane& plane = task.planes[side];
    if (!(distance_to(plane, own[0], own[1]) < 0.5)) continue;
    const bool moving = side == moving_wall;
    visit(Eigen::Vector3d(plane.normal[0], plane.normal[1], 0),
          moving ? kOfMovingWall : kOfFixedWall, moving);
  }
}

// Largest bound on omega^2 in units of k/m, and the id of the grain with this bound (-1: the moving
// wall).
struct Fastest {
  double bound = 0;
  std::int64_t grain = -1;
};

// Computes the bound on omega^2 for grain g. If the bound exceeds `least` and `fastest.bound`,
// updates `fastest`. Cheaper estimates exclude nearly all grains before the eigenvalues are
// computed.
void bound_grain(const WatchTask& task, std::size_t g, double least, Fastest& fastest) {
  const std::size_t block = g / task.lanes;
  const auto slots = static_cast<double>(task.neighbours.moving_wall_slots[block] +
                                         task.neighbours.other_slots[block]);
  if (kOfGrain * slots + 4 * kOfMovingWall <= least) return;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for_each_contact_of(task, g, [&](const Eigen::Vector3d& normal, double weight, bool) {
    sum += weight * normal * normal.transpose();
  });
  // Largest eigenvalue <= mean + sqrt(2) spread (Wolkowicz and Styan, Linear Algebra Appl. 29, 471
  // (1980)). Rounding gives equal eigenvalues a spread of up to 1e-8 of their mean.
  const double mean = sum.trace() / 3;
  const double spread = std::sqrt(std::max(0.0, sum.squaredNorm() / 3 - mean * mean));
  if (mean + std::numbers::sqrt2 * spread <= (1 - 1e-6) * std::max(least, fastest.bound)) return;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(sum, Eigen::EigenvaluesOnly);
  const double bound = solver.eigenvalues()(2);
  if (bound > fastest.bound) fastest = {bound, task.id[g]};
}

// Stores the moving wall's bound on omega^2 in `fastest` if it exceeds `least` and `fastest.bound`.
void bound_wall(const WatchTask& task, double least, Fastest& fastest) {
  const double each = kOnMovingWall / (task.scene.wall_mass * task.cell.width * task.cell.depth);
  std::vector<std::size_t> near;
  double most = 0;
  for (std::size_t g = 0; g < task.id.size(); ++g) {
    const std::size_t block = g / task.lanes;
    if ((task.neighbours.near[block] & kNearMovingWall) == 0) continue;
    near.push_back(g);
    most += each * (1.0 + task.neighbours.moving_wall_slots[block]);
  }
  if (most <= least) return;
  double bound = 0;
  for (const std::size_t g : near) {
    for_each_contact_of(task, g, [&](const Eigen::Vector3d& normal, double, bool moving) {
      if (moving) bound += each * normal.y() * normal.y();
    });
  }
  if (bound > fastest.bound) fastest = {bound, -1};
}

void check_time_step(const WatchTask& task) {
  if (!(task.time_step > 0)) return;
  const double allowed = 2 * task.limits.time_step / task.time_step;
  const double least = allowed * allowed / task.scene.stiffness;
  Fastest fastest;
  for (std::size_t g = 0; g < task.id.size(); ++g) bound_grain(task, g, least, fastest);
  bound_wall(task, least, fastest);
  if (!(fastest.bound > least)) return;
  throw NumericalFailure(
      "the time step [s]", task.time_step,
      2 * task.limits.time_step / std::sqrt(fastest.bound * task.scene.stiffness), fastest.grain,
      task.step,
      "Contacts may vibrate too fast for this time step. Use a smaller time step (more "
      "steps_per_cycle; while settling, a smaller settle_time_step_s)" +
          std::string(fastest.grain < 0 ? ", or a heavier wall (wall_mass_grains_per_d2)" : ""));
}

void check_place(const WatchTask& task, std::size_t g) {
  const double* own = task.rows + 4 * g;
  // If x or y is NaN, the first distance is NaN and stays the smallest, so the first check below
  // throws.
  double smallest = distance_to(task.planes[0], own[0], own[1]);
  for (const WallPlane& plane : task.planes) {
    const double distance = distance_to(plane, own[0], own[1]);
    smallest = distance < smallest ? distance : smallest;
  }
  if (!(smallest >= -task.limits.escape && std::isfinite(own[2]))) {
    throw NumericalFailure("the depth [d] of a grain's centre behind a wall", -smallest,
                           task.limits.escape, task.id[g], task.step,
                           "A grain was pushed out of the cell. Lower the pressure or raise the "
                           "stiffness");
  }
  if (!(0.5 - smallest <= task.limits.overlap)) {
    throw NumericalFailure("the overlap [d] of a grain and a wall plane", 0.5 - smallest,
                           task.limits.overlap, task.id[g], task.step,
                           "The grains are too soft for this load, or were placed too near a "
                           "wall. Raise the stiffness, lower the pressure, or use a smaller time "
                           "step");
  }
}

}  // namespace

NumericalFailure::NumericalFailure(std::string what_quantity, double what_value, double what_limit,
                                   std::int64_t which_grain, std::uint64_t which_step,
                                   const std::string& remedy)
    : std::runtime_error(
          message(what_quantity, what_value, what_limit, which_grain, which_step, remedy)),
      quantity(std::move(what_quantity)),
      value(what_value),
      limit(what_limit),
      grain(which_grain),
      step(which_step) {}

void check_grains(const WatchTask& task) {
  if (!std::isfinite(task.wall_height) || !std::isfinite(task.wall_velocity)) {
    throw NumericalFailure("the height [d] of the moving wall", task.wall_height,
                           std::numeric_limits<double>::max(), -1, task.step,
                           "Use a smaller time step, or check the pressure and the mass and drag "
                           "of the wall");
  }
  const double most_overlap = task.limits.overlap;
  const double fastest_square = 12 * task.scene.stiffness * most_overlap * most_overlap;
  for (std::size_t g = 0; g < task.id.size(); ++g) {
    const double v2 = task.velocity[0][g] * task.velocity[0][g] +
                      task.velocity[1][g] * task.velocity[1][g] +
                      task.velocity[2][g] * task.velocity[2][g];
    // The negated comparison also rejects NaN.
    if (!(v2 <= fastest_square)) {
      throw NumericalFailure(
          "the speed [d/s] of a grain", std::sqrt(v2), std::sqrt(fastest_square), task.id[g],
          task.step,
          "The integration is unstable. Use a smaller time step (more steps_per_cycle; "
          "while settling, a smaller settle_time_step_s)");
    }
    check_place(task, g);
    const double overlap = largest_overlap(task, g);
    if (!(overlap <= most_overlap)) {
      throw NumericalFailure("the overlap [d] of two grains", overlap, most_overlap, task.id[g],
                             task.step,
                             "The grains are too soft for this load, or the time step is too "
                             "large. Raise the stiffness, lower the pressure, or use a smaller "
                             "time step. If such overlaps are intended, raise the limit "
                             "(max_overlap_diameters; while the moving wall compacts the loose "
                             "grains, the limit is at least 0.5 d)");
    }
  }
  check_time_step(task);
}

}  // namespace shearcell
