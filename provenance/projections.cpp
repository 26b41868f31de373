// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/projections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {

namespace {

using nlohmann::json;
using sqlite::Database;
using sqlite::Statement;

constexpr const char* kTables = R"sql(
CREATE TABLE runs(
  id TEXT PRIMARY KEY,
  ordinal INTEGER NOT NULL UNIQUE,
  parent TEXT REFERENCES runs(id),
  kind TEXT NOT NULL,
  resolved TEXT NOT NULL,
  state TEXT NOT NULL,
  grains INTEGER NOT NULL,
  target_cycles INTEGER NOT NULL,
  attempts INTEGER NOT NULL DEFAULT 0,
  cycle REAL NOT NULL DEFAULT 0,
  step INTEGER NOT NULL DEFAULT 0,
  state_hash TEXT NOT NULL DEFAULT '',
  wall_seconds REAL NOT NULL DEFAULT 0,
  particle_steps REAL NOT NULL DEFAULT 0,
  error TEXT NOT NULL DEFAULT '',
  updated_at TEXT NOT NULL
) STRICT;
CREATE TABLE memberships(
  run TEXT NOT NULL REFERENCES runs(id),
  experiment TEXT NOT NULL,
  scale TEXT NOT NULL,
  variant TEXT NOT NULL,
  seed INTEGER NOT NULL,
  manifest TEXT NOT NULL,
  labels TEXT NOT NULL,
  target_cycles INTEGER NOT NULL,
  checkpoint_every INTEGER NOT NULL,
  ordinal INTEGER NOT NULL,
  PRIMARY KEY (run, experiment, scale, variant, seed, manifest)
) STRICT;
CREATE TABLE checkpoints(
  run TEXT NOT NULL REFERENCES runs(id),
  sha256 TEXT NOT NULL,
  step INTEGER NOT NULL,
  cycle REAL NOT NULL,
  time_s REAL NOT NULL,
  file TEXT NOT NULL,
  size INTEGER NOT NULL,
  state_hash TEXT NOT NULL,
  observables TEXT NOT NULL,
  state TEXT NOT NULL,
  seq INTEGER NOT NULL,
  PRIMARY KEY (run, sha256)
) STRICT;
CREATE INDEX checkpoints_by_step ON checkpoints(run, step);
CREATE TABLE figures(
  name TEXT PRIMARY KEY,
  seq INTEGER NOT NULL,
  recorded_at TEXT NOT NULL,
  provenance TEXT NOT NULL
) STRICT;
)sql";

constexpr std::array<std::string_view, 4> kTableNames = {"runs", "memberships", "checkpoints",
                                                         "figures"};

std::string after_slash(const std::string& stream) {
  return stream.substr(stream.find('/') + 1);
}

void declare_run(Database& database, const Event& event, const json& body) {
  const std::string id = after_slash(event.stream);
  const auto target = count_at(body, "target_cycles");
  // An upsert would also count as an insert of a second ordinal, so the two cases are apart.
  Statement known(database, "SELECT 1 FROM runs WHERE id = ?");
  if (known.bind(1, id).step()) {
    Statement grow(database,
                   // The run may also have ended early, as other experiments asked for.
                   "UPDATE runs SET state = CASE WHEN state = 'completed' AND (target_cycles < ?2 "
                   "OR (step > 0 AND cycle < ?2)) "
                   "THEN 'declared' ELSE state END, target_cycles = max(target_cycles, ?2) "
                   "WHERE id = ?1");
    grow.bind(1, id).bind(2, target).run();
  } else {
    Statement insert(database,
                     "INSERT INTO runs(id, ordinal, parent, kind, resolved, state, grains, "
                     "target_cycles, updated_at) VALUES(?,?,?,?,?,'declared',?,?,?)");
    insert.bind(1, id).bind(2, event.seq);
    insert.bind_or_null(3, body.at("parent").get_ref<const std::string&>());
    insert.bind(4, body.at("kind").get_ref<const std::string&>());
    insert.bind(5, body.at("resolved").dump()).bind(6, count_at(body, "grains"));
    insert.bind(7, target).bind(8, event.recorded_at).run();
  }
  const json& membership = body.at("membership");
  Statement member(database,
                   "INSERT INTO memberships(run, experiment, scale, variant, seed, manifest, "
                   "labels, target_cycles, checkpoint_every, ordinal) VALUES(?,?,?,?,?,?,?,?,?,?) "
                   "ON CONFLICT DO UPDATE SET target_cycles = max(target_cycles, "
                   "excluded.target_cycles), checkpoint_every = excluded.checkpoint_every");
  member.bind(1, id);
  member.bind(2, membership.at("experiment").get_ref<const std::string&>());
  member.bind(3, membership.at("scale").get_ref<const std::string&>());
  member.bind(4, membership.at("variant").get_ref<const std::string&>());
  member.bind(5, count_at(membership, "seed"));
  member.bind(6, membership.at("manifest").get_ref<const std::string&>());
  member.bind(7, membership.at("labels").dump()).bind(8, target);
  member.bind(9, count_at(membership, "checkpoint_every")).bind(10, event.seq).run();
}

void set_state(Database& database, const Event& event, std::string_view state,
               const std::string& error, std::uint64_t new_attempts) {
  Statement update(
      database, "UPDATE runs SET state = ?2, error = ?3, attempts = attempts + ?4 WHERE id = ?1");
  update.bind(1, after_slash(event.stream)).bind(2, state).bind(3, error);
  update.bind(4, new_attempts).run();
}

/// A target that was raised, or an early end (`until`) that did not consider every experiment of
/// the run, leaves work to do.
void complete_run(Database& database, const Event& event, const json& body) {
  const json& reached = body.at("target_cycles");
  const json asked = body.value("/summary/ended/memberships"_json_pointer, json());
  Statement update(database,
                   "UPDATE runs SET error = '', state = CASE WHEN (?2 AND target_cycles > ?3) OR "
                   "?4 < (SELECT count(*) FROM memberships WHERE run = ?1) THEN "
                   "'declared' ELSE 'completed' END WHERE id = ?1");
  update.bind(4,
              asked.is_number_unsigned() ? asked.get<std::uint64_t>() : std::uint64_t{INT64_MAX});
  update.bind(1, after_slash(event.stream)).bind(2, std::uint64_t{!reached.is_null()});
  update.bind(3, reached.is_null() ? 0 : count_at(body, "target_cycles")).run();
}

void move_to_furthest_checkpoint(Database& database, const std::string& run) {
  Statement update(database,
                   "UPDATE runs SET (cycle, step, state_hash) = (SELECT coalesce(max(cycle), 0), "
                   "coalesce(max(step), 0), coalesce(max(state_hash), '') FROM (SELECT * FROM "
                   "checkpoints WHERE run = ?1 AND state = 'recorded' ORDER BY step DESC, seq DESC "
                   "LIMIT 1)) WHERE id = ?1");
  update.bind(1, run).run();
}

void record_checkpoint(Database& database, const Event& event, const json& body) {
  const std::string run = after_slash(event.stream);
  Statement insert(database,
                   "INSERT INTO checkpoints(run, sha256, step, cycle, time_s, file, size, "
                   "state_hash, observables, state, seq) VALUES(?,?,?,?,?,?,?,?,?,'recorded',?) "
                   "ON CONFLICT DO UPDATE SET state = 'recorded', seq = excluded.seq");
  insert.bind(1, run).bind(2, body.at("sha256").get_ref<const std::string&>());
  insert.bind(3, count_at(body, "step")).bind(4, body.at("cycle").get<double>());
  insert.bind(5, body.at("time_s").get<double>());
  insert.bind(6, body.at("file").get_ref<const std::string&>());
  insert.bind(7, count_at(body, "size"));
  insert.bind(8, body.at("state_hash").get_ref<const std::string&>());
  insert.bind(9, body.at("observables").dump()).bind(10, event.seq).run();
  Statement effort(database,
                   "UPDATE runs SET wall_seconds = wall_seconds + ?2, particle_steps = "
                   "particle_steps + ?3 WHERE id = ?1");
  effort.bind(1, run).bind(2, body.at("wall_seconds").get<double>());
  effort.bind(3, body.at("particle_steps").get<double>()).run();
  move_to_furthest_checkpoint(database, run);
}

void reject_checkpoint(Database& database, const Event& event, const json& body) {
  const std::string run = after_slash(event.stream);
  // A completed run that loses its last state has work left.
  Statement reopen(database,
                   "UPDATE runs SET state = 'declared' WHERE id = ?1 AND state = 'completed' AND "
                   "step = (SELECT step FROM checkpoints WHERE run = ?1 AND sha256 = ?2)");
  reopen.bind(1, run).bind(2, body.at("sha256").get_ref<const std::string&>()).run();
  Statement update(database,
                   "UPDATE checkpoints SET state = 'rejected' WHERE run = ? AND sha256 = ?");
  update.bind(1, run).bind(2, body.at("sha256").get_ref<const std::string&>()).run();
  move_to_furthest_checkpoint(database, run);
}

void move_checkpoint(Database& database, const Event& event, const json& body,
                     std::string_view state) {
  const std::string run = after_slash(event.stream);
  Statement update(database, "UPDATE checkpoints SET state = ?3 WHERE run = ?1 AND sha256 = ?2");
  update.bind(1, run).bind(2, body.at("sha256").get_ref<const std::string&>());
  update.bind(3, state).run();
  move_to_furthest_checkpoint(database, run);
}

void record_figure(Database& database, const Event& event, const json& body) {
  // The one that was made last; a merge brings in older ones after it.
  Statement insert(database,
                   "INSERT INTO figures VALUES(?,?,?,?) ON CONFLICT DO UPDATE SET seq = "
                   "excluded.seq, recorded_at = excluded.recorded_at, provenance = "
                   "excluded.provenance WHERE excluded.recorded_at >= figures.recorded_at");
  insert.bind(1, after_slash(event.stream)).bind(2, event.seq).bind(3, event.recorded_at);
  insert.bind(4, body.dump()).run();
}

void apply_to_run(Database& database, const Event& event, const json& body) {
  if (event.type == "RunDeclared") declare_run(database, event, body);
  if (event.type == "RunStarted") set_state(database, event, "running", "", 1);
  if (event.type == "RunResumed") set_state(database, event, "running", "", 1);
  if (event.type == "CheckpointRecorded") record_checkpoint(database, event, body);
  if (event.type == "CheckpointRejected") reject_checkpoint(database, event, body);
  if (event.type == "CheckpointPruned") move_checkpoint(database, event, body, "pruned");
  if (event.type == "CheckpointRegenerated") move_checkpoint(database, event, body, "recorded");
  if (event.type == "RunInterrupted") {
    set_state(database, event, "interrupted", body.at("why").get<std::string>(), 0);
  }
  if (event.type == "RunFailed") {
    set_state(database, event, "failed", body.at("why").get<std::string>(), 0);
  }
  if (event.type == "RunCompleted") complete_run(database, event, body);
  Statement touch(database, "UPDATE runs SET updated_at = ?2 WHERE id = ?1");
  touch.bind(1, after_slash(event.stream)).bind(2, event.recorded_at).run();
}

}  // namespace

void create_projections(Database& database) {
  database.execute(kTables);
}

void apply(Database& database, const Event& event) {
  try {
    if (event.stream.starts_with("run/")) apply_to_run(database, event, event.body());
    if (event.stream.starts_with("figure/")) record_figure(database, event, event.body());
  } catch (const json::exception& problem) {
    throw damaged_payload(event, problem);
  }
}

void rebuild_projections(Database& database, const EventLog& log) {
  sqlite::WriteTransaction lock(database);
  for (auto table = kTableNames.rbegin(); table != kTableNames.rend(); ++table) {
    database.execute(fmt::format("DROP TABLE IF EXISTS {}", *table));
  }
  create_projections(database);
  log.for_each([&database](const Event& event) { apply(database, event); });
  lock.commit();
}

std::map<std::string, std::vector<std::string>> projection_rows(const Database& database) {
  std::map<std::string, std::vector<std::string>> tables;
  for (const std::string_view table : kTableNames) {
    std::vector<std::string>& rows = tables[std::string(table)];
    Statement query(database, fmt::format("SELECT * FROM {}", table));
    while (query.step()) {
      std::string row;
      for (int column = 0; column < query.columns(); ++column) {
        row += (column == 0 ? "" : ", ") + query.literal(column);
      }
      rows.push_back(std::move(row));
    }
    std::sort(rows.begin(), rows.end());
  }
  return tables;
}

}  // namespace shearcell
