// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/read_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <numeric>
#include <set>

#include "experiments/manifest/numerics.hpp"

namespace shearcell {
namespace {

using nlohmann::json;
using std::string;
using std::string_view;

constexpr std::uint64_t kLargestCadence = 1'000'000;  // cycles
// Counts that a reader of the store in any language holds exactly.
constexpr std::uint64_t kLargestSeed = (std::uint64_t{1} << 53) - 1;

// As rows of the schema that no Parameters holds.
std::span<const Field> until_fields() {
  constexpr double Parameters::*real = nullptr;
  constexpr std::uint64_t Parameters::*whole = nullptr;
  static const std::array<Field, 4> fields = {
      Field{"crystalline_percent", "", "%", real, 0, 100, true, {}, ""},
      Field{"largest_crystallite", "", "1", whole, 1, 1e8, false, {}, ""},
      Field{"phi", "", "1", real, 0, 1, true, {}, ""},
      Field{"extra_cycles", "", "1", whole, 0, 1e6, false, {}, ""}};
  return fields;
}

std::vector<double> read_phases(const Node& node, const string& path, ProblemList& problems) {
  constexpr double Parameters::*none = nullptr;
  constexpr double largest = std::numeric_limits<double>::max();
  static const Field field{"phases", "", "1", none, -largest, largest, false, {}, ""};
  std::vector<double> phases;
  for (const Node& item : read_list(node, path, "[0.25, 0.5, 0.75]", problems)) {
    const auto read = read_parameter(field, item, path, problems);
    if (!read) continue;
    const auto phase = read->get<double>();
    if (!(phase > 0 && phase < 1)) {
      problems.add(item.at, path, "is not within a cycle", shown(item),
                   "It takes fractions p of a cycle, 0 < p < 1.");
    } else if (!phases.empty() && phase <= phases.back()) {
      problems.add(item.at, path, "is not greater than the phase before it", shown(item),
                   "List them in ascending order, each once.");
    } else {
      phases.push_back(phase);
    }
  }
  return phases;
}

std::optional<SweepAxis> read_axis(const Node& key, const Node& values, const string& path,
                                   bool in_zip, ProblemList& problems) {
  const string full = join_path(path, key.text);
  const Field* field = find_field(key.text);
  if (field == nullptr) {
    problems.add_unknown(key, path, field_names());
    return std::nullopt;
  }
  if (!field->identity.distinguishes_runs() && !(in_zip && is_length(key.text))) {
    problems.add(key.at, full, "cannot be swept, since another value does not make another run", "",
                 is_length(key.text)
                     ? "Set it in `base` or in a scale, or zip it with a key that does."
                     : "Set it in `base` or in a scale.");
    return std::nullopt;
  }
  SweepAxis axis{key.text, key.at, {}};
  for (const Node& item : read_list(values, full, "[1, 2]", problems)) {
    if (is_auto(*field, item)) {
      problems.add(item.at, full, "cannot be swept as `auto`", "",
                   "Set it in `base` or in a scale; it then follows the variant.");
    } else if (auto value = read_parameter(*field, item, full, problems)) {
      axis.values.push_back({std::move(*value), item.at});
    }
  }
  return axis;
}

std::vector<SweepAxis> read_axes(const Node& node, const string& path, bool in_zip,
                                 ProblemList& problems) {
  std::vector<SweepAxis> axes;
  if (node.kind != Node::Kind::map || node.entries.empty()) {
    problems.add(node.at, path, "sweeps nothing", shown(node), "It takes `{key: [values]}`.");
    return axes;
  }
  for (const auto& [key, values] : node.entries) {
    if (auto axis = read_axis(key, values, path, in_zip, problems))
      axes.push_back(std::move(*axis));
  }
  return axes;
}

void check_grid(const Sweep& sweep, const string& path, ProblemList& problems) {
  for (const SweepAxis& axis : sweep.grid) {
    const string full = fmt::format("{}.grid.{}", path, axis.key);
    std::set<json> seen;
    for (const Setting& setting : axis.values) {
      if (seen.insert(setting.value).second) continue;
      problems.add(setting.at, full, "repeats a value", setting.value.dump(), "Keep one of them.");
    }
    if (std::ranges::find(sweep.zip, axis.key, &SweepAxis::key) != sweep.zip.end()) {
      problems.add(axis.at, full, "is in both grid and zip", "", "Keep one of them.");
    }
  }
}

void check_zip(const std::vector<SweepAxis>& zip, const string& path, ProblemList& problems) {
  if (zip.empty()) return;
  if (zip.size() == 1 && is_length(zip.front().key)) {
    problems.add(zip.front().at, fmt::format("{}.zip.{}", path, zip.front().key),
                 "advances with no other key", "", "Set it in `base` or in a scale.");
    return;
  }
  const std::size_t rows = zip.front().values.size();
  for (const SweepAxis& axis : zip) {
    if (axis.values.size() == rows) continue;
    problems.add(axis.at, fmt::format("{}.zip.{}", path, axis.key),
                 fmt::format("differs in length from {}, which has {}", zip.front().key, rows),
                 fmt::format("{} values", axis.values.size()),
                 "The lists of a zip advance together; make them equally long.");
    return;
  }
  std::set<json> seen;
  for (std::size_t row = 0; row < rows; ++row) {
    json values = json::array();
    for (const SweepAxis& axis : zip) {
      if (!is_length(axis.key)) values.push_back(axis.values[row].value);
    }
    if (seen.insert(values).second) continue;
    problems.add(zip.front().values[row].at, fmt::format("{}.zip", path), "repeats a row of values",
                 printable(values.dump()), "Keep one of them.");
  }
}

}  // namespace

std::optional<json> read_parameter(const Field& field, const Node& node, const string& key,
                                   ProblemList& problems) {
  if (node.kind != Node::Kind::scalar) {
    problems.add_type(node, key, "a single value",
                      fmt::format("It takes {}.", expected_values(field)));
    return std::nullopt;
  }
  std::variant<json, ValueProblem> read = read_value(field, node.text, node.quoted);
  std::optional<ValueProblem> wrong;
  if (auto* value = std::get_if<json>(&read)) {
    wrong = check_value(field, *value);
    if (!wrong) return std::move(*value);
  } else {
    wrong = std::get<ValueProblem>(read);
  }
  problems.add(node.at, key, wrong->problem, shown(node), wrong->remedy);
  return std::nullopt;
}

bool is_auto(const Field& field, const Node& node) {
  return takes_auto(field.name) && node.kind == Node::Kind::scalar && !node.quoted &&
         node.text == "auto";
}

std::optional<std::uint64_t> read_count(const Node& node, const string& key, std::uint64_t largest,
                                        ProblemList& problems) {
  if (node.kind == Node::Kind::scalar && !node.quoted && !node.text.starts_with('0')) {
    std::uint64_t value = 0;
    const char* end = node.text.data() + node.text.size();
    const auto [stop, error] = std::from_chars(node.text.data(), end, value);
    if (stop == end && error == std::errc() && value <= largest) return value;
  }
  problems.add(node.at, key, fmt::format("is not an integer from 1 to {}", largest), shown(node),
               "");
  return std::nullopt;
}

std::span<const Node> read_list(const Node& node, const string& key, string_view example,
                                ProblemList& problems) {
  const string remedy = fmt::format("It takes a list such as {}.", example);
  if (node.kind != Node::Kind::list) {
    problems.add_type(node, key, "a list", remedy);
    return {};
  }
  if (node.items.empty()) problems.add(node.at, key, "is an empty list", "", remedy);
  if (node.items.size() > ManifestLimits::values_per_list) {
    problems.add(node.at, key,
                 fmt::format("has more than {} values", ManifestLimits::values_per_list),
                 fmt::format("{} values", node.items.size()), "Shorten the list.");
    return {};
  }
  return node.items;
}

Sweep read_sweep(const Node& node, const string& path, ProblemList& problems) {
  constexpr std::array<string_view, 2> kinds = {"grid", "zip"};
  const string remedy = "It takes `grid: {key: [values]}` or `zip: {key: [values]}`.";
  Sweep sweep;
  if (node.kind != Node::Kind::map || node.entries.empty()) {
    problems.add(node.at, path, "sweeps nothing", shown(node), remedy);
    return sweep;
  }
  for (const auto& [key, value] : node.entries) {
    if (key.text == "grid") {
      sweep.grid = read_axes(value, join_path(path, "grid"), false, problems);
    } else if (key.text == "zip") {
      sweep.zip = read_axes(value, join_path(path, "zip"), true, problems);
    } else if (find_field(key.text) != nullptr) {
      problems.add(key.at, join_path(path, key.text), "must stand under `grid` or `zip`", "",
                   remedy);
    } else {
      problems.add_unknown(key, path, kinds);
    }
  }
  check_grid(sweep, path, problems);
  check_zip(sweep.zip, path, problems);
  return sweep;
}

Checkpoints read_checkpoints(const Node& node, const string& path, ProblemList& problems) {
  static constexpr std::array<string_view, 2> known = {"every_cycles", "phases"};
  Checkpoints checkpoints{.at = node.at};
  if (node.kind != Node::Kind::map || node.entries.empty()) {
    problems.add_type(node, path, "a map of settings", "It takes `{every_cycles: 1}`.");
    return checkpoints;
  }
  for (const auto& [key, value] : node.entries) {
    const string full = join_path(path, key.text);
    if (key.text == known[0]) {
      checkpoints.every_cycles = read_count(value, full, kLargestCadence, problems).value_or(1);
    } else if (key.text == known[1]) {
      checkpoints.at = value.at;
      checkpoints.phases = read_phases(value, full, problems);
    } else {
      problems.add_unknown(key, path, known);
    }
  }
  return checkpoints;
}

StatedUntil read_until(const Node& node, const string& key, ProblemList& problems) {
  StatedUntil stated{{}, node.at};
  if (node.kind == Node::Kind::scalar && node.text == "none") return stated;
  const string remedy = "It takes `{crystalline_percent: 10, extra_cycles: 15}`, or `none`.";
  if (node.kind != Node::Kind::map || node.entries.empty()) {
    problems.add_type(node, key, "a measure with its value", remedy);
    return stated;
  }
  std::vector<string_view> allowed;
  for (const Field& field : until_fields()) allowed.push_back(field.name);
  std::uint64_t extra_cycles = 0;
  bool unknown = false;
  for (const auto& [name, value] : node.entries) {
    const auto field = std::ranges::find(until_fields(), name.text, &Field::name);
    if (field == until_fields().end()) {
      problems.add_unknown(name, key, allowed);
      unknown = true;
      continue;
    }
    const auto read = read_parameter(*field, value, join_path(key, name.text), problems);
    const auto measure = value_of<StopMeasure>(name.text);
    if (!measure) {
      extra_cycles = read.value_or(0).get<std::uint64_t>();
    } else if (stated.until) {
      problems.add(name.at, key, "names two measures", "", "Keep one of them.");
    } else {
      stated.until = Until{*measure, read.value_or(0).get<double>()};
    }
  }
  if (stated.until) {
    stated.until->extra_cycles = extra_cycles;
  } else if (!unknown) {
    problems.add(node.at, key, "names no measure", "", remedy);
  }
  return stated;
}

Seeds read_seeds(const Node& node, const string& key, ProblemList& problems) {
  Seeds seeds;
  if (node.kind != Node::Kind::list) {
    seeds.values.resize(read_count(node, key, ManifestLimits::runs, problems).value_or(1));
    std::iota(seeds.values.begin(), seeds.values.end(), 1);
    return seeds;
  }
  seeds = {.values = {}, .counted = false};
  for (const Node& item : read_list(node, key, "[3, 5]", problems)) {
    const auto seed = read_count(item, key, kLargestSeed, problems);
    if (!seed) continue;
    if (std::ranges::find(seeds.values, *seed) != seeds.values.end()) {
      problems.add(item.at, key, "repeats a seed", shown(item), "Keep one of them.");
    }
    seeds.values.push_back(*seed);
  }
  return seeds;
}

}  // namespace shearcell
