// SPDX-License-Identifier: GPL-3.0-or-later
// The origin of each checkpoint of a run: the attempt that recorded it, its host and build, and the
// state it started from.
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

/// `lost`: a later attempt started and no event ended this one (a kill, a power cut).
enum class AttemptOutcome { running, completed, interrupted, failed, lost };
template <>
inline constexpr auto kNames<AttemptOutcome> =
    names_in_order<AttemptOutcome>("running", "completed", "interrupted", "failed", "lost");

/// The program and the machine that made something, as texts to show; "unknown" where nothing was
/// recorded.
struct Maker {
  std::string program;                 ///< "shearcell 0.1.0 (dd11cbe), GNU 12.2.0 Release"
  std::string version;                 ///< "0.1.0 (dd11cbe)"
  std::string flags;                   ///< of the compiler
  std::vector<std::string> libraries;  ///< "hdf5 1.10.8"
  std::string host;                    ///< its name
  std::string system;
  std::string machine;  ///< "AMD EPYC 7763, 4 cores, AVX2"
};
/// Reads what host_facts() recorded.
Maker maker_of(const nlohmann::json& host);

/// One computation of a run by one program, from start to end.
struct Attempt {
  std::uint64_t seq = 0;   ///< the event that began it
  std::string started_at;  ///< UTC
  std::string ended_at;    ///< UTC; "" when no event ended it
  AttemptOutcome outcome = AttemptOutcome::running;
  std::string why;  ///< of a failure or interruption; "" otherwise
  /// Recorded host, build and libraries; an object, maybe empty.
  nlohmann::json host = nlohmann::json::object();
  std::string from_run;  ///< run of the initial state; "" if it began from loose grains or a file
  std::string from_checkpoint;           ///< SHA-256 of the initial state, or ""
  std::uint64_t bits_version = 0;        ///< of the program; for old records, what they imply
  std::vector<std::string> checkpoints;  ///< SHA-256 of its checkpoints, in order
};

/// One checkpoint, with its state after all events.
struct CheckpointHistory {
  CheckpointRecord record;
  std::string recorded_at;  ///< UTC
  /// Index in RunLineage::attempts of the last attempt that recorded it.
  std::optional<std::size_t> attempt;
  /// Whether the file should exist and be valid.
  bool kept() const { return record.state == CheckpointState::recorded; }
  const std::string& sha256() const { return record.sha256; }
};

struct RunLineage {
  Stage stage;
  std::vector<Attempt> attempts;               ///< in the order of the log; shown as 1, 2, ...
  std::vector<CheckpointHistory> checkpoints;  ///< in ascending order of step

  const CheckpointHistory* find(std::string_view sha256) const;
};

/// The stage and the stages before it, the first one first. Throws NotFound for an unknown stage.
std::vector<Stage> chain_of(const Store& store, const std::string& id);

/// The stages of chain_of() with their lineage. Throws StoreDamaged, naming the event, for a
/// damaged payload.
std::vector<RunLineage> run_lineage(const Store& store, const std::string& id);

using RunLineages = std::map<std::string, RunLineage>;  ///< by id

/// Adds the lineage of the run and of the stages before it, unless it is there.
void add_run_lineage(const Store& store, const std::string& id, RunLineages& lineages);

/// Processor time of a stage, and the processors.
struct ComputingTime {
  /// Processor time of all steps up to recorded checkpoints, over all attempts. Where none was
  /// recorded (by earlier versions, and of LAMMPS under mpirun), wall-clock time times processes.
  double core_seconds = 0;
  std::set<std::string> processors;  ///< their names, of the attempts that recorded checkpoints
};

/// The time up to the checkpoint of `last_cycle`. Throws StoreDamaged, naming the event, for a
/// damaged payload.
ComputingTime computing_time(const Store& store, const std::string& id, double last_cycle);

struct ManifestText : events::ManifestRegistered {
  std::string registered_at;  ///< UTC
};

/// A registered manifest; nothing when the store has none. Throws StoreDamaged when the stored text
/// has another SHA-256.
std::optional<ManifestText> find_manifest(const Store& store, const std::string& sha256);

}  // namespace shearcell
