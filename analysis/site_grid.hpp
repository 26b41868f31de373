// SPDX-License-Identifier: GPL-3.0-or-later
// Points sorted into boxes, periodic in z, so that those near a point are found in constant time.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace shearcell {

/// A fixed set of sites in x, y unbounded and in z periodic with a given depth. Lengths in d.
class SiteGrid {
 public:
  /// `sites` is 3 x n with z in [0, depth); `spacing` is the usual distance of neighbours and only
  /// decides how fast the search is. Throws AnalysisError when a coordinate is not finite.
  SiteGrid(Eigen::Matrix3Xd sites, double depth, double spacing);

  const Eigen::Matrix3Xd& sites() const { return sites_; }

  /// Calls visit(site, offset, distance squared) for every periodic image of every site nearer to
  /// `point` than `reach`, where offset = image position - point. A site that lies at `point`
  /// itself is visited too. In a fixed order.
  template <typename Visit>
  void visit_within(const Eigen::Vector3d& point, double reach, Visit&& visit) const;

 private:
  std::int64_t box_x(double x) const { return clamped((x - low_.x()) / edge_.x(), count_x_); }
  std::int64_t box_y(double y) const { return clamped((y - low_.y()) / edge_.y(), count_y_); }
  static std::int64_t clamped(double value, std::int64_t count) {
    return static_cast<std::int64_t>(std::clamp(value, 0.0, static_cast<double>(count - 1)));
  }

  struct Entry {
    double x, y, z;
    std::int32_t site;
  };

  Eigen::Matrix3Xd sites_;
  double depth_;
  Eigen::Vector3d low_;   // corner of the first box
  Eigen::Vector3d edge_;  // of one box
  std::int64_t count_x_ = 1;
  std::int64_t count_y_ = 1;
  std::int64_t count_z_ = 1;
  std::vector<std::int32_t> first_;  // of each box in entries_, boxes of one row side by side
  std::vector<Entry> entries_;
};

template <typename Visit>
void SiteGrid::visit_within(const Eigen::Vector3d& point, double reach, Visit&& visit) const {
  const double reach2 = reach * reach;
  const double outer = reach * (1 + 1e-9);  // so that rounding at a box's edge loses no site
  const std::int64_t x0 = box_x(point.x() - outer);
  const std::int64_t x1 = box_x(point.x() + outer);
  const std::int64_t y0 = box_y(point.y() - outer);
  const std::int64_t y1 = box_y(point.y() + outer);
  const auto z0 = static_cast<std::int64_t>(std::floor((point.z() - outer) / edge_.z()));
  const auto z1 = static_cast<std::int64_t>(std::floor((point.z() + outer) / edge_.z()));
  std::int64_t image = z0 >= 0 ? z0 / count_z_ : -((count_z_ - 1 - z0) / count_z_);
  std::int64_t row_z = z0 - image * count_z_;
  for (std::int64_t kz = z0; kz <= z1; ++kz) {
    const double shift = static_cast<double>(image) * depth_;
    for (std::int64_t ky = y0; ky <= y1; ++ky) {
      const std::int64_t row = (row_z * count_y_ + ky) * count_x_;
      const std::int32_t end = first_[static_cast<std::size_t>(row + x1 + 1)];
      for (std::int32_t k = first_[static_cast<std::size_t>(row + x0)]; k < end; ++k) {
        const Entry& entry = entries_[static_cast<std::size_t>(k)];
        const Eigen::Vector3d offset(entry.x - point.x(), entry.y - point.y(),
                                     (entry.z - point.z()) + shift);
        const double distance2 = offset.squaredNorm();
        if (distance2 < reach2) visit(entry.site, offset, distance2);
      }
    }
    if (++row_z == count_z_) {
      row_z = 0;
      ++image;
    }
  }
}

}  // namespace shearcell
