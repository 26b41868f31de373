// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/common_neighbours.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

#include "analysis/near_grains.hpp"
#include "analysis/voronoi.hpp"

namespace shearcell {
namespace {

constexpr double kReach = 1.5;  // [d]; the 14 nearest neighbours in BCC are within 1.2
constexpr std::size_t kMost = 14;
using Bonds = std::array<std::uint32_t, kMost>;  // a bit for each neighbour it is bonded to

// Between the first and the second shell of FCC, as a multiple of the first.
const double kCut = 0.5 * (1 + std::numbers::sqrt2);

Bonds find_bonds(std::span<const NearGrain> near, double cut) {
  Bonds bonds{};
  for (std::size_t a = 0; a < near.size(); ++a) {
    for (std::size_t b = a + 1; b < near.size(); ++b) {
      if ((near[a].separation - near[b].separation).squaredNorm() > cut * cut) continue;
      bonds[a] |= 1U << b;
      bonds[b] |= 1U << a;
    }
  }
  return bonds;
}

// Bonds in the largest connected part of the graph that the neighbours `members` form.
int longest_chain(const Bonds& bonds, std::uint32_t members) {
  int longest = 0;
  for (std::uint32_t left = members; left != 0;) {
    std::uint32_t part = left & (~left + 1), grown = 0;
    while (part != grown) {
      grown = part;
      for (std::uint32_t rest = grown; rest != 0; rest &= rest - 1) {
        part |= bonds[static_cast<std::size_t>(std::countr_zero(rest))] & members;
      }
    }
    int ends = 0;
    for (std::uint32_t rest = part; rest != 0; rest &= rest - 1) {
      ends += std::popcount(bonds[static_cast<std::size_t>(std::countr_zero(rest))] & part);
    }
    longest = std::max(longest, ends / 2);
    left &= ~part;
  }
  return longest;
}

// The indices of Honeycutt and Andersen, J. Phys. Chem. 91, 4950 (1987), of a pair of neighbours:
// common neighbours, bonds among them, bonds of the longest chain; 421 as one number.
int signature(const Bonds& bonds, std::size_t neighbour) {
  const std::uint32_t common = bonds[neighbour];
  int ends = 0;
  for (std::uint32_t rest = common; rest != 0; rest &= rest - 1) {
    ends += std::popcount(bonds[static_cast<std::size_t>(std::countr_zero(rest))] & common);
  }
  return 100 * std::popcount(common) + 10 * (ends / 2) + longest_chain(bonds, common);
}

Lattice close_packed(std::span<const NearGrain> near) {
  double mean = 0;
  for (const NearGrain& neighbour : near) mean += neighbour.distance / 12;
  const Bonds bonds = find_bonds(near, kCut * mean);
  int cubic = 0, hexagonal = 0;
  for (std::size_t a = 0; a < near.size(); ++a) {
    if (std::popcount(bonds[a]) != 4) return Lattice::none;
    const int found = signature(bonds, a);
    cubic += found == 421 ? 1 : 0;
    hexagonal += found == 422 ? 1 : 0;
  }
  if (cubic == 12) return Lattice::fcc;
  return cubic == 6 && hexagonal == 6 ? Lattice::hcp : Lattice::none;
}

Lattice body_centred(std::span<const NearGrain> near) {
  double side = 0;  // of the cubic cell, from both shells
  for (std::size_t a = 0; a < near.size(); ++a) {
    side += near[a].distance * (a < 8 ? 2 / std::numbers::sqrt3 : 1) / 14;
  }
  const Bonds bonds = find_bonds(near, kCut * side);
  int first_shell = 0, second_shell = 0;
  for (std::size_t a = 0; a < near.size(); ++a) {
    const int common = std::popcount(bonds[a]);
    if (common != 6 && common != 4) return Lattice::none;
    const int found = signature(bonds, a);
    first_shell += found == 666 ? 1 : 0;
    second_shell += found == 444 ? 1 : 0;
  }
  return first_shell == 8 && second_shell == 6 ? Lattice::bcc : Lattice::none;
}

}  // namespace

std::vector<Lattice> common_neighbour_analysis(const Cell& cell, const WallPose& pose,
                                               const Eigen::Matrix3Xd& grains) {
  const auto count = static_cast<std::size_t>(grains.cols());
  const NearGrains near(cell, pose, wrapped_sites(cell, pose, grains), count, kReach);
  std::vector<Lattice> lattice(count, Lattice::none);
  for (std::size_t i = 0; i < count; ++i) {
    const auto neighbours = near.of(i);
    if (neighbours.size() >= 12) lattice[i] = close_packed(neighbours.first(12));
    if (lattice[i] == Lattice::none && neighbours.size() >= kMost) {
      lattice[i] = body_centred(neighbours.first(kMost));
    }
  }
  return lattice;
}

}  // namespace shearcell
