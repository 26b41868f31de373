// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/wall_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

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

double square_distance(const double* a, const double* b, double depth) {
  const double dx = a[0] - b[0];
  const double dy = a[1] - b[1];
  const double dz = nearest_image(a[2] - b[2], depth, 1 / depth);
  return dx * dx + dy * dy + dz * dz;
}

}  // namespace

WallContacts::WallContacts(const Kernels& kernels, const Cell& cell)
    : kernels_(kernels), cell_(cell) {
  for (const WallGrain& grain : cell_.wall_grains) {
    sides_[static_cast<std::size_t>(grain.side)].grains.push_back(grain.position);
  }
  for (Side& side : sides_) {
    side.rows.assign(4 * (side.grains.size() + 1), 0.0);
    for (std::size_t w = 0; w < side.grains.size(); ++w) {
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        side.rows[4 * w + static_cast<std::size_t>(axis)] = side.grains[w](axis);
      }
    }
    side.rows[4 * side.grains.size()] = kNowhere;
  }
}

// Operations and order are those of wall_grain_position(). z never changes, nor y on the side
// walls.
void WallContacts::place_side(WallSide which, const WallPose& pose) {
  Side& side = sides_[static_cast<std::size_t>(which)];
  const auto row_of = [&side](std::int32_t w) {
    return side.rows.data() + 4 * static_cast<std::size_t>(w);
  };
  if (which == WallSide::left || which == WallSide::right) {
    for (const std::int32_t w : side.active) {
      const Eigen::Vector3d& p = side.grains[static_cast<std::size_t>(w)];
      row_of(w)[0] = p.x() + (p.y() - pose.top) * pose.tan_theta;
    }
    return;
  }
  const bool bottom = which == WallSide::bottom;
  const double dx = bottom ? (pose.bottom - pose.top) * pose.tan_theta : 0.0;
  const double dy = bottom ? pose.bottom - cell_.bottom : pose.top - cell_.top;
  for (const std::int32_t w : side.active) {
    const Eigen::Vector3d& p = side.grains[static_cast<std::size_t>(w)];
    row_of(w)[0] = p.x() + dx;
    row_of(w)[1] = p.y() + dy;
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
  for (std::size_t w = 0; w < sides_.size(); ++w) place_side(static_cast<WallSide>(w), pose);
}

void WallContacts::build(const double* rows, const std::vector<std::int32_t>& id,
                         const WallPose& pose, double cutoff) {
  nowhere_ = padding_offset(id.size());
  for (Side& side : sides_) {
    side.active.resize(side.grains.size());
    std::iota(side.active.begin(), side.active.end(), 0);
  }
  place(pose);
  for (Side& side : sides_) {
    // Side walls reach over the whole fill height, most of which the moving wall has left behind.
    std::erase_if(side.active, [&](std::int32_t w) {
      const double y = side.rows[4 * static_cast<std::size_t>(w) + 1];
      return y < pose.bottom - 2 * cutoff || y > pose.top + 2 * cutoff;
    });
    side.candidates.clear();
    for (std::size_t g = 0; g < id.size(); ++g) {
      // Wall grains lie behind the plane, so none touches a grain farther than d in front of it.
      if (distance_to(side.point, side.normal, rows + 4 * g) < cutoff) {
        side.candidates.push_back(static_cast<std::int32_t>(4 * g));
      }
    }
    std::sort(side.candidates.begin(), side.candidates.end(),
              [&id](std::int32_t a, std::int32_t b) {
                return id[static_cast<std::size_t>(a / 4)] < id[static_cast<std::size_t>(b / 4)];
              });
    find_near(side, rows, cutoff, pose);
  }
}

void WallContacts::find_near(Side& side, const double* rows, double cutoff, const WallPose& pose) {
  LinkedCells cells(cell_.width, pose.bottom, pose.top, cell_.depth,
                    cutoff * std::sqrt(1 + pose.tan_theta * pose.tan_theta), side.active.size());
  const auto untilted = [&pose](const double* p) {
    return p[0] - pose.tan_theta * (p[1] - pose.top);
  };
  for (const std::int32_t w : side.active) {
    const double* p = side.rows.data() + 4 * static_cast<std::size_t>(w);
    cells.insert(w, untilted(p), p[1], p[2]);
  }
  side.near.clear();
  side.near_end.clear();
  for (const std::int32_t candidate : side.candidates) {
    const double* own = rows + candidate;
    const auto first = static_cast<std::ptrdiff_t>(side.near.size());
    cells.for_each_near(untilted(own), own[1], own[2], [&](std::int32_t w) {
      const double* p = side.rows.data() + 4 * static_cast<std::size_t>(w);
      if (square_distance(own, p, cell_.depth) < cutoff * cutoff) side.near.push_back(4 * w);
    });
    std::sort(side.near.begin() + first, side.near.end());
    side.near_end.push_back(side.near.size());
  }
}

void WallContacts::prune(const double* rows, const WallPose& pose, double cutoff) {
  place(pose);
  seen_.assign(static_cast<std::size_t>(nowhere_ / 4), 0);
  for (Side& side : sides_) prune_side(side, rows, cutoff);
  walled_.assign(seen_.size() / kernels_.lanes, 0);
  for (std::size_t g = 0; g < seen_.size(); ++g) walled_[g / kernels_.lanes] |= seen_[g];
}

void WallContacts::prune_side(Side& side, const double* rows, double cutoff) {
  touches_.clear();
  touched_.clear();
  std::size_t first = 0;
  for (std::size_t c = 0; c < side.candidates.size(); ++c) {
    const double* own = rows + side.candidates[c];
    const std::size_t begin = touched_.size();
    for (std::size_t n = first; n < side.near_end[c]; ++n) {
      const double* wall = side.rows.data() + side.near[n];
      if (square_distance(own, wall, cell_.depth) < cutoff * cutoff) {
        touched_.push_back(side.near[n]);
      }
    }
    first = side.near_end[c];
    if (begin < touched_.size() || distance_to(side.point, side.normal, own) < cutoff - 0.5) {
      touches_.push_back({side.candidates[c], touches_.size(), begin, touched_.size()});
    }
  }
  // Members with equally many wall grains share a vector, whose lanes wait for the longest list.
  std::stable_sort(touches_.begin(), touches_.end(), [](const Touch& a, const Touch& b) {
    return a.end - a.begin < b.end - b.begin;
  });
  write_lists(side);
}

void WallContacts::write_lists(Side& side) {
  const std::size_t lanes = kernels_.lanes;
  side.count = touches_.size();
  side.members.assign(padded(side.count), nowhere_);
  side.first.resize(side.count);
  side.push.assign(side.count, 0.0);
  side.by_id.resize(side.count);
  // Sorted by length, so the last member of a block is its longest.
  const std::size_t blocks = side.members.size() / lanes;
  side.begin.assign(blocks, 0);
  side.slots.assign(blocks, 0);
  std::size_t end = 0;
  for (std::size_t block = 0; block * lanes < side.count; ++block) {
    const Touch& longest = touches_[std::min(block * lanes + lanes, side.count) - 1];
    side.begin[block] = static_cast<std::uint32_t>(end);
    side.slots[block] = static_cast<std::uint16_t>(longest.end - longest.begin);
    end += lanes * side.slots[block];
  }
  side.list.assign(end, static_cast<std::int32_t>(4 * side.grains.size()));
  for (std::size_t m = 0; m < side.count; ++m) {
    const Touch& touch = touches_[m];
    side.members[m] = touch.grain;
    side.by_id[touch.rank] = m;
    std::uint8_t& seen = seen_[static_cast<std::size_t>(touch.grain / 4)];
    side.first[m] = seen == 0 ? 1 : 0;
    seen = 1;
    std::int32_t* list = side.list.data() + side.begin[m / lanes] + m % lanes;
    for (std::size_t n = touch.begin; n < touch.end; ++n, list += lanes) *list = touched_[n];
  }
}

double WallContacts::evaluate(const double* rows, const WallPose& pose,
                              std::array<AlignedVector<double>, 3>& wall_sum) {
  place(pose);
  const std::size_t moving = cell_.moving == MovingWall::bottom ? 2 : 3;
  for (std::size_t w = 0; w < sides_.size(); ++w) {
    Side& side = sides_[w];
    if (side.count == 0) continue;
    WallTask task;
    task.rows = rows;
    task.members = side.members.data();
    task.count = side.count;
    task.first = side.first.data();
    task.wall_rows = side.rows.data();
    task.neighbours = {side.list.data(), side.begin.data(), side.slots.data()};
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
  for (const std::size_t m : sides_[moving].by_id) push += sides_[moving].push[m];
  return push;
}

std::size_t WallContacts::bytes() const {
  std::size_t total = 0;
  for (const Side& side : sides_) {
    total += 24 * side.grains.size() +
             8 * (side.rows.size() + side.push.size() + side.near_end.size()) +
             4 * (side.members.size() + side.list.size() + side.near.size() + side.active.size() +
                  side.candidates.size()) +
             6 * side.slots.size();
  }
  return total;
}

}  // namespace shearcell
