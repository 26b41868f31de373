// SPDX-License-Identifier: GPL-3.0-or-later
// `show`: prints all that the store records about a run, checkpoint, figure or published file.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <ranges>
#include <set>
#include <utility>
#include <vector>

#include "experiments/cli/command.hpp"
#include "experiments/figures/lineage.hpp"
#include "experiments/figures/run_table.hpp"
#include "experiments/manifest/document.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/manifest/shipped.hpp"
#include "experiments/manifest/suggest.hpp"
#include "experiments/runner/outlook.hpp"
#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"
#include "provenance/words.hpp"

namespace shearcell::cli {
namespace {

Facts facts_of(const CheckpointRecord& c) {
  return {{"run", c.run},
          {"cycle", c.cycle, "cycle", fmt::format("{:g}", c.cycle)},
          {"step", c.step, "step"},
          {"time_s", c.time_s},
          {"file", c.file},
          {"sha256", c.sha256, "checkpoint", c.sha256.substr(0, 12)},
          {"state_hash", c.state_hash, "state", c.state_hash.substr(0, 12)},
          {"size", c.size, "size", format_bytes(c.size)},
          {"state", name_of(c.state), "",
           std::string(c.state == CheckpointState::recorded ? "" : name_of(c.state))},
          {"observables", c.observables}};
}

/// Facts of the checkpoints. `asked_by` lists the experiments whose figures and tables use the
/// checkpoint, as indices in `memberships`. It is empty if no experiment uses the checkpoint, for
/// example if the checkpoint was stored because the run was interrupted.
std::vector<Facts> facts_of_all(const Store& store, const Stage& stage,
                                const std::vector<CheckpointRecord>& checkpoints) {
  std::map<std::uint64_t, std::vector<std::size_t>> asked_by;
  for (std::size_t k = 0; k < stage.memberships.size(); ++k) {
    for (const CheckpointRecord& c :
         checkpoints_for(store, stage, {&stage.memberships[k].ask, 1})) {
      asked_by[c.step].push_back(k);
    }
  }
  return list_of(checkpoints, [&](const CheckpointRecord& c) {
    Facts facts = facts_of(c);
    facts.push_back({"asked_by", asked_by[c.step]});
    return facts;
  });
}

/// The measures of the checkpoint, under the column names of `shearcell table`. Measures that are
/// not cached are computed. The file of a checkpoint in the state `recorded` is checked even if all
/// measures are cached.
Facts measures_at(const Store& store, const CheckpointRecord& record, Context& context) {
  CheckpointMeasures one{record};
  const ToMeasure todo{&one};
  MeasureOutcome outcome = measure_checkpoints(store, {&todo, 1}, table_providers(), {});
  if (record.state == CheckpointState::recorded) {
    outcome += read_in_parallel(1, 1, [&](std::size_t) { store.load_checkpoint(record); }, {});
  }
  print_problems(outcome, one.lacking.empty() ? "damaged" : "not measured", context);
  Facts facts;
  for (const auto& [column, known] : facts_of(record, one.measures)) {
    const nlohmann::json value = json_of(known);
    Fact& fact = facts.emplace_back(Fact{column.name, value});
    if (!value.is_number()) continue;
    fact.heading = column.name;
    fact.text = fmt::format("{:<12.6g} {}", value.get<double>(), column.meaning);
  }
  return facts;
}

Facts newest_measures(const Store& store, const std::vector<CheckpointRecord>& checkpoints,
                      Context& context) {
  for (auto c = checkpoints.rbegin(); c != checkpoints.rend(); ++c) {
    if (c->state != CheckpointState::rejected) return measures_at(store, *c, context);
  }
  return {};
}

/// The engine of the last attempt that recorded an engine; null if shearcell computed the run.
nlohmann::json engine_of_run(const Store& store, const std::string& run) {
  nlohmann::json engine;
  const RunLineage stage = run_lineage(store, run).back();
  for (const Attempt& attempt : stage.attempts) {
    if (attempt.host.contains("engine")) engine = attempt.host["engine"];
  }
  return engine;
}

/// One line for each manifest value that an option of the command line replaced.
std::vector<std::string> describe(const nlohmann::json& overrides) {
  std::vector<std::string> lines;
  for (const auto& [key, values] : overrides.items()) {
    lines.push_back(fmt::format("given at the command line: {} {} (manifest: {})", key,
                                text_at(values, "run"), text_at(values, "manifest")));
  }
  return lines;
}

Facts facts_of(const Store& store, const Stage& stage) {
  const nlohmann::json engine = engine_of_run(store, stage.id), ended = end_of(stage);
  nlohmann::json places = nlohmann::json::array();
  std::string places_text;
  for (const auto& [place, ask, newest] : stage.memberships) {
    const nlohmann::json overrides = overrides_of(store, stage, place, ask);
    places.push_back({{"experiment", place.experiment},
                      {"scale", scale_name(place.scale)},
                      {"variant", place.variant},
                      {"seed", place.seed},
                      {"target_cycles", ask.target_cycles},
                      {"manifest", place.manifest},
                      {"overrides", overrides}});
    places_text +=
        fmt::format("{}{}: {}, seed {}, manifest {:.8}\n", place.experiment, at_scale(place.scale),
                    variant_in_words(place.variant), place.seed, place.manifest);
    for (const std::string& line : describe(overrides)) places_text += line + "\n";
  }
  return {
      {"id", stage.id, "run"},
      {"kind", stage.kind, "kind"},
      {"parent", stage.parent, "parent", stage.parent.empty() ? "-" : stage.parent},
      {"state", name_of(stage.state), "state",
       fmt::format("{}, cycle {:g} of {}, {}", name_of(stage.state), stage.cycle,
                   stage.target_cycles, counted(stage.attempts, "attempt"))},
      {"engine", engine, "engine",
       engine.is_object() ? fmt::format("{} {}, processes: {}", text_at(engine, "name"),
                                        text_at(engine, "version"), text_at(engine, "processes"))
                          : ""},
      {"error", stage.error, "error"},
      {"ended", ended, "ended", describe_end(ended)},
      {"memberships", places, "part of", places_text},
      {"attempts", stage.attempts},
      {"resolved", stage.resolved},
      {"parameters", effective_parameters(stage.resolved)}};
}

/// The inputs of the run. The hash of the inputs is the id of the run. Parameters without effect on
/// the run are left out.
Facts facts_of_id(const Stage& stage) {
  Facts facts;
  for (const auto& [key, value] : stage.resolved.items()) {
    if (key != "parameters") facts.push_back({"", value, key, value.dump()});
  }
  const nlohmann::json parameters = effective_parameters(stage.resolved);
  for (const auto& [key, value] : parameters.items()) {
    facts.push_back({"", value, key, value.dump()});
  }
  return facts;
}

void show_run(const Store& store, const Stage& stage, Context& context) {
  const std::vector<CheckpointRecord> records = store.checkpoints(stage.id, Listed::all);
  const Facts facts = facts_of(store, stage), measures = newest_measures(store, records, context);
  if (context.json) {
    nlohmann::json all = to_json(facts);
    all["checkpoints"] = to_json(facts_of_all(store, stage, records));
    all["measures"] = to_json(measures);
    return print_json(all);
  }
  print_lines(facts);
  print_text("\n");
  print_lines(facts_of_id(stage));
  print_text("\n");
  print_table(list_of(records, [](const CheckpointRecord& c) { return facts_of(c); }));
  if (!measures.empty()) print_text("\nnewest checkpoint:\n");
  print_lines(measures);
}

/// Prints the checkpoint and its measures. If the file was pruned, the measures must be cached.
void show_checkpoint(const Store& store, const CheckpointRecord& record, Context& context) {
  const bool pruned = record.state == CheckpointState::pruned;
  Facts more;
  if (!pruned) {
    const Checkpoint checkpoint = store.load_checkpoint(record);
    const Eigen::Index grains = checkpoint.state.position.cols();
    const std::size_t wall_grains = checkpoint.cell.wall_grains.size();
    more = {
        {"grains", grains, "grains", fmt::format("{}, and {} wall grains", grains, wall_grains)},
        {"wall_grains", wall_grains}};
  }
  const Facts measures = measures_at(store, record, context);
  const std::string file =
      pruned ? fmt::format("pruned; `shearcell regenerate {:.12}` recomputes it", record.sha256)
             : fmt::format("{} ({}, hash verified)", record.file, format_bytes(record.size));
  Facts facts = {
      {"sha256", record.sha256, "checkpoint"},
      {"state_hash", record.state_hash, "state"},
      {"run", record.run, "run"},
      {"file", record.file, "file", file},
      {"cycle", record.cycle, "time",
       fmt::format("cycle {:g}, step {}, {:.6g} s", record.cycle, record.step, record.time_s)}};
  facts.insert(facts.end(), more.begin(), more.end());
  if (!context.json) {
    print_lines(facts);
    return print_lines(measures);
  }
  nlohmann::json all = to_json(facts_of(record));
  all.update(to_json(facts));
  all["measures"] = to_json(measures);
  print_json(all);
}

template <typename... Arguments>
void say(std::string_view heading, fmt::format_string<Arguments...> format,
         Arguments&&... arguments) {
  const std::string text = fmt::format(format, std::forward<Arguments>(arguments)...);
  print_text("{}\n", without_controls(fmt::format("{:<12} {}", heading, text)));
}

// Numbers the builds and hosts. An attempt is printed with these numbers instead of long texts.
class Makers {
  using Lines = std::vector<std::string>;

 public:
  std::string number(const nlohmann::json& host) {
    const Maker maker = maker_of(host);
    return name("build",
                {maker.program, maker.flags, fmt::format("{}", fmt::join(maker.libraries, ", "))}) +
           ", " + name("host", {maker.host + ", " + maker.system, maker.machine});
  }
  void print() const {
    for (const auto& [what, all] : known_) {
      for (std::size_t k = 0; k < all.size(); ++k) {
        std::string name = fmt::format("{} {}", what, k + 1);
        for (const std::string& line : all[k]) {
          if (!line.empty()) say(std::exchange(name, ""), "{}", line);
        }
      }
    }
  }

 private:
  std::string name(const std::string& what, const Lines& lines) {
    std::vector<Lines>& known = known_[what];
    const auto found = std::ranges::find(known, lines);
    const auto place = found - known.begin();
    if (found == known.end()) known.push_back(lines);
    return fmt::format("{} {}", what, place + 1);
  }
  std::map<std::string, std::vector<Lines>> known_;  // keys: "build" and "host"
};

void print_manifests(const FigureLineage& lineage) {
  for (const ManifestText& manifest : lineage.manifests) {
    print_text("\n");
    say("manifest", "{}", manifest.path);
    say("  sha256", "{}", manifest.sha256);
    std::map<int, std::string> lines;
    for (const FigureInput& input : lineage.inputs) {
      if (input.manifest != manifest.sha256) continue;
      for (const ManifestLine& line : input.lines) lines.emplace(line.line, line.text);
    }
    for (const auto& [number, text] : lines) say(fmt::format("  line {:>4}", number), "{}", text);
  }
}

void print_stage(const RunLineage& stage, const std::vector<std::string>& checkpoints, bool list,
                 Makers& makers) {
  std::size_t number = 0;
  for (const Attempt& attempt : stage.attempts) {
    say(fmt::format("  attempt {}", ++number), "{:.19}  {}, {}", attempt.started_at,
        name_of(attempt.outcome), makers.number(attempt.host));
    if (!attempt.why.empty()) say("", "{}", attempt.why);
    if (!attempt.from_checkpoint.empty()) say("  from", "{}", attempt.from_checkpoint);
  }
  if (!list) return;
  print_text("  {:>6}  {:>2}  checkpoint\n", "cycle", "at");
  for (const std::string& sha256 : checkpoints) {
    const CheckpointHistory* known = stage.find(sha256);
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
  print_text("\n");
  say("run", "{}", input.run);
  say("  of", "{} {}, seed {}, {} grains; manifest {:.8}, lines {}", input.experiment,
      variant_in_words(input.variant), input.seed, run.stage.grains, input.manifest, lines);
  for (const std::string& given : describe(input.overrides)) say("", "{}", given);
  say("  cycles", "{}: {}, {}", to_text(input.states.cycles),
      counted(input.checkpoints.size(), "checkpoint"),
      input.fault.empty() ? "whose states match the figure's record" : input.fault);
  say("  last state", "{}", input.states.state_hash);
  print_stage(run, input.checkpoints, list, makers);
}

void print(const FigureLineage& lineage, bool list) {
  Makers makers;
  const nlohmann::json& recorded = lineage.record.provenance;
  const nlohmann::json made = member_of(recorded, "made");
  say("figure", "{}, analysis version {}", lineage.record.name,
      text_at(recorded, "analysis_version"));
  say("made", "{:.19} UTC, event {}{}", lineage.record.recorded_at, lineage.record.seq,
      made.is_object() ? ", " + makers.number(made) : "");
  if (!lineage.plots.empty()) say("  plots", "{}", lineage.plots);
  for (const auto& [name, sha256] : lineage.outputs) say("  file", "{}  {}", sha256, name);
  print_manifests(lineage);
  for (const FigureInput& input : lineage.inputs) {
    print_input(input, lineage.runs.at(input.run), list, makers);
  }
  for (const auto& [id, stage] : lineage.runs) {
    if (std::ranges::count(lineage.inputs, id, &FigureInput::run) > 0) continue;
    print_text("\n");
    say("before", "{}", id);
    say("  of", "{}, seed {}, {} grains", stage.stage.kind, text_at(stage.stage.resolved, "seed"),
        stage.stage.grains);
    std::vector<std::string> checkpoints;
    for (const CheckpointHistory& c : stage.checkpoints) {
      if (c.record.state != CheckpointState::rejected) checkpoints.push_back(c.record.sha256);
    }
    print_stage(stage, checkpoints, list, makers);
  }
  print_text("\n");
  makers.print();
}

void show(const FigureLineage& lineage, const Facts& check, bool list, const Context& context) {
  if (context.json) {
    nlohmann::json all = to_json(lineage);
    if (!check.empty()) all["check"] = to_json(check);
    return print_json(all);
  }
  print_lines(check);
  if (!check.empty()) print_text("\n");
  print(lineage, list);
}

void show_figure(const Store& store, const FigureRecord& record, bool list, Context& context) {
  const FigureLineage lineage = figure_lineage(store, record);
  const auto is_right = [](const FigureInput& input) { return input.fault.empty(); };
  if (!std::ranges::all_of(lineage.inputs, is_right)) fail(context, kStoreDamaged);
  show(lineage, {}, list, context);
}

Facts facts_of(const std::filesystem::path& file, const PublishedFile& found,
               const std::vector<Finding>& faults, std::size_t inputs) {
  std::size_t changed = 0, pruned = 0;  // checkpoints
  for (const Finding& fault : faults) {
    if (!fault.subject.empty()) ++(fault.severity == Finding::Severity::error ? changed : pruned);
  }
  nlohmann::json list = nlohmann::json::array();
  std::string text =
      faults.empty()
          ? fmt::format("{}, all present and unchanged", counted(inputs, "checkpoint"))
          : fmt::format("{}: {} present and unchanged{}{}", counted(inputs, "checkpoint"),
                        inputs - changed - pruned,
                        pruned > 0 ? fmt::format(", {} pruned", pruned) : "",
                        changed > 0 ? fmt::format(", {} missing or changed", changed) : "");
  for (const auto& [severity, checkpoint, run, what] : faults) {
    list.push_back({{"run", run}, {"checkpoint", checkpoint}, {"what", what}});
    text += fmt::format("\n{}\n{}", checkpoint.empty() ? "run " + run : checkpoint, what);
  }
  const bool matches = found.matches();
  return {{"file", file.string(), "file"},
          {"verdict", matches ? "matches" : "changed", "verdict",
           fmt::format("{} event {}{}", matches ? "matches what" : "WAS CHANGED since",
                       found.record.seq,
                       matches ? " recorded" : ", or the file is from another store")},
          {"sha256", found.sha256, "is", matches ? "" : found.sha256},
          {"recorded_sha256", found.recorded, "was", matches ? "" : found.recorded},
          {"inputs", inputs, "inputs", text},
          {"input_faults", list}};
}

// Compares a figure's file, and the checkpoints used for the figure, with the store's records.
void show_published(const Store& store, const std::filesystem::path& file, bool list,
                    Context& context) {
  const auto found = find_published(store, file);
  if (!found) {
    throw NotFound(
        file.string() +
        ": this store has no record of the file. No figure of the store has a file with these "
        "bytes or this name. If the file is from another store, use --store to open that store");
  }
  const FigureLineage lineage = figure_lineage(store, found->record);
  const std::vector<Finding> faults = check_inputs(store, lineage);
  const bool damaged = std::ranges::count(faults, Finding::Severity::error, &Finding::severity) > 0;
  if (damaged || !found->matches()) fail(context, kStoreDamaged);
  std::size_t inputs = 0;
  for (const FigureInput& input : lineage.inputs) inputs += input.checkpoints.size();
  show(lineage, facts_of(file, *found, faults, inputs), list, context);
}

// Returns the newest record of a figure, such as "drag/desk/S2". Short names, such as "drag/S2" and
// "S2", are accepted if only one figure fits. Throws NotFound if several figures fit.
std::optional<FigureRecord> find_record(const Store& store, const std::string& name) {
  std::map<std::string, FigureRecord> found;  // by path
  for (FigureRecord& figure : store.figures()) {
    const std::string path = figure_path(figure), last = figure_name(figure);
    const std::string experiment = path.substr(0, path.find('/') + 1);
    if (name != path && name != figure.name && name != experiment + last && name != last) continue;
    const auto [known, first] = found.try_emplace(path, figure);
    if (!first && known->second.seq < figure.seq) known->second = std::move(figure);
  }
  if (found.empty()) return std::nullopt;
  if (found.size() > 1) {
    throw NotFound(fmt::format("several figures are called {}: {}", name,
                               fmt::join(std::views::keys(found), ", ")));
  }
  return std::move(found.begin()->second);
}

/// Throws NotFound if `name` is the name of an experiment, or is similar to the name of an
/// experiment or of a drawn figure. (`show` cannot show experiments.)
void require_no_name(const Store& store, const std::string& name,
                     const std::vector<Stage>& stages) {
  std::set<std::string> known;
  for (const Stage& stage : stages) {
    for (const Membership& m : stage.memberships) known.insert(m.place.experiment);
  }
  if (known.contains(name)) {
    throw NotFound(fmt::format(
        "{0} is an experiment, but `show` needs a run, checkpoint or figure. Use `shearcell status "
        "--experiment {0}` to list its runs, or pass --experiment {0} to `table` or `figures`",
        name));
  }
  for (const FigureRecord& figure : store.figures()) known.insert(figure_name(figure));
  const std::vector<std::string_view> names(known.begin(), known.end());
  if (suggest_name(name, names).empty()) return;
  throw NotFound(
      fmt::format("the store has no run or figure '{}'; {}", name, did_you_mean(name, names)));
}

struct ShowOptions {
  std::string name;
  bool list = false;  ///< whether to list every checkpoint that a figure uses
};

void show(const ShowOptions& options, Context& context) {
  const auto& [name, list] = options;
  const Store store(context.store, Access::read);
  if (const auto figure = find_record(store, name))
    return show_figure(store, *figure, list, context);
  const std::string last = std::filesystem::path(name).filename().string();
  if (find_figure(last) != nullptr && !std::filesystem::exists(name)) {
    throw NotFound(
        fmt::format("figure {} has not been drawn; run `shearcell figures {}`", name, last));
  }
  // A name with a dot or a slash is a file, since ids of runs and checkpoints have neither.
  if (name.find_first_of("./") != std::string::npos)
    return show_published(store, name, list, context);
  const std::vector<Stage> stages = store.stages();
  const auto run =
      std::ranges::find_if(stages, [&](const Stage& stage) { return stage.id.starts_with(name); });
  const auto checkpoint = name.size() < 4 ? std::nullopt : store.find_checkpoint(name);
  if (checkpoint && run != stages.end()) {
    throw NotFound(fmt::format(
        "the id of a run and the hash of a checkpoint begin with '{}'; give more digits\n  run "
        "{}\n  checkpoint {}",
        name, run->id, checkpoint->sha256));
  }
  if (checkpoint) return show_checkpoint(store, *checkpoint, context);
  if (run == stages.end()) require_no_name(store, name, stages);
  show_run(store, store.find_stage(name), context);
}

}  // namespace

void add_show(CLI::App& app, Context& context) {
  const auto [command, options] =
      add_command(app, context, "show", "Show one run, checkpoint, figure or figure file", show);
  command
      ->add_option("name", options->name,
                   "Run id or checkpoint SHA-256 (or a unique beginning), figure, or figure file")
      ->required();
  command->add_flag("--checkpoints", options->list, "List every checkpoint that a figure uses");
  add_common_options(
      *command, context,
      R"(For a figure: prints its files, manifest lines, runs, seeds, attempts, builds, hosts and cycles.
Checks that the log contains the states from which the figure was made; if not, the exit code is 4.
For a file of a figure (CSV, SVG or lineage): checks that the store recorded a file with these bytes
and that every checkpoint that the file uses is intact; if not, the exit code is 4. Pruned
checkpoints are counted, but they are not an error.
With --json, `parameters` has the parameters that affect the run. `resolved` is the stored record,
whose hash is the run's id. Some parameters that do not affect the run (such as
max_overlap_diameters) have fixed values in this record.
Examples:
  shearcell show 3f9a
  shearcell show drag/smoke/S2
  shearcell show figures/drag/smoke/S2a.csv)");
}

}  // namespace shearcell::cli
