// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/filling.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/linked_cells.hpp"
#include "core/random.hpp"

namespace shearcell {
namespace {

constexpr double kGrainVolume = std::numbers::pi / 6;
constexpr double kGrainArea = std::numbers::pi / 4;
// Volume that a rough wall takes from the cell, per wall area [d]. A wall has 0.66 wall grains per
// d^2, recessed by 0 to d/4. Each wall grain has on average 0.17 d^3 inside the cell, which gives
// 0.11 d. The rest is the gaps between the wall grains.
constexpr double kRoughLayer = 0.175;
constexpr std::uint32_t kFillStream = 4;  // streams 0 to 3 belong to the wall sides

// Random stream of a wall side. `draw` is Geometry::wall_grain_draw. Draw 0 uses the streams 0 to
// 3, draw 1 uses 5 to 8, and so on. The streams 4 (kFillStream), 9, 14, ... are left out.
std::uint32_t wall_stream(WallSide side, std::uint32_t draw) {
  return static_cast<std::uint32_t>(side) + (kFillStream + 1) * draw;
}

double wrapped_difference(double dz, double depth) {
  return dz - depth * std::nearbyint(dz / depth);
}

// Four uniform random numbers for one attempt to place a grain.
std::array<double, 4> draw(std::uint64_t seed, std::size_t grains, std::uint32_t stream,
                           std::uint64_t attempt) {
  const auto n = static_cast<std::uint32_t>(grains);
  const auto low = static_cast<std::uint32_t>(attempt);
  const auto high = static_cast<std::uint32_t>(attempt >> 32);
  const auto a = uniform_pair({low, high, n, 2 * stream}, seed);
  const auto b = uniform_pair({low, high, n, 2 * stream + 1}, seed);
  return {a[0], a[1], b[0], b[1]};
}

void poll_sometimes(const Poll& poll, std::uint64_t attempt) {
  if (poll && attempt % 1024 == 1023) poll();
}

// Places discs of diameter d by random sequential addition on a wall of the size `length` x
// `depth`. The wall is periodic along `depth`. Calls place(along, z, recess) for each disc.
template <class Place>
void add_wall_grains(const Geometry& geometry, std::uint64_t seed, WallSide side, double length,
                     double depth, const Poll& poll, Place&& place) {
  const double area = length * depth;
  const auto target =
      static_cast<std::size_t>(geometry.wall_grain_area_fraction * area / kGrainArea);
  // With this many attempts, the coverage can come close to the jamming limit (0.547). A wall with
  // fewer grains than `target` is accepted, because it is still rough.
  const auto attempts = static_cast<std::uint64_t>(4000.0 * area);
  const std::uint32_t stream = wall_stream(side, geometry.wall_grain_draw);
  LinkedCells near({.width = length, .depth = depth}, {.top = 1}, 1.0, target);
  std::vector<Eigen::Vector2d> placed;
  for (std::uint64_t attempt = 0; attempt < attempts && placed.size() < target; ++attempt) {
    poll_sometimes(poll, attempt);
    const auto u = draw(seed, geometry.grains, stream, attempt);
    const Eigen::Vector2d p(u[0] * length, u[1] * depth);
    bool free = true;
    near.for_each_near({p.x(), 0.5, p.y()}, [&](std::int32_t j) {
      const Eigen::Vector2d& q = placed[static_cast<std::size_t>(j)];
      const double dx = p.x() - q.x();
      const double dz = wrapped_difference(p.y() - q.y(), depth);
      free = free && dx * dx + dz * dz >= 1.0;
    });
    if (!free) continue;
    near.insert(static_cast<std::int32_t>(placed.size()), {p.x(), 0.5, p.y()});
    placed.push_back(p);
    place(p.x(), p.y(), u[2] * geometry.wall_grain_recess);
  }
}

}  // namespace

double cell_width(const Geometry& geometry) {
  const double volume =
      static_cast<double>(geometry.grains) * kGrainVolume / geometry.nominal_packing_fraction;
  const double layers = geometry.walls == WallTexture::rough ? 2 * kRoughLayer : 0.0;
  const auto too_small = [&](double width) {
    return (width - layers) * (geometry.height_over_width * width - layers) * width < volume;
  };
  double low = layers;
  double high = std::cbrt(volume) + 1.0 + layers;
  while (too_small(high)) high *= 2;  // the first bound is too small for a flat cell
  for (int i = 0; i < 200 && low < high; ++i) {
    const double width = 0.5 * (low + high);
    (too_small(width) ? low : high) = width;
  }
  return 0.5 * (low + high);
}

double fill_height(const Geometry& geometry) {
  const double inset = geometry.walls == WallTexture::rough ? kRoughLayer : 0.0;
  const double width = cell_width(geometry);
  return static_cast<double>(geometry.grains) * kGrainVolume /
             (geometry.fill_packing_fraction * width * (width - 2 * inset)) +
         2 * inset;
}

double wall_grain_count(const Geometry& geometry) {
  if (geometry.walls == WallTexture::smooth) return 0;
  const double width = cell_width(geometry);
  return geometry.wall_grain_area_fraction / kGrainArea * 2 * width *
         (fill_height(geometry) + width);
}

bool too_large(const Geometry& geometry) {
  const auto grains = static_cast<double>(geometry.grains);
  const double width = cell_width(geometry), height = fill_height(geometry);
  return !(std::max(width, height) <= kLongestCell &&
           width * width * height <= 0.5 * kLoosestCell * (grains + 100) &&
           wall_grain_count(geometry) <= 1e4 + 1e3 * grains);
}

Cell make_cell(const Geometry& geometry, std::uint64_t seed, const Poll& poll) {
  Cell cell;
  cell.width = cell.depth = cell_width(geometry);
  cell.moving = geometry.moving;
  if (!(cell.depth >= kShallowestCell)) {
    throw GeometryError("a cell for " + std::to_string(geometry.grains) + " grains is only " +
                        std::to_string(cell.depth) +
                        " d deep. The depth must be at least 3 d, so that no grain touches two "
                        "periodic images of the same neighbour. Use more grains");
  }
  if (too_large(geometry)) {
    throw GeometryError("a cell of " + std::to_string(cell.width) + " d by " +
                        std::to_string(fill_height(geometry)) + " d is too large for " +
                        std::to_string(geometry.grains) +
                        " grains. Raise fill_packing_fraction or nominal_packing_fraction");
  }
  cell.bottom = 0;
  cell.top = fill_height(geometry);
  if (geometry.walls == WallTexture::smooth) return cell;

  const double height = cell.top;
  const auto add = [&](WallSide side, double length, auto&& centre) {
    add_wall_grains(geometry, seed, side, length, cell.depth, poll,
                    [&](double along, double z, double recess) {
                      cell.wall_grains.push_back({side, centre(along, z, recess)});
                    });
  };
  using V = Eigen::Vector3d;
  add(WallSide::left, height, [](double s, double z, double u) { return V(-u, s, z); });
  add(WallSide::right, height,
      [&](double s, double z, double u) { return V(cell.width + u, s, z); });
  add(WallSide::bottom, cell.width, [](double s, double z, double u) { return V(s, -u, z); });
  add(WallSide::top, cell.width, [&](double s, double z, double u) { return V(s, height + u, z); });
  return cell;
}

State fill_cell(const Cell& cell, const Geometry& geometry, std::uint64_t seed, const Poll& poll) {
  const double height = cell.top - cell.bottom;
  if (!(height >= 1)) {
    throw GeometryError("a cell for " + std::to_string(geometry.grains) + " grains is only " +
                        std::to_string(height) +
                        " d high, too low for a grain. Use more grains or raise height_over_width");
  }
  State state;
  const auto n = static_cast<Eigen::Index>(geometry.grains);
  state.position.resize(3, n);
  state.velocity = Eigen::Matrix3Xd::Zero(3, n);
  state.wall_height = cell.moving == MovingWall::bottom ? cell.bottom : cell.top;

  // `sites` holds the wall grains and then the placed grains, so that one search finds both.
  std::vector<Eigen::Vector3d> sites;
  LinkedCells near(cell, {.bottom = cell.bottom, .top = cell.top}, 1.0,
                   geometry.grains + cell.wall_grains.size());
  const auto keep = [&](const Eigen::Vector3d& p) {
    near.insert(static_cast<std::int32_t>(sites.size()), p);
    sites.push_back(p);
  };
  for (const WallGrain& grain : cell.wall_grains) keep(grain.position);

  const std::uint64_t attempts = 200000 + 20000 * std::uint64_t{geometry.grains};
  std::uint64_t attempt = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (bool free = false; !free; ++attempt) {
      if (attempt == attempts) {
        throw GeometryError("only " + std::to_string(i) + " of " + std::to_string(n) +
                            " grains could be placed without touching another grain. "
                            "Lower fill_packing_fraction");
      }
      poll_sometimes(poll, attempt);
      const auto u = draw(seed, geometry.grains, kFillStream, attempt);
      const Eigen::Vector3d p(0.5 + u[0] * (cell.width - 1.0),
                              cell.bottom + 0.5 + u[1] * (height - 1.0), u[2] * cell.depth);
      free = true;
      near.for_each_near(p, [&](std::int32_t j) {
        Eigen::Vector3d r = p - sites[static_cast<std::size_t>(j)];
        r.z() = wrapped_difference(r.z(), cell.depth);
        free = free && r.squaredNorm() >= 1.0;
      });
      if (free) {
        keep(p);
        state.position.col(i) = p;
      }
    }
  }
  return state;
}

void add_noise(State& state, double noise, std::uint64_t seed) {
  if (noise == 0) return;
  for (Eigen::Index i = 0; i < state.position.cols(); ++i) {
    for (Eigen::Index k = 0; k < 3; ++k) {
      const auto grain = static_cast<std::uint32_t>(i), axis = static_cast<std::uint32_t>(k);
      state.position(k, i) += noise * normal_number({grain, axis, 0, 0}, seed);
    }
  }
}

}  // namespace shearcell
