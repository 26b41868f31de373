// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/measures.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "analysis/bond_order.hpp"
#include "analysis/packing_fraction.hpp"
#include "analysis/voronoi.hpp"

namespace shearcell {
namespace {

/// Mean surface [d^2] of the selected cells; 0 when none is selected, and then nothing uses it.
double mean_surface(const std::vector<double>& surface, const std::vector<std::uint8_t>& selected) {
  double sum = 0;
  double count = 0;
  for (std::size_t i = 0; i < selected.size(); ++i) {
    if (selected[i] == 0) continue;
    sum += surface[i];
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

void find_structures(GrainMeasures& grains) {
  const std::size_t count = grains.q6.size();
  grains.phi_local.resize(count);
  grains.structure.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    grains.phi_local[i] = local_packing_fraction(grains.largest_overlap[i], grains.cell_volume[i]);
    grains.structure[i] = structure(grains.phi_local[i], grains.q6[i]);
  }
}

void find_crystallites(const VoronoiDiagram& diagram, Analysis& analysis) {
  GrainMeasures& grains = analysis.grains;
  std::vector<std::uint8_t> crystalline(grains.structure.size());
  double fcc = 0;
  double hcp = 0;
  for (std::size_t i = 0; i < crystalline.size(); ++i) {
    if (grains.interior[i] == 0) continue;
    crystalline[i] = grains.structure[i] == Structure::disordered ? 0 : 1;
    fcc += grains.structure[i] == Structure::fcc ? 1 : 0;
    hcp += grains.structure[i] == Structure::hcp ? 1 : 0;
  }
  grains.crystallites =
      crystallites(diagram, crystalline, mean_surface(grains.cell_surface, grains.interior));
  Measures& all = analysis.measures;
  const auto interior = static_cast<double>(all.interior_grains);
  all.fcc_percent = 100 * fcc / interior;
  all.hcp_percent = 100 * hcp / interior;
  all.crystalline_percent = 100 * (fcc + hcp) / interior;
  all.crystallites = grains.crystallites.size.size();
  all.largest_crystallite = static_cast<std::size_t>(grains.crystallites.largest);
}

}  // namespace

std::span<const ScalarMeasure> all_scalar_measures() {
  using M = Measures;
  static constexpr ScalarMeasure measures[] = {
      {"grains", "1", "N, number of grains", &M::grains},
      {"interior_grains", "1", "N_inves, grains at least 1.5 d from the wall surfaces",
       &M::interior_grains},
      {"phi", "1", "packing fraction of interior grains (Eq. S4)", &M::phi},
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
      {"pressure_Pa", "Pa", "mean normal stress of interior grains, from contacts",
       MechanicalMember{&Mechanics::pressure, &MechanicalUnits::stress_Pa}},
      {"deviator_Pa", "Pa", "sqrt(s:s / 2) of the deviatoric stress s of interior grains",
       MechanicalMember{&Mechanics::deviator, &MechanicalUnits::stress_Pa}},
      {"stress_xx_Pa", "Pa", "normal stress of interior grains, positive in compression",
       MechanicalMember{&Mechanics::stress_xx, &MechanicalUnits::stress_Pa}},
      {"stress_yy_Pa", "Pa", "normal stress of interior grains, positive in compression",
       MechanicalMember{&Mechanics::stress_yy, &MechanicalUnits::stress_Pa}},
      {"stress_zz_Pa", "Pa", "normal stress of interior grains, positive in compression",
       MechanicalMember{&Mechanics::stress_zz, &MechanicalUnits::stress_Pa}},
      {"stress_xy_Pa", "Pa", "shear stress of interior grains",
       MechanicalMember{&Mechanics::stress_xy, &MechanicalUnits::stress_Pa}},
      {"stress_xz_Pa", "Pa", "shear stress of interior grains",
       MechanicalMember{&Mechanics::stress_xz, &MechanicalUnits::stress_Pa}},
      {"stress_yz_Pa", "Pa", "shear stress of interior grains",
       MechanicalMember{&Mechanics::stress_yz, &MechanicalUnits::stress_Pa}},
      {"kinetic_pressure_Pa", "Pa",
       "kinetic part of the pressure, of velocities less the mean flow",
       MechanicalMember{&Mechanics::kinetic_pressure, &MechanicalUnits::kinetic_stress_Pa}},
      {"coordination", "1", "contacts per interior grain",
       MechanicalMember{&Mechanics::coordination, nullptr}},
      {"rattlers_percent", "%", "interior grains that fewer than four contacts hold",
       MechanicalMember{&Mechanics::rattlers, nullptr}},
      {"coordination_without_rattlers", "1",
       "contacts among interior grains that are not rattlers, per grain",
       MechanicalMember{&Mechanics::coordination_without_rattlers, nullptr}},
      {"force_bottom_x_N", "N", "force of the grains on the bottom wall",
       MechanicalMember{&Mechanics::force_bottom_x, &MechanicalUnits::force_N}},
      {"force_bottom_y_N", "N", "force of the grains on the bottom wall",
       MechanicalMember{&Mechanics::force_bottom_y, &MechanicalUnits::force_N}},
      {"force_top_x_N", "N", "force of the grains on the top wall",
       MechanicalMember{&Mechanics::force_top_x, &MechanicalUnits::force_N}},
      {"force_top_y_N", "N", "force of the grains on the top wall",
       MechanicalMember{&Mechanics::force_top_y, &MechanicalUnits::force_N}},
      {"force_left_x_N", "N", "force of the grains on the left wall",
       MechanicalMember{&Mechanics::force_left_x, &MechanicalUnits::force_N}},
      {"force_left_y_N", "N", "force of the grains on the left wall",
       MechanicalMember{&Mechanics::force_left_y, &MechanicalUnits::force_N}},
      {"force_right_x_N", "N", "force of the grains on the right wall",
       MechanicalMember{&Mechanics::force_right_x, &MechanicalUnits::force_N}},
      {"force_right_y_N", "N", "force of the grains on the right wall",
       MechanicalMember{&Mechanics::force_right_y, &MechanicalUnits::force_N}},
      {"elastic_energy_per_grain_J", "J",
       "elastic energy of all contacts over the number of grains",
       MechanicalMember{&Mechanics::elastic_energy, &MechanicalUnits::elastic_J}},
      {"kinetic_energy_per_grain_J", "J",
       "kinetic energy over the number of grains, half a time step later",
       MechanicalMember{&Mechanics::kinetic_energy, &MechanicalUnits::kinetic_J}},
      {"gravitational_energy_per_grain_J", "J", "weight times mean height above the bottom wall",
       MechanicalMember{&Mechanics::height, &MechanicalUnits::weight_J}},
      {"cna_crystalline_percent", "%",
       "FCC and HCP grains among interior grains, by common neighbour analysis",
       NumberOf{"lattices"}},
      {"cna_fcc_percent", "%", "FCC grains likewise", NumberOf{"lattices"}},
      {"cna_hcp_percent", "%", "HCP grains likewise", NumberOf{"lattices"}},
      {"cna_bcc_percent", "%", "BCC grains likewise", NumberOf{"lattices"}},
      {"msd_1_cycle_d2", "d^2",
       "mean squared displacement of interior grains over 1 cycle, in the frame of the walls",
       NumberOf{"motion"}},
      {"msd_10_cycles_d2", "d^2", "the same over 10 cycles", NumberOf{"motion"}},
      {"msd_100_cycles_d2", "d^2", "the same over 100 cycles", NumberOf{"motion"}},
      {"d2min_1_cycle_d2", "d^2",
       "mean non-affine squared displacement D^2_min of interior grains over 1 cycle",
       NumberOf{"motion"}},
      {"d2min_10_cycles_d2", "d^2", "the same over 10 cycles", NumberOf{"motion"}},
      {"d2min_100_cycles_d2", "d^2", "the same over 100 cycles", NumberOf{"motion"}},
      {"reversible_percent", "%",
       "interior grains at most 0.01 d from where they were a cycle before", NumberOf{"motion"}},
      {"msd_inside_crystal_d2", "d^2",
       "mean squared displacement over 1 cycle of crystalline grains among crystalline ones",
       NumberOf{"motion"}},
      {"msd_crystal_boundary_d2", "d^2", "the same of crystalline grains with other neighbours",
       NumberOf{"motion"}},
      {"msd_disordered_d2", "d^2", "the same of grains that are not crystalline",
       NumberOf{"motion"}},
      {"shear_strain", "1", "tan(theta), theta the tilt of the side walls", NumberOf{"drive"}},
      {"shear_rate_per_s", "1/s", "rate of change of shear_strain", NumberOf{"drive"}},
      {"work_of_walls_per_cycle_J", "J",
       "work of the tilting walls on all grains in the cycle that ends here", NumberOf{"ledger"}},
      {"dissipation_per_cycle_J", "J",
       "energy that all grains and the moving wall lost by drag in that cycle", NumberOf{"ledger"}},
      {"energy_stored_per_cycle_J", "J",
       "change of all elastic, kinetic and gravitational energy and of the load's in that cycle",
       NumberOf{"ledger"}}};
  return measures;
}

std::string_view ScalarMeasure::derived() const {
  if (const auto* number = std::get_if<NumberOf>(&member)) return number->derived;
  return std::holds_alternative<MechanicalMember>(member) ? "mechanics" : "scalars";
}

std::span<const CurveMeasure> all_curve_measures() {
  static constexpr CurveMeasure measures[] = {
      {"pair_correlation", "1", "g(r) of interior grains", "distance_d", "d", "pair_correlation"},
      {"structure_factor", "1", "S(k) of interior grains", "wave_number_per_d", "1/d",
       "structure_factor"},
      {"phi_profile", "1", "packing fraction of a layer (Eq. S4)", "height_d", "d", "profiles"},
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
       "grains in the largest crystallite, if faces connect from this share of a mean cell surface",
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
  const auto all = all_curve_measures();
  const auto found = std::ranges::find(all, name, &CurveMeasure::name);
  return found == all.end() ? nullptr : &*found;
}

double ScalarMeasure::of(const Measures& measures) const {
  if (const auto* mechanical = std::get_if<MechanicalMember>(&member)) {
    const double value = measures.mechanics.*mechanical->value;
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
  const auto all = all_scalar_measures();
  const auto found = std::ranges::find(all, name, &ScalarMeasure::name);
  return found == all.end() ? nullptr : &*found;
}

Analysis analyse(const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& positions) {
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

  find_structures(grains);
  find_crystallites(diagram, analysis);
  analysis.crystallites = crystallite_map(grains.crystallites, cell, pose, positions);
  return analysis;
}

Analysis analyse(const Checkpoint& checkpoint) {
  const WallPose pose = wall_pose(checkpoint.cell, checkpoint.theta, checkpoint.state.wall_height);
  Analysis analysis = analyse(checkpoint.cell, pose, checkpoint.state.position);
  GrainMeasures& grains = analysis.grains;
  PackingMechanics found = mechanics(checkpoint, grains.cell_volume, grains.interior);
  analysis.measures.mechanics = found.packing;
  grains.pressure = std::move(found.grain_pressure);
  return analysis;
}

Measures measure(const Checkpoint& checkpoint) {
  return analyse(checkpoint).measures;
}

}  // namespace shearcell
