// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/analyse.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "analysis/measures.hpp"
#include "provenance/errors.hpp"

namespace shearcell {

Analysis analyse(const Checkpoint& checkpoint) {
  const Cell& cell = checkpoint.cell;
  const WallPose pose = pose_of(checkpoint);
  const Eigen::Matrix3Xd& positions = checkpoint.state.position;
  // In a cell less than 1 d deep a grain would overlap its own periodic image.
  if (!(cell.depth >= 1)) {
    throw AnalysisError(fmt::format("the cell is {:f} d deep; minimum: 1 d", cell.depth));
  }
  Analysis analysis;
  GrainMeasures& grains = analysis.grains;
  grains.cells = voronoi(cell, pose, positions);
  grains.overlaps = overlaps(cell, pose, positions);
  grains.interior = interior_grains(cell, pose, positions);
  const auto& [largest_overlap, contacts, mean_overlap] = grains.overlaps;
  const std::vector<double>& volume = grains.cells.volume;
  const std::size_t count = volume.size();
  for (std::size_t i = 0; i < count; ++i) {
    grains.phi_local.push_back(local_packing_fraction(largest_overlap[i], volume[i]));
    grains.q6.push_back(bond_order_q6(grains.cells.faces_of(i), grains.cells.surface[i]));
    grains.structure.push_back(structure(grains.phi_local[i], grains.q6[i]));
  }
  grains.crystallite = crystallites_of(grains, connecting_face);
  analysis.crystallites = crystallite_map(grains.crystallite, cell, pose, positions);
  analysis.mechanics = mechanics(checkpoint, volume, grains.interior);

  const auto percent = [&](auto... wanted) {
    return percent_of(grains.interior,
                      [&](std::size_t i) { return ((grains.structure[i] == wanted) || ...); });
  };
  const auto [phi, phi_uncorrected] = packing_fractions(largest_overlap, volume, grains.interior);
  const auto touches = std::accumulate(contacts.begin(), contacts.end(), std::int64_t{0});
  analysis.measures = {
      .grains = count,
      .interior_grains = static_cast<std::size_t>(std::ranges::count(grains.interior, 1)),
      .phi = phi,
      .phi_uncorrected = phi_uncorrected,
      .crystalline_percent = percent(Structure::fcc, Structure::hcp),
      .fcc_percent = percent(Structure::fcc),
      .hcp_percent = percent(Structure::hcp),
      .mean_overlap_d = mean_overlap,
      .contacts_per_grain = static_cast<double>(touches) / static_cast<double>(count),
      .crystallites = analysis.crystallites.size.size(),
      .largest_crystallite = static_cast<std::size_t>(analysis.crystallites.largest())};
  return analysis;
}

std::vector<std::int32_t> crystallites_of(const GrainMeasures& grains, double least_share) {
  std::vector<std::uint8_t> crystalline(grains.interior);
  for (std::size_t i = 0; i < crystalline.size(); ++i) {
    if (grains.structure[i] == Structure::disordered) crystalline[i] = 0;
  }
  const auto surface = [&](std::size_t i) { return grains.cells.surface[i]; };
  return crystallites(grains.cells, crystalline, least_share * mean_over(grains.interior, surface));
}

std::vector<Provider> packing_providers() {
  using enum MeasureKind;
  const auto grains_of = [](const MeasureInput& input) -> nlohmann::json {
    const GrainMeasures& grains = input.analysis->grains;
    std::vector<double> pressure = input.analysis->mechanics.grain_pressure;
    const double unit_Pa = mechanical_units(input).stress_Pa;
    for (double& one : pressure) one *= unit_Pa;
    std::vector<std::int32_t> crystallite = grains.crystallite;
    for (std::int32_t& label : crystallite) ++label;
    return {{"phi_local", grains.phi_local},
            {"q6", grains.q6},
            {"overlap", grains.overlaps.largest},
            {"grain_pressure_Pa", pressure},
            {"contacts", grains.overlaps.contacts},
            {"structure", grains.structure},
            {"crystallite", crystallite}};
  };
  return {
      {.name = scalars_provider,
       .parameters = crystal_criteria(),
       .measures = {{"interior_grains", "1",
                     "N_inves, number of grains at least 1.5 d from the wall surfaces", count,
                     "N_inves"},
                    {"phi", "1", "volume fraction of interior grains (Eq. S4)"},
                    {"phi_uncorrected", "1",
                     "phi_u, volume fraction without correction for overlaps (Eq. S2)"},
                    {"crystalline_percent", "%",
                     "percentage of interior grains that are crystalline (FCC or HCP)", number,
                     "percentage crystalline"},
                    {"fcc_percent", "%", "percentage of interior grains that are FCC"},
                    {"hcp_percent", "%", "percentage of interior grains that are HCP"},
                    {"mean_overlap_d", "d", "mean overlap of touching grains (Eq. S3)", number,
                     "mean overlap"},
                    {"contacts_per_grain", "1",
                     "contacts with grains and wall grains, mean over all grains", number,
                     "contacts per grain"},
                    {"crystallites", "1", "number of crystallites of interior grains", count},
                    {"largest_crystallite", "1", "number of grains in the largest crystallite",
                     count}},
       .compute =
           [](const MeasureInput& input) { return nlohmann::json(input.analysis->measures); },
       .read_more =
           [](const nlohmann::json&, Measures& measures) {
             const double phi = measures.number("phi");
             if (phi < 0 || phi > 1) throw AnalysisError("a cached phi is not between 0 and 1");
           }},
      {.name = "grains",
       .parameters = crystal_criteria(),
       .measures = {of_grains("phi_local", "1", "volume fraction in the grain's Voronoi cell",
                              "phi_local", {.low = 0.55, .high = 0.74}),
                    of_grains("q6", "1", "bond order (Eq. S1)", "q6", {.low = 0.2, .high = 0.6}),
                    of_grains("overlap", "d", "largest overlap with a grain or wall grain",
                              "largest overlap", {.low = 0, .high = 0.02}),
                    of_grains("grain_pressure_Pa", "Pa", "mean contact stress in the grain's cell",
                              "pressure", {.low = 0, .high = 3, .parameter = "pressure_Pa"}),
                    of_grains("contacts", "1", "contacts with grains and wall grains", "contacts",
                              {.low = 0, .high = 12, .whole = true}),
                    of_grains("structure", "1", "0 = disordered, 1 = FCC, 2 = HCP", "structure",
                              {.classes = {"disordered", "FCC", "HCP"},
                               .whole = true,
                               .of_wall_grains = -1}),
                    of_grains("crystallite", "1",
                              "crystallite's number (1, 2, ... by lowest grain id); 0 = none",
                              "crystallites", {.whole = true, .of_wall_grains = -1})},
       .compute = grains_of}};
}

}  // namespace shearcell
