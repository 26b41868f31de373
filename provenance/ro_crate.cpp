// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/ro_crate.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <utility>

#include "provenance/errors.hpp"
#include "provenance/io/file.hpp"
#include "provenance/json_text.hpp"
#include "provenance/limits.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kCrateSpecification = "https://w3id.org/ro/crate/1.1";
constexpr const char* kProfile = "https://w3id.org/ro/wfrun/process/0.5";

/// Identifier of the crate of a run. An earlier export is recognized by this identifier.
std::string crate_identifier(const std::string& run) {
  return "urn:x-shearcell:run:" + run;
}

json reference(const std::string& id) {
  return {{"@id", id}};
}

using Graph = std::map<std::string, json>;  // the entities of the crate, by id

/// Adds the entity unless its id is known. Returns a reference to the entity.
json add(Graph& graph, json entity) {
  const std::string id = entity.at("@id").get<std::string>();
  graph.try_emplace(id, std::move(entity));
  return reference(id);
}

std::string path_of_checkpoint(const std::string& sha256) {
  return "checkpoints/" + sha256 + ".h5";
}

std::string path_of_manifest(const std::string& sha256) {
  return "manifests/" + sha256 + ".yaml";
}

json file_entity(const std::string& path, const std::string& name, const std::string& format,
                 std::uint64_t size, const std::string& sha256, const std::string& made,
                 const std::string& description) {
  return {{"@id", path},
          {"@type", "File"},
          {"name", name},
          {"encodingFormat", format},
          {"contentSize", std::to_string(size)},  // [bytes]; RO-Crate requires text
          {"sha256", sha256},
          {"dateCreated", made},
          {"description", description}};
}

json add_manifest(Graph& graph, const ManifestText& manifest) {
  // Only the file name is written, because the rest of the path is private.
  const std::string name = fs::path(manifest.path).filename().string();
  return add(graph, file_entity(path_of_manifest(manifest.sha256), "Manifest " + name,
                                "application/yaml", manifest.text.size(), manifest.sha256,
                                manifest.registered_at, "The experiment as it was declared"));
}

json add_checkpoint(Graph& graph, const CheckpointHistory& checkpoint) {
  const CheckpointRecord& c = checkpoint.record;
  json entity =
      file_entity(path_of_checkpoint(c.sha256),
                  fmt::format("State of run {:.12} at cycle {:g}", c.run, c.cycle),
                  "application/x-hdf5", c.size, c.sha256, checkpoint.recorded_at,
                  fmt::format("H5MD 1.1 file with the exact state after {} time steps, {:.9g} s",
                              c.step, c.time_s));
  entity["identifier"] = "urn:x-shearcell:state:" + c.state_hash;
  if (!checkpoint.kept()) {
    entity["@id"] = "#checkpoint-" + c.sha256;
    entity["@type"] = "CreativeWork";
    entity["description"] = c.state == CheckpointState::pruned
                                ? "Not in this crate: its file was pruned"
                                : "Not in this crate: it was rejected as damaged";
    entity.erase("encodingFormat");
  }
  return add(graph, std::move(entity));
}

/// Adds the program of an attempt.
json add_software(Graph& graph, const Maker& maker) {
  const std::string libraries = fmt::format("{}", fmt::join(maker.libraries, ", "));
  const std::string id = sha256_hex(maker.program + maker.flags + libraries).substr(0, 16);
  return add(
      graph,
      {{"@id", "#shearcell-" + id},
       {"@type", "SoftwareApplication"},
       {"name", "shearcell"},
       {"softwareVersion", maker.version},
       {"softwareRequirements", maker.libraries},
       {"description",
        fmt::format("Discrete element simulations of cyclically sheared grains; {}, built with {}",
                    maker.program, maker.flags)}});
}

json add_host(Graph& graph, const Maker& maker) {
  const std::string machine = maker.system + "; " + maker.machine;
  return add(graph, {{"@id", "#host-" + sha256_hex(maker.host + machine).substr(0, 16)},
                     {"@type", "Place"},
                     {"name", maker.host},
                     {"description", machine}});
}

/// Adds the seed, the resolved parameters and the number of cycles of a run.
json add_parameters(Graph& graph, const Stage& stage) {
  json given = json::array();
  const auto add_one = [&](const std::string& name, const json& value) {
    given.push_back(add(graph, {{"@id", fmt::format("#parameter-{}-{}", stage.id, name)},
                                {"@type", "PropertyValue"},
                                {"name", name},
                                {"value", value.is_primitive() ? value : json(value.dump())}}));
  };
  for (const auto& [key, value] : stage.resolved.items()) {
    if (key == "parent") continue;  // the parent's checkpoint is added separately
    if (!value.is_object()) {
      add_one(key, value);
      continue;
    }
    for (const auto& [name, inner] : value.items()) add_one(name, inner);
  }
  if (stage.target_cycles > 0) add_one("target_cycles", stage.target_cycles);
  return given;
}

/// Adds an attempt with the manifests and parameters that it used.
json add_attempt(Graph& graph, const CrateFacts& facts, const RunLineage& stage, std::size_t a) {
  const Attempt& attempt = stage.attempts[a];
  const bool is_last = a + 1 == stage.attempts.size();
  const std::string end =
      !attempt.ended_at.empty() || is_last ? attempt.ended_at : stage.attempts[a + 1].started_at;
  json objects = json::array();
  for (const ManifestText& manifest : facts.manifests) {
    const bool used = std::ranges::any_of(stage.stage.memberships, [&](const Membership& m) {
      return m.place.manifest == manifest.sha256;
    });
    if (used && (end.empty() || manifest.registered_at <= end)) {
      objects.push_back(add_manifest(graph, manifest));
    }
  }
  for (const RunLineage& other : facts.stages) {
    const CheckpointHistory* from = other.find(attempt.from_checkpoint);
    if (other.stage.id == attempt.from_run && from != nullptr) {
      objects.push_back(add_checkpoint(graph, *from));
    }
  }
  for (json& parameter : add_parameters(graph, stage.stage)) {
    objects.push_back(std::move(parameter));
  }
  json results = json::array();
  for (const std::string& sha256 : attempt.checkpoints) {
    results.push_back(add_checkpoint(graph, *stage.find(sha256)));
  }
  const Maker maker = maker_of(attempt.host);
  const bool lost = attempt.outcome == AttemptOutcome::lost;
  const char* status = attempt.outcome == AttemptOutcome::completed ? "Completed"
                       : attempt.outcome == AttemptOutcome::running ? "Active"
                                                                    : "Failed";
  const std::string error =
      lost ? "ended without a record, as after a power cut; a later attempt continued the run"
           : attempt.why;
  json action = {
      {"@id", fmt::format("#attempt-{}-{}", stage.stage.id, a + 1)},
      {"@type", "CreateAction"},
      {"name",
       fmt::format("{} of run {:.12}, attempt {}", stage.stage.kind, stage.stage.id, a + 1)},
      {"instrument", add_software(graph, maker)},
      {"location", add_host(graph, maker)},
      {"startTime", attempt.started_at},
      {"actionStatus", reference(fmt::format("http://schema.org/{}ActionStatus", status))},
      {"object", objects},
      {"result", results}};
  if (!attempt.ended_at.empty()) action["endTime"] = attempt.ended_at;
  if (!error.empty()) action["error"] = error;
  return add(graph, std::move(action));
}

json add_licence(Graph& graph, const std::string& licence) {
  const bool chosen = !licence.empty();
  return add(graph,
             {{"@id", chosen ? licence : "#licence"},
              {"@type", "CreativeWork"},
              {"name", chosen ? licence : "No licence was chosen"},
              {"description", chosen ? "The licence of the data in this crate"
                                     : "The person who exported these data chose no licence; "
                                       "ask this person before you use the data."}});
}

std::string title_of(const Stage& stage) {
  if (stage.memberships.empty()) return fmt::format("{} {:.12}", stage.kind, stage.id);
  const Place& member = stage.memberships.front().place;
  return fmt::format("{} {}, seed {}: {} of {} grains (run {:.12})", member.experiment,
                     member.variant, member.seed, stage.kind, stage.grains, stage.id);
}

bool is_crate_of(const fs::path& folder, const std::string& run) {
  const auto text = read_plain(folder / kCrateMetadata, StoreLimits::value_bytes);
  const json graph = member_of(parse_json(text.value_or("")), "@graph");
  return graph.is_array() && std::any_of(graph.begin(), graph.end(), [&](const json& entity) {
           return member_of(entity, "@id") == "./" &&
                  member_of(entity, "identifier") == crate_identifier(run);
         });
}

/// Creates the folder if it is missing. Throws if `path` is a file or a link.
void make_folder(const fs::path& path) {
  const fs::file_status status = fs::symlink_status(path);
  if (fs::exists(status) && !fs::is_directory(status)) {
    throw UsageError(path.string() +
                     ": this must be a folder, but it is a file or a link; remove "
                     "it, or choose another folder");
  }
  fs::create_directory(path);
}

}  // namespace

CrateFacts crate_facts(const Store& store, const std::string& run) {
  CrateFacts facts{run_lineage(store, run), {}};
  for (const RunLineage& stage : facts.stages) {
    for (const Membership& member : stage.stage.memberships) {
      if (std::ranges::count(facts.manifests, member.place.manifest, &ManifestText::sha256) > 0)
        continue;
      if (auto manifest = find_manifest(store, member.place.manifest)) {
        facts.manifests.push_back(std::move(*manifest));
      }
    }
  }
  return facts;
}

json ro_crate_metadata(const CrateFacts& facts) {
  Graph graph;
  json actions = json::array();
  for (const ManifestText& manifest : facts.manifests) add_manifest(graph, manifest);
  for (const RunLineage& stage : facts.stages) {
    for (std::size_t a = 0; a < stage.attempts.size(); ++a) {
      actions.push_back(add_attempt(graph, facts, stage, a));
    }
  }
  const json licence = add_licence(graph, facts.licence);
  add(graph, {{"@id", kProfile},
              {"@type", "CreativeWork"},
              {"name", "Process Run Crate"},
              {"version", "0.5"}});
  json parts = json::array();
  for (const auto& [id, entity] : graph) {
    if (entity.at("@type") == "File") parts.push_back(reference(id));
  }
  std::string newest;
  for (const RunLineage& stage : facts.stages) newest = std::max(newest, stage.stage.updated_at);
  const Stage& stage = facts.stages.back().stage;
  json all = json::array();
  all.push_back({{"@id", kCrateMetadata},
                 {"@type", "CreativeWork"},
                 {"conformsTo", reference(kCrateSpecification)},
                 {"about", reference("./")}});
  all.push_back(
      {{"@id", "./"},
       {"@type", "Dataset"},
       {"name", title_of(stage)},
       {"description",
        fmt::format("Checkpoints of run {} and of the stages before it, with the program, the "
                    "machines, the manifests and the parameters that made them",
                    stage.id)},
       {"identifier", crate_identifier(stage.id)},
       {"datePublished", newest},
       {"license", licence},
       {"conformsTo", json::array({reference(kProfile)})},
       {"hasPart", parts},
       {"mentions", actions}});
  for (auto& [id, entity] : graph) all.push_back(std::move(entity));
  return {{"@context", json::array({kCrateSpecification + std::string("/context"),
                                    "https://w3id.org/ro/terms/workflow-run/context"})},
          {"@graph", all}};
}

std::vector<std::string> write_ro_crate(const Store& store, const CrateFacts& facts,
                                        const fs::path& folder) {
  make_folder(folder);
  if (!fs::is_empty(folder) && !is_crate_of(folder, facts.stages.back().stage.id)) {
    throw UsageError(folder.string() +
                     ": the folder is not an export of this run; choose another folder");
  }
  std::vector<std::string> written;
  for (const char* subfolder : {"checkpoints", "manifests"}) make_folder(folder / subfolder);
  for (const RunLineage& stage : facts.stages) {
    for (const CheckpointHistory& c : stage.checkpoints) {
      const std::string path = path_of_checkpoint(c.sha256());
      if (!c.kept()) {  // delete the file if an earlier export wrote it
        fs::remove(folder / path);
        continue;
      }
      const std::vector<std::byte> bytes = store.read_file(c.record);
      write_output(folder / path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
      written.push_back(path);
    }
  }
  for (const ManifestText& manifest : facts.manifests) {
    written.push_back(path_of_manifest(manifest.sha256));
    write_output(folder / written.back(), manifest.text);
  }
  // The metadata file describes the other files, so it is written last. Invalid UTF-8 is replaced.
  write_output(folder / kCrateMetadata,
               ro_crate_metadata(facts).dump(1, ' ', false, json::error_handler_t::replace) + '\n');
  written.emplace_back(kCrateMetadata);
  return written;
}

}  // namespace shearcell
