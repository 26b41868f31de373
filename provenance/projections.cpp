// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/projections.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "provenance/events.hpp"
#include "provenance/json_text.hpp"
#include "provenance/limits.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {

// `registered` is the seq of the last registration. `newest` has one row for each experiment and
// scale: the last registered manifest that declared a run of this experiment at this scale.
const char* const projection_tables = R"sql(
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
  updated_at TEXT NOT NULL,
  ends TEXT NOT NULL DEFAULT '[]'
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
  until TEXT NOT NULL,
  checkpoint_phases TEXT NOT NULL,
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
CREATE TABLE manifests(
  sha256 TEXT PRIMARY KEY,
  registered_at TEXT NOT NULL,
  registered INTEGER NOT NULL
) STRICT;
CREATE TABLE newest(
  experiment TEXT NOT NULL,
  scale TEXT NOT NULL,
  manifest TEXT NOT NULL,
  PRIMARY KEY (experiment, scale)
) STRICT;
)sql";

namespace {

using nlohmann::json;
using sqlite::Database;
using sqlite::Statement;

/// Throws StoreDamaged when the target or the checkpoint interval of a run is outside the limits.
/// Larger values could make step counts overflow.
void require_cycles(std::uint64_t target_cycles, std::uint64_t checkpoint_every) {
  const auto require = [](const char* name, std::uint64_t value, std::uint64_t low) {
    if (value >= low && value <= StoreLimits::cycles) return;
    throw StoreDamaged(fmt::format(
        "the record of a run has {} = {}, outside the range {} to {}; run `verify`, and "
        "restore the store from a backup",
        name, value, low, StoreLimits::cycles));
  };
  require("target_cycles", target_cycles, 0);
  require("checkpoint_every", checkpoint_every, 1);
}

/// Applies one event to the tables.
class Projector {
 public:
  Projector(Database& database, const Event& event)
      : database_(database), event_(event), id_(event.stream.substr(event.stream.find('/') + 1)) {}

  void operator()(const events::RunDeclared& e) const {
    const Stage& d = e.stage;
    const auto& [place, ask, newest] = e.membership;
    if (!is_sha256_hex(id_)) {
      throw StoreDamaged(
          fmt::format("event {} ({} of {:.64}): the id of the run is not a SHA-256; "
                      "run `verify`, and restore the store from a backup",
                      event_.seq, event_.type, event_.stream));
    }
    require_cycles(ask.target_cycles, ask.checkpoint_every);
    // A completed run becomes `declared` again if the new target exceeds the old target. If `until`
    // ended the run before the old target, the run's last cycle is used instead of the old target.
    run("INSERT INTO runs(id, ordinal, parent, kind, resolved, state, grains, target_cycles, "
        "updated_at) VALUES(?,?,NULLIF(?,''),?,?,'declared',?,?,?) ON CONFLICT(id) DO UPDATE SET "
        "state = iif(state = 'completed' AND min(target_cycles, cycle) < excluded.target_cycles, "
        "'declared', state), target_cycles = max(target_cycles, excluded.target_cycles)",
        id_, event_.seq, d.parent, d.kind, d.resolved.dump(), d.grains, ask.target_cycles,
        event_.recorded_at);
    // A repeated declaration keeps `ordinal` if it raises the target or changes the checkpoint
    // interval. Otherwise it makes the run the last one declared for its place (holds_place()).
    run("INSERT INTO memberships VALUES(?,?,?,?,?,?,?,?,?,?,?,?) ON CONFLICT DO UPDATE SET "
        "ordinal = iif(excluded.target_cycles <= target_cycles AND excluded.checkpoint_every = "
        "checkpoint_every, excluded.ordinal, ordinal), "
        "target_cycles = max(target_cycles, excluded.target_cycles), "
        "checkpoint_every = excluded.checkpoint_every, until = excluded.until, "
        "checkpoint_phases = excluded.checkpoint_phases",
        id_, place.experiment, place.scale, place.variant, place.seed, place.manifest,
        place.swept.dump(), ask.target_cycles, ask.checkpoint_every, event_.seq, ask.until.dump(),
        json(ask.checkpoint_phases).dump());
    if (d.kind != "prepare") show_newest(place.experiment, place.scale, place.manifest);
  }

  /// If the manifest was registered before, keeps the later of the two registration times.
  void register_manifest() const {
    run("INSERT INTO manifests VALUES(?,?,?) ON CONFLICT DO UPDATE SET "
        "registered_at = excluded.registered_at, registered = excluded.registered "
        "WHERE excluded.registered_at >= registered_at",
        id_, event_.recorded_at, event_.seq);
    Statement places(database_,
                     "SELECT DISTINCT experiment, scale FROM memberships JOIN runs ON run = id "
                     "WHERE manifest = ? AND kind <> 'prepare'",
                     id_);
    const auto place = [](const Statement& row) { return std::pair(row.text(0), row.text(1)); };
    for (const auto& [experiment, scale] : places.all(place)) {
      show_newest(experiment, scale, id_);
    }
  }

  void operator()(const events::RunStarted&) const { begin_attempt(); }
  void operator()(const events::RunResumed&) const { begin_attempt(); }
  void operator()(const events::RunInterrupted& e) const { set_state("interrupted", e.why); }
  void operator()(const events::RunFailed& e) const { set_state("failed", e.why); }

  void operator()(const events::RunCompleted& e) const {
    const json ended = member_of(e.summary, "ended"), asked = member_of(ended, "memberships");
    // The run is not complete if its target was raised during the computation. A run can also end
    // early, when `until` is fulfilled. Such a run is not complete if another experiment requested
    // it during the computation, because that experiment may need more cycles.
    run("UPDATE runs SET error = '', ends = json_insert(ends, '$[#]', json(?2)), state = "
        "iif(target_cycles > ?3 OR ?4 < (SELECT count(*) FROM memberships WHERE run = ?1), "
        "'declared', 'completed') WHERE id = ?1",
        id_, ended.dump(), e.target_cycles.value_or(INT64_MAX),
        asked.is_number_unsigned() ? asked.get<std::uint64_t>() : std::uint64_t{INT64_MAX});
  }

  void operator()(const events::CheckpointRecorded& e) const {
    const CheckpointRecord& c = e.checkpoint;
    run("INSERT INTO checkpoints VALUES(?,?,?,?,?,?,?,?,?,'recorded',?) ON CONFLICT DO UPDATE "
        "SET state = 'recorded', seq = excluded.seq",
        id_, c.sha256, c.step, c.cycle, c.time_s, c.file, c.size, c.state_hash,
        json(c.observables).dump(), event_.seq);
    run("UPDATE runs SET wall_seconds = wall_seconds + ?2, particle_steps = particle_steps + ?3 "
        "WHERE id = ?1",
        id_, e.effort.wall_seconds, e.effort.particle_steps);
    move_to_furthest_from(c.sha256);
  }

  void operator()(const events::CheckpointRejected& e) const {
    // A completed run whose last checkpoint is rejected must be continued.
    run("UPDATE runs SET state = 'declared' WHERE id = ?1 AND state = 'completed' AND "
        "step = (SELECT step FROM checkpoints WHERE run = ?1 AND sha256 = ?2)",
        id_, e.sha256);
    mark_checkpoint(e.sha256, "rejected");
    move_to_furthest_from(e.sha256);
  }

  void operator()(const events::CheckpointPruned& e) const {
    mark_checkpoint(e.checkpoint.sha256, "pruned");
  }
  void operator()(const events::CheckpointRegenerated& e) const {
    mark_checkpoint(e.checkpoint.sha256, "recorded");
    move_to_furthest_from(e.checkpoint.sha256);
  }

  void record_figure() const {
    run("INSERT INTO figures VALUES(?,?,?,?) ON CONFLICT DO UPDATE SET seq = excluded.seq, "
        "recorded_at = excluded.recorded_at, provenance = excluded.provenance",
        id_, event_.seq, event_.recorded_at, event_.body().dump());
  }

  void operator()(const auto&) const {}  // other events change no table

 private:
  template <class... Values>
  void run(std::string_view sql, const Values&... values) const {
    Statement(database_, sql, values...).run();
  }

  void begin_attempt() const {
    run("UPDATE runs SET state = 'running', error = '', attempts = attempts + 1 WHERE id = ?", id_);
  }

  /// Records `manifest` as the newest manifest of this experiment and scale, unless the
  /// manifest recorded so far was registered later than `manifest`.
  void show_newest(const std::string& experiment, const std::string& scale,
                   const std::string& manifest) const {
    run("INSERT INTO newest VALUES(?1, ?2, ?3) ON CONFLICT DO UPDATE SET manifest = ?3 WHERE "
        "coalesce((SELECT (registered_at, registered) >= (SELECT registered_at, registered FROM "
        "manifests WHERE sha256 = newest.manifest) FROM manifests WHERE sha256 = ?3), "
        "NOT EXISTS (SELECT 1 FROM manifests WHERE sha256 = newest.manifest))",
        experiment, scale, manifest);
  }

  void set_state(std::string_view state, const std::string& error) const {
    run("UPDATE runs SET state = ?2, error = ?3 WHERE id = ?1", id_, state, error);
  }

  void mark_checkpoint(const std::string& sha256, std::string_view state) const {
    run("UPDATE checkpoints SET state = ?3 WHERE run = ?1 AND sha256 = ?2", id_, sha256, state);
  }

  /// Called after checkpoint `sha256` was recorded, rejected or regenerated. Copies cycle, step and
  /// state hash from the last recorded checkpoint of the run to the run. Does nothing if the run
  /// has already reached a later step than that of checkpoint `sha256`. The checkpoint at the later
  /// step may have been pruned, and the run must not be set back.
  void move_to_furthest_from(const std::string& sha256) const {
    run("UPDATE runs SET (cycle, step, state_hash) = (SELECT coalesce(max(cycle), 0), "
        "coalesce(max(step), 0), coalesce(max(state_hash), '') FROM (SELECT * FROM checkpoints "
        "WHERE run = ?1 AND state = 'recorded' ORDER BY step DESC, seq DESC LIMIT 1)) "
        "WHERE id = ?1 AND step <= (SELECT step FROM checkpoints WHERE run = ?1 AND sha256 = ?2)",
        id_, sha256);
  }

  Database& database_;
  const Event& event_;
  std::string id_;
};

StoreDamaged damaged_table(const Database& database, const std::string& why) {
  return StoreDamaged(fmt::format("{}: a derived table {}; run `rebuild`", database.name(), why));
}

/// Parses JSON text from a table column. Throws StoreDamaged if the text is not valid.
template <class T>
T parse(const Database& database, const std::string& text) {
  try {
    const json value = parse_json(text);
    if (!value.is_discarded()) return value.get<T>();
  } catch (const json::exception&) {
  }
  throw damaged_table(database, "holds broken JSON");
}

template <class State>
State state_of(const Database& database, const std::string& name) {
  if (const auto state = value_of<State>(name)) return *state;
  throw damaged_table(database, "has the unknown state '" + name + "'");
}

std::vector<Membership> query_memberships(const Database& database, const std::string& id) {
  Statement query(database,
                  "SELECT memberships.*, newest.manifest IS memberships.manifest FROM memberships "
                  "LEFT JOIN newest USING (experiment, scale) WHERE run = ? ORDER BY ordinal",
                  id);
  return query.all([&](const Statement& row) {
    Membership m;
    auto& [place, ask, is_newest] = m;
    std::string run, labels, until, phases;
    std::uint64_t newest = 0;
    row.get(run, place.experiment, place.scale, place.variant, place.seed, place.manifest, labels,
            ask.target_cycles, ask.checkpoint_every, ask.ordinal, until, phases, newest);
    place.swept = parse<json>(database, labels);
    ask.until = parse<json>(database, until);
    ask.checkpoint_phases = parse<std::vector<double>>(database, phases);
    is_newest = newest != 0;
    require_cycles(ask.target_cycles, ask.checkpoint_every);
    return m;
  });
}

/// `rest` is the part of the query after the name of the table.
template <class... Values>
std::vector<Stage> select_runs(const Database& database, const std::string& rest,
                               const Values&... values) {
  Statement query(database, "SELECT * FROM runs " + rest, values...);
  return query.all([&](const Statement& row) {
    Stage stage;
    std::uint64_t ordinal = 0;
    std::string resolved, state, ends;
    row.get(stage.id, ordinal, stage.parent, stage.kind, resolved, state, stage.grains,
            stage.target_cycles, stage.attempts, stage.cycle, stage.step, stage.state_hash,
            stage.wall_seconds, stage.particle_steps, stage.error, stage.updated_at, ends);
    stage.ends = parse<json::array_t>(database, ends);
    stage.resolved = parse<json>(database, resolved);
    require_cycles(stage.target_cycles, 1);
    stage.state = state_of<StageState>(database, state);
    stage.memberships = query_memberships(database, stage.id);
    return stage;
  });
}

template <class... Values>
std::vector<CheckpointRecord> select_checkpoints(const Database& database, const std::string& rest,
                                                 const Values&... values) {
  Statement query(database, "SELECT * FROM checkpoints " + rest, values...);
  return query.all([&](const Statement& row) {
    CheckpointRecord c;
    std::string observables, state;
    row.get(c.run, c.sha256, c.step, c.cycle, c.time_s, c.file, c.size, c.state_hash, observables,
            state, c.seq);
    c.state = state_of<CheckpointState>(database, state);
    c.observables = parse<std::map<std::string, double>>(database, observables);
    return c;
  });
}

/// The result of a query that finds at most one record.
template <class Record>
std::optional<Record> only(std::vector<Record> found) {
  if (found.empty()) return std::nullopt;
  return std::make_optional(std::move(found.front()));
}

}  // namespace

Database empty_projections(const std::string& name) {
  Database tables = Database::in_memory(name);
  tables.execute("PRAGMA foreign_keys=ON");
  tables.execute(projection_tables);
  return tables;
}

void apply(Database& database, const Event& event) {
  const Projector projector(database, event);
  if (event.stream.starts_with("manifest/")) return projector.register_manifest();
  if (event.stream.starts_with("figure/") && event.type == events::kFigureGenerated) {
    return projector.record_figure();
  }
  const auto run = run_of(event);
  if (!run) return;
  std::visit(projector, events::decode(event));
  Statement(database, "UPDATE runs SET updated_at = ? WHERE id = ?", event.recorded_at, *run).run();
}

std::string try_apply(Database& database, const Event& event) {
  try {
    apply(database, event);
    const events::Any decoded = events::decode(event);
    const events::TextRegistered* text = std::get_if<events::ManifestRegistered>(&decoded);
    if (text == nullptr) text = std::get_if<events::PackingRegistered>(&decoded);
    if (text != nullptr && (text->sha256 != sha256_hex(text->text) ||
                            event.stream.substr(event.stream.find('/') + 1) != text->sha256)) {
      return "the SHA-256 of the registered text differs from the recorded one";
    }
    return event.recorded_at.empty() ? "it does not say when it was recorded" : "";
  } catch (const StoreDamaged& damage) {
    return damage.what();
  } catch (const json::exception& problem) {
    return problem.what();
  }
}

void derive_projections(Database& database, const EventLog& log,
                        const sqlite::WriteTransaction& /*lock*/) {
  for (auto table = projected_tables.rbegin(); table != projected_tables.rend(); ++table) {
    database.execute(fmt::format("DROP TABLE IF EXISTS {}", *table));
  }
  database.execute(projection_tables);
  log.for_each([&database](const Event& event) { apply(database, event); });
}

void require_complete(const Database& database, const EventLog& log) {
  // An event adds a row with the event's `seq`, or changes an earlier row that has the same key.
  constexpr std::string_view lost = R"sql(
SELECT stream FROM events WHERE
  type = 'CheckpointRecorded' AND seq NOT IN (SELECT seq FROM checkpoints) AND NOT EXISTS (
    SELECT 1 FROM checkpoints WHERE run = substr(stream, 5)
    AND sha256 = json_extract(payload, '$.sha256'))
  OR type = 'RunDeclared' AND seq NOT IN (SELECT ordinal FROM memberships) AND NOT EXISTS (
    SELECT 1 FROM memberships WHERE run = substr(stream, 5)
    AND json_array(experiment, scale, variant, manifest)
      = json_extract(payload, '$.membership.experiment', '$.membership.scale',
                     '$.membership.variant', '$.membership.manifest'))
UNION ALL SELECT stream FROM events WHERE version = 1
  AND substr(stream, 1, instr(stream, '/')) IN ('run/', 'figure/', 'manifest/')
  AND substr(stream, instr(stream, '/') + 1) NOT IN (
    SELECT id FROM runs UNION ALL SELECT name FROM figures UNION ALL SELECT sha256 FROM manifests)
UNION ALL SELECT 'run/' || run FROM memberships JOIN runs ON run = id
  WHERE kind <> 'prepare' AND (experiment, scale) NOT IN (SELECT experiment, scale FROM newest)
LIMIT 1)sql";
  Statement old(database, "SELECT 1 FROM pragma_user_version WHERE user_version < ?",
                std::uint64_t{kSchemaVersion});
  if (old.step()) return;
  const std::uint64_t newest = log.head().seq;
  const auto fault = log.verify_chain(std::max<std::uint64_t>(newest, 1));
  Statement count(database, "SELECT count(*) FROM events");
  if (fault || (count.step() && count.u64(0) != newest)) {
    throw StoreDamaged(fmt::format("{}: {}; run `verify`", database.name(),
                                   fault ? fault->message : "events are missing in the log"));
  }
  Statement stream(database, lost);
  if (stream.step()) throw damaged_table(database, "lacks a row of " + stream.text(0));
}

void shadow_projections(Database& database, const EventLog& log) {
  std::string tables = projection_tables;
  for (std::size_t at = 0; (at = tables.find("CREATE TABLE", at)) != tables.npos; at += 12) {
    tables.replace(at, 12, "CREATE TEMP TABLE");
  }
  database.execute("PRAGMA temp_store=MEMORY");
  database.execute(tables.replace(tables.find("INDEX "), 6, "INDEX temp."));
  log.for_each([&database](const Event& event) { try_apply(database, event); });
}

std::map<std::string, TableRows> projection_rows(const Database& database) {
  std::map<std::string, TableRows> tables;
  for (const std::string_view table : projected_tables) {
    TableRows& rows = tables[std::string(table)];
    Statement query(database, fmt::format("SELECT * FROM {}", table));
    while (query.step()) rows.push_back(query.cells());
    std::sort(rows.begin(), rows.end());
  }
  return tables;
}

bool adds_something(const std::optional<Stage>& known, const Membership& wanted) {
  return !known || std::ranges::none_of(known->memberships, [&](const Membership& old) {
    return old.place == wanted.place && old.ask.checkpoint_every == wanted.ask.checkpoint_every &&
           old.ask.target_cycles >= wanted.ask.target_cycles;
  });
}

bool holds_place(const Database& database, std::string_view run, const Place& place) {
  Statement last(database,
                 "SELECT run FROM memberships AS m JOIN runs ON run = id WHERE m.seed = ? AND "
                 "variant = ? AND manifest = ? AND scale = ? AND experiment = ? AND "
                 "kind <> 'prepare' ORDER BY m.ordinal DESC LIMIT 1",
                 place.seed, place.variant, place.manifest, place.scale, place.experiment);
  return !last.step() || last.text(0) == run;
}

std::vector<Stage> query_stages(const Database& database, std::string_view prefix) {
  return select_runs(database, "WHERE substr(id, 1, length(?1)) = ?1 ORDER BY ordinal", prefix);
}

std::optional<Stage> query_stage(const Database& database, std::string_view id) {
  return only(select_runs(database, "WHERE id = ?", id));
}

std::vector<CheckpointRecord> query_all_checkpoints(const Database& database,
                                                    std::string_view prefix) {
  return select_checkpoints(database, "WHERE substr(sha256, 1, length(?1)) = ?1 ORDER BY step, seq",
                            prefix);
}

std::vector<CheckpointRecord> query_checkpoints(const Database& database, std::string_view run) {
  return select_checkpoints(database, "WHERE run = ? ORDER BY step, seq", run);
}

std::optional<CheckpointRecord> query_checkpoint(const Database& database, std::string_view run,
                                                 std::string_view sha256) {
  return only(select_checkpoints(database, "WHERE run = ? AND sha256 = ?", run, sha256));
}

bool is_pruned_now(const Database& database, const CheckpointRecord& record) try {
  const auto now = query_checkpoint(database, record.run, record.sha256);
  return now && now->state == CheckpointState::pruned;
} catch (const StoreDamaged&) {
  return false;
}

std::vector<FigureRecord> query_figures(const Database& database) {
  Statement query(database, "SELECT name, seq, recorded_at, provenance FROM figures ORDER BY name");
  return query.all([&](const Statement& row) {
    FigureRecord figure;
    std::string provenance;
    row.get(figure.name, figure.seq, figure.recorded_at, provenance);
    figure.provenance = parse<json>(database, provenance);
    return figure;
  });
}

}  // namespace shearcell
