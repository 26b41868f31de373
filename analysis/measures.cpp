// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/measures.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "analysis/error.hpp"
#include "analysis/packing_fraction.hpp"
#include "analysis/voronoi.hpp"
#include "core/named.hpp"

namespace shearcell {
namespace {

void find_crystallites(const VoronoiDiagram& diagram, Analysis& analysis) {
  GrainMeasures& grains = analysis.grains;
  grains.crystallites =
      crystallites(diagram, crystalline_interior(grains), connecting_face * mean_surface(grains));
  const auto percent = [&](auto... wanted) {
    return percent_of_interior(
        grains, [&](std::size_t i) { return ((grains.structure[i] == wanted) || ...); });
  };
  Measures& all = analysis.measures;
  all.fcc_percent = percent(Structure::fcc);
  all.hcp_percent = percent(Structure::hcp);
  all.crystalline_percent = percent(Structure::fcc, Structure::hcp);
  all.crystallites = grains.crystallites.size.size();
  all.largest_crystallite = static_cast<std::size_t>(grains.crystallites.largest);
}

}  // namespace

std::span<const ScalarMeasure> cached_scalar_measures() {
  using M = Measures;
  using F = Mechanics;
  using U = MechanicalUnits;
  static constexpr ScalarMeasure measures[] = {
      {"grains", "1", "N, number of grains", &M::grains},
      {"interior_grains", "1", "N_inves, grains at least 1.5 d from the wall surfaces",
       &M::interior_grains},
      {"phi", "1", "volume fraction of interior grains (Eq. S4)", &M::phi},
      {"phi_uncorrected", "1", "phi_u, the same without a correction for overlaps (Eq. S2)",
       &M::phi_uncorrected},
      {"crystalline_percent", "%", "crystalline grains among interior grains",
       &M::crystalline_percent},
      {"fcc_percent", "%", "FCC grains among interior grains", &M::fcc_percent},
      {"hcp_percent", "%", "HCP grains among interior grains", &M::hcp_percent},
      {"mean_overlap_d", "d", "mean overlap of touching grains (Eq. S3)", &M::mean_overlap},
      {"contacts_per_grain", "1", "contacts with grains and wall grains, mean over all grains",
       &M::contacts_per_grain},
      {"crystallites", "1", "number of crystallites of interior grains", &M::crystallites},
      {"largest_crystallite", "1", "grains in the largest crystallite", &M::largest_crystallite},
      {"contact_pressure_Pa", "Pa", "mean normal stress of interior grains, from contacts",
       MechanicalMember{"pressure_k_per_d", &F::pressure, &U::stress_Pa}},
      {"deviator_Pa", "Pa", "sqrt(s:s / 2) of the deviatoric stress s of interior grains",
       MechanicalMember{"deviator_k_per_d", &F::deviator, &U::stress_Pa}},
      {"stress_xx_Pa", "Pa", "normal stress of interior grains, positive in compression",
       MechanicalMember{"stress_xx_k_per_d", &F::stress_xx, &U::stress_Pa}},
      {"stress_yy_Pa", "Pa", "normal stress of interior grains, positive in compression",
       MechanicalMember{"stress_yy_k_per_d", &F::stress_yy, &U::stress_Pa}},
      {"stress_zz_Pa", "Pa", "normal stress of interior grains, positive in compression",
       MechanicalMember{"stress_zz_k_per_d", &F::stress_zz, &U::stress_Pa}},
      {"stress_xy_Pa", "Pa",
       "shear stress of interior grains, with the sign of the others: a growing shear_strain makes "
       "it negative",
       MechanicalMember{"stress_xy_k_per_d", &F::stress_xy, &U::stress_Pa}},
      {"stress_xz_Pa", "Pa", "shear stress of interior grains",
       MechanicalMember{"stress_xz_k_per_d", &F::stress_xz, &U::stress_Pa}},
      {"stress_yz_Pa", "Pa", "shear stress of interior grains",
       MechanicalMember{"stress_yz_k_per_d", &F::stress_yz, &U::stress_Pa}},
      {"kinetic_pressure_Pa", "Pa",
       "kinetic part of the pressure, of velocities less the mean flow",
       MechanicalMember{"kinetic_pressure_m_per_d_s2", &F::kinetic_pressure,
                        &U::kinetic_stress_Pa}},
      {"coordination", "1", "contacts per interior grain",
       MechanicalMember{"coordination", &F::coordination, nullptr}},
      {"rattlers_percent", "%",
       "interior grains with fewer than four contacts with walls and grains that are not rattlers",
       MechanicalMember{"rattlers_percent", &F::rattlers, nullptr}},
      {"coordination_without_rattlers", "1",
       "contacts of interior grains that are not rattlers with walls and such grains, per such "
       "grain",
       MechanicalMember{"coordination_without_rattlers", &F::coordination_without_rattlers,
                        nullptr}},
      {"force_bottom_x_N", "N", "force of the grains on the bottom wall",
       MechanicalMember{"force_bottom_x_k_d", &F::force_bottom_x, &U::force_N}},
      {"force_bottom_y_N", "N", "force of the grains on the bottom wall",
       MechanicalMember{"force_bottom_y_k_d", &F::force_bottom_y, &U::force_N}},
      {"force_top_x_N", "N", "force of the grains on the top wall",
       MechanicalMember{"force_top_x_k_d", &F::force_top_x, &U::force_N}},
      {"force_top_y_N", "N", "force of the grains on the top wall",
       MechanicalMember{"force_top_y_k_d", &F::force_top_y, &U::force_N}},
      {"force_left_x_N", "N", "force of the grains on the left wall",
       MechanicalMember{"force_left_x_k_d", &F::force_left_x, &U::force_N}},
      {"force_left_y_N", "N", "force of the grains on the left wall",
       MechanicalMember{"force_left_y_k_d", &F::force_left_y, &U::force_N}},
      {"force_right_x_N", "N", "force of the grains on the right wall",
       MechanicalMember{"force_right_x_k_d", &F::force_right_x, &U::force_N}},
      {"force_right_y_N", "N", "force of the grains on the right wall",
       MechanicalMember{"force_right_y_k_d", &F::force_right_y, &U::force_N}},
      {"elastic_energy_per_grain_J", "J",
       "elastic energy of all contacts over the number of grains",
       MechanicalMember{"elastic_energy_per_grain_k_d2", &F::elastic_energy, &U::elastic_J}},
      {"kinetic_energy_per_grain_J", "J",
       "kinetic energy over the number of grains, half a time step earlier",
       MechanicalMember{"kinetic_energy_per_grain_m_d2_per_s2", &F::kinetic_energy, &U::kinetic_J}},
      {"gravitational_energy_per_grain_J", "J", "weight times mean height above the bottom wall",
       MechanicalMember{"height_d", &F::height, &U::weight_J}},
      {"cna_crystalline_percent", "%",
       "FCC and HCP grains among interior grains, by common neighbour analysis",
       NumberOf{"lattices"}},
      {"cna_fcc_percent", "%", "FCC grains likewise", NumberOf{"lattices"}},
      {"cna_hcp_percent", "%", "HCP grains likewise", NumberOf{"lattices"}},
      {"cna_bcc_percent", "%", "BCC grains likewise", NumberOf{"lattices"}},
      {"core_grains", "1", "grains at least 4 d from the wall surfaces", NumberOf{"core"}},
      {"core_phi", "1", "volume fraction of those grains (Eq. S4)", NumberOf{"core"}},
      {"msd_1_cycle_d2", "d^2",
       "mean squared displacement of interior grains over 1 cycle, in the frame of the walls",
       NumberOf{"motion", 1}},
      {"msd_10_cycles_d2", "d^2", "the same over 10 cycles", NumberOf{"motion", 10}},
      {"msd_100_cycles_d2", "d^2", "the same over 100 cycles", NumberOf{"motion", 100}},
      {"d2min_1_cycle_d2", "d^2",
       "mean non-affine squared displacement D^2_min of interior grains over 1 cycle",
       NumberOf{"motion", 1}},
      {"d2min_10_cycles_d2", "d^2", "the same over 10 cycles", NumberOf{"motion", 10}},
      {"d2min_100_cycles_d2", "d^2", "the same over 100 cycles", NumberOf{"motion", 100}},
      {"reversible_percent", "%",
       "interior grains at most 0.01 d from where they were a cycle before", NumberOf{"motion", 1}},
      {"msd_inside_crystal_d2", "d^2",
       "mean squared displacement over 1 cycle of crystalline grains among crystalline ones",
       NumberOf{"motion", 1}},
      {"msd_crystal_boundary_d2", "d^2", "the same of crystalline grains with other neighbours",
       NumberOf{"motion", 1}},
      {"msd_disordered_d2", "d^2", "the same of grains that are not crystalline",
       NumberOf{"motion", 1}},
      {"shear_strain", "1", "tan(theta), theta the tilt of the side walls", NumberOf{"drive"}},
      {"shear_rate_per_s", "1/s",
       "rate of change of shear_strain; after a pause, of the shear that follows",
       NumberOf{"drive"}},
      {"work_of_walls_per_cycle_J", "J",
       "work of the tilting walls on all grains in the cycle that ends here",
       NumberOf{"ledger", 1}},
      {"dissipation_per_cycle_J", "J",
       "energy that all grains and the moving wall lost by drag in that cycle",
       NumberOf{"ledger", 1}},
      {"energy_stored_per_cycle_J", "J",
       "change of all elastic, kinetic and gravitational energy and of the load's in that cycle",
       NumberOf{"ledger", 1}}};
  return measures;
}

std::span<const ScalarMeasure> all_scalar_measures() {
  return cached_scalar_measures().subspan(1);
}

std::string_view ScalarMeasure::derived() const {
  if (const auto* number = std::get_if<NumberOf>(&member)) return number->derived;
  return std::holds_alternative<MechanicalMember>(member) ? "mechanics" : "scalars";
}

std::uint64_t ScalarMeasure::cycles_back() const {
  const auto* number = std::get_if<NumberOf>(&member);
  return number == nullptr ? 0 : number->cycles_back;
}

std::span<const CurveMeasure> all_curve_measures() {
  static constexpr CurveMeasure measures[] = {
      {"pair_correlation", "1", "g(r) of interior grains", "distance_d", "d", "pair_correlation"},
      {"structure_factor", "1", "S(k) of interior grains", "wave_number_per_d", "1/d",
       "structure_factor"},
      {"phi_profile", "1", "volume fraction of a layer (Eq. S4)", "height_d", "d", "profiles"},
      {"phi_by_wall_distance", "1",
       "volume fraction of a layer by its distance from the nearest wall surface (Eq. S4)",
       "wall_distance_d", "d", "wall_distance"},
      {"pressure_profile_Pa", "Pa", "mean normal stress of a layer, from contacts", "height_d", "d",
       "profiles", &MechanicalUnits::stress_Pa},
      {"coordination_profile", "1", "contacts per grain of a layer, with grains and wall grains",
       "height_d", "d", "profiles"},
      {"crystalline_profile_percent", "%", "crystalline grains of a layer", "height_d", "d",
       "profiles"},
      {"crystalline_by_q6_window_percent", "%",
       "crystalline grains, if |q6 - q6 of a lattice| is below this", "q6_window", "1",
       "sensitivity"},
      {"crystalline_by_phi_local_percent", "%", "crystalline grains, if phi_local is above this",
       "phi_local_threshold", "1", "sensitivity"},
      {"largest_by_face", "1",
       "grains in the largest crystallite, if grains are connected by faces of at least this share "
       "of the mean cell surface",
       "connecting_face", "1", "sensitivity"}};
  return measures;
}

MeasuredCurve CurveMeasure::of(const Measures& measures) const {
  const auto found = measures.curves.find(name);
  if (found == measures.curves.end()) return {};
  MeasuredCurve curve = found->second;
  if (si != nullptr) {
    for (double& y : curve.y) y *= measures.units.*si;
  }
  return curve;
}

const CurveMeasure* find_curve_measure(std::string_view name) {
  return find_named(all_curve_measures(), name);
}

double ScalarMeasure::of(const Measures& measures) const {
  if (const auto* mechanical = std::get_if<MechanicalMember>(&member)) {
    if (!measures.mechanics) return std::nan("");
    const double value = (*measures.mechanics).*mechanical->value;
    return mechanical->unit == nullptr ? value : value * (measures.units.*mechanical->unit);
  }
  if (const auto* count = std::get_if<std::size_t Measures::*>(&member)) {
    return static_cast<double>(measures.**count);
  }
  if (std::holds_alternative<NumberOf>(member)) {
    const auto found = measures.numbers.find(name);
    return found == measures.numbers.end() ? std::nan("") : found->second;
  }
  return measures.*std::get<double Measures::*>(member);
}

const ScalarMeasure* find_measure(std::string_view name) {
  return find_named(all_scalar_measures(), name);
}

Analysis analyse(const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& positions) {
  // In a shallower cell a grain would overlap its own image.
  if (!(cell.depth >= 1)) {
    throw AnalysisError("the cell is " + std::to_string(cell.depth) + " d deep; 1 d is the least");
  }
  Analysis analysis;
  Measures& all = analysis.measures;
  GrainMeasures& grains = analysis.grains;

  VoronoiDiagram diagram = voronoi(cell, pose, positions);
  grains.q6 = bond_order_q6(diagram);
  grains.cell_volume = std::move(diagram.volume);
  grains.cell_surface = std::move(diagram.surface);
  Overlaps contact = overlaps(cell, pose, positions);
  grains.largest_overlap = std::move(contact.largest);
  grains.contacts = std::move(contact.contacts);
  grains.interior = interior_grains(cell, pose, positions);

  all.grains = grains.q6.size();
  all.interior_grains = static_cast<std::size_t>(
      std::count(grains.interior.begin(), grains.interior.end(), std::uint8_t{1}));
  const PackingFractions fractions =
      packing_fractions(grains.largest_overlap, grains.cell_volume, grains.interior);
  all.phi = fractions.phi;
  all.phi_uncorrected = fractions.phi_uncorrected;
  all.mean_overlap = contact.mean;
  const auto contacts =
      std::accumulate(grains.contacts.begin(), grains.contacts.end(), std::int64_t{0});
  all.contacts_per_grain = static_cast<double>(contacts) / static_cast<double>(all.grains);

  for (std::size_t i = 0; i < all.grains; ++i) {
    grains.phi_local.push_back(
        local_packing_fraction(grains.largest_overlap[i], grains.cell_volume[i]));
    grains.structure.push_back(structure(grains.phi_local[i], grains.q6[i]));
  }
  find_crystallites(diagram, analysis);
  analysis.crystallites = crystallite_map(grains.crystallites, cell, pose, positions);
  return analysis;
}

Analysis analyse(const Checkpoint& checkpoint) {
  Analysis analysis = analyse(checkpoint.cell, pose_of(checkpoint), checkpoint.state.position);
  GrainMeasures& grains = analysis.grains;
  PackingMechanics found = mechanics(checkpoint, grains.cell_volume, grains.interior);
  analysis.measures.mechanics = found.packing;
  grains.pressure = std::move(found.grain_pressure);
  return analysis;
}

std::vector<std::uint8_t> crystalline_interior(const GrainMeasures& grains) {
  std::vector<std::uint8_t> crystalline(grains.interior);
  for (std::size_t i = 0; i < crystalline.size(); ++i) {
    if (grains.structure[i] == Structure::disordered) crystalline[i] = 0;
  }
  return crystalline;
}

double mean_surface(const GrainMeasures& grains) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < grains.interior.size(); ++i) {
    if (grains.interior[i] == 0) continue;
    sum += grains.cell_surface[i];
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

}  // namespace shearcell
