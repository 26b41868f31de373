// SPDX-License-Identifier: GPL-3.0-or-later
// Checks whether the variants of a manifest can be simulated.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>

#include "core/drive.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/problems.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/variants.hpp"
#include "protocols/settle.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {
namespace {

using std::string;
using std::string_view;

bool is_wide_enough(const Parameters& p) {
  return cell_width(geometry(p)) >= kShallowestCell;
}

// Checks one variant at one scale. The scale is complete (whole_scale()).
struct VariantCheck {
  const Manifest& manifest;
  const Scale& scale;
  const Variant& variant;
  ProblemList& problems;
  const Parameters& p = variant.parameters;

  void run() {
    if (!autos_are_in_range()) return;
    check_shear_step();
    check_settle_steps();
    check_pause();
    check_cell();
    if (const string why = unfit_for_lammps(p, {}); !why.empty()) {
      report("engine", why, "Leave `engine` out, or use a protocol that shears.");
    }
    check_density();
    if (!scale.checkpoints->phases.empty()) check_phases();
  }

  struct Place {
    Position at;
    string got;
    bool stated = true;  // false: a default
  };

  Place find(string_view key) const {
    for (const auto& [name, setting] : variant.swept) {
      if (name == key) return {setting->at, setting->value.dump()};
    }
    const auto found = scale.settings.find(key);
    if (found != scale.settings.end()) {
      return {found->second.at, is_auto(found->second) ? "auto" : found->second.value.dump()};
    }
    const nlohmann::json value = get_value(*find_field(key), p);
    return {manifest.base.at, fmt::format("the default {}", value.dump()), false};
  }

  void report(string_view key, string problem, string remedy) {
    report(key, find(key), std::move(problem), std::move(remedy));
  }

  void report(string_view key, const Place& place, string problem, string remedy) {
    problems.add(place.at, string(key), std::move(problem), place.got, std::move(remedy));
  }

  // Whether the values that `auto` resolved to are in range.
  bool autos_are_in_range() {
    bool sound = true;
    for (const auto& [key, setting] : scale.settings) {
      if (!is_auto(setting)) continue;
      const Field& field = *find_field(key);
      const nlohmann::json value = get_value(field, p);
      if (!check_value(field, value)) continue;
      report(key, fmt::format("comes to {}, which is out of range", value_text(value)),
             fmt::format("State {}, or change stiffness_N_per_m, mass_kg or period_s.",
                         expected_values(field)));
      sound = false;
    }
    return sound;
  }

  /// Where a time step is stated; if it is a default, a key that decides the limit of stability.
  Place place_of_step(const char* key) {
    Place place = find(key);
    for (const string_view cause : {"period_s", "stiffness_N_per_m", "mass_kg"}) {
      if (cause == "period_s" && key != string_view("steps_per_cycle")) continue;
      if (const Place other = find(cause); !place.stated && other.stated) {
        place = {other.at, place.got};
      }
    }
    return place;
  }

  void check_shear_step() {
    if (p.protocol == ProtocolKind::stiffen) return;
    const double limit = stability_limit_s(p);
    if (shear_time_step_s(p) < limit) return;
    const double enough = std::floor(p.period_s / limit) + 1;
    report("steps_per_cycle", place_of_step("steps_per_cycle"),
           fmt::format("the time step period_s/steps_per_cycle = {:.4g} s is over the stability "
                       "limit 2/sqrt(8 k/m) = {:.4g} s",
                       shear_time_step_s(p), limit),
           find_field("steps_per_cycle")->range.contains(enough)
               ? fmt::format("Use at least {:.0f} steps per cycle, or `auto`.", enough)
               : "Lower period_s or stiffness_N_per_m.");
  }

  void check_settle_steps() {
    const double limit = stability_limit_s(p);
    if (p.settle_time_step_s >= limit) {
      report("settle_time_step_s", place_of_step("settle_time_step_s"),
             fmt::format("the time step {:.4g} s is over the stability limit 2/sqrt(8 k/m) = "
                         "{:.4g} s",
                         p.settle_time_step_s, limit),
             fmt::format("Use less than {:.4g} s, or `auto`.", limit));
    }
    const double seconds = std::max(p.settle_time_limit_s, kSettleCheckInterval);
    if (seconds / p.settle_time_step_s <= kMostSteps) return;
    report("settle_time_step_s",
           fmt::format("settling takes up to {:.3g} time steps, more than {:g}",
                       seconds / p.settle_time_step_s, kMostSteps),
           fmt::format("Use at least {:.3g} s, or lower settle_time_limit_s.",
                       1.001 * seconds / kMostSteps));
  }

  void check_pause() {
    const double steps = pause_time_steps(p);
    if (p.protocol != ProtocolKind::paused || steps <= kMostPauseSteps) return;
    constexpr std::array<string_view, 3> keys = {"pause_s", "period_s", "steps_per_cycle"};
    const auto* stated = std::ranges::find_if(keys, [&](auto key) { return find(key).stated; });
    report(stated == keys.end() ? keys[0] : *stated,
           fmt::format("the pause takes {:.3g} time steps", steps),
           fmt::format("Use a pause of at most {:g} steps of period_s/steps_per_cycle.",
                       kMostPauseSteps));
  }

  void check_cell() {
    const Geometry shape = geometry(p);
    if (!is_wide_enough(p)) {
      report("grains",
             fmt::format("the cell for so few grains is {:.3g} d wide and deep, less than {} d",
                         cell_width(shape), kShallowestCell),
             advise_more_grains(p, is_wide_enough));
    }
    if (!too_large(shape)) return;
    report(p.fill_packing_fraction < 0.1 * p.nominal_packing_fraction ? "fill_packing_fraction"
                                                                      : "nominal_packing_fraction",
           fmt::format("the cell for the loose grains is {:.3g} d wide and {:.3g} d high with "
                       "{:.2g} wall grains, too large for {} grains",
                       cell_width(shape), fill_height(shape), wall_grain_count(shape), p.grains),
           "Raise it.");
  }

  void check_density() {
    if (p.fill_packing_fraction < p.nominal_packing_fraction) return;
    const bool loose_stated = find("fill_packing_fraction").stated;
    report(loose_stated ? "fill_packing_fraction" : "nominal_packing_fraction",
           "the grains are placed at random more densely than they are to settle",
           loose_stated ? fmt::format("Choose it below nominal_packing_fraction ({}).",
                                      p.nominal_packing_fraction)
                        : fmt::format("Choose it above fill_packing_fraction ({}).",
                                      p.fill_packing_fraction));
  }

  void check_phases() {
    const auto refuse = [&](string problem, string remedy) {
      report("checkpoints.phases", {scale.checkpoints->at, ""}, std::move(problem),
             std::move(remedy));
    };
    const Drive motion = drive(p);
    const std::vector<double>& phases = scale.checkpoints->phases;
    if (p.protocol == ProtocolKind::stiffen) {
      refuse("protocol stiffen has no phases of a cycle", "Leave them out.");
    } else if (string why = unfit_for_lammps(p, *scale.checkpoints); !why.empty()) {
      refuse(std::move(why), "Leave them out, or the engine.");
    } else if (steps_at(phases, motion).size() != phases.size()) {
      refuse(fmt::format("two of them are one step, or the end of the cycle, with {} steps in a "
                         "cycle",
                         cycle_steps(motion)),
             "Use fewer of them, or more steps_per_cycle.");
    }
  }
};

void check_scale_against_sweep(const Scale& scale, const Sweep& sweep, ProblemList& problems) {
  for (const auto& [key, setting] : scale.settings) {
    if (find_axis(sweep, key) == nullptr) continue;
    problems.add(setting.at, fmt::format("scales.{}.{}", scale.name, key),
                 "has no effect, since the sweep sets this key", setting.value.dump(),
                 "Give the scale a sweep of its own instead.");
  }
}

/// Each label must name a variant of some scale and show something; names of variants of one scale
/// must look different.
void check_labels(const Manifest& manifest, const std::vector<Scale>& scales,
                  ProblemList& problems) {
  for (const VariantLabel& label : manifest.labels) {
    if (!as_seen(label.name).empty()) continue;
    problems.add(label.at, "labels", "gives a variant a name with nothing to see",
                 fmt::format("\"{}\"", printable(label.name)), "Write a name.");
  }
  std::set<const VariantLabel*> used;
  for (const Scale& scale : scales) {
    std::vector<nlohmann::json> variants;
    for (const Variant& variant : variants_of(scale)) variants.push_back(variant.swept_values());
    const auto names = variant_names(variants, manifest.labels);
    struct Named {
      string name;
      const VariantLabel* label;  // null: none
    };
    std::map<string, Named> named;  // by what a reader sees
    for (const nlohmann::json& variant : variants) {
      const string& name = names.at(variant);
      const VariantLabel* chosen = nullptr;
      for (const VariantLabel& label : manifest.labels) {
        if (!selects(label, variant)) continue;
        used.insert(&label);
        chosen = &label;
      }
      const auto [earlier, first] = named.try_emplace(as_seen(name), Named{name, chosen});
      const auto& [other, label_of_other] = earlier->second;
      const VariantLabel* label = chosen != nullptr ? chosen : label_of_other;
      if (first || label == nullptr) continue;
      string problem = fmt::format("gives two variants the same name, '{}'", printable(name));
      if (other != name) {
        problem = fmt::format("gives two variants names that look the same, '{}' and '{}'",
                              printable(other), printable(name));
      }
      return problems.add(label->at, "labels", problem, printable(label->name),
                          "Give each its own.");
    }
  }
  for (const VariantLabel& label : manifest.labels) {
    if (used.contains(&label)) continue;
    problems.add(label.at, "labels", "names no variant of any scale", words_of(label.where),
                 "A label states swept keys and one of their values, as `\"fluid=still\"`.");
  }
}

}  // namespace

string without_effect(string_view key, const Parameters& p) {
  const Field* field = find_field(key);
  const Identity identity = field == nullptr ? Identity{} : field->identity;
  if (p.protocol == ProtocolKind::stiffen) {
    const bool of_shear =
        identity.stage == Stage::shear || key == "cycles" || key == "until" || key == "checkpoints";
    if (of_shear && key != "protocol") return "has no effect under protocol stiffen";
  } else if (identity.stage == Stage::stiffen || key == "stiffness_decades") {
    return "has an effect only under protocol stiffen";
  }
  if (identity.under && identity.under != p.protocol)
    return fmt::format("has an effect only under protocol {}", name_of(*identity.under));
  if (key.starts_with("wall_grain_") && p.walls == WallTexture::smooth) {
    return "has an effect only with rough walls";
  }
  if (key == "pressure_at" && !depends_on_pressure_at(p)) {
    return "has an effect only with gravity and a moving bottom wall";
  }
  return "";
}

string unfit_for_lammps(const Parameters& p, const Checkpoints& checkpoints) {
  if (p.engine != EngineKind::lammps) return "";
  if (p.protocol == ProtocolKind::stiffen) return "LAMMPS cannot do the protocol stiffen";
  return checkpoints.phases.empty() ? "" : "LAMMPS makes no checkpoints within a cycle";
}

string advise_more_grains(Parameters p, bool (*enough)(const Parameters&)) {
  const auto fits = [&](std::uint64_t grains) {
    p.grains = grains;
    return enough(p);
  };
  const auto& range = find_field("grains")->range;
  std::uint64_t few = p.grains, many = 2 * few;
  for (; !fits(many) && range.contains(static_cast<double>(many)); many *= 2) few = many;
  while (many - few > 1) {
    const std::uint64_t middle = few + (many - few) / 2;
    (fits(middle) ? many : few) = middle;
  }
  return range.contains(static_cast<double>(many)) ? fmt::format("Use at least {} grains.", many)
                                                   : "Use more grains.";
}

void check_variants(const Manifest& manifest) {
  const std::vector<Scale> scales = whole_scales(manifest);
  ProblemList problems(manifest.file);
  for (std::size_t s = 0; s < manifest.scales.size(); ++s) {
    check_scale_against_sweep(manifest.scales[s], *scales[s].sweep, problems);
  }
  std::uint64_t runs = 0;
  for (const Scale& scale : scales) {
    const std::uint64_t variants = variant_count(*scale.sweep);
    const std::uint64_t seeds = scale.seeds->values.size();
    if (variants > ManifestLimits::runs || variants * seeds > ManifestLimits::runs - runs) {
      problems.add(scale.at, scale.name.empty() ? "sweep" : "scales." + scale.name,
                   fmt::format("the manifest expands to more than {} runs", ManifestLimits::runs),
                   "", "Sweep fewer values or use fewer seeds.");
      problems.raise();
    }
    runs += variants * seeds;
  }
  if (!manifest.labels.empty()) check_labels(manifest, scales, problems);
  for (const Scale& scale : scales) {
    for (const Variant& variant : variants_of(scale)) {
      VariantCheck{manifest, scale, variant, problems}.run();
    }
  }
  problems.raise();
}

}  // namespace shearcell
