// SPDX-License-Identifier: GPL-3.0-or-later
// The specification of the kernel: the same operations in the same order, one grain at a time.
#include <algorithm>
#include <cmath>

#include "core/cell_grid.hpp"
#include "core/contact.hpp"
#include "core/kernel.hpp"

namespace shearcell {
namespace {

struct Sum {
  double x, y, z;
};

// Adds (1/r - 1) dr over the touching neighbours of the grain at `own`.
void add_contacts(Sum& sum, const double* own, const double* rows, const std::int32_t* list,
                  std::size_t slots, double depth, double per_depth) {
  for (std::size_t k = 0; k < slots; ++k) {
    const double* other = rows + list[k];
    const double dx = own[0] - other[0];
    const double dy = own[1] - other[1];
    const double dz = nearest_image(own[2] - other[2], depth, per_depth);
    const double s = one_minus_square(dx, dy, dz);
    if (!(s > 0)) continue;
    const double factor = contact_factor(s);
    sum.x = std::fma(factor, dx, sum.x);
    sum.y = std::fma(factor, dy, sum.y);
    sum.z = std::fma(factor, dz, sum.z);
  }
}

template <bool kGravity, bool kFlow>
double step(const StepTask& t, std::size_t first, std::size_t last) {
  double farthest = 0;
  for (std::size_t g = first; g < std::min(last, t.grains); ++g) {
    const double* own = t.rows + 4 * g;
    Sum sum{0, 0, 0};
    if (t.walled[g] != 0) sum = {t.wall_sum[0][g], t.wall_sum[1][g], t.wall_sum[2][g]};
    add_contacts(sum, own, t.rows, t.neighbours.list + t.neighbours.begin[g], t.neighbours.slots[g],
                 t.depth, t.per_depth);

    double vx = std::fma(t.kick, sum.x, t.keep * t.velocity[0][g]);
    double vy = std::fma(t.kick, sum.y, t.keep * t.velocity[1][g]);
    const double vz = std::fma(t.kick, sum.z, t.keep * t.velocity[2][g]);
    if constexpr (kGravity) vy += t.fall;
    if constexpr (kFlow) vx = std::fma(t.flow, own[1] - t.top, vx);
    t.velocity[0][g] = vx;
    t.velocity[1][g] = vy;
    t.velocity[2][g] = vz;
    const double x = std::fma(t.time_step, vx, own[0]);
    const double y = std::fma(t.time_step, vy, own[1]);
    const double z = std::fma(t.time_step, vz, own[2]);
    double* next = t.next_rows + 4 * g;
    next[0] = x;
    next[1] = y;
    next[2] = z;
    next[3] = 0;

    const double ry = double{t.reference[1][g]};
    const double wx = x - std::fma(t.next_shear, ry - t.next_top, double{t.reference[0][g]});
    const double wy = y - ry;
    const double wz = z - double{t.reference[2][g]};
    farthest = std::max(farthest, std::fma(wz, wz, std::fma(wy, wy, wx * wx)));
  }
  return farthest;
}

void walls(const WallTask& t) {
  for (std::size_t m = 0; m < t.count; ++m) {
    const double* own = t.rows + t.members[m];
    const double distance =
        std::fma(own[0] - t.point[0], t.normal[0], (own[1] - t.point[1]) * t.normal[1]);
    const double overlap = std::max(0.5 - distance, 0.0);
    Sum sum{overlap * t.normal[0], overlap * t.normal[1], 0};
    add_contacts(sum, own, t.wall_rows, t.neighbours.list + t.neighbours.begin[m],
                 t.neighbours.slots[m], t.depth, t.per_depth);
    const std::size_t g = static_cast<std::size_t>(t.members[m]) / 4;
    const bool first = t.first[m] != 0;
    t.wall_sum[0][g] = (first ? 0.0 : t.wall_sum[0][g]) + sum.x;
    t.wall_sum[1][g] = (first ? 0.0 : t.wall_sum[1][g]) + sum.y;
    t.wall_sum[2][g] = (first ? 0.0 : t.wall_sum[2][g]) + sum.z;
    if (t.push != nullptr) t.push[m] = sum.y;
  }
}

std::size_t search(const SearchTask& t, std::size_t first, std::size_t last) {
  std::size_t most = 0;
  for (std::size_t place = first; place < last; ++place) {
    const double x = t.grid.position[0][place];
    const double y = t.grid.position[1][place];
    const double z = t.grid.position[2][place];
    const std::int32_t id = t.grid.id[place];
    std::int32_t found[kMostNeighbours];
    std::size_t count = 0;
    std::array<PlaceRun, 9> runs;
    const std::size_t run_count = surrounding_runs(t.grid, place, runs);
    for (std::size_t r = 0; r < run_count; ++r) {
      for (std::size_t p = runs[r].begin; p < runs[r].end; ++p) {
        const double dx = x - t.grid.position[0][p];
        const double dy = y - t.grid.position[1][p];
        const double dz = nearest_image(z - t.grid.position[2][p], t.depth, t.per_depth);
        const bool near = dx * dx + dy * dy + dz * dz < t.cutoff_squared;
        if (near && t.grid.id[p] != id && count < kMostNeighbours) found[count++] = t.grid.id[p];
      }
    }
    most = std::max(most, count);
    count = std::min(count, t.stride);
    std::sort(found, found + count);
    const std::size_t grain = static_cast<std::size_t>(t.offset_of_id[id]) / 4;
    std::int32_t* outer = t.outer + grain * t.stride;
    for (std::size_t k = 0; k < count; ++k) outer[k] = t.offset_of_id[found[k]];
    t.count[grain] = static_cast<std::uint16_t>(count);
  }
  return most;
}

bool prune(const PruneTask& t, std::size_t first, std::size_t last) {
  std::size_t begin = first * t.inner_stride;
  for (std::size_t g = first; g < std::min(last, t.grains); ++g) {
    const double* own = t.rows + 4 * g;
    std::int32_t* inner = t.inner + begin;
    std::size_t kept = 0;
    for (std::size_t k = 0; k < t.outer_count[g]; ++k) {
      const std::int32_t offset = t.outer[g * t.outer_stride + k];
      const double* other = t.rows + offset;
      const double dx = own[0] - other[0];
      const double dy = own[1] - other[1];
      const double dz = nearest_image(own[2] - other[2], t.depth, t.per_depth);
      if (!(dx * dx + dy * dy + dz * dz < t.cutoff_squared)) continue;
      if (kept == t.inner_stride) return false;
      inner[kept++] = offset;
    }
    t.slots[g] = t.inner_count[g] = static_cast<std::uint16_t>(kept);
    t.seam[g] = 1;
    t.begin[g] = static_cast<std::uint32_t>(begin);
    begin += kept;
  }
  return true;
}

}  // namespace

const Kernels& scalar_kernels() {
  static const Kernels kernels{
      "scalar",
      1,
      {{step<false, false>, step<false, true>}, {step<true, false>, step<true, true>}},
      walls,
      search,
      prune};
  return kernels;
}

}  // namespace shearcell
