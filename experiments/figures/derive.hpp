// SPDX-License-Identifier: GPL-3.0-or-later
// Results of the analysis for many checkpoints: those that the store keeps are read, the others are
// computed, several at a time, and kept.
#pragma once

#include <cstddef>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/derived_measures.hpp"
#include "provenance/store.hpp"

namespace shearcell {

struct DeriveOptions {
  std::size_t workers = 1;
  bool fresh = false;  ///< compute everything again and replace what is kept
  /// Called as checkpoints are computed; may be empty.
  std::function<void(std::size_t done, std::size_t total)> report;
};

struct Derived {
  /// In the order of the records; for each the results in the order of the measures, or nothing
  /// when the checkpoint had to be read and could not.
  std::vector<std::optional<std::vector<nlohmann::json>>> results;
  std::size_t computed = 0;         ///< checkpoints
  std::size_t kept = 0;             ///< checkpoints whose results were there
  std::vector<std::string> damage;  ///< checkpoints that could not be read, one line each, sorted
  std::vector<std::string> pruned;  ///< likewise, whose files were pruned
  std::vector<std::string>
      changed;          ///< with `fresh`: checkpoints for which something else was kept
  std::string trouble;  ///< why results cannot be kept; "" when they can
};

/// A kept result stands for the checkpoint's recorded SHA-256, so the file itself is not read for
/// it and may be gone; `verify` is what checks files. The same bytes come out whether a result was
/// kept or computed.
Derived derive(const Store& store, std::span<const CheckpointRecord> records,
               std::span<const DerivedMeasure> measures, const DeriveOptions& options);

}  // namespace shearcell
