// SPDX-License-Identifier: GPL-3.0-or-later
// The reference implementation of the loops, one grain at a time. All other implementations perform
// the same operations in the same order. This file is also compiled for AVX2: without a fused
// multiply-add instruction, each std::fma would call the C library, which is many times slower.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/scalar_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

#include "core/contact.hpp"
#include "core/kernel.hpp"

HWY_BEFORE_NAMESPACE();
namespace shearcell {
namespace HWY_NAMESPACE {
namespace {

struct Sum {
  double x, y, z;
};

// Returns `sum` plus (1/r - 1) dr for each neighbour that touches the grain at `own`.
Sum add_contacts(Sum sum, const double* own, const double* rows, const std::int32_t* list,
                 std::size_t slots, double depth, double per_depth) {
  for (std::size_t k = 0; k < slots; ++k) {
    const double* other = rows + list[k];
    const double dx = own[0] - other[0];
    const double dy = own[1] - other[1];
    const double dz = nearest_image(own[2] - other[2], depth, per_depth);
    const double factor = contact_factor(one_minus_square(dx, dy, dz));  // 0 if not touching
    sum.x = std::fma(factor, dx, sum.x);
    sum.y = std::fma(factor, dy, sum.y);
    sum.z = std::fma(factor, dz, sum.z);
  }
  return sum;
}

double distance_to(const WallPlane& plane, const double* row) {
  return std::fma(row[0] - plane.point[0], plane.normal[0],
                  (row[1] - plane.point[1]) * plane.normal[1]);
}

void touch_plane(Sum& sum, const double* own, const WallPlane& plane) {
  const double overlap = std::max(0.5 - distance_to(plane, own), 0.0);
  sum.x = std::fma(overlap, plane.normal[0], sum.x);
  sum.y = std::fma(overlap, plane.normal[1], sum.y);
}

// Sum of the overlap vectors of all contacts of grain g [d].
Sum contact_sum(const StepTask& t, std::size_t g) {
  const double* own = t.rows + 4 * g;
  Sum sum{0, 0, 0};
  const std::int32_t* list = t.neighbours.list + t.neighbours.begin[g];
  const std::uint8_t near = t.neighbours.near[g];
  if ((near & kNearMovingWall) != 0) {
    const std::size_t slots = t.neighbours.moving_wall_slots[g];
    touch_plane(sum, own, t.planes[0]);
    sum = add_contacts(sum, own, t.rows, list, slots, t.depth, t.per_depth);
    t.moving_wall_force_y[g] = sum.y;
    list += slots;
  }
  if ((near & kNearOtherWall) != 0) {
    for (std::size_t w = 1; w < 4; ++w) touch_plane(sum, own, t.planes[w]);
  }
  return add_contacts(sum, own, t.rows, list, t.neighbours.other_slots[g], t.depth, t.per_depth);
}

// The square of the distance that a grain has moved since its list was built, minus the square of
// the remaining margin. If the result is positive, the list may lack a neighbour.
double margin_excess(const StepTask& t, std::size_t g, const double* at) {
  const double ry = double{t.reference[1][g]};
  const double wx = at[0] - std::fma(t.tan_theta, ry - t.frame_height, double{t.reference[0][g]});
  const double wy = at[1] - ry;
  const double wz = at[2] - double{t.reference[2][g]};
  const double room = std::max(at[3] - t.margin_loss, 0.0);
  return std::fma(-room, room, std::fma(wz, wz, std::fma(wy, wy, wx * wx)));
}

double step(const StepTask& t, std::size_t first, std::size_t last) {
  double excess = -1;
  for (std::size_t g = first; g < std::min(last, t.grains); ++g) {
    const double* own = t.rows + 4 * g;
    const Sum sum = contact_sum(t, g);
    double vx = std::fma(t.contact_kick, sum.x, t.velocity_factor * t.velocity[0][g]);
    double vy = std::fma(t.contact_kick, sum.y, t.velocity_factor * t.velocity[1][g]);
    const double vz = std::fma(t.contact_kick, sum.z, t.velocity_factor * t.velocity[2][g]);
    if (t.fluid_step != 0) vx = std::fma(t.fluid_step, own[1] - t.fluid_rest_height, vx);
    vy += t.gravity_step;
    t.velocity[0][g] = vx;
    t.velocity[1][g] = vy;
    t.velocity[2][g] = vz;
    double* next = t.next_rows + 4 * g;
    next[0] = std::fma(t.time_step, vx, own[0]);
    next[1] = std::fma(t.time_step, vy, own[1]);
    next[2] = std::fma(t.time_step, vz, own[2]);
    next[3] = own[3];
    excess = std::max(excess, margin_excess(t, g, next));
  }
  return excess;
}

std::size_t search(const SearchTask& t, std::size_t first, std::size_t last) {
  std::size_t most = 0;
  for (std::size_t place = first; place < last; ++place) {
    const std::int32_t id = t.grid.id[place];
    if (id < t.first_grain) continue;
    const double x = t.grid.position[0][place];
    const double y = t.grid.position[1][place];
    const double z = t.grid.position[2][place];
    std::int32_t found[kMostNeighbours];
    std::size_t count = 0;
    std::array<CellRange, 9> ranges;
    const std::size_t range_count = t.grid.cells.surrounding(t.grid.cell[place], ranges);
    for (std::size_t r = 0; r < range_count; ++r) {
      const std::size_t end = t.grid.begin[ranges[r].end];
      for (std::size_t p = t.grid.begin[ranges[r].begin]; p < end; ++p) {
        const double dx = x - t.grid.position[0][p];
        const double dy = y - t.grid.position[1][p];
        const double dz = nearest_image(z - t.grid.position[2][p], t.depth, t.per_depth);
        const double cutoff = 1 + (t.grid.margin[place] + t.grid.margin[p]);
        const bool near = dx * dx + dy * dy + dz * dz < cutoff * cutoff;
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

std::uint8_t near_planes(const PruneTask& t, const double* own) {
  std::uint8_t near = 0;
  for (std::size_t w = 0; w < 4; ++w) {
    const bool touches = distance_to(t.planes[w], own) < 0.5 + (own[3] + t.wall_margin);
    if (touches) near |= w == 0 ? kNearMovingWall : kNearOtherWall;
  }
  return near;
}

bool prune(const PruneTask& t, std::size_t first, std::size_t last) {
  std::size_t begin = first * t.inner_stride;
  for (std::size_t g = first; g < std::min(last, t.grains); ++g) {
    const double* own = t.rows + 4 * g;
    std::int32_t* inner = t.inner + begin;
    std::size_t kept = 0, wall = 0;
    for (std::size_t k = 0; k < t.outer_count[g]; ++k) {
      const std::int32_t offset = t.outer[g * t.outer_stride + k];
      const double* other = t.rows + offset;
      const double dx = own[0] - other[0];
      const double dy = own[1] - other[1];
      const double dz = nearest_image(own[2] - other[2], t.depth, t.per_depth);
      const double cutoff = 1 + (own[3] + other[3]);
      if (!(dx * dx + dy * dy + dz * dz < cutoff * cutoff)) continue;
      if (kept == t.inner_stride) return false;
      if (offset >= t.first_wall && offset < t.moving_end) ++wall;
      inner[kept++] = offset;
    }
    t.inner_count[g] = static_cast<std::uint16_t>(kept);
    t.moving_wall_slots[g] = static_cast<std::uint16_t>(wall);
    t.other_slots[g] = static_cast<std::uint16_t>(kept - wall);
    t.near[g] = t.grain_near[g] =
        static_cast<std::uint8_t>(near_planes(t, own) | (wall > 0 ? kNearMovingWall : 0));
    t.begin[g] = static_cast<std::uint32_t>(begin);
    begin += kept;
  }
  return true;
}

}  // namespace

const Kernels& scalar_table() {
  static const Kernels kernels{"scalar", 1, step, search, prune};
  return kernels;
}

}  // namespace HWY_NAMESPACE
}  // namespace shearcell
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shearcell {

const Kernels& scalar_kernels() {
#if HWY_TARGETS & HWY_AVX2
  if ((hwy::SupportedTargets() & HWY_AVX2) != 0) return N_AVX2::scalar_table();
#endif
  return HWY_STATIC_DISPATCH(scalar_table)();
}

}  // namespace shearcell
#endif  // HWY_ONCE
