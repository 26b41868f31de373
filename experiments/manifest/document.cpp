// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/document.hpp"

#include <fmt/format.h>
#include <utf8proc.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <boost/algorithm/string/replace.hpp>
#include <boost/algorithm/string/trim_all.hpp>
#include <cctype>
#include <cstdlib>
#include <map>
#include <set>
#include <sstream>

#include "provenance/io/read_number.hpp"

namespace shearcell {
namespace {

using std::string_view;

Position position(const YAML::Mark& mark) {
  return mark.is_null() ? Position{1, 1} : Position{mark.line + 1, mark.column + 1};
}

struct Character {
  std::size_t length = 0;  // [bytes]; 0 if the bytes are not UTF-8
  char32_t code_point = 0;
};

const utf8proc_uint8_t* bytes_of(string_view text) {
  return reinterpret_cast<const utf8proc_uint8_t*>(text.data());
}

Character decode(string_view text) {
  utf8proc_int32_t c = 0;
  const auto length = utf8proc_iterate(bytes_of(text), std::ssize(text), &c);
  if (length <= 0) return {};
  return {static_cast<std::size_t>(length), static_cast<char32_t>(c)};
}

// Control characters, line ends, and characters that change the direction of text (Bidi_Control in
// Unicode).
bool is_control(char32_t c) {
  return c < 0x20 || (c >= 0x7F && c < 0xA0) || c == 0x61C || c == 0x200E || c == 0x200F ||
         (c >= 0x2028 && c <= 0x202E) || (c >= 0x2066 && c <= 0x2069);
}

// Characters that a reader does not see, or that look like a space. U+2800 is a Braille cell
// without dots.
bool is_unseen(char32_t c) {
  const auto code_point = static_cast<utf8proc_int32_t>(c);
  const utf8proc_category_t category = utf8proc_category(code_point);
  return category == UTF8PROC_CATEGORY_CF || category == UTF8PROC_CATEGORY_CN || c == 0x2800 ||
         (category == UTF8PROC_CATEGORY_ZS && c != ' ') ||
         utf8proc_get_property(code_point)->ignorable != 0;
}

// Noncharacters of Unicode. XML does not allow U+FFFE and U+FFFF.
bool is_noncharacter(char32_t c) {
  return (c >= 0xFDD0 && c <= 0xFDEF) || (c & 0xFFFE) == 0xFFFE;
}

std::string escaped(string_view text, std::size_t longest, bool (*escapes)(char32_t)) {
  std::string result;
  while (!text.empty()) {
    if (result.size() >= longest) return result + "...";
    auto [length, c] = decode(text);
    if (length == 0) c = static_cast<unsigned char>(text.front());
    if (length == 0 || escapes(c)) {
      result += c < 0x100 ? fmt::format("\\x{:02x}", static_cast<unsigned>(c))
                          : fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      result += text.substr(0, length);
    }
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return result;
}

class TreeBuilder : public YAML::EventHandler {
 public:
  explicit TreeBuilder(string_view file) : file_(file) {}

  Node take() { return std::move(root_); }

  [[noreturn]] void refuse_reference(const YAML::Mark& mark) {
    refuse(file_, position(mark), "", "is neither an anchor nor an alias of an earlier anchor", "",
           "Write the value out, and quote a text that begins with & or *.");
  }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (started_) {
      refuse(file_, position(mark), "", "a second YAML document begins", "",
             "Write one manifest per file.");
    }
    started_ = true;
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    keep(anchor, add({.at = position(mark)}));
  }
  // Adds a copy of the anchored value. The copy counts towards ManifestLimits like any other value.
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto known = anchored_.find(anchor);
    if (known == anchored_.end()) refuse_reference(mark);  // an alias inside its own value
    check_size(known->second, position(mark), open_.size());
    add(known->second);
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    check_tag(mark, tag);
    check_text(mark, value);
    Node node{
        .kind = Node::Kind::scalar, .at = position(mark), .text = value, .quoted = tag == "!"};
    keep(anchor, node);
    add(std::move(node));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(Node::Kind::list, mark, tag, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(Node::Kind::map, mark, tag, anchor);
  }
  void OnMapEnd() override { close(); }

 private:
  // A list or map that is being read.
  struct Open {
    Node& node;
    YAML::anchor_t anchor;
    std::set<std::string> keys = {};
    bool awaits_value = false;
  };

  void check_tag(const YAML::Mark& mark, const std::string& tag) {
    if (tag == "?" || tag == "!" || tag.empty()) return;  // no tag was written
    refuse(file_, position(mark), "", fmt::format("the tag {} is not supported", printable(tag)),
           "", "Remove the tag. The key decides the type.");
  }

  // Reports control characters and noncharacters, since texts are written to JSON, XML and
  // terminals. Escapes in double quotes can stand for any character, and yaml-cpp reads \_ and \N
  // as bytes that are not UTF-8.
  void check_text(const YAML::Mark& mark, string_view text) {
    for (string_view rest = text; !rest.empty();) {
      const auto [length, c] = decode(rest);
      if (length == 0 || (is_control(c) && c != '\n') || is_noncharacter(c)) {
        refuse(file_, position(mark), "", "holds an escape or a character that is not supported",
               printable(text), "Remove it, or write the text in single quotes.");
      }
      rest.remove_prefix(length);
    }
  }

  void open(Node::Kind kind, const YAML::Mark& mark, const std::string& tag,
            YAML::anchor_t anchor) {
    check_tag(mark, tag);
    check_depth(position(mark), open_.size());
    open_.push_back({add({.kind = kind, .at = position(mark)}), anchor});
  }
  void close() {
    keep(open_.back().anchor, open_.back().node);
    open_.pop_back();
  }

  // Keeps a copy of an anchored value for its aliases. `anchor` is 0 for a value without anchor.
  void keep(YAML::anchor_t anchor, const Node& node) {
    if (anchor == 0) return;
    check_size(node, node.at, 0);
    anchored_[anchor] = node;
  }

  // Counts the values and bytes of a copied node, and checks the limits. `depth`: number of lists
  // and maps around the node.
  void check_size(const Node& node, Position at, std::size_t depth) {
    count_value(at);
    copied_ += node.text.size() + node.key.size();
    if (copied_ > ManifestLimits::bytes) {
      refuse(
          file_, at, "",
          fmt::format("is larger than {} bytes after aliases are replaced", ManifestLimits::bytes),
          "", "");
    }
    if (node.kind == Node::Kind::list || node.kind == Node::Kind::map) check_depth(at, depth);
    for (const Node& part : node.parts) {
      if (node.kind == Node::Kind::map) count_value(at);  // a key counts as a value
      check_size(part, at, depth + 1);
    }
  }

  void check_depth(Position at, std::size_t depth) {
    if (depth < ManifestLimits::depth) return;
    refuse(file_, at, "", fmt::format("nested deeper than {} levels", ManifestLimits::depth), "",
           "");
  }

  void count_value(Position at) {
    if (++nodes_ <= ManifestLimits::nodes) return;
    refuse(file_, at, "", fmt::format("holds more than {} values", ManifestLimits::nodes), "", "");
  }

  // Adds an item, key or value to the innermost open list or map. The returned reference is valid
  // until this list or map gets another item, key or value.
  Node& add(Node node) {
    count_value(node.at);
    if (open_.empty()) return root_ = std::move(node);
    auto& [parent, anchor, keys, awaits_value] = open_.back();
    const bool is_key = parent.kind == Node::Kind::map && !awaits_value;
    awaits_value = is_key;
    if (is_key) {
      if (node.kind != Node::Kind::scalar)
        refuse(file_, node.at, "", "a key must be a plain name", "", "");
      const std::string name = printable(node.text);
      if (!keys.insert(node.text).second) {
        refuse(file_, node.at, name, "appears twice in one map", "",
               read_number<double>(name) ? kDecimalPoint : "Keep one of them.");
      }
      Node value{.at = node.at,  // an empty value is reported at its key
                 .key = std::move(node.text),
                 .key_at = node.at,
                 .path = parent.path.empty() ? name : parent.path + '.' + name};
      return parent.parts.emplace_back(std::move(value));
    }
    if (parent.kind == Node::Kind::list) {
      node.key_at = parent.key_at;
      node.path = parent.path;
      return parent.parts.emplace_back(std::move(node));
    }
    Node& value = parent.parts.back();
    if (node.kind == Node::Kind::null) return value;
    node.key = std::move(value.key);
    node.key_at = value.key_at;
    node.path = std::move(value.path);
    return value = std::move(node);
  }

  std::string file_;
  bool started_ = false;
  std::size_t nodes_ = 0;
  std::size_t copied_ = 0;  // bytes in copies of anchored values
  std::vector<Open> open_;
  std::map<YAML::anchor_t, Node> anchored_;
  Node root_;
};

}  // namespace

const Node* Node::find(string_view name) const {
  const auto found = std::ranges::find(parts, name, &Node::key);
  return found == parts.end() || kind != Kind::map ? nullptr : &*found;
}

void check_characters(string_view text, string_view file, std::string_view remedy) {
  Position at{1, 1};
  while (!text.empty()) {
    const std::size_t length = decode(text).length;
    const char c = text.front();
    if (length == 0) refuse(file, at, "", "is not valid UTF-8", "", "Save the file as UTF-8 text.");
    if (std::iscntrl(static_cast<unsigned char>(c)) != 0 && c != '\t' && c != '\n' && c != '\r') {
      refuse(file, at, "", fmt::format("holds the control character 0x{:02x}", static_cast<int>(c)),
             "", std::string(remedy));
    }
    at = c == '\n' ? Position{at.line + 1, 1} : Position{at.line, at.column + 1};
    text.remove_prefix(length);
  }
}

Node read_document(string_view text, string_view file) {
  if (text.size() > ManifestLimits::bytes) {
    refuse(file, {}, "", fmt::format("is larger than {} bytes", ManifestLimits::bytes), "",
           "A manifest is a short text.");
  }
  // yaml-cpp silently replaces bad bytes and stops reading at U+0004.
  check_characters(text, file, "A manifest is plain text.");
  std::istringstream stream{std::string(text)};
  TreeBuilder builder(file);
  try {
    YAML::Parser parser(stream);
    if (!parser.HandleNextDocument(builder)) {
      refuse(file, {1, 1}, "", "the manifest is empty", "", "It needs at least `experiment`.");
    }
    parser.HandleNextDocument(builder);
  } catch (const YAML::Exception& error) {
    // The messages of yaml-cpp for anchors and aliases depend on its version.
    if (error.msg.find("anchor") != std::string::npos ||
        error.msg.find("alias") != std::string::npos) {
      builder.refuse_reference(error.mark);
    }
    refuse(
        file, position(error.mark), "", fmt::format("is not valid YAML: {}", error.msg), "",
        "Check the indentation (spaces, no tabs), the space after each colon, the quotes and the "
        "brackets, here and in the lines above.");
  }
  return builder.take();
}

std::string printable(string_view text, std::size_t longest) {
  return escaped(text, longest, [](char32_t c) { return is_control(c) || is_unseen(c); });
}

std::string without_controls(string_view text) {
  return escaped(text, std::string::npos, is_control);
}

std::string for_terminal(string_view text) {
  return escaped(text, std::string::npos, [](char32_t c) { return c != '\n' && is_control(c); });
}

std::string as_seen(string_view text) {
  utf8proc_uint8_t* mapped = nullptr;
  const auto length =
      utf8proc_map(bytes_of(text), std::ssize(text), &mapped,
                   static_cast<utf8proc_option_t>(UTF8PROC_STABLE | UTF8PROC_COMPOSE |
                                                  UTF8PROC_IGNORE | UTF8PROC_LUMP));
  std::string seen = length < 0 ? std::string(text) : std::string(mapped, mapped + length);
  std::free(mapped);
  boost::algorithm::replace_all(seen, "\xe2\xa0\x80", " ");  // U+2800
  return boost::algorithm::trim_fill_copy(seen, " ");
}

}  // namespace shearcell
