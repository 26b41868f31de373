// SPDX-License-Identifier: GPL-3.0-or-later
// Checks whether the values of a variant can be simulated together.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <span>

#include "core/drive.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/names.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/variants.hpp"
#include "protocols/settle.hpp"

namespace shearcell {
namespace {

class VariantChecker {
 public:
  explicit VariantChecker(const Manifest& manifest) : manifest_(manifest) {}

  void check(const AtScale& scale) {
    for_each_variant(scale, [&](const Variant& variant) {
      const Parameters& p = variant.parameters;
      const auto where = [&](std::string_view key) { return find(scale, variant, key); };
      if (!check_engine_numbers(p, where)) return;
      if (!check_auto(scale, p, where)) return;
      check_shear_step(p, where);
      check_settle_step(p, where);
      check_settle_steps(p, where);
      check_pause(p, where);
      check_depth(p, where);
      check_size(p, where);
      if (asks_lammps_to_stiffen(p)) {
        report("engine", where("engine"), "LAMMPS cannot do the protocol stiffen",
               "Leave the engine out, or shear.");
      }
      check_density(p, where);
      check_phases(scale.checkpoints, p);
    });
  }

  std::vector<ManifestProblem> take() { return std::move(problems_); }

 private:
  struct Place {
    Position at;
    std::string got;
    bool stated = true;  // rather than a default
  };

  Place find(const AtScale& scale, const Variant& variant, std::string_view key) const {
    for (const auto& [name, setting] : variant.swept) {
      if (name == key) return {setting->at, setting->value.dump()};
    }
    const auto found = scale.settings.find(key);
    if (found != scale.settings.end()) {
      return {found->second.at, is_auto(found->second) ? "auto" : found->second.value.dump()};
    }
    const nlohmann::json value = get_value(*find_field(key), variant.parameters);
    return {manifest_.base_at, fmt::format("the default {}", value.dump()), false};
  }

  // Of these keys the one whose value is farthest from its default.
  static std::string_view farthest(const Parameters& p, std::span<const std::string_view> keys) {
    const auto distance = [&p](std::string_view key) {
      const Field& field = *find_field(key);
      return std::fabs(std::log(get_value(field, p).get<double>() /
                                get_value(field, Parameters{}).get<double>()));
    };
    return *std::ranges::max_element(keys, {}, distance);
  }

  template <class Where>
  bool check_engine_numbers(const Parameters& p, const Where& where) {
    const Scene scene = shear_scene(p);
    struct Number {
      double value;
      bool may_be_zero;
      std::vector<std::string_view> keys;  // that it is made from
    };
    const std::vector<std::string_view> spring = {"mass_kg", "stiffness_N_per_m"};
    const std::vector<std::string_view> pressure = {"pressure_Pa", "diameter_m", "mass_kg"};
    for (const Number& number :
         {Number{scene.stiffness, false, spring}, Number{stability_limit_s(p), false, spring},
          Number{scene.drag_rate, true, {"drag_kg_per_s", "mass_kg"}},
          Number{scene.gravity, true, {"gravity_m_per_s2", "diameter_m"}},
          Number{scene.pressure, false, pressure},
          Number{scene.pressure / scene.stiffness,
                 true,
                 {"pressure_Pa", "diameter_m", "stiffness_N_per_m"}},
          Number{scene.time_step, false, {"period_s", "steps_per_cycle"}}}) {
      if (std::isfinite(number.value) && (number.value > 0 || number.may_be_zero)) continue;
      const std::string_view key = farthest(p, number.keys);
      report(std::string(key), where(key),
             "the parameters are so far apart that their values in units of d, m and s leave the "
             "range of a double",
             fmt::format("Check {}.", fmt::join(number.keys, ", ")));
      return false;
    }
    return true;
  }

  // Whether what `auto` came to may be used.
  template <class Where>
  bool check_auto(const AtScale& scale, const Parameters& p, const Where& where) {
    bool sound = true;
    for (const auto& [key, setting] : scale.settings) {
      if (!is_auto(setting)) continue;
      const Field& field = *find_field(key);
      const nlohmann::json value = get_value(field, p);
      if (!check_value(field, value)) continue;
      report(key, where(key), fmt::format("comes to {}, which is out of range", value_text(value)),
             fmt::format("State {}, or change stiffness_N_per_m, mass_kg or period_s.",
                         expected_values(field)));
      sound = false;
    }
    return sound;
  }

  template <class Where>
  void check_shear_step(const Parameters& p, const Where& where) {
    const double limit = stability_limit_s(p);
    if (shear_time_step_s(p) < limit) return;
    const double enough = std::floor(p.period_s / limit) + 1;
    const Field& field = *find_field("steps_per_cycle");
    Place place = where("steps_per_cycle");
    // Left at its default, it was made wrong by one of these.
    for (const char* cause : {"period_s", "stiffness_N_per_m", "mass_kg"}) {
      if (place.stated) break;
      const Place other = where(cause);
      if (other.stated) place = {other.at, place.got, true};
    }
    report("steps_per_cycle", place,
           fmt::format("the time step period_s/steps_per_cycle = {:.4g} s is over the stability "
                       "limit 2/sqrt(8 k/m) = {:.4g} s",
                       shear_time_step_s(p), limit),
           enough <= field.max
               ? fmt::format("Use at least {:.0f} steps per cycle, or `auto`.", enough)
               : "Lower period_s or stiffness_N_per_m.");
  }

  template <class Where>
  void check_settle_step(const Parameters& p, const Where& where) {
    const double limit = stability_limit_s(p);
    if (p.settle_time_step_s < limit) return;
    report(
        "settle_time_step_s", where("settle_time_step_s"),
        fmt::format("the time step {:.4g} s is over the stability limit 2/sqrt(8 k/m) = {:.4g} s",
                    p.settle_time_step_s, limit),
        fmt::format("Use less than {:.4g} s, or `auto`.", limit));
  }

  template <class Where>
  void check_settle_steps(const Parameters& p, const Where& where) {
    const double seconds = std::max(p.settle_time_limit_s, kLookInterval);
    if (seconds / p.settle_time_step_s <= kMostSteps) return;
    report("settle_time_step_s", where("settle_time_step_s"),
           fmt::format("settling takes up to {:.3g} time steps, more than {:g}",
                       seconds / p.settle_time_step_s, kMostSteps),
           fmt::format("Use at least {:.3g} s, or lower settle_time_limit_s.",
                       1.001 * seconds / kMostSteps));
  }

  template <class Where>
  void check_density(const Parameters& p, const Where& where) {
    if (p.fill_packing_fraction < p.nominal_packing_fraction) return;
    const Place fill = where("fill_packing_fraction");
    const char* problem = "the grains are placed at random more densely than they are to settle";
    if (fill.stated) {
      report("fill_packing_fraction", fill, problem,
             fmt::format("Choose it below nominal_packing_fraction ({}).",
                         p.nominal_packing_fraction));
    } else {
      report("nominal_packing_fraction", where("nominal_packing_fraction"), problem,
             fmt::format("Choose it above fill_packing_fraction ({}).", p.fill_packing_fraction));
    }
  }

  void check_phases(const Checkpoints& checkpoints, const Parameters& p) {
    if (checkpoints.phases.empty()) return;
    const auto refuse = [&](std::string problem, std::string remedy) {
      report("checkpoints.phases", {checkpoints.at, ""}, std::move(problem), std::move(remedy));
    };
    const Drive motion = drive(p);
    if (p.protocol == ProtocolKind::stiffen) {
      refuse("protocol stiffen has no phases of a cycle", "Leave them out.");
    } else if (p.engine == EngineKind::lammps) {
      refuse("LAMMPS makes no checkpoints within a cycle", "Leave them out, or the engine.");
    } else if (steps_at(checkpoints.phases, motion).size() != checkpoints.phases.size()) {
      refuse(fmt::format("two of them are one step, or the end of the cycle, with {} steps in a "
                         "cycle",
                         cycle_steps(motion)),
             "Use fewer of them, or more steps_per_cycle.");
    }
  }

  template <class Where>
  void check_size(const Parameters& p, const Where& where) {
    const Geometry shape = geometry(p);
    if (!too_large(shape)) return;
    const char* key = p.fill_packing_fraction < 0.1 * p.nominal_packing_fraction
                          ? "fill_packing_fraction"
                          : "nominal_packing_fraction";
    report(
        key, where(key),
        fmt::format("the cell for the loose grains is {:.3g} d wide and {:.3g} d high with {:.2g} "
                    "wall grains, too large for {} grains",
                    cell_width(shape), fill_height(shape), wall_grain_count(shape), p.grains),
        "Raise it.");
  }

  template <class Where>
  void check_pause(const Parameters& p, const Where& where) {
    const double steps = pause_time_steps(p);
    if (p.protocol != ProtocolKind::paused || steps <= kMostPauseSteps) return;
    constexpr std::array<std::string_view, 3> keys = {"pause_s", "period_s", "steps_per_cycle"};
    const std::string_view key = farthest(p, keys);
    report(std::string(key), where(key),
           fmt::format("the pause takes {:.3g} time steps",
                       std::min(steps, std::numeric_limits<double>::max())),
           fmt::format("Use a pause of at most {:g} steps of period_s/steps_per_cycle.",
                       kMostPauseSteps));
  }

  template <class Where>
  void check_depth(const Parameters& p, const Where& where) {
    // Below, a grain could meet another one through both ends of the period.
    constexpr double smallest_depth = 3;
    const double depth = cell_width(geometry(p));
    if (depth >= smallest_depth) return;
    report("grains", where("grains"),
           fmt::format("the cell for so few grains is {:.3g} d wide and deep, less than {} d",
                       depth, smallest_depth),
           "Use more grains.");
  }

  void report(std::string key, Place place, std::string problem, std::string remedy) {
    ManifestProblem entry{manifest_.file,     place.at,  std::move(key),
                          std::move(problem), place.got, std::move(remedy)};
    // Many variants share one cause.
    if (seen_.insert(entry.text()).second) problems_.push_back(std::move(entry));
  }

  const Manifest& manifest_;
  std::vector<ManifestProblem> problems_;
  std::set<std::string> seen_;
};

std::vector<const Scale*> runnable_scales(const Manifest& manifest) {
  if (manifest.scales.empty()) return {nullptr};
  std::vector<const Scale*> scales;
  for (const Scale& scale : manifest.scales) scales.push_back(&scale);
  return scales;
}

void check_scale_against_sweep(const Manifest& manifest, const Scale& scale,
                               std::vector<ManifestProblem>& problems) {
  const Sweep& sweep = scale.sweep ? *scale.sweep : manifest.sweep;
  for (const auto* axes : {&sweep.grid, &sweep.zip}) {
    for (const SweepAxis& axis : *axes) {
      const auto overridden = scale.settings.find(axis.key);
      if (overridden == scale.settings.end()) continue;
      problems.push_back(
          {manifest.file, overridden->second.at, fmt::format("scales.{}.{}", scale.name, axis.key),
           "has no effect, since the sweep sets this key", overridden->second.value.dump(),
           "Give the scale a sweep of its own instead."});
    }
  }
}

/// Every label names a variant of some scale, and no two variants of a scale have one name.
void check_labels(const Manifest& manifest, std::vector<ManifestProblem>& problems) {
  std::set<const VariantLabel*> used;
  const auto report = [&](const VariantLabel& label, std::string problem, std::string remedy) {
    problems.push_back(
        {manifest.file, label.at, "labels", std::move(problem), label.name, std::move(remedy)});
  };
  for (const Scale* scale : runnable_scales(manifest)) {
    std::vector<nlohmann::json> variants;
    for_each_variant(at_scale(manifest, scale),
                     [&](const Variant& variant) { variants.push_back(variant.labels()); });
    const std::vector<std::string> names = variant_names(variants, manifest.labels);
    std::set<std::string> seen;
    for (std::size_t k = 0; k < variants.size(); ++k) {
      const bool repeated = !seen.insert(names[k]).second;
      for (const VariantLabel& label : manifest.labels) {
        if (!selects(label, variants[k])) continue;
        used.insert(&label);
        if (!repeated) continue;
        report(label, "gives two variants the same name, " + names[k], "Give each its own.");
        return;
      }
    }
  }
  for (const VariantLabel& label : manifest.labels) {
    if (used.contains(&label)) continue;
    report(label, "names no variant of any scale",
           "A label states swept keys and one of their values, as `\"fluid=still\"`.");
  }
}

}  // namespace

std::string without_effect(const Field& field, const Parameters& p) {
  const Identity& identity = field.identity;
  const bool stiffens = last_stage(p.protocol) == Stage::stiffen;
  if (stiffens && (identity.stage == Stage::shear || field.name == "cycles") &&
      field.name != "protocol") {
    return "not under protocol stiffen";
  }
  if (!stiffens && (identity.stage == Stage::stiffen || field.name == "stiffness_decades")) {
    return "only under protocol stiffen";
  }
  if (identity.under && identity.under != p.protocol)
    return fmt::format("only under protocol {}", name_of(*identity.under));
  if (field.name.starts_with("wall_grain_") && p.walls == WallTexture::smooth) {
    return "only with rough walls";
  }
  if (field.name == "pressure_at" && !feels_pressure_at(p)) {
    return "only with gravity and a moving bottom wall";
  }
  return "";
}

std::vector<ManifestProblem> check_variants(const Manifest& manifest) {
  std::vector<ManifestProblem> problems;
  std::uint64_t runs = 0;
  for (const Scale* scale : runnable_scales(manifest)) {
    if (scale != nullptr) check_scale_against_sweep(manifest, *scale, problems);
    const AtScale resolved = at_scale(manifest, scale);
    const std::uint64_t variants = variant_count(*resolved.sweep);
    const std::uint64_t seeds = resolved.seeds->values.size();
    if (variants > ManifestLimits::runs || variants * seeds > ManifestLimits::runs - runs) {
      problems.push_back(
          {manifest.file, scale == nullptr ? manifest.base_at : scale->at,
           scale == nullptr ? "sweep" : fmt::format("scales.{}", scale->name),
           fmt::format("the manifest expands to more than {} runs", ManifestLimits::runs), "",
           "Sweep fewer values or use fewer seeds."});
      return problems;
    }
    runs += variants * seeds;
  }
  if (!manifest.labels.empty()) check_labels(manifest, problems);
  VariantChecker checker(manifest);
  for (const Scale* scale : runnable_scales(manifest)) checker.check(at_scale(manifest, scale));
  for (ManifestProblem& problem : checker.take()) problems.push_back(std::move(problem));
  return problems;
}

}  // namespace shearcell
