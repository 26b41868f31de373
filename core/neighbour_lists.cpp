// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/neighbour_lists.hpp"

#include <algorithm>
#include <cmath>

#include "core/contact.hpp"

namespace shearcell {
namespace {

constexpr std::size_t kLargestStride = 4096;  // beyond it the cell has collapsed into a point

}  // namespace

void Reference::set(const double* rows, std::size_t grains, const WallPose& pose) {
  pose_ = pose;
  for (auto& axis : at_) axis.resize(padded(grains));
  for (std::size_t g = 0; g < grains; ++g) {
    const double* p = rows + 4 * g;
    at_[0][g] = p[0] - pose.tan_theta * (p[1] - pose.top);
    at_[1][g] = p[1];
    at_[2][g] = p[2];
  }
}

double Reference::farthest(const double* rows, std::size_t grains, const WallPose& pose) const {
  double square = 0;
  for (std::size_t g = 0; g < grains; ++g) {
    const double* p = rows + 4 * g;
    const double wx = p[0] - (at_[0][g] + pose.tan_theta * (at_[1][g] - pose.top));
    const double wy = p[1] - at_[1][g];
    const double wz = p[2] - at_[2][g];
    square = std::max(square, wx * wx + wy * wy + wz * wz);
  }
  return std::sqrt(square);
}

double Reference::wall_travel(const WallPose& pose) const {
  // Side wall grains follow the shear exactly. Those of the bottom move with its plane, whose x is
  // that of its own height: a grain behind it, by at most d, differs by the strain times that.
  const double travel =
      std::max(std::fabs(pose.bottom - pose_.bottom), std::fabs(pose.top - pose_.top));
  return travel * (1 + std::fabs(pose.tan_theta)) + std::fabs(pose.tan_theta - pose_.tan_theta);
}

double Reference::stretch(const WallPose& pose) const {
  // The smallest singular value of a simple shear e is sqrt(1 + e^2/4) - e/2.
  return 1 - 0.5 * std::fabs(pose.tan_theta - pose_.tan_theta);
}

NeighbourLists::NeighbourLists(const Kernels& kernels, const ListSettings& settings, double depth)
    : kernels_(kernels), settings_(settings), depth_(depth) {}

bool NeighbourLists::inner_valid(double farthest, const WallPose& pose) const {
  if (settings_.rebuild_every_step) return false;
  const double moved = std::max(farthest, inner_reference_.wall_travel(pose));
  return settings_.inner_cutoff * inner_reference_.stretch(pose) - 2 * moved > 1.0 + 1e-9;
}

bool NeighbourLists::outer_valid(const double* rows, std::size_t grains,
                                 const WallPose& pose) const {
  if (settings_.rebuild_every_step) return false;
  const double moved =
      std::max(outer_reference_.farthest(rows, grains, pose), outer_reference_.wall_travel(pose));
  return settings_.outer_cutoff * outer_reference_.stretch(pose) - 2 * moved >
         settings_.inner_cutoff + 1e-9;
}

void NeighbourLists::build(const double* rows, std::size_t grains,
                           const std::vector<std::int32_t>& id, const LinkedCells& near,
                           const WallPose& pose) {
  outer_reference_.set(rows, grains, pose);
  outer_count_.assign(grains, 0);
  const double cutoff = settings_.outer_cutoff * settings_.outer_cutoff;
  const double per_depth = 1 / depth_;
  const auto padding = padding_offset(grains);
  const auto by_id = [&id](std::int32_t a, std::int32_t b) {
    return id[static_cast<std::size_t>(a / 4)] < id[static_cast<std::size_t>(b / 4)];
  };
  outer_.assign(grains * outer_stride_, padding);
  for (std::size_t g = 0; g < grains; ++g) {
    const double* own = rows + 4 * g;
    std::int32_t* row = outer_.data() + g * outer_stride_;
    std::size_t count = 0;
    near.for_each_near(own[0] - pose.tan_theta * (own[1] - pose.top), own[1], own[2],
                       [&](std::int32_t other) {
                         const double* p = rows + 4 * static_cast<std::size_t>(other);
                         const double dx = own[0] - p[0];
                         const double dy = own[1] - p[1];
                         const double dz = nearest_image(own[2] - p[2], depth_, per_depth);
                         if (!(dx * dx + dy * dy + dz * dz < cutoff)) return;
                         if (static_cast<std::size_t>(other) == g) return;
                         if (count < outer_stride_) row[count] = 4 * other;
                         ++count;
                       });
    if (count > outer_stride_ && outer_stride_ < kLargestStride) {
      outer_stride_ = std::min(kLargestStride, (count + 15) / 8 * 8);
      build(rows, grains, id, near, pose);
      return;
    }
    count = std::min(count, outer_stride_);
    std::sort(row, row + count, by_id);
    outer_count_[g] = static_cast<std::uint16_t>(count);
  }
}

void NeighbourLists::prune(const double* rows, std::size_t grains, const WallPose& pose) {
  inner_reference_.set(rows, grains, pose);
  const std::size_t blocks = (grains + kernels_.lanes - 1) / kernels_.lanes;
  slots_.resize(blocks);
  PruneTask task;
  task.grains = grains;
  task.rows = rows;
  task.outer = outer_.data();
  task.outer_stride = outer_stride_;
  task.outer_count = outer_count_.data();
  task.slots = slots_.data();
  task.padding = padding_offset(grains);
  task.depth = depth_;
  task.per_depth = 1 / depth_;
  task.cutoff_squared = settings_.inner_cutoff * settings_.inner_cutoff;
  for (;; inner_stride_ *= 2) {
    inner_.resize(blocks * kernels_.lanes * inner_stride_);
    task.inner = inner_.data();
    task.inner_stride = inner_stride_;
    if (kernels_.prune(task, 0, blocks)) return;
  }
}

std::size_t NeighbourLists::bytes() const {
  return 4 * (outer_.size() + inner_.size()) + 2 * (outer_count_.size() + slots_.size()) +
         6 * 8 * outer_count_.size();
}

}  // namespace shearcell
