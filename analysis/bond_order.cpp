// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/bond_order.hpp"

#include <array>
#include <cmath>

namespace shearcell {
namespace {

// (4 pi / 13) times the square of the coefficient of Y_6m, for m = 0..6. Orders m and -m give equal
// squares, so those above 0 count twice.
constexpr std::array<double, 7> order_weight = {
    1.0 / 256,        2 * 42.0 / 256,    2 * 420.0 / 4096, 2 * 420.0 / 1024,
    2 * 126.0 / 1024, 2 * 2772.0 / 1024, 2 * 924.0 / 4096};

/// Sums over bonds of w Y_6m(x, y, z) without its coefficient: (x + iy)^m times a polynomial in z.
struct HarmonicSums {
  double order0 = 0;
  std::array<double, 6> real{};
  std::array<double, 6> imaginary{};

  void add(double weight, double x, double y, double z) {
    const double z2 = z * z;
    const std::array<double, 6> polynomial = {z * ((33 * z2 - 30) * z2 + 5),
                                              (33 * z2 - 18) * z2 + 1,
                                              z * (11 * z2 - 3),
                                              11 * z2 - 1,
                                              z,
                                              1};
    order0 += weight * (((231 * z2 - 315) * z2 + 105) * z2 - 5);
    double re = x;
    double im = y;
    for (std::size_t m = 0; m < 6; ++m) {
      real[m] += weight * polynomial[m] * re;
      imaginary[m] += weight * polynomial[m] * im;
      const double next = re * x - im * y;
      im = re * y + im * x;
      re = next;
    }
  }

  double norm() const {
    double sum = order_weight[0] * order0 * order0;
    for (std::size_t m = 0; m < 6; ++m) {
      sum += order_weight[m + 1] * (real[m] * real[m] + imaginary[m] * imaginary[m]);
    }
    return std::sqrt(sum);
  }
};

}  // namespace

double bond_order_q6(std::span<const VoronoiFace> faces, double surface) {
  HarmonicSums sums;
  for (const VoronoiFace& face : faces) {
    if (face.kind == NeighbourKind::wall_plane) continue;
    const Eigen::Vector3d bond = face.to_neighbour / face.to_neighbour.norm();
    sums.add(face.area / surface, bond.x(), bond.y(), bond.z());
  }
  return sums.norm();
}

std::vector<double> bond_order_q6(const VoronoiDiagram& diagram) {
  std::vector<double> q6(diagram.volume.size());
  for (std::size_t i = 0; i < q6.size(); ++i) {
    q6[i] = bond_order_q6(diagram.faces_of(i), diagram.surface[i]);
  }
  return q6;
}

}  // namespace shearcell
