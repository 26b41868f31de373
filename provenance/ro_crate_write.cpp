// SPDX-License-Identifier: GPL-3.0-or-later
// The folder of a crate, and prov.json in it.
#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "provenance/io/file.hpp"
#include "provenance/json_text.hpp"
#include "provenance/limits.hpp"
#include "provenance/ro_crate.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json qualified(const char* name) {
  return {{"$", name}, {"type", "prov:QUALIFIED_NAME"}};
}

std::string checkpoint_id(const std::string& sha256) {
  return "shearcell:checkpoint-" + sha256;
}

class Document {
 public:
  explicit Document(const CrateFacts& facts) : facts_(facts) {}

  json build() {
    document_["prefix"] = {{"shearcell", "urn:x-shearcell:"}};
    for (const ManifestText& manifest : facts_.manifests) add_manifest(manifest);
    for (const RunLineage& stage : facts_.stages) {
      add_parameters(stage.run);
      for (const CheckpointHistory& checkpoint : stage.checkpoints) add_checkpoint(checkpoint);
      for (std::size_t a = 0; a < stage.attempts.size(); ++a) add_attempt(stage, a);
    }
    return std::move(document_);
  }

 private:
  void add_manifest(const ManifestText& manifest) {
    document_["entity"]["shearcell:manifest-" + manifest.sha256] = {
        {"prov:type", qualified("prov:Plan")},
        {"prov:location", crate_path_of_manifest(manifest.sha256)},
        {"shearcell:sha256", manifest.sha256}};
  }

  void add_parameters(const RunRecord& run) {
    document_["entity"]["shearcell:parameters-" + run.id] = {
        {"prov:label", "Resolved parameters and seed of a run"},
        {"shearcell:run", run.id},
        {"shearcell:resolved", run.resolved.dump()}};
  }

  void add_checkpoint(const CheckpointHistory& checkpoint) {
    const CheckpointRecord& c = checkpoint.record;
    json entity = {{"prov:type", qualified("shearcell:Checkpoint")},
                   {"shearcell:sha256", c.sha256},
                   {"shearcell:state", c.state_hash},
                   {"shearcell:run", c.run},
                   {"shearcell:cycle", c.cycle},
                   {"shearcell:step", c.step}};
    if (checkpoint.kept()) {
      entity["prov:location"] = crate_path_of_checkpoint(c.sha256);
    } else {
      entity[fmt::format("shearcell:{}", name_of(c.state))] = true;
    }
    document_["entity"][checkpoint_id(c.sha256)] = std::move(entity);
  }

  std::string add_agent(const json& host) {
    const json build = host.value("build", json::object());
    const json libraries = host.value("libraries", json::object());
    std::string id = "shearcell:build-" + build_digest(host);
    document_["agent"][id] = {{"prov:type", qualified("prov:SoftwareAgent")},
                              {"prov:label", "shearcell"},
                              {"shearcell:build", build.dump()},
                              {"shearcell:libraries", libraries.dump()}};
    return id;
  }

  void add_attempt(const RunLineage& stage, std::size_t a) {
    const Attempt& attempt = stage.attempts[a];
    const std::string id = fmt::format("shearcell:attempt-{}-{}", stage.run.id, a + 1);
    json machine = attempt.host;
    machine.erase("build");
    machine.erase("libraries");
    json activity = {{"prov:startTime", attempt.started_at},
                     {"prov:type", qualified("shearcell:Attempt")},
                     {"shearcell:run", stage.run.id},
                     {"shearcell:outcome", name_of(attempt.outcome)},
                     {"shearcell:host", machine.dump()}};
    if (!attempt.ended_at.empty()) activity["prov:endTime"] = attempt.ended_at;
    if (!attempt.why.empty()) activity["shearcell:why"] = attempt.why;
    document_["activity"][id] = std::move(activity);

    json association = {{"prov:activity", id}, {"prov:agent", add_agent(attempt.host)}};
    for (const Membership& member : stage.run.memberships) {
      const std::string plan = "shearcell:manifest-" + member.manifest;
      if (document_["entity"].contains(plan)) association["prov:plan"] = plan;
    }
    relate("wasAssociatedWith", std::move(association));
    relate("used",
           {{"prov:activity", id}, {"prov:entity", "shearcell:parameters-" + stage.run.id}});
    std::string before;
    if (facts_.initial_state(attempt) != nullptr) {
      before = checkpoint_id(attempt.from_checkpoint);
      relate("used", {{"prov:activity", id}, {"prov:entity", before}});
    }
    for (const std::string& sha256 : attempt.checkpoints) {
      const CheckpointHistory& checkpoint = *stage.find(sha256);
      const std::string made = checkpoint_id(sha256);
      if (checkpoint.attempt == a) add_generation(checkpoint, id, before);
      before = made;
    }
  }

  void add_generation(const CheckpointHistory& checkpoint, const std::string& activity,
                      const std::string& before) {
    const std::string made = checkpoint_id(checkpoint.record.sha256);
    relate("wasGeneratedBy", {{"prov:entity", made},
                              {"prov:activity", activity},
                              {"prov:time", checkpoint.recorded_at}});
    if (before.empty() || before == made) return;
    relate(
        "wasDerivedFrom",
        {{"prov:generatedEntity", made}, {"prov:usedEntity", before}, {"prov:activity", activity}});
  }

  void relate(const char* kind, json relation) {
    document_[kind][fmt::format("_:r{}", ++relations_)] = std::move(relation);
  }

  const CrateFacts& facts_;
  json document_;
  std::size_t relations_ = 0;
};

/// Bytes that are not UTF-8 are replaced.
std::string dump(const json& value) {
  return value.dump(1, ' ', false, json::error_handler_t::replace) + '\n';
}

bool is_crate_of(const fs::path& folder, const std::string& run) {
  const auto text = read_plain(folder / kCrateMetadata, StoreLimits::value_bytes);
  const json graph = member_of(parse_json(text.value_or("")), "@graph");
  return graph.is_array() && std::any_of(graph.begin(), graph.end(), [&](const json& entity) {
           return member_of(entity, "@id") == "./" &&
                  member_of(entity, "identifier") == crate_identifier(run);
         });
}

/// Creates a folder in the crate; a link is refused.
void make_subfolder(const fs::path& crate, const char* name) {
  const fs::path path = crate / name;
  const fs::file_status status = fs::symlink_status(path);
  if (fs::exists(status) && !fs::is_directory(status)) {
    throw std::invalid_argument(path.string() +
                                ": this must be a folder, but it is a file or a link; remove it");
  }
  fs::create_directory(path);
}

std::vector<std::string> fill(const Store& store, const CrateFacts& facts, const fs::path& folder) {
  const ObjectStore objects(store.folder());
  std::vector<std::string> written;
  for (const char* subfolder : {"checkpoints", "manifests"}) make_subfolder(folder, subfolder);
  std::set<std::string> done;
  for (const RunLineage& stage : facts.stages) {
    for (const CheckpointHistory& c : stage.checkpoints) {
      if (!c.kept() || !done.insert(c.record.sha256).second) continue;
      const std::vector<std::byte> bytes = objects.get(c.record.sha256, c.record.size);
      const std::string path = crate_path_of_checkpoint(c.record.sha256);
      write_output(folder / path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
      written.push_back(path);
    }
  }
  // An earlier export wrote what was pruned or rejected since.
  for (const RunLineage& stage : facts.stages) {
    for (const CheckpointHistory& c : stage.checkpoints) {
      if (!done.contains(c.sha256())) fs::remove(folder / crate_path_of_checkpoint(c.sha256()));
    }
  }
  for (const ManifestText& manifest : facts.manifests) {
    written.push_back(crate_path_of_manifest(manifest.sha256));
    write_output(folder / written.back(), manifest.text);
  }
  const std::string prov = dump(prov_json(facts));
  write_output(folder / kCrateProv, prov);
  written.emplace_back(kCrateProv);
  // Last, because it describes the other files.
  write_output(folder / kCrateMetadata, dump(ro_crate_metadata(facts, prov)));
  written.emplace_back(kCrateMetadata);
  return written;
}

}  // namespace

json prov_json(const CrateFacts& facts) {
  return Document(facts).build();
}

std::vector<std::string> write_ro_crate(const Store& store, const std::string& run,
                                        const fs::path& where, const std::string& licence) {
  const CrateFacts facts = crate_facts(store, run, licence);
  // "crate/" has no file name; "crate" is the same folder.
  const fs::path given = fs::absolute(where);
  const fs::path folder = given.has_filename() ? given : given.parent_path();
  const fs::file_status status = fs::symlink_status(folder);
  if (fs::exists(status) && !fs::is_directory(status)) {
    throw std::invalid_argument(folder.string() +
                                ": this is a file or a link; name another folder");
  }
  if (fs::exists(status) && !fs::is_empty(folder)) {
    if (!is_crate_of(folder, run)) {
      throw std::invalid_argument(folder.string() +
                                  ": the folder is not an export of this run; name another one");
    }
    return fill(store, facts, folder);
  }
  // On the same file system as the folder, to be renamed to it.
  fs::create_directories(folder.parent_path());
  const TemporaryFolder beside(folder.parent_path() /
                               fmt::format(".{}.tmp-", folder.filename().string()));
  const fs::path staged = beside.path() / "crate";
  fs::create_directory(staged);
  std::vector<std::string> written = fill(store, facts, staged);
  fs::rename(staged, folder);
  return written;
}

}  // namespace shearcell
