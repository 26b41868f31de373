// SPDX-License-Identifier: GPL-3.0-or-later
// Motion of the grains between two checkpoints of one run.
#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>
#include <cstddef>
#include <limits>

#include "analysis/measures.hpp"
#include "analysis/near_grains.hpp"
#include "core/contact.hpp"
#include "provenance/errors.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

/// Largest distance of neighbours in the analysis of motion [d], near the first minimum of g(r).
constexpr double motion_neighbour_d = 1.5;
/// A grain has returned if it is at most this far from its position one cycle earlier [d].
constexpr double reversible_d = 0.01;

/// One column or entry per grain, by grain id.
struct Motion {
  /// Displacement in the frame of the tilted walls [d], with x - (y - y_top) tan(theta) in place of
  /// x. In this frame, affine shear of the whole cell displaces no grain.
  Eigen::Matrix3Xd displacement;
  /// D^2_min of Falk and Langer, Phys. Rev. E 57, 7192 (1998) [d^2]: the mean, over the neighbours
  /// at the earlier time, of the squared relative motion that remains after the best affine
  /// deformation is subtracted. NaN if there are fewer than four neighbours or all lie in a plane.
  std::vector<double> nonaffine;

  double square(std::size_t grain) const {  ///< squared displacement [d^2]
    return displacement.col(static_cast<Eigen::Index>(grain)).squaredNorm();
  }
};

Eigen::Matrix3Xd untilted(const Checkpoint& checkpoint) {
  const WallPose pose = pose_of(checkpoint);
  Eigen::Matrix3Xd position = checkpoint.state.position;
  position.row(0).array() -= pose.tan_theta * (position.row(1).array() - pose.top);
  return position;
}

// Sums over the neighbours of one grain. They determine the best affine deformation.
struct Neighbours {
  Eigen::Matrix3d product = Eigen::Matrix3d::Zero();  // later x earlier
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();   // earlier x earlier
  double later = 0;                                   // sum of squared distances
  int count = 0;

  void add(const Eigen::Vector3d& earlier_r, const Eigen::Vector3d& later_r) {
    product += later_r * earlier_r.transpose();
    square += earlier_r * earlier_r.transpose();
    later += later_r.squaredNorm();
    ++count;
  }

  // The best deformation is F = P S^-1, where P is `product` and S is `square`. It gives
  // sum |r' - F r|^2 = `later` - tr(F P^T).
  double nonaffine() const {
    // Neighbours in one plane do not determine the deformation.
    const double flat = 1e-9 * std::pow(square.trace() / 3, 3);
    if (count < 4 || !(square.determinant() > flat)) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    const Eigen::Matrix3d deformation = product * square.inverse();
    return std::max(0.0, later - (deformation * product.transpose()).trace()) / count;
  }
};

Motion motion(const Checkpoint& earlier, const Checkpoint& later) {
  if (earlier.state.position.cols() != later.state.position.cols()) {
    throw AnalysisError("two checkpoints of one run have different numbers of grains");
  }
  const Eigen::Matrix3Xd from = untilted(earlier), to = untilted(later);
  Motion found;
  found.displacement = to - from;
  std::vector<Neighbours> neighbours(static_cast<std::size_t>(from.cols()));
  for_each_pair(earlier.cell, pose_of(earlier), earlier.state.position, motion_neighbour_d,
                [&](std::int32_t i, std::int32_t j, const Eigen::Vector3d&) {
                  Eigen::Vector3d before = from.col(j) - from.col(i);
                  before.z() =
                      nearest_image(before.z(), earlier.cell.depth, 1 / earlier.cell.depth);
                  const Eigen::Vector3d after =
                      before + found.displacement.col(j) - found.displacement.col(i);
                  neighbours[static_cast<std::size_t>(i)].add(before, after);
                  neighbours[static_cast<std::size_t>(j)].add(-before, -after);
                });
  found.nonaffine.reserve(neighbours.size());
  for (const Neighbours& of_grain : neighbours) found.nonaffine.push_back(of_grain.nonaffine());
  return found;
}

enum class GrainPlace { disordered, inside_crystal, crystal_boundary };

/// The place of each grain. A crystalline grain is at the boundary if a neighbour is disordered.
std::vector<GrainPlace> places_of(const Checkpoint& checkpoint,
                                  const std::vector<Structure>& structure) {
  std::vector<GrainPlace> places;
  for (const Structure one : structure) {
    places.push_back(one == Structure::disordered ? GrainPlace::disordered
                                                  : GrainPlace::inside_crystal);
  }
  for_each_pair(checkpoint.cell, pose_of(checkpoint), checkpoint.state.position, motion_neighbour_d,
                [&](std::int32_t i, std::int32_t j, const Eigen::Vector3d&) {
                  GrainPlace &a = places[static_cast<std::size_t>(i)],
                             &b = places[static_cast<std::size_t>(j)];
                  if ((a == GrainPlace::disordered) == (b == GrainPlace::disordered)) return;
                  (a == GrainPlace::disordered ? b : a) = GrainPlace::crystal_boundary;
                });
  return places;
}

/// Computes result_of(input, motion since the earlier checkpoint). The result is empty if there is
/// no earlier checkpoint.
auto from_motion(auto result_of) {
  return [result_of](const MeasureInput& input) -> json {
    const Checkpoint* earlier = input.earlier ? input.earlier() : nullptr;
    if (earlier == nullptr) return json::object();
    return result_of(input, motion(*earlier, *input.checkpoint));
  };
}

/// Means over interior grains. The names of the means end in `lag`.
json means_of(const Motion& moved, const GrainMeasures& grains, const std::string& lag) {
  const auto square = [&](std::size_t i) { return moved.square(i); };
  const auto nonaffine = [&](std::size_t i) { return moved.nonaffine[i]; };
  return {{"msd_" + lag, mean_over(grains.interior, square)},
          {"d2min_" + lag, mean_over(grains.interior, nonaffine)}};
}

json one_cycle(const MeasureInput& input, const Motion& moved) {
  const GrainMeasures& grains = input.analysis->grains;
  const std::vector<GrainPlace> places = places_of(*input.checkpoint, grains.structure);
  const auto square_in = [&](GrainPlace place) {
    return mean_over(grains.interior, [&](std::size_t i) {
      return places[i] == place ? moved.square(i) : std::nan("");
    });
  };
  json values = means_of(moved, grains, "1_cycle_d2");
  values["reversible_percent"] = percent_of(grains.interior, [&](std::size_t i) {
    return moved.square(i) <= reversible_d * reversible_d;
  });
  values["msd_inside_crystal_d2"] = square_in(GrainPlace::inside_crystal);
  values["msd_crystal_boundary_d2"] = square_in(GrainPlace::crystal_boundary);
  values["msd_disordered_d2"] = square_in(GrainPlace::disordered);
  return values;
}

json of_each_grain(const MeasureInput&, const Motion& moved) {
  const Eigen::VectorXd displacement = moved.displacement.colwise().norm();
  return {{"displacement_d", std::vector(displacement.begin(), displacement.end())},
          {"d2min_d2", moved.nonaffine}};
}

/// Each lag has its own provider, so a pruned checkpoint affects only the lag that needs it.
Provider motion_over(std::uint64_t cycles) {
  const std::string lag = fmt::format("{}_cycles_d2", cycles);
  const auto means = [lag](const MeasureInput& input, const Motion& moved) {
    return means_of(moved, input.analysis->grains, lag);
  };
  return {
      .name = fmt::format("motion_{}", cycles),
      .parameters = with(interior_criteria(), {{"neighbour_d", motion_neighbour_d}}),
      .measures = {{"msd_" + lag, "d^2",
                    fmt::format("mean squared displacement of interior grains over {} cycles",
                                cycles)},
                   {"d2min_" + lag, "d^2",
                    fmt::format("D^2_min of the motion over {} cycles, mean over interior grains",
                                cycles)}},
      .compute = from_motion(means),
      .cycles_back = cycles};
}

}  // namespace

std::vector<Provider> motion_providers() {
  return {
      {.name = "motion",
       .parameters = with(crystal_criteria(),
                          {{"neighbour_d", motion_neighbour_d}, {"reversible_d", reversible_d}}),
       .measures =
           {{"msd_1_cycle_d2", "d^2",
             "mean squared displacement of interior grains over 1 cycle, in the frame of the "
             "walls"},
            {"d2min_1_cycle_d2", "d^2",
             "mean non-affine squared displacement D^2_min of interior grains over 1 cycle"},
            {"reversible_percent", "%",
             "interior grains at most 0.01 d from their position one cycle earlier"},
            {"msd_inside_crystal_d2", "d^2",
             "mean squared displacement of crystalline grains not next to disordered grains, over "
             "1 cycle"},
            {"msd_crystal_boundary_d2", "d^2",
             "mean squared displacement of crystalline grains next to disordered grains, over "
             "1 cycle"},
            {"msd_disordered_d2", "d^2",
             "mean squared displacement of disordered grains, over 1 cycle"}},
       .compute = from_motion(one_cycle),
       .cycles_back = 1},
      motion_over(10),
      motion_over(100),
      {.name = "grain_motion",
       .parameters = {{"neighbour_d", motion_neighbour_d}},
       .measures = {of_grains("displacement_d", "d", "displacement over the previous cycle",
                              "displacement in a cycle",
                              {.low = 1e-3, .high = 1, .logarithmic = true}),
                    of_grains("d2min_d2", "d^2", "D^2_min of the motion over the previous cycle",
                              "non-affine motion in a cycle",
                              {.low = 1e-6, .high = 1, .logarithmic = true})},
       .compute = from_motion(of_each_grain),
       .cycles_back = 1}};
}

}  // namespace shearcell
