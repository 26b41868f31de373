// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/queries.hpp"

#include <fmt/format.h>

#include "provenance/json_text.hpp"

namespace shearcell {

namespace {

using nlohmann::json;
using sqlite::Database;
using sqlite::Statement;

json parse(const Database& database, const std::string& text) {
  json value = parse_json(text);
  if (value.is_discarded()) {
    throw StoreDamaged(
        fmt::format("{}: a derived table holds broken JSON; run `rebuild`", database.name()));
  }
  return value;
}

RunState state_of(const Database& database, const std::string& text) {
  for (const RunState state : {RunState::declared, RunState::running, RunState::interrupted,
                               RunState::failed, RunState::completed}) {
    if (text == name_of(state)) return state;
  }
  throw StoreDamaged(
      fmt::format("{}: a run has the unknown state '{}'; run `rebuild`", database.name(), text));
}

CheckpointState checkpoint_state_of(const Database& database, const std::string& text) {
  for (const CheckpointState state :
       {CheckpointState::recorded, CheckpointState::rejected, CheckpointState::pruned}) {
    if (text == name_of(state)) return state;
  }
  throw StoreDamaged(fmt::format("{}: a checkpoint has the unknown state '{}'; run `rebuild`",
                                 database.name(), text));
}

std::vector<Membership> query_memberships(const Database& database, const std::string& run) {
  Statement query(database,
                  "SELECT experiment, scale, variant, labels, seed, manifest, target_cycles, "
                  "checkpoint_every FROM memberships WHERE run = ? ORDER BY ordinal");
  query.bind(1, run);
  std::vector<Membership> found;
  while (query.step()) {
    found.push_back({.experiment = query.text(0),
                     .scale = query.text(1),
                     .variant = query.text(2),
                     .labels = parse(database, query.text(3)),
                     .seed = query.u64(4),
                     .manifest = query.text(5),
                     .checkpoint_every = query.u64(7),
                     .target_cycles = query.u64(6)});
  }
  return found;
}

std::string checkpoint_columns(std::string_view where) {
  return fmt::format(
      "SELECT run, step, cycle, time_s, file, size, sha256, state_hash, observables, state, seq "
      "FROM checkpoints {} ORDER BY step, seq",
      where);
}

CheckpointRecord read_checkpoint(const Database& database, const Statement& row) {
  CheckpointRecord record{.run = row.text(0),
                          .step = row.u64(1),
                          .cycle = row.f64(2),
                          .time_s = row.f64(3),
                          .file = row.text(4),
                          .size = row.u64(5),
                          .sha256 = row.text(6),
                          .state_hash = row.text(7),
                          .observables = {},
                          .state = checkpoint_state_of(database, row.text(9)),
                          .seq = row.u64(10)};
  const json observables = parse(database, row.text(8));
  for (const auto& [name, value] : observables.items()) {
    if (value.is_number()) record.observables[name] = value.get<double>();
  }
  return record;
}

}  // namespace

NotFound unknown_run(std::string_view id) {
  return NotFound(
      fmt::format("the store has no run '{}'; `shearcell status` lists the runs it has", id));
}

const char* name_of(RunState state) {
  switch (state) {
    case RunState::declared:
      return "declared";
    case RunState::running:
      return "running";
    case RunState::interrupted:
      return "interrupted";
    case RunState::failed:
      return "failed";
    case RunState::completed:
      return "completed";
  }
  return "unknown";
}

const char* name_of(CheckpointState state) {
  switch (state) {
    case CheckpointState::recorded:
      return "recorded";
    case CheckpointState::rejected:
      return "rejected";
    case CheckpointState::pruned:
      return "pruned";
  }
  return "unknown";
}

std::vector<RunRecord> query_runs(const Database& database, std::string_view id) {
  Statement query(database,
                  fmt::format("SELECT id, parent, kind, resolved, state, grains, target_cycles, "
                              "attempts, cycle, step, state_hash, wall_seconds, particle_steps, "
                              "error, updated_at FROM runs {} ORDER BY ordinal",
                              id.empty() ? "" : "WHERE id = ?"));
  if (!id.empty()) query.bind(1, id);
  std::vector<RunRecord> found;
  while (query.step()) {
    RunRecord run;
    run.id = query.text(0);
    run.parent = query.text(1);
    run.kind = query.text(2);
    run.resolved = parse(database, query.text(3));
    run.state = state_of(database, query.text(4));
    run.grains = query.u64(5);
    run.target_cycles = query.u64(6);
    run.attempts = query.u64(7);
    run.cycle = query.f64(8);
    run.step = query.u64(9);
    run.state_hash = query.text(10);
    run.wall_seconds = query.f64(11);
    run.particle_steps = query.f64(12);
    run.error = query.text(13);
    run.updated_at = query.text(14);
    run.memberships = query_memberships(database, run.id);
    found.push_back(std::move(run));
  }
  return found;
}

std::vector<std::string> query_run_ids(const Database& database, std::string_view prefix,
                                       std::size_t limit) {
  Statement query(database,
                  "SELECT id FROM runs WHERE substr(id, 1, length(?1)) = ?1 ORDER BY id LIMIT ?2");
  query.bind(1, prefix).bind(2, std::uint64_t{limit});
  std::vector<std::string> found;
  while (query.step()) found.push_back(query.text(0));
  return found;
}

std::vector<CheckpointRecord> query_checkpoints(const Database& database, std::string_view run) {
  Statement query(database, checkpoint_columns(run.empty() ? "" : "WHERE run = ?"));
  if (!run.empty()) query.bind(1, run);
  std::vector<CheckpointRecord> found;
  while (query.step()) found.push_back(read_checkpoint(database, query));
  return found;
}

std::optional<CheckpointRecord> query_checkpoint(const Database& database, std::string_view run,
                                                 std::string_view sha256) {
  Statement query(database, checkpoint_columns("WHERE run = ? AND sha256 = ?"));
  query.bind(1, run).bind(2, sha256);
  if (!query.step()) return std::nullopt;
  return read_checkpoint(database, query);
}

std::vector<CheckpointRecord> query_checkpoints_by_prefix(const Database& database,
                                                          std::string_view prefix,
                                                          std::size_t limit) {
  Statement query(database,
                  checkpoint_columns("WHERE substr(sha256, 1, length(?1)) = ?1") + " LIMIT ?2");
  query.bind(1, prefix).bind(2, std::uint64_t{limit});
  std::vector<CheckpointRecord> found;
  while (query.step()) found.push_back(read_checkpoint(database, query));
  return found;
}

std::vector<FigureRecord> query_figures(const Database& database) {
  Statement query(database, "SELECT name, seq, recorded_at, provenance FROM figures ORDER BY name");
  std::vector<FigureRecord> found;
  while (query.step()) {
    found.push_back({.name = query.text(0),
                     .seq = query.u64(1),
                     .recorded_at = query.text(2),
                     .provenance = parse(database, query.text(3))});
  }
  return found;
}

}  // namespace shearcell
