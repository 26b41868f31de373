// SPDX-License-Identifier: GPL-3.0-or-later
// `show`: everything the store knows about one run, checkpoint, figure or published file.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "analysis/error.hpp"
#include "analysis/figure.hpp"
#include "experiments/cli/command.hpp"
#include "experiments/figures/lineage.hpp"
#include "experiments/figures/more_measures.hpp"
#include "experiments/figures/run_table.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/runner/look.hpp"
#include "provenance/errors.hpp"
#include "provenance/words.hpp"

namespace shearcell::cli {
namespace {

nlohmann::json checkpoint_facts(const CheckpointRecord& c) {
  return {{"run", c.run},
          {"cycle", c.cycle},
          {"step", c.step},
          {"time_s", c.time_s},
          {"file", c.file},
          {"size", c.size},
          {"sha256", c.sha256},
          {"state_hash", c.state_hash},
          {"state", name_of(c.state)},
          {"observables", c.observables}};
}

/// `asked_by`: indices of the memberships whose figures and tables have the checkpoint; empty if
/// only an interruption or another experiment's cadence left it.
nlohmann::json facts_of_all(const Store& store, const RunRecord& run,
                            const std::vector<CheckpointRecord>& checkpoints) {
  std::map<std::uint64_t, std::vector<std::size_t>> asked_by;
  for (std::size_t k = 0; k < run.memberships.size(); ++k) {
    for (const CheckpointRecord& c : checkpoints_for(store, run, run.memberships[k], {})) {
      asked_by[c.step].push_back(k);
    }
  }
  return json_list(checkpoints, [&](const CheckpointRecord& c) {
    nlohmann::json facts = checkpoint_facts(c);
    facts["asked_by"] = asked_by[c.step];
    return facts;
  });
}

// The engine that the latest attempt recorded; null for our own.
nlohmann::json engine_of_run(const Store& store, const std::string& run) {
  nlohmann::json engine;
  for (const Event& event : store.events(run_stream(run))) {
    const nlohmann::json body = event.body();
    const nlohmann::json host = body.value("host", nlohmann::json::object());
    if (host.is_object() && host.contains("engine")) engine = host["engine"];
  }
  return engine;
}

using CheckpointFacts = std::vector<std::pair<TableColumn, nlohmann::json>>;

/// The same values as in `table`; measured now if they are not cached.
CheckpointFacts facts_at(const Store& store, const CheckpointRecord& record, Context& context) {
  MeasuredPackings found;
  try {
    found = measures_of(store, {&record, 1}, table_measures(), {});
  } catch (const AnalysisError& problem) {  // a failed run may leave such a state
    print_stderr("not measured: {}\n", problem.what());
    return facts_of(record, std::nullopt);
  }
  print_problems(found, "not measured", context);
  return facts_of(record, found.measures.front());
}

CheckpointFacts newest_measures(const Store& store,
                                const std::vector<CheckpointRecord>& checkpoints,
                                Context& context) {
  for (auto c = checkpoints.rbegin(); c != checkpoints.rend(); ++c) {
    if (c->state != CheckpointState::rejected) return facts_at(store, *c, context);
  }
  return {};
}

nlohmann::json as_json(const CheckpointFacts& facts) {
  nlohmann::json all = nlohmann::json::object();
  for (const auto& [column, value] : facts) all[column.name] = value;
  return all;
}

void print(const CheckpointFacts& facts) {
  for (const auto& [column, value] : facts) {
    if (value.is_null() || value.is_string()) continue;
    print_text("{:<37} {:<12.6g} {}\n", column.name, value.get<double>(), column.meaning);
  }
}

nlohmann::json run_facts(const Store& store, const RunRecord& run,
                         const std::vector<CheckpointRecord>& checkpoints, Context& context) {
  const auto member = [&](const Membership& m) -> nlohmann::json {
    return {{"experiment", m.experiment},
            {"scale", m.scale},
            {"variant", m.variant},
            {"seed", m.seed},
            {"target_cycles", m.target_cycles},
            {"manifest", m.manifest},
            {"overrides", overrides_of(store, run, m)}};
  };
  return {{"id", run.id},
          {"parent", run.parent},
          {"kind", run.kind},
          {"state", name_of(run.state)},
          {"resolved", run.resolved},
          {"parameters", effective_parameters(run.resolved)},
          {"attempts", run.attempts},
          {"engine", engine_of_run(store, run.id)},
          {"memberships", json_list(run.memberships, member)},
          {"checkpoints", facts_of_all(store, run, checkpoints)},
          {"measures", as_json(newest_measures(store, checkpoints, context))},
          {"error", run.error},
          {"ended", end_of(run)}};
}

void print_run(const Store& store, const RunRecord& run) {
  const nlohmann::json engine = engine_of_run(store, run.id);
  print_text("run      {}\nkind     {}\nparent   {}\nstate    {}, cycle {:g} of {}, {}\n", run.id,
             run.kind, run.parent.empty() ? "-" : run.parent, name_of(run.state), run.cycle,
             run.target_cycles, counted(run.attempts, "attempt"));
  if (engine.is_object()) {
    print_text("engine   {} {}, {} processes\n", engine.value("name", ""),
               engine.value("version", ""), engine.value("processes", 1));
  }
  if (!run.error.empty()) print_text("error    {}\n", run.error);
  if (const std::string why = describe_end(end_of(run)); !why.empty()) {
    print_text("ended    {}\n", why);
  }
  for (const Membership& m : run.memberships) {
    print_text("part of  {} ({}) {} seed {}, manifest {:.8}\n", m.experiment, scale_name(m.scale),
               m.variant, m.seed, m.manifest);
    const nlohmann::json given = overrides_of(store, run, m);
    for (const auto& [key, values] : given.items()) {
      print_text("         given at the command line: {} {} (manifest: {})\n", key,
                 values.at("run").dump(), values.at("manifest").dump());
    }
  }
}

void print_resolved(const nlohmann::json& resolved) {
  for (const auto& [key, value] : resolved.items()) {
    if (key != "parameters") print_text("{:<32} {}\n", key, value.dump());
  }
  const nlohmann::json parameters = effective_parameters(resolved);
  for (const auto& [name, value] : parameters.items()) {
    print_text("{:<32} {}\n", name, value.dump());
  }
}

void show_run(const Store& store, const RunRecord& run, Context& context) {
  const std::vector<CheckpointRecord> checkpoints = store.checkpoints(run.id, Listed::all);
  if (context.json) return print_json(run_facts(store, run, checkpoints, context));
  print_run(store, run);
  print_text("\n");
  print_resolved(run.resolved);
  print_text("\n");
  print_table({"cycle", "step", "checkpoint", "state", "size", ""}, checkpoints,
              [](const CheckpointRecord& c) -> Row {
                return {fmt::format("{:g}", c.cycle),
                        std::to_string(c.step),
                        c.sha256.substr(0, 12),
                        c.state_hash.substr(0, 12),
                        format_bytes(static_cast<double>(c.size)),
                        c.state == CheckpointState::recorded ? "" : std::string(name_of(c.state))};
              });
  if (const CheckpointFacts facts = newest_measures(store, checkpoints, context); !facts.empty()) {
    print_text("\nnewest checkpoint:\n");
    print(facts);
  }
}

/// `file`: a description of its file.
void print_head(const CheckpointRecord& record, const std::string& file) {
  print_text("checkpoint  {}\nstate       {}\nrun         {}\n", record.sha256, record.state_hash,
             record.run);
  print_text("file        {}\n", file);
  print_text("time        cycle {:g}, step {}, {:.6g} s\n", record.cycle, record.step,
             record.time_s);
}

// Prints the record of a checkpoint whose file was deleted.
void show_pruned(const CheckpointRecord& record, Context& context) {
  if (context.json) return print_json(checkpoint_facts(record));
  print_head(record,
             fmt::format("pruned; `shearcell regenerate {:.12}` recomputes it", record.sha256));
  for (const auto& [name, value] : record.observables) print_text("{:<42} {:.6g}\n", name, value);
}

void show_checkpoint(const Store& store, const CheckpointRecord& record, Context& context) {
  if (record.state == CheckpointState::pruned) return show_pruned(record, context);
  const Checkpoint checkpoint = store.load_checkpoint(record);
  const Eigen::Index grains = checkpoint.state.position.cols();
  const std::size_t wall_grains = checkpoint.cell.wall_grains.size();
  if (context.json) {
    nlohmann::json all = checkpoint_facts(record);
    all["grains"] = grains;
    all["wall_grains"] = wall_grains;
    all["measures"] = as_json(facts_at(store, record, context));
    return print_json(all);
  }
  print_head(record, fmt::format("{} ({}, hash verified)", record.file,
                                 format_bytes(static_cast<double>(record.size))));
  print_text("grains      {} and {} wall grains\n", grains, wall_grains);
  print(facts_at(store, record, context));
}

// The newest record of "drag/desk/S2"; also of "drag/S2" and "S2" if no other figure has that name.
std::optional<FigureRecord> find_record(const Store& store, const std::string& name) {
  std::map<std::string, FigureRecord> found;  // by path
  for (FigureRecord& figure : store.figures()) {
    const std::string path = figure_path(figure), last = figure_name(figure);
    const std::string experiment = path.substr(0, path.find('/') + 1);
    if (name != path && name != figure.name && name != experiment + last && name != last) continue;
    const auto [known, first] = found.try_emplace(path, figure);
    if (!first && known->second.seq < figure.seq) known->second = std::move(figure);
  }
  std::vector<std::string> paths;
  for (const auto& [path, figure] : found) paths.push_back(path);
  if (paths.size() > 1) {
    throw NotFound(fmt::format("several figures are called {}: {}", name, fmt::join(paths, ", ")));
  }
  if (paths.empty()) return std::nullopt;
  return std::move(found.begin()->second);
}

// Throws if the name, as "S4" or "drag/desk/S4", is that of a figure without a record.
void require_not_undrawn(const std::string& name) {
  const std::string figure = std::filesystem::path(name).filename().string();
  if (find_figure(figure) == nullptr || std::filesystem::exists(name)) return;
  throw NotFound(
      fmt::format("figure {} has not been drawn; run `shearcell figures {}`", name, figure));
}

void show(const std::string& name, Context& context) {
  const Store store(context.store, Access::read);
  if (const auto figure = find_record(store, name)) return show_figure(store, *figure, context);
  require_not_undrawn(name);
  // Ids of runs and checkpoints have no dot or slash.
  if (name.find_first_of("./") != std::string::npos) return show_published(store, name, context);
  if (name.size() >= 4) {
    if (const auto checkpoint = store.find_checkpoint(name)) {
      for (const RunRecord& run : store.runs()) {
        if (!run.id.starts_with(name)) continue;
        throw NotFound(
            fmt::format("a run and a checkpoint begin with '{}'; give more digits of one of\n"
                        "  run {}\n  checkpoint {}",
                        name, run.id, checkpoint->sha256));
      }
      return show_checkpoint(store, *checkpoint, context);
    }
  }
  show_run(store, store.find_run(name), context);
}

}  // namespace

void add_show(CLI::App& app, Context& context) {
  auto name = std::make_shared<std::string>();
  CLI::App* command =
      app.add_subcommand("show", "Show one run, checkpoint, figure or figure's file");
  command
      ->add_option("name", *name,
                   "Run id or checkpoint SHA-256 (or a beginning), figure, or a figure's file")
      ->required();
  add_common_options(*command, context);
  command->footer(
      R"(For a figure: prints its files, manifest lines, runs, seeds, attempts, builds, hosts and the
SHA-256 of every checkpoint in it. For a file (CSV, SVG or lineage): checks that it is what the
store recorded and that every checkpoint behind it is intact; exit code 4 if not. Pruned
checkpoints are counted and are not an error.
With --json, `parameters` of a run are those that affect it; `resolved` is the stored record,
whose hash is the run's id, and has fixed values for some that do not (max_overlap_diameters).
Examples:
  shearcell show 3f9a
  shearcell show drag/smoke/S2
  shearcell show figures/drag/smoke/S2a.csv)");
  command->callback([name, &context] { show(*name, context); });
}

}  // namespace shearcell::cli
