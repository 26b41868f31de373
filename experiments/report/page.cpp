// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/sha.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <ranges>
#include <span>

#include "analysis/plot.hpp"
#include "experiments/figures/collect.hpp"
#include "experiments/figures/draw.hpp"
#include "experiments/figures/lineage.hpp"
#include "experiments/figures/run_table.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/manifest/parameters.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/suggest.hpp"
#include "experiments/manifest/variants.hpp"
#include "experiments/report/html.hpp"
#include "experiments/runner/host.hpp"
#include "experiments/runner/outlook.hpp"
#include "experiments/runner/registered.hpp"
#include "provenance/errors.hpp"
#include "provenance/io/file.hpp"
#include "provenance/json_text.hpp"
#include "provenance/sha256.hpp"
#include "provenance/words.hpp"

// The HTML template, style, script and licences of the page, embedded by web_assets.S.
extern "C" {
extern const char shearcell_page[], shearcell_page_end[];
extern const char shearcell_style[], shearcell_style_end[];
extern const char shearcell_script[], shearcell_script_end[];  // empty if built without Node
extern const char shearcell_licences[], shearcell_licences_end[];
}

namespace shearcell {
namespace {

using nlohmann::json;

std::string_view front_end_script() {
  return {shearcell_script, shearcell_script_end};
}

struct Experiment {
  RegisteredManifest manifest;           ///< the newest version
  json figures = json::array();          ///< results of figure_json()
  std::vector<Verdict> verdicts = {};    ///< verdicts of all figures
  std::vector<std::string> unmade = {};  ///< names of figures that could not be computed
  std::vector<Stage> runs = {};
  std::set<std::string> scales = {};  ///< names of the scales of `runs`
  RunTable table = {};                ///< a row for each run, except runs that settle packings
};

struct Content {
  const Store& store;
  const ReportOptions& options;
  Report& report;
  std::vector<FigureRecord> records = figure_records(store);
  std::vector<Experiment> experiments = {};
  json across = json::array();   ///< figures that use more than one experiment
  json charts = json::object();  ///< by id of the panel
  RunLineages runs = {};
  std::map<std::string, ManifestText> manifests = {};
  Packings packings = {};
};

/// The hash of the script for a Content-Security-Policy that allows no other script.
std::string script_hash(std::string_view script) {
  unsigned char digest[SHA256_DIGEST_LENGTH];
  SHA256(reinterpret_cast<const unsigned char*>(script.data()), script.size(), digest);
  return "sha256-" + base64(std::as_bytes(std::span(digest)));
}

/// "shearcell 0.1.0 (dd11cbe), GNU 12.2.0 Release; HOST, CPU, 4 cores, AVX-512".
std::string text_of(const Maker& maker) {
  return fmt::format("{}; {}, {}", maker.program, maker.host, maker.machine);
}

json ruling_json(Ruling ruling) {
  const bool good = ruling == Ruling::agrees || ruling == Ruling::supported;
  const bool open = ruling == Ruling::undecided || ruling == Ruling::undecidable;
  const char* mark = open ? "?" : good ? "✓" : "✗";
  return {{"name", name_of(ruling)}, {"mark", mark}};
}

json text_table(const TextTable& table) {
  if (table.rows.empty()) return false;
  json head = json::array(), rows = json::array();
  for (const TextTable::Cell& cell : table.rows.front()) {
    head.push_back({{"html", text_html(cell.text)}});
  }
  for (const std::vector<TextTable::Cell>& row : std::span(table.rows).subspan(1)) {
    json cells = json::array();
    for (const auto& [text, colour] : row) {
      cells.push_back({{"head", head.at(cells.size()).at("html")},
                       {"html", text_html(text)},
                       {"colour", colour == TextTable::Cell().colour ? "" : colour}});
    }
    rows.push_back({{"cells", cells}});
  }
  return {{"head", head}, {"rows", rows}, {"note", text_html(table.note)}};
}

std::string draw(const Table& table) {
  const TemporaryFolder folder;
  constexpr std::size_t most = 64'000'000;
  std::optional<std::string> svg = read_plain(draw_svg(table, folder.path()), most);
  if (!svg) throw AnalysisError(fmt::format("{}.svg is larger than {} bytes", table.name, most));
  return std::move(*svg);
}

/// Describes a panel of a figure. `id`: id of the panel in the page, such as "drag.S2a".
json panel_json(const Table& table, const std::string& id, const ComputedFigure& figure,
                Content& content) {
  const bool interactive = content.report.interactive;
  const bool chart = interactive && !table.chart.series.empty();
  if (chart) content.charts[id] = chart_json(table);
  if (chart && !figure.why_empty.empty()) content.charts[id]["empty"] = figure.why_empty;
  std::string drawing, trouble;
  try {
    if (!interactive && table.text.rows.empty()) drawing = draw(table);
  } catch (const AnalysisError& error) {
    trouble = error.what();
    content.report.undrawn.insert(fmt::format("figure {}{}{}: {}", figure.experiment,
                                              figure.experiment.empty() ? "" : "/", figure.name,
                                              trouble));
  }
  return {{"id", id},
          {"name", table.name},
          {"letter", table.chart.letter},
          {"chart", chart},
          {"drawing", base64(std::as_bytes(std::span(drawing)))},
          {"table", text_table(table.text)},
          {"trouble", trouble},
          {"csv", to_csv(table)}};
}

/// The newest record that equals the lineage of `figure`; `made` and `outputs` are not compared.
std::optional<FigureRecord> recorded_as(std::span<const FigureRecord> records,
                                        const ComputedFigure& figure) {
  for (const FigureRecord& record : records | std::views::reverse) {
    json facts = record.provenance;
    if (!facts.is_object()) continue;
    facts.erase("made");
    facts["outputs"] = json::object();  // figure.lineage lists no outputs
    if (facts == figure.lineage) return record;
  }
  return {};
}

json lineage_json(const FigureLineage& lineage, const ComputedFigure& figure, const json& panels,
                  const std::optional<FigureRecord>& recorded) {
  json facts = to_json(lineage);
  facts.erase("runs");
  std::set<std::string> makers;
  for (const auto& [id, stage] : lineage.runs) {
    for (const Attempt& attempt : stage.attempts) makers.insert(text_of(maker_of(attempt.host)));
  }
  json outputs = json::array();
  for (const json& panel : panels) {
    const std::string file = panel.at("name").get<std::string>() + ".csv";
    const std::string sha256 = sha256_hex(panel.at("csv").get_ref<const std::string&>());
    std::string found;
    if (recorded) {
      const json known = member_of(recorded->provenance, "outputs");
      found = text_at(known, file.c_str()) == sha256 ? ", as recorded" : ", NOT as recorded";
    }
    outputs.push_back({{"file", file}, {"sha256", sha256}, {"found", found}});
  }
  for (json& input : facts["inputs"]) {
    std::set<int> lines;
    for (const json& line : input["manifest_lines"]) lines.insert(line.at("line").get<int>());
    input["lines"] = fmt::format("{}", fmt::join(lines, ", "));
    const auto cycles = input["cycles"].get<Cycles>();
    input["cycles"] =
        cycles.empty() ? "?" : fmt::format("{:g} to {:g}", cycles.front()[0], cycles.back()[1]);
    input["checkpoints"] = input["checkpoints"].size();
  }
  const std::string command = "shearcell figures " + figure.name;
  facts.update(
      {{"amount",
        fmt::format("{}, {}; analysis version {}", counted(figure.runs, "run"),
                    counted(figure.checkpoints, "checkpoint"), text_at(facts, "analysis_version"))},
       {"makers", makers},
       {"outputs", outputs},
       {"recorded",
        recorded ? fmt::format("event {} of {}", recorded->seq, recorded->recorded_at) : ""},
       {"command",
        figure.experiment.empty() ? command : command + " --experiment " + figure.experiment},
       {"record", lineage.record.name}});
  return facts;
}

/// The figure as JSON. Adds to `content` the manifests, charts and notes of the figure, and
/// messages on checkpoints that the figure leaves out.
json figure_json(const WantedFigure& wanted, const ComputedFigure& figure, Content& content) {
  const std::string prefix = wanted.experiment.empty() ? "" : wanted.experiment + ".";
  const FigureLineage lineage =
      figure_lineage(content.store, {wanted.path(), 0, "", figure.lineage});
  for (const ManifestText& manifest : lineage.manifests) {
    content.manifests.try_emplace(manifest.sha256, manifest);
  }
  json panels = json::array(), claims = json::array(), warnings = json::array();
  for (const Table& table : figure.tables) {
    panels.push_back(panel_json(table, prefix + table.name, figure, content));
  }
  for (const Verdict& verdict : figure.verdicts) {
    claims.push_back({{"ruling", ruling_json(verdict.ruling)},
                      {"claim", verdict.text},
                      {"result", result_of(verdict)}});
  }
  for (const auto* list : {&figure.damage, &figure.pruned}) {
    for (const std::string& line : *list) warnings.push_back("Left out: " + line);
  }
  if (figure.caption.empty()) {
    if (!figure.why_empty.empty()) warnings.push_back(figure.why_empty);
    std::ranges::copy(figure.notes, std::back_inserter(warnings));
  }
  content.report += figure;
  content.report.notes.insert(figure.notes.begin(), figure.notes.end());
  return {{"id", prefix + wanted.figure.name},
          {"name", figure.name},
          {"heading",
           fmt::format("{} {}{}{}{}", panels.empty() && !claims.empty() ? "Claim" : "Figure",
                       figure.name, figure.title.empty() ? "" : ". ", figure.title,
                       figure.scale.empty() ? "" : fmt::format(" ({} scale)", figure.scale))},
          {"panels", panels},
          {"caption", figure.caption},
          {"claims", claims},
          {"warnings", warnings},
          {"lineage", lineage_json(lineage, figure, panels, recorded_as(content.records, figure))}};
}

json stage_json(const RunLineage& stage) {
  const Stage& run = stage.stage;
  json facts = to_json(stage);
  json members = json::array();
  for (const Membership& m : run.memberships) {
    const Place& place = m.place;
    members.push_back(
        {{"manifest", place.manifest},
         {"text", fmt::format("{}{}, {}, seed {}", place.experiment, at_scale(place.scale),
                              variant_in_words(place.variant), place.seed)}});
  }
  for (json& attempt : facts["attempts"]) {
    const Maker maker = maker_of(attempt["host"]);
    attempt.update({{"host", text_of(maker)}, {"flags", maker.flags}});
  }
  std::string checkpoints;
  for (const CheckpointHistory& c : stage.checkpoints) {
    checkpoints += fmt::format("cycle {:<8g} {}{}{}\n", c.record.cycle, c.record.sha256,
                               c.kept() ? "" : " ", c.kept() ? "" : name_of(c.record.state));
  }
  json parameters = run.resolved;
  if (parameters.contains("parameters")) {
    parameters["parameters"] = effective_parameters(run.resolved);
  }
  facts.update({{"error", run.error},
                {"state", name_of(run.state)},
                {"members", members},
                {"resolved", parameters.dump()},
                {"checkpoints", checkpoints},
                {"count", counted(stage.checkpoints.size(), "checkpoint")}});
  return facts;
}

struct Count {
  const char* state;
  const char* mark;  ///< symbol of the state, for readers who do not see the colour
  const char* name;
  std::size_t number;
};

/// A box of the workflow: a title, and the number of stages, checkpoints or figures in each state.
json step(const char* title, std::initializer_list<Count> counts) {
  json list = json::array();
  for (const Count& one : counts) {
    if (one.number == 0) continue;
    list.push_back(
        {{"state", one.state}, {"mark", one.mark}, {"name", one.name}, {"number", one.number}});
  }
  return {{"title", title}, {"some", !list.empty()}, {"counts", std::move(list)}};
}

json stages_step(const char* title, std::map<StageState, std::size_t>& in) {
  return step(title, {{"done", "✓", "done", in[StageState::completed]},
                      {"running", "▸", "running", in[StageState::running]},
                      {"stopped", "‖", "interrupted", in[StageState::interrupted]},
                      {"failed", "✗", "failed", in[StageState::failed]},
                      {"waiting", "·", "waiting", in[StageState::declared]}});
}

json workflow(const Content& content, const Experiment& experiment) {
  std::map<StageState, std::size_t> packings, runs;
  std::map<CheckpointState, std::size_t> in;
  std::size_t left = 0;  // upper limit of the number of checkpoints still to be recorded
  for (const Stage& stage : experiment.runs) {
    for (const CheckpointHistory& c : content.runs.at(stage.id).checkpoints) ++in[c.record.state];
    const bool is_packing = stage.kind == name_of(StageKind::prepare);
    ++(is_packing ? packings : runs)[stage.state];
    if (is_packing) continue;  // it will record an unknown number of checkpoints
    std::vector<Ask> asks;
    for (const Membership& m : stage.memberships) {
      if (m.place.experiment == experiment.manifest.experiment) asks.push_back(m.ask);
    }
    const Outlook look =
        outlook(stage, asks, content.store.checkpoints(stage.id, Listed::and_pruned));
    if (!look.done) left += static_cast<std::size_t>(look.checkpoints);
  }
  json figures = step("Figures", {{"done", "✓", "made", experiment.figures.size()},
                                  {"failed", "✗", "cannot be made", experiment.unmade.size()}});
  figures["figures_step"] = true;
  return {stages_step("Packings", packings), stages_step("Runs", runs),
          step("Checkpoints", {{"done", "✓", "stored", in[CheckpointState::recorded]},
                               {"stopped", "‖", "pruned", in[CheckpointState::pruned]},
                               {"failed", "✗", "damaged", in[CheckpointState::rejected]},
                               {"waiting", "·", "or fewer to come", left}}),
          figures};
}

/// The columns that the page shows at first: identifiers, swept parameters, states and results of
/// the runs. Each element describes one column; `at` is its index in the experiment's table.
json columns_of(const Experiment& experiment) {
  const Table& table = experiment.table.table;
  json shown = json::array();
  const auto add = [&](std::string_view key, const std::string& heading, bool numeric = true) {
    const std::size_t at = table.place(key);
    shown.push_back({{"at", at},
                     {"key", key},
                     {"meaning", table.columns.at(at).meaning},
                     {"heading", heading},
                     {"numeric", numeric}});
  };
  const std::size_t seed = table.place("seed"), cycle = table.place("cycle");
  const std::size_t scale = table.place("scale");
  add("run", "run", false);
  const bool differ = std::ranges::any_of(
      table.rows, [&](const TableRow& row) { return row[scale] != table.rows.front()[scale]; });
  if (differ) add("scale", "scale", false);
  // The columns between `seed` and `cycle` are `grains` and the swept parameters.
  const bool labelled = !experiment.manifest.content.labels.empty();
  if (labelled || cycle - seed == 2) add("variant", "variant", false);
  for (std::size_t at = seed + 1; at < cycle; ++at) {
    const Field* field = find_field(table.columns[at].name);
    if (field == nullptr || field->name == "grains") continue;
    std::string name(field->symbol.empty() ? field->name : field->symbol);
    std::ranges::replace(name, '_', ' ');
    const bool unit = !field->symbol.empty() && has_unit(*field);
    const std::string heading = unit ? fmt::format("{} [{}]", name, field->unit) : name;
    add(field->name, heading, !field->unit.empty());
  }
  add("seed", "seed");
  add("grains", "N");
  add("state", "state", false);
  add("cycle", "cycle");
  add("target_cycles", "of");
  add("phi", "ϕ");
  add("crystalline_percent", "crystalline [%]");
  add("largest_crystallite", "largest crystallite");
  add("onset_size_cycle", "onset cycle");
  add("onset_size_phi", "onset ϕ");
  add("wall_time_s", "time [s]");
  add("particle_steps_per_s", "steps/s");
  return shown;
}

json cell_json(const Packings& packings, const TableColumn& column, const TableCell& known) {
  const json value = json_of(known);
  const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  json cell = {{"known", !value.is_null()}, {"value", text},  {"run", false},
               {"packed", false},           {"state", false}, {"text", ""}};
  if (column.name == "run") {
    cell["run"] = text.substr(0, 8);
    cell["packed"] =
        std::ranges::any_of(packings.runs, [&](const json& run) { return run.at("id") == value; });
  } else if (column.name == "state") {
    cell["state"] = text;
  } else if (value.is_number_float()) {
    cell["text"] = fmt::format("{:.4g}", value.get<double>());
  } else if (!value.is_null()) {
    cell["text"] = short_text(value);
  }
  return cell;
}

json run_rows(const Packings& packings, const Experiment& experiment) {
  const Table& table = experiment.table.table;
  if (table.rows.empty()) return false;
  const json columns = columns_of(experiment);
  json rows = json::array();
  for (const TableRow& row : table.rows) {
    json cells = json::array();
    for (const json& column : columns) {
      const std::size_t at = column.at("at");
      cells.emplace_back(column).update(cell_json(packings, table.columns[at], row[at]));
    }
    rows.push_back({{"number", rows.size()}, {"cells", std::move(cells)}});
  }
  return {{"columns", columns}, {"rows", rows}};
}

json experiment_json(const Content& content, const Experiment& experiment) {
  const RegisteredManifest& manifest = experiment.manifest;
  json verdict = json::array();
  for (const auto& [ruling, number] : rulings_of(experiment.verdicts)) {
    verdict.push_back(ruling_json(ruling));
    verdict.back()["number"] = number;
  }
  return {{"experiment", manifest.experiment},
          {"question", manifest.question.empty() ? manifest.experiment : manifest.question},
          {"verdict", verdict},
          {"claimed", !verdict.empty()},
          {"stage_count", experiment.runs.size()},
          {"manifest", {{"sha256", manifest.sha256}, {"path", manifest.path}}},
          {"steps", workflow(content, experiment)},
          {"figures", experiment.figures},
          {"unmade", experiment.unmade},
          {"runs", run_rows(content.packings, experiment)}};
}

/// The experiments, then the figures that use more than one experiment.
json parts_of(const Content& content) {
  json parts = list_of(content.experiments, [&](const Experiment& experiment) {
    return experiment_json(content, experiment);
  });
  if (!content.across.empty()) {
    parts.push_back({{"experiment", false},
                     {"question", "All experiments together"},
                     {"figures", content.across},
                     {"runs", false}});
  }
  return parts;
}

/// The runs in the order of the table's rows: [{id, kind, scale, variant, seed, cycle, phi, ...}].
/// `cycle` and each scalar measure are arrays over the checkpoints, with null for unknown values.
json traces_of(const RunTable& made) {
  const Table& runs = made.table;
  constexpr int significant = 6;
  json all = json::array();
  for (std::size_t k = 0; k < runs.rows.size(); ++k) {
    json& run = all.emplace_back(json::object());
    for (const CheckpointMeasures& checkpoint : made.histories[k].checkpoints) {
      run["cycle"].push_back(checkpoint.cycle);
      for (const Measure& measure : provider(scalars_provider).measures) {
        run[std::string(measure.name)].push_back(
            rounded(checkpoint.measures.number(measure.name), significant));
      }
    }
    const TableRow& row = runs.rows[k];
    for (const char* key : {"scale", "variant", "seed"}) run[key] = json_of(row[runs.place(key)]);
    run["id"] = json_of(row[runs.place("run")]);
    run["kind"] = made.histories[k].stage.kind;
  }
  return all;
}

json script_data(const Content& content) {
  const auto cells_of = [](const TableRow& row) { return list_of(row, json_of); };
  json experiments = json::array();
  for (const Experiment& experiment : content.experiments) {
    const Table& table = experiment.table.table;
    json columns = json::array();
    for (const TableColumn& column : table.columns) {
      const Field* field = find_field(column.name);
      columns.push_back({{"key", column.name},
                         {"meaning", column.meaning},
                         {"symbol", field == nullptr ? "" : field->symbol}});
    }
    experiments.push_back({{"experiment", experiment.manifest.experiment},
                           {"columns", std::move(columns)},
                           {"rows", list_of(table.rows, cells_of)},
                           {"runs", traces_of(experiment.table)}});
  }
  return {{"charts", content.charts},
          {"packings", content.packings.runs},
          {"experiments", std::move(experiments)}};
}

/// The chosen experiments (default: all) in the order of first registration, each with its newest
/// manifest. If scales are chosen, an experiment without a run at these scales is left out.
std::vector<Experiment> experiments_of(const Store& store, const RunSelection& chosen) {
  Filter names(chosen.experiments), scales(chosen.scales);
  std::vector<Experiment> found;
  const std::vector<Stage> stages = store.stages();
  for (RegisteredManifest& manifest : newest_manifests(store)) {
    if (!names.passes(manifest.experiment)) continue;
    Experiment experiment{std::move(manifest)};
    for (const Stage& stage : stages) {
      bool is_chosen = false;
      for (const auto& [place, ask, newest] : stage.memberships) {
        const std::string scale = scale_name(place.scale);
        if (place.experiment != experiment.manifest.experiment || !scales.passes(scale)) continue;
        experiment.scales.insert(scale);
        is_chosen = true;
      }
      if (is_chosen) experiment.runs.push_back(stage);
    }
    if (chosen.scales.empty() || !experiment.runs.empty()) found.push_back(std::move(experiment));
  }
  return found;
}

void add_figures(Content& content) {
  const ReportOptions& options = content.options;
  WantedFigures wanted = wanted_figures(content.store, {}, options.runs.experiments);
  Report& report = content.report;
  report.problems.insert(wanted.unknown.begin(), wanted.unknown.end());
  const std::string left = leave_out_unselected(content.store, options.runs, wanted.figures);
  if (!left.empty()) report.notes.insert(left);
  for (const WantedFigure& figure : wanted.figures) {
    const auto home = std::ranges::find(content.experiments, figure.experiment,
                                        [](const Experiment& e) { return e.manifest.experiment; });
    const bool at_home = home != content.experiments.end();
    const auto leave_out = [&](std::set<std::string>& list, const std::exception& why) {
      list.insert("figure " + figure.path() + ": " + why.what());
      if (at_home) home->unmade.push_back(figure.figure.name);
    };
    try {
      const ComputedFigure made =
          compute_figure(content.store, figure, {options, {}, options.runs});
      (at_home ? home->figures : content.across).push_back(figure_json(figure, made, content));
      if (at_home) std::ranges::copy(made.verdicts, std::back_inserter(home->verdicts));
      const bool is_first = at_home && home->figures.size() == 1;
      if (is_first && options.runs.scales.empty()) {
        std::set<std::string> others = home->scales;
        others.erase(scale_name(made.scale));
        if (!others.empty()) {
          report.notes.insert(fmt::format(
              "experiment {}: the figures show scale {}; choose another with --scale: {}",
              figure.experiment, scale_name(made.scale), some_of(others)));
        }
      }
      ++report.figures;
    } catch (const StoreDamaged& damage) {
      leave_out(report.damage, damage);
    } catch (const UsageError& problem) {
      leave_out(report.problems, problem);
    } catch (const AnalysisError& problem) {
      leave_out(report.problems, problem);
    }
  }
}

/// Adds the manifest of each experiment, the stages of its runs, and a table of its runs. Adds a
/// note on each experiment without a selected run.
void add_runs(Content& content) {
  for (Experiment& experiment : content.experiments) {
    const RegisteredManifest& manifest = experiment.manifest;
    content.manifests.try_emplace(manifest.sha256, manifest);
    for (const Stage& stage : experiment.runs) {
      add_run_lineage(content.store, stage.id, content.runs);
    }
    RunSelection selection = content.options.runs;
    selection.experiments = {manifest.experiment};
    try {
      experiment.table = run_table(content.store, selection, RowPer::run, content.options);
      // Also adds runs that another program declared after experiments_of() had listed the runs.
      for (const FrameRun& run : experiment.table.histories)
        add_run_lineage(content.store, run.stage.id, content.runs);
      content.report += experiment.table;
    } catch (const StoreDamaged& damage) {
      content.report.damage.insert(damage.what());
    } catch (const NotFound& none_selected) {
      content.report.notes.insert(
          fmt::format("table of runs of {}: {}", manifest.experiment, none_selected.what()));
    }
  }
}

json page_of(const Content& content, const Head& head) {
  const std::size_t packed = content.packings.runs.size();
  json packings = false;
  if (packed > 0) {
    packings = {{"counts", fmt::format("{} of {}", counted(content.packings.frames, "checkpoint"),
                                       counted(packed, "run"))},
                {"step", fmt::format("{:.2g}", content.packings.largest_step)}};
  }
  const std::string counts =
      fmt::format("{}, {}, {}", counted(content.experiments.size(), "experiment"),
                  counted(content.report.figures, "figure"), counted(content.runs.size(), "stage"));
  json manifests = json::array();
  for (const auto& [sha256, manifest] : content.manifests) {
    manifests.push_back({{"sha256", sha256}, {"path", manifest.path}, {"text", manifest.text}});
  }
  json facts = {
      {"store",
       std::filesystem::absolute(content.store.folder()).lexically_normal().filename().string()},
      {"counts", counts},
      {"log_event", head.seq},
      {"log_head", head.hash},
      {"version", maker_of(host_facts()).version},
      {"interactive", content.report.interactive},
      {"drawings_asked", !content.report.interactive && has_front_end()},
      {"no_front_end", !has_front_end()},
      {"parts", parts_of(content)},
      {"packings", packings},
      {"stages", list_of(content.runs | std::views::values, stage_json)},
      {"manifests", manifests},
      {"style", std::string(shearcell_style, shearcell_style_end)}};
  if (content.report.interactive) {
    facts["script_hash"] = script_hash(front_end_script());
    facts["script"] = front_end_script();
    facts["licences"] = std::string(shearcell_licences, shearcell_licences_end);
    facts["script_data"] = script_json(script_data(content));
  }
  return facts;
}

}  // namespace

bool has_front_end() {
  return !front_end_script().empty();
}

Report make_report(const Store& store, const ReportOptions& options) {
  Report report;
  Content content{store, options, report};
  const Head head = store.head();
  report.interactive = options.interactive && has_front_end();
  select_runs(store, options.runs);  // throws NotFound for unknown names
  content.experiments = experiments_of(store, options.runs);
  if (content.experiments.empty()) {
    throw NotFound(store.folder().string() +
                   ": the store has no experiment; compute one with `shearcell run`");
  }
  add_figures(content);
  add_runs(content);
  if (report.interactive) {
    const auto names =
        list_of(content.experiments, [](const Experiment& e) { return e.manifest.experiment; });
    content.packings = collect_packings(store, names, options.runs, options.packings,
                                        options.workers, options.encoded);
    const std::vector<std::string>& notes = content.packings.notes;
    report.notes.insert(notes.begin(), notes.end());
    report += content.packings;
  }
  report.experiments = content.experiments.size();
  report.stages = content.runs.size();
  report.packings = content.packings.runs.size();
  report.checkpoints = content.packings.frames;
  report.html = filled({shearcell_page, shearcell_page_end}, page_of(content, head));
  return report;
}

}  // namespace shearcell
