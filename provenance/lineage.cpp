// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/lineage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "provenance/errors.hpp"
#include "provenance/events.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {

namespace {

using nlohmann::json;

/// Folds the events of one run into its lineage. Other events change nothing.
class Fold {
 public:
  explicit Fold(RunLineage& lineage) : lineage_(lineage) {}

  void take(const Event& event) {
    std::visit(events::Overloaded{
                   [&](const events::RunStarted& e) {
                     begin(event, e.host, lineage_.run.parent, e.parent_checkpoint.value_or(""));
                   },
                   [&](const events::RunResumed& e) {
                     begin(event, e.host, lineage_.run.id, e.from.sha256);
                   },
                   [&](const events::RunCompleted&) { end(event, AttemptOutcome::completed, ""); },
                   [&](const events::RunInterrupted& e) {
                     end(event, AttemptOutcome::interrupted, e.why);
                   },
                   [&](const events::RunFailed& e) { end(event, AttemptOutcome::failed, e.why); },
                   [&](const events::CheckpointRecorded& e) { record(event, e); },
                   [&](const events::CheckpointRejected& e) {
                     mark(e.sha256, &CheckpointHistory::rejected, true);
                   },
                   [&](const events::CheckpointPruned& e) {
                     mark(e.sha256, &CheckpointHistory::pruned, true);
                   },
                   [&](const events::CheckpointRegenerated& e) {
                     mark(e.sha256, &CheckpointHistory::pruned, false);
                   },
                   [](const auto&) {}},
               events::decode(event));
  }

 private:
  void begin(const Event& event, const json& host, const std::string& from_run,
             const std::string& from_checkpoint) {
    if (!lineage_.attempts.empty() && lineage_.attempts.back().outcome == AttemptOutcome::running) {
      lineage_.attempts.back().outcome = AttemptOutcome::lost;
    }
    Attempt& attempt = lineage_.attempts.emplace_back();
    attempt.seq = event.seq;
    attempt.started_at = event.recorded_at;
    if (host.is_object()) attempt.host = host;
    if (from_checkpoint.empty()) return;
    attempt.from_run = from_run;
    attempt.from_checkpoint = from_checkpoint;
  }

  void end(const Event& event, AttemptOutcome outcome, const std::string& why) {
    if (lineage_.attempts.empty()) return;
    Attempt& attempt = lineage_.attempts.back();
    attempt.outcome = outcome;
    attempt.ended_at = event.recorded_at;
    attempt.why = why;
  }

  void record(const Event& event, const events::CheckpointRecorded& e) {
    if (!is_sha256_hex(e.sha256)) {
      throw StoreDamaged(fmt::format("event {} ({} of {}): '{:.64}' is not a SHA-256", event.seq,
                                     event.type, event.stream, e.sha256));
    }
    CheckpointHistory checkpoint;
    checkpoint.record = {.run = lineage_.run.id,
                         .step = e.step,
                         .cycle = e.cycle,
                         .time_s = e.time_s,
                         .file = ObjectStore::file_of(e.sha256),
                         .size = e.size,
                         .sha256 = e.sha256,
                         .state_hash = e.state_hash,
                         .observables = {},
                         .seq = event.seq};
    checkpoint.recorded_at = event.recorded_at;
    if (!lineage_.attempts.empty()) {
      checkpoint.attempt = lineage_.attempts.size() - 1;
      lineage_.attempts.back().checkpoints.push_back(e.sha256);
    }
    if (CheckpointHistory* known = find(e.sha256)) {
      *known = std::move(checkpoint);  // recorded again after it was rejected
    } else {
      lineage_.checkpoints.push_back(std::move(checkpoint));
    }
  }

  void mark(const std::string& sha256, bool CheckpointHistory::*property, bool value) {
    if (CheckpointHistory* known = find(sha256)) known->*property = value;
  }

  CheckpointHistory* find(const std::string& sha256) {
    for (CheckpointHistory& known : lineage_.checkpoints) {
      if (known.record.sha256 == sha256) return &known;
    }
    return nullptr;
  }

  RunLineage& lineage_;
};

/// The newest checkpoint of the run that had a file just before event `seq`; "" without any.
std::string newest_before(const RunRecord& run, const std::vector<Event>& events,
                          std::uint64_t seq) {
  RunLineage then{run, {}, {}};
  Fold fold(then);
  for (const Event& event : events) {
    if (event.seq < seq) fold.take(event);
  }
  const CheckpointHistory* newest = nullptr;
  for (const CheckpointHistory& c : then.checkpoints) {
    if (c.rejected || c.pruned) continue;
    if (newest == nullptr || c.record.step >= newest->record.step) newest = &c;
  }
  return newest == nullptr ? "" : newest->record.sha256;
}

}  // namespace

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
    Fold fold(stage);
    for (const Event& event : events) fold.take(event);
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
    if (event.type != events::ManifestRegistered::kType) continue;
    auto found = std::get<events::ManifestRegistered>(events::decode(event));
    if (sha256_hex(found.text) != sha256) {
      throw StoreDamaged(fmt::format(
          "event {} (ManifestRegistered): its text has another SHA-256 than the manifest; run "
          "`verify`",
          event.seq));
    }
    return ManifestText{sha256, std::move(found.path), std::move(found.text), event.recorded_at};
  }
  return std::nullopt;
}

}  // namespace shearcell
