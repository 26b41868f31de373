// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/measures.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "analysis/packing_fraction.hpp"
#include "core/named.hpp"
#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {

using nlohmann::json;

// Each function is defined in the file that computes its measures.
using MakeProviders = std::vector<Provider>();
MakeProviders packing_providers, crystallite_providers, mechanics_providers, lattice_providers,
    pair_structure_providers, profile_providers, motion_providers, onset_providers, run_providers;

std::span<const Provider> all_providers() {
  static const std::vector<Provider> all = [] {
    std::vector<Provider> list;
    for (MakeProviders* of_file : {packing_providers, crystallite_providers, mechanics_providers,
                                   lattice_providers, pair_structure_providers, profile_providers,
                                   motion_providers, onset_providers, run_providers}) {
      std::ranges::move(of_file(), std::back_inserter(list));
    }
    return list;
  }();
  return all;
}

const Provider& provider(std::string_view name) {
  const Provider* found = find_named(all_providers(), name);
  if (found == nullptr) throw std::logic_error("no such provider: " + std::string(name));
  return *found;
}

std::vector<std::string> provider_names(bool (*fits)(const Provider&)) {
  std::vector<std::string> names;
  for (const Provider& one : all_providers()) {
    if (fits(one)) names.push_back(one.name);
  }
  return names;
}

namespace {

bool is_of(MeasureKind wanted, const Measure& measure) {
  return measure.kind == wanted ||
         (wanted == MeasureKind::number && measure.kind == MeasureKind::count);
}

}  // namespace

std::vector<const Measure*> all_measures(MeasureKind kind) {
  std::vector<const Measure*> found;
  for (const Provider& one : all_providers()) {
    for (const Measure& measure : one.measures) {
      if (is_of(kind, measure)) found.push_back(&measure);
    }
  }
  return found;
}

const Measure* find_measure(std::string_view name, MeasureKind kind) {
  for (const Provider& one : all_providers()) {
    const Measure* found = find_named(one.measures, name);
    if (found != nullptr) return is_of(kind, *found) ? found : nullptr;
  }
  return nullptr;
}

const Provider& provider_of(const Measure& measure) {
  return *std::ranges::find_if(all_providers(), [&](const Provider& one) {
    return find_named(one.measures, measure.name) != nullptr;
  });
}

double Measures::number(std::string_view name) const {
  const auto found = numbers.find(name);
  return found == numbers.end() ? std::nan("") : found->second;
}

double RunFacts::number(const char* key) const {
  const json found = member_of(parameters, key);
  return found.is_number() ? found.get<double>() : std::nan("");
}

bool Provider::has(MeasureKind kind) const {
  return std::ranges::any_of(measures, [&](const Measure& one) { return is_of(kind, one); });
}

bool Provider::is_kept() const {
  return (from == ComputedFrom::checkpoint || from == ComputedFrom::simulation) &&
         !has(MeasureKind::grains);
}

void Provider::read(const json& result, Measures& into) const try {
  const bool may_lack = from != ComputedFrom::checkpoint || cycles_back > 0;
  for (const Measure& measure : measures) {
    const std::string named(measure.name);
    if (may_lack && !result.contains(named)) continue;
    const json& value = result.at(named);
    if (measure.kind == MeasureKind::curve) {
      MeasuredCurve& curve = into.curves[named];
      value.get_to(curve);
      if (curve.x.size() != curve.y.size()) throw AnalysisError("a cached curve lacks values");
    } else if (measure.kind == MeasureKind::grains) {
      value.get_to(into.of_grains[named]);
    } else {
      into.numbers.insert_or_assign(named, value.get<double>());
    }
  }
  if (read_more != nullptr) read_more(result, into);
} catch (const json::exception& problem) {
  throw AnalysisError(
      std::string("a cached result does not have the form that its provider expects: ") +
      problem.what());
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

json with(json parameters, const json& more) {
  parameters.update(more);
  return parameters;
}

json surface_criteria() {
  return {{"rough_wall_surface_d", rough_wall_surface}};
}

json interior_criteria() {
  return with(surface_criteria(), {{"interior_distance_d", interior_distance}});
}

json crystal_criteria() {
  return with(interior_criteria(), {{"connecting_face", connecting_face},
                                    {"crystalline_phi_local", crystalline_phi_local},
                                    {"q6_fcc", q6_fcc},
                                    {"q6_hcp", q6_hcp},
                                    {"q6_tolerance", q6_tolerance}});
}

}  // namespace shearcell
