// SPDX-License-Identifier: GPL-3.0-or-later
// Maintenance of the store: verify, rebuild, prune, regenerate, merge.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "provenance/events.hpp"
#include "provenance/projections.hpp"
#include "provenance/queries.hpp"
#include "provenance/sha256.hpp"
#include "provenance/store.hpp"

namespace shearcell {

namespace {

/// Checkpoints that are initial states of other stages.
std::set<std::string> initial_states(const EventLog& log) {
  std::set<std::string> found;
  log.for_each([&found](const Event& event) {
    if (event.type != events::RunStarted::kType) return;
    const auto started = std::get<events::RunStarted>(events::decode(event));
    if (started.parent_checkpoint) found.insert(*started.parent_checkpoint);
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
    needed = initial_states(log_);
  }
  std::vector<CheckpointRecord> found;
  for (const RunRecord& run : runs()) {
    if (!chosen(choice, run)) continue;
    std::vector<CheckpointRecord> records = checkpoints(run.id);
    if (records.empty()) continue;
    // The newest is kept, and all back to the newest that can be read.
    while (!records.empty()) {
      const CheckpointRecord newest = std::move(records.back());
      records.pop_back();
      try {
        load_checkpoint(newest);
        break;
      } catch (const StoreDamaged&) {
        // Kept as well: `resume` reports it.
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
    // One transaction: all checkpoints are recorded as pruned, or none.
    sqlite::WriteTransaction lock(database_);
    for (const CheckpointRecord& record : records) {
      const auto now = query_checkpoint(database_, record.run, record.sha256);
      const RunRecord run = query_runs(database_, record.run).at(0);
      if (!now || now->state != CheckpointState::recorded || now->step >= run.step) continue;
      append(run_stream(record.run), events::encode(events::CheckpointPruned(*now)), lock);
    }
    lock.commit();
  }
  std::uint64_t freed = 0;
  for (const CheckpointRecord& record : records) {
    // Under the lock, so that the file is not recorded again between the check and the removal.
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
    throw StoreDamaged(
        fmt::format("checkpoint {:.12} of run {:.12}: the regenerated one has state {:.12} instead "
                    "of {:.12} and "
                    "file {:.12}; it was not stored",
                    record.sha256, record.run, state, record.state_hash, sha256));
  }
  for (;;) {
    objects_.put(bytes);
    const std::scoped_lock guard(mutex_);
    sqlite::WriteTransaction lock(database_);
    if (!objects_.contains(sha256)) continue;  // a concurrent `prune` deleted it
    const auto now = query_checkpoint(database_, record.run, sha256);
    if (!now) throw unknown_checkpoint(record.run, sha256);
    if (now->state == CheckpointState::recorded) return;
    append(run_stream(record.run), events::encode(events::CheckpointRegenerated(*now)), lock);
    lock.commit();
    return;
  }
}

void Store::record_replay(const std::string& id, bool same, const nlohmann::json& facts) {
  run(id);  // throws when it is unknown
  record(run_stream(id), same ? events::encode(events::ReplayVerified{facts})
                              : events::encode(events::ReplayDiverged{facts}));
}

std::vector<MergeReport> Store::merge(const std::vector<std::filesystem::path>& folders,
                                      const std::set<std::string>& runs) {
  must_write();
  const auto require_idle = [this] {
    for (const Lease& lease : query_leases(database_)) {
      if (lapsed(lease, now_ms())) continue;
      throw StoreBusy(fmt::format("{}: a program computes run {:.12} ({}); merge when it has ended",
                                  folder_.string(), lease.run, describe(lease.holder)));
    }
  };
  std::vector<MergeSource> sources;
  for (const std::filesystem::path& folder : folders) {
    std::error_code ignored;
    if (std::filesystem::equivalent(folder, folder_, ignored)) {
      throw NotFound(folder.string() + ": a store cannot be merged into itself; name another one");
    }
    sources.push_back(read_merge_source(folder, runs));
  }
  const std::scoped_lock guard(mutex_);
  require_idle();
  // All checks are made before the first byte is written.
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
