// SPDX-License-Identifier: GPL-3.0-or-later
// What no single value tells: whether the values of a variant can be simulated together.
#include <fmt/format.h>

#include <cmath>
#include <set>

#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/variants.hpp"

namespace shearcell {
namespace {

class VariantChecker {
 public:
  explicit VariantChecker(const Manifest& manifest) : manifest_(manifest) {}

  void check(const AtScale& scale) {
    for_each_variant(scale, [&](const Variant& variant) {
      const Parameters& p = variant.parameters;
      const auto where = [&](std::string_view key) { return find(scale, variant, key); };
      if (!engine_numbers_are_sound(p)) {
        report("mass_kg", where("mass_kg"),
               "the parameters are so far apart that their values in units of d, m and s leave the "
               "range of a double",
               "Check mass, diameter, stiffness, drag, gravity and pressure.");
        return;
      }
      check_shear_step(p, where);
      check_settle_step(p, where);
      check_pause(p, where);
      check_depth(p, where);
      if (asks_lammps_to_stiffen(p)) {
        report("engine", where("engine"), "LAMMPS cannot do the protocol stiffen",
               "Leave the engine out, or shear.");
      }
      if (p.fill_packing_fraction >= p.nominal_packing_fraction) {
        report("fill_packing_fraction", where("fill_packing_fraction"),
               "the grains are placed at random more densely than they are to settle",
               fmt::format("Choose it below nominal_packing_fraction ({}).",
                           p.nominal_packing_fraction));
      }
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
    if (found != scale.settings.end()) return {found->second.at, found->second.value.dump()};
    const nlohmann::json value = get_value(*find_field(key), variant.parameters);
    return {manifest_.base_at, fmt::format("the default {}", value.dump()), false};
  }

  static bool engine_numbers_are_sound(const Parameters& p) {
    const Scene scene = shear_scene(p);
    const double limit = stability_limit_s(p);
    return std::isfinite(scene.stiffness) && scene.stiffness > 0 &&
           std::isfinite(scene.drag_rate) && std::isfinite(scene.gravity) &&
           std::isfinite(scene.pressure) && scene.pressure > 0 && scene.time_step > 0 &&
           std::isfinite(limit) && limit > 0;
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
           enough <= field.max ? fmt::format("Use at least {:.0f} steps per cycle.", enough)
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
        fmt::format("Use less than {:.4g} s.", limit));
  }

  template <class Where>
  void check_pause(const Parameters& p, const Where& where) {
    if (p.protocol != ProtocolKind::paused || pause_time_steps(p) <= kMostPauseSteps) return;
    report("pause_s", where("pause_s"),
           fmt::format("the pause takes {:.3g} time steps", pause_time_steps(p)),
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
  VariantChecker checker(manifest);
  for (const Scale* scale : runnable_scales(manifest)) checker.check(at_scale(manifest, scale));
  for (ManifestProblem& problem : checker.take()) problems.push_back(std::move(problem));
  return problems;
}

}  // namespace shearcell
