// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/neighbour_lists.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace shearcell {
namespace {

// Number of time steps for which a margin should suffice at the present speed of the grain.
constexpr double kOuterHorizon = 500, kInnerHorizon = 80;

// Speed of a grain in the frame that moves with the shear [d/s].
double speed(const Snapshot& now, std::size_t g) {
  const double vx = now.velocity[0][g] - now.shear_rate * (now.rows[4 * g + 1] - now.pose.top);
  const double vy = now.velocity[1][g];
  const double vz = now.velocity[2][g];
  return std::sqrt(vx * vx + vy * vy + vz * vz);
}

float round_down(double margin) {
  return static_cast<float>(margin * (1 - 0x1p-23));
}

// Largest margin [d] of a grain in a cell with this depth [d].
double largest_margin(double depth) {
  return 0.24 * (depth - 2);
}

}  // namespace

double ListSettings::widest_margin(double depth) const {
  return std::max(
      {std::min(0.5 * (widest_cutoff - 1), largest_margin(depth)), outer_margin(), inner_margin()});
}

void Reference::set(const double* rows, std::size_t grains, const WallPose& pose, double widest,
                    Team& team) {
  pose_ = pose;
  widest_ = widest;
  for (auto& axis : at_) axis.resize(padded(grains));
  const double largest = team.largest(grains, [&](std::size_t first, std::size_t last) {
    double coordinate = 0;
    for (std::size_t g = first; g < last; ++g) {
      const double* p = rows + 4 * g;
      coordinate = std::max({coordinate, std::fabs(p[0]), std::fabs(p[1]), std::fabs(p[2])});
      at_[0][g] = static_cast<float>(p[0] - pose.tan_theta * (p[1] - pose.top));
      at_[1][g] = static_cast<float>(p[1]);
      at_[2][g] = static_cast<float>(p[2]);
    }
    return coordinate;
  });
  // Each coordinate is rounded by at most 2^-24 of its value. The factor of 4 leaves room for the
  // errors of all three coordinates and for the tilt.
  rounding_ = 0x1p-22 * largest;
}

double Reference::moved(const double* rows, std::size_t grain, const WallPose& pose) const {
  const double* p = rows + 4 * grain;
  const double y = double{at_[1][grain]};
  const double wx = p[0] - (double{at_[0][grain]} + pose.tan_theta * (y - pose_.top));
  const double wy = p[1] - y;
  const double wz = p[2] - double{at_[2][grain]};
  return std::sqrt(wx * wx + wy * wy + wz * wz);
}

double Reference::wall_moved(const WallPose& pose) const {
  // The side walls follow the shear displacement, which is zero at the top wall. Grains of the
  // bottom wall move in x with the bottom plane, whatever their height. A wall grain is at most d
  // away from the plane. So its displacement differs from the shear displacement at its own height
  // by at most d times the change of tan(theta).
  const double travel =
      std::max(std::fabs(pose.bottom - pose_.bottom), std::fabs(pose.top - pose_.top));
  return travel * (1 + std::fabs(pose.tan_theta)) + std::fabs(pose.tan_theta - pose_.tan_theta);
}

double Reference::margin_loss(double tan_theta) const {
  // A simple shear by e multiplies each distance by at least the smallest singular value of the
  // shear, sqrt(1 + e^2/4) - e/2 > 1 - e/2. So the distance 1 + 2 widest_ decreases by at most the
  // fraction e/2. Half of this loss is subtracted from the margin of each grain of the pair.
  return 0.25 * std::fabs(tan_theta - pose_.tan_theta) * (1 + 2 * widest_) + rounding_ + 1e-9;
}

NeighbourLists::NeighbourLists(const Kernels& kernels, const ListSettings& settings, double depth,
                               const Walls& walls, Team& team)
    : kernels_(kernels),
      walls_(walls),
      team_(team),
      settings_(settings),
      depth_(depth),
      widest_margin_(settings.widest_margin(depth)) {}

bool NeighbourLists::inner_valid(double excess, const WallPose& pose) const {
  if (settings_.rebuild_every_step) return false;
  const double room = inner_wall_margin_ - inner_reference_.margin_loss(pose.tan_theta);
  return excess <= 0 && inner_reference_.wall_moved(pose) < room;
}

// Widens the margins if the last outer lists were valid only for a short time. In this case many
// grains are fast (a wall presses loose grains together), and wide margins cost less than searches.
void NeighbourLists::choose_widest_margin(const Snapshot& now) {
  const std::uint64_t age = now.step - built_at_;
  built_at_ = now.step;
  const double most = std::min(0.5, largest_margin(depth_));
  const double least = settings_.widest_margin(depth_);
  if (age > 0 && age < 100) widest_margin_ = std::min(1.3 * widest_margin_, most);
  if (age > 250) widest_margin_ /= 1.3;
  widest_margin_ = std::max(widest_margin_, least);
}

void NeighbourLists::set_outer_margins(const Snapshot& now) {
  choose_widest_margin(now);
  const double least = settings_.outer_margin();
  const double horizon = kOuterHorizon * now.time_step;
  outer_margin_.resize(now.grains);
  team_.run(now.grains, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t g = first; g < last; ++g) {
      now.rows[4 * g + 3] = std::min(least + horizon * speed(now, g), widest_margin_);
    }
  });
  outer_wall_margin_ = std::min(least + horizon * now.wall_speed, widest_margin_);
  walls_.place_all(now.pose, outer_wall_margin_, now.rows + wall_offset(now.grains));
}

void NeighbourLists::build(const Snapshot& now, const std::vector<std::int32_t>& id,
                           const CellOrder& order) {
  outer_reference_.set(now.rows, now.grains, now.pose, widest_margin_, team_);
  for (std::size_t g = 0; g < now.grains; ++g) outer_margin_[g] = round_down(now.rows[4 * g + 3]);
  const std::size_t walls = walls_.size();
  offset_of_id_.resize(walls + now.grains);
  for (std::size_t w = 0; w < walls; ++w) {
    offset_of_id_[w] = wall_offset(now.grains) + static_cast<std::int32_t>(4 * w);
  }
  for (std::size_t g = 0; g < now.grains; ++g) {
    offset_of_id_[walls + static_cast<std::size_t>(id[g])] = static_cast<std::int32_t>(4 * g);
  }
  search(order, now.grains);
  set_inner_margins(now);
  prune_inner(now);
}

void NeighbourLists::search(const CellOrder& order, std::size_t grains) {
  outer_count_.resize(grains);
  SearchTask task;
  task.grid = order.grid();
  task.first_grain = static_cast<std::int32_t>(walls_.size());
  task.offset_of_id = offset_of_id_.data();
  task.count = outer_count_.data();
  task.padding = padding_offset(grains);
  task.depth = depth_;
  task.per_depth = 1 / depth_;
  for (;;) {
    outer_.resize(grains * outer_stride_);
    task.outer = outer_.data();
    task.stride = outer_stride_;
    const double longest = team_.largest(order.size(), [&](std::size_t first, std::size_t last) {
      return static_cast<double>(kernels_.search(task, first, last));
    });
    const auto most = static_cast<std::size_t>(longest);
    if (most <= outer_stride_) return;
    outer_stride_ = padded(most + 8);
  }
}

bool NeighbourLists::prune(const Snapshot& now) {
  if (settings_.rebuild_every_step || !set_inner_margins(now)) return false;
  prune_inner(now);
  return true;
}

// The outer lists must contain each pair whose distance is less than 1 plus the inner margins of
// both partners. So the largest allowed inner margin is: outer margin - margin_loss() - movement
// since the outer lists were built. Returns false if this maximum is below settings_.inner_margin()
// for a grain or the walls.
bool NeighbourLists::set_inner_margins(const Snapshot& now) {
  const double least = settings_.inner_margin();
  const double horizon = kInnerHorizon * now.time_step;
  const double loss = outer_reference_.margin_loss(now.pose.tan_theta);
  double smallest_room = outer_wall_margin_ - outer_reference_.wall_moved(now.pose) - loss;
  inner_wall_margin_ = std::min(least + horizon * now.wall_speed, smallest_room);
  const auto set = [&](std::size_t first, std::size_t last) {
    double smallest = std::numeric_limits<double>::infinity();
    for (std::size_t g = first; g < last; ++g) {
      const double room =
          double{outer_margin_[g]} - outer_reference_.moved(now.rows, g, now.pose) - loss;
      smallest = std::min(smallest, room);
      now.rows[4 * g + 3] = std::min(least + horizon * speed(now, g), room);
    }
    return -smallest;
  };
  smallest_room = std::min(smallest_room, -team_.largest(now.grains, set));
  double* wall_row = now.rows + wall_offset(now.grains);
  for (std::size_t w = 0; w < walls_.size(); ++w) wall_row[4 * w + 3] = inner_wall_margin_;
  return smallest_room >= least;
}

void NeighbourLists::prune_inner(const Snapshot& now) {
  inner_reference_.set(now.rows, now.grains, now.pose, widest_margin_, team_);
  const std::size_t blocks = (now.grains + kernels_.lanes - 1) / kernels_.lanes;
  other_slots_.resize(blocks);
  moving_wall_slots_.resize(blocks);
  near_.resize(blocks);
  begin_.resize(blocks);
  inner_count_.resize(padded(now.grains));
  grain_near_.resize(padded(now.grains));
  PruneTask task;
  task.grains = now.grains;
  task.rows = now.rows;
  task.outer = outer_.data();
  task.outer_stride = outer_stride_;
  task.outer_count = outer_count_.data();
  task.first_wall = wall_offset(now.grains);
  task.moving_end = task.first_wall + static_cast<std::int32_t>(4 * walls_.moving_size());
  task.planes = walls_.planes(now.pose);
  task.wall_margin = inner_wall_margin_;
  task.inner_count = inner_count_.data();
  task.other_slots = other_slots_.data();
  task.moving_wall_slots = moving_wall_slots_.data();
  task.near = near_.data();
  task.grain_near = grain_near_.data();
  task.begin = begin_.data();
  task.padding = padding_offset(now.grains);
  task.depth = depth_;
  task.per_depth = 1 / depth_;
  for (;; inner_stride_ *= 2) {
    inner_.resize(blocks * kernels_.lanes * inner_stride_);
    task.inner = inner_.data();
    task.inner_stride = inner_stride_;
    const auto too_long = [&](std::size_t first, std::size_t last) {
      return kernels_.prune(task, first, last) ? 0.0 : 1.0;
    };
    if (team_.largest(blocks, too_long) == 0) break;
  }
  at_moving_wall_.clear();
  for (std::size_t i = walls_.size(); i < offset_of_id_.size(); ++i) {
    const std::int32_t g = offset_of_id_[i] / 4;
    const std::uint8_t near = grain_near_[static_cast<std::size_t>(g)];
    if ((near & kNearMovingWall) != 0) at_moving_wall_.push_back(g);
  }
}

NeighbourRows NeighbourLists::rows() const {
  return {inner_.data(), begin_.data(), other_slots_.data(), moving_wall_slots_.data(),
          near_.data()};
}

std::size_t NeighbourLists::bytes() const {
  return 4 * (outer_.size() + inner_.size() + offset_of_id_.size() + outer_margin_.size()) +
         2 * outer_count_.size() + 3 * inner_count_.size() + 9 * other_slots_.size() +
         outer_reference_.bytes() + inner_reference_.bytes();
}

}  // namespace shearcell
