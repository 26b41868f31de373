// SPDX-License-Identifier: GPL-3.0-or-later
// Reads `labels`, `plots` and `claims` of a manifest.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include "analysis/figure.hpp"
#include "experiments/manifest/read_parts.hpp"
#include "experiments/manifest/suggest.hpp"

namespace shearcell {
namespace {

constexpr std::size_t kShownNames = 20;

using nlohmann::json;
using std::string;
using std::string_view;

constexpr std::size_t kLongestLabel = 60;  // [bytes]
constexpr std::uint64_t kLastCycle = 1'000'000;

bool is_plain(string_view text) {
  return std::ranges::none_of(text, [](char c) { return (c >= 0 && c < 0x20) || c == 0x7F; });
}

/// One parameter and its value; the value's text stands in `node`.
void read_where(const Node& key, const Node& value, const string& path, json& where,
                ProblemList& problems) {
  const Field* field = find_field(key.text);
  if (field == nullptr) return problems.add_unknown(key, path, field_names());
  if (auto read = read_parameter(*field, value, join_path(path, key.text), problems)) {
    where[key.text] = std::move(*read);
  }
}

/// "fluid=still,amplitude_rad=0.05".
json read_selector(const Node& node, const string& path, ProblemList& problems) {
  json where = json::object();
  string_view rest = node.text;
  while (!rest.empty()) {
    const string_view part = rest.substr(0, rest.find(','));
    rest.remove_prefix(std::min(rest.size(), part.size() + 1));
    const std::size_t equal = part.find('=');
    if (equal == part.npos) {
      problems.add(node.at, path, "does not select variants", shown(node),
                   "It takes `\"fluid=still\"`, or several joined by commas.");
      break;
    }
    const Node key{Node::Kind::scalar, node.at, string(part.substr(0, equal))};
    const Node value{Node::Kind::scalar, node.at, string(part.substr(equal + 1))};
    read_where(key, value, path, where, problems);
  }
  return where;
}

/// The entries of a map with these keys, each handed to `take`. False, with a problem, if it is
/// none or lacks one of the first `required` keys.
bool read_entries(const Node& node, const string& path, std::span<const string_view> known,
                  std::size_t required, const string& example, ProblemList& problems,
                  const std::function<void(const Node& key, const Node& value)>& take) {
  if (node.kind != Node::Kind::map) {
    problems.add_type(node, path, "a map", fmt::format("It takes `{}`.", example));
    return false;
  }
  std::set<string_view> seen;
  for (const auto& [key, value] : node.entries) {
    if (std::ranges::find(known, key.text) == known.end()) {
      problems.add_unknown(key, path, known);
      continue;
    }
    seen.insert(key.text);
    take(key, value);
  }
  for (const string_view key : known.first(required)) {
    if (seen.contains(key)) continue;
    problems.add(node.at, path, fmt::format("lacks {}", key), "",
                 fmt::format("It takes `{}`.", example));
    return false;
  }
  return true;
}

/// The value, if it is one of `known`; else a problem with the nearest of them.
string read_one_of(const Node& node, const string& path, const std::vector<string_view>& known,
                   ProblemList& problems) {
  if (node.kind == Node::Kind::scalar && std::ranges::find(known, node.text) != known.end()) {
    return node.text;
  }
  const string near = node.kind == Node::Kind::scalar ? suggest_name(node.text, known).name : "";
  problems.add(node.at, path,
               near.empty() ? "is unknown" : fmt::format("is unknown, the nearest is {}", near),
               shown(node),
               known.size() > kShownNames ? "`shearcell manual --markdown` lists them."
                                          : fmt::format("Known are {}.", fmt::join(known, ", ")));
  return "";
}

std::vector<string_view> measure_names() {
  std::vector<string_view> names;
  for (const ScalarMeasure& measure : all_scalar_measures()) names.push_back(measure.name);
  return names;
}

std::vector<string_view> with_measures(std::vector<string_view> names) {
  for (const string_view name : measure_names()) names.push_back(name);
  return names;
}

/// A name for files, different from those of the supplement's figures and their panels.
string read_own_name(const Node& node, const string& path, std::set<string>& taken,
                     ProblemList& problems) {
  const auto is_panel = [&](const Figure& figure) {
    if (!node.text.starts_with(figure.name)) return false;
    const string_view rest = string_view(node.text).substr(figure.name.size());
    return rest.size() < 2 || rest.front() == '_';
  };
  if (node.kind != Node::Kind::scalar || !is_name(node.text)) {
    problems.add_type(node, path, "a name", "It takes letters, digits, - and _.");
  } else if (std::ranges::any_of(all_figures(), is_panel)) {
    problems.add(node.at, path, "is the name of a figure of the supplement", shown(node),
                 "Choose another one.");
  } else if (!taken.insert(node.text).second) {
    problems.add(node.at, path, "is the name of another plot or claim", shown(node),
                 "Choose another one.");
  }
  return node.text;
}

/// A first and a last cycle.
std::array<std::uint64_t, 2> read_interval(const Node& node, const string& path,
                                           const string& example, ProblemList& problems) {
  const auto ends = read_list(node, path, example, problems);
  std::array<std::uint64_t, 2> interval = {1, 1};
  if (ends.size() == 2) {
    interval[0] = read_count(ends[0], path, kLastCycle, problems).value_or(1);
    interval[1] = read_count(ends[1], path, kLastCycle, problems).value_or(interval[0]);
  }
  if (ends.size() != 2 || interval[1] < interval[0]) {
    problems.add(node.at, path, "is not a first and a last cycle", "",
                 fmt::format("It takes `{}`.", example));
  }
  return interval;
}

PlotSpec read_plot(const Node& node, std::set<string>& taken, ProblemList& problems) {
  static constexpr std::array<string_view, 8> known = {"name", "y",   "x",        "by",
                                                       "show", "log", "at_cycle", "cycles"};
  const string example = "{name: compaction, y: phi, x: cycle}";
  PlotSpec plot;
  std::optional<Position> x_at;
  Position cycles_at;
  read_entries(node, "plots", known, 2, example, problems, [&](const Node& key, const Node& value) {
    const string path = join_path("plots", key.text);
    if (key.text == "name") {
      plot.name = read_own_name(value, path, taken, problems);
    } else if (key.text == "y") {
      std::vector<string_view> names = measure_names();
      for (const CurveMeasure& curve : all_curve_measures()) names.push_back(curve.name);
      plot.y = read_one_of(value, path, names, problems);
    } else if (key.text == "x") {
      x_at = value.at;
      std::vector<string_view> names = with_measures({"cycle"});
      for (const string_view name : field_names()) names.push_back(name);
      plot.x = read_one_of(value, path, names, problems);
    } else if (key.text == "by") {
      plot.by = read_one_of(value, path, field_names(), problems);
    } else if (key.text == "show") {
      plot.traces = read_one_of(value, path, {"mean", "traces"}, problems) == "traces";
    } else if (key.text == "log") {
      const string axes = read_one_of(value, path, {"none", "x", "y", "xy"}, problems);
      plot.log_x = axes.starts_with('x');
      plot.log_y = axes.ends_with('y');
    } else if (key.text == "cycles") {
      cycles_at = value.at;
      plot.cycles = read_interval(value, path, "[20, 21]", problems);
    } else {
      plot.cycle = read_count(value, path, kLastCycle, problems);
    }
  });
  const CurveMeasure* curve = find_curve_measure(plot.y);
  if (curve != nullptr && x_at) {
    problems.add(*x_at, "plots.x", fmt::format("does not go with {}", curve->name), plot.x,
                 fmt::format("Leave it out: {} is drawn against {}.", curve->name, curve->x));
  }
  const bool against_parameter = plot.x != "cycle" && !plot.x.empty() && !is_measure(plot.x);
  if (plot.cycles && (!plot.traces || against_parameter)) {
    problems.add(cycles_at, "plots.cycles", "draws each run along its cycles", "",
                 "It takes `show: traces`, and `cycle` or a measure as x.");
  }
  if (const Field* field = is_measure(plot.x) ? nullptr : find_field(plot.x)) {
    plot.x_symbol = field->symbol;
    if (!field->symbol.empty() && field->unit != "1") plot.x_unit = field->unit;
  }
  return plot;
}

double read_margin(const Node& node, ProblemList& problems) {
  constexpr double Parameters::*none = nullptr;
  static const Field field{"margin", "", "1", none, 0, std::numeric_limits<double>::max(),
                           true,     {}, ""};
  return read_parameter(field, node, "claims.margin", problems).value_or(0.0).get<double>();
}

ClaimSpec read_claim(const Node& node, std::set<string>& taken, ProblemList& problems) {
  static constexpr std::array<string_view, 7> known = {"name",     "compare", "between", "margin",
                                                       "at_cycle", "cycles",  "is"};
  const string example =
      "{name: same, compare: phi, at_cycle: 10, between: [{fluid: still}, {fluid: cell}], "
      "margin: 0.001}";
  ClaimSpec claim;
  const bool whole = read_entries(
      node, "claims", known, 4, example, problems, [&](const Node& key, const Node& value) {
        const string path = join_path("claims", key.text);
        if (key.text == "name") {
          claim.name = read_own_name(value, path, taken, problems);
        } else if (key.text == "compare") {
          claim.compare = read_one_of(value, path, measure_names(), problems);
        } else if (key.text == "margin") {
          claim.margin = read_margin(value, problems);
        } else if (key.text == "is") {
          claim.higher = read_one_of(value, path, {"same", "higher"}, problems) == "higher";
        } else if (key.text == "at_cycle") {
          claim.first = claim.last = read_count(value, path, kLastCycle, problems).value_or(1);
        } else if (key.text == "cycles") {
          const auto [first, last] = read_interval(value, path, "[1, 15]", problems);
          claim.first = first, claim.last = last;
        } else {
          const std::size_t problems_before = problems.size();
          const auto sides = read_list(value, path, "[{fluid: still}, {fluid: cell}]", problems);
          for (std::size_t k = 0; k < std::min<std::size_t>(sides.size(), 2); ++k) {
            claim.between[k] = json::object();
            for (const auto& [name, of] : sides[k].entries) {
              read_where(name, of, path, claim.between[k], problems);
            }
          }
          const bool two =
              sides.size() == 2 && !claim.between[0].empty() && !claim.between[1].empty();
          if (!two && problems.size() == problems_before) {
            problems.add(value.at, path, "does not name two variants", "",
                         "It takes `[{fluid: still}, {fluid: cell}]`.");
          }
        }
      });
  if (whole && claim.last == 0) {
    problems.add(node.at, "claims", "lacks at_cycle or cycles", "",
                 fmt::format("It takes `{}`.", example));
  }
  return claim;
}

}  // namespace

std::vector<VariantLabel> read_labels(const Node& node, ProblemList& problems) {
  std::vector<VariantLabel> labels;
  if (node.kind != Node::Kind::map || node.entries.empty()) {
    problems.add_type(node, "labels", "a map of names",
                      "It takes `{\"fluid=still\": \"fluid at rest\"}`.");
    return labels;
  }
  for (const auto& [key, value] : node.entries) {
    const string path = join_path("labels", key.text);
    if (value.kind != Node::Kind::scalar || value.text.empty() ||
        value.text.size() > kLongestLabel || !is_plain(value.text)) {
      problems.add_type(value, path, "a name",
                        fmt::format("It takes a text of at most {} bytes.", kLongestLabel));
    }
    labels.push_back({read_selector(key, path, problems), value.text, key.at});
  }
  return labels;
}

void read_plots(const Node& node, Manifest& manifest, ProblemList& problems) {
  std::set<string> taken;
  for (const ClaimSpec& claim : manifest.claims) taken.insert(claim.name);
  for (const Node& item : read_list(node, "plots", "[{name: compaction, y: phi}]", problems)) {
    manifest.plots.push_back(read_plot(item, taken, problems));
  }
}

void read_claims(const Node& node, Manifest& manifest, ProblemList& problems) {
  std::set<string> taken;
  for (const PlotSpec& plot : manifest.plots) taken.insert(plot.name);
  for (const Node& item : read_list(node, "claims", "[{name: same, compare: phi}]", problems)) {
    manifest.claims.push_back(read_claim(item, taken, problems));
  }
}

}  // namespace shearcell
