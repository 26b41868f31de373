// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/problems.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/suggest.hpp"

namespace shearcell {

using std::string;
using std::string_view;

std::span<const ManifestKey> manifest_keys() {
  static constexpr std::array<ManifestKey, 12> keys = {{
      {"experiment", "drag", "required; its name: letters, digits, - and _"},
      {"question", "Does the fluid matter?", "what the experiment is to find out, for people"},
      {"figures", "[S2]", "figures of the supplement to draw"},
      {"labels", "{\"fluid=still\": fluid at rest}", "names of variants in figures and tables"},
      {"plots", "[{name: compaction, y: phi, x: cycle}]", "figures of your own"},
      {"claims",
       "[{name: same, compare: phi, at_cycle: 10, between: [{fluid: still}, {fluid: cell}], "
       "margin: 0.001}]",
       "claims of your own, decided like those of the supplement"},
      {"base", "{grains: 7900}", "parameters of every run; others have their default"},
      {"sweep", "{grid: {fluid: [still, cell]}}",
       "parameters that vary: `grid` takes every combination, keys of `zip` advance together"},
      {"seeds", "6", "seeds 1 to 6, or a list; default 1"},
      {"checkpoints", "{every_cycles: 1, phases: [0.25, 0.5, 0.75]}",
       "cycles between checkpoints, default 1; `phases` adds fractions of each cycle that follows "
       "one, pause included, default none"},
      {"until", "{crystalline_percent: 10, extra_cycles: 15}",
       "ends a run so many cycles after the measure reaches the value; default: at `cycles`"},
      {"scales", "{smoke: {grains: 600, seeds: 2, cycles: 5}}",
       "named sizes, which override the keys above; default `desk`"},
  }};
  return keys;
}

std::span<const string_view> manifest_sections() {
  static const std::vector<string_view> names = [] {
    std::vector<string_view> all;
    for (const ManifestKey& key : manifest_keys()) all.push_back(key.name);
    return all;
  }();
  return names;
}

void ProblemList::add(Position at, string key, string problem, string got, string remedy) {
  problems_.push_back(
      {file_, at, std::move(key), std::move(problem), std::move(got), std::move(remedy)});
}

void ProblemList::add_type(const Node& node, string key, string_view wanted, string remedy) {
  add(node.at, std::move(key), fmt::format("is not {}", wanted), shown(node), std::move(remedy));
}

void ProblemList::add_unknown(const Node& key, string_view path,
                              std::span<const string_view> allowed) {
  const string full = join_path(path, key.text);
  const bool at_top = path.empty();
  const bool section =
      std::ranges::find(manifest_sections(), key.text) != manifest_sections().end();
  if (key.text == "<<") return add(key.at, full, "merge keys are not read", "", "Write it out.");
  if (at_top && find_field(key.text) != nullptr) {
    return add(key.at, full, "is a parameter", "", "Move it under `base:`.");
  }
  if (section) return add(key.at, full, "does not belong here", "", "Move it to the top level.");

  const Suggestion near = suggest_name(key.text, allowed);
  if (near.missing_unit) {
    add(key.at, full, "is written without its unit", "", fmt::format("Write {}.", near.name));
  } else if (!near.name.empty()) {
    add(key.at, full, "is an unknown key", "", fmt::format("The nearest is {}.", near.name));
  } else if (allowed.size() <= manifest_sections().size()) {
    add(key.at, full, "is an unknown key", "",
        fmt::format("Known here: {}.", fmt::join(allowed, ", ")));
  } else {
    add(key.at, full, "is an unknown key", "", "`shearcell manual --markdown` lists the keys.");
  }
}

void ProblemList::raise() {
  if (!problems_.empty()) throw ManifestError(std::move(problems_));
}

string join_path(string_view path, string_view key) {
  const string last = printable(key);
  return path.empty() ? last : fmt::format("{}.{}", path, last);
}

string shown(const Node& node) {
  switch (node.kind) {
    case Node::Kind::null:
      return "nothing";
    case Node::Kind::list:
      return node.items.empty() ? "an empty list" : "a list";
    case Node::Kind::map:
      return node.entries.empty() ? "an empty map" : "a map";
    case Node::Kind::scalar:
      break;
  }
  return node.quoted ? fmt::format("\"{}\"", printable(node.text)) : printable(node.text);
}

}  // namespace shearcell
