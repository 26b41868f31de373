// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/clip.hpp"

#include <CGAL/MP_Float.h>
#include <CGAL/Mpzf.h>

#include <cmath>

#include "analysis/rounding.hpp"

namespace shearcell {
namespace {

#ifdef CGAL_HAS_MPZF
using Exact = CGAL::Mpzf;
#else
using Exact = CGAL::MP_Float;
#endif

// Above this the corner is computed again in exact arithmetic: its three planes nearly share a
// line.
constexpr double worst_corner_error = 1e-10;

struct ExactVector {
  Exact x, y, z;
};

ExactVector exact(const Eigen::Vector3d& v) {
  return {Exact(v.x()), Exact(v.y()), Exact(v.z())};
}

ExactVector cross(const ExactVector& a, const ExactVector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

Exact dot(const ExactVector& a, const ExactVector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

Exact twice_offset(const HalfSpace& plane, const ExactVector& normal) {
  return plane.bisector ? dot(normal, normal) : Exact(2 * plane.offset);
}

/// The meeting point of three planes is numerator / (2 determinant), without rounding.
struct ExactCorner {
  ExactVector numerator;
  Exact determinant;
};

ExactCorner meet_exactly(const HalfSpace& a, const HalfSpace& b, const HalfSpace& c) {
  const ExactVector na = exact(a.normal);
  const ExactVector nb = exact(b.normal);
  const ExactVector nc = exact(c.normal);
  const ExactVector bc = cross(nb, nc);
  const ExactVector ca = cross(nc, na);
  const ExactVector ab = cross(na, nb);
  const Exact wa = twice_offset(a, na);
  const Exact wb = twice_offset(b, nb);
  const Exact wc = twice_offset(c, nc);
  return {{wa * bc.x + wb * ca.x + wc * ab.x, wa * bc.y + wb * ca.y + wc * ab.y,
           wa * bc.z + wb * ca.z + wc * ab.z},
          dot(na, bc)};
}

bool lies_outside(const ExactCorner& corner, const HalfSpace& plane) {
  const ExactVector normal = exact(plane.normal);
  const Exact side =
      dot(normal, corner.numerator) - twice_offset(plane, normal) * corner.determinant;
  const auto sign = CGAL::sign(side);
  return CGAL::sign(corner.determinant) == CGAL::NEGATIVE ? sign == CGAL::NEGATIVE
                                                          : sign == CGAL::POSITIVE;
}

Eigen::Vector3d rounded(const ExactCorner& corner) {
  const double scale = 2 * CGAL::to_double(corner.determinant);
  return {CGAL::to_double(corner.numerator.x) / scale, CGAL::to_double(corner.numerator.y) / scale,
          CGAL::to_double(corner.numerator.z) / scale};
}

}  // namespace

HalfSpace bisector_to(const Eigen::Vector3d& site) {
  const double distance2 = site.squaredNorm();
  return {site, distance2 / 2, std::sqrt(distance2), true};
}

HalfSpace plane_at(const Eigen::Vector3d& normal, double offset) {
  return {normal, offset, 1.0, false};
}

void ConvexCell::reset(const std::array<HalfSpace, 6>& box) {
  count_ = 0;
  planes_.assign(box.begin(), box.end());
  if (stride_ < planes_.size()) grow_tables();
  grow_corners(8);
  for (unsigned k = 0; k < 8; ++k) {
    const auto x = static_cast<std::uint16_t>(k & 1U);
    const auto y = static_cast<std::uint16_t>(2 + ((k >> 1U) & 1U));
    const auto z = static_cast<std::uint16_t>(4 + ((k >> 2U) & 1U));
    const bool right_handed = (x + y + z) % 2 == 1;
    add_corner(right_handed ? Triple{x, y, z} : Triple{y, x, z});
  }
}

void ConvexCell::grow_tables() {
  stride_ = stride_ == 0 ? 64 : 2 * stride_;
  marked_.assign(stride_ * stride_, 0);
  owner_.assign(stride_ * stride_, 0);
}

void ConvexCell::grow_corners(std::size_t count) {
  if (count <= x_.size()) return;
  const std::size_t size = 2 * count;
  for (std::vector<double>* list : {&x_, &y_, &z_, &error_}) list->resize(size);
  triples_.resize(size);
}

void ConvexCell::add_corner(Triple t) {
  const HalfSpace& a = planes_[t[0]];
  const HalfSpace& b = planes_[t[1]];
  const HalfSpace& c = planes_[t[2]];
  const Eigen::Vector3d bc = b.normal.cross(c.normal);
  const Eigen::Vector3d ca = c.normal.cross(a.normal);
  const Eigen::Vector3d ab = a.normal.cross(b.normal);
  const double inverse = 1 / a.normal.dot(bc);
  Eigen::Vector3d v = (a.offset * bc + b.offset * ca + c.offset * ab) * inverse;

  // Forward error of Cramer's rule: numerator and determinant each lose a few roundoffs of the sum
  // of the sizes of their terms. 24 covers the operations counted one by one.
  const double terms = std::abs(a.offset) * b.length * c.length +
                       std::abs(b.offset) * c.length * a.length +
                       std::abs(c.offset) * a.length * b.length;
  double error =
      24 * unit_roundoff * inverse * (terms + v.lpNorm<1>() * a.length * b.length * c.length);
  if (!(error >= 0 && error <= worst_corner_error)) {
    v = rounded(meet_exactly(a, b, c));
    error = 8 * unit_roundoff * v.lpNorm<1>();
  }
  x_[count_] = v.x();
  y_[count_] = v.y();
  z_[count_] = v.z();
  error_[count_] = error;
  triples_[count_] = t;
  ++count_;
}

void ConvexCell::remove_corner(std::size_t k) {
  --count_;
  x_[k] = x_[count_];
  y_[k] = y_[count_];
  z_[k] = z_[count_];
  error_[k] = error_[count_];
  triples_[k] = triples_[count_];
}

bool ConvexCell::outside_exactly(std::size_t k, const HalfSpace& plane) const {
  const Triple& t = triples_[k];
  return lies_outside(meet_exactly(planes_[t[0]], planes_[t[1]], planes_[t[2]]), plane);
}

void ConvexCell::find_outside(const HalfSpace& plane) {
  const double slack = 8 * unit_roundoff * std::abs(plane.offset);
  const double nx = plane.normal.x();
  const double ny = plane.normal.y();
  const double nz = plane.normal.z();
  cut_.clear();
  for (std::size_t k = 0; k < count_; ++k) {
    const double value = nx * x_[k] + ny * y_[k] + nz * z_[k] - plane.offset;
    const double doubt = plane.length * error_[k] + slack;
    if (value < -doubt) continue;
    if (value > doubt || outside_exactly(k, plane)) cut_.push_back(static_cast<std::uint16_t>(k));
  }
}

bool ConvexCell::clip(const HalfSpace& plane) {
  find_outside(plane);
  if (cut_.empty()) return false;

  if (planes_.size() == stride_) grow_tables();
  const auto index = static_cast<std::uint16_t>(planes_.size());
  planes_.push_back(plane);
  for (const std::uint16_t k : cut_) {
    const Triple& t = triples_[k];
    marked_[pair(t[0], t[1])] = 1;
    marked_[pair(t[1], t[2])] = 1;
    marked_[pair(t[2], t[0])] = 1;
  }
  fresh_.clear();
  for (const std::uint16_t k : cut_) {
    const Triple& t = triples_[k];
    if (marked_[pair(t[1], t[0])] == 0) fresh_.push_back({t[0], t[1], index});
    if (marked_[pair(t[2], t[1])] == 0) fresh_.push_back({t[1], t[2], index});
    if (marked_[pair(t[0], t[2])] == 0) fresh_.push_back({t[2], t[0], index});
  }
  for (const std::uint16_t k : cut_) {
    const Triple& t = triples_[k];
    marked_[pair(t[0], t[1])] = 0;
    marked_[pair(t[1], t[2])] = 0;
    marked_[pair(t[2], t[0])] = 0;
  }
  for (std::size_t k = cut_.size(); k-- > 0;) remove_corner(cut_[k]);
  grow_corners(count_ + fresh_.size());
  for (const Triple& t : fresh_) add_corner(t);
  return true;
}

double ConvexCell::measure(std::vector<double>& areas) {
  areas.assign(planes_.size(), 0.0);
  for (std::size_t k = 0; k < count_; ++k) {
    const Triple& t = triples_[k];
    for (std::size_t e = 0; e < 3; ++e) {
      owner_[pair(t[e], t[(e + 1) % 3])] = static_cast<std::uint16_t>(k);
    }
  }
  // An edge lies in two faces. With the origin as apex it spans a triangle, whose projections on
  // the two planes are the triangles that it spans with their foot points: those sum to the faces.
  for (std::size_t k = 0; k < count_; ++k) {
    const Triple& t = triples_[k];
    for (std::size_t e = 0; e < 3; ++e) {
      const std::uint16_t a = t[e];
      const std::uint16_t b = t[(e + 1) % 3];
      if (a > b) continue;
      const Eigen::Vector3d twice = corner(owner_[pair(b, a)]).cross(corner(k));
      areas[a] += planes_[a].normal.dot(twice);
      areas[b] -= planes_[b].normal.dot(twice);
    }
  }
  double volume = 0;
  for (std::size_t p = 0; p < planes_.size(); ++p) {
    areas[p] /= 2 * planes_[p].length;
    volume += areas[p] * planes_[p].offset / planes_[p].length;
  }
  return volume / 3;
}

}  // namespace shearcell
