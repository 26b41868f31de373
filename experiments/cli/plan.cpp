// SPDX-License-Identifier: GPL-3.0-or-later
// `plan`: the runs of manifests, which of them are done, and what the rest costs.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string_view>

#include "core/machine.hpp"
#include "experiments/cli/command.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/runner/cost.hpp"
#include "experiments/runner/engine.hpp"
#include "experiments/runner/lammps/lammps_run.hpp"
#include "experiments/runner/run_end.hpp"
#include "provenance/words.hpp"

namespace shearcell::cli {
namespace {

// Stages of the plan, each once, with what the store holds of them.
struct Line {
  const PlannedRun* run;
  const StageSpec* stage;
  std::string state = "to do";
  double cycle = 0;  // of the newest checkpoint
  double from = 0;   // cycle from which it is computed
  StageCost left = {};
  std::optional<double> left_until = 0;       // particle-steps; nothing when it is not known
  std::vector<std::string> shared_with = {};  // other experiments that contain it
};

// "also in twin".
std::string remark(const Line& line) {
  return line.shared_with.empty() ? ""
                                  : fmt::format("also in {}", fmt::join(line.shared_with, ", "));
}

void add_shares(const RunRecord& record, const std::string& experiment, Line& line) {
  for (const Membership& m : record.memberships) {
    const bool known = std::ranges::count(line.shared_with, m.experiment) > 0;
    if (m.experiment != experiment && !known) line.shared_with.push_back(m.experiment);
  }
}

// The time step of a stage; none where no time passes.
std::optional<TimeStep> time_step_of(const Line& line) {
  const Parameters& p = line.run->parameters;
  if (line.stage->stage == Stage::prepare) return settle_time_step(p);
  if (line.stage->stage == Stage::stiffen) return std::nullopt;
  return shear_time_step(p);
}

nlohmann::json facts(const std::optional<TimeStep>& step) {
  if (!step) return nullptr;
  return {{"seconds", step->seconds},
          {"over_contact_time", step->over_contact_time},
          {"over_stability_limit", step->over_stability_limit}};
}

// Time steps and overlap of every kind of stage, each once.
void print_numerics(const std::vector<Line>& lines) {
  std::vector<Row> rows;
  for (const Line& line : lines) {
    const Parameters& p = line.run->parameters;
    const Stage stage = line.stage->stage;
    Row row = {std::string(name_of(stage)),
               stage == Stage::prepare ? "" : line.run->name,
               stage == Stage::shear ? std::to_string(p.steps_per_cycle) : "",
               "",
               "",
               "",
               fmt::format("{:.2g}", expected_overlap(p))};
    if (const auto step = time_step_of(line)) {
      row[3] = fmt::format("{:.4g}", step->seconds);
      row[4] = fmt::format("{:.3f}", step->over_contact_time);
      row[5] = fmt::format("{:.3f}", step->over_stability_limit);
    }
    if (std::ranges::count(rows, row) == 0) rows.push_back(std::move(row));
  }
  fmt::print("\n");
  // The mean overlap that is to be expected.
  print_table(
      {"stage", "variant", "steps/cycle", "dt [s]", "dt/contact", "dt/limit", "overlap [d]"}, rows);
}

// Notes on runs that this machine cannot hold, and on runs by another engine.
std::vector<std::string> notes_of(const Plan& plan) {
  std::vector<std::string> notes;
  double most = 0;
  for (const PlannedRun& run : plan.runs) {
    most = std::max(most, run_bytes(geometry(run.parameters)));
  }
  if (most > machine_memory()) {
    notes.push_back(fmt::format("the largest run needs {}, and this machine has {}",
                                format_bytes(most), format_bytes(machine_memory())));
  }
  if (!asks_for_lammps(plan)) return notes;
  std::ranges::move(lammps_caveats(), std::back_inserter(notes));
  try {
    notes.push_back("LAMMPS here: " + find_lammps().version);
  } catch (const ProgramError& missing) {
    notes.emplace_back(missing.what());
  }
  return notes;
}

// What is left if the run ends where others with the same `until` ended; nothing when none did.
// `ends` keeps where those ended, as a search reads every run.
using ExpectedEnds = std::map<std::string, std::optional<double>>;
std::optional<double> left_until(const Line& line, const std::optional<Store>& store,
                                 ExpectedEnds& ends) {
  if (!line.run->ends_early || line.stage->stage == Stage::prepare) return line.left.particle_steps;
  const auto [known, fresh] = ends.try_emplace(describe(*line.run->ends_early));
  if (fresh && store) known->second = expected_end(*store, *line.run->ends_early);
  const std::optional<double> end = known->second;
  if (!end) return std::nullopt;
  PlannedRun shorter = *line.run;
  shorter.target_cycles =
      std::min(shorter.target_cycles, static_cast<std::uint64_t>(std::llround(*end)));
  return stage_cost(shorter, *line.stage, line.from).particle_steps;
}

// The same of the whole plan; nothing without `until`, or when it is not known of some run.
nlohmann::json left_until(const std::vector<Line>& lines) {
  double sum = 0;
  bool asked = false;
  for (const Line& line : lines) {
    asked = asked || line.run->ends_early;
    if (!line.left_until) return nullptr;
    sum += *line.left_until;
  }
  return asked ? nlohmann::json(sum) : nlohmann::json();
}

void print_until(const std::vector<Line>& lines, double at_most) {
  std::set<std::string> ends;
  for (const Line& line : lines) {
    if (line.run->ends_early) ends.insert(describe(*line.run->ends_early));
  }
  if (ends.empty()) return;
  fmt::print("      `until` ({}): ", fmt::join(ends, "; "));
  if (const nlohmann::json left = left_until(lines); left.is_null()) {
    fmt::print("less, by how much is known once such a run has ended\n");
  } else {
    fmt::print("about {:.3g} particle-steps, {:.0f} % of these, as such runs ended before\n",
               left.get<double>(), at_most > 0 ? 100 * left.get<double>() / at_most : 100);
  }
}

std::vector<Line> lines_of(const Plan& plan, const std::optional<Store>& store,
                           const std::vector<RunRecord>& runs) {
  std::map<std::string_view, const RunRecord*> known;
  for (const RunRecord& run : runs) known.emplace(run.id, &run);
  ExpectedEnds ends;
  std::vector<Line> lines;
  std::set<std::string> seen;
  for (const PlannedRun& run : plan.runs) {
    for (const StageSpec* stage : {&run.prepare, &run.last}) {
      if (!seen.insert(stage->key).second) continue;
      Line line{.run = &run, .stage = stage};
      if (const auto found = known.find(stage->key); found != known.end()) {
        const RunRecord* record = found->second;
        line.cycle = record->cycle;
        add_shares(*record, run.experiment, line);
        const auto from = cycle_to_continue(run, *stage, record, &*store);
        line.from = from.value_or(line.cycle);
        line.state = !from ? "done" : record->attempts > 0 ? name_of(record->state) : "to do";
        // Short of checkpoints that were asked for later, or of cycles.
        const bool replayed = line.from < line.cycle;
        if (line.state == "completed") line.state = replayed ? "to replay" : "to extend";
      }
      if (line.state != "done") {
        line.left = stage_cost(run, *stage, line.from);
        line.left_until = left_until(line, store, ends);
      }
      lines.push_back(line);
    }
  }
  return lines;
}

struct Left {
  RemainingWork work;
  double bytes = 0;
  double rate = 0;  ///< mean particle-steps/s of one core
};

Left left_of(const std::vector<Line>& lines, const std::vector<RunRecord>& known) {
  Left left;
  const Rates rates(known);
  for (const Line& line : lines) {
    const Rate own =
        rates.of(engine_of(line.stage->resolved), static_cast<double>(line.run->parameters.grains));
    left.work.add(line.stage->key, line.stage->parent, line.left.particle_steps, own);
    left.bytes += line.left.bytes;
    if (left.rate == 0) left.rate = own.particle_steps_per_second;  // where nothing is left to do
  }
  const RemainingWork& work = left.work;
  if (work.core_seconds > 0) left.rate = work.particle_steps / work.core_seconds;
  return left;
}

nlohmann::json experiment_facts(const Plan& plan) {
  return {{"experiment", plan.experiment}, {"scale", plan.scale}, {"runs", plan.runs.size()}};
}

nlohmann::json facts(const Line& line) {
  return {{"id", line.stage->key},
          {"experiment", line.run->experiment},
          {"parent", line.stage->parent},
          {"stage", name_of(line.stage->stage)},
          {"variant", line.run->variant},
          {"parameters", effective_parameters(line.stage->resolved)},
          {"seed", line.run->seed},
          {"N", line.run->parameters.grains},
          {"cycles", line.run->target_cycles},
          {"state", line.state},
          {"shared_with", line.shared_with},
          {"time_step", facts(time_step_of(line))},
          {"expected_overlap_d", expected_overlap(line.run->parameters)},
          {"particle_steps_left", line.left.particle_steps},
          {"bytes_left", line.left.bytes},
          {"memory_bytes", run_bytes(geometry(line.run->parameters))}};
}

void print_stages(const std::vector<Line>& lines, bool of_several_experiments) {
  Row header = {"run", "stage", "variant", "seed", "N", "cycle", "state", ""};
  if (of_several_experiments) header.insert(header.begin() + 2, "experiment");
  print_table(header, lines, [&](const Line& line) {
    const bool prepare = line.stage->stage == Stage::prepare;
    Row row = {line.stage->key.substr(0, 8),
               std::string(name_of(line.stage->stage)),
               prepare ? "" : line.run->name,
               std::to_string(line.run->seed),
               std::to_string(line.run->parameters.grains),
               prepare ? "" : fmt::format("{:.4g}/{}", line.cycle, line.run->target_cycles),
               line.state,
               remark(line)};
    if (of_several_experiments) row.insert(row.begin() + 2, line.run->experiment);
    return row;
  });
}

void plan(const std::vector<std::string>& manifests, const ExpandOptions& options,
          Context& context) {
  const std::vector<Plan> plans = load_manifests(manifests, options, context).plans;
  Plan expanded = joined(plans);
  const std::optional<Store> store = open_if_there(context.store);
  const auto runs = store ? store->runs() : std::vector<RunRecord>{};
  const std::size_t longer = take_longer_targets(runs, expanded);
  const std::vector<Line> lines = lines_of(expanded, store, runs);
  const Left left = left_of(lines, runs);
  std::set<const PlannedRun*> unfinished;  // each is computed by one core
  for (const Line& line : lines) {
    if (line.state != "done") unfinished.insert(line.run);
  }
  const std::size_t cores = std::clamp<std::size_t>(unfinished.size(), 1, usable_cores());
  const double seconds = left.work.seconds(cores);
  std::vector<std::string> notes = notes_of(expanded);
  const std::filesystem::path place = existing_folder(context.store);
  const auto free = static_cast<double>(std::filesystem::space(place).available);
  if (left.bytes > free) {
    notes.push_back(fmt::format("too little disk space: {} are free in {}", format_bytes(free),
                                place.string()));
  }
  if (longer > 0) {
    notes.push_back(fmt::format(
        "`run` also continues {} to the number of cycles that an earlier command asked for",
        counted(longer, "run")));
  }
  if (context.json) {
    return print_json({{"experiment", expanded.experiment},
                       {"scale", expanded.scale},
                       {"experiments", json_list(plans, experiment_facts)},
                       {"notes", notes},
                       {"warnings", context.warnings},
                       {"runs", expanded.runs.size()},
                       {"stages", json_list(lines, [](const Line& line) { return facts(line); })},
                       {"particle_steps_left", left.work.particle_steps},
                       {"particle_steps_left_with_until", left_until(lines)},
                       {"bytes_left", left.bytes},
                       {"seconds_left", seconds},
                       {"cores", cores},
                       {"particle_steps_per_second_and_core", left.rate},
                       {"rate_measured", left.work.measured}});
  }
  fmt::print("{} at scale {}: {}, {}\n\n", expanded.experiment, scale_name(expanded.scale),
             counted(expanded.runs.size(), "run"), counted(lines.size(), "stage"));
  print_stages(lines, manifests.size() > 1);
  print_numerics(lines);
  if (std::ranges::all_of(lines, [](const Line& line) { return line.state == "done"; })) {
    fmt::print("\nleft: nothing\n");
  } else {
    fmt::print(
        "\nleft: {:.3g} particle-steps, about {} on {} at {:.0f} M particle-steps/s each "
        "({}),\n      about {} on disk\n",
        left.work.particle_steps, format_duration(seconds), counted(cores, "core"),
        left.rate * 1e-6,
        left.work.measured ? "measured in this store" : "assumed until a run has been measured",
        format_bytes(left.bytes));
    print_until(lines, left.work.particle_steps);
  }
  if (!notes.empty()) fmt::print("\n{}\n", fmt::join(notes, "\n"));
}

}  // namespace

void add_plan(CLI::App& app, Context& context) {
  auto manifests = std::make_shared<std::vector<std::string>>();
  auto options = std::make_shared<ExpandOptions>();
  CLI::App* command = app.add_subcommand(
      "plan", "Show the runs of manifests, what is done, and the cost of the rest");
  command->add_option("manifest", *manifests, "YAML manifests")->required();
  add_expand_options(*command, *options);
  add_engine_option(*command, *options);
  add_common_options(*command, context);
  command->footer(
      "Runs that several of the manifests share are counted once.\n"
      "Examples:\n"
      "  shearcell plan experiments/drag.yaml --scale paper\n"
      "  shearcell plan experiments/*.yaml --scale paper       # all of a campaign");
  command->callback([manifests, options, &context] { plan(*manifests, *options, context); });
}

}  // namespace shearcell::cli
