// SPDX-License-Identifier: GPL-3.0-or-later
// Reads `labels`, `plots` and `claims` of a manifest.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <limits>

#include "analysis/figure.hpp"
#include "analysis/onset.hpp"
#include "experiments/manifest/read_parts.hpp"
#include "experiments/manifest/suggest.hpp"
#include "provenance/limits.hpp"

namespace shearcell {
namespace {

using nlohmann::json;
using std::string;
using std::string_view;

constexpr std::size_t kShownNames = 20;
constexpr std::size_t kLongestLabel = 60;  // [bytes]

/// The parameters that distinguish runs. The record of a run does not hold the others.
std::vector<string_view> parameters() {
  std::vector<string_view> names;
  for (const Field& field : schema()) {
    if (field.identity.distinguishes_runs()) names.push_back(field.name);
  }
  return names;
}

/// Reads a parameter and its value into `where`.
void read_where(const Entry& in, json& where) {
  const Field* field = find_field(in.key.text);
  if (field == nullptr) return in.reject_unknown(parameters());
  if (!field->identity.distinguishes_runs()) {
    return in.reject_key("does not distinguish runs", "Name a parameter that does.");
  }
  if (where.contains(in.key.text)) return in.reject_key("is stated twice", "State it once.");
  if (auto read = read_parameter(*field, in)) where[in.key.text] = std::move(*read);
}

/// Reads the key "fluid=still,amplitude_rad=0.05" as a map.
json read_selector(const Entry& in) {
  Node map{Node::Kind::map, in.key.at};
  string_view rest = in.key.text;
  while (!rest.empty()) {
    string_view part = rest.substr(0, rest.find(','));
    rest.remove_prefix(std::min(rest.size(), part.size() + 1));
    part.remove_prefix(std::min(part.size(), part.find_first_not_of(' ')));
    const std::size_t equal = part.find('=');
    if (equal == part.npos) {
      in.problems.add(in.key.at, in.path, "does not select variants", shown(in.key),
                      "It takes `\"fluid=still\"`, or several joined by commas.");
      break;
    }
    map.entries.push_back({{Node::Kind::scalar, in.key.at, string(part.substr(0, equal))},
                           {Node::Kind::scalar, in.key.at, string(part.substr(equal + 1))}});
  }
  json where = json::object();
  for (const Entry& entry : Entry{in.key, map, in.path, in.problems}.entries()) {
    read_where(entry, where);
  }
  return where;
}

/// Reads a map with these keys, of which the first `required` ones must be stated. Returns false
/// after a problem.
bool read_whole(const Entry& in, std::span<const Key> keys, std::size_t required,
                const string& example) {
  const string remedy = fmt::format("It takes `{}`.", example);
  if (in.node.kind != Node::Kind::map) {
    in.reject_type("a map", remedy);
    return false;
  }
  const std::set<string_view> found = read_keys(in, keys);
  for (const Key& key : keys.first(required)) {
    if (found.contains(key.name)) continue;
    in.reject(fmt::format("lacks {}", key.name), remedy);
    return false;
  }
  return true;
}

/// Reads a value that must be one of `known`; "" after a problem.
string read_one_of(const Entry& in, const std::vector<string_view>& known) {
  const string text = in.is_scalar() ? in.node.text : "";
  if (in.is_scalar() && std::ranges::find(known, text) != known.end()) return text;
  in.reject_value(with_nearest("is unknown", text, known),
                  known.size() > kShownNames
                      ? "`shearcell manual --markdown` lists them."
                      : fmt::format("Known are {}.", fmt::join(known, ", ")));
  return "";
}

std::vector<string_view> joined(std::vector<string_view> names,
                                const std::vector<string_view>& more) {
  names.insert(names.end(), more.begin(), more.end());
  return names;
}

/// Reads a name that differs from those of the supplement's figures and panels, and of other plots
/// and claims.
string read_own_name(const Entry& in, const Manifest& manifest) {
  const string name = read_name(in);
  if (name.empty()) return name;
  const auto is_panel = [&](const Figure& figure) {
    if (!name.starts_with(figure.name)) return false;
    const string_view rest = string_view(name).substr(figure.name.size());
    return rest.size() < 2 || rest.front() == '_';
  };
  const auto is_taken = [&](const auto& others) {
    return std::ranges::any_of(others, [&](const auto& other) { return other.name == name; });
  };
  if (std::ranges::any_of(all_figures(), is_panel)) {
    in.reject_value("is the name of a figure of the supplement", "Choose another one.");
  } else if (is_taken(manifest.plots) || is_taken(manifest.claims)) {
    in.reject_value("is the name of another plot or claim", "Choose another one.");
  }
  return name;
}

/// Reads a first and a last cycle.
std::array<std::uint64_t, 2> read_interval(const Entry& in, const string& example) {
  const std::vector<Entry> ends = read_list(in, example);
  std::array<std::uint64_t, 2> interval = {1, 1};
  if (ends.size() == 2) {
    interval[0] = read_count(ends[0], StoreLimits::cycles).value_or(1);
    interval[1] = read_count(ends[1], StoreLimits::cycles).value_or(interval[0]);
  }
  if (ends.size() != 2 || interval[1] < interval[0]) {
    in.reject("is not a first and a last cycle", fmt::format("It takes `{}`.", example));
  }
  return interval;
}

PlotSpec read_plot(const Entry& in, const Manifest& manifest) {
  PlotSpec plot;
  std::optional<Entry> x, cycles;
  const auto measures = names_of(all_scalar_measures());
  const auto can_be_x = joined(joined({"cycle"}, measures), parameters());
  const auto can_be_y =
      joined(joined(measures, names_of(all_curve_measures())), names_of(all_run_measures()));
  const Key keys[] = {
      {"name", [&](auto& of) { plot.name = read_own_name(of, manifest); }},
      {"y", [&](auto& of) { plot.y = read_one_of(of, can_be_y); }},
      {"x", [&](auto& of) { plot.x = read_one_of(x.emplace(of), can_be_x); }},
      {"by", [&](auto& of) { plot.by = read_one_of(of, parameters()); }},
      {"show",
       [&](auto& of) {
         plot.traces = read_one_of(of, {"mean", "traces"}) == "traces";
       }},
      {"log",
       [&](auto& of) {
         const string axes = read_one_of(of, {"none", "x", "y", "xy"});
         plot.log_x = axes.starts_with('x');
         plot.log_y = axes.ends_with('y');
       }},
      {"at_cycle", [&](auto& of) { plot.cycle = read_count(of, StoreLimits::cycles); }},
      {"cycles", [&](auto& of) { plot.cycles = read_interval(cycles.emplace(of), "[20, 21]"); }}};
  read_whole(in, keys, 2, "{name: compaction, y: phi, x: cycle}");
  if (const CurveMeasure* curve = find_curve_measure(plot.y); curve != nullptr && x) {
    x->reject_value(fmt::format("does not go with {}", curve->name),
                    fmt::format("Leave it out: {} is drawn against {}.", curve->name, curve->x));
  }
  if (x && !plot.y.empty() && plot.y == plot.x) {
    x->reject_value("is also the y of this plot", "Name another one.");
  }
  const bool against_parameter = !plot.x.empty() && is_parameter(plot.x);
  if (find_run_measure(plot.y) != nullptr && !against_parameter && !plot.x.empty()) {
    in.reject(fmt::format("{} is one number of a run", plot.y), "Name a parameter as x.");
  }
  if (cycles && (!plot.traces || against_parameter)) {
    cycles->reject("draws each run along its cycles",
                   "It takes `show: traces`, and `cycle` or a measure as x.");
  }
  if (const Field* field = against_parameter ? find_field(plot.x) : nullptr) {
    plot.x_symbol = field->symbol;
    if (field->unit != "1") plot.x_unit = field->unit;
    if (get_value(*field, Parameters{}).is_string()) {
      x->reject_value("is not a number", "Take `by` for a curve of each of its values.");
    }
  }
  return plot;
}

void read_between(const Entry& in, std::array<json, 2>& between) {
  const std::string example = "[{fluid: still}, {fluid: cell}]";
  const std::size_t problems_before = in.problems.size();
  const std::vector<Entry> sides = read_list(in, example);
  for (std::size_t k = 0; k < std::min<std::size_t>(sides.size(), 2); ++k) {
    between[k] = json::object();
    for (const Entry& entry : sides[k].entries()) read_where(entry, between[k]);
  }
  const bool two = sides.size() == 2 && !between[0].empty() && !between[1].empty();
  if (!two && in.problems.size() == problems_before) {
    in.reject("does not name two variants", fmt::format("It takes `{}`.", example));
  }
}

ClaimSpec read_claim(const Entry& in, const Manifest& manifest) {
  const string example =
      "{name: same, compare: phi, at_cycle: 10, between: [{fluid: still}, {fluid: cell}], "
      "margin: 0.001}";
  const Field margin =
      real_number("margin", "1", {0, std::numeric_limits<double>::infinity(), true});
  ClaimSpec claim;
  std::optional<Entry> when;
  const auto can_be_compared =
      joined(names_of(all_scalar_measures()), names_of(all_run_measures()));
  const Key keys[] = {
      {"name", [&](auto& of) { claim.name = read_own_name(of, manifest); }},
      {"compare", [&](auto& of) { claim.compare = read_one_of(of, can_be_compared); }},
      {"between", [&](auto& of) { read_between(of, claim.between); }},
      {"margin", [&](auto& of) { claim.margin = read_parameter(margin, of).value_or(0.0); }},
      {"at_cycle",
       [&](auto& of) {
         claim.first = claim.last = read_count(when.emplace(of), StoreLimits::cycles).value_or(1);
       }},
      {"cycles",
       [&](auto& of) {
         if (when) of.reject("does not go with at_cycle", "State one of them.");
         const auto [first, last] = read_interval(when.emplace(of), "[1, 15]");
         claim.first = first, claim.last = last;
       }},
      {"is", [&](auto& of) {
         claim.higher = read_one_of(of, {"same", "higher"}) == "higher";
       }}};
  if (!read_whole(in, keys, 4, example)) return claim;
  const bool of_run = find_run_measure(claim.compare) != nullptr;
  if (of_run && when) {
    when->reject(fmt::format("{} is one number of a run", claim.compare), "Leave it out.");
  } else if (!of_run && !when) {
    in.reject("lacks at_cycle or cycles", fmt::format("It takes `{}`.", example));
  }
  return claim;
}

}  // namespace

void read_labels(const Entry& in, Manifest& manifest) {
  if (!in.is_map()) {
    in.reject_type("a map of names", "It takes `{\"fluid=still\": \"fluid at rest\"}`.");
  }
  for (const Entry& entry : in.entries()) {
    if (!is_text(entry.node, kLongestLabel, false) || entry.node.text.empty()) {
      entry.reject_type("a name",
                        fmt::format("It takes a text of at most {} bytes.", kLongestLabel));
    }
    manifest.labels.push_back({read_selector(entry), entry.node.text, entry.key.at});
  }
}

void read_plots(const Entry& in, Manifest& manifest) {
  for (const Entry& item : read_list(in, "[{name: compaction, y: phi}]")) {
    manifest.plots.push_back({read_plot(item, manifest), item.node.at});
  }
}

void read_claims(const Entry& in, Manifest& manifest) {
  for (const Entry& item : read_list(in, "[{name: same, compare: phi}]")) {
    manifest.claims.push_back({read_claim(item, manifest), item.node.at});
  }
}

}  // namespace shearcell
