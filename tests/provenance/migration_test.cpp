// SPDX-License-Identifier: GPL-3.0-or-later
// A store of schema 1, as the first program wrote it, opens, migrates and verifies.
#include <gtest/gtest.h>

#include "provenance/events.hpp"
#include "provenance/json_text.hpp"
#include "provenance/projections.hpp"
#include "tests/provenance/samples.hpp"

namespace shearcell {
namespace {

namespace fs = std::filesystem;

// Printed by the program that wrote it; see tests/data/store_v1/README.md.
constexpr const char* kHead = "65f80af869fde3002a7de4d3cf7376c4fdb49de6523dfc78cdf827a1924e3e66";
constexpr const char* kSheared = "a61190aacbadf7a5f4f7ca8babc7607320644ed281a483fd2c845db08c2563b0";
constexpr const char* kLastState =
    "d7dbfa231195ea8d5af40cd93ffadc3a09bb084aedc8a84156ef5162c7ba96d1";

class MigrationTest : public ::testing::Test {
 protected:
  MigrationTest() {
    fs::copy(fs::path(SHEARCELL_TEST_DATA) / "store_v1", path_, fs::copy_options::recursive);
    for (const auto& entry : fs::recursive_directory_iterator(path_)) {
      fs::permissions(entry, fs::perms::owner_write, fs::perm_options::add);
    }
  }

  sqlite::Database database() const { return {path_ / "store.sqlite", Access::write}; }
  void execute(const std::string& sql) const { database().execute(sql); }
  std::int64_t integer(const std::string& sql) const { return database().integer(sql); }
  std::int64_t version() { return integer("PRAGMA user_version"); }

  TemporaryFolder folder_;
  fs::path path_ = folder_.path() / "store";
};

void expect_what_was_stored(const Store& store) {
  EXPECT_EQ(store.head().seq, 15u);
  EXPECT_EQ(store.head().hash, kHead);
  const Stage run = store.stage(kSheared);
  EXPECT_EQ(run.state, StageState::completed);
  EXPECT_EQ(run.cycle, 2);
  EXPECT_EQ(run.attempts, 2u);
  EXPECT_EQ(run.state_hash, kLastState);
  EXPECT_EQ(state_hash(store.load_checkpoint(store.checkpoints(kSheared).back())), kLastState);
  const VerifyReport report = store.verify(Head{15, kHead});
  EXPECT_TRUE(report.ok());
  EXPECT_TRUE(report.findings.empty());
  EXPECT_EQ(report.checkpoints, 4u);
}

TEST_F(MigrationTest, AReaderKeepsTheOldSchema) {
  ASSERT_EQ(version(), 1);
  const std::string before = test::read_bytes(path_ / "store.sqlite");
  const Store store(path_, Access::read);
  expect_what_was_stored(store);
  EXPECT_TRUE(store.leases().empty());
  EXPECT_EQ(test::read_bytes(path_ / "store.sqlite"), before);
}

TEST_F(MigrationTest, AWriterMigratesAndChangesNoEvent) {
  expect_what_was_stored(Store(path_, Access::write));
  EXPECT_EQ(version(), kSchemaVersion);
  EXPECT_EQ(integer("SELECT count(*) FROM leases"), 0);
  expect_what_was_stored(Store(path_, Access::write));  // once is enough
}

TEST_F(MigrationTest, RebuildGivesTheOldTables) {
  const auto rows = [](const sqlite::Database& of, const std::string& columns) {
    sqlite::Statement query(of, "SELECT " + columns + " ORDER BY 1");
    return query.all([](const sqlite::Statement& row) { return row.cells(); });
  };
  const std::vector<std::string> old_columns = {
      "id, ordinal, parent, kind, resolved, state, grains, target_cycles, attempts, cycle, step, "
      "state_hash, wall_seconds, particle_steps, error, updated_at FROM runs",
      "run, experiment, scale, variant, seed, manifest, labels, target_cycles, checkpoint_every, "
      "ordinal FROM memberships",
      "* FROM checkpoints", "* FROM figures"};
  std::vector<TableRows> before;
  for (const std::string& columns : old_columns) before.push_back(rows(database(), columns));
  // In memory, by the migration and by `rebuild`.
  const auto read = projection_rows(open_database(path_ / "store.sqlite", Access::read));
  { const Store migrated(path_, Access::write); }
  EXPECT_EQ(projection_rows(database()), read);
  Store(path_, Access::write).rebuild();
  EXPECT_EQ(projection_rows(database()), read);
  for (std::size_t k = 0; k < old_columns.size(); ++k) {
    EXPECT_EQ(rows(database(), old_columns[k]), before[k]) << old_columns[k];
  }
}

TEST_F(MigrationTest, TheColumnsOfSchema3AreThoseOfTheOldEvents) {
  for (const Access access : {Access::read, Access::write}) {
    const Store store(path_, access);
    for (const Stage& run : store.stages()) {
      const auto ends = store.events("run/" + run.id, "RunCompleted");
      ASSERT_EQ(run.ends.size(), ends.size());
      for (std::size_t k = 0; k < ends.size(); ++k) {
        EXPECT_EQ(run.ends[k], member_of(ends[k].body().at("summary"), "ended"));
      }
      ASSERT_EQ(run.memberships.size(), 1u);
      const auto& [place, ask, newest] = run.memberships[0];
      EXPECT_TRUE(ask.until.is_null());
      EXPECT_TRUE(ask.checkpoint_phases.empty());
      EXPECT_TRUE(newest);
      EXPECT_EQ(store.events("manifest/" + place.manifest).size(), 1u);
    }
  }
}

TEST_F(MigrationTest, AMigratedStoreCanBeContinued) {
  Store store(path_, Access::write);
  Stage run = store.stage(kSheared);
  run.memberships.at(0).ask.target_cycles = 3;
  store.declare_stage(run);
  store.start_stage(run.id, {}, store.checkpoints(run.id).back().sha256);
  EXPECT_EQ(store.events("run/" + run.id).back().schema, 2u);
  store.complete_stage(run.id, {}, 3);
  EXPECT_TRUE(store.verify(Head{15, kHead}).ok());
}

TEST_F(MigrationTest, AnInterruptedMigrationKeepsTheOldVersion) {
  execute("CREATE TABLE leases(in_the_way)");  // so that the migration fails
  EXPECT_THROW(Store(path_, Access::write), StoreDamaged);
  EXPECT_EQ(version(), 1);
  execute("DROP TABLE leases");
  expect_what_was_stored(Store(path_, Access::write));
  EXPECT_EQ(version(), kSchemaVersion);
}

// Derived tables are rebuilt without a check of their contents. Any other table is refused.
TEST_F(MigrationTest, OldDerivedTablesAreNotRead) {
  using Pair = std::pair<std::string, std::string>;
  for (const auto& [other, rest] :
       {Pair{"TRIGGER t", " AFTER INSERT ON events BEGIN DELETE FROM runs; END"},
        {"TABLE t", "(a)"},
        {"VIEW manifests", " AS SELECT 1"}}) {
    execute("CREATE " + other + rest);
    for (const Access access : {Access::read, Access::write}) {
      EXPECT_THROW(Store(path_, access), StoreDamaged) << other;
    }
    execute("DROP " + other);
  }
  execute(
      "DROP TABLE figures; CREATE TABLE figures(x INTEGER CHECK (x IS NOT randomblob(1)), y AS (2 "
      "* "
      "x) STORED); INSERT INTO figures(x) VALUES (1); CREATE TABLE newest(a)");
  EXPECT_EQ(version(), 1);
  expect_what_was_stored(Store(path_, Access::read));
  expect_what_was_stored(Store(path_, Access::write));
  EXPECT_EQ(version(), kSchemaVersion);
}

TEST_F(MigrationTest, OldEventsAreReadInTheirNewLayout) {
  const Store store(path_, Access::read);
  int started = 0, completed = 0;
  for (const Event& event : store.events()) {
    EXPECT_EQ(event.schema, 1u);
    EXPECT_EQ(event_hash(event), event.hash);
    const nlohmann::json body = event.body();
    if (event.type == "RunStarted") {
      ++started;
      EXPECT_TRUE(body.at("process").is_null());
      EXPECT_TRUE(body.at("parent_checkpoint").is_null());
      EXPECT_EQ(body.at("host").at("host"), "example");
      EXPECT_EQ(event.payload.find("process"), std::string::npos) << "it was rewritten";
    }
    if (event.type == "RunCompleted") {
      ++completed;
      EXPECT_TRUE(body.at("target_cycles").is_null());
    }
  }
  EXPECT_EQ(started, 2);
  EXPECT_EQ(completed, 3);
}

TEST_F(MigrationTest, NewerPayloadsAreRejectedByName) {
  EXPECT_EQ(events::newest_schema("RunStarted"), 2u);
  EXPECT_EQ(events::newest_schema("CheckpointRecorded"), 1u);
  Event event;
  event.seq = 7;
  event.type = "RunStarted";
  event.schema = 3;
  event.payload = "{}";
  test::expect_refused<StoreDamaged>([&] { event.body(); }, {"event 7 (RunStarted)", "layout 3"});
}

}  // namespace
}  // namespace shearcell
