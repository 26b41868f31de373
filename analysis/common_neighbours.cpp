// SPDX-License-Identifier: GPL-3.0-or-later
// Lattice of each grain by common neighbour analysis. Wall grains count as neighbours.

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <numbers>
#include <span>
#include <tuple>

#include "analysis/measures.hpp"
#include "analysis/near_grains.hpp"
#include "analysis/voronoi.hpp"

namespace shearcell {
namespace {

enum class Lattice : std::uint8_t { none, fcc, hcp, bcc };

constexpr double kReach = 1.5;  // [d]; the 14 nearest neighbours in BCC are within 1.2 d
constexpr std::size_t kMost = 14;
using Bonds = std::array<std::uint32_t, kMost>;  // bit b of entry a: neighbours a and b are bonded

// Longest bond, relative to the radius of the first FCC shell: halfway to the second shell.
const double kCut = 0.5 * (1 + std::numbers::sqrt2);

struct Neighbour {
  std::int32_t site;
  double distance;             // [d]
  Eigen::Vector3d separation;  // from the grain to the neighbour's nearest image [d]
};

// Neighbours of each grain, sorted by distance and, at equal distance, by site number.
std::vector<std::vector<Neighbour>> neighbours_of_all(const Cell& cell, const WallPose& pose,
                                                      const Eigen::Matrix3Xd& grains) {
  std::vector<std::vector<Neighbour>> near(static_cast<std::size_t>(grains.cols()));
  for (std::vector<Neighbour>& of_grain : near) of_grain.reserve(20);  // few grains have more
  const auto add = [&](std::int32_t site, std::int32_t other, const Eigen::Vector3d& separation) {
    const auto grain = static_cast<std::size_t>(site);
    if (grain < near.size()) near[grain].push_back({other, separation.norm(), separation});
  };
  for_each_pair(cell, pose, wrapped_sites(cell, pose, grains), kReach,
                [&](std::int32_t i, std::int32_t j, const Eigen::Vector3d& r) {
                  add(i, j, -r);
                  add(j, i, r);
                });
  for (std::vector<Neighbour>& of_grain : near) {
    std::ranges::sort(of_grain, {},
                      [](const Neighbour& n) { return std::tie(n.distance, n.site); });
  }
  return near;
}

Bonds find_bonds(std::span<const Neighbour> near, double cut) {
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

// Number of bonds between the neighbours in the bit set `members`.
int bonds_among(const Bonds& bonds, std::uint32_t members) {
  int ends = 0;
  for (std::size_t a = 0; a < kMost; ++a) {
    if ((members >> a & 1U) != 0) ends += std::popcount(bonds[a] & members);
  }
  return ends / 2;
}

// Number of bonds in the largest connected group of neighbours in `members`.
int longest_chain(const Bonds& bonds, std::uint32_t members) {
  int longest = 0;
  while (members != 0) {
    std::uint32_t part = members & (~members + 1), grown = 0;
    while (part != grown) {
      grown = part;
      for (std::size_t a = 0; a < kMost; ++a) {
        if ((grown >> a & 1U) != 0) part |= bonds[a] & members;
      }
    }
    longest = std::max(longest, bonds_among(bonds, part));
    members &= ~part;
  }
  return longest;
}

// Indices of Honeycutt and Andersen, J. Phys. Chem. 91, 4950 (1987), for a grain and one neighbour:
// number of common neighbours, number of bonds between common neighbours, and number of bonds in
// the longest chain of these bonds. The three digits form one number, such as 421.
int signature(const Bonds& bonds, std::size_t neighbour) {
  const std::uint32_t common = bonds[neighbour];
  return 100 * std::popcount(common) + 10 * bonds_among(bonds, common) +
         longest_chain(bonds, common);
}

// Numbers of neighbours with the signatures `first` and `second`; {0, 0} if a neighbour has another
// signature.
std::array<int, 2> count_signatures(std::span<const Neighbour> near, double cut, int first,
                                    int second) {
  const Bonds bonds = find_bonds(near, cut);
  std::array<int, 2> counts{};
  for (std::size_t a = 0; a < near.size(); ++a) {
    const int found = signature(bonds, a);
    if (found != first && found != second) return {};
    ++counts[found == first ? 0 : 1];
  }
  return counts;
}

// The lattice of a grain with these neighbours. FCC and HCP are recognized by the 12 nearest
// neighbours, BCC by 14. Two neighbours are bonded if they are at most kCut * L apart. For FCC and
// HCP, L is the mean distance of the 12 neighbours from the grain. For BCC, L is the side of the
// cubic cell, estimated from the distances of all 14 neighbours (8 first and 6 second neighbours)
// from the grain.
Lattice lattice_of(std::span<const Neighbour> near) {
  if (near.size() < 12) return Lattice::none;
  double mean = 0, side = 0;
  for (const Neighbour& neighbour : near.first(12)) mean += neighbour.distance / 12;
  const auto [cubic, hexagonal] = count_signatures(near.first(12), kCut * mean, 421, 422);
  if (cubic == 12) return Lattice::fcc;
  if (cubic == 6 && hexagonal == 6) return Lattice::hcp;
  if (near.size() < kMost) return Lattice::none;
  for (std::size_t a = 0; a < kMost; ++a) {
    side += near[a].distance * (a < 8 ? 2 / std::numbers::sqrt3 : 1) / 14;
  }
  const auto [first, second] = count_signatures(near.first(kMost), kCut * side, 666, 444);
  return first == 8 && second == 6 ? Lattice::bcc : Lattice::none;
}

/// Adaptive common neighbour analysis of each grain (Stukowski, Modelling Simul. Mater. Sci. Eng.
/// 20, 045021 (2012)). Wall grains are neighbours too. A grain with fewer than 12 neighbours within
/// 1.5 d has no lattice.
std::vector<Lattice> lattices_of(const Checkpoint& c) {
  std::vector<Lattice> lattices;
  for (const auto& near : neighbours_of_all(c.cell, pose_of(c), c.state.position)) {
    lattices.push_back(lattice_of(near));
  }
  return lattices;
}

}  // namespace

std::vector<Provider> lattice_providers() {
  const auto compute = [](const MeasureInput& input) -> nlohmann::json {
    const std::vector<Lattice> lattice = lattices_of(*input.checkpoint);
    const auto percent = [&](Lattice wanted) {
      return percent_of(input.analysis->grains.interior,
                        [&](std::size_t i) { return lattice[i] == wanted; });
    };
    const double fcc = percent(Lattice::fcc), hcp = percent(Lattice::hcp);
    return {{"cna_crystalline_percent", fcc + hcp},
            {"cna_fcc_percent", fcc},
            {"cna_hcp_percent", hcp},
            {"cna_bcc_percent", percent(Lattice::bcc)}};
  };
  return {{.name = "lattices",
           .parameters = interior_criteria(),
           .measures =
               {{"cna_crystalline_percent", "%",
                 "percentage of interior grains that are FCC or HCP, by common neighbour analysis"},
                {"cna_fcc_percent", "%",
                 "percentage of interior grains that are FCC, by common neighbour analysis"},
                {"cna_hcp_percent", "%",
                 "percentage of interior grains that are HCP, by common neighbour analysis"},
                {"cna_bcc_percent", "%",
                 "percentage of interior grains that are BCC, by common neighbour analysis"}},
           .compute = compute},
          {.name = "grain_lattices",
           .measures = {of_grains(
               "lattice", "1", "by common neighbours: 0 = none, 1 = FCC, 2 = HCP, 3 = BCC",
               "lattice by common neighbours",
               {.classes = {"none", "FCC", "HCP", "BCC"}, .whole = true, .of_wall_grains = -1})},
           .compute = [](const MeasureInput& input) {
             return nlohmann::json{{"lattice", lattices_of(*input.checkpoint)}};
           }}};
}

}  // namespace shearcell
