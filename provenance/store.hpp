// SPDX-License-Identifier: GPL-3.0-or-later
// The store as the rest of the program sees it: one folder that remembers every run.
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "provenance/checkpoint.hpp"
#include "provenance/errors.hpp"
#include "provenance/event_log.hpp"
#include "provenance/lease.hpp"
#include "provenance/merge.hpp"
#include "provenance/objects.hpp"
#include "provenance/records.hpp"
#include "provenance/verify.hpp"

namespace shearcell {

enum class Access {
  create,  ///< read and write; the folder is made when it is missing
  write,   ///< read and write; the store must exist
  read     ///< the store must exist; the recording functions throw std::logic_error
};

struct StoreOptions {
  /// After this long without a sign of life of its holder a run may be taken by others.
  double lease_seconds = 60;
};

/// The stream of what `record_submission` records.
inline constexpr std::string_view kSubmissions = "store/submission";

struct LoadedCheckpoint {
  CheckpointRecord record;
  Checkpoint checkpoint;
};

/// Thread-safe: any thread may call any function at any time. Several processes may open one store
/// on a local disk; the log decides who came first.
///
/// Between `start_run` and `interrupt_run`, `fail_run` or `complete_run` this object holds the run,
/// by a lease that every record and `renew_leases` prolong. Others may take the run when the lease
/// has expired, at once when the holder's process is dead; then the next record throws
/// ConcurrencyConflict and the run is no longer held: stop stepping it. A Store that goes away
/// gives its leases back.
///
/// Every function may throw StoreDamaged, StoreBusy and std::runtime_error (disk full, ...).
class Store {
 public:
  /// Throws StoreDamaged when the folder is a plain file, holds something else or has a newer
  /// schema; NotFound when it is missing and `access` does not create it.
  Store(std::filesystem::path folder, Access access, const StoreOptions& options = {});
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  const std::filesystem::path& folder() const { return folder_; }

  // --- What happened ---

  /// Keeps the text once; returns its SHA-256.
  std::string register_manifest(std::string_view text, std::string_view path,
                                const nlohmann::json& info);

  /// Nothing is recorded when the run is known with this membership and at least this target. A
  /// longer target makes a completed run `declared` again. Throws std::invalid_argument when the id
  /// is no digest, stands for other parameters, or its parent was never declared.
  void declare_run(const RunDeclaration& declaration);

  /// Begins an attempt, from `from_sha256` (the checkpoint of this run that it continues) when
  /// given; else from `parent_checkpoint`, which is only noted. Returns the attempt's number, 1 for
  /// the first. Throws NotFound when the run or the checkpoint is unknown, RunHeld when another
  /// program is at work on it, and ConcurrencyConflict when this object holds the run already, when
  /// nothing is left to do, or when somebody recorded a later checkpoint than `from_sha256`.
  std::uint64_t start_run(const std::string& id, const nlohmann::json& host,
                          const std::optional<std::string>& from_sha256 = std::nullopt,
                          const std::string& parent_checkpoint = "");

  /// Shows that this program is still at work on what it holds; call it a few times within
  /// `lease_seconds`. A run that somebody else took is held no longer.
  void renew_leases();
  double lease_seconds() const { return static_cast<double>(lease_ms_) / 1000; }
  bool holds(const std::string& id) const;

  /// Writes the file, then the event. A checkpoint that is recorded already gives its old record.
  /// Throws std::invalid_argument when the checkpoint names another run or holds NaN.
  CheckpointRecord record_checkpoint(const std::string& id, const Checkpoint& checkpoint,
                                     const Effort& effort = {});
  void interrupt_run(const std::string& id, const std::string& why);
  void fail_run(const std::string& id, const std::string& why,
                const nlohmann::json& numbers = nlohmann::json::object());
  /// `target_cycles` is the length that was reached: a run whose target is longer by now is
  /// declared again.
  void complete_run(const std::string& id, const nlohmann::json& summary = nlohmann::json::object(),
                    std::optional<std::uint64_t> target_cycles = std::nullopt);

  /// From now on the checkpoint is passed over; its file stays.
  void reject_checkpoint(const std::string& id, const std::string& sha256, const std::string& why);

  /// The newest checkpoint from which the run can go on. Those that are missing or damaged are
  /// rejected (only skipped with Access::read) and the next older one is tried.
  /// What was wrong with each of those is appended to `damage`, when given.
  std::optional<LoadedCheckpoint> newest_valid_checkpoint(
      const std::string& id, std::vector<std::string>* damage = nullptr);

  /// `provenance` holds the inputs and the SHA-256 of the outputs.
  void record_figure(const std::string& name, const nlohmann::json& provenance);

  /// Work that was handed to a cluster ("CampaignSubmitted", "JobQueued"). Throws
  /// ConcurrencyConflict when `seen`, the number of such events that the caller has read, is not
  /// all.
  void record_submission(const std::string& type, const nlohmann::json& facts,
                         std::optional<std::uint64_t> seen = std::nullopt);

  // --- What is known ---

  std::vector<RunRecord> runs() const;  ///< in the order in which they were declared
  RunRecord run(const std::string& id) const;
  /// Who works on which run now. Leases that anybody may take are left out.
  std::vector<Lease> leases() const;
  /// The run whose id begins so. Throws NotFound, listing the candidates when there are several.
  RunRecord find_run(std::string_view prefix) const;
  /// In ascending order of step: those that can be read, or all that were ever recorded.
  std::vector<CheckpointRecord> checkpoints(const std::string& id, bool all = false) const;
  /// The checkpoint whose SHA-256 begins so, whatever its state. Throws as find_run does.
  CheckpointRecord find_checkpoint(std::string_view prefix) const;
  /// Reads, verifies and decodes. Throws StoreDamaged naming the file, and CheckpointPruned.
  Checkpoint load_checkpoint(const CheckpointRecord& record) const;
  std::vector<FigureRecord> figures() const;  ///< the newest of each name, by name
  /// Of one stream ("run/<id>", ...), or of all ("").
  std::vector<Event> events(std::string_view stream = "") const;
  Head head() const;

  // --- Care ---

  /// Drops what was derived from the events and derives it again.
  void rebuild();
  /// `against` is a head that `verify` told earlier: the log must extend it.
  VerifyReport verify(const std::optional<Head>& against = std::nullopt) const;

  /// The checkpoints that `prune` would free. Left out are the newest checkpoint of each run, the
  /// newest that can be read, and those that another stage started from.
  std::vector<CheckpointRecord> prunable(const PruneChoice& choice) const;
  /// Files of pruned checkpoints that a crash left behind.
  std::vector<CheckpointRecord> prune_leftovers() const;
  /// Records that they are pruned and then removes their files; a crash in between leaves files
  /// that `verify` notes and the next `prune` removes. What became unfit to be pruned since is
  /// kept. Returns the bytes that were freed.
  std::uint64_t prune(const std::vector<CheckpointRecord>& records);
  /// Keeps what was computed again for a record whose file is gone. Throws StoreDamaged when it is
  /// not the same, byte for byte.
  void restore_checkpoint(const CheckpointRecord& record, const Checkpoint& checkpoint);
  /// ReplayVerified or ReplayDiverged: what came of computing a part of the run again.
  void record_replay(const std::string& id, bool same, const nlohmann::json& facts);

  /// Folds the events and checkpoints of other stores in (merge.hpp); with `runs`, only of these
  /// runs, which must hold the parents of each. Throws StoreDamaged or MergeConflict, naming what
  /// is wrong, before anything is changed.
  std::vector<MergeReport> merge(const std::vector<std::filesystem::path>& sources,
                                 const std::set<std::string>& runs = {});

 private:
  void append(std::string_view stream, std::uint64_t expected_version, NewEvent event,
              const sqlite::WriteTransaction& lock);
  void append_held(const std::string& id, NewEvent event, bool release);
  void hold(const std::string& id, std::uint64_t attempt);
  void must_write() const;

  std::filesystem::path folder_;
  Access access_;
  ObjectStore objects_;
  mutable std::mutex mutex_;  ///< guards everything below
  mutable sqlite::Database database_;
  EventLog log_;
  struct Held {
    std::uint64_t version = 0;  ///< of the run's stream when last seen
    std::uint64_t attempt = 0;
  };
  Holder self_;
  std::uint64_t lease_ms_;
  std::map<std::string, Held> held_;  ///< by run id
};

}  // namespace shearcell
