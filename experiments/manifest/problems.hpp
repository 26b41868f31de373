// SPDX-License-Identifier: GPL-3.0-or-later
// Collects every problem of a manifest, so that all are reported at once.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/manifest/document.hpp"
#include "experiments/manifest/manifest.hpp"

namespace shearcell {

class ProblemList {
 public:
  explicit ProblemList(std::string_view file) : file_(file) {}

  void add(Position at, std::string key, std::string problem, std::string got, std::string remedy);
  /// The node is not what is `wanted`, as in "a list".
  void add_type(const Node& node, std::string key, std::string_view wanted,
                std::string remedy = {});
  /// A key that is not `allowed` in the map at `path`; says which name is meant.
  void add_unknown(const Node& key, std::string_view path,
                   std::span<const std::string_view> allowed);

  std::size_t size() const { return problems_.size(); }

  /// Throws ManifestError when there are any.
  void raise();

 private:
  std::string file_;
  std::vector<ManifestProblem> problems_;
};

/// A key at the top level of a manifest.
struct ManifestKey {
  std::string_view name;
  std::string_view example;  ///< a value, as YAML
  std::string_view meaning;
};
std::span<const ManifestKey> manifest_keys();

/// Their names.
std::span<const std::string_view> manifest_sections();

/// "scales.smoke" and "grains" -> "scales.smoke.grains".
std::string join_path(std::string_view path, std::string_view key);

/// A node as it is quoted in a message.
std::string shown(const Node& node);

}  // namespace shearcell
