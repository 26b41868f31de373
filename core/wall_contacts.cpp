// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/wall_contacts.hpp"

#include <algorithm>
#include <cmath>

#include "core/contact.hpp"
#include "core/linked_cells.hpp"

namespace shearcell {
namespace {

// Far from every grain, and on the other side than the padding among the grains.
constexpr double kNowhere = 1e30;

double distance_to(const std::array<double, 2>& point, const std::array<double, 2>& normal,
                   const double* row) {
  return (row[0] - point[0]) * normal[0] + (row[1] - point[1]) * normal[1];
}

}  // namespace

WallContacts::WallContacts(const Kernels& kernels, const Cell& cell)
    : kernels_(kernels), cell_(cell) {
  for (std::size_t w = 0; w < cell_.wall_grains.size(); ++w) {
    sides_[static_cast<std::size_t>(cell_.wall_grains[w].side)].grains.push_back(w);
  }
  for (Side& side : sides_) {
    side.rows.assign(4 * (side.grains.size() + 1), 0.0);
    side.rows[4 * side.grains.size()] = kNowhere;
  }
}

void WallContacts::place(const WallPose& pose) {
  const double c = pose.cos_theta;
  const double s = pose.sin_theta;
  // The side planes pass through the ends of the top wall, which does not move in x.
  sides_[0].point = {0, pose.top};
  sides_[0].normal = {c, -s};
  sides_[1].point = {cell_.width, pose.top};
  sides_[1].normal = {-c, s};
  sides_[2].point = {0, pose.bottom};
  sides_[2].normal = {0, 1};
  sides_[3].point = {0, pose.top};
  sides_[3].normal = {0, -1};
  for (Side& side : sides_) {
    double* row = side.rows.data();
    for (const std::size_t w : side.grains) {
      const Eigen::Vector3d p = wall_grain_position(cell_, pose, cell_.wall_grains[w]);
      row[0] = p.x();
      row[1] = p.y();
      row[2] = p.z();
      row += 4;
    }
  }
}

void WallContacts::build(const double* rows, std::size_t grains,
                         const std::vector<std::int32_t>& id, const WallPose& pose, double cutoff) {
  place(pose);
  for (Side& side : sides_) {
    side.members.clear();
    for (std::size_t g = 0; g < grains; ++g) {
      // Wall grains lie behind the plane, so none touches a grain farther than d in front of it.
      if (distance_to(side.point, side.normal, rows + 4 * g) < cutoff) {
        side.members.push_back(static_cast<std::int32_t>(4 * g));
      }
    }
    std::sort(side.members.begin(), side.members.end(), [&id](std::int32_t a, std::int32_t b) {
      return id[static_cast<std::size_t>(a / 4)] < id[static_cast<std::size_t>(b / 4)];
    });
    side.count = side.members.size();
    side.members.resize(padded(side.count), padding_offset(grains));
    side.push.assign(side.count, 0.0);
    find_neighbours(side, rows, cutoff, pose);
  }
}

void WallContacts::find_neighbours(Side& side, const double* rows, double cutoff,
                                   const WallPose& pose) {
  const std::size_t lanes = kernels_.lanes;
  side.slots.assign(side.members.size() / lanes, 0);
  const auto padding = static_cast<std::int32_t>(4 * side.grains.size());
  side.list.assign(side.members.size() * side.stride, padding);
  if (side.grains.empty()) return;

  LinkedCells near(cell_.width, pose.bottom, pose.top, cell_.depth,
                   cutoff * std::sqrt(1 + pose.tan_theta * pose.tan_theta), side.grains.size());
  const auto untilted = [&pose](const double* p) {
    return p[0] - pose.tan_theta * (p[1] - pose.top);
  };
  for (std::size_t w = side.grains.size(); w-- > 0;) {
    const double* p = side.rows.data() + 4 * w;
    // Side walls reach over the whole fill height: the moving wall has left most of it behind.
    if (p[1] < pose.bottom - 2 * cutoff || p[1] > pose.top + 2 * cutoff) continue;
    near.insert(static_cast<std::int32_t>(w), untilted(p), p[1], p[2]);
  }
  for (std::size_t m = 0; m < side.count; ++m) {
    const double* own = rows + side.members[m];
    std::int32_t* row = side.list.data() + m * side.stride;
    std::size_t count = 0;
    near.for_each_near(untilted(own), own[1], own[2], [&](std::int32_t w) {
      const double* p = side.rows.data() + 4 * static_cast<std::size_t>(w);
      const double dx = own[0] - p[0];
      const double dy = own[1] - p[1];
      const double dz = nearest_image(own[2] - p[2], cell_.depth, 1 / cell_.depth);
      if (!(dx * dx + dy * dy + dz * dz < cutoff * cutoff)) return;
      if (count < side.stride) row[count] = 4 * w;
      ++count;
    });
    if (count > side.stride) {
      side.stride = (count + 7) / 8 * 8;
      find_neighbours(side, rows, cutoff, pose);
      return;
    }
    std::sort(row, row + count);
    std::uint16_t& slots = side.slots[m / lanes];
    slots = std::max(slots, static_cast<std::uint16_t>(count));
  }
}

double WallContacts::evaluate(const double* rows, const WallPose& pose,
                              std::array<AlignedVector<double>, 3>& wall_sum) {
  place(pose);
  for (const Side& side : sides_) {
    for (std::size_t m = 0; m < side.count; ++m) {
      const auto g = static_cast<std::size_t>(side.members[m]) / 4;
      for (auto& axis : wall_sum) axis[g] = 0;
    }
  }
  const std::size_t moving = cell_.moving == MovingWall::bottom ? 2 : 3;
  for (std::size_t w = 0; w < sides_.size(); ++w) {
    Side& side = sides_[w];
    if (side.count == 0) continue;
    WallTask task;
    task.rows = rows;
    task.members = side.members.data();
    task.count = side.count;
    task.wall_rows = side.rows.data();
    task.neighbours = {side.list.data(), side.stride, side.slots.data()};
    for (std::size_t axis = 0; axis < 2; ++axis) {
      task.point[axis] = side.point[axis];
      task.normal[axis] = side.normal[axis];
    }
    task.depth = cell_.depth;
    task.per_depth = 1 / cell_.depth;
    for (std::size_t axis = 0; axis < 3; ++axis) task.wall_sum[axis] = wall_sum[axis].data();
    task.push = w == moving ? side.push.data() : nullptr;
    kernels_.walls(task);
  }
  double push = 0;
  for (std::size_t m = 0; m < sides_[moving].count; ++m) push += sides_[moving].push[m];
  return push;
}

std::size_t WallContacts::bytes() const {
  std::size_t total = cell_.wall_grains.size() * sizeof(WallGrain);
  for (const Side& side : sides_) {
    total += 8 * (side.rows.size() + side.push.size() + side.grains.size()) +
             4 * (side.members.size() + side.list.size()) + 2 * side.slots.size();
  }
  return total;
}

}  // namespace shearcell
