// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/neighbour_lists.hpp"

#include <algorithm>
#include <cmath>

namespace shearcell {
void Reference::set(const double* rows, std::size_t grains, const WallPose& pose) {
  pose_ = pose;
  for (auto& axis : at_) axis.resize(padded(grains));
  double largest = 0;
  for (std::size_t g = 0; g < grains; ++g) {
    const double* p = rows + 4 * g;
    largest = std::max({largest, std::fabs(p[0]), std::fabs(p[1]), std::fabs(p[2])});
    at_[0][g] = static_cast<float>(p[0] - pose.tan_theta * (p[1] - pose.top));
    at_[1][g] = static_cast<float>(p[1]);
    at_[2][g] = static_cast<float>(p[2]);
  }
  rounding_ = 0x1p-22 * largest;  // half a unit in the last place is 2^-25 of a coordinate at most
}

double Reference::farthest(const double* rows, std::size_t grains, const WallPose& pose) const {
  double square = 0;
  for (std::size_t g = 0; g < grains; ++g) {
    const double* p = rows + 4 * g;
    const double y = double{at_[1][g]};
    const double wx = p[0] - (double{at_[0][g]} + pose.tan_theta * (y - pose.top));
    const double wy = p[1] - y;
    const double wz = p[2] - double{at_[2][g]};
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

NeighbourLists::NeighbourLists(const Kernels& kernels, const ListSettings& settings, double depth,
                               Team& team)
    : kernels_(kernels), team_(team), settings_(settings), depth_(depth) {}

bool NeighbourLists::inner_valid(double farthest, const WallPose& pose) const {
  if (settings_.rebuild_every_step) return false;
  const double moved =
      std::max(farthest, inner_reference_.wall_travel(pose)) + inner_reference_.rounding();
  return settings_.inner_cutoff * inner_reference_.stretch(pose) - 2 * moved > 1.0 + 1e-9;
}

bool NeighbourLists::outer_valid(const double* rows, std::size_t grains,
                                 const WallPose& pose) const {
  if (settings_.rebuild_every_step) return false;
  const double moved =
      std::max(outer_reference_.farthest(rows, grains, pose), outer_reference_.wall_travel(pose)) +
      outer_reference_.rounding();
  return settings_.outer_cutoff * outer_reference_.stretch(pose) - 2 * moved >
         settings_.inner_cutoff + 1e-9;
}

void NeighbourLists::build(const double* rows, const std::vector<std::int32_t>& id,
                           const CellOrder& order, const WallPose& pose) {
  const std::size_t grains = id.size();
  outer_reference_.set(rows, grains, pose);
  offset_of_id_.resize(grains);
  for (std::size_t g = 0; g < grains; ++g) {
    offset_of_id_[static_cast<std::size_t>(id[g])] = static_cast<std::int32_t>(4 * g);
  }
  outer_count_.resize(grains);
  SearchTask task;
  task.grid = order.grid();
  task.offset_of_id = offset_of_id_.data();
  task.count = outer_count_.data();
  task.padding = padding_offset(grains);
  task.depth = depth_;
  task.per_depth = 1 / depth_;
  task.cutoff_squared = settings_.outer_cutoff * settings_.outer_cutoff;
  for (;;) {
    outer_.resize(grains * outer_stride_);
    task.outer = outer_.data();
    task.stride = outer_stride_;
    std::vector<std::size_t> longest(team_.size(), 0);
    team_.run(grains, [&](std::size_t thread, std::size_t first, std::size_t last) {
      longest[thread] = kernels_.search(task, first, last);
    });
    const std::size_t most = *std::max_element(longest.begin(), longest.end());
    if (most <= outer_stride_) return;
    outer_stride_ = padded(most + 8);
  }
}

void NeighbourLists::prune(const double* rows, std::size_t grains, const WallPose& pose) {
  inner_reference_.set(rows, grains, pose);
  const std::size_t blocks = (grains + kernels_.lanes - 1) / kernels_.lanes;
  slots_.resize(blocks);
  seam_.resize(blocks);
  begin_.resize(blocks);
  PruneTask task;
  task.grains = grains;
  task.rows = rows;
  task.outer = outer_.data();
  task.outer_stride = outer_stride_;
  task.outer_count = outer_count_.data();
  inner_count_.resize(padded(grains));
  task.inner_count = inner_count_.data();
  task.slots = slots_.data();
  task.seam = seam_.data();
  task.begin = begin_.data();
  task.padding = padding_offset(grains);
  task.depth = depth_;
  task.per_depth = 1 / depth_;
  task.cutoff_squared = settings_.inner_cutoff * settings_.inner_cutoff;
  for (;; inner_stride_ *= 2) {
    inner_.resize(blocks * kernels_.lanes * inner_stride_);
    task.inner = inner_.data();
    task.inner_stride = inner_stride_;
    std::vector<char> fits(team_.size(), 0);
    team_.run(blocks, [&](std::size_t thread, std::size_t first, std::size_t last) {
      fits[thread] = kernels_.prune(task, first, last) ? 1 : 0;
    });
    if (std::count(fits.begin(), fits.end(), 0) == 0) return;
  }
}

std::size_t NeighbourLists::bytes() const {
  return 4 * (outer_.size() + inner_.size() + offset_of_id_.size()) + 4 * outer_count_.size() +
         7 * slots_.size() + std::size_t{24} * outer_count_.size();
}

}  // namespace shearcell
