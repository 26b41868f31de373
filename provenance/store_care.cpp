// SPDX-License-Identifier: GPL-3.0-or-later
// Maintenance of the store: verify, rebuild, prune, regenerate, merge.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "provenance/events.hpp"
#include "provenance/projections.hpp"
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
  return (choice.runs.empty() || std::ranges::count(choice.runs, run.id) > 0) &&
         (!choice.state || run.state == *choice.state);
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
  const std::scoped_lock guard(mutex_);
  const std::set<std::string> needed = initial_states(log_);
  const auto readable = [this](const CheckpointRecord& record) {
    try {
      load_checkpoint(record);
      return true;
    } catch (const StoreDamaged&) {
      return false;  // kept as well: `resume` reports it
    }
  };
  std::vector<CheckpointRecord> found;
  for (const RunRecord& run : runs()) {
    if (!chosen(choice, run)) continue;
    // The newest is kept, and all back to the newest that can be read.
    std::vector<CheckpointRecord> records = checkpoints(run.id);
    bool kept = false;
    while (!records.empty() && !kept) {
      kept = readable(records.back());
      records.pop_back();
    }
    for (CheckpointRecord& record : records) {
      if (needed.contains(record.sha256) || kept_by_cadence(choice, record)) continue;
      found.push_back(std::move(record));
    }
  }
  return found;
}

std::vector<CheckpointRecord> Store::prune_leftovers() const {
  const std::scoped_lock guard(mutex_);
  std::vector<CheckpointRecord> found = query_checkpoints(database_);
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
      const auto run = query_run(database_, record.run);
      if (!now || now->state != CheckpointState::recorded || !run || now->step >= run->step)
        continue;
      append(run_stream(record.run), events::encode(events::CheckpointPruned{{*now}}), lock);
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
    append(run_stream(record.run), events::encode(events::CheckpointRegenerated{{*now}}), lock);
    lock.commit();
    return;
  }
}

void Store::record_replay(const std::string& id, bool same, const nlohmann::json& facts) {
  run(id);  // throws when it is unknown
  record(run_stream(id), {same ? "ReplayVerified" : "ReplayDiverged", facts});
}

std::vector<MergeReport> Store::merge(const std::vector<std::filesystem::path>& sources,
                                      const std::set<std::string>& runs) {
  must_write();
  const std::scoped_lock guard(mutex_);
  return merge_stores(database_, log_, objects_, folder_, sources, runs);
}

}  // namespace shearcell
