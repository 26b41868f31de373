// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/watchdog.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "core/contact.hpp"

namespace shearcell {
namespace {

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

std::string message(const std::string& quantity, double value, double limit, std::int64_t grain,
                    std::uint64_t step, const std::string& remedy) {
  return quantity + " is " + number(value) + ", over its limit of " + number(limit) +
         (grain >= 0 ? ", at grain " + std::to_string(grain) : "") + ", step " +
         std::to_string(step) + ". " + remedy;
}

// Distances of a centre from the left, right, bottom and top plane [d].
std::array<double, 4> plane_distances(const Cell& cell, const WallPose& pose, const double* row) {
  const double across = pose.cos_theta * row[0] - pose.sin_theta * (row[1] - pose.top);
  return {across, pose.cos_theta * cell.width - across, row[1] - pose.bottom, pose.top - row[1]};
}

double largest_overlap(const WatchTask& task, std::size_t g, double depth) {
  const double* own = task.rows + 4 * g;
  const std::size_t block = g / task.lanes;
  const std::int32_t* list = task.neighbours.list + task.neighbours.begin[block] + g % task.lanes;
  double nearest = 1;
  const std::size_t slots =
      task.neighbours.moving_wall_slots[block] + task.neighbours.other_slots[block];
  for (std::size_t k = 0; k < slots; ++k) {
    const double* other = task.rows + list[k * task.lanes];
    const double dx = own[0] - other[0];
    const double dy = own[1] - other[1];
    const double dz = nearest_image(own[2] - other[2], depth, 1 / depth);
    nearest = std::min(nearest, dx * dx + dy * dy + dz * dz);
  }
  return 1 - std::sqrt(nearest);
}

// Weights w of contacts in the frequency bound (watchdog.hpp).
constexpr double kOfGrain = 2, kOfFixedWall = 1, kOfMovingWall = 1.25, kOnMovingWall = 5;

// Calls visit(unit normal, weight, is with the moving wall) for every contact of a grain.
template <class Visit>
void for_each_contact_of(const WatchTask& task, std::size_t g, const Cell& cell,
                         const WallPose& pose, Visit&& visit) {
  const double* own = task.rows + 4 * g;
  const std::size_t block = g / task.lanes;
  const std::int32_t* list = task.neighbours.list + task.neighbours.begin[block] + g % task.lanes;
  const std::size_t wall_slots = task.neighbours.moving_wall_slots[block];
  const std::size_t slots = wall_slots + task.neighbours.other_slots[block];
  const std::int32_t first_wall = wall_offset(task.id->size());
  for (std::size_t k = 0; k < slots; ++k) {
    const std::int32_t offset = list[k * task.lanes];
    const double* other = task.rows + offset;
    const double dz = nearest_image(own[2] - other[2], cell.depth, 1 / cell.depth);
    const Eigen::Vector3d dr(own[0] - other[0], own[1] - other[1], dz);
    const double square = dr.squaredNorm();
    if (!(square < 1)) continue;
    const double wall = k < wall_slots ? kOfMovingWall : kOfFixedWall;
    visit(dr / std::sqrt(square), offset < first_wall ? kOfGrain : wall, k < wall_slots);
  }
  const Eigen::Vector3d across(pose.cos_theta, -pose.sin_theta, 0), up(0, 1, 0);
  const std::array<double, 4> distance = plane_distances(cell, pose, own);
  const auto moving = static_cast<std::size_t>(moving_side(cell));
  for (std::size_t side = 0; side < 4; ++side) {
    if (!(distance[side] < 0.5)) continue;
    visit(side < 2 ? across : up, side == moving ? kOfMovingWall : kOfFixedWall, side == moving);
  }
}

// Largest bound of omega^2 in units of k/m, and its grain.
struct Fastest {
  double bound = 0;
  std::int64_t grain = -1;
};

// Raises `fastest` to the bound of one grain if that exceeds `least`. Almost always the number of
// neighbours, or else the trace of the sum, shows that it does not.
void bound_grain(const WatchTask& task, std::size_t g, const Cell& cell, const WallPose& pose,
                 double least, Fastest& fastest) {
  const std::size_t block = g / task.lanes;
  const auto slots = static_cast<double>(task.neighbours.moving_wall_slots[block] +
                                         task.neighbours.other_slots[block]);
  if (kOfGrain * slots + 4 * kOfMovingWall <= least) return;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for_each_contact_of(task, g, cell, pose, [&](const Eigen::Vector3d& normal, double weight, bool) {
    sum += weight * normal * normal.transpose();
  });
  if (sum.trace() <= std::max(least, fastest.bound)) return;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(sum, Eigen::EigenvaluesOnly);
  const double bound = solver.eigenvalues()(2);
  if (bound > fastest.bound) fastest = {bound, (*task.id)[g]};
}

// The same for the moving wall itself.
void bound_wall(const WatchTask& task, const Cell& cell, const Scene& scene, const WallPose& pose,
                double least, Fastest& fastest) {
  const double each = kOnMovingWall / (scene.wall_mass * cell.width * cell.depth);
  const auto near = [&](std::size_t g) {
    return (task.neighbours.near[g / task.lanes] & kNearMovingWall) != 0;
  };
  double most = 0;
  for (std::size_t g = 0; g < task.id->size(); ++g) {
    const std::size_t block = g / task.lanes;
    if (near(g)) most += each * (1.0 + task.neighbours.moving_wall_slots[block]);
  }
  if (most <= least) return;
  double bound = 0;
  for (std::size_t g = 0; g < task.id->size(); ++g) {
    if (!near(g)) continue;
    for_each_contact_of(task, g, cell, pose,
                        [&](const Eigen::Vector3d& normal, double, bool moving) {
                          if (moving) bound += each * normal.y() * normal.y();
                        });
  }
  if (bound > fastest.bound) fastest = {bound, -1};
}

void check_time_step(const WatchTask& task, const Cell& cell, const Scene& scene,
                     const WallPose& pose, const WatchdogLimits& limits) {
  if (!(task.time_step > 0)) return;
  const double allowed = 2 * limits.time_step / task.time_step;
  const double least = allowed * allowed / scene.stiffness;
  Fastest fastest;
  for (std::size_t g = 0; g < task.id->size(); ++g) {
    bound_grain(task, g, cell, pose, least, fastest);
  }
  bound_wall(task, cell, scene, pose, least, fastest);
  if (!(fastest.bound > least)) return;
  throw NumericalFailure(
      "the time step [s]", task.time_step,
      2 * limits.time_step / std::sqrt(fastest.bound * scene.stiffness), fastest.grain, task.step,
      "The contacts may vibrate faster than it can follow: use a smaller time step (more "
      "steps_per_cycle; while settling, a smaller settle_time_step_s)" +
          std::string(fastest.grain < 0 ? ", or a heavier wall (wall_mass_grains_per_d2)" : ""));
}

void check_place(const WatchTask& task, const WatchdogLimits& limits, std::size_t g,
                 const std::array<double, 4>& distance) {
  const std::int64_t id = (*task.id)[g];
  // NaN in x or y reaches the first distance, and nothing is smaller than that.
  double smallest = distance[0];
  for (const double d : distance) smallest = d < smallest ? d : smallest;
  if (!(smallest >= -limits.escape && std::isfinite(task.rows[4 * g + 2]))) {
    throw NumericalFailure("the depth [d] of a grain's centre behind a wall", -smallest,
                           limits.escape, id, task.step,
                           "A grain was pushed out of the cell: lower the pressure or raise the "
                           "stiffness");
  }
  if (!(0.5 - smallest <= limits.overlap)) {
    throw NumericalFailure("the overlap [d] of a grain and a wall plane", 0.5 - smallest,
                           limits.overlap, id, task.step,
                           "The grains are too soft for this load, or were placed too near a "
                           "wall: raise the stiffness, lower the pressure, or use a smaller time "
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

void check_grains(const WatchTask& task, const Cell& cell, const Scene& scene, const WallPose& pose,
                  const WatchdogLimits& limits) {
  if (!std::isfinite(task.wall_height) || !std::isfinite(task.wall_velocity)) {
    throw NumericalFailure("the height [d] of the moving wall", task.wall_height,
                           std::numeric_limits<double>::max(), -1, task.step,
                           "Use a smaller time step, or check the pressure and the wall's mass "
                           "and drag");
  }
  const double fastest_square = 12 * scene.stiffness * limits.overlap * limits.overlap;
  for (std::size_t g = 0; g < task.id->size(); ++g) {
    const std::int64_t id = (*task.id)[g];
    const double v2 = task.velocity[0][g] * task.velocity[0][g] +
                      task.velocity[1][g] * task.velocity[1][g] +
                      task.velocity[2][g] * task.velocity[2][g];
    // Written so that NaN fails.
    if (!(v2 <= fastest_square)) {
      throw NumericalFailure(
          "the speed [d/s] of a grain", std::sqrt(v2), std::sqrt(fastest_square), id, task.step,
          "The integration is unstable: use a smaller time step (more steps_per_cycle; "
          "while settling, a smaller settle_time_step_s)");
    }
    const std::array<double, 4> distance = plane_distances(cell, pose, task.rows + 4 * g);
    check_place(task, limits, g, distance);
    const double overlap = largest_overlap(task, g, cell.depth);
    if (!(overlap <= limits.overlap)) {
      throw NumericalFailure("the overlap [d] of two grains", overlap, limits.overlap, id,
                             task.step,
                             "The grains are too soft for this load, or the time step is too "
                             "large: raise the stiffness, lower the pressure, or use a smaller "
                             "time step. If they are merely compressed, raise the limit "
                             "(max_overlap_diameters)");
    }
  }
  check_time_step(task, cell, scene, pose, limits);
}

}  // namespace shearcell
