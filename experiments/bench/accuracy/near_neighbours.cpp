// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/accuracy/near_neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "analysis/bond_order.hpp"
#include "analysis/measures.hpp"
#include "analysis/voronoi.hpp"
#include "core/contact.hpp"
#include "core/linked_cells.hpp"

namespace shearcell::accuracy {
namespace {

constexpr double kSearch = 1.6;  // [d]

VoronoiFace bond(const Eigen::Vector3d& to) {
  return {to, 1, 0, NeighbourKind::grain};
}

}  // namespace

std::vector<double> q6_of_near(const Cell& cell, const WallPose& pose,
                               const Eigen::Matrix3Xd& grains, const NeighbourRule& rule) {
  const Eigen::Matrix3Xd sites = wrapped_sites(cell, pose, grains);
  const double reach = (rule.most == 0 ? rule.cutoff : kSearch);
  const auto untilted = [&](Eigen::Index s) {
    return sites(0, s) - pose.tan_theta * (sites(1, s) - pose.top);
  };
  LinkedCells near(cell.width, pose.bottom, pose.top, cell.depth,
                   reach * std::sqrt(1 + pose.tan_theta * pose.tan_theta),
                   static_cast<std::size_t>(sites.cols()));
  for (Eigen::Index s = 0; s < sites.cols(); ++s) {
    near.insert(static_cast<std::int32_t>(s), untilted(s), sites(1, s), sites(2, s));
  }
  std::vector<double> q6;
  std::vector<std::pair<double, VoronoiFace>> found;
  std::vector<VoronoiFace> bonds;
  for (Eigen::Index i = 0; i < grains.cols(); ++i) {
    found.clear();
    near.for_each_near(untilted(i), sites(1, i), sites(2, i), [&](std::int32_t j) {
      Eigen::Vector3d to = sites.col(j) - sites.col(i);
      to.z() = nearest_image(to.z(), cell.depth, 1 / cell.depth);
      const double square = to.squaredNorm();
      if (j != i && square < reach * reach) found.emplace_back(square, bond(to));
    });
    if (rule.most > 0 && found.size() > rule.most) {
      const auto by_distance = [](const auto& a, const auto& b) { return a.first < b.first; };
      std::nth_element(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(rule.most),
                       found.end(), by_distance);
      found.resize(rule.most, {0, bond({})});
    }
    bonds.clear();
    for (const auto& [square, face] : found) bonds.push_back(face);
    q6.push_back(bonds.empty() ? 0 : bond_order_q6(bonds, static_cast<double>(bonds.size())));
  }
  return q6;
}

OrderError order_error(const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& grains,
                       const NeighbourRule& rule) {
  const Analysis exact = analyse(cell, pose, grains);
  const std::vector<double> q6 = q6_of_near(cell, pose, grains, rule);
  double squares = 0, crystalline = 0, interior = 0;
  for (std::size_t i = 0; i < q6.size(); ++i) {
    if (exact.grains.interior[i] == 0) continue;
    ++interior;
    squares += (q6[i] - exact.grains.q6[i]) * (q6[i] - exact.grains.q6[i]);
    constexpr double dense = 1;  // passes the criterion of density, which this rule cannot test
    crystalline += structure(dense, q6[i]) == Structure::disordered ? 0 : 1;
  }
  if (interior == 0) return {};
  return {std::sqrt(squares / interior),
          100 * crystalline / interior - exact.measures.crystalline_percent};
}

}  // namespace shearcell::accuracy
