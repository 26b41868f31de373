// SPDX-License-Identifier: GPL-3.0-or-later
// What the store holds: reading it, and rebuilding, pruning and restoring it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "provenance/events.hpp"
#include "provenance/io/clock.hpp"
#include "provenance/projections.hpp"
#include "provenance/sha256.hpp"
#include "provenance/store.hpp"

namespace shearcell {

namespace {

constexpr std::size_t kListed = 10;  // candidates of an ambiguous prefix

void require_one(const char* what, std::string_view prefix,
                 const std::vector<std::string>& candidates) {
  if (candidates.size() < 2) return;
  const bool more = candidates.size() == kListed;
  throw NotFound(fmt::format("several {} begin with '{}'; give more digits of one of\n  {}{}", what,
                             prefix, fmt::join(candidates, "\n  "), more ? "\n  ..." : ""));
}

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

/// Settling has no cycles, so of its checkpoints only the first is one of cycle 0.
bool kept_by_cadence(const PruneChoice& choice, const CheckpointRecord& record) {
  return choice.keep_every > 0 && (record.cycle > 0 || record.step == 0) &&
         std::fmod(record.cycle, static_cast<double>(choice.keep_every)) == 0;
}

}  // namespace

std::optional<LoadedCheckpoint> Store::newest_valid_checkpoint(const std::string& id,
                                                               std::vector<std::string>* damage,
                                                               std::uint64_t before_step) {
  std::vector<CheckpointRecord> records = checkpoints(id);
  std::ranges::reverse(records);
  for (const CheckpointRecord& record : records) {
    if (record.step >= before_step) continue;
    try {
      return LoadedCheckpoint{record, load_checkpoint(record)};
    } catch (const FilePruned&) {
      continue;
    } catch (const StoreDamaged& error) {
      if (damage == nullptr) continue;
      damage->push_back(error.what());
      if (access_ != Access::read) reject_checkpoint(id, record.sha256, error.what());
    }
  }
  return std::nullopt;
}

std::vector<Stage> Store::stages() const {
  const std::scoped_lock guard(mutex_);
  const sqlite::ReadTransaction snapshot(database_);
  return query_stages(database_);
}

Stage Store::stage(const std::string& id) const {
  const std::scoped_lock guard(mutex_);
  const sqlite::ReadTransaction snapshot(database_);
  auto found = query_stage(database_, id);
  if (!found) throw unknown_stage(id);
  return std::move(*found);
}

std::vector<Lease> Store::leases() const {
  const std::scoped_lock guard(mutex_);
  std::vector<Lease> found = query_leases(database_);
  const std::uint64_t now = now_ms();
  std::erase_if(found, [now](const Lease& lease) { return lapsed(lease, now); });
  return found;
}

Stage Store::find_stage(std::string_view prefix) const {
  const std::scoped_lock guard(mutex_);
  const std::vector<std::string> ids = query_stage_ids(database_, prefix, kListed);
  if (ids.empty()) throw unknown_stage(prefix);
  require_one("runs", prefix, ids);
  return stage(ids.front());
}

std::optional<CheckpointRecord> Store::find_checkpoint(std::string_view prefix) const {
  const std::scoped_lock guard(mutex_);
  const auto found = query_checkpoints_by_prefix(database_, prefix, kListed);
  if (found.empty()) return std::nullopt;
  std::vector<std::string> names;
  for (const CheckpointRecord& record : found) names.push_back(record.sha256);
  require_one("checkpoints", prefix, names);
  return found.front();
}

std::vector<CheckpointRecord> Store::checkpoints(const std::string& id, Listed listed) const {
  const std::scoped_lock guard(mutex_);
  if (!has_stage(database_, id)) throw unknown_stage(id);
  auto found = query_checkpoints(database_, id);
  std::erase_if(found, [listed](const CheckpointRecord& record) {
    return (record.state == CheckpointState::rejected && listed != Listed::all) ||
           (record.state == CheckpointState::pruned && listed == Listed::recorded);
  });
  return found;
}

Checkpoint Store::load_checkpoint(const CheckpointRecord& record) const {
  const std::string file = (folder_ / record.file).string();
  const auto require_kept = [&] {
    const std::scoped_lock guard(mutex_);
    const auto now = query_checkpoint(database_, record.run, record.sha256);
    if (!now || now->state != CheckpointState::pruned) return;
    throw FilePruned(fmt::format(
        "{}: checkpoint {:.12} (run {:.12}, cycle {:g}) was pruned; restore it with `shearcell "
        "regenerate {:.12}`",
        file, record.sha256, record.run, record.cycle, record.sha256));
  };
  if (record.state == CheckpointState::pruned) require_kept();
  std::vector<std::byte> bytes;
  try {
    bytes = objects_.get(record.sha256, record.size);
  } catch (const StoreDamaged&) {
    require_kept();  // it may have been pruned since the record was read
    throw;
  }
  const Stage of = stage(record.run);
  try {
    return read_checkpoint(bytes, record, of);
  } catch (const StoreDamaged& damage) {
    throw StoreDamaged(fmt::format("{}: {}", file, damage.what()));
  }
}

std::optional<Checkpoint> Store::load_if_readable(const CheckpointRecord& record) const {
  try {
    return load_checkpoint(record);
  } catch (const FilePruned&) {
  } catch (const StoreDamaged&) {
  }
  return std::nullopt;
}

std::vector<FigureRecord> Store::figures() const {
  const std::scoped_lock guard(mutex_);
  return query_figures(database_);
}

std::vector<Event> Store::events(std::string_view stream, std::string_view type) const {
  const std::scoped_lock guard(mutex_);
  return log_.events(stream, type);
}

Head Store::head() const {
  const std::scoped_lock guard(mutex_);
  return log_.head();
}

void Store::rebuild() {
  must_write();
  const std::scoped_lock guard(mutex_);
  rebuild_projections(database_, log_);
}

std::vector<CheckpointRecord> Store::prunable(const PruneChoice& choice) const {
  const std::scoped_lock guard(mutex_);
  const std::set<std::string> needed = initial_states(log_);
  std::vector<CheckpointRecord> found;
  for (const Stage& run : stages()) {
    if (!choice.runs.empty() && std::ranges::count(choice.runs, run.id) == 0) continue;
    // The newest is kept, and all back to the newest that can be read: `resume` reports the others.
    std::vector<CheckpointRecord> records = checkpoints(run.id);
    bool kept = false;
    while (!records.empty() && !kept) {
      kept = load_if_readable(records.back()).has_value();
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
      const auto run = query_stage(database_, record.run);
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
  stage(id);  // throws when it is unknown
  record(run_stream(id), {same ? "ReplayVerified" : "ReplayDiverged", facts});
}

}  // namespace shearcell
