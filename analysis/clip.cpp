// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/clip.hpp"

#include <CGAL/MP_Float.h>
#include <CGAL/Mpzf.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <string>

#include "analysis/error.hpp"

namespace shearcell {
namespace {

#ifdef CGAL_HAS_MPZF
using Exact = CGAL::Mpzf;
#else
using Exact = CGAL::MP_Float;
#endif

// A corner with a larger error bound [d] is computed again in exact arithmetic: its three planes
// nearly share a line.
constexpr double worst_corner_error = 1e-10;

// The relative error of one operation in doubles.
constexpr double unit_roundoff = std::numeric_limits<double>::epsilon() / 2;

using ExactVector = Eigen::Matrix<Exact, 3, 1>;

Exact twice_offset(const HalfSpace& plane, const ExactVector& normal) {
  return plane.bisector ? normal.dot(normal) : Exact(2 * plane.offset);
}

/// The meeting point of three planes is numerator / (2 determinant), without rounding.
struct ExactCorner {
  ExactVector numerator;
  Exact determinant;
};

ExactCorner meet_exactly(const HalfSpace& a, const HalfSpace& b, const HalfSpace& c) {
  const ExactVector na = a.normal.cast<Exact>();
  const ExactVector nb = b.normal.cast<Exact>();
  const ExactVector nc = c.normal.cast<Exact>();
  const ExactVector bc = nb.cross(nc);
  return {twice_offset(a, na) * bc + twice_offset(b, nb) * nc.cross(na) +
              twice_offset(c, nc) * na.cross(nb),
          na.dot(bc)};
}

bool lies_outside(const ExactCorner& corner, const HalfSpace& plane) {
  const ExactVector normal = plane.normal.cast<Exact>();
  const Exact side =
      normal.dot(corner.numerator) - twice_offset(plane, normal) * corner.determinant;
  return CGAL::sign(side) * CGAL::sign(corner.determinant) == CGAL::POSITIVE;
}

Eigen::Vector3d rounded(const ExactCorner& corner) {
  const double scale = 2 * CGAL::to_double(corner.determinant);
  return corner.numerator.unaryExpr([&](const Exact& x) { return CGAL::to_double(x) / scale; });
}

/// Calls visit(a, b) for the three edges of a corner, each by two of its planes in turn.
template <class Visit>
void for_each_edge(const std::array<std::uint16_t, 3>& planes, const Visit& visit) {
  for (std::size_t e = 0; e < 3; ++e) visit(planes[e], planes[(e + 1) % 3]);
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
  corners_.clear();
  planes_.assign(box.begin(), box.end());
  if (stride_ < planes_.size()) grow_tables();
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
  corners_.push_back({v, error, t});
}

bool ConvexCell::is_outside(const Corner& corner, const HalfSpace& plane) const {
  const double value = plane.normal.dot(corner.position) - plane.offset;
  const double doubt = plane.length * corner.error + 8 * unit_roundoff * std::abs(plane.offset);
  if (std::abs(value) > doubt) return value > 0;
  const auto& [a, b, c] = corner.planes;
  return lies_outside(meet_exactly(planes_[a], planes_[b], planes_[c]), plane);
}

bool ConvexCell::clip(const HalfSpace& plane) {
  cut_.clear();
  for (std::size_t k = 0; k < corners_.size(); ++k) {
    if (is_outside(corners_[k], plane)) cut_.push_back(static_cast<std::uint16_t>(k));
  }
  if (cut_.empty()) return false;

  if (planes_.size() == most_planes) {
    throw AnalysisError("a Voronoi cell has more than " + std::to_string(most_planes) +
                        " neighbours: these grains are no packing");
  }
  if (planes_.size() == stride_) grow_tables();
  const auto index = static_cast<std::uint16_t>(planes_.size());
  planes_.push_back(plane);
  const auto mark_cut = [&](std::uint8_t mark) {
    for (const std::uint16_t k : cut_) {
      for_each_edge(corners_[k].planes, [&](auto a, auto b) { marked_[pair(a, b)] = mark; });
    }
  };
  mark_cut(1);
  fresh_.clear();
  for (const std::uint16_t k : cut_) {
    for_each_edge(corners_[k].planes, [&](auto a, auto b) {
      if (marked_[pair(b, a)] == 0) fresh_.push_back({a, b, index});
    });
  }
  mark_cut(0);
  for (std::size_t k = cut_.size(); k-- > 0;) {
    corners_[cut_[k]] = corners_.back();
    corners_.pop_back();
  }
  for (const Triple& t : fresh_) add_corner(t);
  return true;
}

double ConvexCell::measure(std::vector<double>& areas) {
  areas.assign(planes_.size(), 0.0);
  for (std::size_t k = 0; k < corners_.size(); ++k) {
    for_each_edge(corners_[k].planes,
                  [&](auto a, auto b) { owner_[pair(a, b)] = static_cast<std::uint16_t>(k); });
  }
  // An edge lies in two faces. Edge and origin span a triangle. Its projection on the plane of a
  // face is the triangle of the edge and the foot of the origin; these triangles sum to the face.
  for (std::size_t k = 0; k < corners_.size(); ++k) {
    for_each_edge(corners_[k].planes, [&](auto a, auto b) {
      if (a > b) return;
      const Eigen::Vector3d twice =
          corners_[owner_[pair(b, a)]].position.cross(corners_[k].position);
      areas[a] += planes_[a].normal.dot(twice);
      areas[b] -= planes_[b].normal.dot(twice);
    });
  }
  double volume = 0;
  for (std::size_t p = 0; p < planes_.size(); ++p) {
    areas[p] /= 2 * planes_[p].length;
    volume += areas[p] * planes_[p].offset / planes_[p].length;
  }
  return volume / 3;
}

}  // namespace shearcell
