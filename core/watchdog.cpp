// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/watchdog.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
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

double smallest_distance(const Cell& cell, const WallPose& pose, const double* row) {
  const double across = pose.cos_theta * row[0] - pose.sin_theta * (row[1] - pose.top);
  const double side = std::min(across, pose.cos_theta * cell.width - across);
  return std::min({side, row[1] - pose.bottom, pose.top - row[1]});
}

double largest_overlap(const WatchTask& task, std::size_t g, double depth) {
  const double* own = task.rows + 4 * g;
  const std::size_t block = g / task.lanes;
  const std::int32_t* list = task.neighbours.list + task.neighbours.begin[block] + g % task.lanes;
  double nearest = 1;
  const std::size_t slots = task.neighbours.head[block] + task.neighbours.slots[block];
  for (std::size_t k = 0; k < slots; ++k) {
    const double* other = task.rows + list[k * task.lanes];
    const double dx = own[0] - other[0];
    const double dy = own[1] - other[1];
    const double dz = nearest_image(own[2] - other[2], depth, 1 / depth);
    nearest = std::min(nearest, dx * dx + dy * dy + dz * dz);
  }
  return 1 - std::sqrt(nearest);
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
  const double fastest_square = 12 * scene.stiffness * limits.overlap * limits.overlap;
  for (std::size_t g = 0; g < task.id->size(); ++g) {
    const std::int64_t id = (*task.id)[g];
    const double* row = task.rows + 4 * g;
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
    const double distance = smallest_distance(cell, pose, row);
    if (!(distance >= -limits.escape && std::isfinite(row[2]))) {
      throw NumericalFailure("the depth [d] of a grain's centre behind a wall", -distance,
                             limits.escape, id, task.step,
                             "A grain was pushed out of the cell: lower the pressure or raise the "
                             "stiffness");
    }
    const double overlap = largest_overlap(task, g, cell.depth);
    if (!(overlap <= limits.overlap)) {
      throw NumericalFailure("the overlap [d] of two grains", overlap, limits.overlap, id,
                             task.step,
                             "The grains are too soft for this load, or the time step is too "
                             "large: raise the stiffness, lower the pressure, or use a smaller "
                             "time step");
    }
  }
}

}  // namespace shearcell
