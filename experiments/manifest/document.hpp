// SPDX-License-Identifier: GPL-3.0-or-later
// Turns an untrusted YAML text into a tree of nodes with their positions. The tree is built from
// the events of the parser, so that the limits are checked before an alias is expanded.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/manifest/manifest.hpp"

namespace shearcell {

struct Node {
  enum class Kind { null, scalar, list, map };
  Kind kind = Kind::null;
  Position at = {};
  std::string text = {};         ///< the value of a scalar
  bool quoted = false;           ///< written in quotes or as a block
  std::vector<Node> parts = {};  ///< items of a list, or values of a map
  std::string key = {};          ///< key of this node in its map; "" if in no map
  Position key_at = {};          ///< position of `key`; in a list, position of the list's key
  std::string path = {};         ///< keys from the root, as in "scales.smoke.grains"

  bool is_scalar() const { return kind == Kind::scalar; }
  bool is_map() const { return kind == Kind::map && !parts.empty(); }
  /// The value of a key of the map, or nullptr.
  const Node* find(std::string_view name) const;
};

/// Reads one YAML document within ManifestLimits. Tags and repeated keys are errors. An alias
/// becomes a copy of the anchored value, with the positions of the anchored value. Texts of nodes
/// are UTF-8, and have no noncharacters of Unicode, no control characters other than line feeds and
/// no characters that change the direction of text. Throws ManifestError.
Node read_document(std::string_view text, std::string_view file);

/// The remedy for a key that is a number: YAML reads `{amplitude_rad: 0,05}` as a map with key 05.
inline constexpr const char* kDecimalPoint =
    "If the comma before this number is a decimal comma, write a point instead, as in 0.05.";

/// Throws ManifestError with the position if the text is not UTF-8, or has control characters other
/// than tabs and line ends. `remedy`: the advice given about a control character.
void check_characters(std::string_view text, std::string_view file, std::string_view remedy);

/// Makes a text safe to print in a one-line message, and cuts it after `longest` bytes. Writes
/// escapes, such as \x1b or \u202e, for control characters, characters that change the direction of
/// text, bytes that are not UTF-8, noncharacters, invisible characters, and blanks other than the
/// space.
std::string printable(std::string_view text, std::size_t longest = 60);

/// Makes a text safe to print in a terminal. Unlike printable(), keeps blanks and
/// invisible characters, because some writing systems need them.
std::string without_controls(std::string_view text);

/// Like without_controls(), but keeps line feeds.
std::string for_terminal(std::string_view text);

/// The text as a reader sees it, for comparing names. Composes characters (Unicode NFC), removes
/// invisible characters and the blanks at both ends, replaces consecutive blanks by one space, and
/// replaces similar characters, such as minus and hyphen, by one of them. Returns "" if nothing is
/// visible.
std::string as_seen(std::string_view text);

}  // namespace shearcell
