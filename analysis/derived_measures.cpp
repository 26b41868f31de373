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
  const Measures& m = analysis.measures;
  return {{"grains", m.grains},
          {"interior_grains", m.interior_grains},
          {"phi", m.phi},
          {"phi_uncorrected", m.phi_uncorrected},
          {"crystalline_percent", m.crystalline_percent},
          {"fcc_percent", m.fcc_percent},
          {"hcp_percent", m.hcp_percent},
          {"mean_overlap_d", m.mean_overlap},
          {"contacts_per_grain", m.contacts_per_grain},
          {"crystallites", m.crystallites},
          {"largest_crystallite", m.largest_crystallite}};
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
    result.at("grains").get_to(m.grains);
    result.at("interior_grains").get_to(m.interior_grains);
    result.at("phi").get_to(m.phi);
    result.at("phi_uncorrected").get_to(m.phi_uncorrected);
    result.at("crystalline_percent").get_to(m.crystalline_percent);
    result.at("fcc_percent").get_to(m.fcc_percent);
    result.at("hcp_percent").get_to(m.hcp_percent);
    result.at("mean_overlap_d").get_to(m.mean_overlap);
    result.at("contacts_per_grain").get_to(m.contacts_per_grain);
    result.at("crystallites").get_to(m.crystallites);
    result.at("largest_crystallite").get_to(m.largest_crystallite);
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
  if (result.is_discarded()) throw AnalysisError("a kept result is no CBOR");
  return result;
}

}  // namespace shearcell
