// SPDX-License-Identifier: GPL-3.0-or-later
// The store as the rest of the program sees it: one folder that remembers every run.
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "provenance/checkpoint.hpp"
#include "provenance/errors.hpp"
#include "provenance/event_log.hpp"
#include "provenance/objects.hpp"
#include "provenance/records.hpp"
#include "provenance/verify.hpp"

namespace shearcell {

enum class Access {
  create,  ///< read and write; the folder is made when it is missing
  write,   ///< read and write; the store must exist
  read     ///< the store must exist; the recording functions throw std::logic_error
};

struct LoadedCheckpoint {
  CheckpointRecord record;
  Checkpoint checkpoint;
};

/// Thread-safe: any thread may call any function at any time. Several processes may open one store
/// on a local disk; the log decides who came first.
///
/// Between `start_run` and `interrupt_run`, `fail_run` or `complete_run` this object holds the run.
/// When another process starts the same run meanwhile, the next record throws ConcurrencyConflict
/// and the run is no longer held: stop stepping it.
///
/// Every function may throw StoreDamaged, StoreBusy and std::runtime_error (disk full, ...).
class Store {
 public:
  /// Throws StoreDamaged when the folder is a plain file, holds something else or has a newer
  /// schema; NotFound when it is missing and `access` does not create it.
  Store(std::filesystem::path folder, Access access);

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
  /// given. Returns the attempt's number, 1 for the first. Throws NotFound when the run or the
  /// checkpoint is unknown and ConcurrencyConflict when this object holds the run already.
  std::uint64_t start_run(const std::string& id, const nlohmann::json& host,
                          const std::optional<std::string>& from_sha256 = std::nullopt);

  /// Writes the file, then the event. A checkpoint that is recorded already gives its old record.
  /// Throws std::invalid_argument when the checkpoint names another run or holds NaN.
  CheckpointRecord record_checkpoint(const std::string& id, const Checkpoint& checkpoint,
                                     const Effort& effort = {});
  void interrupt_run(const std::string& id, const std::string& why);
  void fail_run(const std::string& id, const std::string& why,
                const nlohmann::json& numbers = nlohmann::json::object());
  void complete_run(const std::string& id,
                    const nlohmann::json& summary = nlohmann::json::object());

  /// From now on the checkpoint is passed over; its file stays.
  void reject_checkpoint(const std::string& id, const std::string& sha256, const std::string& why);

  /// The newest checkpoint from which the run can go on. Those that are missing or damaged are
  /// rejected (only skipped with Access::read) and the next older one is tried.
  /// What was wrong with each of those is appended to `damage`, when given.
  std::optional<LoadedCheckpoint> newest_valid_checkpoint(
      const std::string& id, std::vector<std::string>* damage = nullptr);

  /// `provenance` holds the inputs and the SHA-256 of the outputs.
  void record_figure(const std::string& name, const nlohmann::json& provenance);

  // --- What is known ---

  std::vector<RunRecord> runs() const;  ///< in the order in which they were declared
  RunRecord run(const std::string& id) const;
  /// The run whose id begins so. Throws NotFound, listing the candidates when there are several.
  RunRecord find_run(std::string_view prefix) const;
  /// In ascending order of step. Rejected ones only on request.
  std::vector<CheckpointRecord> checkpoints(const std::string& id,
                                            bool with_rejected = false) const;
  /// Reads, verifies and decodes. Throws StoreDamaged naming the file.
  Checkpoint load_checkpoint(const CheckpointRecord& record) const;
  std::vector<FigureRecord> figures() const;  ///< the newest of each name, by name
  /// Of one stream ("run/<id>", ...), or of all ("").
  std::vector<Event> events(std::string_view stream = "") const;
  Head head() const;

  // --- Care ---

  /// Drops what was derived from the events and derives it again.
  void rebuild();
  VerifyReport verify() const;

 private:
  void append(std::string_view stream, std::uint64_t expected_version, NewEvent event,
              const sqlite::WriteTransaction& lock);
  void append_held(const std::string& id, NewEvent event, bool release);
  void must_write() const;

  std::filesystem::path folder_;
  Access access_;
  ObjectStore objects_;
  mutable std::mutex mutex_;  ///< guards everything below
  mutable sqlite::Database database_;
  EventLog log_;
  std::map<std::string, std::uint64_t> held_;  ///< run id -> version of its stream when last seen
};

}  // namespace shearcell
