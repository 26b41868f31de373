// SPDX-License-Identifier: GPL-3.0-or-later
// Bond order from cheap neighbours beside that from Voronoi cells.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "analysis/measures.hpp"
#include "core/random.hpp"
#include "experiments/bench/accuracy/box.hpp"
#include "experiments/bench/accuracy/near_neighbours.hpp"
#include "experiments/bench/accuracy/packings.hpp"

namespace shearcell::accuracy {
namespace {

struct Sample {
  std::string name;
  Cell cell;
  WallPose pose;
  Eigen::Matrix3Xd grains;
};

// A crystal of neighbours that overlap by 0.003 d, each grain moved by up to `by` [d] along each
// axis.
Sample jittered_crystal(double by) {
  Scene scene;
  scene.stiffness = 1;
  const Crystal crystal = fcc(scene, 12, 0.003, false);
  Sample sample{fmt::format("crystal, moved by {:g} d", by), {}, {}, crystal.position};
  sample.cell.width = crystal.box.size.x();
  sample.cell.top = crystal.box.size.y();
  sample.cell.depth = crystal.box.size.z();
  sample.pose = wall_pose(sample.cell, 0, 0);
  for (Eigen::Index i = 0; i < sample.grains.cols(); ++i) {
    const auto id = static_cast<std::uint32_t>(i);
    const auto a = uniform_pair({id, 0, 0, 0}, 1), b = uniform_pair({id, 1, 0, 0}, 1);
    const Eigen::Vector3d unit = Eigen::Vector3d(a[0], a[1], b[0]) * 2 - Eigen::Vector3d::Ones();
    // A quarter of the lattice constant off the walls.
    sample.grains.col(i) += Eigen::Vector3d(0.35, 0.35, 0) + by * unit;
  }
  return sample;
}

// Best of several, in seconds per 1000 grains.
template <class Work>
double time_per_1000(const Sample& sample, int repeats, Work&& work) {
  double best = 1e9;
  for (int n = 0; n < repeats; ++n) {
    const auto start = std::chrono::steady_clock::now();
    work();
    best = std::min(
        best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return 1e3 * best / static_cast<double>(sample.grains.cols());
}

}  // namespace

Section order_section(const Options& options) {
  if (options.report) options.report("bond order from cheaper neighbours");
  const Packing packing = settled(small_cell(options.quick), 1);
  std::vector<Sample> samples = {
      {"settled packing", packing.cell, wall_pose(packing.cell, 0, packing.state.wall_height),
       packing.state.position},
      jittered_crystal(0.002),
      jittered_crystal(0.01)};
  const std::vector<std::pair<std::string, NeighbourRule>> rules = {{"within 1.2 d", {1.2, 0}},
                                                                    {"within 1.3 d", {1.3, 0}},
                                                                    {"within 1.4 d", {1.4, 0}},
                                                                    {"12 nearest", {1.6, 12}}};
  const int repeats = options.quick ? 1 : 5;
  Section section{"Bond order: cheap neighbours beside Voronoi cells",
                  {},
                  {"packing", "neighbours", "ms/1000 grains", "error of q6", "crystalline %"},
                  {},
                  {}};
  section.table.name = "accuracy-order";
  section.table.columns = {"packing", "neighbours", "seconds_per_1000_grains", "q6_error",
                           "crystalline_percent"};
  for (const Sample& sample : samples) {
    const auto add = [&](const std::string& rule, double seconds, double q6, double percent) {
      section.table.rows.push_back({sample.name, rule, seconds, q6, percent});
      section.summary.push_back({sample.name, rule, fmt::format("{:.2f}", 1e3 * seconds),
                                 fmt::format("{:.4f}", q6), fmt::format("{:.1f}", percent)});
    };
    const Measures exact = analyse(sample.cell, sample.pose, sample.grains).measures;
    add("Voronoi faces",
        time_per_1000(sample, repeats, [&] { analyse(sample.cell, sample.pose, sample.grains); }),
        0, exact.crystalline_percent);
    for (const auto& named : rules) {
      const auto& rule = named.second;  // clang 14 lends no part of a binding to a lambda
      const OrderError error = order_error(sample.cell, sample.pose, sample.grains, rule);
      const double seconds = time_per_1000(
          sample, repeats, [&] { q6_of_near(sample.cell, sample.pose, sample.grains, rule); });
      add(named.first, seconds, error.q6, exact.crystalline_percent + error.percent);
    }
  }
  section.findings = {
      "Cheap neighbours know no volume of a cell, so their percentage lacks the criterion "
      "phi_local "
      "> 0.72."};
  return section;
}

}  // namespace shearcell::accuracy
