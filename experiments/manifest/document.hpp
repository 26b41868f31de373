// SPDX-License-Identifier: GPL-3.0-or-later
// An untrusted YAML text as a tree of nodes with their positions. It is built from the parser's
// events, so that the limits apply before anything is expanded.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/manifest/manifest.hpp"

namespace shearcell {

/// A value of the document.
struct Node {
  enum class Kind { null, scalar, list, map };
  Kind kind = Kind::null;
  Position at = {};
  std::string text = {};         ///< of a scalar
  bool quoted = false;           ///< written in quotes or as a block
  std::vector<Node> parts = {};  ///< items of a list, or values of a map, whose keys differ
  std::string key = {};          ///< of a value of a map
  Position key_at = {};          ///< place of the key; of an item, place of its list's key
  std::string path = {};         ///< to this key, as in "scales.smoke.grains"

  bool is_scalar() const { return kind == Kind::scalar; }
  /// Whether it is a map with at least one key.
  bool is_map() const { return kind == Kind::map && !parts.empty(); }
  /// The value of a key of the map, or nullptr.
  const Node* find(std::string_view name) const;
};

/// One YAML document without tags or repeated keys, within ManifestLimits. An alias becomes a copy
/// of the anchored value with its positions. Texts are UTF-8, without control characters other than
/// line feeds, without characters that change the direction of text, and without code points that
/// are no characters. Throws ManifestError.
Node read_document(std::string_view text, std::string_view file);

/// The remedy for a key that is a number, such as "05" in `{amplitude_rad: 0,05}`.
inline constexpr const char* kDecimalPoint =
    "If it follows a comma: a number takes a decimal point, as in 0.05.";

/// Throws a ManifestError, with the place and this remedy, unless the text is UTF-8 without control
/// characters other than tabs and line ends.
void check_characters(std::string_view text, std::string_view file, std::string_view remedy);

/// Makes a text fit for a one-line message. Escapes, as \x1b or \u202e, control characters,
/// characters that change the direction of text, bytes that are not UTF-8, code points that are no
/// characters, invisible characters, and blanks other than the space. Cuts the text to `longest`
/// bytes.
std::string printable(std::string_view text, std::size_t longest = 60);

/// Makes a text fit for a terminal: like printable(), but keeps blanks and invisible characters,
/// which some scripts need.
std::string without_controls(std::string_view text);

/// without_controls() of each line.
std::string for_terminal(std::string_view text);

/// The text as a reader sees it, to compare names: composed (NFC in Unicode), without invisible
/// characters, with one space for blanks and none at the ends, and with one character for those
/// that look alike, such as minus and hyphen. "" if there is nothing to see.
std::string as_seen(std::string_view text);

}  // namespace shearcell
