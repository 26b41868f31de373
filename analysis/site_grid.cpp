// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/site_grid.hpp"

#include <utility>

#include "analysis/error.hpp"

namespace shearcell {
namespace {

// Boxes a little smaller than the spacing: a search then looks at few sites outside its sphere.
constexpr double boxes_per_spacing = 1.15;
// Sites in a large, nearly empty region must not cost memory without bound.
constexpr double boxes_per_axis_limit = 400;

std::int64_t box_count(double length, double spacing) {
  const double wanted = length * boxes_per_spacing / spacing;
  return static_cast<std::int64_t>(std::clamp(std::floor(wanted), 1.0, boxes_per_axis_limit));
}

}  // namespace

SiteGrid::SiteGrid(Eigen::Matrix3Xd sites, double depth, double spacing)
    : sites_(std::move(sites)), depth_(depth), low_(Eigen::Vector3d::Zero()) {
  Eigen::Vector3d high(1, 1, depth);
  if (!sites_.allFinite()) throw AnalysisError("a grain or wall grain has no finite position");
  if (sites_.cols() > 0) {
    low_.head<2>() = sites_.topRows<2>().rowwise().minCoeff();
    high.head<2>() = sites_.topRows<2>().rowwise().maxCoeff();
  }
  // A set of one point has no extent; any edge above zero serves.
  const Eigen::Vector3d length = (high - low_).cwiseMax(1e-6);
  count_x_ = box_count(length.x(), spacing);
  count_y_ = box_count(length.y(), spacing);
  count_z_ = box_count(depth, spacing);
  edge_ << length.x() / static_cast<double>(count_x_), length.y() / static_cast<double>(count_y_),
      depth / static_cast<double>(count_z_);

  const auto box_of = [this](Eigen::Index site) {
    const Eigen::Vector3d p = sites_.col(site);
    const std::int64_t z = clamped(p.z() / edge_.z(), count_z_);
    return static_cast<std::size_t>((z * count_y_ + box_y(p.y())) * count_x_ + box_x(p.x()));
  };
  first_.assign(static_cast<std::size_t>(count_x_ * count_y_ * count_z_) + 1, 0);
  for (Eigen::Index i = 0; i < sites_.cols(); ++i) ++first_[box_of(i) + 1];
  for (std::size_t box = 1; box < first_.size(); ++box) first_[box] += first_[box - 1];
  std::vector<std::int32_t> next(first_.begin(), first_.end() - 1);
  entries_.resize(static_cast<std::size_t>(sites_.cols()));
  for (Eigen::Index i = 0; i < sites_.cols(); ++i) {
    entries_[static_cast<std::size_t>(next[box_of(i)]++)] = {
        sites_(0, i), sites_(1, i), sites_(2, i), static_cast<std::int32_t>(i)};
  }
}

}  // namespace shearcell
