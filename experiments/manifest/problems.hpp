// SPDX-License-Identifier: GPL-3.0-or-later
// Collects every problem of a manifest, so that all are reported at once.
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

  /// Many variants share one cause: what was reported already is not repeated.
  void add(Position at, std::string key, std::string problem, std::string got, std::string remedy);

  std::size_t size() const { return problems_.size(); }

  /// Throws ManifestError, in the order of the text, when there are any.
  void raise();

 private:
  std::string file_;
  std::vector<ManifestProblem> problems_;
  std::set<std::string> texts_;
};

/// A value of the document while it is read.
struct Entry {
  const Node& key;   ///< of an item, that of its list; of the document, the document
  const Node& node;  ///< the value
  std::string path;  ///< to the key, as in "scales.smoke.grains"
  ProblemList& problems;

  bool is_scalar() const { return node.kind == Node::Kind::scalar; }
  /// Whether it is a map with at least one key.
  bool is_map() const { return node.kind == Node::Kind::map && !node.entries.empty(); }

  std::vector<Entry> entries() const;  ///< of a map
  std::vector<Entry> items() const;    ///< of a list

  /// Something is wrong with the value, which the message quotes.
  void reject_value(std::string problem, std::string remedy) const;
  /// The value is not what is `wanted`, as in "a list".
  void reject_type(std::string_view wanted, std::string remedy) const;
  /// Something is wrong with a part of the value, or with its place.
  void reject(std::string problem, std::string remedy) const;
  void reject_key(std::string problem, std::string remedy) const;
  /// The key is not one of those `allowed` in its map; says which name is meant.
  void reject_unknown(std::span<const std::string_view> allowed) const;
};

/// A node as it is quoted in a message.
std::string shown(const Node& node);

}  // namespace shearcell
