// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/store.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <system_error>

#include "core/bits_version.hpp"
#include "provenance/events.hpp"
#include "provenance/io/clock.hpp"
#include "provenance/io/file.hpp"
#include "provenance/json_text.hpp"
#include "provenance/projections.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {

namespace {

using events::encode;
using nlohmann::json;

constexpr const char* kLogFile = "store.sqlite";

/// The name of any file or subfolder of `folder` that is not hidden; "" if there is none.
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
  sqlite::full_name(folder / kLogFile);  // throws if the path is too long, before files are made
  if (fs::exists(folder) && !fs::is_directory(folder)) {
    throw UsageError(
        fmt::format("{}: a store is a folder, but this is a file; choose another path", name));
  }
  if (fs::exists(folder / kLogFile)) return folder;
  require_no_results(folder / kLogFile, "missing");
  if (access != Access::create) {
    throw NotFound(fmt::format(
        "{}: there is no store here; make one with `shearcell run`, or choose a store with --store",
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
    throw MachineError(fmt::format("{}: cannot create the store: {}; set --store to another folder",
                                   name, error.message()));
  }
  return folder;
}

/// Throws StoreDamaged if the folder of the checkpoints is missing or empty. Without this check,
/// the program would reject all checkpoints and compute all runs again.
void require_objects(const std::filesystem::path& folder, const sqlite::Database& database) {
  try {
    sqlite::Statement kept(database, "SELECT 1 FROM checkpoints WHERE state = 'recorded' LIMIT 1");
    if (!kept.step()) return;
  } catch (const StoreDamaged&) {
    return;  // `rebuild` repairs the damaged table
  }
  const std::filesystem::path objects = folder / "objects";  // exists before a checkpoint is logged
  std::error_code unreadable;
  if (std::filesystem::exists(objects) && !std::filesystem::is_empty(objects, unreadable)) return;
  if (unreadable) return;
  throw StoreDamaged(fmt::format(
      "{}: the log lists checkpoints, but this folder is missing or empty; mount it, copy it "
      "from the original store, or choose another store with --store",
      objects.string()));
}

/// Why the program with this token no longer holds the run; "" if it still holds the run.
std::string loss_of(const sqlite::Database& database, const std::string& token,
                    const std::string& id, std::uint64_t attempt) {
  for (const Lease& lease : query_leases(database, id)) {
    if (lease.holder.token == token) continue;
    return fmt::format("its lease expired and another program took over the run ({})",
                       describe(lease.holder));
  }
  // Only another program can have recorded a newer attempt or a state other than `running`.
  const auto run = query_stage(database, id);
  const bool own = run && run->attempts == attempt && run->state == StageState::running;
  return own ? "" : "another process continued it";
}

NotFound unknown_stage(std::string_view id) {
  return NotFound(fmt::format("the store has no run '{}'; `shearcell status` lists its runs", id));
}

/// The checkpoint of the run. Throws NotFound if the run has no such checkpoint.
CheckpointRecord known_checkpoint(const sqlite::Database& database, const std::string& run,
                                  const std::string& sha256) {
  auto found = query_checkpoint(database, run, sha256);
  if (!found) throw NotFound(fmt::format("run {}: it has no checkpoint {}", run, sha256));
  return std::move(*found);
}

/// Throws NotFound if there are two or more candidates. The message lists their ids.
void require_one(const char* what, std::string_view prefix, const auto& candidates, auto id) {
  constexpr std::size_t most = 10;
  if (candidates.size() < 2) return;
  std::string list;
  for (const auto& one : std::span(candidates).first(std::min(most, candidates.size()))) {
    list += "\n  " + one.*id;
  }
  throw NotFound(fmt::format("several {} begin with '{}'; give more digits of one of them:{}{}",
                             what, prefix, list, candidates.size() > most ? "\n  ..." : ""));
}

/// SHA-256 of each checkpoint from which a later stage started.
std::set<std::string> initial_states(const EventLog& log) {
  std::set<std::string> found;
  for (const Event& event : log.events("", events::RunStarted::kType)) {
    const auto started = std::get<events::RunStarted>(events::decode(event));
    if (started.parent_checkpoint) found.insert(*started.parent_checkpoint);
  }
  return found;
}

/// The cycle of the parent at which the stage starts.
double start_cycle(const Stage& stage) {
  const json cycle = member_of(member_of(stage.resolved, "parameters"), "start_cycle");
  return cycle.is_number() ? cycle.get<double>() : 0;
}

/// Whether `keep_every` keeps the checkpoint. All checkpoints of a packing that settles
/// have cycle 0. Of these, only the checkpoint at step 0 is kept.
bool kept_by_cadence(const PruneChoice& choice, const CheckpointRecord& record) {
  return choice.keep_every > 0 && (record.cycle > 0 || record.step == 0) &&
         std::fmod(record.cycle, static_cast<double>(choice.keep_every)) == 0;
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
  if (access_ == Access::read) return;
  require_objects(folder_, database_);
  remove_leftovers(folder_, true);
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

Store::Snapshot::Snapshot(const Store& store)
    : scoped_lock(store.mutex_), ReadTransaction(store.database_) {
  if (!store.is_complete_) require_complete(store.database_, store.log_);
  store.is_complete_ = true;
}

Store::Writing::Writing(Store& store)
    : scoped_lock(store.mutex_), WriteTransaction(store.must_write()) {}

sqlite::Database& Store::must_write() const {
  if (access_ == Access::read) throw std::logic_error("this store was opened for reading only");
  return database_;
}

void Store::append(std::string_view stream, const NewEvent& event,
                   const sqlite::WriteTransaction& lock) {
  apply(database_, log_.append(lock, stream, event));
}

void Store::record(std::string_view stream, const NewEvent& event,
                   std::optional<std::uint64_t> seen) {
  Writing lock(*this);
  if (const std::uint64_t found = log_.version(stream); seen.value_or(found) != found) {
    throw ConcurrencyConflict(fmt::format(
        "{}: stream {} has version {} instead of {}: another process wrote to it; read it again",
        database_.name(), stream, found, *seen));
  }
  append(stream, event, lock);
  lock.commit();
}

void Store::append_held(const std::string& id, const NewEvent& event, bool release) {
  Writing lock(*this);
  const auto held = held_.find(id);
  if (held == held_.end()) {
    throw ConcurrencyConflict(
        fmt::format("run {}: this process is not computing the run, so it is not allowed to record "
                    "events of the run",
                    id));
  }
  if (const std::string why = loss_of(database_, self_.token, id, held->second); !why.empty()) {
    held_.erase(held);
    throw ConcurrencyConflict(fmt::format("run {}: {}", id, why));
  }
  append(run_stream(id), event, lock);
  if (release) {
    drop_lease(database_, id, self_.token);
  } else {
    put_lease(database_, id, self_, held->second, lease_ms_);
  }
  lock.commit();
  if (release) held_.erase(held);
}

std::string Store::register_manifest(std::string_view text, std::string_view path,
                                     const json& info) {
  std::string sha256 = sha256_hex(text);
  const std::string stream = "manifest/" + sha256;
  Writing lock(*this);
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
      encode(events::ManifestRegistered{{sha256, std::string(path), std::string(text)}, info});
  // The newest manifest must have the latest recorded_at, even if the clock was set back.
  if (known) event.not_before = newest.text(1);
  append(stream, event, lock);
  lock.commit();
  return sha256;
}

std::string Store::register_packing(std::string_view text, std::string_view path) {
  std::string sha256 = sha256_hex(text);
  const std::string stream = "packing/" + sha256;
  Writing lock(*this);
  if (log_.version(stream) > 0) return sha256;
  append(stream, encode(events::PackingRegistered{{sha256, std::string(path), std::string(text)}}),
         lock);
  lock.commit();
  return sha256;
}

std::pair<std::string, std::string> Store::packing_text(const std::string& sha256) const {
  for (const Event& event : events("packing/" + sha256, events::PackingRegistered::kType)) {
    auto found = std::get<events::PackingRegistered>(events::decode(event));
    if (sha256_hex(found.text) == sha256) return {std::move(found.text), std::move(found.path)};
  }
  throw StoreDamaged(
      fmt::format("the file of grain positions with SHA-256 {:.12} is not in the store; "
                  "`shearcell run` records the file",
                  sha256));
}

void Store::declare_stage(const Stage& declared) {
  if (!is_sha256_hex(declared.id)) {
    throw std::invalid_argument(fmt::format("'{}' is not a run id", declared.id));
  }
  Writing lock(*this);
  const auto known = query_stage(database_, declared.id);
  if (!known && !declared.parent.empty() && !query_stage(database_, declared.parent)) {
    throw std::invalid_argument(
        fmt::format("run {}: its parent {} was never declared", declared.id, declared.parent));
  }
  if (known && !same_computation(*known, declared)) {
    throw std::invalid_argument(
        fmt::format("run {}: the store has other parameters for this id", declared.id));
  }
  for (const Membership& m : declared.memberships) {
    const NewEvent event = encode(events::RunDeclared{declared, m});
    if (adds_something(known, m)) append(run_stream(declared.id), event, lock);
    // If another stage was declared later for this place (experiment, scale, variant and seed),
    // this stage is declared again and becomes the last one.
    if (!holds_place(database_, declared.id, m.place)) append(run_stream(declared.id), event, lock);
  }
  lock.commit();
}

std::uint64_t Store::start_stage(const std::string& id, const json& host,
                                 const std::optional<std::string>& from_sha256,
                                 const std::string& parent_checkpoint, bool fill) {
  Writing lock(*this);
  if (held_.contains(id)) {
    throw ConcurrencyConflict(fmt::format("run {}: this process is already computing it", id));
  }
  const auto known = query_stage(database_, id);
  if (!known) throw unknown_stage(id);
  for (const Lease& lease : query_leases(database_, id)) {
    if (lease.holder.token == self_.token || lapsed(lease, now_ms())) continue;
    throw ConcurrencyConflict(
        fmt::format("run {}: another program is computing it ({})", id, describe(lease.holder)));
  }
  if ((known->state == StageState::completed) != fill) {
    throw ConcurrencyConflict(fmt::format("run {}: it is {}completed", id, fill ? "not " : ""));
  }
  const std::uint64_t attempt = known->attempts + 1;
  const json process = {{"host", self_.host}, {"pid", self_.pid}, {"token", self_.token}};
  const events::AttemptBegun attempted{attempt, host, process, bits_version};
  events::RunStarted started{attempted};
  if (!parent_checkpoint.empty()) started.parent_checkpoint = parent_checkpoint;
  events::Any begun = std::move(started);
  std::uint64_t from_step = 0;
  if (from_sha256) {
    const CheckpointRecord from = known_checkpoint(database_, id, *from_sha256);
    from_step = from.step;
    begun = events::RunResumed{attempted, {from.sha256, from.step, from.cycle}};
  }
  if (known->step > from_step && !fill) {
    throw ConcurrencyConflict(fmt::format(
        "run {}: another process has recorded step {}; continue from this step", id, known->step));
  }
  append(run_stream(id), encode(begun), lock);
  put_lease(database_, id, self_, attempt, lease_ms_);
  held_[id] = attempt;  // before the commit, which may succeed and still throw
  lock.commit();
  return attempt;
}

void Store::renew_leases() {
  const std::scoped_lock guard(mutex_);
  if (held_.empty()) return;
  Writing lock(*this);
  std::erase_if(held_, [this](const auto& run) {
    return !loss_of(database_, self_.token, run.first, run.second).empty();
  });
  for (const auto& [id, attempt] : held_) put_lease(database_, id, self_, attempt, lease_ms_);
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
        fmt::format("run {}: the checkpoint belongs to run '{}'", id, checkpoint.run));
  }
  // The file is written before the event. A crash between the two writes leaves a file without an
  // event, never an event without its file.
  const std::string state = state_hash(checkpoint);
  const std::vector<std::byte> bytes = encode_checkpoint(checkpoint);
  {
    const std::scoped_lock guard(mutex_);
    database_.require_in_place();  // do not write the file into a store that replaced this one
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
  // A concurrent `prune` may have deleted the file before the event was appended.
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
  Writing lock(*this);
  const CheckpointRecord record = known_checkpoint(database_, id, sha256);
  if (record.state != CheckpointState::recorded) return;
  append(run_stream(id), encode(events::CheckpointRejected{sha256, record.step, why}), lock);
  lock.commit();
}

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
  const Snapshot snapshot(*this);
  return query_stages(database_);
}

Stage Store::stage(const std::string& id) const {
  const Snapshot snapshot(*this);
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
  const Snapshot snapshot(*this);
  std::vector<Stage> found = query_stages(database_, prefix);
  if (found.empty()) throw unknown_stage(prefix);
  require_one("runs", prefix, found, &Stage::id);
  return std::move(found.front());
}

std::optional<CheckpointRecord> Store::find_checkpoint(std::string_view prefix) const {
  const Snapshot snapshot(*this);
  const auto found = query_all_checkpoints(database_, prefix);
  if (found.empty()) return std::nullopt;
  require_one("checkpoints", prefix, found, &CheckpointRecord::sha256);
  return found.front();
}

std::vector<CheckpointRecord> Store::checkpoints(const std::string& id, Listed listed) const {
  const Snapshot snapshot(*this);
  auto found = query_checkpoints(database_, id);
  if (found.empty() && !query_stage(database_, id)) throw unknown_stage(id);
  std::erase_if(found, [listed](const CheckpointRecord& record) {
    return (record.state == CheckpointState::rejected && listed != Listed::all) ||
           (record.state == CheckpointState::pruned && listed == Listed::recorded);
  });
  return found;
}

std::vector<std::byte> Store::read_file(const CheckpointRecord& record) const {
  try {
    if (record.state != CheckpointState::pruned) return objects_.get(record.sha256, record.size);
  } catch (const StoreDamaged&) {
  }
  {
    const std::scoped_lock guard(mutex_);
    if (is_pruned_now(database_, record)) {
      throw FilePruned(fmt::format(
          "{}: checkpoint {:.12} (run {:.12}, cycle {:g}) was pruned; restore it with `shearcell "
          "regenerate {:.12}`",
          (folder_ / record.file).string(), record.sha256, record.run, record.cycle,
          record.sha256));
    }
  }
  return objects_.get(record.sha256, record.size);  // the file may have been regenerated meanwhile
}

Checkpoint Store::load_checkpoint(const CheckpointRecord& record) const {
  const std::vector<std::byte> bytes = read_file(record);
  const Stage of = stage(record.run);
  try {
    return read_checkpoint(bytes, record, of);
  } catch (const StoreDamaged& damage) {
    throw StoreDamaged(fmt::format("{}: {}", (folder_ / record.file).string(), damage.what()));
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
  const Snapshot snapshot(*this);
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
  Writing lock(*this);
  derive_projections(database_, log_, lock);
  lock.commit();
}

std::vector<CheckpointRecord> Store::prunable(const PruneChoice& choice) const {
  const std::scoped_lock guard(mutex_);
  const std::set<std::string> needed = initial_states(log_);
  const std::vector<Stage> known = stages();
  std::set<std::pair<std::string, double>> to_come;  // (run, cycle) where other stages will start
  for (const Stage& stage : known) {
    if (!stage.parent.empty() && !has_ended(stage.state))
      to_come.emplace(stage.parent, start_cycle(stage));
  }
  std::vector<CheckpointRecord> found;
  for (const Stage& stage : known) {
    if (!choice.runs.empty() && std::ranges::count(choice.runs, stage.id) == 0) continue;
    // Keeps the newest readable checkpoint and the damaged ones after it, which `resume` reports.
    std::vector<CheckpointRecord> records = checkpoints(stage.id);
    const bool all = choice.last_too && stage.state == StageState::completed;
    bool kept = all;
    while (!records.empty() && !kept) {
      kept = load_if_readable(records.back()).has_value();
      records.pop_back();
    }
    for (CheckpointRecord& record : records) {
      const bool settling = stage.kind == "prepare" && record.step < stage.step;
      if (!settling && to_come.contains({stage.id, record.cycle})) continue;
      if (kept_by_cadence(choice, record) || (!all && needed.contains(record.sha256))) continue;
      found.push_back(std::move(record));
    }
  }
  return found;
}

std::vector<CheckpointRecord> Store::prune_leftovers() const {
  const std::scoped_lock guard(mutex_);
  std::vector<CheckpointRecord> found = query_all_checkpoints(database_);
  std::erase_if(found, [this](const CheckpointRecord& record) {
    return record.state != CheckpointState::pruned || !objects_.contains(record.sha256);
  });
  return found;
}

std::uint64_t Store::prune(const std::vector<CheckpointRecord>& records, bool last_too) {
  {
    // One transaction: after an error, none of the checkpoints is recorded as pruned.
    Writing lock(*this);
    DerivedCache measures(folder_, Access::read);
    for (const CheckpointRecord& record : records) {
      const auto now = query_checkpoint(database_, record.run, record.sha256);
      const auto run = query_stage(database_, record.run);
      const bool last = run && now && now->step >= run->step;
      if (!now || !run || now->state != CheckpointState::recorded) continue;
      if (last && !(last_too && run->state == StageState::completed)) continue;
      append(run_stream(record.run),
             encode(events::CheckpointPruned{{*now}, measures.digests(now->sha256)}), lock);
    }
    lock.commit();
  }
  std::uint64_t freed = 0;
  for (const CheckpointRecord& record : records) {
    // Without the lock, the file could be recorded again between the check and the removal.
    const Writing lock(*this);
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
        fmt::format("checkpoint {:.12} of run {:.12}: the regenerated state has hash {:.12} "
                    "(recorded: {:.12}), and the regenerated file has hash {:.12}; the regenerated "
                    "file was not stored",
                    record.sha256, record.run, state, record.state_hash, sha256));
  }
  for (;;) {
    objects_.put(bytes);
    Writing lock(*this);
    if (!objects_.contains(sha256)) continue;  // a concurrent `prune` deleted it
    const CheckpointRecord now = known_checkpoint(database_, record.run, sha256);
    if (now.state == CheckpointState::recorded) return;
    append(run_stream(record.run), encode(events::CheckpointRegenerated{{now}}), lock);
    lock.commit();
    return;
  }
}

}  // namespace shearcell
