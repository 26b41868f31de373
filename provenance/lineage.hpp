// SPDX-License-Identifier: GPL-3.0-or-later
// The origin of each checkpoint of a run: the attempt that recorded the checkpoint, the host and
// the build of this attempt, and the state from which the attempt started.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "provenance/events.hpp"
#include "provenance/store.hpp"

namespace shearcell {

/// `lost`: no event records the end of the attempt (kill, power cut), and a later attempt started.
enum class AttemptOutcome { running, completed, interrupted, failed, lost };
template <>
inline constexpr auto kNames<AttemptOutcome> =
    names_in_order<AttemptOutcome>("running", "completed", "interrupted", "failed", "lost");

/// Program and machine of an attempt, as texts for display. A text is "unknown" if not recorded.
struct Maker {
  std::string program;                 ///< "shearcell 0.1.0 (dd11cbe), GNU 12.2.0 Release"
  std::string version;                 ///< "0.1.0 (dd11cbe)"
  std::string flags;                   ///< compiler flags
  std::vector<std::string> libraries;  ///< "hdf5 1.10.8"
  std::string host;                    ///< name of the machine
  std::string system;
  std::string machine;  ///< "AMD EPYC 7763, 4 cores, AVX2"
};
/// `host` is the JSON object that host_facts() returned.
Maker maker_of(const nlohmann::json& host);

/// A period in which one program computed a run. Resuming the run begins a new attempt.
struct Attempt {
  std::uint64_t seq = 0;   ///< seq of the event that began the attempt
  std::string started_at;  ///< UTC
  std::string ended_at;    ///< UTC; "" when no event ended the attempt
  AttemptOutcome outcome = AttemptOutcome::running;
  std::string why;  ///< reason for a failure or interruption; "" otherwise
  /// Host, build and libraries as recorded: a JSON object, which may be empty.
  nlohmann::json host = nlohmann::json::object();
  std::string from_run;         ///< run that recorded the initial state; "" if no run did
  std::string from_checkpoint;  ///< SHA-256 of the initial state, or ""
  /// See core/bits_version.hpp. If an old event lacks this number, Event::schema determines it.
  std::uint64_t bits_version = 0;
  std::vector<std::string> checkpoints;  ///< SHA-256 of the recorded checkpoints, in order
};

/// One checkpoint. record.state is its state (recorded, rejected, pruned) at the end of the log.
struct CheckpointHistory {
  CheckpointRecord record;
  std::string recorded_at;  ///< UTC
  /// Index in RunLineage::attempts of the last attempt that recorded this checkpoint.
  std::optional<std::size_t> attempt;
  /// Whether the checkpoint file should exist and be valid.
  bool kept() const { return record.state == CheckpointState::recorded; }
  const std::string& sha256() const { return record.sha256; }
};

struct RunLineage {
  Stage stage;
  std::vector<Attempt> attempts;  ///< in the order of the log; shown to users as 1, 2, ...
  std::vector<CheckpointHistory> checkpoints;  ///< in ascending order of step

  const CheckpointHistory* find(std::string_view sha256) const;
};

/// The stage and all stages before it, in order. Throws NotFound for an unknown stage.
std::vector<Stage> chain_of(const Store& store, const std::string& id);

/// The lineage of each stage of chain_of(). Throws StoreDamaged if an event is damaged.
std::vector<RunLineage> run_lineage(const Store& store, const std::string& id);

using RunLineages = std::map<std::string, RunLineage>;  ///< by id

/// Adds the lineages of run `id` and all stages before it. Does nothing if `lineages` has `id`.
void add_run_lineage(const Store& store, const std::string& id, RunLineages& lineages);

/// Processor time of a stage, and the names of the processors.
struct ComputingTime {
  /// Processor time of all attempts [s]. The steps after the last recorded checkpoint of an attempt
  /// are not counted. Attempts of earlier program versions, and of LAMMPS under mpirun, recorded no
  /// processor time. For such attempts, wall-clock time times the number of processes is added.
  double core_seconds = 0;
  std::set<std::string> processors;  ///< names of the processors that computed the steps
};

/// The processor time up to cycle `last_cycle`. Throws StoreDamaged if an event is damaged.
ComputingTime computing_time(const Store& store, const std::string& id, double last_cycle);

struct ManifestText : events::ManifestRegistered {
  std::string registered_at;  ///< UTC
};

/// A registered manifest; nothing when the store does not have it. Throws StoreDamaged when the
/// SHA-256 of the stored text is not `sha256`.
std::optional<ManifestText> find_manifest(const Store& store, const std::string& sha256);

}  // namespace shearcell
