// SPDX-License-Identifier: GPL-3.0-or-later
// Named results of the analysis of one checkpoint, which are stored and read back exactly.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/measures.hpp"

namespace shearcell {

/// Raise it with every change that may alter a bit of any result: results that were stored with
/// another version are computed again. tests/analysis/test_derived_measures.cpp pins results to it.
inline constexpr std::uint64_t analysis_version = 2;

/// What a result is computed from.
struct MeasureInput {
  const Analysis& analysis;
  const Checkpoint* checkpoint = nullptr;  ///< not needed for scalars and crystallites
  /// The same run's checkpoint so many cycles earlier, valid until the next call; null where the
  /// run has none.
  std::function<const Checkpoint*(std::uint64_t cycles)> earlier = {};
};

/// One result that can be stored, with the parameters on which it depends besides the checkpoint.
/// All are computed from one Analysis, so that the Voronoi cells are computed once. A result is any
/// JSON value; it may hold binary arrays (nlohmann::json::binary) of one entry per grain.
struct DerivedMeasure {
  std::string name;
  nlohmann::json parameters;
  nlohmann::json (*from)(const MeasureInput& input);
  /// Adds a result to the measures. Throws AnalysisError for a result of something else.
  void (*read)(const nlohmann::json& result, Measures& measures);
  std::vector<std::uint64_t> earlier = {};  ///< cycles back to the other checkpoints it needs

  /// Name and parameters as one text: equal texts, equal computation.
  std::string key() const { return name + " " + parameters.dump(); }
};

/// Every result that can be stored. "scalars" has the scalars of `Measures` itself.
std::span<const DerivedMeasure> all_derived_measures();
/// The one of that name, which must exist.
const DerivedMeasure& derived_measure(std::string_view name);

/// CBOR (RFC 8949): every double and integer exactly, equal results in equal bytes.
std::vector<std::byte> encode_result(const nlohmann::json& result);
/// Throws AnalysisError when the bytes are not CBOR.
nlohmann::json decode_result(std::span<const std::byte> bytes);

}  // namespace shearcell
