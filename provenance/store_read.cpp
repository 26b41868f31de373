// SPDX-License-Identifier: GPL-3.0-or-later
// Reading functions of the store.
#include <fmt/format.h>

#include <algorithm>

#include "provenance/projections.hpp"
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

}  // namespace

std::optional<LoadedCheckpoint> Store::newest_valid_checkpoint(const std::string& id,
                                                               std::vector<std::string>* damage) {
  std::vector<CheckpointRecord> records = checkpoints(id);
  std::reverse(records.begin(), records.end());
  for (const CheckpointRecord& record : records) {
    try {
      return LoadedCheckpoint{record, load_checkpoint(record)};
    } catch (const CheckpointPruned&) {
      continue;
    } catch (const StoreDamaged& error) {
      if (damage != nullptr) damage->push_back(error.what());
      if (access_ != Access::read) reject_checkpoint(id, record.sha256, error.what());
    }
  }
  return std::nullopt;
}

std::vector<RunRecord> Store::runs() const {
  const std::scoped_lock guard(mutex_);
  const sqlite::ReadTransaction snapshot(database_);
  return query_runs(database_);
}

RunRecord Store::run(const std::string& id) const {
  const std::scoped_lock guard(mutex_);
  const sqlite::ReadTransaction snapshot(database_);
  auto found = query_run(database_, id);
  if (!found) throw unknown_run(id);
  return std::move(*found);
}

std::vector<Lease> Store::leases() const {
  const std::scoped_lock guard(mutex_);
  std::vector<Lease> found = query_leases(database_);
  const std::uint64_t now = now_ms();
  std::erase_if(found, [now](const Lease& lease) { return lapsed(lease, now); });
  return found;
}

RunRecord Store::find_run(std::string_view prefix) const {
  const std::scoped_lock guard(mutex_);
  const std::vector<std::string> ids = query_run_ids(database_, prefix, kListed);
  if (ids.empty()) throw unknown_run(prefix);
  require_one("runs", prefix, ids);
  return run(ids.front());
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
  if (query_run_ids(database_, id, 1) != std::vector{id}) throw unknown_run(id);
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
    throw CheckpointPruned(fmt::format(
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
  const RunRecord of = run(record.run);
  try {
    return read_checkpoint(bytes, record, of);
  } catch (const StoreDamaged& damage) {
    throw StoreDamaged(fmt::format("{}: {}", file, damage.what()));
  }
}

std::optional<Checkpoint> Store::load_if_readable(const CheckpointRecord& record) const {
  try {
    return load_checkpoint(record);
  } catch (const CheckpointPruned&) {
  } catch (const StoreDamaged&) {
  }
  return std::nullopt;
}

std::vector<FigureRecord> Store::figures() const {
  const std::scoped_lock guard(mutex_);
  return query_figures(database_);
}

std::vector<Event> Store::events(std::string_view stream) const {
  const std::scoped_lock guard(mutex_);
  return log_.events(stream);
}

Head Store::head() const {
  const std::scoped_lock guard(mutex_);
  return log_.head();
}

}  // namespace shearcell
