// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/lineage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ranges>

#include "experiments/manifest/parameters.hpp"
#include "provenance/errors.hpp"
#include "provenance/io/file.hpp"
#include "provenance/json_text.hpp"
#include "provenance/limits.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

/// Cycles that differ by less than this are treated as equal. A time step is much longer.
constexpr double kSameCycle = 1e-9;

Cycles cycles_of(const std::vector<CheckpointRecord>& checkpoints) {
  Cycles ranges;
  for (const CheckpointRecord& record : checkpoints) {
    if (!ranges.empty()) {
      auto& [first, last, every] = ranges.back();
      if (first == last) every = record.cycle - first;
      if (std::abs(record.cycle - last - every) < kSameCycle) {
        last = record.cycle;
        continue;
      }
    }
    ranges.push_back({record.cycle, record.cycle, 1});
  }
  return ranges;
}

/// The checkpoints of the run at these cycles. A rejected checkpoint is returned only if the run
/// has no other checkpoint at the same cycle.
std::vector<CheckpointRecord> at_cycles(const RunLineage& run, const Cycles& cycles) {
  std::map<double, CheckpointRecord> found;
  for (const CheckpointHistory& c : run.checkpoints) {
    const double cycle = c.record.cycle;
    const auto holds = [cycle](const auto& range) {
      const auto& [first, last, every] = range;
      return cycle > first - kSameCycle && cycle < last + kSameCycle &&
             std::abs(std::remainder(cycle - first, every)) < kSameCycle;
    };
    if (std::ranges::none_of(cycles, holds)) continue;
    const auto [known, first] = found.try_emplace(cycle, c.record);
    if (!first && c.record.state != CheckpointState::rejected) known->second = c.record;
  }
  std::vector<CheckpointRecord> all;
  for (auto& [cycle, record] : found) all.push_back(std::move(record));
  return all;
}

/// Reads an input run from the figure's record. Sets everything except FigureInput::lines.
FigureInput read_input(const json& entry, const RunLineage& run) {
  FigureInput input;
  input.run = run.stage.id;
  entry.at("experiment").get_to(input.experiment);
  entry.at("variant").get_to(input.variant);
  input.seed = count_at(entry, "seed");
  entry.at("manifest").get_to(input.manifest);
  input.overrides = entry.value("overrides", json());
  std::vector<CheckpointRecord> found;
  if (entry.contains("checkpoints")) {  // a record of an earlier version
    entry.at("checkpoints").get_to(input.checkpoints);
    for (const std::string& sha256 : input.checkpoints) {
      if (const CheckpointHistory* known = run.find(sha256)) found.push_back(known->record);
    }
    input.states = states_of(found);
    if (found.size() < input.checkpoints.size()) input.fault = "the log lacks some checkpoints";
    return input;
  }
  input.states = {entry.at("cycles"), entry.at("state_hash"), entry.at("states_sha256")};
  found = at_cycles(run, input.states.cycles);
  for (const CheckpointRecord& record : found) input.checkpoints.push_back(record.sha256);
  if (states_of(found) != input.states)
    input.fault = "the checkpoint states in the log differ from those in the figure's record";
  return input;
}

// The swept values of the run, from the version of the manifest that the figure used.
json swept_values_of(const Stage& stage, const FigureInput& input) {
  for (const auto& [place, ask, newest] : stage.memberships) {
    // In records of earlier program versions, ",manifest=VERSION" follows the name of a variant if
    // the variant is from an older manifest.
    const bool same =
        input.variant == place.variant || input.variant.starts_with(place.variant + ",manifest=");
    if (place.manifest == input.manifest && same) return place.swept;
  }
  return json::object();
}

const ManifestText* remember_manifest(const Store& store, FigureLineage& lineage,
                                      const std::string& sha256) {
  const auto known = std::ranges::find(lineage.manifests, sha256, &ManifestText::sha256);
  if (known != lineage.manifests.end()) return &*known;
  auto manifest = find_manifest(store, sha256);
  if (!manifest) return nullptr;
  lineage.manifests.push_back(std::move(*manifest));
  return &lineage.manifests.back();
}

json checkpoint_json(const std::string& sha256, const RunLineage& run) {
  const CheckpointHistory* known = run.find(sha256);
  if (known == nullptr) return {{"sha256", sha256}, {"known", false}};
  return {{"sha256", sha256},
          {"known", true},
          {"state_hash", known->record.state_hash},
          {"cycle", known->record.cycle},
          {"step", known->record.step},
          {"file", known->record.file},
          {"size", known->record.size},
          {"event", known->record.seq},
          {"recorded_at", known->recorded_at},
          {"attempt", known->attempt ? json(*known->attempt + 1) : json(nullptr)},
          {"rejected", known->record.state == CheckpointState::rejected},
          {"pruned", known->record.state == CheckpointState::pruned}};
}

// The outputs in a record, as file name -> SHA-256. The record may be malformed.
std::map<std::string, std::string> outputs_of(const json& provenance) {
  std::map<std::string, std::string> outputs;
  const json found = provenance.is_object() ? provenance.value("outputs", json()) : json();
  if (!found.is_object()) return outputs;
  for (const auto& [name, sha256] : found.items()) {
    if (sha256.is_string()) outputs[name] = sha256.get<std::string>();
  }
  return outputs;
}

// The SHA-256 of the file according to the lineage file in the same folder, or "".
std::string hash_in_lineage_beside(const std::filesystem::path& file, const std::string& figure) {
  const auto text =
      read_plain(file.parent_path() / (figure + ".lineage.json"), StoreLimits::value_bytes);
  return text ? outputs_of(parse_json(*text))[file.filename().string()] : "";
}

// The SHA-256 of each output and of the lineage file.
std::map<std::string, std::string> files_of(const FigureRecord& record) {
  std::map<std::string, std::string> files = outputs_of(record.provenance);
  files[figure_name(record) + ".lineage.json"] = sha256_hex(lineage_text(record.provenance));
  return files;
}

}  // namespace

std::string to_text(const Cycles& cycles) {
  std::string text;
  for (const auto& [first, last, every] : cycles) {
    text += fmt::format("{}{}:{}:{}", text.empty() ? "" : ", ", first, last, every);
  }
  return text;
}

States states_of(const std::vector<CheckpointRecord>& checkpoints) {
  std::string hashes;
  for (const CheckpointRecord& record : checkpoints) hashes += record.state_hash + '\n';
  return {cycles_of(checkpoints), checkpoints.empty() ? "" : checkpoints.back().state_hash,
          sha256_hex(hashes)};
}

json overrides_of(const Store& store, const Stage& stage, const Place& place, const Ask& ask) {
  if (stage.kind != name_of(StageKind::shear)) return nullptr;
  const auto manifest = find_manifest(store, place.manifest);
  return manifest ? overrides(manifest->text, place, ask) : json();
}

std::string figure_name(const FigureRecord& record) {
  return record.name.substr(record.name.rfind('/') + 1);
}

std::string figure_path(const FigureRecord& record) {
  const json experiment = member_of(record.provenance, "experiment");
  const json scale = member_of(record.provenance, "scale");
  if (!scale.is_string()) return record.name;
  const std::string path = scale_name(scale) + "/" + figure_name(record);
  return experiment.is_string() ? experiment.get<std::string>() + "/" + path : path;
}

std::string lineage_text(json provenance) {
  if (provenance.is_object()) provenance.erase("made");
  return provenance.dump(1) + '\n';
}

std::vector<FigureRecord> figure_records(const Store& store) {
  constexpr std::string_view prefix = "figure/";
  std::vector<FigureRecord> records;
  for (const Event& event : store.events("", events::kFigureGenerated)) {
    if (!event.stream.starts_with(prefix)) continue;
    records.push_back(
        {event.stream.substr(prefix.size()), event.seq, event.recorded_at, event.body()});
  }
  return records;
}

FigureLineage figure_lineage(const Store& store, const FigureRecord& record) {
  FigureLineage lineage;
  lineage.record = record;
  lineage.outputs = outputs_of(record.provenance);
  try {
    lineage.scale = record.provenance.value("scale", "");
    lineage.plots = record.provenance.value("plots", "");
    for (const json& entry : record.provenance.at("inputs")) {
      const std::string id = entry.at("run");
      add_run_lineage(store, id, lineage.runs);
      const RunLineage& run = lineage.runs.at(id);
      FigureInput input = read_input(entry, run);
      if (const auto* manifest = remember_manifest(store, lineage, input.manifest)) {
        input.lines = manifest_lines(manifest->text, lineage.scale,
                                     swept_values_of(run.stage, input), figure_name(record));
      }
      lineage.inputs.push_back(std::move(input));
    }
  } catch (const json::exception& problem) {
    throw StoreDamaged(
        fmt::format("event {} (FigureGenerated of {}): the payload is malformed: {}; run `verify`",
                    record.seq, record.name, problem.what()));
  } catch (const NotFound& problem) {
    throw StoreDamaged(fmt::format("event {} (FigureGenerated of {}): {}", record.seq, record.name,
                                   problem.what()));
  }
  return lineage;
}

json to_json(const RunLineage& stage) {
  json attempts = json::array();
  for (const Attempt& attempt : stage.attempts) {
    attempts.push_back(
        {{"attempt", attempts.size() + 1},
         {"event", attempt.seq},
         {"started_at", attempt.started_at},
         {"ended_at", attempt.ended_at},
         {"outcome", name_of(attempt.outcome)},
         {"why", attempt.why},
         {"host", attempt.host},
         {"from", {{"run", attempt.from_run}, {"checkpoint", attempt.from_checkpoint}}}});
  }
  return {{"run", stage.stage.id},
          {"kind", stage.stage.kind},
          {"parent", stage.stage.parent},
          {"grains", stage.stage.grains},
          {"resolved", stage.stage.resolved},
          {"attempts", attempts}};
}

json to_json(const FigureLineage& lineage) {
  json manifests = json::array(), inputs = json::array(), stages = json::array();
  for (const ManifestText& m : lineage.manifests) {
    manifests.push_back({{"sha256", m.sha256},
                         {"path", m.path},
                         {"registered_at", m.registered_at},
                         {"text", m.text}});
  }
  for (const FigureInput& input : lineage.inputs) {
    json checkpoints = json::array();
    const RunLineage& run = lineage.runs.at(input.run);
    for (const std::string& c : input.checkpoints) checkpoints.push_back(checkpoint_json(c, run));
    inputs.push_back({{"run", input.run},
                      {"experiment", input.experiment},
                      {"variant", input.variant},
                      {"seed", input.seed},
                      {"manifest", input.manifest},
                      {"manifest_lines", input.lines},
                      {"overrides", input.overrides},
                      {"cycles", input.states.cycles},
                      {"state_hash", input.states.state_hash},
                      {"states_sha256", input.states.sha256},
                      {"fault", input.fault},
                      {"checkpoints", checkpoints}});
  }
  for (const auto& [id, stage] : lineage.runs) stages.push_back(to_json(stage));
  return {{"figure", figure_name(lineage.record)},
          {"experiment", member_of(lineage.record.provenance, "experiment")},
          {"event", lineage.record.seq},
          {"recorded_at", lineage.record.recorded_at},
          {"scale", scale_name(lineage.scale)},
          {"analysis_version", member_of(lineage.record.provenance, "analysis_version")},
          {"plots", member_of(lineage.record.provenance, "plots")},
          {"made", member_of(lineage.record.provenance, "made")},
          {"outputs", lineage.outputs},
          {"manifests", manifests},
          {"inputs", inputs},
          {"runs", stages}};
}

std::optional<PublishedFile> find_published(const Store& store, const std::filesystem::path& file) {
  const auto content =
      read_plain(std::filesystem::weakly_canonical(file), StoreLimits::published_bytes);
  if (!content) {
    throw NotFound(
        file.string() +
        ": this file cannot be read, or it is larger than any file that `figures` writes");
  }
  const std::string sha256 = sha256_hex(*content);
  const std::string name = file.filename().string();
  const std::vector<FigureRecord> records = figure_records(store);
  std::optional<PublishedFile> by_lineage, by_name;
  for (const FigureRecord& record : records | std::views::reverse) {  // the newest first
    for (const auto& [output, hash] : files_of(record)) {
      if (hash == sha256) return PublishedFile{sha256, hash, record};
      if (output != name) continue;
      if (!by_name) by_name = {sha256, hash, record};
      if (!by_lineage && hash_in_lineage_beside(file, figure_name(record)) == hash) {
        by_lineage = {sha256, hash, record};
      }
    }
  }
  return by_lineage ? by_lineage : by_name;
}

std::vector<Finding> check_inputs(const Store& store, const FigureLineage& lineage) {
  using enum Finding::Severity;
  std::vector<Finding> faults;
  for (const FigureInput& input : lineage.inputs) {
    const RunLineage& run = lineage.runs.at(input.run);
    if (!input.fault.empty()) faults.push_back({error, "", input.run, input.fault});
    for (const std::string& sha256 : input.checkpoints) {
      const CheckpointHistory* known = run.find(sha256);
      if (known == nullptr) {
        faults.push_back({error, sha256, input.run, "the log lacks this checkpoint"});
        continue;
      }
      try {
        store.read_file(known->record);
      } catch (const FilePruned&) {
        faults.push_back({note, sha256, input.run, "pruned"});
      } catch (const StoreDamaged& damage) {
        faults.push_back({error, sha256, input.run, damage.what()});
      }
    }
  }
  return faults;
}

}  // namespace shearcell
