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

// Records the values of a document in their order. An alias repeats the values of its anchor.
class Recorder : public YAML::EventHandler {
  using Mark = YAML::Mark;
  using Text = std::string;
  using Anchor = YAML::anchor_t;
  using Style = YAML::EmitterStyle::value;

 public:
  explicit Recorder(string_view file) : file_(file) {}

  // The recorded value at `next`, as a tree. Moves `next` past the value.
  Node tree(std::size_t& next) {
    const std::size_t end = next + values_[next].size;
    Node node = std::move(values_[next++]);
    std::set<std::string> keys;
    while (next < end) {
      const Value& key = values_[next];
      const bool in_map = node.kind == Node::Kind::map;
      Value& part = values_[in_map ? ++next : next];
      part.key_at = node.key_at;
      part.path = node.path;
      if (in_map) {
        const std::string name = printable(key.text);
        if (!key.is_scalar()) refuse(file_, key.at, "", "a key must be a plain name", "", "");
        if (!keys.insert(key.text).second) {
          refuse(file_, key.at, name, "appears twice in one map", "",
                 read_number<double>(name) ? kDecimalPoint : "Keep one of them.");
        }
        part.key = key.text;
        part.key_at = key.at;
        part.path += (node.path.empty() ? "" : ".") + name;
        if (part.kind == Node::Kind::null) part.at = key.at;
      }
      node.parts.push_back(tree(next));
    }
    return node;
  }

  [[noreturn]] void refuse_reference(const Mark& mark) {
    refuse(file_, position(mark), "", "is neither an anchor nor an alias of an earlier anchor", "",
           "Write the value out, and quote a text that begins with & or *.");
  }

  void OnDocumentStart(const Mark& mark) override {
    if (values_.empty()) return;
    refuse(file_, position(mark), "", "a second YAML document begins", "",
           "Write one manifest per file.");
  }
  void OnDocumentEnd() override {}
  void OnNull(const Mark& mark, Anchor anchor) override {
    start(Node::Kind::null, mark, "", anchor);
  }
  void OnScalar(const Mark& mark, const Text& tag, Anchor anchor, const Text& text) override {
    start(Node::Kind::scalar, mark, tag, anchor, text);
  }
  void OnSequenceStart(const Mark& mark, const Text& tag, Anchor anchor, Style) override {
    start(Node::Kind::list, mark, tag, anchor);
  }
  void OnSequenceEnd() override {
    values_[open_.back()].size = values_.size() - open_.back();
    open_.pop_back();
  }
  void OnMapStart(const Mark& mark, const Text& tag, Anchor anchor, Style) override {
    start(Node::Kind::map, mark, tag, anchor);
  }
  void OnMapEnd() override { OnSequenceEnd(); }
  void OnAlias(const Mark& mark, Anchor anchor) override {
    const std::size_t first = anchors_.at(anchor), size = values_[first].size;
    if (size == 0) refuse_reference(mark);  // an alias inside its own value
    for (std::size_t k = first; k < first + size; ++k) {
      Value copy = values_[k];
      copy.depth += open_.size() - values_[first].depth;
      copied_ += copy.text.size();
      add(std::move(copy), position(mark));
    }
  }

 private:
  struct Value : Node {
    std::size_t depth = 0;  // number of lists and maps around the value
    std::size_t size = 1;   // number of values in it, itself included; 0 until its end is known
  };

  void start(Node::Kind kind, const Mark& mark, const Text& tag, Anchor anchor,
             const Text& text = "") {
    const Position at = position(mark);
    if (tag != "?" && tag != "!" && !tag.empty()) {
      refuse(file_, at, "", fmt::format("the tag {} is not supported", printable(tag)), "",
             "Remove the tag. The key decides the type.");
    }
    check_text(text, at);
    if (anchor != 0) anchors_[anchor] = values_.size();
    add({{.kind = kind, .at = at, .text = text, .quoted = tag == "!"}, open_.size()}, at);
    if (kind != Node::Kind::list && kind != Node::Kind::map) return;
    values_.back().size = 0;
    open_.push_back(values_.size() - 1);
  }

  // `at`: the position of the value or, for a copy, of the alias.
  void add(Value value, Position at) {
    const bool nests = value.kind == Node::Kind::list || value.kind == Node::Kind::map;
    const bool deep = nests && value.depth >= ManifestLimits::depth;
    values_.push_back(std::move(value));
    if (deep || values_.size() > ManifestLimits::nodes || copied_ > ManifestLimits::bytes) {
      refuse(file_, at, "",
             deep ? fmt::format("nested deeper than {} levels", ManifestLimits::depth)
             : values_.size() > ManifestLimits::nodes
                 ? fmt::format("holds more than {} values", ManifestLimits::nodes)
                 : fmt::format("is larger than {} bytes after aliases are replaced",
                               ManifestLimits::bytes),
             "", "");
    }
  }

  // Reports control characters and noncharacters, since texts are written to JSON, XML and
  // terminals. Escapes in double quotes can stand for any character, and yaml-cpp reads \_ and \N
  // as bytes that are not UTF-8.
  void check_text(string_view text, Position at) {
    for (string_view rest = text; !rest.empty();) {
      const auto [length, c] = decode(rest);
      if (length == 0 || (is_control(c) && c != '\n') || is_noncharacter(c)) {
        refuse(file_, at, "", "holds an escape or a character that is not supported",
               printable(text), "Remove it, or write the text in single quotes.");
      }
      rest.remove_prefix(length);
    }
  }

  std::string file_;
  std::vector<Value> values_;
  std::vector<std::size_t> open_;          // lists and maps whose end is not known
  std::map<Anchor, std::size_t> anchors_;  // places in `values_`
  std::size_t copied_ = 0;                 // bytes of text in copies
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
  Recorder recorder(file);
  try {
    YAML::Parser parser(stream);
    if (!parser.HandleNextDocument(recorder)) {
      refuse(file, {1, 1}, "", "the manifest is empty", "", "It needs at least `experiment`.");
    }
    parser.HandleNextDocument(recorder);
  } catch (const YAML::Exception& error) {
    // The messages of yaml-cpp for anchors and aliases depend on its version.
    if (error.msg.find("anchor") != std::string::npos ||
        error.msg.find("alias") != std::string::npos) {
      recorder.refuse_reference(error.mark);
    }
    refuse(
        file, position(error.mark), "", fmt::format("is not valid YAML: {}", error.msg), "",
        "Check the indentation (spaces, no tabs), the space after each colon, the quotes and the "
        "brackets, here and in the lines above.");
  }
  std::size_t first = 0;
  return recorder.tree(first);
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
