// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "analysis/figure.hpp"
#include "experiments/manifest/problems.hpp"
#include "experiments/manifest/read_parts.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/suggest.hpp"

namespace shearcell {
namespace {

using std::string;
using std::string_view;

// What a scale may state beside parameters.
constexpr std::array<string_view, 4> kScaleSections = {"sweep", "seeds", "checkpoints", "until"};
constexpr std::size_t kLongestName = 64;
constexpr std::size_t kLongestQuestion = 2'000;

bool contains(const auto& names, string_view name) {
  return std::ranges::find(names, name) != names.end();
}

class Reader {
 public:
  explicit Reader(string_view file) : problems_(file) { manifest_.file = file; }

  Manifest read(const Node& root) {
    if (root.kind == Node::Kind::map) {
      read_sections(root);
    } else {
      problems_.add_type(root, "", "a map of keys", "Begin with `experiment: NAME`.");
    }
    problems_.raise();
    return std::move(manifest_);
  }

 private:
  void read_sections(const Node& root) {
    std::set<string_view> seen;
    manifest_.base_at = root.at;
    for (const auto& [key, value] : root.entries) {
      if (contains(manifest_sections(), key.text)) {
        seen.insert(key.text);
        read_section(key, value);
      } else {
        problems_.add_unknown(key, "", manifest_sections());
      }
    }
    if (!seen.contains("experiment")) {
      problems_.add(root.at, "experiment", "is missing", "", "Begin with `experiment: NAME`.");
    }
  }

  void read_section(const Node& key, const Node& value) {
    if (key.text == "experiment") {
      manifest_.experiment = read_name(value, key.text);
    } else if (key.text == "question") {
      manifest_.question = read_question(value);
    } else if (key.text == "figures") {
      read_figures(value);
    } else if (key.text == "labels") {
      manifest_.labels = read_labels(value, problems_);
    } else if (key.text == "plots") {
      read_plots(value, manifest_, problems_);
    } else if (key.text == "claims") {
      read_claims(value, manifest_, problems_);
    } else if (key.text == "base") {
      manifest_.base_at = key.at;
      manifest_.base = read_settings(value, key.text, nullptr);
    } else if (key.text == "sweep") {
      manifest_.sweep = read_sweep(value, key.text, problems_);
    } else if (key.text == "seeds") {
      manifest_.seeds = read_seeds(value, key.text, problems_);
    } else if (key.text == "checkpoints") {
      manifest_.checkpoints = read_checkpoints(value, key.text, problems_);
    } else if (key.text == "until") {
      manifest_.until = read_until(value, key.text, problems_);
    } else {
      read_scales(value);
    }
  }

  string read_name(const Node& node, const string& key) {
    if (node.kind == Node::Kind::scalar && is_name(node.text)) return node.text;
    problems_.add_type(
        node, key, "a name",
        fmt::format("It takes letters, digits, - and _, at most {} of them.", kLongestName));
    return {};
  }

  string read_question(const Node& node) {
    const bool plain = std::ranges::none_of(
        node.text, [](char c) { return (c >= 0 && c < 0x20 && c != '\n') || c == 0x7F; });
    if (node.kind == Node::Kind::scalar && plain && node.text.size() <= kLongestQuestion) {
      return node.text;
    }
    problems_.add_type(node, "question", "a plain text",
                       fmt::format("It takes one text of at most {} bytes.", kLongestQuestion));
    return {};
  }

  void read_figures(const Node& node) {
    for (const Node& item : read_list(node, "figures", "[S2]", problems_)) {
      const string figure = read_name(item, "figures");
      if (figure.empty()) continue;
      if (contains(manifest_.figures, figure)) {
        problems_.add(item.at, "figures", "names a figure twice", figure, "Keep one of them.");
      } else if (find_figure(figure) == nullptr) {
        add_unknown_figure(item);
      }
      manifest_.figures.push_back(figure);
    }
  }

  void add_unknown_figure(const Node& item) {
    std::vector<string_view> known;
    for (const Figure& figure : all_figures()) known.emplace_back(figure.name);
    const string near = suggest_name(item.text, known).name;
    problems_.add(item.at, "figures",
                  near.empty() ? "names an unknown figure"
                               : fmt::format("names an unknown figure, the nearest is {}", near),
                  shown(item), "`shearcell figures --help` lists them.");
  }

  // The parameters of `base`, or of a scale, which may have sections of its own.
  Settings read_settings(const Node& node, const string& path, Scale* scale) {
    Settings settings;
    if (node.kind != Node::Kind::map) {
      problems_.add_type(node, path, "a map of parameters", "Indent `key: value` lines under it.");
      return settings;
    }
    std::vector<string_view> allowed = field_names();
    if (scale != nullptr) {
      allowed.insert(allowed.end(), kScaleSections.begin(), kScaleSections.end());
    }
    for (const auto& [key, value] : node.entries) {
      const string full = join_path(path, key.text);
      if (const Field* field = find_field(key.text)) {
        auto read = is_auto(*field, value) ? nlohmann::json(value.text)
                                           : read_parameter(*field, value, full, problems_);
        if (read) settings[key.text] = {std::move(*read), value.at};
      } else if (scale != nullptr && contains(kScaleSections, key.text)) {
        read_scale_section(key.text, value, full, *scale);
      } else {
        problems_.add_unknown(key, path, allowed);
      }
    }
    return settings;
  }

  void read_scale_section(string_view name, const Node& value, const string& path, Scale& scale) {
    if (name == "seeds") {
      scale.seeds = read_seeds(value, path, problems_);
    } else if (name == "sweep") {
      scale.sweep = read_sweep(value, path, problems_);
    } else if (name == "until") {
      scale.until = read_until(value, path, problems_);
    } else {
      scale.checkpoints = read_checkpoints(value, path, problems_);
    }
  }

  void read_scales(const Node& node) {
    const string remedy = "It takes `NAME: {key: value}` entries, such as smoke, desk and paper.";
    if (node.kind != Node::Kind::map || node.entries.empty()) {
      problems_.add_type(node, "scales", "a map of scales", remedy);
      return;
    }
    if (node.entries.size() > ManifestLimits::scales) {
      problems_.add(node.at, "scales",
                    fmt::format("has more than {} scales", ManifestLimits::scales),
                    fmt::format("{} scales", node.entries.size()), "");
      return;
    }
    for (const auto& [key, value] : node.entries) {
      const string path = join_path("scales", key.text);
      if (!is_name(key.text)) problems_.add_type(key, path, "a name for a scale", remedy);
      Scale scale;
      scale.name = key.text;
      scale.at = key.at;
      scale.settings = read_settings(value, path, &scale);
      manifest_.scales.push_back(std::move(scale));
    }
  }

  Manifest manifest_;
  ProblemList problems_;
};

}  // namespace

bool is_name(string_view text) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  };
  return !text.empty() && text.size() <= kLongestName && text.front() != '-' &&
         std::ranges::all_of(text, allowed);
}

Manifest read_manifest(const Node& root, string_view file) {
  return Reader(file).read(root);
}

}  // namespace shearcell
