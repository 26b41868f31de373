// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/derived_measures.hpp"

#include "analysis/crystal.hpp"
#include "analysis/error.hpp"
#include "analysis/packing_fraction.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

json scalars_of(const Analysis& analysis) {
  json scalars;
  for (const ScalarMeasure& scalar : all_scalar_measures()) {
    std::visit([&](auto member) { scalars[scalar.name] = analysis.measures.*member; },
               scalar.member);
  }
  return scalars;
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

const DerivedMeasure& crystallite_measure() {
  static const DerivedMeasure measure{"crystallites", criteria(), [](const Analysis& analysis) {
                                        return to_json(analysis.crystallites);
                                      }};
  return measure;
}

Measures read_measures(const json& result) {
  Measures m;
  try {
    for (const ScalarMeasure& scalar : all_scalar_measures()) {
      std::visit([&](auto member) { result.at(scalar.name).get_to(m.*member); }, scalar.member);
    }
  } catch (const json::exception& problem) {
    throw AnalysisError(std::string("these are not the scalars of a checkpoint: ") +
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
