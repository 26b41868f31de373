// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/store.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <system_error>

#include "provenance/events.hpp"
#include "provenance/io/clock.hpp"
#include "provenance/projections.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {

namespace {

using events::encode;
using nlohmann::json;

constexpr const char* kLogFile = "store.sqlite";

/// A file or folder that a new store should not be mixed with; "" if there is none.
std::string other_file_in(const std::filesystem::path& folder) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with('.') && name != "lost+found") return name;
  }
  return "";
}

/// Checks the folder, or creates it, so that its log can be opened.
std::filesystem::path prepare_folder(std::filesystem::path folder, Access access) {
  namespace fs = std::filesystem;
  const std::string name = folder.string();
  sqlite::full_name(folder / kLogFile);  // or says that it is too long, before anything is made
  if (fs::exists(folder) && !fs::is_directory(folder)) {
    throw UsageError(
        fmt::format("{}: a store is a folder, but this is a file; name another one", name));
  }
  if (fs::exists(folder / kLogFile)) return folder;
  if (fs::exists(folder / "objects")) {
    throw StoreDamaged(
        fmt::format("{}: there are objects but no {}: the log is lost; restore it from a backup",
                    name, kLogFile));
  }
  if (access != Access::create) {
    throw NotFound(fmt::format(
        "{}: there is no store here; create one with `shearcell run`, or name another with --store",
        name));
  }
  if (const std::string other = other_file_in(folder); !other.empty()) {
    throw UsageError(fmt::format(
        "{}: this folder is not a store and has other files ({}); name a new or empty folder with "
        "--store",
        name, other));
  }
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw MachineError(fmt::format("{}: cannot create the store: {}; name another with --store",
                                   name, error.message()));
  }
  return folder;
}

/// A program that finds no checkpoint would reject each of them and compute all runs again.
void require_objects(const std::filesystem::path& folder, const sqlite::Database& database) {
  try {
    sqlite::Statement kept(database, "SELECT 1 FROM checkpoints WHERE state = 'recorded' LIMIT 1");
    if (!kept.step()) return;
  } catch (const StoreDamaged&) {
    return;  // `rebuild` derives the table again
  }
  const std::filesystem::path objects = folder / "objects";  // made before the first event
  std::error_code unreadable;
  if (std::filesystem::exists(objects) && !std::filesystem::is_empty(objects, unreadable)) return;
  if (unreadable) return;
  throw StoreDamaged(fmt::format(
      "{}: the log names checkpoints, but this folder is missing or empty; mount it, or copy it "
      "from where the store was, or name another store with --store",
      objects.string()));
}

bool adds_something(const Stage& known, const Ask& m) {
  return std::ranges::none_of(known.asks, [&](const Ask& old) {
    return place_of(old) == place_of(m) && old.checkpoint_every == m.checkpoint_every &&
           old.target_cycles >= m.target_cycles;
  });
}

/// Why the holder of this token lost the run of its own attempt; "" while it holds it.
std::string loss_of(const sqlite::Database& database, const std::string& token,
                    const std::string& id, std::uint64_t attempt) {
  const auto lease = query_lease(database, id);
  if (lease && lease->holder.token != token) {
    return fmt::format("its lease expired and another program took the run ({})",
                       describe(lease->holder));
  }
  // Whoever continued it began an attempt, and a merge may have brought its end.
  const auto run = query_stage(database, id);
  const bool own = run && run->attempts == attempt && run->state == StageState::running;
  return own ? "" : "another process continued it";
}

}  // namespace

Store::Store(std::filesystem::path folder, Access access, double lease_seconds)
    : folder_(prepare_folder(std::move(folder), access)),
      access_(access),
      objects_(folder_),
      database_(open_database(folder_ / kLogFile, access)),
      log_(database_),
      self_(this_process()),
      lease_ms_(std::min(kLongestLeaseMs,
                         static_cast<std::uint64_t>(std::max(0.0, lease_seconds) * 1000))) {
  if (access_ != Access::read) require_objects(folder_, database_);
}

Store::~Store() {
  if (held_.empty()) return;
  try {
    sqlite::WriteTransaction lock(database_);
    for (const auto& [id, attempt] : held_) drop_lease(database_, id, self_.token);
    lock.commit();
  } catch (const std::exception&) {
    // The leases expire by themselves.
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

void Store::append(std::string_view stream, const NewEvent& event,
                   const sqlite::WriteTransaction& lock) {
  apply(database_, log_.append(lock, stream, event));
}

void Store::record(std::string_view stream, const NewEvent& event) {
  must_write();
  const std::scoped_lock guard(mutex_);
  sqlite::WriteTransaction lock(database_);
  append(stream, event, lock);
  lock.commit();
}

void Store::append_held(const std::string& id, const NewEvent& event, bool release) {
  must_write();
  const std::scoped_lock guard(mutex_);
  const auto held = held_.find(id);
  if (held == held_.end()) {
    throw ConcurrencyConflict(
        fmt::format("run {}: this program does not hold the run; start it first", id));
  }
  sqlite::WriteTransaction lock(database_);
  if (const std::string why = loss_of(database_, self_.token, id, held->second); !why.empty()) {
    held_.erase(held);
    throw ConcurrencyConflict(fmt::format("run {}: {}", id, why));
  }
  append(run_stream(id), event, lock);
  if (!release) {
    hold(id, held->second);
    lock.commit();
  } else {
    drop_lease(database_, id, self_.token);
    lock.commit();
    held_.erase(held);
  }
}

std::string Store::register_manifest(std::string_view text, std::string_view path,
                                     const json& info) {
  must_write();
  std::string sha256 = sha256_hex(text);
  const std::string stream = "manifest/" + sha256;
  const std::scoped_lock guard(mutex_);
  sqlite::WriteTransaction lock(database_);
  const std::string experiment = info.is_object() ? info.value("experiment", "") : "";
  sqlite::Statement newest(
      database_,
      "SELECT stream, recorded_at FROM events WHERE stream >= 'manifest/' AND stream < 'manifest0' "
      "AND json_valid(payload) AND json_extract(payload, '$.info.experiment') = ? "
      "ORDER BY recorded_at DESC, seq DESC LIMIT 1",
      experiment);
  const bool known = newest.step();
  if (log_.version(stream) > 0 && (!known || newest.text(0) == stream)) return sha256;
  NewEvent event =
      encode(events::ManifestRegistered{sha256, std::string(path), std::string(text), info});
  // The newest version of an experiment is the last one by this time.
  if (known) event.not_before = newest.text(1);
  append(stream, event, lock);
  lock.commit();
  return sha256;
}

void Store::declare_stage(const Stage& declared) {
  must_write();
  if (!is_sha256_hex(declared.id)) {
    throw std::invalid_argument(fmt::format("'{}' is not a run id", declared.id));
  }
  const std::scoped_lock guard(mutex_);
  sqlite::WriteTransaction lock(database_);
  const auto known = query_stage(database_, declared.id);
  if (!known && !declared.parent.empty() && !query_stage(database_, declared.parent)) {
    throw std::invalid_argument(
        fmt::format("run {}: its parent {} was never declared", declared.id, declared.parent));
  }
  if (known && !same_computation(*known, declared)) {
    throw std::invalid_argument(
        fmt::format("run {}: the store has this id with other parameters", declared.id));
  }
  for (const Ask& m : declared.asks) {
    if (known && !adds_something(*known, m)) continue;
    append(run_stream(declared.id), encode(events::RunDeclared{declared, m}), lock);
  }
  lock.commit();
}

std::uint64_t Store::start_stage(const std::string& id, const json& host,
                                 const std::optional<std::string>& from_sha256,
                                 const std::string& parent_checkpoint, bool fill) {
  must_write();
  const std::scoped_lock guard(mutex_);
  if (held_.contains(id)) {
    throw ConcurrencyConflict(fmt::format("run {}: this program computes it already", id));
  }
  sqlite::WriteTransaction lock(database_);
  const auto known = query_stage(database_, id);
  if (!known) throw unknown_stage(id);
  const auto lease = query_lease(database_, id);
  if (lease && lease->holder.token != self_.token && !lapsed(*lease, now_ms())) {
    throw RunHeld(
        fmt::format("run {}: another program computes it ({})", id, describe(lease->holder)));
  }
  if ((known->state == StageState::completed) != fill) {
    throw ConcurrencyConflict(fmt::format("run {}: it is {}completed", id, fill ? "not " : ""));
  }
  const std::uint64_t attempt = known->attempts + 1;
  const json process = {{"host", self_.host}, {"pid", self_.pid}, {"token", self_.token}};
  events::RunStarted started{attempt, host, process, std::nullopt};
  if (!parent_checkpoint.empty()) started.parent_checkpoint = parent_checkpoint;
  events::Any begun = std::move(started);
  std::uint64_t from_step = 0;
  if (from_sha256) {
    const auto from = query_checkpoint(database_, id, *from_sha256);
    if (!from) throw unknown_checkpoint(id, *from_sha256);
    from_step = from->step;
    begun = events::RunResumed{attempt, host, process, {from->sha256, from->step, from->cycle}};
  }
  if (known->step > from_step && !fill) {
    throw ConcurrencyConflict(fmt::format(
        "run {}: another program has recorded step {}; continue from there", id, known->step));
  }
  append(run_stream(id), encode(begun), lock);
  hold(id, attempt);
  held_[id] =
      attempt;  // first, so that interrupt_stage() works if the commit only reports an error
  lock.commit();
  return attempt;
}

void Store::renew_leases() {
  must_write();
  const std::scoped_lock guard(mutex_);
  if (held_.empty()) return;
  sqlite::WriteTransaction lock(database_);
  std::erase_if(held_, [this](const auto& run) {
    return !loss_of(database_, self_.token, run.first, run.second).empty();
  });
  for (const auto& [id, attempt] : held_) hold(id, attempt);
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
  // The file is written before the event: a crash in between leaves a file without an event, never
  // an event without its file.
  const std::string state = state_hash(checkpoint);
  const std::vector<std::byte> bytes = encode_checkpoint(checkpoint);
  {
    const std::scoped_lock guard(mutex_);
    database_.require_in_place();  // else the file would go to the store that is now at this place
  }
  const std::string sha256 = objects_.put(bytes);
  const std::scoped_lock guard(mutex_);
  const auto old = query_checkpoint(database_, id, sha256);
  if (old && old->state == CheckpointState::recorded && held_.contains(id)) return *old;
  const CheckpointRecord record{.run = id,
                                .step = checkpoint.state.step,
                                .cycle = checkpoint.cycle,
                                .time_s = checkpoint.time_s,
                                .file = ObjectStore::file_of(sha256),
                                .size = bytes.size(),
                                .sha256 = sha256,
                                .state_hash = state,
                                .observables = checkpoint.observables};
  append_held(id, encode(events::CheckpointRecorded{{record}, effort}), false);
  // A concurrent `prune` may have deleted the file before this event.
  if (old && !objects_.contains(sha256)) objects_.put(bytes);
  return query_checkpoint(database_, id, sha256).value();
}

void Store::interrupt_stage(const std::string& id, const std::string& why) {
  append_held(id, encode(events::RunInterrupted{why}), true);
}

void Store::fail_stage(const std::string& id, const std::string& why, const json& numbers) {
  append_held(id, encode(events::RunFailed{why, numbers}), true);
}

void Store::complete_stage(const std::string& id, const json& summary,
                           std::optional<std::uint64_t> target_cycles) {
  append_held(id, encode(events::RunCompleted{summary, target_cycles}), true);
}

void Store::reject_checkpoint(const std::string& id, const std::string& sha256,
                              const std::string& why) {
  must_write();
  const std::scoped_lock guard(mutex_);
  sqlite::WriteTransaction lock(database_);
  const auto record = query_checkpoint(database_, id, sha256);
  if (!record) throw unknown_checkpoint(id, sha256);
  if (record->state != CheckpointState::recorded) return;
  append(run_stream(id), encode(events::CheckpointRejected{sha256, record->step, why}), lock);
  lock.commit();
}

void Store::record_figure(const std::string& name, const json& provenance) {
  record("figure/" + name, encode(events::FigureGenerated{provenance}));
}

void Store::record_submission(const std::string& type, const json& facts,
                              std::optional<std::uint64_t> seen) {
  must_write();
  const std::scoped_lock guard(mutex_);
  sqlite::WriteTransaction lock(database_);
  const std::uint64_t found = log_.version(kSubmissions);
  if (seen.value_or(found) != found) {
    throw ConcurrencyConflict(fmt::format(
        "{}: stream {} has version {} instead of {}: another process wrote to it; read it again",
        database_.name(), kSubmissions, found, *seen));
  }
  append(kSubmissions, {type, facts}, lock);
  lock.commit();
}

}  // namespace shearcell
