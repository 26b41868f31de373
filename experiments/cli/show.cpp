// SPDX-License-Identifier: GPL-3.0-or-later
// `show`: everything the store knows about one run, checkpoint, figure or published file.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "analysis/error.hpp"
#include "analysis/figure.hpp"
#include "experiments/cli/command.hpp"
#include "experiments/figures/lineage.hpp"
#include "experiments/figures/run_table.hpp"
#include "experiments/manifest/document.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/manifest/shipped.hpp"
#include "experiments/runner/look.hpp"
#include "experiments/runner/measure_sources.hpp"
#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"
#include "provenance/words.hpp"

namespace shearcell::cli {
namespace {

Facts checkpoint_facts(const CheckpointRecord& c) {
  return {{"run", c.run},
          {"cycle", c.cycle, "cycle", fmt::format("{:g}", c.cycle)},
          {"step", c.step, "step"},
          {"time_s", c.time_s},
          {"file", c.file},
          {"sha256", c.sha256, "checkpoint", c.sha256.substr(0, 12)},
          {"state_hash", c.state_hash, "state", c.state_hash.substr(0, 12)},
          {"size", c.size, "size", format_bytes(static_cast<double>(c.size))},
          {"state", name_of(c.state), "",
           std::string(c.state == CheckpointState::recorded ? "" : name_of(c.state))},
          {"observables", c.observables}};
}

/// `asked_by`: indices of the memberships whose figures and tables have the checkpoint; empty if
/// only an interruption or another experiment's cadence left it.
std::vector<Facts> facts_of_all(const Store& store, const Stage& run,
                                const std::vector<CheckpointRecord>& checkpoints) {
  std::map<std::uint64_t, std::vector<std::size_t>> asked_by;
  for (std::size_t k = 0; k < run.asks.size(); ++k) {
    for (const CheckpointRecord& c : checkpoints_for(store, run, run.asks[k], {})) {
      asked_by[c.step].push_back(k);
    }
  }
  return rows_of(checkpoints, [&](const CheckpointRecord& c) {
    Facts facts = checkpoint_facts(c);
    facts.push_back({"asked_by", asked_by[c.step]});
    return facts;
  });
}

// The engine that the latest attempt recorded; null for our own.
nlohmann::json engine_of_run(const Store& store, const std::string& run) {
  nlohmann::json engine;
  const RunLineage stage = run_lineage(store, run).back();
  for (const Attempt& attempt : stage.attempts) {
    if (attempt.host.contains("engine")) engine = attempt.host["engine"];
  }
  return engine;
}

using CheckpointFacts = std::vector<std::pair<TableColumn, nlohmann::json>>;

/// The same values as in `table`; measured now if they are not cached.
CheckpointFacts facts_at(const Store& store, const CheckpointRecord& record, Context& context) {
  MeasuredCheckpoints found;
  try {
    found = measure_checkpoints(store, {&record, 1}, table_providers(), {});
  } catch (const AnalysisError& problem) {  // a failed run may leave such a state
    print_stderr("not measured: {}\n", problem.what());
    MeasureSources sources(store);
    sources.read_run(record.run);
    Measures recorded;
    sources.add_recorded(record, recorded);
    return facts_of(record, recorded);
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

nlohmann::json run_facts(const Store& store, const Stage& run,
                         const std::vector<CheckpointRecord>& checkpoints, Context& context) {
  const auto member = [&](const Ask& m) -> nlohmann::json {
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
          {"memberships", json_list(run.asks, member)},
          {"checkpoints", to_json(facts_of_all(store, run, checkpoints))},
          {"measures", as_json(newest_measures(store, checkpoints, context))},
          {"error", run.error},
          {"ended", end_of(run)}};
}

void print_run(const Store& store, const Stage& run) {
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
  for (const Ask& m : run.asks) {
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

void show_run(const Store& store, const Stage& run, Context& context) {
  const std::vector<CheckpointRecord> checkpoints = store.checkpoints(run.id, Listed::all);
  if (context.json) return print_json(run_facts(store, run, checkpoints, context));
  print_run(store, run);
  print_text("\n");
  print_resolved(run.resolved);
  print_text("\n");
  print_table(rows_of(checkpoints, checkpoint_facts));
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
  if (context.json) return print_json(to_json(checkpoint_facts(record)));
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
    nlohmann::json all = to_json(checkpoint_facts(record));
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

// --- Figures and their files ---

// Escapes a recorded text and cuts it to the rest of the terminal's line; in a pipe it stays whole.
std::string cut(const std::string& text, std::size_t used) {
  const std::string shown = without_controls(text);
  const std::size_t width = terminal_columns(stdout).value_or(std::string::npos);
  const std::size_t left = width > used + 3 ? width - used : 4;
  if (characters(shown) <= left) return shown;
  return std::string(first_characters(shown, left - 3)) + "...";
}

// "2026-11-20T21:40:51.123Z" as "2026-11-20 21:40:51".
std::string moment(const std::string& utc) {
  std::string text = utc.substr(0, 19);
  std::replace(text.begin(), text.end(), 'T', ' ');
  return text;
}

// Numbers builds and hosts, so that the lines of attempts stay short.
class Makers {
 public:
  /// "build 1, host 1".
  std::string number(const nlohmann::json& host) {
    const Maker maker = maker_of(host);
    Row build = {maker.program, maker.flags};
    if (!maker.libraries.empty())
      build.push_back(fmt::format("{}", fmt::join(maker.libraries, ", ")));
    return fmt::format("build {}, host {}", number(builds_, build),
                       number(hosts_, {maker.host + ", " + maker.system, maker.machine}));
  }
  void print() const {
    for (const auto& [what, all] : {std::pair("build", &builds_), {"host", &hosts_}}) {
      for (std::size_t k = 0; k < all->size(); ++k) {
        std::string name = fmt::format("{} {}", what, k + 1);
        for (const std::string& line : all->at(k)) {
          print_text("{:<9} {}\n", std::exchange(name, ""), cut(line, 10));
        }
      }
    }
  }

 private:
  static std::size_t number(std::vector<Row>& known, const Row& lines) {
    const auto found = std::ranges::find(known, lines);
    const auto place = static_cast<std::size_t>(found - known.begin());
    if (found == known.end()) known.push_back(lines);
    return place + 1;
  }
  std::vector<Row> builds_, hosts_;  // lines to print
};

void print_manifests(const FigureLineage& lineage) {
  for (const ManifestText& manifest : lineage.manifests) {
    print_text("\nmanifest  {}\n  sha256  {}\n", cut(manifest.path, 10), manifest.sha256);
    std::map<int, std::string> lines;
    for (const FigureInput& input : lineage.inputs) {
      if (input.manifest != manifest.sha256) continue;
      for (const ManifestLine& line : input.lines) lines.emplace(line.line, line.text);
    }
    for (const auto& [number, text] : lines) {
      print_text("  line {:>4}  {}\n", number, cut(text, 13));
    }
  }
}

void print_attempts(const RunLineage& stage, Makers& makers) {
  for (std::size_t a = 0; a < stage.attempts.size(); ++a) {
    const Attempt& attempt = stage.attempts[a];
    print_text("  attempt {:<3} {}  {}, {}\n", a + 1, moment(attempt.started_at),
               name_of(attempt.outcome), makers.number(attempt.host));
    if (!attempt.why.empty()) print_text("              {}\n", cut(attempt.why, 14));
    if (!attempt.from_checkpoint.empty()) {
      print_text("  from        {}\n", attempt.from_checkpoint);
    }
  }
}

void print_checkpoints(const std::vector<std::string>& checkpoints, const RunLineage& run) {
  print_text("  {:>6}  {:>2}  checkpoint\n", "cycle", "at");
  for (const std::string& sha256 : checkpoints) {
    const CheckpointHistory* known = run.find(sha256);
    const bool has_attempt = known != nullptr && known->attempt;
    print_text("  {:>6}  {:>2}  {}\n",
               known != nullptr ? fmt::format("{:g}", known->record.cycle) : "?",
               has_attempt ? std::to_string(*known->attempt + 1) : "?", sha256);
  }
}

void print_input(const FigureInput& input, const RunLineage& run, bool list, Makers& makers) {
  std::set<int> numbers;
  for (const ManifestLine& line : input.lines) numbers.insert(line.line);
  const std::string lines = numbers.empty() ? "?" : fmt::format("{}", fmt::join(numbers, ", "));
  print_text("\nrun       {}\n", input.run);
  print_text("  {}\n", cut(fmt::format("{} {}, seed {}, {} grains; manifest {:.8}, lines {}",
                                       input.experiment, input.variant, input.seed,
                                       run.stage.grains, input.manifest, lines),
                           2));
  if (input.overrides.is_object()) {
    for (const auto& [key, values] : input.overrides.items()) {
      print_text("  {}\n", cut(fmt::format("given at the command line: {} {} (manifest: {})", key,
                                           text_at(values, "run"), text_at(values, "manifest")),
                               2));
    }
  }
  print_attempts(run, makers);
  print_text("  cycles      {}: {}, {}\n", cut(to_text(input.states.cycles), 40),
             counted(input.checkpoints.size(), "checkpoint"),
             input.fault.empty() ? "with the states that the figure names" : input.fault);
  print_text("  last state  {}\n", cut(input.states.state_hash, 14));
  if (list) print_checkpoints(input.checkpoints, run);
}

void print_stage_before(const RunLineage& stage, bool list, Makers& makers) {
  print_text("\nbefore    {}\n  {}, seed {}, {} grains\n", stage.stage.id,
             cut(stage.stage.kind, 50), text_at(stage.stage.resolved, "seed"), stage.stage.grains);
  print_attempts(stage, makers);
  if (!list) return;
  std::vector<std::string> checkpoints;
  for (const CheckpointHistory& c : stage.checkpoints) {
    if (c.record.state != CheckpointState::rejected) checkpoints.push_back(c.record.sha256);
  }
  print_checkpoints(checkpoints, stage);
}

// `list`: every checkpoint.
void print(const FigureLineage& lineage, bool list) {
  Makers makers;
  print_text(
      "figure    {}, {} scale, analysis version {}\n", cut(lineage.record.name, 40),
      cut(scale_name(lineage.scale), 50),
      cut(lineage.analysis_version.is_null() ? "unknown" : short_text(lineage.analysis_version),
          70));
  print_text("made      {} UTC, event {}{}\n", moment(lineage.record.recorded_at),
             lineage.record.seq,
             lineage.made.is_object() ? ", " + makers.number(lineage.made) : "");
  std::size_t widest = 0;
  for (const auto& [name, sha256] : lineage.outputs) {
    widest = std::max(widest, cut(name, 66).size());
  }
  for (const auto& [name, sha256] : lineage.outputs) {
    print_text("  {:<{}}  {}\n", cut(name, 66), widest, sha256);
  }
  print_manifests(lineage);
  for (const FigureInput& input : lineage.inputs) {
    print_input(input, lineage.runs.at(input.run), list, makers);
  }
  for (const auto& [id, stage] : lineage.runs) {
    if (std::ranges::count(lineage.inputs, id, &FigureInput::run) == 0) {
      print_stage_before(stage, list, makers);
    }
  }
  print_text("\n");
  makers.print();
}

nlohmann::json check_json(const std::filesystem::path& file, const PublishedFile& found,
                          const std::vector<InputFault>& faults, std::size_t inputs) {
  const auto fault_facts = [](const InputFault& fault) -> nlohmann::json {
    return {{"run", fault.run}, {"checkpoint", fault.checkpoint}, {"what", fault.what}};
  };
  return {{"file", file.string()},
          {"sha256", found.sha256},
          {"recorded_sha256", found.recorded},
          {"verdict", found.matches() ? "matches" : "changed"},
          {"inputs", inputs},
          {"input_faults", json_list(faults, fault_facts)}};
}

void print_check(const std::filesystem::path& file, const PublishedFile& found,
                 const std::vector<InputFault>& faults, std::size_t inputs) {
  print_text("file      {}\n", cut(file.string(), 10));
  if (found.matches()) {
    print_text("verdict   matches what event {} recorded\n", found.record.seq);
  } else {
    print_text("verdict   WAS CHANGED since event {}, or another store made it\n",
               found.record.seq);
    print_text("  is      {}\n  was     {}\n", found.sha256, found.recorded);
  }
  if (faults.empty()) {
    print_text("inputs    {}, all present and right\n\n", counted(inputs, "checkpoint"));
    return;
  }
  const auto pruned = std::ranges::count(faults, "pruned", &InputFault::what);
  const auto changed = std::ssize(faults) - pruned;
  print_text("inputs    {}: {} present and right{}{}\n", counted(inputs, "checkpoint"),
             inputs - faults.size(), pruned > 0 ? fmt::format(", {} pruned", pruned) : "",
             changed > 0 ? fmt::format(", {} missing or changed", changed) : "");
  for (const InputFault& fault : faults) {
    print_text("  {}\n  {}\n", fault.checkpoint.empty() ? "run " + fault.run : fault.checkpoint,
               fault.what);
  }
  print_text("\n");
}

void show_figure(const Store& store, const FigureRecord& record, bool list, Context& context) {
  const FigureLineage lineage = figure_lineage(store, record);
  const auto is_right = [](const FigureInput& input) { return input.fault.empty(); };
  if (!std::ranges::all_of(lineage.inputs, is_right)) fail(context, kStoreDamaged);
  if (context.json) return print_json(to_json(lineage));
  print(lineage, list);
}

// Compares a figure's file and its inputs with the store's records.
void show_published(const Store& store, const std::filesystem::path& file, bool list,
                    Context& context) {
  const auto found = find_published(store, file);
  if (!found) {
    throw NotFound(
        file.string() +
        ": unknown to this store: no figure that it recorded has a file with these bytes "
        "or of this name; name the right store with --store");
  }
  const FigureLineage lineage = figure_lineage(store, found->record);
  const std::vector<InputFault> faults = check_inputs(store, lineage);
  // A pruned checkpoint is not damage.
  const bool damaged =
      std::ranges::any_of(faults, [](const InputFault& f) { return f.what != "pruned"; });
  if (damaged || !found->matches()) fail(context, kStoreDamaged);
  std::size_t inputs = 0;
  for (const FigureInput& input : lineage.inputs) inputs += input.checkpoints.size();
  if (context.json) {
    nlohmann::json all = to_json(lineage);
    all["check"] = check_json(file, *found, faults, inputs);
    return print_json(all);
  }
  print_check(file, *found, faults, inputs);
  print(lineage, list);
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

void show(const std::string& name, bool list, Context& context) {
  const Store store(context.store, Access::read);
  if (const auto figure = find_record(store, name))
    return show_figure(store, *figure, list, context);
  require_not_undrawn(name);
  // Ids of runs and checkpoints have no dot or slash.
  if (name.find_first_of("./") != std::string::npos)
    return show_published(store, name, list, context);
  if (name.size() >= 4) {
    if (const auto checkpoint = store.find_checkpoint(name)) {
      for (const Stage& run : store.stages()) {
        if (!run.id.starts_with(name)) continue;
        throw NotFound(
            fmt::format("a run and a checkpoint begin with '{}'; give more digits of one of\n"
                        "  run {}\n  checkpoint {}",
                        name, run.id, checkpoint->sha256));
      }
      return show_checkpoint(store, *checkpoint, context);
    }
  }
  show_run(store, store.find_stage(name), context);
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
  auto list = std::make_shared<bool>(false);
  command->add_flag("--checkpoints", *list, "List every checkpoint behind a figure");
  add_common_options(*command, context);
  command->footer(
      R"(For a figure: prints its files, manifest lines, runs, seeds, attempts, builds, hosts and
cycles, and checks that the log has the states of which it was made; exit code 4 if not.
For a file (CSV, SVG or lineage): checks that it is what the store recorded and that every
checkpoint behind it is intact; exit code 4 if not. Pruned checkpoints are counted and are not
an error.
With --json, `parameters` of a run are those that affect it; `resolved` is the stored record,
whose hash is the run's id, and has fixed values for some that do not (max_overlap_diameters).
Examples:
  shearcell show 3f9a
  shearcell show drag/smoke/S2
  shearcell show figures/drag/smoke/S2a.csv)");
  command->callback([name, list, &context] { show(*name, *list, context); });
}

}  // namespace shearcell::cli
