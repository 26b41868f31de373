// SPDX-License-Identifier: GPL-3.0-or-later
// Measures as functions of the height above the bottom wall, of the distance from the nearest wall,
// and of the criteria of supplement A.
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "analysis/measures.hpp"
#include "analysis/packing_fraction.hpp"
#include "analysis/voronoi.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

// Index of the layer of each grain, counted from the bottom. A grain near a side wall belongs to no
// layer; its index is `layers`.
std::vector<std::size_t> layers_of(const Checkpoint& checkpoint, const WallPose& pose,
                                   std::size_t layers) {
  const double least = interior_margin(checkpoint.cell);
  std::vector<std::size_t> found;
  for (Eigen::Index i = 0; i < checkpoint.state.position.cols(); ++i) {
    const Eigen::Vector3d centre = checkpoint.state.position.col(i);
    const Eigen::Vector4d distance = wall_distances(checkpoint.cell, pose, centre);
    const bool inside = std::min(distance[0], distance[1]) >= least;
    const double height = std::max(0.0, centre.y() - pose.bottom);
    found.push_back(inside ? std::min(static_cast<std::size_t>(height), layers - 1) : layers);
  }
  return found;
}

/// Curves with one entry per layer. Layers are one diameter thick, from the plane of the bottom
/// wall to the plane of the top wall. A grain counts in the layer of its centre if it is at least
/// 1.5 d from the surfaces of the side walls. The value of a layer without grains is NaN.
json profiles_of(const MeasureInput& input) {
  const Checkpoint& checkpoint = *input.checkpoint;
  const GrainMeasures& grains = input.analysis->grains;
  const std::vector<double>& volumes = grains.cells.volume;
  const WallPose pose = pose_of(checkpoint);
  const auto layers = static_cast<std::size_t>(std::max(1.0, std::ceil(pose.top - pose.bottom)));
  const std::vector<std::size_t> layer_of = layers_of(checkpoint, pose, layers);
  const double unit_Pa = mechanical_units(input).stress_Pa;
  MeasuredCurve phi, pressure, coordination, crystalline;
  for (std::size_t l = 0; l < layers; ++l) {
    std::vector<std::uint8_t> inside;
    double volume = 0, trace = 0;
    for (std::size_t i = 0; i < layer_of.size(); ++i) {
      inside.push_back(layer_of[i] == l ? 1 : 0);
      if (layer_of[i] != l) continue;
      volume += volumes[i];
      trace += input.analysis->mechanics.grain_pressure[i] * volumes[i];
    }
    for (MeasuredCurve* one : {&phi, &pressure, &coordination, &crystalline}) {
      one->x.push_back(static_cast<double>(l) + 0.5);
    }
    phi.y.push_back(packing_fractions(grains.overlaps.largest, volumes, inside).phi);
    pressure.y.push_back(trace / volume * unit_Pa);
    coordination.y.push_back(
        mean_over(inside, [&](std::size_t i) { return grains.overlaps.contacts[i]; }));
    crystalline.y.push_back(percent_of(
        inside, [&](std::size_t i) { return grains.structure[i] != Structure::disordered; }));
  }
  return {{"phi_profile", phi},
          {"pressure_profile_Pa", pressure},
          {"coordination_profile", coordination},
          {"crystalline_profile_percent", crystalline}};
}

/// phi in layers of half a diameter, by distance from the walls; NaN for a layer without grains.
json wall_distance_of(const MeasureInput& input) {
  constexpr double layer = 0.5;
  const GrainMeasures& grains = input.analysis->grains;
  const Checkpoint& c = *input.checkpoint;
  const std::vector<double> distance = distances_from_walls(c.cell, pose_of(c), c.state.position);
  const double farthest = distance.empty() ? 0 : std::ranges::max(distance);
  MeasuredCurve phi;
  for (double low = 0; low <= farthest; low += layer) {
    std::vector<std::uint8_t> inside;
    for (const double d : distance) inside.push_back(d >= low && d < low + layer ? 1 : 0);
    phi.x.push_back(low + layer / 2);
    phi.y.push_back(packing_fractions(grains.overlaps.largest, grains.cells.volume, inside).phi);
  }
  return {{"phi_by_wall_distance", phi}};
}

/// Number and phi of the core grains; phi is NaN without core grains.
json core_of(const MeasureInput& input) {
  const GrainMeasures& grains = input.analysis->grains;
  const Checkpoint& c = *input.checkpoint;
  const auto core = interior_grains(c.cell, pose_of(c), c.state.position, core_distance);
  return {{"core_grains", static_cast<double>(std::ranges::count(core, 1))},
          {"core_phi", packing_fractions(grains.overlaps.largest, grains.cells.volume, core).phi}};
}

MeasuredCurve curve_of(const std::vector<double>& x, const auto& y_of) {
  MeasuredCurve curve{x, {}};
  for (const double at : x) curve.y.push_back(y_of(at));
  return curve;
}

/// Each curve is a result as a function of one criterion; the other criteria have their usual
/// values.
json sensitivity_of(const MeasureInput& input) {
  const GrainMeasures& grains = input.analysis->grains;
  const Checkpoint& checkpoint = *input.checkpoint;
  const auto crystalline = [&](double least_phi_local, double tolerance) {
    return percent_of(grains.interior, [&](std::size_t i) {
      return structure(grains.phi_local[i], grains.q6[i], least_phi_local, tolerance) !=
             Structure::disordered;
    });
  };
  const auto largest = [&](double share) {
    const std::vector<std::int32_t> label = crystallites_of(grains, share);
    return crystallite_map(label, checkpoint.cell, pose_of(checkpoint), checkpoint.state.position)
        .largest();
  };
  std::vector<double> windows, thresholds;
  for (int n = 1; n <= 20; ++n) windows.push_back(n * 0.1 * q6_tolerance);
  for (int n = -16; n <= 8; ++n) thresholds.push_back(crystalline_phi_local + n * 0.0025);
  const auto by_window = [&](double window) { return crystalline(crystalline_phi_local, window); };
  const auto by_phi_local = [&](double least) { return crystalline(least, q6_tolerance); };
  return {{"crystalline_by_q6_window_percent", curve_of(windows, by_window)},
          {"crystalline_by_phi_local_percent", curve_of(thresholds, by_phi_local)},
          {"largest_by_face",
           curve_of({0.0, 0.0025, 0.005, 0.01, 0.015, 0.02, 0.03, 0.04, 0.05, 0.06}, largest)}};
}

}  // namespace

std::vector<Provider> profile_providers() {
  using enum MeasureKind;
  return {
      {.name = "core",
       .parameters = with(surface_criteria(), {{"core_distance_d", core_distance}}),
       .measures = {{"core_grains", "1", "core grains, at least 4 d from the wall surfaces"},
                    {"core_phi", "1", "volume fraction of core grains (Eq. S4)"}},
       .compute = core_of},
      {.name = "profiles",
       .parameters = with(crystal_criteria(), {{"units", "SI"}}),
       .measures = {{"phi_profile", "1", "volume fraction of a layer (Eq. S4)", curve, "",
                     "height_d", "d"},
                    {"pressure_profile_Pa", "Pa", "mean normal stress of a layer, from contacts",
                     curve, "", "height_d", "d"},
                    {"coordination_profile", "1",
                     "contacts per grain of a layer, including contacts with wall grains", curve,
                     "", "height_d", "d"},
                    {"crystalline_profile_percent", "%", "crystalline grains of a layer", curve, "",
                     "height_d", "d"}},
       .compute = profiles_of},
      {.name = "wall_distance",
       .parameters = surface_criteria(),
       .measures =
           {{"phi_by_wall_distance", "1",
             "volume fraction of a layer by its distance from the nearest wall surface (Eq. S4)",
             curve, "", "wall_distance_d", "d"}},
       .compute = wall_distance_of},
      {.name = "sensitivity",
       .parameters = crystal_criteria(),
       .measures =
           {{"crystalline_by_q6_window_percent", "%",
             "crystalline grains by the criterion |q6 - q6 of a lattice| < `q6_window`", curve, "",
             "q6_window", "1"},
            {"crystalline_by_phi_local_percent", "%",
             "crystalline grains by the criterion phi_local > `phi_local_threshold`", curve, "",
             "phi_local_threshold", "1"},
            {"largest_by_face", "1",
             "grains in the largest crystallite, connected by faces of at least `connecting_face` "
             "(area divided by the mean surface of a Voronoi cell)",
             curve, "", "connecting_face", "1"}},
       .compute = sensitivity_of}};
}

}  // namespace shearcell
