// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <ranges>
#include <set>
#include <tuple>
#include <utility>

#include "analysis/claims.hpp"
#include "analysis/estimators.hpp"
#include "analysis/expression.hpp"
#include "analysis/figure.hpp"
#include "analysis/plots.hpp"
#include "analysis/statistics.hpp"
#include "core/drive.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/document.hpp"
#include "experiments/manifest/expand.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/shipped.hpp"
#include "experiments/manifest/suggest.hpp"
#include "protocols/settle.hpp"
#include "provenance/json_text.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

using fmt::format;
using nlohmann::json;
using std::string;
using std::string_view;

struct VariantCheck {
  const Manifest& manifest;
  const Scale& scale;
  const Variant& variant;
  ProblemList& problems;
  const Parameters& p = variant.parameters;

  void run() {
    if (!autos_are_in_range()) return;
    check_time_steps();
    check_cell();
    check_start();
    const string why = unfit_for_lammps(p, scale.checkpoints);
    report_if(!why.empty(), {"engine"}, why,
              "Remove `engine`, or change the key that LAMMPS does not support.");
    if (!scale.checkpoints.phases.empty()) check_phases();
  }

  // The value that the manifest gives for `key` (a parameter or "settle.PARAMETER"), or null.
  const Setting* find(string_view key) const {
    if (constexpr string_view of_packing = "settle."; key.starts_with(of_packing)) {
      const auto found = scale.settle.find(key.substr(of_packing.size()));
      return found == scale.settle.end() ? nullptr : &found->second;
    }
    if (const SweepAxis* axis = find_axis(scale.sweep, key); axis != nullptr && !is_length(key)) {
      return &*std::ranges::find(axis->values, variant.swept.at(axis->key), &Setting::value);
    }
    for (const Settings* settings : {&scale.settings, &scale.start.settings}) {
      const auto found = settings->find(key);
      if (found != settings->end()) return &found->second;
    }
    return nullptr;
  }

  // If `wrong`, reports a problem with the value of the first key in `keys`. The message gives the
  // line of this key or, if the manifest does not set it, of the next key that the manifest sets.
  void report_if(bool wrong, std::initializer_list<string_view> keys, const string& problem,
                 const string& remedy) {
    if (!wrong) return;
    const string_view key = *keys.begin();
    const Setting* stated = find(key);
    const json value = stated != nullptr ? stated->value : find_field(key)->get(p);
    Position at = manifest.base.at;
    for (const string_view cause : keys | std::views::reverse) {
      if (const Setting* found = find(cause)) at = found->at;
    }
    problems.add(at, string(key), problem,
                 (stated != nullptr ? "" : "the default ") + value_text(value), remedy);
  }

  void refuse_if(bool wrong, const Position& at, const char* key, const string& problem,
                 const string& remedy) {
    if (wrong) problems.add(at, key, problem, "", remedy);
  }

  // Reports each number computed for `auto` that is out of range. Returns true if all are in range.
  bool autos_are_in_range() {
    bool sound = true;
    for (const auto& [key, setting] : scale.settings) {
      if (setting.value != "auto") continue;
      const Field& field = *find_field(key);
      const json value = field.get(p);
      const bool in_range = !check_value(field, value);
      report_if(!in_range, {key}, format("results in {}, which is out of range", value_text(value)),
                format("Write {}, or change stiffness_N_per_m, mass_kg or period_s.",
                       expected_values(field)));
      sound = sound && in_range;
    }
    return sound;
  }

  void check_time_steps() {
    const double limit = stability_limit_s(p), settle_limit = stability_limit_s(variant.packing);
    const double step = shear_time_step_s(p), settle_step = variant.packing.settle_time_step_s;
    const auto over = [](double of) {
      return format("is over the stability limit 2/sqrt(8 k/m) = {:.4g} s", of);
    };
    report_if(p.protocol != ProtocolKind::stiffen && step >= limit,
              {"steps_per_cycle", "period_s", "stiffness_N_per_m", "mass_kg"},
              format("the time step period_s/steps_per_cycle = {:.4g} s {}", step, over(limit)),
              format("Use at least {:.0f} steps per cycle, or `auto`.",
                     std::floor(p.period_s / limit) + 1));
    report_if(settle_step >= settle_limit,
              {"settle_time_step_s", "settle.stiffness_N_per_m", "stiffness_N_per_m", "mass_kg"},
              format("the time step {:.4g} s {}", settle_step, over(settle_limit)),
              format("Use less than {:.4g} s, or `auto`.", settle_limit));
    const double steps = std::max(p.settle_time_limit_s, kSettleCheckInterval) / settle_step;
    report_if(steps > kMostSteps, {"settle_time_step_s"},
              format("settling may need {:.3g} time steps, but at most {:g} are allowed", steps,
                     kMostSteps),
              "Raise this value, or lower settle_time_limit_s.");
    const double pause = pause_time_steps(p);
    report_if(
        p.protocol == ProtocolKind::paused && pause > kMostPauseSteps,
        {"pause_s", "period_s", "steps_per_cycle"},
        format("the pause takes {:.3g} time steps", pause),
        format("Use a pause of at most {:g} time steps. A time step is period_s/steps_per_cycle.",
               kMostPauseSteps));
  }

  void check_cell() {
    const Geometry shape = geometry(p);
    report_if(
        cell_width(shape) < kShallowestCell, {"grains"},
        format("with this number of grains the cell is {:.3g} d wide and deep, less than {} d",
               cell_width(shape), kShallowestCell),
        "Use more grains.");
    report_if(too_large(shape), {"fill_packing_fraction", "nominal_packing_fraction"},
              format("the cell for the loose grains would be too large: {:.3g} d wide and {:.3g} d "
                     "high, with {:.2g} wall grains for {} grains",
                     cell_width(shape), fill_height(shape), wall_grain_count(shape), p.grains),
              "Raise this value, or nominal_packing_fraction.");
    report_if(
        p.fill_packing_fraction >= p.nominal_packing_fraction,
        {"fill_packing_fraction", "nominal_packing_fraction"},
        "the random initial packing must be looser than the settled packing",
        format("Choose a value below nominal_packing_fraction ({}).", p.nominal_packing_fraction));
  }

  void check_start() {
    const Start& start = scale.start;
    if (!start.is_recorded()) {
      for (const char* key : {"start_seed", "start_cycle", "start_noise_d"}) {
        const Field& field = *find_field(key);
        report_if(field.get(p) != field.get({}), {key}, "has no effect without `start`",
                  "Add `start: {experiment: NAME}`, or remove this key.");
      }
      return;
    }
    refuse_if(p.protocol == ProtocolKind::stiffen, start.at, "start",
              "cannot be used with protocol stiffen", "Use protocol continuous or paused.");
    refuse_if(start.run.empty() && find("start_seed") == nullptr, start.at, "start", "lacks seed",
              "Give the seed of the recorded run: `seed: 3`.");
    refuse_if(scale.settle_at.line > 0, scale.settle_at, "settle",
              "has no effect with `start`, because nothing settles", "Leave it out.");
  }

  void check_phases() {
    const Drive motion = drive(p);
    const auto& [every, phases, at] = scale.checkpoints;
    const bool has_cycles = p.protocol != ProtocolKind::stiffen;
    refuse_if(!has_cycles, at, "checkpoints.phases", "protocol stiffen has no cycles",
              "Remove this key.");
    refuse_if(has_cycles && steps_at(phases, motion).size() != phases.size(), at,
              "checkpoints.phases",
              format("two phases fall on one time step, or a phase falls on the end of the cycle, "
                     "because a cycle has only {} time steps",
                     cycle_steps(motion)),
              "Use fewer phases, or more steps_per_cycle.");
  }
};

/// Whether spreadsheet programs would read the text as a formula: it begins with =, +, - or @. With
/// East Asian settings, the full-width forms of these four characters also begin a formula.
bool is_formula(string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  constexpr string_view begins[] = {"=", "+", "-", "@", "＝", "＋", "－", "＠"};
  return std::ranges::any_of(begins, [&](string_view one) { return text.starts_with(one); });
}

/// Checks that each label and statement has visible characters and is not a formula (is_formula()),
/// that each label belongs to a variant of at least one scale, and that no two variants of one
/// scale have the same name.
void check_texts(const Manifest& manifest, const std::vector<Scale>& scales,
                 ProblemList& problems) {
  const auto check = [&](Position at, const char* key, const string& text) {
    if (!as_seen(text).empty() && !is_formula(text)) return;
    problems.add(at, key,
                 "has no visible characters, or would be read as a formula by spreadsheet programs",
                 format("\"{}\"", printable(text)), "Begin it with a letter or a digit.");
  };
  for (const VariantLabel& label : manifest.labels) check(label.at, "labels", label.name);
  for (const Placed<ClaimSpec>& claim : manifest.claims) {
    if (!claim.statement.empty()) check(claim.at, "claims.statement", claim.statement);
  }
  std::set<Position> used;
  for (const Scale& scale : scales) {
    const std::vector<json> variants = swept_in(variants_of(scale));
    const auto names = variant_names(variants, manifest.labels);
    std::map<string, json> named;  // variants by as_seen(name)
    for (const json& variant : variants) {
      const string& name = names.at(variant);
      const auto [earlier, first] = named.try_emplace(as_seen(name), variant);
      for (const VariantLabel& label : manifest.labels) {
        const bool fits = selects(label, variant);
        if (fits) used.insert(label.at);
        if (first || !(fits || selects(label, earlier->second))) continue;
        problems.add(label.at, "labels", "gives two variants the same name", printable(name),
                     "Give each variant a different name.");
      }
    }
  }
  for (const VariantLabel& label : manifest.labels) {
    if (used.contains(label.at)) continue;
    problems.add(label.at, "labels", "matches no variant of any scale", words_of(label.where),
                 "Write swept keys, each with one of its values, such as `\"fluid=still\"`.");
  }
}

/// Why the key (a parameter, `until` or `checkpoints`) has no effect if the parameters are `p`; ""
/// if the key has an effect. Example: "has an effect only under protocol paused".
string without_effect(string_view key, const Parameters& p) {
  const Field* field = find_field(key);
  const Identity identity = field == nullptr ? Identity{} : field->identity;
  if (p.protocol == ProtocolKind::stiffen) {
    const bool of_shear = identity.stage == StageKind::shear || key == "cycles" || key == "until" ||
                          key == "checkpoints";
    if (of_shear && key != "protocol") return "has no effect under protocol stiffen";
  } else if (identity.stage == StageKind::stiffen || key == "stiffness_decades") {
    return "has an effect only under protocol stiffen";
  }
  if (identity.under && identity.under != p.protocol) {
    return format("has an effect only under protocol {}", name_of(*identity.under));
  }
  if (key.starts_with("wall_grain_") && p.walls == WallTexture::smooth) {
    return "has an effect only with rough walls";
  }
  if (key == "pressure_at" && !depends_on_pressure_at(p)) {
    return "has an effect only with gravity and a moving bottom wall";
  }
  return "";
}

void warn_of_ineffective(const Manifest& manifest, const Scale& scale,
                         std::span<const Variant> variants, std::vector<string>& warnings) {
  std::map<string, Position> stated;
  for (const auto& [key, setting] : scale.settings) stated[key] = setting.at;
  for (const auto* axes : {&scale.sweep.grid, &scale.sweep.zip}) {
    for (const SweepAxis& axis : *axes) stated[axis.key] = axis.at;
  }
  if (scale.until.until) stated["until"] = scale.until.at;
  if (scale.checkpoints.every_cycles != 1) stated["checkpoints"] = scale.checkpoints.at;
  for (const auto& [key, at] : stated) {
    string why;
    for (const Variant& variant : variants) {
      why = without_effect(key, variant.parameters);
      if (why.empty()) break;
    }
    if (why.empty()) continue;
    warnings.push_back(problem_text(manifest.file, at, key, why, "", "Leave it out."));
  }
}

// Warnings about parameter values that are probably wrong. `settles`: whether the packing settles.
std::vector<string> advice_on(const Variant& variant, bool settles) {
  const Parameters &p = variant.parameters, &packing = variant.packing;
  std::vector<string> advice;
  const auto advise_if = [&](bool wrong, const string& text) {
    if (wrong) advice.push_back(text);
  };
  // Density of a grain [kg/m^3]. All known solids are within the limits of the next line.
  const double density = 6 / std::numbers::pi * p.mass_kg / std::pow(p.diameter_m, 3);
  advise_if(density < 0.1 || density > 1e5,
            format("grains of {:g} m and {:g} kg have a density of {:.2g} kg/m^3. Check the units "
                   "of diameter_m [m] and mass_kg [kg].",
                   p.diameter_m, p.mass_kg, density));
  advise_if(!pressure_lifts_column(p),
            format("at the pressure of {} Pa, the moving bottom wall cannot lift the grains (N = "
                   "{}). Use `pressure_at: top` or `moving_wall: top`, raise pressure_Pa, turn "
                   "gravity off, or lower height_over_width.",
                   p.pressure_Pa, p.grains));
  advise_if(!has_interior(p), format("the cell of {} grains is too small to have interior grains, "
                                     "which are at least 1.5 d from the walls. So phi and other "
                                     "measures of interior grains have no value. Use more grains.",
                                     p.grains));
  const double overlap = expected_overlap(p);
  advise_if(
      overlap > p.max_overlap_diameters,
      format("grains will overlap by {:.2g} d on average, and a run stops if an overlap exceeds "
             "max_overlap_diameters ({:g}). Raise stiffness_N_per_m, or lower pressure_Pa.",
             overlap, p.max_overlap_diameters));
  for (const auto& [seconds, what] :
       {std::pair(damping_time_s(packing), "the grains come to rest"),
        {pressing_time_s(packing), "the moving wall presses the grains together"}}) {
    advise_if(
        settles && seconds > p.settle_time_limit_s,
        format("with drag_kg_per_s {:g} and wall_drag_grains_per_d2_s {:g} {} {}, so settling "
               "fails at settle_time_limit_s ({:g} s). Change the drag, pressure_Pa or the limit.",
               packing.drag_kg_per_s, packing.wall_drag_grains_per_d2_s, what,
               seconds < 1e6 ? format("only after about {:.2g} s", seconds) : "too late",
               p.settle_time_limit_s));
  }
  for (const auto& [step, key, is_used] :
       {std::tuple(time_step(p, shear_time_step_s(p)), "steps_per_cycle",
                   p.protocol != ProtocolKind::stiffen),
        {time_step(packing, packing.settle_time_step_s), "settle_time_step_s", settles}}) {
    if (const auto one = time_step_advice(step, key); one && is_used) advice.push_back(*one);
  }
  return advice;
}

// Adds each warning about parameter values once, with the variants that the warning concerns.
void warn_of_parameters(const Manifest& manifest, const Scale& scale,
                        std::span<const Variant> variants, std::size_t seeds,
                        std::vector<string>& warnings) {
  const Start& start = scale.start;
  const bool settles = !start.is_recorded() && (start.file.empty() || scale.settle_at.line > 0);
  nlohmann::ordered_map<string, std::vector<string>> advice;  // variants by warning
  for (const Variant& variant : variants) {
    for (const string& one : advice_on(variant, settles)) advice[one].push_back(variant.name);
  }
  const auto draws = [&](const Variant& variant) {  // whether the run depends on the seed
    return start.is_recorded()
               ? variant.parameters.start_noise_d > 0
               : start.file.empty() || variant.parameters.walls == WallTexture::rough;
  };
  if (seeds > 1 && std::ranges::none_of(variants, draws)) {
    warnings.push_back(format(
        "{}:{}:{}: start: all {} seeds give the same run. Write {}`seeds: 1`.", manifest.file,
        start.at.line, start.at.column, seeds, start.is_recorded() ? "`noise_d`, or " : ""));
  }
  for (const auto& [one, of] : advice) {
    const bool swept = !variants.front().swept.empty();
    warnings.push_back(format(
        "{}: {}{}", manifest.file,
        swept ? format("variant{} {}: ", of.size() == 1 ? "" : "s", some_of(of, 8)) : "", one));
  }
}

/// A scale, and one planned run of each of its variants.
struct ScaleRuns {
  const Scale& scale;
  std::size_t seeds;
  std::vector<FrameRun> runs = {};
};

/// Whether the run will have a checkpoint at one of the cycles that `wanted` selects (null: any),
/// and another checkpoint `back` cycles earlier.
bool has_checkpoint(const FrameRun& run, const std::array<std::uint64_t, 2>& cycles,
                    std::uint64_t back, const json& wanted) {
  const std::uint64_t every = run.ask.checkpoint_every, last = run.ask.target_cycles;
  const auto has = [&](std::uint64_t cycle) { return cycle % every == 0 || cycle == last; };
  for (std::uint64_t cycle = std::max(cycles[0], back); cycle <= std::min(cycles[1], last);
       ++cycle) {
    if (!has(cycle) || !has(cycle - back)) continue;
    if (wanted.is_null() || is_within(static_cast<double>(cycle), wanted)) return true;
  }
  return false;
}

/// Why none of the runs will have a value of the column at these cycles; "" if one may have a
/// value.
string lack_of(const string& column, const std::array<std::uint64_t, 2>& cycles, RunGroup runs,
               const json& wanted = nullptr) {
  std::uint64_t back = 0;  // cycles between the two checkpoints that a value needs; 0: it needs one
  for (const string& name : providers_of({&column, 1})) {
    back = std::max(back, provider(name).cycles_back);
  }
  const bool any = std::ranges::any_of(
      runs, [&](const FrameRun* run) { return has_checkpoint(*run, cycles, back, wanted); });
  if (any) return "";
  return format(
      "runs lack a checkpoint {}{}{}, so {} has no value. Record more checkpoints (`every_cycles`) "
      "or more cycles.",
      cycles[0] == cycles[1] ? format("at cycle {}", cycles[0])
                             : format("in cycles {} to {}", cycles[0], cycles[1]),
      wanted.is_null() ? "" : " with " + words_of({{"cycle", wanted}}),
      back == 0 ? "" : format(" and another checkpoint {} earlier", counted(back, "cycle")),
      column);
}

/// Why no run will have a value for the plot; "" if some run may have a value.
string lack_of(const PlotSpec& plot, const Scale& scale, RunGroup runs) {
  const auto [shortest, longest] = std::ranges::minmax(
      std::views::transform(runs, [](const FrameRun* run) { return run->ask.target_cycles; }));
  const json wanted = member_of(plot.where, "cycle");
  std::array<std::uint64_t, 2> cycles = plot.cycles.value_or(std::array{std::uint64_t{0}, longest});
  if (!plot.cycles && !draws_every_cycle(plot) && !is_of_run(plot.y())) {
    if (!plot.cycle && scale.until.until) return "";  // `until` decides the last cycle
    cycles[1] = plot.cycle.value_or(shortest);
    // Without `at_cycle`, the plot draws the last cycle that `where` selects.
    if (plot.cycle || wanted.is_null()) cycles[0] = cycles[1];
  }
  const string lack = lack_of(plot.y(), cycles, runs, wanted);
  return lack.empty() ? lack_of(plot.x, cycles, runs, wanted) : lack;
}

/// Why the run will have no value for the claim; "" if the run may have a value. If the claim
/// states cycles, the run must have a value at each of these cycles.
string lack_of(const ClaimSpec& claim, const FrameRun* run) {
  if (!claim.cycles) return "";
  const auto [first, last] = *claim.cycles;
  // If the first, second and last cycle have checkpoints, all cycles of the range have them.
  for (const std::uint64_t cycle : {first, std::min(first + 1, last), last}) {
    string lack = lack_of(claim.compare, {cycle, cycle}, {&run, 1});
    if (!lack.empty()) return lack;
  }
  return "";
}

/// A message that lists the variants whose packings differ from those of the subtracted variant
/// (`minus`); "" if all variants have the same packings.
string lack_of_partner(const PlotSpec& plot, const PlotRuns& selection) {
  if (selection.alone.empty() || selection.subtracted.size() != 1) return "";
  std::vector<string> alone;
  for (const FrameRun* run : selection.alone) alone.push_back(run->place.variant);
  return format(
      "the plot omits {}, because the subtracted variant ({}) has different packings. Under "
      "`settle`, give one value to each swept parameter that changes the packings.",
      some_of(alone, 8), words_of(plot.minus));
}

/// Number of curves in the plot that get their style from this entry of `series`.
std::size_t curves_of(const SeriesSpec& series, const PlotSpec& plot, RunGroup runs) {
  std::set<json> curves;
  for (const FrameRun* run : runs) {
    if (!has_parameters(*run, series.where)) continue;
    json curve = run->place.swept;
    for (const string& name : names_in(plot.x)) curve.erase(name);
    curve.erase(plot.panel);
    if (!plot.by.empty()) curve = parameter_of(*run, plot.by);
    curves.insert(std::move(curve));
  }
  return curves.size();
}

/// Why `at_cycle` has no effect on the plot; "" if it has an effect or is not given.
string unused_cycle(const PlotSpec& plot) {
  if (plot.cycle && is_of_run(plot.y())) {
    return format("{} has one value for each run, so at_cycle has no effect. Leave at_cycle out.",
                  plot.y());
  }
  return plot.cycle && draws_every_cycle(plot)
             ? "at_cycle has no effect, because the plot draws every cycle. Remove at_cycle."
             : "";
}

std::vector<string> problems_of(const PlotSpec& plot, const ScaleRuns& here,
                                std::span<const ScaleRuns> all) {
  const PlotRuns selection = selected_by(plot, here.runs);
  const std::vector<const FrameRun*> runs = runs_of(selection.drawn);
  std::vector<string> found = {problem_of_minus(plot, count_variants(selection.subtracted)),
                               lack_of_partner(plot, selection)};
  if (runs.empty()) {
    if (found[0].empty() && found[1].empty()) {
      found.push_back(format("no run is left{}, so nothing is drawn. Change `where` or `minus`.",
                             plot.where.empty() ? "" : " with " + words_of(plot.where)));
    }
    return found;
  }
  if (const string key = averaged_by(plot, runs); !key.empty()) {
    found.push_back(
        format("the plot would average over the values of {}. Leave out `by` to draw one curve for "
               "each variant.",
               key));
  }
  if (plot.x == "shear_strain" && (!plot.cycles || here.scale.checkpoints.phases.empty())) {
    found.push_back(
        "shear_strain is 0 at whole cycles. To draw phases within a cycle, set `cycles` in the "
        "plot and `phases` in `checkpoints`.");
  }
  for (const SeriesSpec& one : plot.series) {
    // A listed plot is checked only in the manifest that defines it.
    if (plot.listed || !one.column.empty()) continue;
    const std::size_t curves = curves_of(one, plot, runs);
    const auto is_drawn = [&](const ScaleRuns& other) {
      return curves_of(one, plot, runs_of(selected_by(plot, other.runs).drawn)) > 0;
    };
    if (curves == 1 || (curves == 0 && std::ranges::any_of(all, is_drawn))) continue;
    found.push_back(
        format("the style for {} matches {} curves, but a style is for one curve. In `series`, "
               "give parameter values that exactly one curve of the plot has.",
               words_of(one.where), curves));
  }
  found.push_back(unused_cycle(plot));
  found.push_back(lack_of(plot, here.scale, runs));
  return found;
}

struct ClaimProblems {
  std::vector<string> refusals;  // why `shearcell figures` will refuse the claim
  std::vector<string> lacks;     // why the claim will be undecided
};

ClaimProblems problems_of(const ClaimSpec& claim, const ScaleRuns& here) {
  const ClaimSides sides = sides_of(claim, here.runs);
  if (claim.optional && sides.lacks_one) return {};
  ClaimProblems found = {problems_of_sides(claim, sides, true), {}};
  for (const auto& side : sides.runs) {
    for (const FrameRun* run : side) {
      string lack = lack_of(claim, run);
      if (!lack.empty() && found.lacks.empty()) found.lacks.push_back(std::move(lack));
    }
  }
  if (estimator_of(claim).compares_variants && count_variants(sides.runs[0]) == 1) {
    found.lacks.push_back(format("{} compares variants, but the claim selects only one variant.",
                                 estimator_of(claim).name));
  }
  if (here.seeds < least_runs) {
    found.lacks.push_back(format("a verdict needs at least {} seeds, but the manifest has {}.",
                                 least_runs, here.seeds));
  }
  return found;
}

/// First the plots or claims of the figures in `manifest.figures`, then the plots or claims that
/// `manifest` defines. Each is paired with the text that begins the messages about it.
template <class Spec>
std::vector<std::pair<string, const Placed<Spec>*>> stated_in(
    const Manifest& manifest, std::vector<Placed<Spec>> Manifest::*list) {
  std::vector<std::pair<string, const Placed<Spec>*>> found;
  for (const string& figure : manifest.figures) {
    for (const Manifest& shipped : shipped_manifests()) {
      for (const Placed<Spec>& one : shipped.*list) {
        if (figure_of(one) != figure) continue;
        found.emplace_back(format("{}: figure {}", manifest.file, figure), &one);
      }
    }
  }
  for (const Placed<Spec>& one : manifest.*list) {
    found.emplace_back(format("{}:{}:{}", manifest.file, one.at.line, one.at.column), &one);
  }
  return found;
}

/// Reports each entry of `primary` that is neither the id of a claim nor, as in older manifests,
/// the statement of a claim. Claims of all scales count. An id can have the ending `@VALUE`, where
/// VALUE is a value of `for_each`. VALUE is not checked if the claim belongs to a computed figure
/// or uses runs of other experiments (`of`): this manifest does not tell which values are possible.
void check_primary(const Manifest& manifest, const std::vector<Scale>& scales,
                   ProblemList& problems) {
  std::set<string> ids, unchecked, statements;
  for (const Scale& scale : scales) {
    if (scale.primary.empty()) continue;
    const std::vector<FrameRun> runs = planned_runs(manifest, scale, variants_of(scale));
    for (const auto& [place, claim] : stated_in(manifest, &Manifest::claims)) {
      for (const ClaimSpec& one : each_of(*claim, runs)) {
        ids.insert(one.id);
        statements.insert(stated(one, sides_of(one, runs).names).text);
      }
      if (!manifest.of.empty()) unchecked.insert(claim->id);
    }
  }
  for (const Figure& figure : all_figures()) {
    const bool listed = std::ranges::count(manifest.figures, figure.name) > 0 &&
                        find_named(computed_figures(), figure.name) != nullptr;
    if (listed) ids.insert(figure.claims.begin(), figure.claims.end());
    if (listed || !figure.of.empty()) {
      unchecked.insert(figure.claims.begin(), figure.claims.end());
    }
  }
  for (const Scale& scale : scales) {
    for (const auto& [id, at] : scale.primary) {
      if (ids.contains(id) || statements.contains(id)) continue;
      if (unchecked.contains(without_value(id))) continue;
      if (std::ranges::count(ids, id, without_value) > 0) continue;
      problems.add(at, "primary", "is not the id of a claim", printable(id),
                   format("The claims are: {}.", ids.empty() ? "none" : some_of(ids, 20)));
    }
  }
}

void add_warnings(const string& what, const std::vector<string>& problems,
                  std::vector<string>& warnings) {
  for (const string& problem : problems) {
    if (!problem.empty()) warnings.push_back(format("{}: {}", what, problem));
  }
}

void warn_of_figures(const Manifest& manifest, const ScaleRuns& here,
                     std::vector<string>& warnings) {
  for (const string& name : manifest.figures) {
    const Figure& figure = *find_figure(name);
    if (figure.form != FigureForm::groups) continue;
    const string key = averaged_key(pointers(here.runs), figure.keys);
    if (key.empty()) continue;
    warnings.push_back(
        format("{}: figure {} would average over the values of {}. Use one experiment for each "
               "value, or define a plot (`plots`).",
               manifest.file, name, key));
  }
  const std::vector<Scale> scales = scales_of(manifest);
  std::vector<ScaleRuns> all;
  for (const Scale& one : scales) {
    all.push_back({one, one.seeds.values.size(), planned_runs(manifest, one, variants_of(one))});
  }
  for (const auto& [place, plot] : stated_in(manifest, &Manifest::plots)) {
    add_warnings(format("{}: plot {}", place, plot->name), problems_of(*plot, here, all), warnings);
  }
  for (const auto& [place, stated_claim] : stated_in(manifest, &Manifest::claims)) {
    for (const ClaimSpec& claim : each_of(*stated_claim, here.runs)) {
      const string statement = stated(claim, sides_of(claim, here.runs).names).text;
      if (std::ranges::count(here.scale.primary, statement, &PrimaryClaim::id) > 0) {
        warnings.push_back(format("primary: '{}' is the statement of a claim. Write its id, {}.",
                                  statement, claim.id));
      }
      const ClaimProblems found = problems_of(claim, here);
      // A shipped claim (ClaimSpec::listed) may select values that no run of this experiment has.
      if (claim.listed && !found.refusals.empty()) continue;
      const string what = format("{}: claim {}", place, claim.id);
      add_warnings(what, found.refusals, warnings);
      // Small scales are for trials, so warn only if no other scale can decide the claim.
      const bool decided = std::ranges::any_of(all, [&](const ScaleRuns& other) {
        if (found.lacks.empty() || other.scale.name == here.scale.name) return false;
        const ClaimProblems there = problems_of(claim, other);
        return there.refusals.empty() && there.lacks.empty();
      });
      if (!decided) add_warnings(what, found.lacks, warnings);
    }
  }
}

}  // namespace

string unfit_for_lammps(const Parameters& p, const Checkpoints& checkpoints) {
  if (p.engine != EngineKind::lammps) return "";
  if (p.protocol == ProtocolKind::stiffen) return "LAMMPS cannot compute protocol stiffen";
  return checkpoints.phases.empty() ? "" : "LAMMPS makes no checkpoints within a cycle";
}

void check_variants(const Manifest& manifest) {
  const std::vector<Scale> scales = scales_of(manifest);
  ProblemList problems(manifest.file);
  std::uint64_t runs = 0;
  for (const Scale& scale : scales) {
    const string path = scale.name.empty() ? "" : "scales." + scale.name;
    if (scale.name == "base") {
      problems.add(scale.at, path, "is reserved for runs without a scale", "",
                   "Choose another name, such as desk.");
    }
    // A scale must not set a key of its sweep. `base` may set such keys; the sweep overrides them.
    for (const string& key : scale.own) {
      const auto setting = scale.settings.find(key);
      if (setting == scale.settings.end() || find_axis(scale.sweep, key) == nullptr) continue;
      problems.add(setting->second.at, path + "." + key,
                   "has no effect, because the sweep sets this key", setting->second.value.dump(),
                   "Define a separate `sweep` in this scale instead.");
    }
    const std::uint64_t variants = variant_count(scale.sweep);
    const std::uint64_t seeds = scale.seeds.values.size();
    if (std::ranges::adjacent_find(scale.looks, std::greater_equal()) != scale.looks.end()) {
      problems.add(scale.at, "looks", "are not ascending numbers of seeds", "",
                   "Sort the numbers.");
    }
    std::vector<Setting> needed;  // numbers of seeds
    if (const SweepAxis* axis = find_axis(scale.sweep, "seeds")) needed = axis->values;
    if (!scale.looks.empty()) needed.push_back({scale.looks.back(), scale.seeds.at});
    for (const auto& [number, at] : needed) {
      if (number <= seeds) continue;
      problems.add(at, "seeds", "are too few for `looks` or for the sweep", number.dump(),
                   format("Write `seeds: {}`, or list this many seeds.", number.dump()));
    }
    if (variants > ManifestLimits::runs || variants * seeds > ManifestLimits::runs - runs) {
      problems.add(scale.at, path.empty() ? "sweep" : path,
                   format("the manifest expands to more than {} runs", ManifestLimits::runs), "",
                   "Sweep fewer values or use fewer seeds.");
      problems.raise();
    }
    runs += variants * seeds;
  }
  check_texts(manifest, scales, problems);
  for (const Scale& scale : scales) {
    std::set<json> known;
    for (const Variant& variant : variants_of(scale)) {
      VariantCheck{manifest, scale, variant, problems}.run();
      if (known.insert(variant.swept).second) continue;
      const Sweep& sweep = scale.sweep;
      problems.add((sweep.grid.empty() ? sweep.zip : sweep.grid).front().at, "sweep",
                   "gives the same variant twice", variant.name, "Keep one of them.");
    }
  }
  problems.raise();  // check_primary() needs valid variants
  check_primary(manifest, scales, problems);
  problems.raise();
}

std::vector<string> warnings_of(const Manifest& manifest) {
  std::vector<string> warnings;
  for (const auto& [place, plot] : stated_in(manifest, &Manifest::plots)) {
    add_warnings(format("{}: plot {}", place, plot->name), {unused_cycle(*plot)}, warnings);
  }
  for (const auto& [place, claim] : stated_in(manifest, &Manifest::claims)) {
    add_warnings(format("{}: claim {}", place, claim->id), problems_of_sides(*claim, {}, false),
                 warnings);
  }
  return warnings;
}

std::vector<string> warnings_of(const Manifest& manifest, const Scale& scale,
                                std::span<const Variant> all, std::span<const Variant> planned,
                                std::size_t seeds) {
  std::vector<string> warnings;
  warn_of_parameters(manifest, scale, planned, seeds, warnings);
  warn_of_figures(manifest, {scale, seeds, planned_runs(manifest, scale, all)}, warnings);
  warn_of_ineffective(manifest, scale, all, warnings);
  return warnings;
}

}  // namespace shearcell
