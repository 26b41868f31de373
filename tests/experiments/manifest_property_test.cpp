// SPDX-License-Identifier: GPL-3.0-or-later
// For random manifests: every combination is run once, and a run's id depends on its physics only.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <set>
#include <variant>

#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/expand.hpp"
#include "experiments/manifest/schema.hpp"
#include "tests/property.hpp"

namespace shearcell::test {
namespace {

using nlohmann::json;
using Strings = std::vector<std::string>;

template <typename T>
void shuffle(std::vector<T>& items) {
  for (std::size_t i = items.size(); i > 1; --i) {
    std::swap(items[i - 1], items[*rc::gen::inRange<std::size_t>(0, i)]);
  }
}

struct Axis {
  std::string key;
  Strings values;
};

// A sweep and its seeds, written in some order.
struct Written {
  std::vector<Axis> grid, zip;
  std::vector<std::uint64_t> seeds;

  std::string text() const {
    const auto axes = [](const std::vector<Axis>& all) {
      Strings parts;
      for (const Axis& axis : all) {
        parts.push_back(fmt::format("{}: [{}]", axis.key, fmt::join(axis.values, ", ")));
      }
      return fmt::format("{{{}}}", fmt::join(parts, ", "));
    };
    Strings sweeps;
    if (!grid.empty()) sweeps.push_back("grid: " + axes(grid));
    if (!zip.empty()) sweeps.push_back("zip: " + axes(zip));
    Strings sections = {"experiment: any", "base: {period_s: 2, steps_per_cycle: 100000}",
                        fmt::format("seeds: [{}]", fmt::join(seeds, ", "))};
    if (!sweeps.empty()) {
      shuffle(sweeps);
      sections.push_back(fmt::format("sweep: {{{}}}", fmt::join(sweeps, ", ")));
    }
    shuffle(sections);
    return fmt::format("{}\n", fmt::join(sections, "\n"));
  }
};

Written any_sweep() {
  std::vector<Axis> axes = {{"amplitude_rad", {"0.05", "0.0625", "1e-3"}},
                            {"period_s", {"2", "2.5", "4"}},
                            {"steps_per_cycle", {"100001", "120000"}},
                            {"fluid", {"still", "cell"}},
                            {"gravity_m_per_s2", {"0", "9.81", "1"}},
                            {"walls", {"rough", "smooth"}},
                            {"moving_wall", {"top", "bottom"}},
                            {"protocol", {"continuous", "paused"}},
                            {"grains", {"300", "301", "1000"}}};
  shuffle(axes);
  axes.resize(*rc::gen::inRange<std::size_t>(0, 5).as("swept keys"));
  Written written;
  for (Axis& axis : axes) {
    shuffle(axis.values);
    auto& kind = *rc::gen::arbitrary<bool>().as("in the zip") ? written.zip : written.grid;
    kind.push_back(std::move(axis));
  }
  std::size_t rows = *rc::gen::inRange<std::size_t>(1, 4).as("rows of the zip");
  for (const Axis& axis : written.zip) rows = std::min(rows, axis.values.size());
  for (Axis& axis : written.zip) axis.values.resize(rows);
  for (Axis& axis : written.grid) {
    axis.values.resize(*rc::gen::inRange<std::size_t>(1, axis.values.size() + 1));
  }
  written.seeds = *rc::gen::unique<std::vector<std::uint64_t>>(
      *rc::gen::inRange<std::size_t>(1, 4), rc::gen::inRange<std::uint64_t>(1, 50));
  return written;
}

std::string value_text(const std::string& written) {
  char* end = nullptr;
  const double number = std::strtod(written.c_str(), &end);
  return *end == '\0' ? fmt::format("{}", number) : written;
}

// Every combination by counting through them, one line each, its parts sorted.
std::vector<std::string> combinations(const Written& written) {
  std::vector<Strings> all = {{}};
  const auto multiply = [&all](std::size_t count, const auto& parts_of) {
    std::vector<Strings> next;
    for (const Strings& sofar : all) {
      for (std::size_t i = 0; i < count; ++i) {
        next.push_back(sofar);
        parts_of(i, next.back());
      }
    }
    all = std::move(next);
  };
  const auto add = [](const Axis& axis, std::size_t i, Strings& parts) {
    parts.push_back(axis.key + "=" + value_text(axis.values[i]));
  };
  for (const Axis& axis : written.grid) {
    multiply(axis.values.size(), [&](std::size_t i, Strings& parts) { add(axis, i, parts); });
  }
  multiply(written.zip.empty() ? 1 : written.zip[0].values.size(),
           [&](std::size_t i, Strings& parts) {
             for (const Axis& axis : written.zip) add(axis, i, parts);
           });
  multiply(written.seeds.size(), [&](std::size_t i, Strings& parts) {
    parts.push_back(fmt::format("seed={}", written.seeds[i]));
  });
  Strings lines;
  for (Strings& parts : all) {
    std::sort(parts.begin(), parts.end());
    lines.push_back(fmt::format("{}", fmt::join(parts, " ")));
  }
  return lines;
}

// The same of what it expands to, from the parameters that will be computed.
std::string described(const PlannedRun& run) {
  Strings parts = {fmt::format("seed={}", run.place.seed)};
  for (const auto& [key, label] : run.place.swept.items()) {
    const json value = find_field(key)->get(run.parameters);
    RC_ASSERT(value == label);
    parts.push_back(key + "=" + value_text(value.is_string() ? std::string(value) : value.dump()));
  }
  std::sort(parts.begin(), parts.end());
  return fmt::format("{}", fmt::join(parts, " "));
}

PROPERTY(Expand, GivesEveryCombinationAndSeedOnce, 400) {
  const Written written = any_sweep();
  const Plan plan = expand(parse_manifest(written.text(), "any.yaml"));
  Strings expected = combinations(written), found;
  std::set<std::string> ids;
  for (const PlannedRun& run : plan.runs) {
    found.push_back(described(run));
    ids.insert(run.stage.id);
  }
  std::sort(expected.begin(), expected.end());
  std::sort(found.begin(), found.end());
  RC_ASSERT(found == expected);
  RC_ASSERT(ids.size() == plan.runs.size());
}

PROPERTY(Expand, DoesNotDependOnTheOrderOfWriting, 300) {
  const auto ids = [](const Written& written) {
    std::multiset<std::string> found;
    for (const PlannedRun& run : expand(parse_manifest(written.text(), "any.yaml")).runs) {
      found.insert(fmt::format("{} {} {}", run.place.seed, run.prepare->id, run.stage.id));
    }
    return found;
  };
  Written written = any_sweep();
  const auto before = ids(written);
  shuffle(written.grid);
  for (Axis& axis : written.grid) shuffle(axis.values);
  shuffle(written.zip);
  if (!written.zip.empty()) {  // its rows, equally many on all axes
    const std::size_t first = *rc::gen::inRange<std::size_t>(0, written.zip[0].values.size());
    for (Axis& axis : written.zip) {
      std::rotate(axis.values.begin(), axis.values.begin() + static_cast<std::ptrdiff_t>(first),
                  axis.values.end());
    }
  }
  shuffle(written.seeds);
  RC_ASSERT(ids(written) == before);
}

// digits x 10^exponent in one of the ways to write it.
std::string notation(std::int64_t digits, int exponent) {
  std::string text = std::to_string(digits);
  switch (*rc::gen::element(0, 1, 2, 3, 4).as("notation")) {
    case 0:
      return fmt::format("{}e{}", text, exponent);
    case 1:
      return fmt::format("+{}00e{}", text, exponent - 2);
    case 2: {
      const int shift = static_cast<int>(text.size()) - 1;
      return fmt::format("{}.{}0E{:+}", text.substr(0, 1), text.substr(1), exponent + shift);
    }
    case 3:
      return (digits == 0 ? "-" : "") + fmt::format("{}.0e{}", text, exponent);
    default: {  // 0.00123, 12.3
      const auto places = static_cast<std::size_t>(-exponent);
      if (text.size() <= places) text.insert(0, places + 1 - text.size(), '0');
      return text.insert(text.size() - places, ".") + "0";
    }
  }
}

// A value of a key, and whether it is the default.
struct Stated {
  std::string key, plain;
  std::int64_t digits = 0;
  int exponent = 0;  // below 0 for a real number, 0 for an integer, 1 for a name
  bool is_default = false;

  std::string any_form() const {
    if (exponent < 0) return notation(digits, exponent);
    const bool quoted = exponent > 0 && *rc::gen::arbitrary<bool>().as("quoted");
    return quoted ? "'" + plain + "'" : plain;
  }
};

std::vector<Stated> any_base() {
  std::vector<Stated> all;
  const auto number = [&all](const char* key, std::int64_t low, std::int64_t high, int exponent,
                             std::int64_t usual) {
    const std::int64_t digits =
        *rc::gen::oneOf(rc::gen::element(usual, low), rc::gen::inRange(low, high));
    const auto plain =
        fmt::format("{}{}", digits, exponent == 0 ? "" : fmt::format("e{}", exponent));
    all.push_back({key, plain, digits, exponent, digits == usual});
  };
  number("amplitude_rad", 0, 5000, -4, 833);
  number("period_s", 1000, 4000, -3, 2000);
  number("gravity_m_per_s2", 0, 2000, -2, 981);
  number("mass_kg", 100, 999, -7, 200);
  number("diameter_m", 1, 99, -4, 30);
  number("drag_kg_per_s", 0, 999, -5, 128);
  number("pressure_Pa", 1, 99999, -1, 9540);
  number("settle_force_tolerance", 1, 99, -4, 10);
  number("grains", 100, 9999, 0, 7900);
  number("wall_grain_draw", 0, 5, 0, 0);
  const auto name = [&all](const char* key, const char* usual, const char* other) {
    const bool keep = *rc::gen::arbitrary<bool>().as("the default");
    all.push_back({key, keep ? usual : other, 0, 1, keep});
  };
  name("fluid", "still", "cell");
  name("walls", "rough", "smooth");
  name("moving_wall", "bottom", "top");
  name("protocol", "continuous", *rc::gen::element("paused", "stiffen"));
  return all;
}

PROPERTY(Identity, IgnoresHowAManifestIsWrittenAndHowLongARunIs, 500) {
  std::vector<Stated> all = any_base();
  const std::string steps = "steps_per_cycle: 100000";
  Strings plain = {steps}, other = {steps}, in_scale, in_sweep;
  for (const Stated& stated : all) plain.push_back(stated.key + ": " + stated.plain);
  shuffle(all);
  for (const Stated& stated : all) {
    const int where = *rc::gen::element(0, 1, 2, 3).as("where it is written");
    const std::string line = stated.key + ": " + stated.any_form();
    if (where == 0 && stated.is_default) continue;
    if (where == 1) {
      in_scale.push_back(line);
    } else if (where == 2) {
      in_sweep.push_back(fmt::format("{}: [{}]", stated.key, stated.any_form()));
    } else {
      other.push_back(line);
    }
  }
  other.push_back(fmt::format("cycles: {}", *rc::gen::inRange(0, 1000).as("cycles")));
  shuffle(other);
  const auto cadence = *rc::gen::inRange(1, 10).as("cadence");
  const auto ids = [](const std::string& text) {
    const Plan plan = expand(parse_manifest(text, "any.yaml"));
    RC_ASSERT(plan.runs.size() == 1U);
    return plan.runs[0].prepare->id + plan.runs[0].stage.id;
  };
  const std::string sweep =
      in_sweep.empty() ? "" : fmt::format("sweep: {{grid: {{{}}}}}\n", fmt::join(in_sweep, ", "));
  RC_ASSERT(ids(fmt::format("experiment: a\nbase: {{{}}}\n", fmt::join(plain, ", "))) ==
            ids(fmt::format("scales: {{desk: {{{}}}}}\ncheckpoints: {{every_cycles: {}}}\n{}"
                            "base: {{{}}}\nexperiment: b\n",
                            fmt::join(in_scale, ", "), cadence, sweep, fmt::join(other, ", "))));
}

json any_value(const Field& field) {
  if (field.is_choice()) {
    return field.names[*rc::gen::inRange<std::size_t>(0, field.names.size())];
  }
  if (field.whole) {
    const auto low = static_cast<std::uint64_t>(field.range.min);
    return *rc::gen::inRange<std::uint64_t>(low, static_cast<std::uint64_t>(field.range.max) + 1);
  }
  const double share = *rc::gen::inRange(1, 1001) / 1000.0;  // never the lower end
  return field.range.min + (field.range.max - field.range.min) * std::pow(share, 4);
}

Parameters any_parameters() {
  Parameters parameters;
  for (const Field& field : schema()) {
    if (*rc::gen::arbitrary<bool>()) field.set(parameters, any_value(field));
  }
  return parameters;
}

// Whether the field affects the last stage, beside what affects its packing.
bool has_effect(const Field& field, const Parameters& before, const Parameters& after) {
  if (field.name == "protocol") return true;
  if (before.protocol == ProtocolKind::stiffen) return field.identity.stage == StageKind::stiffen;
  return field.identity.stage == StageKind::shear && !field.identity.selects_parent &&
         (!field.identity.under || field.identity.under == after.protocol);
}

PROPERTY(Identity, ChangesWithEachValueAsTheSchemaStates, 100) {
  const Parameters before = any_parameters();
  const Stage prepare = prepare_stage(before, 1);
  const Stage last = last_stage(before, 1, prepare);
  for (const Field& field : schema()) {
    const json value = field.get(before);
    json other = any_value(field);
    if (value.is_number_float() && *rc::gen::arbitrary<bool>().as("by one bit")) {
      other = std::nextafter(value.get<double>(),
                             field.range.max == value ? field.range.min : field.range.max);
    }
    if (other == value) continue;
    Parameters after = before;
    field.set(after, other);
    const Stage other_prepare = prepare_stage(after, 1);
    const bool settling = field.identity.stage == StageKind::prepare &&
                          field.identity.distinguishes_runs() &&
                          (field.name != "pressure_at" || depends_on_pressure_at(before));
    RC_LOG() << field.name << " " << value << " " << other << "\n";
    RC_ASSERT((other_prepare.id != prepare.id) == settling);
    RC_ASSERT((last_stage(after, 1, other_prepare).id != last.id) ==
              (settling || has_effect(field, before, after)));
  }
}

PROPERTY(Identity, OfARecordReadBackIsTheSame, 300) {
  const Parameters parameters = any_parameters();
  const auto seed = *rc::gen::inRange<std::uint64_t>(1, 1ULL << 53);
  const Stage prepare = prepare_stage(parameters, seed);
  const Stage last = last_stage(parameters, seed, prepare);
  for (const Stage& stage : {prepare, last}) {
    for (const std::string& text : {stage.resolved.dump(), canonical_json(stage.resolved)}) {
      const json stored = json::parse(text);
      const StageInputs record = read_stage(stored);
      RC_ASSERT(stage_key(stored) == stage.id);
      RC_ASSERT(record.seed == seed);
      RC_ASSERT(name_of(record.stage) == stage.kind && record.parent == stage.parent);
      const Stage again = prepare_stage(record.parameters, seed);
      RC_ASSERT(
          (record.stage == StageKind::prepare ? again : last_stage(record.parameters, seed, again))
              .id == stage.id);
    }
  }
}

PROPERTY(CanonicalJson, ShortestDigitsReadBackToTheSameDouble, 2000) {
  const auto number =
      std::bit_cast<double>(*rc::gen::resize(100, rc::gen::arbitrary<std::uint64_t>()));
  RC_PRE(std::isfinite(number));
  const std::string text = canonical_json(number);
  RC_ASSERT(std::strtod(text.c_str(), nullptr) == number);
  RC_ASSERT(text.size() <= fmt::format("{:.17g}", number).size());
}

}  // namespace
}  // namespace shearcell::test
