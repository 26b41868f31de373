// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/store.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "provenance/projections.hpp"
#include "provenance/queries.hpp"
#include "provenance/schema.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {

namespace {

using nlohmann::json;

constexpr const char* kLogFile = "store.sqlite";

std::string run_stream(const std::string& id) {
  return "run/" + id;
}

/// The folder, checked or made, so that its log can be opened.
std::filesystem::path prepare_folder(std::filesystem::path folder, Access access) {
  namespace fs = std::filesystem;
  const std::string name = folder.string();
  if (fs::exists(folder) && !fs::is_directory(folder)) {
    throw StoreDamaged(fmt::format(
        "{}: a store is a folder, and this is a file; remove it or name another store", name));
  }
  if (fs::exists(folder / kLogFile)) return folder;
  if (fs::exists(folder / "objects")) {
    throw StoreDamaged(
        fmt::format("{}: there are objects and no {}, so the log is lost; restore it from a backup",
                    name, kLogFile));
  }
  if (access != Access::create) {
    throw NotFound(fmt::format(
        "{}: there is no store here; make one with `shearcell run`, or name another with --store",
        name));
  }
  fs::create_directories(folder);
  return folder;
}

/// Events that only the holder of a run writes. Others (a new membership, a rejected checkpoint)
/// say nothing about who runs it and so conflict with nobody.
bool claims_run(const Event& event) {
  return event.type != "RunDeclared" && event.type != "CheckpointRejected";
}

json membership_json(const Membership& m) {
  return {{"experiment", m.experiment},
          {"scale", m.scale},
          {"variant", m.variant},
          {"labels", m.labels},
          {"seed", m.seed},
          {"manifest", m.manifest},
          {"checkpoint_every", m.checkpoint_every}};
}

bool adds_something(const RunRecord& known, const RunDeclaration& declared) {
  const Membership& m = declared.membership;
  return std::none_of(
      known.memberships.begin(), known.memberships.end(), [&](const Membership& old) {
        return old.experiment == m.experiment && old.scale == m.scale && old.variant == m.variant &&
               old.seed == m.seed && old.manifest == m.manifest &&
               old.checkpoint_every == m.checkpoint_every &&
               old.target_cycles >= declared.target_cycles;
      });
}

NotFound unknown_run(std::string_view id) {
  return NotFound(
      fmt::format("the store has no run '{}'; `shearcell status` lists the runs it has", id));
}

}  // namespace

Store::Store(std::filesystem::path folder, Access access)
    : folder_(prepare_folder(std::move(folder), access)),
      access_(access),
      objects_(folder_),
      database_(
          open_database(folder_ / kLogFile,
                        access == Access::create ? sqlite::Open::create : sqlite::Open::existing,
                        access == Access::read)),
      log_(database_) {}

void Store::must_write() const {
  if (access_ == Access::read) throw std::logic_error("this store was opened for reading only");
}

void Store::append(std::string_view stream, std::uint64_t expected_version, NewEvent event,
                   const sqlite::WriteTransaction& lock) {
  for (const Event& e : log_.append(lock, stream, expected_version, std::span(&event, 1))) {
    apply(database_, e);
  }
}

void Store::append_held(const std::string& id, NewEvent event, bool release) {
  const auto held = held_.find(id);
  if (held == held_.end()) {
    throw ConcurrencyConflict(
        fmt::format("run {}: this program does not hold the run; start it first", id));
  }
  sqlite::WriteTransaction lock(database_);
  std::uint64_t version = held->second;
  for (const Event& e : log_.events(run_stream(id), version)) {
    if (claims_run(e)) {
      held_.erase(held);
      throw ConcurrencyConflict(
          fmt::format("run {}: another process went on with it ({} at {}); leave it to that one",
                      id, e.type, e.recorded_at));
    }
    version = e.version;
  }
  append(run_stream(id), version, std::move(event), lock);
  lock.commit();
  if (release) {
    held_.erase(held);
  } else {
    held->second = version + 1;
  }
}

std::string Store::register_manifest(std::string_view text, std::string_view path,
                                     const json& info) {
  must_write();
  const std::string sha256 = sha256_hex(text);
  const std::string stream = "manifest/" + sha256;
  const std::scoped_lock guard(mutex_);
  sqlite::WriteTransaction lock(database_);
  if (log_.version(stream) == 0) {
    append(stream, 0,
           {"ManifestRegistered",
            {{"sha256", sha256}, {"path", path}, {"text", text}, {"info", info}}},
           lock);
    lock.commit();
  }
  return sha256;
}

void Store::declare_run(const RunDeclaration& declared) {
  must_write();
  if (!is_sha256_hex(declared.id)) {
    throw std::invalid_argument(fmt::format("'{}' is no run id", declared.id));
  }
  const std::scoped_lock guard(mutex_);
  sqlite::WriteTransaction lock(database_);
  const std::vector<RunRecord> known = query_runs(database_, declared.id);
  if (known.empty()) {
    if (!declared.parent.empty() && query_runs(database_, declared.parent).empty()) {
      throw std::invalid_argument(
          fmt::format("run {}: its parent {} was never declared", declared.id, declared.parent));
    }
  } else {
    const RunRecord& old = known.front();
    if (old.parent != declared.parent || old.kind != declared.kind ||
        old.resolved != declared.resolved || old.grains != declared.grains) {
      throw std::invalid_argument(
          fmt::format("run {}: the store knows this id with other parameters", declared.id));
    }
    if (!adds_something(old, declared)) return;
  }
  append(run_stream(declared.id), log_.version(run_stream(declared.id)),
         {"RunDeclared",
          {{"parent", declared.parent},
           {"kind", declared.kind},
           {"resolved", declared.resolved},
           {"grains", declared.grains},
           {"target_cycles", declared.target_cycles},
           {"membership", membership_json(declared.membership)}}},
         lock);
  lock.commit();
}

std::uint64_t Store::start_run(const std::string& id, const json& host,
                               const std::optional<std::string>& from_sha256) {
  must_write();
  const std::scoped_lock guard(mutex_);
  if (held_.contains(id)) {
    throw ConcurrencyConflict(fmt::format("run {}: this program is running it already", id));
  }
  sqlite::WriteTransaction lock(database_);
  const std::vector<RunRecord> known = query_runs(database_, id);
  if (known.empty()) throw unknown_run(id);
  if (known.front().state == RunState::completed) {
    throw ConcurrencyConflict(fmt::format("run {}: it is completed; nothing is left to do", id));
  }
  json payload = {{"attempt", known.front().attempts + 1}, {"host", host}};
  if (from_sha256) {
    const auto from = query_checkpoint(database_, id, *from_sha256);
    if (!from) {
      throw NotFound(fmt::format("run {}: it has no checkpoint {}", id, *from_sha256));
    }
    payload["from"] = {{"sha256", from->sha256}, {"step", from->step}, {"cycle", from->cycle}};
  }
  const std::uint64_t version = log_.version(run_stream(id));
  append(run_stream(id), version, {from_sha256 ? "RunResumed" : "RunStarted", payload}, lock);
  lock.commit();
  held_[id] = version + 1;
  return known.front().attempts + 1;
}

CheckpointRecord Store::record_checkpoint(const std::string& id, const Checkpoint& checkpoint,
                                          const Effort& effort) {
  must_write();
  if (checkpoint.run != id) {
    throw std::invalid_argument(
        fmt::format("run {}: the checkpoint names run '{}'", id, checkpoint.run));
  }
  // The slow part, and the file before the event: a crash in between leaves a file that no event
  // names, never an event without its file.
  const std::string state = state_hash(checkpoint);
  const ObjectInfo object = objects_.put(encode_checkpoint(checkpoint));
  const std::scoped_lock guard(mutex_);
  const auto old = query_checkpoint(database_, id, object.sha256);
  if (old && old->state == CheckpointState::recorded && held_.contains(id)) return *old;
  append_held(id,
              {"CheckpointRecorded",
               {{"step", checkpoint.state.step},
                {"cycle", checkpoint.cycle},
                {"time_s", checkpoint.time_s},
                {"file", object.file},
                {"size", object.size},
                {"sha256", object.sha256},
                {"state_hash", state},
                {"observables", checkpoint.observables},
                {"wall_seconds", effort.wall_seconds},
                {"particle_steps", effort.particle_steps}}},
              false);
  return query_checkpoint(database_, id, object.sha256).value();
}

void Store::interrupt_run(const std::string& id, const std::string& why) {
  must_write();
  const std::scoped_lock guard(mutex_);
  append_held(id, {"RunInterrupted", {{"why", why}}}, true);
}

void Store::fail_run(const std::string& id, const std::string& why, const json& numbers) {
  must_write();
  const std::scoped_lock guard(mutex_);
  append_held(id, {"RunFailed", {{"why", why}, {"numbers", numbers}}}, true);
}

void Store::complete_run(const std::string& id, const json& summary) {
  must_write();
  const std::scoped_lock guard(mutex_);
  append_held(id, {"RunCompleted", {{"summary", summary}}}, true);
}

void Store::reject_checkpoint(const std::string& id, const std::string& sha256,
                              const std::string& why) {
  must_write();
  const std::scoped_lock guard(mutex_);
  sqlite::WriteTransaction lock(database_);
  const auto record = query_checkpoint(database_, id, sha256);
  if (!record) throw NotFound(fmt::format("run {}: it has no checkpoint {}", id, sha256));
  if (record->state == CheckpointState::rejected) return;
  append(run_stream(id), log_.version(run_stream(id)),
         {"CheckpointRejected", {{"sha256", sha256}, {"step", record->step}, {"why", why}}}, lock);
  lock.commit();
}

std::optional<LoadedCheckpoint> Store::newest_valid_checkpoint(const std::string& id,
                                                               std::vector<std::string>* damage) {
  std::vector<CheckpointRecord> records = checkpoints(id);
  std::reverse(records.begin(), records.end());
  for (const CheckpointRecord& record : records) {
    try {
      return LoadedCheckpoint{record, load_checkpoint(record)};
    } catch (const StoreDamaged& error) {
      if (damage != nullptr) damage->push_back(error.what());
      if (access_ != Access::read) reject_checkpoint(id, record.sha256, error.what());
    }
  }
  return std::nullopt;
}

void Store::record_figure(const std::string& name, const json& provenance) {
  must_write();
  const std::string stream = "figure/" + name;
  const std::scoped_lock guard(mutex_);
  sqlite::WriteTransaction lock(database_);
  append(stream, log_.version(stream), {"FigureGenerated", provenance}, lock);
  lock.commit();
}

std::vector<RunRecord> Store::runs() const {
  const std::scoped_lock guard(mutex_);
  const sqlite::ReadTransaction snapshot(database_);
  return query_runs(database_);
}

RunRecord Store::run(const std::string& id) const {
  const std::scoped_lock guard(mutex_);
  const sqlite::ReadTransaction snapshot(database_);
  const std::vector<RunRecord> found =
      id.empty() ? std::vector<RunRecord>() : query_runs(database_, id);
  if (found.empty()) throw unknown_run(id);
  return found.front();
}

RunRecord Store::find_run(std::string_view prefix) const {
  constexpr std::size_t kListed = 10;
  std::vector<std::string> ids;
  {
    const std::scoped_lock guard(mutex_);
    ids = query_run_ids(database_, prefix, kListed);
  }
  if (ids.empty()) throw unknown_run(prefix);
  if (ids.size() > 1) {
    std::string list;
    for (const std::string& id : ids) list += "\n  " + id;
    if (ids.size() == kListed) list += "\n  ...";
    throw NotFound(
        fmt::format("several runs begin with '{}'; give more digits of one of{}", prefix, list));
  }
  return run(ids.front());
}

std::vector<CheckpointRecord> Store::checkpoints(const std::string& id, bool with_rejected) const {
  std::vector<CheckpointRecord> found;
  {
    const std::scoped_lock guard(mutex_);
    if (query_run_ids(database_, id, 1) != std::vector{id}) throw unknown_run(id);
    found = query_checkpoints(database_, id);
  }
  if (!with_rejected) {
    std::erase_if(found, [](const CheckpointRecord& record) {
      return record.state != CheckpointState::recorded;
    });
  }
  return found;
}

Checkpoint Store::load_checkpoint(const CheckpointRecord& record) const {
  const std::vector<std::byte> bytes = objects_.get(record.sha256, record.size);
  const std::string file = (folder_ / record.file).string();
  Checkpoint checkpoint;
  try {
    checkpoint = decode_checkpoint(bytes);
  } catch (const StoreDamaged& damage) {
    throw StoreDamaged(fmt::format("{}: {}", file, damage.what()));
  }
  if (checkpoint.run != record.run || state_hash(checkpoint) != record.state_hash) {
    throw StoreDamaged(fmt::format(
        "{}: it holds another state than the log says; `resume` goes on from an older one", file));
  }
  return checkpoint;
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

void Store::rebuild() {
  must_write();
  const std::scoped_lock guard(mutex_);
  rebuild_projections(database_, log_);
}

VerifyReport Store::verify() const {
  const std::scoped_lock guard(mutex_);
  return shearcell::verify(database_, log_, objects_);
}

}  // namespace shearcell
