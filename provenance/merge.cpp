// SPDX-License-Identifier: GPL-3.0-or-later
// Merges the events and checkpoints of other stores into one store.
//
// The result is the union of the stores. A merge skips events that the store already has (equal
// stream, type, layout, time and payload), checkpoints that it already has, and attempts that did
// not record new checkpoints. Copied events keep their time and payload; seq, version and hashes
// are new. Of two states of a run, the merge keeps the state at the later step. At equal steps it
// prefers completed, failed, interrupted, running, declared. A repeated merge changes nothing.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "provenance/errors.hpp"
#include "provenance/events.hpp"
#include "provenance/json_text.hpp"
#include "provenance/lease.hpp"
#include "provenance/projections.hpp"
#include "provenance/sha256.hpp"
#include "provenance/store.hpp"

namespace shearcell {

namespace {

using events::CheckpointRecorded;
using sqlite::Database;
using sqlite::Statement;

/// A store to merge from. `head` and `events` were read in one transaction. The hash chain and the
/// events were checked.
struct Source {
  std::filesystem::path folder;
  Head head;
  std::vector<Event> events;
  Database tables;  ///< in memory, derived only from the events
  ObjectStore objects;
};

/// A hash that is equal for copies of one event in different logs.
std::string content_key(const Event& event) {
  return Sha256()
      .add_fields(event.stream, event.type, event.schema, event.recorded_at, event.payload)
      .hex();
}

/// Throws StoreDamaged, which names both stores, when two stores hold different states of one run
/// at the same step, or different runs under one id.
void require_agreement(const Database& into, const std::string& name,
                       const std::vector<Source>& sources) {
  using Step = std::pair<std::string, std::uint64_t>;  // run and step
  using States = std::set<std::string>;
  // The string in each value is the name of a store: in `runs`, the first store that has the run;
  // in `states`, the first store that has a state of the run at this step.
  std::map<std::string, std::pair<Stage, std::string>> runs;
  std::map<Step, std::pair<States, std::string>> states;
  const auto compare = [&](const Database& tables, const std::string& store) {
    for (const Stage& stage : query_stages(tables)) {
      const auto& [known, other] = runs.try_emplace(stage.id, stage, store).first->second;
      if (same_computation(known, stage)) continue;
      throw StoreDamaged(
          fmt::format("run {}: {} and {} have different parameters for this run; one store was "
                      "changed by hand. Nothing was merged",
                      stage.id, other, store));
    }
    std::map<Step, States> own;
    for (const CheckpointRecord& record : query_all_checkpoints(tables)) {
      if (record.state == CheckpointState::rejected) continue;
      own[{record.run, record.step}].insert(record.state_hash);
    }
    for (auto& [step, found] : own) {
      auto& [known, other] = states.try_emplace(step, found, store).first->second;
      if (std::ranges::none_of(found, [&](const auto& state) { return known.contains(state); })) {
        throw StoreDamaged(fmt::format(
            "run {} at step {}: {} has state {:.12} and {} has state {:.12}; one of them is wrong. "
            "Run `shearcell verify --replay` in each store. Nothing was merged",
            step.first, step.second, other, *known.begin(), store, *found.begin()));
      }
      known.merge(found);
    }
  };
  compare(into, name);
  for (const Source& source : sources) compare(source.tables, source.folder.string());
}

/// Whether `into` lacks the checkpoint or has only a damaged file while the source has a valid
/// file. False if `into` has the same state in a file with other bytes (another HDF5 version).
bool is_news(const Database& into, const CheckpointRecord& record) {
  Statement same(into,
                 "SELECT count(*), sum(state <> 'rejected') FROM checkpoints WHERE run = ? AND "
                 "(sha256 = ? OR (step = ? AND state_hash = ? AND state <> 'rejected'))",
                 record.run, record.sha256, record.step, record.state_hash);
  same.step();
  const bool damaged_here = same.u64(0) > 0;
  return same.u64(1) == 0 && (!damaged_here || record.state == CheckpointState::recorded);
}

/// The source's checkpoints whose files must be copied.
std::vector<CheckpointRecord> needed_objects(const Database& into, const Source& source) {
  auto needed = query_all_checkpoints(source.tables);
  std::erase_if(needed, [&](const CheckpointRecord& record) {
    return record.state != CheckpointState::recorded || !is_news(into, record);
  });
  return needed;
}

/// Throws FilePruned if a program pruned the checkpoint after the source was read.
std::vector<std::byte> read_object(const Source& source, const CheckpointRecord& record) {
  try {
    return source.objects.get(record.sha256, record.size);
  } catch (const StoreDamaged& damage) {
    const Database now = open_database(source.folder / "store.sqlite", Access::read);
    if (is_pruned_now(now, record)) throw FilePruned(damage.what());
    throw StoreDamaged(
        fmt::format("{}. Nothing was merged from {}", damage.what(), source.folder.string()));
  }
}

using Stream = std::vector<const Event*>;  // in the order of the log

/// Decides which events of one run are copied from the source to the store. If the store does not
/// have the run, every attempt is copied. Otherwise an attempt is copied if it recorded a new
/// checkpoint (see is_news). The last attempt is also copied if `source_wins` is true.
struct RunMerge {
  std::optional<Stage> before;       ///< the run in the store before the merge
  std::optional<Event> last_claim;   ///< last event in the store that began or ended an attempt
  std::set<std::string> known;       ///< SHA-256 of checkpoints for which is_news() is false
  std::set<std::uint64_t> attempts;  ///< seq (in the source) of the events of copied attempts
  /// Whether the source has a later step of the run than the store, or the same step and a state
  /// that is later in StageState. True if the store does not have the run.
  bool source_wins = false;

  bool wants(const Database& into, const Event& event) const {
    if (event.type == events::RunDeclared::kType) {
      const auto declared = std::get<events::RunDeclared>(events::decode(event));
      return !before || adds_something(query_stage(into, before->id), declared.membership);
    }
    if (events::begins_attempt(event) || events::ends_attempt(event) ||
        event.type == CheckpointRecorded::kType) {
      return attempts.contains(event.seq);
    }
    // An event that rejects, prunes or regenerates a checkpoint is copied only if the checkpoint is
    // new (see is_news).
    if (!event.type.starts_with("Checkpoint")) return true;
    return !known.contains(text_at(event.body(), "sha256"));
  }

  /// Returns the event `last_claim` if the copied events changed the state of the run. The caller
  /// then appends `last_claim` again, which restores the state that the run had before the merge.
  std::optional<Event> closing_event(const Database& into) const {
    if (!before || source_wins || attempts.empty() || !last_claim) return std::nullopt;
    const StageState now = query_stage(into, before->id).value().state;
    // If a copied event requests more cycles of a completed run, this run is left `declared`.
    const bool more_to_do = before->state == StageState::completed && now == StageState::declared;
    if (now == before->state || more_to_do) return std::nullopt;
    return last_claim;
  }
};

/// For all attempts that must be copied: the sequence numbers (seq) of their events.
std::set<std::uint64_t> attempts_to_take(const Stream& stream, const RunMerge& plan) {
  std::set<std::uint64_t> taken, attempt;
  bool news = false;
  const auto close = [&](bool last) {
    if (news || !plan.before || (last && plan.source_wins)) {
      taken.insert(attempt.begin(), attempt.end());
    }
    attempt.clear();
    news = false;
  };
  for (const Event* event : stream) {
    if (events::begins_attempt(*event)) {
      close(false);
      attempt.insert(event->seq);
    } else if (event->type == CheckpointRecorded::kType) {
      const auto recorded = std::get<CheckpointRecorded>(events::decode(*event));
      if (plan.known.contains(recorded.checkpoint.sha256)) continue;
      attempt.insert(event->seq);
      news = true;
    } else if (events::ends_attempt(*event)) {
      attempt.insert(event->seq);
    }
  }
  close(true);
  return taken;
}

RunMerge plan_run(const Database& into, const EventLog& log, const Database& source_tables,
                  const Stream& stream, const Stage& source_run) {
  RunMerge plan;
  plan.before = query_stage(into, source_run.id);
  for (Event& event : log.events(run_stream(source_run.id))) {
    if (events::begins_attempt(event) || events::ends_attempt(event)) {
      plan.last_claim = std::move(event);
    }
  }
  plan.source_wins = !plan.before || std::pair(source_run.step, source_run.state) >
                                         std::pair(plan.before->step, plan.before->state);
  for (const CheckpointRecord& record : query_checkpoints(source_tables, source_run.id)) {
    if (!is_news(into, record)) plan.known.insert(record.sha256);
  }
  plan.attempts = attempts_to_take(stream, plan);
  return plan;
}

/// Whether the stream holds the text of a manifest or of a file of grain positions.
bool holds_a_text(std::string_view stream) {
  return stream.starts_with("manifest/") || stream.starts_with("packing/");
}

/// Reads and checks a source. If `runs` is not empty, keeps only the events of these runs, of all
/// manifests and of all files of grain positions.
Source read_source(const std::filesystem::path& folder, const std::set<std::string>& runs) {
  const std::filesystem::path file = folder / "store.sqlite";
  if (!std::filesystem::exists(file)) {
    throw NotFound(fmt::format("{}: there is no store here to merge", folder.string()));
  }
  Database database = open_database(file, Access::read);
  const EventLog log(database);
  Source source{folder, {}, {}, empty_projections(file.string()), ObjectStore(folder)};
  {
    const sqlite::ReadTransaction snapshot(database);
    if (const auto fault = log.verify_chain()) {
      throw StoreDamaged(fmt::format("{}: {}. Nothing was merged from this store", folder.string(),
                                     fault->message));
    }
    source.head = log.head();
    source.events = log.events();
  }
  if (!runs.empty()) {
    std::erase_if(source.events, [&runs](const Event& event) {
      const auto run = run_of(event);
      return !holds_a_text(event.stream) && !(run && runs.contains(*run));
    });
  }
  for (const Event& event : source.events) {
    const std::string why = try_apply(source.tables, event);
    if (why.empty()) continue;
    throw StoreDamaged(fmt::format("{}: event {} ({}) cannot be applied: {}. Nothing was merged",
                                   folder.string(), event.seq, event.type, why));
  }
  return source;
}

void require_idle(const Store& into) {
  for (const Lease& lease : into.leases()) {
    throw MachineError(
        fmt::format("{}: a program is computing run {:.12} ({}); merge when that program has ended",
                    into.folder().string(), lease.run, describe(lease.holder)));
  }
}

/// Appends and applies the events that the store lacks, then appends StoreMerged.
void merge_events(Database& into, EventLog& log, const sqlite::WriteTransaction& lock,
                  const Source& source, MergeReport& report) {
  std::set<std::string> known;
  log.for_each([&known](const Event& event) { known.insert(content_key(event)); });
  const std::vector<FigureRecord> figures = query_figures(into);
  std::map<std::string, Stream> streams;
  for (const Event& event : source.events) streams[event.stream].push_back(&event);
  std::map<std::string, RunMerge> runs;  // by stream
  for (const Stage& stage : query_stages(source.tables)) {
    const std::string stream = run_stream(stage.id);
    runs.emplace(stream, plan_run(into, log, source.tables, streams.at(stream), stage));
  }
  // Manifests and files of grain positions that `into` already has are not copied.
  std::erase_if(streams, [&log](const auto& entry) {
    return holds_a_text(entry.first) && log.version(entry.first) > 0;
  });
  const auto take = [&](const Event& event) { apply(into, log.append_copy(lock, event)); };
  for (const Event& event : source.events) {
    if (known.contains(content_key(event)) || !streams.contains(event.stream)) continue;
    if (run_of(event)) {
      const auto run = runs.find(event.stream);
      if (run == runs.end() || !run->second.wants(into, event)) continue;
    }
    take(event);
    ++report.events;
  }
  for (const auto& [stream, run] : runs) {
    if (const auto closing = run.closing_event(into)) take(*closing);
  }
  // The last event of a figure is the valid one. If the store had a newer version of a copied
  // figure before the merge, the event of that newer version is appended again.
  for (const FigureRecord& copied : query_figures(into)) {
    const auto own = std::ranges::find(figures, copied.name, &FigureRecord::name);
    if (own == figures.end() || own->recorded_at <= copied.recorded_at) continue;
    for (const Event& event : log.events("figure/" + copied.name)) {
      if (event.seq == own->seq) take(event);
    }
  }
  Statement same_head(into,
                      "SELECT 1 FROM events WHERE stream = 'store/merge' AND json_valid(payload) "
                      "AND json_extract(payload, '$.head.hash') = ?",
                      source.head.hash);
  if (same_head.step()) return;  // merged before
  log.append(lock, "store/merge",
             events::encode(
                 events::StoreMerged{.source = source.folder.string(),
                                     .head = {{"seq", source.head.seq}, {"hash", source.head.hash}},
                                     .events = report.events,
                                     .checkpoints = report.checkpoints}));
}

}  // namespace

std::vector<MergeReport> Store::merge(const std::vector<std::filesystem::path>& folders,
                                      const std::set<std::string>& runs) {
  must_write();
  const std::scoped_lock guard(mutex_);
  std::vector<MergeReport> reports;
  while (reports.size() < folders.size()) {
    try {
      std::vector<Source> sources;
      for (const std::filesystem::path& folder : std::span(folders).subspan(reports.size())) {
        std::error_code ignored;
        if (std::filesystem::equivalent(folder, folder_, ignored)) {
          throw NotFound(folder.string() +
                         ": a store cannot be merged into itself; choose another store");
        }
        sources.push_back(read_source(folder, runs));
      }
      // All checks are made before the first byte is written.
      require_idle(*this);
      require_agreement(database_, folder_.string(), sources);
      for (const Source& source : sources) {
        for (const CheckpointRecord& record : needed_objects(database_, source))
          read_object(source, record);
      }
      for (const Source& source : sources) {
        MergeReport report{.source = source.folder.string(), .head = source.head};
        const std::vector<CheckpointRecord> needed = needed_objects(database_, source);
        for (const CheckpointRecord& record : needed) {
          objects_.put(read_object(source, record));
          ++report.checkpoints;
          report.bytes += record.size;
        }
        sqlite::WriteTransaction lock(database_);
        require_idle(*this);
        merge_events(database_, log_, lock, source, report);
        // After the copied events have been applied, a checkpoint may still be marked as rejected,
        // although its copied file is valid.
        for (const CheckpointRecord& record : needed) {
          const auto now = query_checkpoint(database_, record.run, record.sha256);
          if (!now || now->state != CheckpointState::rejected) continue;
          append(run_stream(now->run), events::encode(events::CheckpointRegenerated{{*now}}), lock);
        }
        lock.commit();
        reports.push_back(std::move(report));
      }
    } catch (const FilePruned&) {
      // A checkpoint was pruned after the source was read, so the loop reads the source again.
    }
  }
  return reports;
}

}  // namespace shearcell
