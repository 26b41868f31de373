// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/queries.hpp"

#include <fmt/format.h>

#include "provenance/json_text.hpp"
#include "provenance/limits.hpp"

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

template <class State>
State state_of(const Database& database, const std::string& name) {
  if (const auto state = value_of<State>(name)) return *state;
  throw StoreDamaged(fmt::format("{}: a derived table has the unknown state '{}'; run `rebuild`",
                                 database.name(), name));
}

std::vector<Membership> query_memberships(const Database& database, const std::string& run) {
  Statement query(database,
                  "SELECT experiment, scale, variant, labels, seed, manifest, target_cycles, "
                  "checkpoint_every FROM memberships WHERE run = ? ORDER BY ordinal",
                  run);
  std::vector<Membership> found;
  while (query.step()) {
    Membership& m = found.emplace_back();
    std::string labels;
    query.get(m.experiment, m.scale, m.variant, labels, m.seed, m.manifest, m.target_cycles,
              m.checkpoint_every);
    m.labels = parse(database, labels);
    require_cycles(m.target_cycles, m.checkpoint_every);
  }
  return found;
}

/// Checkpoints in ascending order of step; `rest` follows FROM.
template <class... Values>
std::vector<CheckpointRecord> select_checkpoints(const Database& database, const std::string& rest,
                                                 const Values&... values) {
  Statement query(database,
                  "SELECT run, step, cycle, time_s, file, size, sha256, state_hash, seq, "
                  "observables, state FROM checkpoints " +
                      rest,
                  values...);
  std::vector<CheckpointRecord> found;
  while (query.step()) {
    CheckpointRecord& record = found.emplace_back();
    std::string observables, state;
    query.get(record.run, record.step, record.cycle, record.time_s, record.file, record.size,
              record.sha256, record.state_hash, record.seq, observables, state);
    record.state = state_of<CheckpointState>(database, state);
    const json values_by_name = parse(database, observables);
    for (const auto& [name, value] : values_by_name.items()) {
      if (value.is_number()) record.observables[name] = value.template get<double>();
    }
  }
  return found;
}

constexpr const char* kByStep = "ORDER BY step, seq";

}  // namespace

NotFound unknown_run(std::string_view id) {
  return NotFound(fmt::format("the store has no run '{}'; `shearcell status` lists its runs", id));
}

NotFound unknown_checkpoint(std::string_view run, std::string_view sha256) {
  return NotFound(fmt::format("run {}: it has no checkpoint {}", run, sha256));
}

std::string run_stream(std::string_view id) {
  return fmt::format("run/{}", id);
}

void require_cycles(std::uint64_t target_cycles, std::uint64_t checkpoint_every) {
  const auto require = [](const char* name, std::uint64_t value, std::uint64_t low) {
    if (value >= low && value <= StoreLimits::cycles) return;
    throw StoreDamaged(
        fmt::format("the record of a run has {} = {}, outside {} to {}; run "
                    "`verify`, and restore the store from a backup",
                    name, value, low, StoreLimits::cycles));
  };
  require("target_cycles", target_cycles, 0);
  require("checkpoint_every", checkpoint_every, 1);
}

std::vector<RunRecord> query_runs(const Database& database, std::string_view id) {
  Statement query(database,
                  fmt::format("SELECT id, parent, kind, grains, target_cycles, attempts, cycle, "
                              "step, state_hash, wall_seconds, particle_steps, error, updated_at, "
                              "resolved, state FROM runs {} ORDER BY ordinal",
                              id.empty() ? "" : "WHERE id = ?"));
  if (!id.empty()) query.bind(1, id);
  std::vector<RunRecord> found;
  while (query.step()) {
    RunRecord& run = found.emplace_back();
    std::string resolved, state;
    query.get(run.id, run.parent, run.kind, run.grains, run.target_cycles, run.attempts, run.cycle,
              run.step, run.state_hash, run.wall_seconds, run.particle_steps, run.error,
              run.updated_at, resolved, state);
    run.resolved = parse(database, resolved);
    require_cycles(run.target_cycles, 1);
    run.state = state_of<RunState>(database, state);
    run.memberships = query_memberships(database, run.id);
  }
  return found;
}

std::vector<std::string> query_run_ids(const Database& database, std::string_view prefix,
                                       std::size_t limit) {
  Statement query(database,
                  "SELECT id FROM runs WHERE substr(id, 1, length(?1)) = ?1 ORDER BY id LIMIT ?2",
                  prefix, std::uint64_t{limit});
  std::vector<std::string> found;
  while (query.step()) found.push_back(query.text(0));
  return found;
}

std::vector<CheckpointRecord> query_checkpoints(const Database& database, std::string_view run) {
  if (run.empty()) return select_checkpoints(database, kByStep);
  return select_checkpoints(database, std::string("WHERE run = ? ") + kByStep, run);
}

std::optional<CheckpointRecord> query_checkpoint(const Database& database, std::string_view run,
                                                 std::string_view sha256) {
  auto found = select_checkpoints(database, "WHERE run = ? AND sha256 = ?", run, sha256);
  if (found.empty()) return std::nullopt;
  return std::move(found.front());
}

std::vector<CheckpointRecord> query_checkpoints_by_prefix(const Database& database,
                                                          std::string_view prefix,
                                                          std::size_t limit) {
  return select_checkpoints(
      database, std::string("WHERE substr(sha256, 1, length(?1)) = ?1 ") + kByStep + " LIMIT ?2",
      prefix, std::uint64_t{limit});
}

std::vector<FigureRecord> query_figures(const Database& database) {
  Statement query(database, "SELECT name, seq, recorded_at, provenance FROM figures ORDER BY name");
  std::vector<FigureRecord> found;
  while (query.step()) {
    FigureRecord& figure = found.emplace_back();
    std::string provenance;
    query.get(figure.name, figure.seq, figure.recorded_at, provenance);
    figure.provenance = parse(database, provenance);
  }
  return found;
}

}  // namespace shearcell
