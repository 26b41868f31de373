// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/read_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <utility>

#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/suggest.hpp"
#include "provenance/limits.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

using nlohmann::json;
using std::string;
using std::string_view;

// A double holds it exactly, so readers in any language can.
constexpr std::uint64_t kLargestSeed = (std::uint64_t{1} << 53) - 1;

std::vector<double> read_phases(const Entry& in) {
  constexpr double any = std::numeric_limits<double>::infinity();
  std::vector<double> phases;
  for (const Entry& item : read_list(in, "[0.25, 0.5, 0.75]")) {
    const auto read = read_parameter(real_number("phases", "1", {-any, any}), item);
    if (!read) continue;
    const auto phase = read->get<double>();
    if (!(phase > 0 && phase < 1)) {
      item.reject_value("is not within a cycle", "It takes fractions p of a cycle, 0 < p < 1.");
    } else if (!phases.empty() && phase <= phases.back()) {
      item.reject_value("is not greater than the phase before it",
                        "List them in ascending order, each once.");
    } else {
      phases.push_back(phase);
    }
  }
  return phases;
}

void read_axis(const Entry& in, bool in_zip, std::vector<SweepAxis>& axes) {
  const Field* field = find_field(in.key.text);
  if (field == nullptr) return in.reject_unknown(names_of(schema()));
  const bool length = is_length(field->name);
  if (!field->identity.distinguishes_runs() && !(in_zip && length)) {
    return in.reject_key("cannot be swept, since another value does not make another run",
                         length ? "Set it in `base` or in a scale, or zip it with a key that does."
                                : "Set it in `base` or in a scale.");
  }
  SweepAxis& axis = axes.emplace_back(SweepAxis{in.key.text, in.key.at, {}});
  for (const Entry& item : read_list(in, "[1, 2]")) {
    if (is_auto(*field, item.node)) {
      item.reject("cannot be swept as `auto`",
                  "Set it in `base` or in a scale; it then follows the variant.");
    } else if (auto value = read_parameter(*field, item)) {
      axis.values.push_back({std::move(*value), item.node.at});
    }
  }
}

std::vector<SweepAxis> read_axes(const Entry& in, bool in_zip) {
  std::vector<SweepAxis> axes;
  if (!in.is_map()) in.reject_value("sweeps nothing", "It takes `{key: [values]}`.");
  for (const Entry& entry : in.entries()) read_axis(entry, in_zip, axes);
  return axes;
}

void check_grid(const Sweep& sweep, const Entry& in) {
  for (const SweepAxis& axis : sweep.grid) {
    const string path = fmt::format("{}.grid.{}", in.path, axis.key);
    std::set<json> seen;
    for (const Setting& setting : axis.values) {
      if (seen.insert(setting.value).second) continue;
      in.problems.add(setting.at, path, "repeats a value", setting.value.dump(),
                      "Keep one of them.");
    }
    if (std::ranges::find(sweep.zip, axis.key, &SweepAxis::key) != sweep.zip.end()) {
      in.problems.add(axis.at, path, "is in both grid and zip", "", "Keep one of them.");
    }
  }
}

void check_zip(const std::vector<SweepAxis>& zip, const Entry& in) {
  if (zip.empty()) return;
  const string path = in.path + ".zip";
  const SweepAxis& first = zip.front();
  if (zip.size() == 1 && is_length(first.key)) {
    return in.problems.add(first.at, path + "." + first.key, "advances with no other key", "",
                           "Set it in `base` or in a scale.");
  }
  const std::size_t rows = first.values.size();
  for (const SweepAxis& axis : zip) {
    if (axis.values.size() == rows) continue;
    return in.problems.add(axis.at, path + "." + axis.key,
                           fmt::format("differs in length from {}, which has {}", first.key, rows),
                           counted(axis.values.size(), "value"),
                           "The lists of a zip advance together; make them equally long.");
  }
  std::set<json> seen;
  for (std::size_t row = 0; row < rows; ++row) {
    json values = json::array();
    for (const SweepAxis& axis : zip) {
      if (!is_length(axis.key)) values.push_back(axis.values[row].value);
    }
    if (seen.insert(values).second) continue;
    in.problems.add(first.values[row].at, path, "repeats a row of values", printable(values.dump()),
                    "Keep one of them.");
  }
}

}  // namespace

std::optional<json> read_parameter(const Field& field, const Entry& in) {
  if (!in.is_scalar()) {
    in.reject_type("a single value", fmt::format("It takes {}.", expected_values(field)));
    return std::nullopt;
  }
  std::variant<json, ValueProblem> read = read_value(field, in.node.text, in.node.quoted);
  if (const auto* wrong = std::get_if<ValueProblem>(&read)) {
    in.reject_value(wrong->problem, wrong->remedy);
    return std::nullopt;
  }
  return std::get<json>(std::move(read));
}

bool is_auto(const Field& field, const Node& node) {
  return takes_auto(field.name) && node.kind == Node::Kind::scalar && !node.quoted &&
         node.text == "auto";
}

std::optional<std::uint64_t> read_count(const Entry& in, std::uint64_t largest) {
  const auto read = read_parameter(whole_number("", {1, static_cast<double>(largest)}), in);
  return read ? std::optional(read->get<std::uint64_t>()) : std::nullopt;
}

bool is_text(const Node& node, std::size_t longest, bool lines) {
  return node.kind == Node::Kind::scalar && node.text.size() <= longest &&
         (lines || node.text.find('\n') == node.text.npos);
}

std::vector<Entry> read_list(const Entry& in, string_view example) {
  constexpr std::size_t most = ManifestLimits::values_per_list;
  const string remedy = fmt::format("It takes a list such as {}.", example);
  const std::size_t count = in.node.items.size();
  if (in.node.kind != Node::Kind::list) {
    in.reject_type("a list", remedy);
  } else if (count == 0) {
    in.reject("is an empty list",
              fmt::format("Remove the key, or write a list such as {}.", example));
  } else if (count > most) {
    in.problems.add(in.node.at, in.path, fmt::format("has more than {} values", most),
                    fmt::format("{} values", count), "Shorten the list.");
  } else {
    return in.items();
  }
  return {};
}

std::set<string_view> read_keys(const Entry& map, std::span<const Key> keys) {
  std::set<string_view> found;
  for (const Entry& entry : map.entries()) {
    const auto key = std::ranges::find(keys, entry.key.text, &Key::name);
    if (key == keys.end()) {
      entry.reject_unknown(names_of(keys));
    } else {
      found.insert(key->name);
      key->read(entry);
    }
  }
  return found;
}

Sweep read_sweep(const Entry& in) {
  constexpr std::array<string_view, 2> kinds = {"grid", "zip"};
  const string remedy = "It takes `grid: {key: [values]}` or `zip: {key: [values]}`.";
  Sweep sweep;
  if (!in.is_map()) in.reject_value("sweeps nothing", remedy);
  for (const Entry& entry : in.entries()) {
    if (entry.key.text == "grid") {
      sweep.grid = read_axes(entry, false);
    } else if (entry.key.text == "zip") {
      sweep.zip = read_axes(entry, true);
    } else if (find_field(entry.key.text) != nullptr) {
      entry.reject_key("must be under `grid` or `zip`", remedy);
    } else {
      entry.reject_unknown(kinds);
    }
  }
  check_grid(sweep, in);
  check_zip(sweep.zip, in);
  return sweep;
}

Checkpoints read_checkpoints(const Entry& in) {
  Checkpoints checkpoints{.at = in.node.at};
  if (!in.is_map()) in.reject_type("a map of settings", "It takes `{every_cycles: 1}`.");
  const Key keys[] = {{"every_cycles",
                       [&](const Entry& entry) {
                         checkpoints.every_cycles =
                             read_count(entry, StoreLimits::cycles).value_or(1);
                       }},
                      {"phases", [&](const Entry& entry) {
                         checkpoints.at = entry.node.at;
                         checkpoints.phases = read_phases(entry);
                       }}};
  read_keys(in, keys);
  return checkpoints;
}

StatedUntil read_until(const Entry& in) {
  // Read like parameters.
  static const std::array<Field, 4> fields = {
      real_number("crystalline_percent", "%", {0, 100, true}),
      whole_number("largest_crystallite", {1, 1e8}), real_number("phi", "1", {0, 1, true}),
      whole_number("extra_cycles", {0, StoreLimits::cycles})};
  StatedUntil stated{{}, in.node.at};
  if (in.is_scalar() && in.node.text == "none") return stated;
  const string remedy = "It takes `{crystalline_percent: 10, extra_cycles: 15}`, or `none`.";
  if (!in.is_map()) {
    in.reject_type("a measure with its value", remedy);
    return stated;
  }
  std::uint64_t extra_cycles = 0;
  std::vector<Key> keys;
  for (const Field& field : fields) {
    keys.push_back({field.name, [&](const Entry& entry) {
                      const auto read = read_parameter(field, entry);
                      const auto measure = value_of<StopMeasure>(field.name);
                      if (!measure) {
                        extra_cycles = read.value_or(0).get<std::uint64_t>();
                      } else if (stated.until) {
                        in.problems.add(entry.key.at, in.path, "names two measures", "",
                                        "Keep one of them.");
                      } else {
                        stated.until = Until{*measure, read.value_or(0).get<double>()};
                      }
                    }});
  }
  const bool all_known = read_keys(in, keys).size() == in.node.entries.size();
  if (stated.until) {
    stated.until->extra_cycles = extra_cycles;
  } else if (all_known) {
    in.reject("names no measure", remedy);
  }
  return stated;
}

Seeds read_seeds(const Entry& in) {
  Seeds seeds{.at = in.key.at};
  if (in.node.kind != Node::Kind::list) {
    seeds.values.resize(read_count(in, ManifestLimits::runs).value_or(1));
    std::iota(seeds.values.begin(), seeds.values.end(), 1);
    return seeds;
  }
  seeds.values.clear();
  seeds.counted = false;
  for (const Entry& item : read_list(in, "[3, 5]")) {
    const auto seed = read_count(item, kLargestSeed);
    if (!seed) continue;
    if (std::ranges::find(seeds.values, *seed) != seeds.values.end()) {
      item.reject_value("repeats a seed", "Keep one of them.");
    }
    seeds.values.push_back(*seed);
  }
  return seeds;
}

}  // namespace shearcell
