// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/derived_measures.hpp"

#include "analysis/crystal.hpp"
#include "analysis/error.hpp"
#include "analysis/packing_fraction.hpp"
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
          if constexpr (requires(Measures & m) { m.*member; }) visit(scalar.name, member);
        },
        scalar.member);
  }
}

json scalars_of(const Analysis& analysis) {
  json scalars;
  for_each_kept(
      [&](std::string_view name, auto member) { scalars[name] = analysis.measures.*member; });
  return scalars;
}

json mechanics_of(const Analysis& analysis) {
  json kept;
  for (const auto& [name, member] : all_mechanical_quantities()) {
    kept[name] = analysis.measures.mechanics.*member;
  }
  return kept;
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

}  // namespace

const DerivedMeasure& scalar_measures() {
  static const DerivedMeasure measure{"scalars", criteria(), scalars_of};
  return measure;
}

const DerivedMeasure& mechanics_measure() {
  static const DerivedMeasure measure{
      "mechanics",
      {{"interior_distance_d", interior_distance}, {"rough_wall_surface_d", rough_wall_surface}},
      mechanics_of};
  return measure;
}

const DerivedMeasure& crystallite_measure() {
  static const DerivedMeasure measure{"crystallites", criteria(), [](const Analysis& analysis) {
                                        return to_json(analysis.crystallites);
                                      }};
  return measure;
}

Measures read_measures(const json& result) {
  Measures m;
  try {
    for_each_kept([&](std::string_view name, auto member) { result.at(name).get_to(m.*member); });
  } catch (const json::exception& problem) {
    throw AnalysisError(std::string("these are not the scalars of a checkpoint: ") +
                        problem.what());
  }
  return m;
}

Mechanics read_mechanics(const json& result) {
  Mechanics m;
  try {
    for (const auto& [name, member] : all_mechanical_quantities()) {
      result.at(name).get_to(m.*member);
    }
  } catch (const json::exception& problem) {
    throw AnalysisError(std::string("these are not the mechanics of a checkpoint: ") +
                        problem.what());
  }
  return m;
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
