// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/derived_measures.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "analysis/common_neighbours.hpp"
#include "analysis/crystal.hpp"
#include "analysis/error.hpp"
#include "analysis/motion.hpp"
#include "analysis/packing_fraction.hpp"
#include "analysis/pair_structure.hpp"
#include "analysis/profiles.hpp"
#include "analysis/sensitivity.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

/// Calls visit(name, member) for those that are kept together.
template <class Visit>
void for_each_kept(Visit&& visit) {
  for (const ScalarMeasure& scalar : all_scalar_measures()) {
    std::visit(
        [&](auto member) {
          if constexpr (std::is_member_pointer_v<decltype(member)>) visit(scalar.name, member);
        },
        scalar.member);
  }
}

json scalars_of(const MeasureInput& input) {
  json scalars;
  for_each_kept(
      [&](std::string_view name, auto member) { scalars[name] = input.analysis.measures.*member; });
  return scalars;
}

json mechanics_of(const MeasureInput& input) {
  json kept;
  for (const auto& [name, member] : all_mechanical_quantities()) {
    kept[name] = input.analysis.measures.mechanics.*member;
  }
  return kept;
}

json crystallites_of(const MeasureInput& input) {
  return to_json(input.analysis.crystallites);
}

WallPose pose_of(const Checkpoint& checkpoint) {
  return wall_pose(checkpoint.cell, checkpoint.theta, checkpoint.state.wall_height);
}

json lattices_of(const MeasureInput& input) {
  const Checkpoint& checkpoint = *input.checkpoint;
  const std::vector<Lattice> lattice =
      common_neighbour_analysis(checkpoint.cell, pose_of(checkpoint), checkpoint.state.position);
  const std::vector<std::uint8_t>& interior = input.analysis.grains.interior;
  const auto percent = [&](Lattice wanted) {
    double found = 0;
    for (std::size_t i = 0; i < lattice.size(); ++i) {
      found += interior[i] != 0 && lattice[i] == wanted ? 1 : 0;
    }
    return 100 * found / static_cast<double>(input.analysis.measures.interior_grains);
  };
  const double fcc = percent(Lattice::fcc), hcp = percent(Lattice::hcp);
  return {{"cna_crystalline_percent", fcc + hcp},
          {"cna_fcc_percent", fcc},
          {"cna_hcp_percent", hcp},
          {"cna_bcc_percent", percent(Lattice::bcc)}};
}

/// Over the interior grains for which `selected` holds and the value is a number.
template <class Value, class Selected>
double mean_over(const std::vector<std::uint8_t>& interior, Value&& value, Selected&& selected) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < interior.size(); ++i) {
    if (interior[i] == 0 || !selected(i)) continue;
    const double one = value(i);
    if (!std::isfinite(one)) continue;
    sum += one;
    ++count;
  }
  return sum / count;
}

/// How grains of each structure moved over one cycle.
void add_by_structure(const MeasureInput& input, const Motion& moved, json& kept) {
  const GrainMeasures& grains = input.analysis.grains;
  std::vector<std::uint8_t> crystalline;
  for (const Structure structure : grains.structure) {
    crystalline.push_back(structure == Structure::disordered ? 0 : 1);
  }
  const std::vector<std::uint8_t> boundary = crystal_boundary(*input.checkpoint, crystalline);
  const auto square = [&](std::size_t i) {
    return moved.displacement.col(static_cast<Eigen::Index>(i)).squaredNorm();
  };
  const auto mean = [&](auto&& value, auto&& selected) {
    return mean_over(grains.interior, value, selected);
  };
  kept["reversible_percent"] =
      mean([&](std::size_t i) { return square(i) <= reversible_d * reversible_d ? 100.0 : 0.0; },
           [](std::size_t) { return true; });
  kept["msd_inside_crystal_d2"] =
      mean(square, [&](std::size_t i) { return crystalline[i] != 0 && boundary[i] == 0; });
  kept["msd_crystal_boundary_d2"] = mean(square, [&](std::size_t i) { return boundary[i] != 0; });
  kept["msd_disordered_d2"] = mean(square, [&](std::size_t i) { return crystalline[i] == 0; });
}

json motion_of(const MeasureInput& input) {
  json kept = json::object();
  for (const auto& [cycles, lag] : {std::pair{std::uint64_t{1}, "1_cycle_d2"},
                                    {std::uint64_t{10}, "10_cycles_d2"},
                                    {std::uint64_t{100}, "100_cycles_d2"}}) {
    const Checkpoint* earlier = input.earlier ? input.earlier(cycles) : nullptr;
    if (earlier == nullptr) continue;
    const Motion moved = motion(*earlier, *input.checkpoint);
    const auto mean = [&](auto&& value) {
      return mean_over(input.analysis.grains.interior, value, [](std::size_t) { return true; });
    };
    kept[std::string("msd_") + lag] = mean([&](std::size_t i) {
      return moved.displacement.col(static_cast<Eigen::Index>(i)).squaredNorm();
    });
    kept[std::string("d2min_") + lag] = mean([&](std::size_t i) { return moved.nonaffine[i]; });
    if (cycles == 1) add_by_structure(input, moved, kept);
  }
  return kept;
}

json curve(std::vector<double> x, std::vector<double> y) {
  return {{"x", std::move(x)}, {"y", std::move(y)}};
}

json binned(const MeasureInput& input,
            BinnedFunction (*compute)(const Cell&, const WallPose&, const Eigen::Matrix3Xd&,
                                      std::span<const std::uint8_t>)) {
  const Checkpoint& checkpoint = *input.checkpoint;
  BinnedFunction found = compute(checkpoint.cell, pose_of(checkpoint), checkpoint.state.position,
                                 input.analysis.grains.interior);
  return curve(std::move(found.x), std::move(found.y));
}

json pair_correlation_of(const MeasureInput& input) {
  return {{"pair_correlation", binned(input, pair_correlation)}};
}

json structure_factor_of(const MeasureInput& input) {
  return {{"structure_factor", binned(input, structure_factor)}};
}

json profiles_of(const MeasureInput& input) {
  const Profiles found = profiles(*input.checkpoint, input.analysis.grains);
  return {{"phi_profile", curve(found.height, found.phi)},
          {"pressure_profile_Pa", curve(found.height, found.pressure)},
          {"coordination_profile", curve(found.height, found.coordination)},
          {"crystalline_profile_percent", curve(found.height, found.crystalline_percent)}};
}

json sensitivity_of(const MeasureInput& input) {
  const GrainMeasures& grains = input.analysis.grains;
  const auto of = [](Sensitivity found) {
    return curve(std::move(found.criterion), std::move(found.result));
  };
  return {{"crystalline_by_q6_window_percent", of(crystalline_by_window(grains))},
          {"crystalline_by_phi_local_percent", of(crystalline_by_phi_local(grains))},
          {"largest_by_face", of(largest_by_face(*input.checkpoint, grains))}};
}

void read_scalars(const json& result, Measures& measures) {
  for_each_kept(
      [&](std::string_view name, auto member) { result.at(name).get_to(measures.*member); });
}

void read_mechanics(const json& result, Measures& measures) {
  for (const auto& [name, member] : all_mechanical_quantities()) {
    result.at(name).get_to(measures.mechanics.*member);
  }
}

void read_numbers(const json& result, Measures& measures) {
  for (const auto& [name, value] : result.items()) {
    measures.numbers.insert_or_assign(name, value.get<double>());
  }
}

void read_curves(const json& result, Measures& measures) {
  for (const auto& [name, value] : result.items()) {
    MeasuredCurve& curve = measures.curves[name];
    value.at("x").get_to(curve.x);
    value.at("y").get_to(curve.y);
    if (curve.x.size() != curve.y.size()) throw AnalysisError("a kept curve lacks values");
  }
}

/// kRead, with an error for people where the result is not what it was kept as.
template <void (*kRead)(const json&, Measures&)>
void checked(const json& result, Measures& measures) {
  try {
    kRead(result, measures);
  } catch (const json::exception& problem) {
    throw AnalysisError(std::string("a kept result is not what its name says: ") + problem.what());
  }
}

json interior() {
  return {{"interior_distance_d", interior_distance}, {"rough_wall_surface_d", rough_wall_surface}};
}

json criteria() {
  return {{"connecting_face", connecting_face},
          {"crystalline_phi_local", crystalline_phi_local},
          {"interior_distance_d", interior_distance},
          {"q6_fcc", q6_fcc},
          {"q6_hcp", q6_hcp},
          {"q6_tolerance", q6_tolerance},
          {"rough_wall_surface_d", rough_wall_surface}};
}

json with(json parameters, const json& more) {
  parameters.update(more);
  return parameters;
}

std::vector<DerivedMeasure> make_all() {
  return {{"scalars", criteria(), scalars_of, checked<read_scalars>},
          {"mechanics", interior(), mechanics_of, checked<read_mechanics>},
          {"crystallites", criteria(), crystallites_of},
          {"lattices", interior(), lattices_of, checked<read_numbers>},
          {"motion",
           with(criteria(), {{"neighbour_d", motion_neighbour_d}, {"reversible_d", reversible_d}}),
           motion_of,
           checked<read_numbers>,
           {1, 10, 100}},
          {"pair_correlation", with(interior(), {{"bin_d", pair_bin_d}, {"reach_d", pair_reach_d}}),
           pair_correlation_of, checked<read_curves>},
          {"structure_factor",
           with(interior(), {{"bin_per_d", wave_bin_per_d}, {"largest_per_d", largest_wave_per_d}}),
           structure_factor_of, checked<read_curves>},
          {"profiles", criteria(), profiles_of, checked<read_curves>},
          {"sensitivity", criteria(), sensitivity_of, checked<read_curves>}};
}

}  // namespace

std::span<const DerivedMeasure> all_derived_measures() {
  static const std::vector<DerivedMeasure> all = make_all();
  return all;
}

const DerivedMeasure& derived_measure(std::string_view name) {
  const auto all = all_derived_measures();
  const auto found = std::ranges::find(all, name, &DerivedMeasure::name);
  if (found == all.end()) throw std::logic_error("no such measure: " + std::string(name));
  return *found;
}

const DerivedMeasure& scalar_measures() {
  return derived_measure("scalars");
}

const DerivedMeasure& crystallite_measure() {
  return derived_measure("crystallites");
}

Measures read_measures(const json& result) {
  Measures measures;
  scalar_measures().read(result, measures);
  return measures;
}

std::vector<std::byte> encode_result(const json& result) {
  const std::vector<std::uint8_t> cbor = json::to_cbor(result);
  const auto bytes = std::as_bytes(std::span(cbor));
  return {bytes.begin(), bytes.end()};
}

json decode_result(std::span<const std::byte> bytes) {
  json result = parse_cbor(bytes);
  if (result.is_discarded()) throw AnalysisError("a cached result is not CBOR");
  return result;
}

}  // namespace shearcell
