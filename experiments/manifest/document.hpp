// SPDX-License-Identifier: GPL-3.0-or-later
// An untrusted YAML text as a small tree of nodes that know where they were written. Built from the
// parser's events, so that nothing is expanded before it is counted.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/manifest/manifest.hpp"

namespace shearcell {

struct Node {
  enum class Kind { null, scalar, list, map };
  Kind kind = Kind::null;
  Position at = {};
  std::string text = {};                            ///< of a scalar
  bool quoted = false;                              ///< written in quotes or as a block
  std::vector<Node> items = {};                     ///< of a list
  std::vector<std::pair<Node, Node>> entries = {};  ///< of a map; keys are scalars, none twice
};

/// One YAML document without anchors, aliases, tags or repeated keys, within ManifestLimits.
/// Throws ManifestError.
Node read_document(std::string_view text, std::string_view file);

/// A text fit for a one-line message: control characters, also those that change the direction of
/// a text, and bytes that are not UTF-8 escaped as \x1b or \u202e; cut to a readable length.
std::string printable(std::string_view text, std::size_t longest = 60);

}  // namespace shearcell
