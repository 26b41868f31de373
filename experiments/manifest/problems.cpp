// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/problems.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <tuple>

#include "experiments/manifest/read_parts.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/suggest.hpp"

namespace shearcell {

using std::string;
using std::string_view;

void ProblemList::add(Position at, string key, string problem, string got, string remedy) {
  ManifestProblem entry{
      file_, at, std::move(key), std::move(problem), std::move(got), std::move(remedy)};
  if (texts_.insert(entry.text()).second) problems_.push_back(std::move(entry));
}

void ProblemList::raise() {
  if (problems_.empty()) return;
  const auto place = [](const ManifestProblem& problem) {
    return std::tuple(problem.at.line, problem.at.column);
  };
  std::ranges::stable_sort(problems_, {}, place);
  throw ManifestError(std::move(problems_));
}

std::vector<Entry> Entry::entries() const {
  std::vector<Entry> all;
  for (const auto& [name, value] : node.entries) {
    const string last = printable(name.text);
    all.push_back({name, value, path.empty() ? last : path + "." + last, problems});
  }
  return all;
}

std::vector<Entry> Entry::items() const {
  std::vector<Entry> all;
  for (const Node& item : node.items) all.push_back({key, item, path, problems});
  return all;
}

void Entry::reject_value(string problem, string remedy) const {
  problems.add(node.at, path, std::move(problem), shown(node), std::move(remedy));
}

void Entry::reject_type(string_view wanted, string remedy) const {
  reject_value(fmt::format("is not {}", wanted), std::move(remedy));
}

void Entry::reject(string problem, string remedy) const {
  problems.add(node.at, path, std::move(problem), "", std::move(remedy));
}

void Entry::reject_key(string problem, string remedy) const {
  problems.add(key.at, path, std::move(problem), "", std::move(remedy));
}

void Entry::reject_unknown(std::span<const string_view> allowed) const {
  if (key.text == "<<") return reject_key("merge keys are not read", "Write it out.");
  const bool at_top = path == printable(key.text);
  if (at_top && find_field(key.text) != nullptr) {
    return reject_key("is a parameter", "Move it under `base:`.");
  }
  const std::span<const ManifestKey> sections = manifest_keys();
  if (std::ranges::find(sections, key.text, &ManifestKey::name) != sections.end()) {
    return reject_key("does not belong here", "Move it to the top level.");
  }
  const Suggestion near = suggest_name(key.text, allowed);
  if (near.missing_unit) {
    reject_key("is written without its unit", fmt::format("Write {}.", near.name));
  } else if (!near.name.empty()) {
    reject_key("is an unknown key", fmt::format("Did you mean {}?", near.name));
  } else if (allowed.size() <= sections.size()) {
    reject_key("is an unknown key", fmt::format("Known here: {}.", fmt::join(allowed, ", ")));
  } else {
    reject_key("is an unknown key", "`shearcell manual --markdown` lists the keys.");
  }
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
