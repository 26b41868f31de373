// SPDX-License-Identifier: GPL-3.0-or-later
// The store as the rest of the program uses it: one folder with the log and the checkpoint files.
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "provenance/checkpoint.hpp"
#include "provenance/errors.hpp"
#include "provenance/event_log.hpp"
#include "provenance/lease.hpp"
#include "provenance/objects.hpp"
#include "provenance/records.hpp"

namespace shearcell {

/// The stream that holds submissions to a cluster.
inline constexpr std::string_view kSubmissions = "store/submission";

struct LoadedCheckpoint {
  CheckpointRecord record;
  Checkpoint checkpoint;
};

struct Finding {
  /// `error`: a record is lost or changed. `note`: every record is intact. `unread`: the subject
  /// could not be checked, because the operating system reported an error.
  enum class Severity { note, unread, error };
  Severity severity = Severity::note;
  std::string subject;  ///< file, event or table
  std::string run;      ///< affected run, or ""
  std::string message;  ///< problem and remedy
};

struct VerifyReport {
  std::vector<Finding> findings;
  std::uint64_t events = 0;
  std::uint64_t checkpoints = 0;  ///< number of checkpoint files hashed
  std::uint64_t bytes = 0;        ///< total size of the hashed files
  std::uint64_t orphans = 0;      ///< files to which no event refers
  Head head;                      ///< head of the log, which can be saved for a later verify()

  /// The number of findings of this severity.
  std::size_t count(Finding::Severity severity) const;
  bool ok() const { return count(Finding::Severity::error) == 0; }
};

struct MergeReport {
  std::string source;             ///< folder as the user gave it
  Head head;                      ///< head of the source when it was read
  std::uint64_t events = 0;       ///< number of copied events
  std::uint64_t checkpoints = 0;  ///< number of copied files
  std::uint64_t bytes = 0;        ///< total size of the copied files
  // Set by merge_stores():
  std::size_t absent = 0;             ///< MeasureCheck::absent of the source
  std::vector<Finding> refused = {};  ///< why measures of the source were not copied
};

/// Decodes the checkpoint file `image`. Throws StoreDamaged if the file is damaged or not
/// plausible, or if its run, step, cycle, time, units, number of grains, observables or state
/// differ from the record or from the parameters of the run.
Checkpoint read_checkpoint(std::span<const std::byte> image, const CheckpointRecord& record,
                           const Stage& stage);

/// Thread-safe. Several processes may open one store on a local disk; conflicting writes throw
/// ConcurrencyConflict. Every function may throw StoreDamaged, and std::runtime_error when the
/// machine fails (disk full, no permission) or another process keeps the store locked.
///
/// Between start_stage() and the end of the attempt this object holds a lease on the run. Calls of
/// record_checkpoint() and renew_leases() renew the lease. Another program may continue the run
/// when the lease has expired, or at once when the process of the holder is dead. If the
/// previous holder then calls a function that records something for the run, the function throws
/// ConcurrencyConflict, and the previous holder must stop the computation. The destructor releases
/// all leases.
class Store {
 public:
  /// Throws NotFound if there is no store and `access` does not create one; UsageError if a store
  /// cannot be created at this path; StoreDamaged if the log is lost, is damaged or has a newer
  /// schema. If the store is opened for writing, a missing folder of checkpoints is damage, too. A
  /// lease expires when it is not renewed for `lease_seconds` (at most kLongestLeaseMs).
  Store(std::filesystem::path folder, Access access,
        double lease_seconds = static_cast<double>(kLongestLeaseMs) / 1000);
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  const std::filesystem::path& folder() const { return folder_; }

  // --- Recording ---

  /// Stores the text and returns its SHA-256. Records nothing if this text is already
  /// the newest manifest of info["experiment"].
  std::string register_manifest(std::string_view text, std::string_view path,
                                const nlohmann::json& info);

  /// Stores the text of a file of grain positions, unless the store already has it. Returns the
  /// SHA-256 of the text.
  std::string register_packing(std::string_view text, std::string_view path);
  /// The text of the file of grain positions that has this SHA-256, and the path that
  /// register_packing() recorded. Throws StoreDamaged if the store lacks the text.
  std::pair<std::string, std::string> packing_text(const std::string& sha256) const;

  /// Records those memberships of the stage that meet one of these conditions: the store does not
  /// have the membership; the store has it with a smaller target or another checkpoint interval;
  /// the last stage declared for the membership's place is another stage. A larger target makes
  /// a completed stage `declared` again. Throws std::invalid_argument when the stage's id is not a
  /// SHA-256 or was recorded with other parameters, or when the parent was not declared.
  void declare_stage(const Stage& stage);

  /// Starts an attempt and returns its number, from 1. If `from_sha256` is given, the attempt
  /// continues from the run's checkpoint with this SHA-256. `parent_checkpoint`, the SHA-256 of
  /// the initial state, is recorded but not checked. `fill` is for a run that is already completed:
  /// the attempt records missing checkpoints before the last one, and then completes the run again.
  /// Throws NotFound when the run or the checkpoint is unknown. Throws ConcurrencyConflict in these
  /// cases: this object or another program holds the run; `fill` is true, but the run is not
  /// completed; `fill` is false, but the run is completed or has reached a later step than the step
  /// from which the attempt starts.
  std::uint64_t start_stage(const std::string& id, const nlohmann::json& host,
                            const std::optional<std::string>& from_sha256 = std::nullopt,
                            const std::string& parent_checkpoint = "", bool fill = false);

  /// Renews the leases of all held runs; call it several times within `lease_seconds`. Runs that
  /// another program has taken over are no longer held.
  void renew_leases();
  double lease_seconds() const { return static_cast<double>(lease_ms_) / 1000; }
  bool holds(const std::string& id) const;

  /// Writes the file, then the event. If the checkpoint is already recorded, returns its record.
  /// Throws std::invalid_argument when the checkpoint belongs to another run or holds NaN.
  CheckpointRecord record_checkpoint(const std::string& id, const Checkpoint& checkpoint,
                                     const Effort& effort = {});
  void interrupt_stage(const std::string& id, const std::string& why);
  void fail_stage(const std::string& id, const std::string& why,
                  const nlohmann::json& numbers = nlohmann::json::object());
  /// `target_cycles` is the target of the attempt. If the recorded target of the run is larger by
  /// now, the run becomes `declared` again.
  void complete_stage(const std::string& id,
                      const nlohmann::json& summary = nlohmann::json::object(),
                      std::optional<std::uint64_t> target_cycles = std::nullopt);

  /// Marks the checkpoint as rejected, so that it is not used. Its file is kept.
  void reject_checkpoint(const std::string& id, const std::string& sha256, const std::string& why);

  /// The newest checkpoint before `before_step` that can be loaded. Missing and damaged checkpoints
  /// are skipped. If `damage` is given, an error is added to `damage` for each of them, and a
  /// writable store also marks them as rejected.
  std::optional<LoadedCheckpoint> newest_valid_checkpoint(
      const std::string& id, std::vector<std::string>* damage = nullptr,
      std::uint64_t before_step = UINT64_MAX);

  /// Appends an event that changes no run. FigureGenerated has a stream such as
  /// "figure/drag/desk/S2", ReplayVerified and ReplayDiverged have the stream of the run, and
  /// CampaignSubmitted and JobQueued have kSubmissions.
  /// Throws ConcurrencyConflict if `seen` is given and differs from the number of events in the
  /// stream.
  void record(std::string_view stream, const NewEvent& event,
              std::optional<std::uint64_t> seen = std::nullopt);

  // --- Reading ---

  /// While a Snapshot exists, all reads through this store see one state of the log, and no other
  /// program can write to the log. Keep it only while rows are read, not while files are read or
  /// results are computed. The first Snapshot of a Store calls require_complete(), which throws
  /// StoreDamaged if events or rows are missing.
  struct Snapshot : private std::scoped_lock<std::recursive_mutex>, sqlite::ReadTransaction {
    explicit Snapshot(const Store& store);
  };

  std::vector<Stage> stages() const;  ///< in the order of their declaration
  Stage stage(const std::string& id) const;
  std::vector<Lease> leases() const;  ///< only leases that have not lapsed
  /// The stage whose id begins with `prefix`. Throws NotFound when there is none or more than one;
  /// the message lists the candidates.
  Stage find_stage(std::string_view prefix) const;
  /// The checkpoints of a stage, in ascending order of step.
  std::vector<CheckpointRecord> checkpoints(const std::string& id,
                                            Listed listed = Listed::recorded) const;
  /// The checkpoint, in any state, whose SHA-256 begins with `prefix`; nothing when there is none.
  /// Throws NotFound when there are several; the message lists the candidates.
  std::optional<CheckpointRecord> find_checkpoint(std::string_view prefix) const;
  /// The bytes of a checkpoint file, whose SHA-256 is checked. Throws FilePruned if the checkpoint
  /// was pruned, even if this happened after the caller got `record`. Throws StoreDamaged, which
  /// names the file, if the file is missing for another reason or its size or SHA-256 differs.
  std::vector<std::byte> read_file(const CheckpointRecord& record) const;
  /// Decodes the file and compares the content with the record. Throws StoreDamaged with the path.
  Checkpoint load_checkpoint(const CheckpointRecord& record) const;
  /// Like load_checkpoint(), but returns nothing when the checkpoint is damaged or was pruned.
  std::optional<Checkpoint> load_if_readable(const CheckpointRecord& record) const;
  std::vector<FigureRecord> figures() const;  ///< newest record per figure, sorted by name
  /// Events in order. An empty `stream` means all streams, and an empty `type` means all types.
  std::vector<Event> events(std::string_view stream = "", std::string_view type = "") const;
  Head head() const;

  // --- Maintenance ---

  /// Drops the tables and derives them from the events.
  void rebuild();
  /// Reports damage as findings; never throws StoreDamaged. `against` is a head that was saved
  /// earlier; if the log does not contain this head, the log is reported as damaged.
  VerifyReport verify(const std::optional<Head>& against = std::nullopt) const;

  /// The checkpoints that prune() may delete. Excludes the initial states of stages that have not
  /// ended. Without PruneChoice::last_too, also excludes the initial states of ended stages, the
  /// newest readable checkpoint of each run, and the unreadable ones after it.
  std::vector<CheckpointRecord> prunable(const PruneChoice& choice) const;
  /// Pruned checkpoints whose files still exist because of a crash.
  std::vector<CheckpointRecord> prune_leftovers() const;
  /// Records the checkpoints as pruned, then deletes their files. Skips a checkpoint if the store
  /// has changed so that the checkpoint must now be kept. Returns the number of bytes freed.
  std::uint64_t prune(const std::vector<CheckpointRecord>& records, bool last_too = false);
  /// Stores a regenerated checkpoint. Throws StoreDamaged when its bytes differ from the record.
  void restore_checkpoint(const CheckpointRecord& record, const Checkpoint& checkpoint);

  /// Merges other stores into this one (merge.cpp). If `runs` is not empty, only these runs are
  /// merged, and `runs` must contain their parents, too. All manifests and all files of grain
  /// positions are merged in any case. Throws NotFound when a source is not a store, and
  /// MachineError while a process computes a run of this store. Throws StoreDamaged if a source is
  /// damaged, or if two stores hold different states for the same step of a run or use one id for
  /// different runs. All sources are checked before the first source is merged.
  std::vector<MergeReport> merge(const std::vector<std::filesystem::path>& sources,
                                 const std::set<std::string>& runs = {});

 private:
  /// Appends one event to the log and applies it to the tables.
  void append(std::string_view stream, const NewEvent& event, const sqlite::WriteTransaction& lock);
  /// Appends an event that only the holder of the lease may write. `release` ends the lease.
  void append_held(const std::string& id, const NewEvent& event, bool release);
  /// Returns the database. Throws std::logic_error if the store was opened with Access::read.
  sqlite::Database& must_write() const;
  /// A write transaction that also locks out other threads of this program.
  struct Writing : private std::scoped_lock<std::recursive_mutex>, sqlite::WriteTransaction {
    explicit Writing(Store& store);
  };

  std::filesystem::path folder_;
  Access access_;
  mutable bool is_complete_ = false;  ///< whether require_complete() was called
  ObjectStore objects_;
  mutable std::recursive_mutex mutex_;  ///< guards all members below
  mutable sqlite::Database database_;
  EventLog log_;
  Holder self_;
  std::uint64_t lease_ms_;
  std::map<std::string, std::uint64_t> held_;  ///< run id -> number of the attempt
};

}  // namespace shearcell
