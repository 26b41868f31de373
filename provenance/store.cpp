// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/store.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
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

/// Events that only the holder of a run writes. Others (a new membership, a rejected checkpoint, a
/// replay) say nothing about who runs it and so conflict with nobody.
bool claims_run(const Event& event) {
  constexpr std::array<std::string_view, 6> kClaims = {"RunStarted",         "RunResumed",
                                                       "CheckpointRecorded", "RunInterrupted",
                                                       "RunFailed",          "RunCompleted"};
  return std::find(kClaims.begin(), kClaims.end(), event.type) != kClaims.end();
}

json membership_json(const Membership& m) {
  json written = {{"experiment", m.experiment},
                  {"scale", m.scale},
                  {"variant", m.variant},
                  {"labels", m.labels},
                  {"seed", m.seed},
                  {"manifest", m.manifest},
                  {"checkpoint_every", m.checkpoint_every}};
  if (!m.until.is_null()) written["until"] = m.until;
  return written;
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

}  // namespace

Store::Store(std::filesystem::path folder, Access access, const StoreOptions& options)
    : folder_(prepare_folder(std::move(folder), access)),
      access_(access),
      objects_(folder_),
      database_(
          open_database(folder_ / kLogFile,
                        access == Access::create ? sqlite::Open::create : sqlite::Open::existing,
                        access == Access::read)),
      log_(database_),
      self_(this_process()),
      lease_ms_(static_cast<std::uint64_t>(std::max(0.0, options.lease_seconds) * 1000)) {}

Store::~Store() {
  if (held_.empty()) return;
  try {
    sqlite::WriteTransaction lock(database_);
    for (const auto& [id, held] : held_) drop_lease(database_, id, self_.token);
    lock.commit();
  } catch (const std::exception&) {
    // They expire.
  }
}

void Store::hold(const std::string& id, std::uint64_t attempt) {
  const std::uint64_t now = now_ms();
  put_lease(database_, {.run = id,
                        .holder = self_,
                        .attempt = attempt,
                        .renewed_at_ms = now,
                        .expires_at_ms = now + lease_ms_});
}

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
  const auto lease = query_lease(database_, id);
  if (lease && lease->holder.token != self_.token) {
    held_.erase(held);
    throw ConcurrencyConflict(
        fmt::format("run {}: its lease expired and another program took it ({}); leave it to that "
                    "one",
                    id, describe(lease->holder)));
  }
  std::uint64_t version = held->second.version;
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
  if (release) {
    drop_lease(database_, id, self_.token);
  } else {
    hold(id, held->second.attempt);
  }
  lock.commit();
  if (release) {
    held_.erase(held);
  } else {
    held->second.version = version + 1;
  }
}

std::string Store::register_manifest(std::string_view text, std::string_view path,
                                     const json& info) {
  must_write();
  std::string sha256 = sha256_hex(text);
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
                               const std::optional<std::string>& from_sha256,
                               const std::string& parent_checkpoint) {
  must_write();
  const std::scoped_lock guard(mutex_);
  if (held_.contains(id)) {
    throw ConcurrencyConflict(fmt::format("run {}: this program is running it already", id));
  }
  sqlite::WriteTransaction lock(database_);
  const std::vector<RunRecord> known = query_runs(database_, id);
  if (known.empty()) throw unknown_run(id);
  const auto lease = query_lease(database_, id);
  if (lease && lease->holder.token != self_.token && !lapsed(*lease, now_ms())) {
    throw RunHeld(
        fmt::format("run {}: another program is at work on it ({})", id, describe(lease->holder)));
  }
  if (known.front().state == RunState::completed) {
    throw ConcurrencyConflict(fmt::format("run {}: it is completed; nothing is left to do", id));
  }
  const std::uint64_t attempt = known.front().attempts + 1;
  json payload = {{"attempt", attempt},
                  {"host", host},
                  {"process", {{"host", self_.host}, {"pid", self_.pid}, {"token", self_.token}}}};
  std::uint64_t from_step = 0;
  if (from_sha256) {
    const auto from = query_checkpoint(database_, id, *from_sha256);
    if (!from) {
      throw NotFound(fmt::format("run {}: it has no checkpoint {}", id, *from_sha256));
    }
    from_step = from->step;
    payload["from"] = {{"sha256", from->sha256}, {"step", from->step}, {"cycle", from->cycle}};
  } else {
    payload["parent_checkpoint"] = parent_checkpoint.empty() ? json() : json(parent_checkpoint);
  }
  if (known.front().step > from_step) {
    throw ConcurrencyConflict(fmt::format(
        "run {}: step {} was recorded meanwhile; go on from there", id, known.front().step));
  }
  const std::uint64_t version = log_.version(run_stream(id));
  append(run_stream(id), version, {from_sha256 ? "RunResumed" : "RunStarted", payload}, lock);
  hold(id, attempt);
  lock.commit();
  held_[id] = {version + 1, attempt};
  return attempt;
}

void Store::renew_leases() {
  must_write();
  const std::scoped_lock guard(mutex_);
  if (held_.empty()) return;
  sqlite::WriteTransaction lock(database_);
  for (auto run = held_.begin(); run != held_.end();) {
    const auto lease = query_lease(database_, run->first);
    const bool lost = lease && lease->holder.token != self_.token;
    if (!lost) hold(run->first, run->second.attempt);
    run = lost ? held_.erase(run) : std::next(run);
  }
  lock.commit();
}

bool Store::holds(const std::string& id) const {
  const std::scoped_lock guard(mutex_);
  return held_.contains(id);
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
  const std::vector<std::byte> bytes = encode_checkpoint(checkpoint);
  const ObjectInfo object = objects_.put(bytes);
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
  // A `prune` at work may have removed the file; now that it is recorded again it stays.
  if (old && !objects_.contains(object.sha256)) objects_.put(bytes);
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

void Store::complete_run(const std::string& id, const json& summary,
                         std::optional<std::uint64_t> target_cycles) {
  must_write();
  const std::scoped_lock guard(mutex_);
  const json reached = target_cycles ? json(*target_cycles) : json();
  append_held(id, {"RunCompleted", {{"summary", summary}, {"target_cycles", reached}}}, true);
}

void Store::reject_checkpoint(const std::string& id, const std::string& sha256,
                              const std::string& why) {
  must_write();
  const std::scoped_lock guard(mutex_);
  sqlite::WriteTransaction lock(database_);
  const auto record = query_checkpoint(database_, id, sha256);
  if (!record) throw NotFound(fmt::format("run {}: it has no checkpoint {}", id, sha256));
  if (record->state != CheckpointState::recorded) return;
  append(run_stream(id), log_.version(run_stream(id)),
         {"CheckpointRejected", {{"sha256", sha256}, {"step", record->step}, {"why", why}}}, lock);
  lock.commit();
}

void Store::record_figure(const std::string& name, const json& provenance) {
  must_write();
  const std::string stream = "figure/" + name;
  const std::scoped_lock guard(mutex_);
  sqlite::WriteTransaction lock(database_);
  append(stream, log_.version(stream), {"FigureGenerated", provenance}, lock);
  lock.commit();
}

void Store::record_submission(const std::string& type, const json& facts,
                              std::optional<std::uint64_t> seen) {
  must_write();
  const std::scoped_lock guard(mutex_);
  sqlite::WriteTransaction lock(database_);
  append(kSubmissions, seen.value_or(log_.version(kSubmissions)), {type, facts}, lock);
  lock.commit();
}

}  // namespace shearcell
