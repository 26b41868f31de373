// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/sha.h>

#include <algorithm>
#include <map>
#include <set>
#include <span>
#include <vector>

#include "experiments/manifest/identity.hpp"
#include "experiments/manifest/parameters.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/report/html.hpp"
#include "provenance/json_text.hpp"
#include "provenance/sha256.hpp"
#include "provenance/words.hpp"

// The template and the front end (web_assets.S).
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

/// The hash of the script for a Content-Security-Policy that allows no other script.
std::string script_hash(std::string_view script) {
  unsigned char digest[SHA256_DIGEST_LENGTH];
  SHA256(reinterpret_cast<const unsigned char*>(script.data()), script.size(), digest);
  return "sha256-" + base64(std::as_bytes(std::span(digest)));
}

/// The beginning of an id, by which the page links to it.
std::string brief(const std::string& id) {
  return id.substr(0, 12);
}

/// "shearcell 0.1.0 (dd11cbe), GNU 12.2.0 Release; HOST, CPU, 4 cores, AVX-512".
std::string text_of(const Maker& maker) {
  return fmt::format("{}; {}, {}", maker.program, maker.host, maker.machine);
}

/// A ruling with a mark that needs no colour.
json ruling_json(Ruling ruling) {
  const bool good = ruling == Ruling::agrees || ruling == Ruling::supported;
  const char* mark = ruling == Ruling::undecided ? "?" : good ? "✓" : "✗";
  return {{"name", name_of(ruling)}, {"mark", mark}};
}

/// How many claims of the experiment's figures have each ruling.
json verdict_of(const ReportData& data, const ReportExperiment& experiment) {
  std::map<Ruling, std::size_t> count;
  for (const std::size_t figure : experiment.figures) {
    for (const Verdict& verdict : data.figures.at(figure).summary.verdicts) ++count[verdict.ruling];
  }
  json list = json::array();
  for (const auto& [ruling, number] : count) {
    list.push_back(ruling_json(ruling));
    list.back()["number"] = number;
  }
  return list;
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

json panel_json(const ReportData& data, const ReportPanel& panel) {
  const bool chart = data.interactive && !panel.chart.is_null();
  const bool drawn = chart || !panel.drawing.empty() || !panel.text.rows.empty();
  return {{"id", panel.id},
          {"name", panel.name},
          {"chart", chart},
          {"drawing", base64(std::as_bytes(std::span(panel.drawing)))},
          {"table", text_table(panel.text)},
          {"trouble", drawn || data.interactive ? "" : panel.trouble},
          {"csv", panel.csv}};
}

std::string span_of_cycles(const FigureInput& input, const RunLineage& run) {
  std::vector<double> cycles;
  for (const std::string& sha256 : input.checkpoints) {
    if (const CheckpointHistory* known = run.find(sha256)) cycles.push_back(known->record.cycle);
  }
  return cycles.empty() ? "?" : fmt::format("{:g} to {:g}", cycles.front(), cycles.back());
}

/// Where a figure comes from.
json lineage_json(const ReportFigure& figure) {
  const FigureLineage& lineage = figure.lineage;
  const FigureSummary& summary = figure.summary;
  std::set<std::string> makers;
  for (const auto& [id, stage] : lineage.runs) {
    for (const Attempt& attempt : stage.attempts) makers.insert(text_of(maker_of(attempt.host)));
  }
  json outputs = json::array(), inputs = json::array(), manifests = json::array();
  for (const ReportPanel& panel : figure.panels) {
    const std::string file = panel.name + ".csv", sha256 = sha256_hex(panel.csv);
    std::string found;
    if (figure.recorded) {
      const json recorded = member_of(figure.recorded->provenance, "outputs");
      found = text_at(recorded, file.c_str()) == sha256 ? ", as recorded" : ", NOT as recorded";
    }
    outputs.push_back({{"file", file}, {"sha256", sha256}, {"found", found}});
  }
  for (const ManifestText& manifest : lineage.manifests) {
    manifests.push_back(
        {{"brief", brief(manifest.sha256)}, {"path", manifest.path}, {"sha256", manifest.sha256}});
  }
  for (const FigureInput& input : lineage.inputs) {
    std::set<int> lines;
    for (const ManifestLine& line : input.lines) lines.insert(line.line);
    inputs.push_back({{"brief", brief(input.run)},
                      {"experiment", input.experiment},
                      {"variant", input.variant},
                      {"seed", input.seed},
                      {"checkpoints", input.checkpoints.size()},
                      {"cycles", span_of_cycles(input, lineage.runs.at(input.run))},
                      {"lines", fmt::format("{}", fmt::join(lines, ", "))}});
  }
  const std::string command = "shearcell figures " + summary.name;
  return {{"scale", scale_name(lineage.scale)},
          {"amount", fmt::format("{} runs, {} checkpoints; analysis version {}", summary.runs,
                                 summary.checkpoints, short_text(lineage.analysis_version))},
          {"makers", makers},
          {"manifests", manifests},
          {"outputs", outputs},
          {"recorded", figure.recorded ? fmt::format("event {} of {}", figure.recorded->seq,
                                                     figure.recorded->recorded_at)
                                       : ""},
          {"command",
           summary.experiment.empty() ? command : command + " --experiment " + summary.experiment},
          {"record", lineage.record.name},
          {"inputs", inputs}};
}

/// A stage with its attempts and checkpoints.
json stage_json(const RunLineage& stage) {
  const Stage& run = stage.stage;
  json members = json::array(), attempts = json::array();
  for (const Ask& member : run.asks) {
    members.push_back(
        {{"manifest", brief(member.manifest)},
         {"text", fmt::format("{} at scale {}, {}, seed {}", member.experiment,
                              scale_name(member.scale), member.variant, member.seed)}});
  }
  for (const Attempt& attempt : stage.attempts) {
    const Maker maker = maker_of(attempt.host);
    attempts.push_back({{"what", fmt::format("Attempt {}, {}, {}: ", attempts.size() + 1,
                                             attempt.started_at, name_of(attempt.outcome))},
                        {"from_run", brief(attempt.from_run)},
                        {"from_checkpoint", brief(attempt.from_checkpoint)},
                        {"maker", text_of(maker)},
                        {"flags", maker.flags},
                        {"why", attempt.why}});
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
  return {{"id", run.id},
          {"brief", brief(run.id)},
          {"kind", run.kind},
          {"grains", run.grains},
          {"error", run.error},
          {"state", name_of(run.state)},
          {"members", members},
          {"parent", brief(run.parent)},
          {"attempts", attempts},
          {"parameters", parameters.dump()},
          {"checkpoints", checkpoints},
          {"count", stage.checkpoints.size()}};
}

json figure_json(const ReportData& data, const ReportFigure& figure) {
  const FigureSummary& summary = figure.summary;
  json panels = json::array(), claims = json::array(), warnings = json::array();
  for (const ReportPanel& panel : figure.panels) panels.push_back(panel_json(data, panel));
  for (const Verdict& verdict : summary.verdicts) {
    claims.push_back({{"ruling", ruling_json(verdict.ruling)},
                      {"claim", verdict.claim},
                      {"numbers", fmt::format("{}: {}{}{}", verdict.quantity, numbers_of(verdict),
                                              verdict.note.empty() ? "" : ". ", verdict.note)}});
  }
  for (const auto* list : {&summary.damage, &summary.pruned}) {
    for (const std::string& line : *list) warnings.push_back("Left out: " + line);
  }
  for (const std::string& line : summary.notes) warnings.push_back(line);
  return {{"id", figure.id},
          {"name", summary.name},
          {"heading", fmt::format("{} {}{}{}", panels.empty() ? "Claim" : "Figure", summary.name,
                                  summary.title.empty() ? "" : ". ", summary.title)},
          {"panels", panels},
          {"claims", claims},
          {"warnings", warnings},
          {"lineage", lineage_json(figure)}};
}

struct Count {
  const char* state;
  const char* mark;  ///< distinguishes the states without colour
  const char* name;
  std::size_t number;
};

/// A box of the workflow: what it is about, and how many are in each state.
json step(const char* title, std::initializer_list<Count> counts) {
  json list = json::array();
  for (const Count& one : counts) {
    if (one.number == 0) continue;
    list.push_back(
        {{"state", one.state}, {"mark", one.mark}, {"name", one.name}, {"number", one.number}});
  }
  return {{"title", title},    {"some", !list.empty()}, {"none", list.empty()},
          {"manifest", false}, {"figures_step", false}, {"counts", std::move(list)}};
}

json stages_step(const char* title, const ReportExperiment& experiment, bool prepare) {
  std::map<StageState, std::size_t> in;
  for (const Stage& run : experiment.runs) {
    if ((run.kind == name_of(StageKind::prepare)) == prepare) ++in[run.state];
  }
  return step(title, {{"done", "✓", "done", in[StageState::completed]},
                      {"running", "▸", "running", in[StageState::running]},
                      {"stopped", "‖", "interrupted", in[StageState::interrupted]},
                      {"failed", "✗", "failed", in[StageState::failed]},
                      {"waiting", "·", "waiting", in[StageState::declared]}});
}

/// The way from the manifest to the figures, with the states of each step.
json workflow(const ReportData& data, const ReportExperiment& experiment) {
  std::map<CheckpointState, std::size_t> in;
  for (const Stage& run : experiment.runs) {
    for (const CheckpointHistory& c : data.runs.at(run.id).checkpoints) ++in[c.record.state];
  }
  json manifest = step("Manifest", {});
  manifest["none"] = false;
  manifest["manifest"] = {{"brief", brief(experiment.manifest.sha256)},
                          {"path", experiment.manifest_path}};
  json figures = step("Figures", {{"done", "✓", "made", experiment.figures.size()},
                                  {"failed", "✗", "cannot be made", experiment.unmade.size()}});
  figures["figures_step"] = true;
  return {manifest, stages_step("Packings", experiment, true),
          stages_step("Runs", experiment, false),
          step("Checkpoints", {{"done", "✓", "stored", in[CheckpointState::recorded]},
                               {"stopped", "‖", "pruned", in[CheckpointState::pruned]},
                               {"failed", "✗", "damaged", in[CheckpointState::rejected]},
                               {"waiting", "·", "to come, at most", experiment.checkpoints_left}}),
          figures};
}

/// A column of the table of runs.
struct RunColumn {
  std::size_t at = 0;  ///< in RunTable
  std::string heading;
  bool numeric = true;
};

/// The columns that are shown at first: what distinguishes the runs, then their state and results.
std::vector<RunColumn> columns_of(const ReportExperiment& experiment) {
  const RunTable& table = experiment.table;
  const std::size_t seed = table.place("seed"), cycle = table.place("cycle");
  std::vector<RunColumn> shown = {{table.place("run"), "run", false}};
  const auto differs = [&](std::size_t at) {
    return std::ranges::any_of(table.rows,
                               [&](const auto& row) { return row[at] != table.rows.front()[at]; });
  };
  if (differs(table.place("scale"))) shown.push_back({table.place("scale"), "scale", false});
  // Swept parameters stand between the seed and the cycle; the grains are among them.
  if (experiment.labelled || cycle - seed == 2) {
    shown.push_back({table.place("variant"), "variant", false});
  }
  for (std::size_t at = seed + 1; at < cycle; ++at) {
    const Field* field = find_field(table.columns[at].name);
    if (field == nullptr || field->name == "grains") continue;
    std::string name(field->symbol.empty() ? field->name : field->symbol);
    std::ranges::replace(name, '_', ' ');
    const bool unit = !field->symbol.empty() && field->unit != "1" && !field->unit.empty();
    shown.push_back(
        {at, unit ? fmt::format("{} [{}]", name, field->unit) : name, !field->unit.empty()});
  }
  for (const auto& [key, heading] : std::initializer_list<std::pair<const char*, const char*>>{
           {"seed", "seed"},
           {"grains", "N"},
           {"state", "state"},
           {"cycle", "cycle"},
           {"target_cycles", "of"},
           {"phi", "ϕ"},
           {"crystalline_percent", "crystalline [%]"},
           {"largest_crystallite", "largest crystallite"},
           {"onset_size_cycle", "onset cycle"},
           {"onset_size_phi", "onset ϕ"},
           {"wall_time_s", "time [s]"},
           {"particle_steps_per_s", "steps/s"}}) {
    shown.push_back({table.place(key), heading, key != std::string_view("state")});
  }
  return shown;
}

json cell_json(const ReportData& data, const TableColumn& column, const json& value) {
  const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  json cell = {{"known", !value.is_null()}, {"value", text},  {"run", false},
               {"packed", false},           {"state", false}, {"text", ""}};
  if (column.name == "run") {
    cell["brief"] = brief(text);
    cell["run"] = text.substr(0, 8);
    cell["packed"] = std::ranges::any_of(data.packings.runs,
                                         [&](const json& run) { return run.at("id") == value; });
  } else if (column.name == "state") {
    cell["state"] = text;
  } else if (value.is_number_float()) {
    cell["text"] = fmt::format("{:.4g}", value.get<double>());
  } else if (!value.is_null()) {
    cell["text"] = short_text(value);
  }
  return cell;
}

json run_rows(const ReportData& data, const ReportExperiment& experiment) {
  const RunTable& table = experiment.table;
  if (table.rows.empty()) return false;
  json columns = json::array(), rows = json::array();
  const std::vector<RunColumn> shown = columns_of(experiment);
  for (const RunColumn& column : shown) {
    const TableColumn& source = table.columns.at(column.at);
    columns.push_back({{"key", source.name},
                       {"meaning", source.meaning},
                       {"heading", column.heading},
                       {"numeric", column.numeric}});
  }
  for (const std::vector<json>& row : table.rows) {
    json cells = json::array();
    for (std::size_t c = 0; c < shown.size(); ++c) {
      json& cell =
          cells.emplace_back(cell_json(data, table.columns.at(shown[c].at), row.at(shown[c].at)));
      cell["heading"] = shown[c].heading;
      cell["numeric"] = shown[c].numeric;
    }
    rows.push_back({{"number", rows.size()}, {"cells", std::move(cells)}});
  }
  return {{"columns", columns}, {"rows", rows}};
}

json experiment_json(const ReportData& data, const ReportExperiment& experiment) {
  const RegisteredManifest& manifest = experiment.manifest;
  json figures = json::array();
  for (const std::size_t figure : experiment.figures) {
    figures.push_back(figure_json(data, data.figures.at(figure)));
  }
  const json verdict = verdict_of(data, experiment);
  return {{"experiment", manifest.experiment},
          {"question", manifest.question.empty() ? manifest.experiment : manifest.question},
          {"verdict", verdict},
          {"claimed", !verdict.empty()},
          {"stage_count", experiment.runs.size()},
          {"steps", workflow(data, experiment)},
          {"figures", std::move(figures)},
          {"unmade", experiment.unmade},
          {"runs", run_rows(data, experiment)}};
}

/// The experiments, then the figures of all experiments together.
json parts_of(const ReportData& data) {
  json parts = json::array(), across = json::array();
  for (const ReportExperiment& experiment : data.experiments) {
    parts.push_back(experiment_json(data, experiment));
  }
  for (const ReportFigure& figure : data.figures) {
    if (figure.summary.experiment.empty()) across.push_back(figure_json(data, figure));
  }
  if (!across.empty()) {
    parts.push_back({{"experiment", false},
                     {"question", "All experiments together"},
                     {"figures", std::move(across)},
                     {"runs", false}});
  }
  return parts;
}

/// What the front end reads.
json script_data(const ReportData& data) {
  json charts = json::object(), experiments = json::array();
  for (const ReportFigure& figure : data.figures) {
    for (const ReportPanel& panel : figure.panels) {
      if (!panel.chart.is_null()) charts[panel.id] = panel.chart;
    }
  }
  for (const ReportExperiment& experiment : data.experiments) {
    json columns = json::array();
    for (const TableColumn& column : experiment.table.columns) {
      const Field* field = find_field(column.name);
      columns.push_back({{"key", column.name},
                         {"meaning", column.meaning},
                         {"symbol", field == nullptr ? "" : field->symbol}});
    }
    experiments.push_back({{"experiment", experiment.manifest.experiment},
                           {"columns", std::move(columns)},
                           {"rows", experiment.table.rows},
                           {"runs", experiment.traces}});
  }
  return {{"charts", std::move(charts)},
          {"packings", data.packings.runs},
          {"experiments", std::move(experiments)}};
}

}  // namespace

bool has_front_end() {
  return !front_end_script().empty();
}

std::string report_page(const ReportData& data) {
  const std::size_t packed = data.packings.runs.size();
  json packings = false;
  if (packed > 0) {
    packings = {{"counts", fmt::format("{} of {}", counted(data.packings.frames, "checkpoint"),
                                       counted(packed, "run"))},
                {"step", fmt::format("{:.2g}", data.packings.largest_step)}};
  }
  const std::string counts =
      fmt::format("{}, {}, {}", counted(data.experiments.size(), "experiment"),
                  counted(data.figures.size(), "figure"), counted(data.runs.size(), "stage"));
  json stages = json::array(), manifests = json::array();
  for (const auto& [id, stage] : data.runs) stages.push_back(stage_json(stage));
  for (const auto& [sha256, manifest] : data.manifests) {
    manifests.push_back(
        {{"brief", brief(sha256)}, {"path", manifest.path}, {"text", manifest.text}});
  }
  json facts = {{"store", data.store},
                {"counts", counts},
                {"event", data.head.seq},
                {"log_head", data.head.hash},
                {"log_brief", brief(data.head.hash)},
                {"version", data.program.value("version", "")},
                {"commit", data.program.value("commit", "")},
                {"interactive", data.interactive},
                {"drawings_asked", !data.interactive && has_front_end()},
                {"no_front_end", !has_front_end()},
                {"parts", parts_of(data)},
                {"packings", packings},
                {"stages", stages},
                {"manifests", manifests},
                {"style", std::string(shearcell_style, shearcell_style_end)}};
  if (data.interactive) {
    facts["script_hash"] = script_hash(front_end_script());
    facts["script"] = front_end_script();
    facts["licences"] = std::string(shearcell_licences, shearcell_licences_end);
    facts["script_data"] = script_json(script_data(data));
  }
  return filled({shearcell_page, shearcell_page_end}, facts);
}

}  // namespace shearcell
