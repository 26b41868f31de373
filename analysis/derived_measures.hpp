// SPDX-License-Identifier: GPL-3.0-or-later
// Named results of the analysis of one checkpoint, in a form that can be kept and read back
// exactly.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "analysis/measures.hpp"

namespace shearcell {

/// Raise it with every change that may alter a bit of any result: what was kept under another
/// version is then computed again. tests/analysis/test_derived_measures.cpp pins results to it.
inline constexpr std::uint64_t analysis_version = 1;

/// One result that can be kept, with what it depends on besides the checkpoint. Several are taken
/// from one Analysis, so that the Voronoi cells are found once. A result may be anything JSON
/// holds, binary arrays (nlohmann::json::binary) of one entry per grain included.
struct DerivedMeasure {
  std::string name;
  nlohmann::json parameters;
  nlohmann::json (*from)(const Analysis&);

  /// Name and parameters as one text: equal texts, equal computation.
  std::string key() const { return name + " " + parameters.dump(); }
};

/// All scalars of `Measures` itself.
const DerivedMeasure& scalar_measures();
/// What scalar_measures() gave. Throws AnalysisError when it is not that.
Measures read_measures(const nlohmann::json& result);

/// Mechanics in its own units, and the same back.
const DerivedMeasure& mechanics_measure();
Mechanics read_mechanics(const nlohmann::json& result);

/// The CrystalliteMap of a checkpoint; read_crystallite_map() reads it back.
const DerivedMeasure& crystallite_measure();

/// CBOR (RFC 8949): every double and integer exactly, equal results in equal bytes.
std::vector<std::byte> encode_result(const nlohmann::json& result);
/// Throws AnalysisError when the bytes are no CBOR.
nlohmann::json decode_result(std::span<const std::byte> bytes);

}  // namespace shearcell
