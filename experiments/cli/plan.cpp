// SPDX-License-Identifier: GPL-3.0-or-later
// `plan`: lists the runs of manifests, shows whether each run is done, and estimates the cost of
// the runs that are not done.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <set>

#include "core/machine.hpp"
#include "experiments/cli/command.hpp"
#include "experiments/figures/draw.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/runner/lammps/lammps_run.hpp"
#include "experiments/runner/outlook.hpp"
#include "experiments/runner/registered.hpp"
#include "provenance/errors.hpp"
#include "provenance/words.hpp"

namespace shearcell::cli {
namespace {

using Line = PlannedStage;

// Returns what `run` will do with the stage, or the recorded state of the stage.
std::string state_of(const Line& line) {
  if (line.look.done) return "done";
  if (line.stage.attempts == 0) return "to do";
  if (line.stage.state != StageState::completed) return std::string(name_of(line.stage.state));
  // More cycles, or checkpoints between the existing ones, were requested after completion.
  return line.look.missing.empty() ? "to extend" : "to replay";
}

bool is_packing(const Line& line) {
  return line.stage.kind == name_of(StageKind::prepare);
}

const Parameters& parameters_of(const Line& line) {
  return is_packing(line) ? line.run->packing : line.run->parameters;
}

std::optional<TimeStep> time_step_of(const Line& line) {
  const Parameters& p = parameters_of(line);
  if (is_packing(line)) return time_step(p, p.settle_time_step_s);
  if (line.stage.kind == name_of(StageKind::stiffen)) return std::nullopt;
  return time_step(p, shear_time_step_s(p));
}

nlohmann::json facts(const std::optional<TimeStep>& step) {
  if (!step) return nullptr;
  return {{"seconds", step->seconds},
          {"over_contact_time", step->over_contact_time},
          {"over_stability_limit", step->over_stability_limit}};
}

std::string shown_name(const Line& line, const VariantNames& names) {
  return is_packing(line) ? names.of(line.stage, line.memberships.back().place) : line.run->name;
}

void print_numerics(const std::vector<Line>& lines, const VariantNames& names) {
  std::vector<Facts> rows;
  for (const Line& line : lines) {
    const Parameters& p = parameters_of(line);
    const std::string& kind = line.stage.kind;
    const auto step = time_step_of(line);
    Facts row = {{"", kind, "stage"},
                 {"", shown_name(line, names), "variant"},
                 {"", kind == name_of(StageKind::shear) ? std::to_string(p.steps_per_cycle) : "",
                  "steps/cycle"},
                 {"", step ? fmt::format("{:.4g}", step->seconds) : "", "dt [s]"},
                 {"", step ? fmt::format("{:.3f}", step->over_contact_time) : "", "dt/contact"},
                 {"", step ? fmt::format("{:.3f}", step->over_stability_limit) : "", "dt/limit"},
                 {"", fmt::format("{:.2g}", expected_overlap(p)), "overlap [d]"}};  // expected mean
    if (std::ranges::count(rows, row) == 0) rows.push_back(std::move(row));
  }
  fmt::print("\n");
  print_table(rows);
}

const std::vector<std::string> kLammpsCaveats = {
    "LAMMPS computes only the shear. shearcell settles the packings of all runs.",
    "The results of LAMMPS differ from those of shearcell by rounding errors, which depend on "
    "the number of processes.",
    "A run that LAMMPS computes has another id than the same run computed by shearcell. verify "
    "--replay, regenerate and prune skip the runs of LAMMPS.",
    "In runs by LAMMPS, the watchdog checks only checkpoints, not every 1024th step. These runs "
    "fail if the centre of a grain reaches the plane of a wall."};

std::vector<std::string> notes_of(const std::vector<Plan>& plans, const std::vector<Line>& lines) {
  std::vector<std::string> notes = list_of(plans, [](const Plan& plan) { return plan.read; });
  std::erase(notes, "");
  double most = 0;
  for (const Line& line : lines) {
    most = std::max(most, run_bytes(geometry(line.run->parameters)));
  }
  if (most > machine_memory()) {
    notes.push_back(fmt::format("the largest run needs {} of memory, but this machine has {}",
                                format_bytes(most), format_bytes(machine_memory())));
  }
  if (std::ranges::none_of(plans, asks_for_lammps)) return notes;
  notes.insert(notes.end(), kLammpsCaveats.begin(), kLammpsCaveats.end());
  try {
    notes.push_back("LAMMPS on this machine: " + find_lammps().version);
  } catch (const ProgramError& missing) {
    notes.emplace_back(missing.what());
  }
  return notes;
}

// The undecided claims of the experiment and the chance that the next look decides each of them,
// such as "S2.phi 0.93". Unknown until `figures` has measured all runs that have ended.
std::vector<std::string> powers_of(const Store& store, const Plan& plan) {
  FigureOptions options;
  options.only_cached = true;
  options.runs.scales = {scale_name(plan.scale)};
  std::vector<std::string> powers;
  for (const WantedFigure& wanted : wanted_figures(store).figures) {
    if (wanted.experiment != plan.manifest.experiment || wanted.figure.claims.empty()) continue;
    try {
      const ComputedFigure figure = compute_figure(store, wanted, options);
      for (const Verdict& verdict : figure.verdicts) {
        if (figure.unmeasured > 0 && verdict.looks.size() > 1) {
          powers.push_back(fmt::format("{} unknown ({} not measured yet: `figures` measures them)",
                                       verdict.id, counted(figure.unmeasured, "run")));
        } else if (verdict.power) {
          powers.push_back(fmt::format("{} {:.2f}", verdict.id, *verdict.power));
        }
      }
    } catch (const UsageError&) {  // `figures` will refuse this figure and say why
    } catch (const AnalysisError&) {
    }
  }
  return powers;
}

// For each experiment, adds a note on the next look (interim analysis). The note gives the work
// that this look needs and, for each claim, the probability that the claim is decided by then. As
// in verdicts, runs that failed or cannot start count as ended.
void note_looks(const std::vector<Plan>& plans, const std::vector<Line>& lines, const Store* store,
                const std::vector<Stage>& known, std::vector<std::string>& notes) {
  std::set<std::string> failed;  // ids
  for (const Stage& stage : known) {
    if (stage.state == StageState::failed) failed.insert(stage.id);
  }
  for (const Plan& plan : plans) {
    for (const Scale& scale : scales_of(plan.manifest)) {
      if (scale.name != plan.scale) continue;
      const auto left_at = [&](std::uint64_t look) {
        const std::span seeds = std::span(scale.seeds.values).first(look);
        double left = 0;
        for (const Line& line : lines) {
          const Place& place = line.run->place;
          const Stage& stage = line.stage;
          const bool enters = place.experiment == plan.manifest.experiment &&
                              std::ranges::count(seeds, place.seed) > 0 &&
                              !failed.contains(has_ended(stage.state) ? stage.id : stage.parent);
          left += enters ? line.look.particle_steps : 0;
        }
        return left;
      };
      const auto next =
          std::ranges::find_if(scale.looks, [&](std::uint64_t look) { return left_at(look) > 0; });
      if (next == scale.looks.end()) continue;
      const auto powers = store == nullptr ? std::vector<std::string>() : powers_of(*store, plan);
      notes.push_back(fmt::format(
          "{}: the next planned look (interim analysis) uses {} of {} and needs {:.3g} more "
          "particle-steps. {}",
          plan.manifest.experiment, *next, counted(scale.seeds.values.size(), "seed"),
          left_at(*next),
          powers.empty()
              ? "The probability that this look decides a claim is unknown: `figures` has measured "
                "too few runs, or all claims are decided"
              : fmt::format("Probability that a claim is decided at or before this look, if the "
                            "present estimates are the true values: {}",
                            fmt::join(powers, ", "))));
    }
  }
}

// Estimates the remaining particle-steps under the assumption that unfinished stages end at the
// expected_end() of their `until`. Null if Outlook::may_end_early is false for all stages, or if
// expected_end() is empty for the `until` of an unfinished stage.
nlohmann::json left_until(const std::vector<Line>& lines, const std::vector<Stage>& known) {
  std::map<nlohmann::json, std::optional<double>>
      ends;  // `until` -> expected last cycle; cached, since expected_end() reads all runs
  double sum = 0;
  bool asked = false;
  for (const Line& line : lines) {
    std::vector<Ask> asks = asks_of(line.memberships);
    for (Ask& ask : asks) {
      if (ask.until.is_null() || line.look.done) continue;
      const auto [end, fresh] = ends.try_emplace(ask.until);
      if (fresh) end->second = expected_end(known, ask.until);
      if (!end->second) return nullptr;
      const auto cycles = static_cast<std::uint64_t>(std::llround(*end->second));
      ask.target_cycles = std::min(ask.target_cycles, cycles);
    }
    asked = asked || line.look.may_end_early;
    sum += outlook(line.stage, asks, line.checkpoints).particle_steps;
  }
  return asked ? nlohmann::json(sum) : nlohmann::json();
}

void print_until(const std::vector<Line>& lines, const nlohmann::json& left, double at_most) {
  std::set<std::string> ends;
  for (const Line& line : lines) {
    if (!line.look.may_end_early) continue;
    for (const Ask& ask : asks_of(line.memberships)) {
      if (!ask.until.is_null()) ends.insert(describe(until_from_json(ask.until)));
    }
  }
  if (ends.empty()) return;
  fmt::print("      `until` ({}): ", fmt::join(ends, "; "));
  if (left.is_null()) {
    fmt::print(
        "fewer particle-steps than the number above if `until` ends these runs early; no estimate "
        "yet, because at least one condition has never ended a run\n");
  } else {
    fmt::print(
        "about {:.3g} particle-steps ({:.0f} % of the number above) if `until` ends these runs at "
        "the mean cycle at which it ended earlier runs\n",
        left.get<double>(), at_most > 0 ? 100 * left.get<double>() / at_most : 100);
  }
}

std::string joined(const std::vector<Plan>& plans, std::string (*name)(const Plan&)) {
  std::vector<std::string> names;
  for (const Plan& plan : plans) {
    if (std::ranges::count(names, name(plan)) == 0) names.push_back(name(plan));
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

nlohmann::json experiment_facts(const Plan& plan) {
  return {{"experiment", plan.manifest.experiment},
          {"scale", scale_name(plan.scale)},
          {"runs", plan.runs.size()}};
}

/// Names of the stages, as `status` will show them when the stages are in the store.
VariantNames names_of(const std::vector<Plan>& plans, const std::vector<Line>& lines) {
  VariantNames::Labels labels;
  for (const Plan& plan : plans) {
    if (!plan.runs.empty()) labels[plan.runs.front().place.manifest] = plan.manifest.labels;
  }
  return {list_of(lines,
                  [](const Line& line) {
                    Stage stage = line.stage;
                    stage.memberships = line.memberships;
                    return stage;
                  }),
          labels};
}

Facts facts(const Line& line, const VariantNames& names, bool of_several_experiments) {
  const PlannedRun& run = *line.run;
  // The stage is complete after `cycles`, unless an `until` ends it earlier.
  const double cycles = std::max(static_cast<double>(run.ask.target_cycles), line.look.end);
  std::set<std::string> others;
  for (const Membership& m : line.memberships) others.insert(m.place.experiment);
  others.erase(run.place.experiment);
  Facts all = {{"id", line.stage.id, "run", line.stage.id.substr(0, 8)},
               {"stage", line.stage.kind, "stage"},
               {"experiment", run.place.experiment},
               {"variant", run.place.variant, "variant", shown_name(line, names)},
               {"seed", run.place.seed, "seed"},
               {"N", run.parameters.grains, "N"},
               {"cycles", static_cast<std::uint64_t>(cycles), "cycle",
                is_packing(line) ? "" : fmt::format("{:.4g}/{}", line.stage.cycle, cycles)},
               {"state", state_of(line), "state"},
               {"shared_with", others, "",
                others.empty() ? "" : fmt::format("also in {}", fmt::join(others, ", "))},
               {"parent", line.stage.parent},
               {"parameters", effective_parameters(line.stage.resolved)},
               {"time_step", facts(time_step_of(line))},
               {"expected_overlap_d", expected_overlap(parameters_of(line))},
               {"particle_steps_left", line.look.particle_steps},
               {"checkpoints_left", line.look.checkpoints},
               {"bytes_left", line.look.bytes},
               {"memory_bytes", run_bytes(geometry(run.parameters))}};
  if (of_several_experiments) all[2].heading = "experiment";
  return all;
}

struct PlanOptions {
  std::vector<std::string> manifests;
  ExpandOptions expand;
};

void plan(const PlanOptions& options, Context& context) {
  const std::vector<Plan> plans = load_plans(options.manifests, options.expand, context, false);
  const std::optional<Store> store = open_if_there(context.store);
  const auto runs = store ? store->stages() : std::vector<Stage>{};
  const std::vector<Line> lines = look_at(plans, store ? &*store : nullptr);
  const Rates rates(runs);
  Work left;
  for (const Line& line : lines) left.add(line.stage, line.look, rates);
  const nlohmann::json with_until = left_until(lines, runs);
  std::set<const PlannedRun*> left_runs;  // unfinished runs; each run uses one core
  std::size_t runs_planned = 0, longer = 0;
  for (const Line& line : lines) {
    runs_planned += is_packing(line) ? 0 : 1;
    if (!line.look.done) left_runs.insert(line.run);
    // Whether an earlier command requested more cycles than this plan.
    const auto asks_more = [&](const Membership& m) {
      return m.ask.target_cycles > line.run->ask.target_cycles;
    };
    longer += std::ranges::any_of(line.stage.memberships, asks_more) ? 1 : 0;
  }
  const std::size_t cores = std::clamp<std::size_t>(left_runs.size(), 1, usable_cores());
  const double seconds = left.seconds(cores);
  std::vector<std::string> notes = notes_of(plans, lines);
  const std::filesystem::path place = existing_folder(context.store);
  const auto free = static_cast<double>(std::filesystem::space(place).available);
  if (left.bytes > free) {
    notes.push_back(fmt::format("too little disk space: only {} are free in {}", format_bytes(free),
                                place.string()));
  }
  note_looks(plans, lines, store ? &*store : nullptr, runs, notes);
  if (longer > 0) {
    notes.push_back(fmt::format(
        "an earlier command requested more cycles for {}; `run` also computes these cycles",
        counted(longer, "run")));
  }
  const std::string experiment =
      joined(plans, [](const Plan& one) { return one.manifest.experiment; });
  const std::string scale = joined(plans, [](const Plan& one) { return one.scale; });
  const VariantNames names = names_of(plans, lines);
  const std::vector<Facts> stages = list_of(
      lines, [&](const Line& line) { return facts(line, names, options.manifests.size() > 1); });
  if (context.json) {
    return print_json({{"experiment", experiment},
                       {"scale", scale_name(scale)},
                       {"experiments", list_of(plans, experiment_facts)},
                       {"notes", notes},
                       {"warnings", context.warnings},
                       {"runs", runs_planned},
                       {"stages", to_json(stages)},
                       {"particle_steps_left", left.particle_steps},
                       {"particle_steps_left_with_until", with_until},
                       {"bytes_left", left.bytes},
                       {"seconds_left", seconds},
                       {"cores", cores},
                       {"particle_steps_per_second_and_core", left.rate},
                       {"rate_measured", left.measured}});
  }
  fmt::print("{}{}: {}, {}\n", experiment, at_scale(scale), counted(runs_planned, "run"),
             counted(lines.size(), "stage"));
  if (!lines.empty()) {
    fmt::print("\n");
    print_table(stages);
    print_numerics(lines, names);
    if (std::ranges::all_of(lines, [](const Line& line) { return line.look.done; })) {
      fmt::print("\nleft: nothing\n");
    } else {
      fmt::print(
          "\nleft: {:.3g} particle-steps, about {} on {} at {:.0f} M particle-steps/s each "
          "({}),\n      about {} on disk\n",
          left.particle_steps, format_duration(seconds), counted(cores, "core"), left.rate * 1e-6,
          left.measured ? "measured in this store" : "assumed until a run has been measured",
          format_bytes(left.bytes));
      print_until(lines, with_until, left.particle_steps);
    }
  }
  if (!notes.empty()) fmt::print("\n{}\n", fmt::join(notes, "\n"));
}

}  // namespace

void add_plan(CLI::App& app, Context& context) {
  const auto [command, options] = add_command(
      app, context, "plan",
      "List the runs of manifests, show which are done, and estimate the cost of the others", plan);
  add_manifest_options(*command, options->manifests, options->expand, true);
  add_common_options(*command, context,
                     "A run that several manifests share is counted once.\n"
                     "Examples:\n"
                     "  shearcell plan experiments/drag.yaml --scale paper\n"
                     "  shearcell plan experiments/*.yaml --scale paper       # a whole campaign");
}

}  // namespace shearcell::cli
