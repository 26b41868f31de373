// SPDX-License-Identifier: GPL-3.0-or-later
// The store's care for what it holds: proving, freeing, restoring, merging.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "provenance/json_text.hpp"
#include "provenance/projections.hpp"
#include "provenance/queries.hpp"
#include "provenance/sha256.hpp"
#include "provenance/store.hpp"

namespace shearcell {

namespace {

using nlohmann::json;

/// Checkpoints from which other stages began, as their attempts noted.
std::set<std::string> beginnings_of_others(const EventLog& log) {
  std::set<std::string> found;
  log.for_each([&found](const Event& event) {
    if (event.type != "RunStarted") return;
    try {
      const json body = event.body();
      const json& parent = body.at("parent_checkpoint");
      if (parent.is_string()) found.insert(parent.get<std::string>());
    } catch (const json::exception& problem) {
      throw damaged_payload(event, problem);
    }
  });
  return found;
}

bool chosen(const PruneChoice& choice, const RunRecord& run) {
  const bool named = std::find(choice.runs.begin(), choice.runs.end(), run.id) != choice.runs.end();
  return (choice.runs.empty() || named) && (!choice.state || run.state == *choice.state);
}

bool kept_by_cadence(const PruneChoice& choice, const CheckpointRecord& record) {
  return choice.keep_every > 0 &&
         std::fmod(record.cycle, static_cast<double>(choice.keep_every)) == 0;
}

json describe_checkpoint(const CheckpointRecord& record) {
  return {{"sha256", record.sha256}, {"step", record.step}, {"cycle", record.cycle},
          {"file", record.file},     {"size", record.size}, {"state_hash", record.state_hash}};
}

}  // namespace

void Store::rebuild() {
  must_write();
  const std::scoped_lock guard(mutex_);
  rebuild_projections(database_, log_);
}

VerifyReport Store::verify(const std::optional<Head>& against) const {
  const std::scoped_lock guard(mutex_);
  return shearcell::verify(database_, log_, objects_, against);
}

std::vector<CheckpointRecord> Store::prunable(const PruneChoice& choice) const {
  std::set<std::string> needed;
  {
    const std::scoped_lock guard(mutex_);
    needed = beginnings_of_others(log_);
  }
  std::vector<CheckpointRecord> found;
  for (const RunRecord& run : runs()) {
    if (!chosen(choice, run)) continue;
    std::vector<CheckpointRecord> records = checkpoints(run.id);
    if (records.empty()) continue;
    // The newest, and from it backwards to the newest that can be read.
    while (!records.empty()) {
      const CheckpointRecord newest = std::move(records.back());
      records.pop_back();
      try {
        load_checkpoint(newest);
        break;
      } catch (const StoreDamaged&) {
        // Kept as well, because it is for `resume` to say what is wrong with it.
      }
    }
    for (CheckpointRecord& record : records) {
      if (needed.contains(record.sha256) || kept_by_cadence(choice, record)) continue;
      found.push_back(std::move(record));
    }
  }
  return found;
}

std::vector<CheckpointRecord> Store::prune_leftovers() const {
  std::vector<CheckpointRecord> found;
  {
    const std::scoped_lock guard(mutex_);
    found = query_checkpoints(database_);
  }
  std::erase_if(found, [this](const CheckpointRecord& record) {
    return record.state != CheckpointState::pruned || !objects_.contains(record.sha256);
  });
  return found;
}

std::uint64_t Store::prune(const std::vector<CheckpointRecord>& records) {
  must_write();
  const std::scoped_lock guard(mutex_);
  {
    // One transaction for all: the choice is recorded whole or not at all.
    sqlite::WriteTransaction lock(database_);
    for (const CheckpointRecord& record : records) {
      const auto now = query_checkpoint(database_, record.run, record.sha256);
      const RunRecord run = query_runs(database_, record.run).at(0);
      if (!now || now->state != CheckpointState::recorded || now->step >= run.step) continue;
      const std::string stream = "run/" + record.run;
      append(stream, log_.version(stream), {"CheckpointPruned", describe_checkpoint(*now)}, lock);
    }
    lock.commit();
  }
  std::uint64_t freed = 0;
  for (const CheckpointRecord& record : records) {
    // Under the lock, so that nobody records the file anew between the look and the removal.
    sqlite::WriteTransaction lock(database_);
    const auto now = query_checkpoint(database_, record.run, record.sha256);
    if (!now || now->state != CheckpointState::pruned) continue;
    if (objects_.remove(record.sha256)) freed += record.size;
  }
  return freed;
}

void Store::restore_checkpoint(const CheckpointRecord& record, const Checkpoint& checkpoint) {
  must_write();
  const std::vector<std::byte> bytes = encode_checkpoint(checkpoint);
  const std::string state = state_hash(checkpoint), sha256 = sha256_hex(bytes);
  if (checkpoint.run != record.run || state != record.state_hash || sha256 != record.sha256) {
    throw StoreDamaged(fmt::format(
        "checkpoint {:.12} of run {:.12}: computed again it has state {:.12} instead of {:.12} and "
        "file {:.12}; it was not kept",
        record.sha256, record.run, state, record.state_hash, sha256));
  }
  for (;;) {
    objects_.put(bytes);
    const std::scoped_lock guard(mutex_);
    sqlite::WriteTransaction lock(database_);
    if (!objects_.contains(sha256)) continue;  // a `prune` at work removed it just now
    const auto now = query_checkpoint(database_, record.run, sha256);
    if (!now) throw NotFound(fmt::format("run {}: it has no checkpoint {}", record.run, sha256));
    if (now->state == CheckpointState::recorded) return;
    const std::string stream = "run/" + record.run;
    append(stream, log_.version(stream), {"CheckpointRegenerated", describe_checkpoint(*now)},
           lock);
    lock.commit();
    return;
  }
}

void Store::record_replay(const std::string& id, bool same, const json& facts) {
  must_write();
  const std::scoped_lock guard(mutex_);
  sqlite::WriteTransaction lock(database_);
  if (query_runs(database_, id).empty()) throw unknown_run(id);
  append("run/" + id, log_.version("run/" + id),
         {same ? "ReplayVerified" : "ReplayDiverged", facts}, lock);
  lock.commit();
}

std::vector<MergeReport> Store::merge(const std::vector<std::filesystem::path>& folders,
                                      const std::set<std::string>& runs) {
  must_write();
  const auto require_idle = [this] {
    for (const Lease& lease : query_leases(database_)) {
      if (lapsed(lease, now_ms())) continue;
      throw StoreBusy(
          fmt::format("{}: a program is at work on run {:.12} ({}); merge when it has ended",
                      folder_.string(), lease.run, describe(lease.holder)));
    }
  };
  std::vector<MergeSource> sources;
  for (const std::filesystem::path& folder : folders) {
    std::error_code ignored;
    if (std::filesystem::equivalent(folder, folder_, ignored)) {
      throw NotFound(folder.string() + ": a store is not merged into itself; name another one");
    }
    sources.push_back(read_merge_source(folder, runs));
  }
  const std::scoped_lock guard(mutex_);
  require_idle();
  // Everything that may be refused is looked at before the first byte is written.
  require_agreement(database_, folder_.string(), sources);
  for (const MergeSource& source : sources) check_objects(database_, source);
  std::vector<MergeReport> reports;
  for (const MergeSource& source : sources) {
    MergeReport& report = reports.emplace_back();
    report.source = source.folder.string();
    report.head = source.head;
    copy_objects(database_, objects_, source, report);
    sqlite::WriteTransaction lock(database_);
    require_idle();
    merge_events(database_, log_, lock, source, report);
    lock.commit();
  }
  return reports;
}

}  // namespace shearcell
