// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <string>

#include "provenance/ro_crate.hpp"

namespace shearcell {

namespace {

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
    if (checkpoint.rejected) entity["shearcell:rejected"] = true;
    if (checkpoint.pruned) entity["shearcell:pruned"] = true;
    if (checkpoint.kept()) entity["prov:location"] = crate_path_of_checkpoint(c.sha256);
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

}  // namespace

json prov_json(const CrateFacts& facts) {
  return Document(facts).build();
}

}  // namespace shearcell
