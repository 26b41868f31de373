// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the parts of manifests: values, counts, lists, sweeps. Problems go to the entry's
// ProblemList, and reading continues.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/manifest/problems.hpp"
#include "experiments/manifest/schema.hpp"

namespace shearcell {

/// A key at the top level of a manifest.
struct ManifestKey {
  std::string_view name;
  std::string_view example;  ///< a value, as YAML
  std::string_view meaning;
  void (*read)(const Entry& in, Manifest& manifest);
  /// Null if a scale has no such key.
  void (*read_in_scale)(const Entry& in, Scale& scale) = nullptr;
};
std::span<const ManifestKey> manifest_keys();

/// Reads the value of a parameter; nothing after a problem with its type or range.
std::optional<nlohmann::json> read_parameter(const Field& field, const Entry& in);

/// Whether the node is the word `auto` and the parameter takes it.
bool is_auto(const Field& field, const Node& node);

/// Reads a whole number from 1 to `largest`, which must be an exact double.
std::optional<std::uint64_t> read_count(const Entry& in, std::uint64_t largest);

/// Reads a text that is_name(); "" after a problem.
std::string read_name(const Entry& in);

/// Whether the node is a text of at most `longest` bytes; it has one line unless `lines`.
bool is_text(const Node& node, std::size_t longest, bool lines);

/// The items of a list; empty after a problem, as with an empty or too long list.
std::vector<Entry> read_list(const Entry& in, std::string_view example);

struct Key {
  std::string_view name;
  std::function<void(const Entry&)> read;
};

/// Reads the entries of a map; an unlisted key is a problem. Returns the keys that were read.
std::set<std::string_view> read_keys(const Entry& map, std::span<const Key> keys);

Sweep read_sweep(const Entry& in);
Seeds read_seeds(const Entry& in);
Checkpoints read_checkpoints(const Entry& in);
StatedUntil read_until(const Entry& in);

/// Add to the manifest. Names of plots and claims must all differ.
void read_labels(const Entry& in, Manifest& manifest);
void read_plots(const Entry& in, Manifest& manifest);
void read_claims(const Entry& in, Manifest& manifest);

}  // namespace shearcell
