// SPDX-License-Identifier: GPL-3.0-or-later
// Collects the problems of a manifest, so that all are reported at once.
#pragma once

#include <cstddef>
#include <set>
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

  /// Adds a problem, unless it was added before: many variants may share one.
  void add(Position at, std::string key, std::string problem, std::string got, std::string remedy);

  std::size_t size() const { return problems_.size(); }

  /// Throws ManifestError, with the problems in the order of the text, if there are any.
  void raise();

 private:
  std::string file_;
  std::vector<ManifestProblem> problems_;
  std::set<std::string> texts_;
};

/// A value of the document while it is read.
struct Entry {
  const Node& key;   ///< for an item, the key of its list; for the document, the document
  const Node& node;  ///< the value
  std::string path;  ///< to the key, as in "scales.smoke.grains"
  ProblemList& problems;

  bool is_scalar() const { return node.kind == Node::Kind::scalar; }
  /// Whether it is a map with at least one key.
  bool is_map() const { return node.kind == Node::Kind::map && !node.entries.empty(); }

  std::vector<Entry> entries() const;  ///< of a map
  std::vector<Entry> items() const;    ///< of a list

  /// Reports a problem with the value, and quotes it.
  void reject_value(std::string problem, std::string remedy) const;
  /// Reports that the value is not `wanted`, as in "a list".
  void reject_type(std::string_view wanted, std::string remedy) const;
  /// Reports a problem at the value, or at the key, without a quotation.
  void reject(std::string problem, std::string remedy) const;
  void reject_key(std::string problem, std::string remedy) const;
  /// Reports that the key is not one of those `allowed` in its map, with the nearest of them.
  void reject_unknown(std::span<const std::string_view> allowed) const;
};

/// A node as messages quote it.
std::string shown(const Node& node);

}  // namespace shearcell
