// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/lineage.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {

namespace {

using nlohmann::json;

/// Collects the attempts of one run from its events. Other events are ignored.
class LineageBuilder {
 public:
  LineageBuilder(RunLineage& lineage, const Event& event) : lineage_(lineage), event_(event) {}

  void operator()(const events::RunStarted& e) {
    begin(e, lineage_.stage.parent, e.parent_checkpoint.value_or(""));
  }
  void operator()(const events::RunResumed& e) { begin(e, lineage_.stage.id, e.from.sha256); }
  void operator()(const events::RunCompleted&) { end(AttemptOutcome::completed, ""); }
  void operator()(const events::RunInterrupted& e) { end(AttemptOutcome::interrupted, e.why); }
  void operator()(const events::RunFailed& e) { end(AttemptOutcome::failed, e.why); }

  void operator()(const events::CheckpointRecorded& e) {
    const std::string& sha256 = e.checkpoint.sha256;
    const auto known = std::ranges::find(lineage_.checkpoints, sha256, &CheckpointHistory::sha256);
    if (!is_sha256_hex(sha256) || known == lineage_.checkpoints.end()) {
      throw StoreDamaged(
          fmt::format("event {} ({} of {}): '{:.64}' is not a SHA-256, or the "
                      "checkpoint is missing in the tables; run `verify`",
                      event_.seq, event_.type, event_.stream, sha256));
    }
    known->recorded_at = event_.recorded_at;
    if (lineage_.attempts.empty()) return;
    known->attempt = lineage_.attempts.size() - 1;
    lineage_.attempts.back().checkpoints.push_back(sha256);
  }
  void operator()(const auto&) {}

 private:
  void begin(const events::AttemptBegun& begun, const std::string& from_run,
             const std::string& from_checkpoint) {
    if (!lineage_.attempts.empty() && lineage_.attempts.back().outcome == AttemptOutcome::running) {
      lineage_.attempts.back().outcome = AttemptOutcome::lost;
    }
    Attempt& attempt = lineage_.attempts.emplace_back();
    attempt.seq = event_.seq;
    attempt.started_at = event_.recorded_at;
    if (begun.host.is_object()) attempt.host = begun.host;
    // Early events do not record bits_version. The programs that wrote these events had the
    // bits_version 1 or 2, the same number as the layout of the payload (`schema`).
    attempt.bits_version = begun.bits_version.value_or(std::min<std::uint64_t>(event_.schema, 2));
    if (from_checkpoint.empty()) return;
    attempt.from_run = from_run;
    attempt.from_checkpoint = from_checkpoint;
  }

  void end(AttemptOutcome outcome, const std::string& why) {
    if (lineage_.attempts.empty()) return;
    Attempt& attempt = lineage_.attempts.back();
    attempt.outcome = outcome;
    attempt.ended_at = event_.recorded_at;
    attempt.why = why;
  }

  RunLineage& lineage_;
  const Event& event_;
};

/// The newest checkpoint of the attempts that began before event `seq`; "" if there is none.
std::string newest_before(const RunLineage& run, std::uint64_t seq) {
  const CheckpointHistory* newest = nullptr;
  for (const CheckpointHistory& c : run.checkpoints) {
    if (!c.attempt || run.attempts[*c.attempt].seq > seq) continue;
    if (newest == nullptr || c.record.step >= newest->record.step) newest = &c;
  }
  return newest == nullptr ? "" : newest->record.sha256;
}

}  // namespace

Maker maker_of(const json& host) {
  const json build = member_of(host, "build"), libraries = member_of(host, "libraries");
  Maker maker;
  maker.version = fmt::format("{} ({})", text_at(build, "version"), text_at(build, "commit"));
  maker.program = fmt::format("shearcell {}, {} {}", maker.version, text_at(build, "compiler"),
                              text_at(build, "type"));
  maker.flags = text_at(build, "flags");
  for (const auto& [name, version] : libraries.items()) {
    maker.libraries.push_back(name + " " + short_text(version));
  }
  maker.host = text_at(host, "host");
  maker.system = text_at(host, "system");
  maker.machine = fmt::format("{}, {} cores, {}", text_at(host, "cpu"), text_at(host, "cores"),
                              text_at(host, "simd"));
  return maker;
}

const CheckpointHistory* RunLineage::find(std::string_view sha256) const {
  const auto found = std::ranges::find(checkpoints, sha256, &CheckpointHistory::sha256);
  return found == checkpoints.end() ? nullptr : &*found;
}

std::vector<Stage> chain_of(const Store& store, const std::string& id) {
  std::vector<Stage> chain = {store.stage(id)};
  std::set<std::string> seen = {id};  // a forged record may be its own parent
  while (!chain.front().parent.empty() && seen.insert(chain.front().parent).second) {
    chain.insert(chain.begin(), store.stage(chain.front().parent));
  }
  return chain;
}

std::vector<RunLineage> run_lineage(const Store& store, const std::string& id) {
  const Store::Snapshot snapshot(store);
  std::vector<RunLineage> stages;
  for (Stage& recorded : chain_of(store, id)) {
    RunLineage stage{std::move(recorded), {}, {}};
    for (CheckpointRecord& record : store.checkpoints(stage.stage.id, Listed::all)) {
      stage.checkpoints.push_back({std::move(record), "", std::nullopt});
    }
    for (const Event& event : store.events(run_stream(stage.stage.id))) {
      std::visit(LineageBuilder(stage, event), events::decode(event));
    }
    std::erase_if(stage.checkpoints, [](const CheckpointHistory& c) {
      return c.recorded_at.empty() && !c.attempt;  // no event: the table was changed by hand
    });
    for (Attempt& attempt : stage.attempts) {
      if (!attempt.from_checkpoint.empty() || stages.empty()) continue;
      // Events of early program versions do not contain the initial state. In these versions, the
      // initial state was always the newest checkpoint of the parent.
      attempt.from_checkpoint = newest_before(stages.back(), attempt.seq);
      if (!attempt.from_checkpoint.empty()) attempt.from_run = stage.stage.parent;
    }
    stages.push_back(std::move(stage));
  }
  return stages;
}

void add_run_lineage(const Store& store, const std::string& id, RunLineages& lineages) {
  if (lineages.contains(id)) return;
  for (RunLineage& stage : run_lineage(store, id)) {
    const std::string stage_id = stage.stage.id;
    lineages.try_emplace(stage_id, std::move(stage));
  }
}

ComputingTime computing_time(const Store& store, const std::string& id, double last_cycle) {
  ComputingTime time;
  json host;
  for (const Event& event : store.events(run_stream(id))) {
    if (events::begins_attempt(event)) host = member_of(event.body(), "host");
    if (event.type != events::CheckpointRecorded::kType) continue;
    const auto recorded = std::get<events::CheckpointRecorded>(events::decode(event));
    if (recorded.checkpoint.cycle > last_cycle) continue;
    const json processes = member_of(member_of(host, "engine"), "processes");
    const double cores = processes.is_number_unsigned() ? processes.get<double>() : 1;
    time.core_seconds +=
        recorded.effort.core_seconds.value_or(cores * recorded.effort.wall_seconds);
    time.processors.insert(text_at(host, "cpu"));
  }
  return time;
}

std::optional<ManifestText> find_manifest(const Store& store, const std::string& sha256) {
  for (const Event& event : store.events("manifest/" + sha256, events::ManifestRegistered::kType)) {
    auto found = std::get<events::ManifestRegistered>(events::decode(event));
    if (sha256_hex(found.text) != sha256) {
      throw StoreDamaged(fmt::format(
          "event {} (ManifestRegistered): the SHA-256 of its text differs from the SHA-256 in the "
          "stream name; run `verify`",
          event.seq));
    }
    found.sha256 = sha256;  // a forged payload may contain another SHA-256
    return ManifestText{std::move(found), event.recorded_at};
  }
  return std::nullopt;
}

}  // namespace shearcell
