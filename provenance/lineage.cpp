// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/lineage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {

namespace {

using nlohmann::json;

/// Folds the events of one run. Types that say nothing about attempts or checkpoints change
/// nothing.
class Folding {
 public:
  explicit Folding(RunLineage& lineage) : lineage_(lineage) {}

  void take(const Event& event) {
    try {
      const json body = event.body();
      if (event.type == "RunStarted" || event.type == "RunResumed") begin(event, body);
      if (event.type == "RunCompleted") end(event, AttemptOutcome::completed, "");
      if (event.type == "RunInterrupted") {
        end(event, AttemptOutcome::interrupted, body.at("why").get<std::string>());
      }
      if (event.type == "RunFailed") {
        end(event, AttemptOutcome::failed, body.at("why").get<std::string>());
      }
      if (event.type == "CheckpointRecorded") record(event, body);
      if (event.type == "CheckpointRejected") {
        if (CheckpointHistory* known = find(body)) known->rejected = true;
      }
      if (event.type == "CheckpointPruned" || event.type == "CheckpointRegenerated") {
        if (CheckpointHistory* known = find(body)) known->pruned = event.type == "CheckpointPruned";
      }
    } catch (const json::exception& problem) {
      throw damaged_payload(event, problem);
    }
  }

 private:
  void begin(const Event& event, const json& body) {
    if (!lineage_.attempts.empty() && lineage_.attempts.back().outcome == AttemptOutcome::running) {
      lineage_.attempts.back().outcome = AttemptOutcome::lost;
    }
    Attempt attempt;
    attempt.seq = event.seq;
    attempt.started_at = event.recorded_at;
    if (body.contains("host") && body["host"].is_object()) attempt.host = body["host"];
    if (body.contains("from")) {
      attempt.from_run = lineage_.run.id;
      attempt.from_checkpoint = body["from"].at("sha256").get<std::string>();
    } else if (body.contains("parent_checkpoint") && body["parent_checkpoint"].is_string()) {
      attempt.from_run = lineage_.run.parent;
      attempt.from_checkpoint = body["parent_checkpoint"].get<std::string>();
    }
    lineage_.attempts.push_back(std::move(attempt));
  }

  void end(const Event& event, AttemptOutcome outcome, const std::string& why) {
    if (lineage_.attempts.empty()) return;
    Attempt& attempt = lineage_.attempts.back();
    attempt.outcome = outcome;
    attempt.ended_at = event.recorded_at;
    attempt.why = why;
  }

  void record(const Event& event, const json& body) {
    CheckpointHistory checkpoint;
    CheckpointRecord& c = checkpoint.record;
    c.run = lineage_.run.id;
    c.step = count_at(body, "step");
    body.at("cycle").get_to(c.cycle);
    body.at("time_s").get_to(c.time_s);
    c.size = count_at(body, "size");
    body.at("sha256").get_to(c.sha256);
    body.at("state_hash").get_to(c.state_hash);
    if (!is_sha256_hex(c.sha256)) {
      throw StoreDamaged(fmt::format("event {} ({} of {}): '{:.64}' is no SHA-256", event.seq,
                                     event.type, event.stream, c.sha256));
    }
    c.file = ObjectStore::file_of(c.sha256);
    c.seq = event.seq;
    checkpoint.recorded_at = event.recorded_at;
    if (!lineage_.attempts.empty()) {
      checkpoint.attempt = lineage_.attempts.size() - 1;
      lineage_.attempts.back().checkpoints.push_back(c.sha256);
    }
    if (CheckpointHistory* known = find(body)) {
      *known = std::move(checkpoint);  // recorded again after it was rejected
    } else {
      lineage_.checkpoints.push_back(std::move(checkpoint));
    }
  }

  CheckpointHistory* find(const json& body) {
    const auto& sha256 = body.at("sha256").get_ref<const std::string&>();
    for (CheckpointHistory& known : lineage_.checkpoints) {
      if (known.record.sha256 == sha256) return &known;
    }
    return nullptr;
  }

  RunLineage& lineage_;
};

/// The state of the run from which another stage would have begun just before event `seq`.
std::string newest_before(const RunRecord& run, const std::vector<Event>& events,
                          std::uint64_t seq) {
  RunLineage then{run, {}, {}};
  Folding folding(then);
  for (const Event& event : events) {
    if (event.seq < seq) folding.take(event);
  }
  const CheckpointHistory* newest = nullptr;
  for (const CheckpointHistory& c : then.checkpoints) {
    if (c.rejected || c.pruned) continue;
    if (newest == nullptr || c.record.step >= newest->record.step) newest = &c;
  }
  return newest == nullptr ? "" : newest->record.sha256;
}

}  // namespace

const char* name_of(AttemptOutcome outcome) {
  switch (outcome) {
    case AttemptOutcome::running:
      return "running";
    case AttemptOutcome::completed:
      return "completed";
    case AttemptOutcome::interrupted:
      return "interrupted";
    case AttemptOutcome::failed:
      return "failed";
    case AttemptOutcome::lost:
      return "lost";
  }
  return "unknown";
}

const CheckpointHistory* RunLineage::find(std::string_view sha256) const {
  const auto found =
      std::find_if(checkpoints.begin(), checkpoints.end(),
                   [&](const CheckpointHistory& c) { return c.record.sha256 == sha256; });
  return found == checkpoints.end() ? nullptr : &*found;
}

std::vector<RunLineage> run_lineage(const Store& store, const std::string& id) {
  std::vector<RunRecord> chain;
  std::set<std::string> seen;
  for (std::string next = id; !next.empty() && seen.insert(next).second;) {
    chain.push_back(store.run(next));
    next = chain.back().parent;
  }
  std::reverse(chain.begin(), chain.end());
  std::vector<RunLineage> stages;
  std::vector<Event> before;
  for (const RunRecord& run : chain) {
    RunLineage stage{run, {}, {}};
    std::vector<Event> events = store.events("run/" + run.id);
    Folding folding(stage);
    for (const Event& event : events) folding.take(event);
    for (Attempt& attempt : stage.attempts) {
      if (!attempt.from_checkpoint.empty() || stages.empty()) continue;
      attempt.from_checkpoint = newest_before(stages.back().run, before, attempt.seq);
      if (!attempt.from_checkpoint.empty()) attempt.from_run = run.parent;
    }
    stages.push_back(std::move(stage));
    before = std::move(events);
  }
  return stages;
}

std::optional<ManifestText> find_manifest(const Store& store, const std::string& sha256) {
  for (const Event& event : store.events("manifest/" + sha256)) {
    if (event.type != "ManifestRegistered") continue;
    const json body = event.body();
    const auto text = [&](const char* key) {
      return body.contains(key) && body[key].is_string() ? body[key].get<std::string>() : "";
    };
    ManifestText manifest{sha256, text("path"), text("text"), event.recorded_at};
    if (sha256_hex(manifest.text) != sha256) {
      throw StoreDamaged(fmt::format(
          "event {} (ManifestRegistered): its text has another SHA-256 than the manifest's; run "
          "`verify`",
          event.seq));
    }
    return manifest;
  }
  return std::nullopt;
}

}  // namespace shearcell
