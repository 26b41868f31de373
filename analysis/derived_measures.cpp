// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/derived_measures.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "analysis/common_neighbours.hpp"
#include "analysis/crystal.hpp"
#include "analysis/error.hpp"
#include "analysis/motion.hpp"
#include "analysis/packing_fraction.hpp"
#include "analysis/pair_structure.hpp"
#include "analysis/profiles.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

/// Scalars that are cached together: those of Measures itself, or of its Mechanics.
enum class Scalars { own, mechanics };

/// Calls visit(cached name, value) for each; mechanics must exist.
template <Scalars kWhich, class AnyMeasures, class Visit>
void for_each_cached(AnyMeasures& measures, const Visit& visit) {
  for (const auto& [name, unit, meaning, member] : cached_scalar_measures()) {
    if constexpr (kWhich == Scalars::mechanics) {
      const auto* mechanical = std::get_if<MechanicalMember>(&member);
      if (mechanical != nullptr)
        visit(mechanical->cached_as, (*measures.mechanics).*mechanical->value);
    } else {
      if (const auto* value = std::get_if<double Measures::*>(&member)) {
        visit(name, measures.**value);
      } else if (const auto* count = std::get_if<std::size_t Measures::*>(&member)) {
        visit(name, measures.**count);
      }
    }
  }
}

template <Scalars kWhich>
json scalars_of(const MeasureInput& input) {
  json values;
  for_each_cached<kWhich>(input.analysis.measures,
                          [&](std::string_view name, auto value) { values[name] = value; });
  return values;
}

json lattices_of(const MeasureInput& input) {
  const Checkpoint& c = *input.checkpoint;
  const std::vector<Lattice> lattice =
      common_neighbour_analysis(c.cell, pose_of(c), c.state.position);
  const auto percent = [&](Lattice wanted) {
    return percent_of_interior(input.analysis.grains,
                               [&](std::size_t i) { return lattice[i] == wanted; });
  };
  const double fcc = percent(Lattice::fcc), hcp = percent(Lattice::hcp);
  return {{"cna_crystalline_percent", fcc + hcp},
          {"cna_fcc_percent", fcc},
          {"cna_hcp_percent", hcp},
          {"cna_bcc_percent", percent(Lattice::bcc)}};
}

constexpr auto any_grain = [](std::size_t) { return true; };

/// Mean of the finite values of the interior grains for which `selected` holds.
template <class Value, class Selected>
double mean_over(const GrainMeasures& grains, const Value& value, const Selected& selected) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < grains.interior.size(); ++i) {
    if (grains.interior[i] == 0 || !selected(i)) continue;
    const double one = value(i);
    if (!std::isfinite(one)) continue;
    sum += one;
    ++count;
  }
  return sum / count;
}

json motion_of(const MeasureInput& input) {
  const GrainMeasures& grains = input.analysis.grains;
  json values = json::object();
  for (const auto& [cycles, lag] : {std::pair{std::uint64_t{1}, "1_cycle_d2"},
                                    {std::uint64_t{10}, "10_cycles_d2"},
                                    {std::uint64_t{100}, "100_cycles_d2"}}) {
    const Checkpoint* earlier = input.earlier ? input.earlier(cycles) : nullptr;
    if (earlier == nullptr) continue;
    const Motion moved = motion(*earlier, *input.checkpoint);
    const auto square = [&](std::size_t i) {
      return moved.displacement.col(static_cast<Eigen::Index>(i)).squaredNorm();
    };
    const auto nonaffine = [&](std::size_t i) { return moved.nonaffine[i]; };
    values[std::string("msd_") + lag] = mean_over(grains, square, any_grain);
    values[std::string("d2min_") + lag] = mean_over(grains, nonaffine, any_grain);
    if (cycles != 1) continue;
    // Motion over one cycle by the structure of the grains.
    std::vector<std::uint8_t> crystalline;
    for (const Structure structure : grains.structure) {
      crystalline.push_back(structure == Structure::disordered ? 0 : 1);
    }
    const std::vector<std::uint8_t> boundary = crystal_boundary(*input.checkpoint, crystalline);
    const auto returned = [&](std::size_t i) { return square(i) <= reversible_d * reversible_d; };
    const auto inside = [&](std::size_t i) { return crystalline[i] != 0 && boundary[i] == 0; };
    const auto at_boundary = [&](std::size_t i) { return boundary[i] != 0; };
    const auto disordered = [&](std::size_t i) { return crystalline[i] == 0; };
    values["reversible_percent"] = percent_of_interior(grains, returned);
    values["msd_inside_crystal_d2"] = mean_over(grains, square, inside);
    values["msd_crystal_boundary_d2"] = mean_over(grains, square, at_boundary);
    values["msd_disordered_d2"] = mean_over(grains, square, disordered);
  }
  return values;
}

json to_json(const MeasuredCurve& curve) {
  return {{"x", curve.x}, {"y", curve.y}};
}

/// A function of the positions of the interior grains.
MeasuredCurve of_places(decltype(pair_correlation)* compute, const MeasureInput& input) {
  const Checkpoint& c = *input.checkpoint;
  return compute(c.cell, pose_of(c), c.state.position, input.analysis.grains.interior);
}

json pair_correlation_of(const MeasureInput& input) {
  return {{"pair_correlation", to_json(of_places(pair_correlation, input))}};
}

json structure_factor_of(const MeasureInput& input) {
  return {{"structure_factor", to_json(of_places(structure_factor, input))}};
}

json profiles_of(const MeasureInput& input) {
  const Profiles found = profiles(*input.checkpoint, input.analysis.grains);
  const auto against_height = [&](const std::vector<double>& values) {
    return to_json(MeasuredCurve{found.height, values});
  };
  return {{"phi_profile", against_height(found.phi)},
          {"pressure_profile_Pa", against_height(found.pressure)},
          {"coordination_profile", against_height(found.coordination)},
          {"crystalline_profile_percent", against_height(found.crystalline_percent)}};
}

json by_wall_distance(const MeasureInput& input) {
  return {{"phi_by_wall_distance",
           to_json(phi_by_wall_distance(*input.checkpoint, input.analysis.grains))}};
}

json core_of(const MeasureInput& input) {
  const Core found = core(*input.checkpoint, input.analysis.grains);
  return {{"core_grains", found.grains}, {"core_phi", found.phi}};
}

json sensitivity_of(const MeasureInput& input) {
  const GrainMeasures& grains = input.analysis.grains;
  return {{"crystalline_by_q6_window_percent", to_json(crystalline_by_window(grains))},
          {"crystalline_by_phi_local_percent", to_json(crystalline_by_phi_local(grains))},
          {"largest_by_face", to_json(largest_by_face(*input.checkpoint, grains))}};
}

template <Scalars kWhich>
void read_scalars(const json& result, Measures& measures) {
  if (kWhich == Scalars::mechanics && !measures.mechanics) measures.mechanics.emplace();
  for_each_cached<kWhich>(
      measures, [&](std::string_view name, auto& value) { result.at(name).get_to(value); });
  if (measures.phi < 0 || measures.phi > 1) throw AnalysisError("a cached phi is not in 0 to 1");
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
    if (curve.x.size() != curve.y.size()) throw AnalysisError("a cached curve lacks values");
  }
}

/// Calls kRead and turns errors of the JSON library into AnalysisError.
template <void (*kRead)(const json&, Measures&)>
void checked(const json& result, Measures& measures) {
  try {
    kRead(result, measures);
  } catch (const json::exception& problem) {
    throw AnalysisError(std::string("a cached result is not what its name says: ") +
                        problem.what());
  }
}

json with(json parameters, const json& more) {
  parameters.update(more);
  return parameters;
}

json surface() {
  return {{"rough_wall_surface_d", rough_wall_surface}};
}

json interior() {
  return with(surface(), {{"interior_distance_d", interior_distance}});
}

json criteria() {
  return with(interior(), {{"connecting_face", connecting_face},
                           {"crystalline_phi_local", crystalline_phi_local},
                           {"q6_fcc", q6_fcc},
                           {"q6_hcp", q6_hcp},
                           {"q6_tolerance", q6_tolerance}});
}

}  // namespace

std::span<const DerivedMeasure> all_derived_measures() {
  static const std::vector<DerivedMeasure> all = {
      {"scalars", criteria(), scalars_of<Scalars::own>, checked<read_scalars<Scalars::own>>},
      {"mechanics", interior(), scalars_of<Scalars::mechanics>,
       checked<read_scalars<Scalars::mechanics>>},
      {"crystallites", criteria(),
       [](const MeasureInput& input) { return to_json(input.analysis.crystallites); },
       [](const json& result, Measures& measures) {
         measures.crystallite_map = read_crystallite_map(result);
       }},
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
      {"wall_distance", surface(), by_wall_distance, checked<read_curves>},
      {"core", with(surface(), {{"core_distance_d", core_distance}}), core_of,
       checked<read_numbers>},
      {"sensitivity", criteria(), sensitivity_of, checked<read_curves>}};
  return all;
}

const DerivedMeasure& derived_measure(std::string_view name) {
  const auto all = all_derived_measures();
  const auto found = std::ranges::find(all, name, &DerivedMeasure::name);
  if (found == all.end()) throw std::logic_error("no such measure: " + std::string(name));
  return *found;
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
