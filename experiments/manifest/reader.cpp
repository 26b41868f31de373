// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the keys at the top level of a manifest, and its scales.
#include "experiments/manifest/read_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "analysis/figure.hpp"
#include "experiments/manifest/suggest.hpp"

namespace shearcell {
namespace {

using std::string;
using std::string_view;

constexpr std::size_t kLongestQuestion = 2'000;

void read_question(const Entry& in, Manifest& manifest) {
  if (is_text(in.node, kLongestQuestion, true)) {
    manifest.question = in.node.text;
  } else {
    in.reject_type("a plain text",
                   fmt::format("It takes one text of at most {} bytes.", kLongestQuestion));
  }
}

void read_figures(const Entry& in, Manifest& manifest) {
  for (const Entry& item : read_list(in, "[S2]")) {
    const string figure = read_name(item);
    if (figure.empty()) continue;
    if (std::ranges::find(manifest.figures, figure) != manifest.figures.end()) {
      item.reject_value("names a figure twice", "Keep one of them.");
    } else if (find_figure(figure) == nullptr) {
      item.reject_value(with_nearest("names an unknown figure", figure, names_of(all_figures())),
                        "`shearcell figures --help` lists them.");
    }
    manifest.figures.push_back(figure);
  }
}

// Reads the parameters of `base` or of a scale; a scale may also have sections.
void read_settings(const Entry& in, Scale& scale, bool with_sections) {
  if (in.node.kind != Node::Kind::map) {
    in.reject_type("a map of parameters", "Indent `key: value` lines under it.");
    return;
  }
  std::vector<string_view> allowed = names_of(schema());
  for (const ManifestKey& key : manifest_keys()) {
    if (with_sections && key.read_in_scale != nullptr) allowed.push_back(key.name);
  }
  for (const Entry& entry : in.entries()) {
    const string& name = entry.key.text;
    if (std::ranges::find(allowed, name) == allowed.end()) {
      entry.reject_unknown(allowed);
    } else if (const Field* field = find_field(name); field == nullptr) {
      std::ranges::find(manifest_keys(), name, &ManifestKey::name)->read_in_scale(entry, scale);
    } else if (is_auto(*field, entry.node)) {
      scale.settings[name] = {entry.node.text, entry.node.at};
    } else if (auto read = read_parameter(*field, entry)) {
      scale.settings[name] = {std::move(*read), entry.node.at};
    }
  }
}

void read_scales(const Entry& in, Manifest& manifest) {
  const string remedy = "It takes `NAME: {key: value}` entries, such as smoke, desk and paper.";
  if (!in.is_map()) return in.reject_type("a map of scales", remedy);
  const std::size_t count = in.node.entries.size();
  if (count > ManifestLimits::scales) {
    in.problems.add(in.node.at, in.path,
                    fmt::format("has more than {} scales", ManifestLimits::scales),
                    fmt::format("{} scales", count), "");
    return;
  }
  for (const Entry& entry : in.entries()) {
    if (!is_name(entry.key.text)) {
      Entry{entry.key, entry.key, entry.path, in.problems}.reject_type("a name for a scale",
                                                                       remedy);
    }
    Scale& scale = manifest.scales.emplace_back();
    scale.name = entry.key.text;
    scale.at = entry.key.at;
    read_settings(entry, scale, true);
  }
}

// A key that a scale may also have.
template <auto Member, auto Read>
constexpr ManifestKey part(string_view name, string_view example, string_view meaning) {
  return {name, example, meaning,
          [](const Entry& in, Manifest& manifest) { manifest.base.*Member = Read(in); },
          [](const Entry& in, Scale& scale) { scale.*Member = Read(in); }};
}

}  // namespace

std::span<const ManifestKey> manifest_keys() {
  static constexpr std::array<ManifestKey, 12> keys = {{
      {"experiment", "drag", "required; its name: letters, digits, - and _",
       [](const Entry& in, Manifest& manifest) {
         manifest.experiment = read_name(in);
         manifest.experiment_at = in.key.at;
       }},
      {"question", "Does the fluid matter?", "what the experiment is to find out, for people",
       read_question},
      {"figures", "[S2]", "figures of the supplement to draw", read_figures},
      {"labels", "{\"fluid=still\": fluid at rest}",
       "names of variants in drawings, captions, progress, `status` and `table`", read_labels},
      {"plots", "[{name: compaction, y: phi, x: cycle}]", "figures of your own", read_plots},
      {"claims",
       "[{name: same, compare: phi, at_cycle: 10, between: [{fluid: still}, {fluid: cell}], "
       "margin: 0.001}]",
       "claims of your own, decided like those of the supplement", read_claims},
      {"base", "{grains: 7900}", "parameters of every run; others have their default",
       [](const Entry& in, Manifest& manifest) {
         manifest.base.at = in.key.at;
         read_settings(in, manifest.base, false);
       }},
      part<&Scale::sweep, read_sweep>(
          "sweep", "{grid: {fluid: [still, cell]}}",
          "parameters that vary: `grid` takes every combination, keys of `zip` advance together"),
      part<&Scale::seeds, read_seeds>("seeds", "6", "seeds 1 to 6, or a list; default 1"),
      part<&Scale::checkpoints, read_checkpoints>(
          "checkpoints", "{every_cycles: 1, phases: [0.25, 0.5, 0.75]}",
          "cycles between checkpoints, default 1, and always one after the last cycle; "
          "`phases` adds fractions of each cycle that follows one, pause included, default none"),
      part<&Scale::until, read_until>(
          "until", "{crystalline_percent: 10, extra_cycles: 15}",
          "ends a run `extra_cycles` after the measure reaches the value; default: at `cycles`"),
      {"scales", "{smoke: {grains: 600, seeds: 2, cycles: 5}}",
       "named sizes, which override the keys above; default `desk`", read_scales},
  }};
  return keys;
}

string read_name(const Entry& in) {
  if (in.is_scalar() && is_name(in.node.text)) return in.node.text;
  in.reject_type(
      "a name",
      fmt::format(
          "It takes ASCII letters, digits, - and _, at most {} of them, and does not begin with -.",
          kLongestName));
  return {};
}

bool is_name(string_view text) {
  const auto allowed = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; };
  return !text.empty() && text.size() <= kLongestName && text.front() != '-' &&
         std::ranges::all_of(text, allowed);
}

Manifest read_manifest(string_view text, string_view file) {
  const Node root = read_document(text, file);
  ProblemList problems(file);
  Manifest manifest;
  manifest.file = file;
  manifest.text = text;
  manifest.base.at = root.at;
  const Entry document{root, root, "", problems};
  if (root.kind != Node::Kind::map) {
    document.reject_type("a map of keys", "Begin with `experiment: NAME`.");
    problems.raise();
  }
  std::vector<Key> keys;
  for (const ManifestKey& key : manifest_keys()) {
    keys.push_back({key.name, [&](const Entry& in) { key.read(in, manifest); }});
  }
  if (!read_keys(document, keys).contains("experiment")) {
    problems.add(root.at, "experiment", "is missing", "", "Begin with `experiment: NAME`.");
  }
  problems.raise();
  return manifest;
}

}  // namespace shearcell
