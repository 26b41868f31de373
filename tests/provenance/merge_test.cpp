// SPDX-License-Identifier: GPL-3.0-or-later
// Merging is a union of several stores: nothing is lost, repeated or mixed up.
#include "provenance/store.hpp"

#include <gtest/gtest.h>

#include <set>

#include "provenance/projections.hpp"
#include "tests/provenance/lineage_samples.hpp"

namespace shearcell {
namespace {

namespace fs = std::filesystem;
using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

class MergeTest : public ::testing::Test {
 protected:
  fs::path path(const std::string& name) const { return folder_.path() / name; }
  Store open(const std::string& name) const { return Store(path(name), Access::create); }

  /// Brings the run from its newest checkpoint to cycle `to` of `target`, and completes it there.
  static void advance(Store& store, int run, std::uint64_t to, std::uint64_t target) {
    const std::string id = run_id(run);
    store.declare_stage(sample_run(run, target));
    const auto known = store.checkpoints(id);
    std::uint64_t cycle = 0;
    if (known.empty()) {
      store.start_stage(id, {});
      store.record_checkpoint(id, sample_checkpoint(id, 0));
    } else {
      cycle = static_cast<std::uint64_t>(known.back().cycle);
      store.start_stage(id, {}, known.back().sha256);
    }
    while (cycle < to) store.record_checkpoint(id, sample_checkpoint(id, ++cycle * kCycle), {1, 2});
    if (to == target) {
      store.complete_stage(id, {}, target);
    } else {
      store.interrupt_stage(id, "SIGTERM");
    }
  }

  struct Part {
    int run;
    std::uint64_t to, target;
  };
  /// A store that was computed so far and closed.
  void computed(const std::string& name, const std::vector<Part>& parts) const {
    Store store = open(name);
    for (const Part& part : parts) advance(store, part.run, part.to, part.target);
  }

  void copy(const std::string& from, const std::string& to) const {
    fs::copy(path(from), path(to), fs::copy_options::recursive);
  }

  /// Every row of the tables, without the facts of when, by whom and in how many attempts it was
  /// computed: seq and ordinals, times, attempts, efforts.
  std::map<std::string, std::set<std::vector<std::string>>> facts(const std::string& name) const {
    const sqlite::Database database(path(name) / "store.sqlite", Access::write);
    std::map<std::string, std::set<std::vector<std::string>>> found;
    for (const std::string rows :
         {"runs id, parent, kind, resolved, state, grains, target_cycles, cycle, step, state_hash, "
          "error",
          "memberships run, experiment, scale, variant, seed, manifest, labels, target_cycles, "
          "checkpoint_every",
          "checkpoints run, sha256, step, cycle, time_s, file, size, state_hash, observables, "
          "state",
          "figures name, provenance"}) {
      const std::string table = rows.substr(0, rows.find(' '));
      sqlite::Statement query(database, "SELECT " + rows.substr(table.size()) + " FROM " + table);
      while (query.step()) found[table].insert(query.cells());
    }
    return found;
  }

  TemporaryFolder folder_;
};

// Run 0 is shared by all, run 1 by the first two, run 2 is the third one's own. The stores got to
// different cycles of them, and the third one's target is longer.
TEST_F(MergeTest, ThreeOverlappingStoresEqualOneCompleteStore) {
  const std::string manifest = "a: 1\n";
  {
    Store a = open("a");
    a.register_manifest(manifest, "a.yaml", {{"n", 1}});
    advance(a, 0, 3, 3);
    advance(a, 1, 2, 4);
    a.record("figure/S2", {"FigureGenerated", {{"inputs", "of a"}}});
  }
  {
    Store b = open("b");
    b.register_manifest(manifest, "b.yaml", {{"n", 1}});
    advance(b, 0, 1, 3);
    advance(b, 1, 4, 4);
  }
  {
    Store c = open("c");
    c.register_manifest("c: 1\n", "c.yaml", {{"n", 3}});
    advance(c, 0, 4, 5);
    advance(c, 2, 2, 2);
    c.record("figure/S2", {"FigureGenerated", {{"inputs", "of c"}}});  // the later one
  }
  {
    Store whole = open("whole");
    whole.register_manifest(manifest, "a.yaml", {{"n", 1}});
    whole.register_manifest("c: 1\n", "c.yaml", {{"n", 3}});
    advance(whole, 0, 3, 3);
    advance(whole, 1, 4, 4);
    advance(whole, 0, 4, 5);
    advance(whole, 2, 2, 2);
    whole.record("figure/S2", {"FigureGenerated", {{"inputs", "of c"}}});
  }
  const auto expected = facts("whole");
  ASSERT_EQ(expected.at("runs").size(), 3u);
  ASSERT_EQ(expected.at("checkpoints").size(), 5u + 5u + 3u);
  std::vector<std::string> order = {"a", "b", "c"};
  do {  // until the first of these conditions
    const std::string name = "merged-" + order[0] + order[1] + order[2];
    SCOPED_TRACE(name);
    Store merged = open(name);
    const auto reports = merged.merge({path(order[0]), path(order[1]), path(order[2])});
    EXPECT_EQ(facts(name), expected);
    EXPECT_EQ(merged.events("store/merge").size(), 3u);
    std::uint64_t copied = 0;
    for (const MergeReport& report : reports) copied += report.checkpoints;
    EXPECT_EQ(copied, 13u);
    const VerifyReport verified = merged.verify();
    EXPECT_TRUE(verified.ok());
    EXPECT_TRUE(verified.findings.empty());
    merged.rebuild();
    EXPECT_EQ(facts(name), expected);

    const Head head = merged.head();
    for (const MergeReport& report : merged.merge({path("a"), path("b"), path("c")})) {
      EXPECT_EQ(report.events + report.checkpoints, 0u);
    }
    EXPECT_EQ(merged.head().hash, head.hash) << "merging again recorded something";
  } while (std::next_permutation(order.begin(), order.end()));
  // Also through another merge.
  Store some = open("some");
  some.merge({path("c"), path("a")});
  Store rest = open("rest");
  rest.merge({path("b"), path("some")});
  EXPECT_EQ(facts("rest"), expected);
}

TEST_F(MergeTest, IntoOneOfTheSourcesAndBack) {
  computed("a", {{0, 3, 3}});
  copy("a", "b");  // a common past
  Store a = open("a");
  Store b = open("b");
  advance(a, 0, 4, 6);
  advance(b, 0, 6, 6);
  advance(b, 1, 1, 1);
  a.merge({path("b")});
  EXPECT_EQ(a.stage(run_id(0)).state, StageState::completed);
  EXPECT_EQ(a.stage(run_id(0)).cycle, 6);
  b.merge({path("a")});
  EXPECT_EQ(facts("a"), facts("b"));
  EXPECT_TRUE(a.verify().ok());
  EXPECT_TRUE(b.verify().ok());
  // One effort for each checkpoint: each was counted once.
  EXPECT_EQ(a.stage(run_id(0)).wall_seconds, 6);
}

// An older attempt with states of its own must not make a completed run unfinished.
TEST_F(MergeTest, TheFurthestStateWins) {
  computed("a", {{0, 3, 3}});
  {
    Store b = open("b");
    const std::string id = run_id(0);
    b.declare_stage(sample_run(0, 3));
    b.start_stage(id, {});
    b.record_checkpoint(id, sample_checkpoint(id, kCycle / 2));  // interrupted within a cycle
    b.interrupt_stage(id, "SIGTERM");
  }
  for (const auto& [into, from] : {std::pair("a", "b"), std::pair("b", "a")}) {
    const std::string name = std::string(into) + "-and-" + from;
    copy(into, name);
    Store store = open(name);
    const MergeReport report = store.merge({path(from)}).at(0);
    EXPECT_EQ(report.events, report.head.seq - 1) << "all but the declaration; " << name;
    const Stage run = store.stage(run_id(0));
    EXPECT_EQ(run.state, StageState::completed) << name;
    EXPECT_EQ(run.cycle, 3) << name;
    EXPECT_EQ(run.error, "") << name;
    EXPECT_EQ(store.checkpoints(run.id).size(), 5u) << name;
    EXPECT_TRUE(store.verify().ok()) << name;
  }
}

TEST_F(MergeTest, RejectsDifferentStatesByNameAndChangesNothing) {
  const std::string id = run_id(0);
  computed("a", {{0, 1, 3}});
  computed("c", {{1, 1, 1}});
  {
    Store b = open("b");
    b.declare_stage(sample_run(0, 3));
    b.start_stage(id, {});
    Checkpoint other = sample_checkpoint(id, kCycle);
    other.state.velocity(0, 0) += 1e-12;
    b.record_checkpoint(id, other);
  }
  Store a = open("a");
  const Head head = a.head();
  for (const auto& sources : {std::vector{path("b")}, std::vector{path("c"), path("b")}}) {
    expect_refused<StoreDamaged>([&] { a.merge(sources); },
                                 {id, "step 45600", path("a"), path("b")});
  }
  Store fresh = open("fresh");  // the two sources disagree with each other
  EXPECT_THROW(fresh.merge({path("a"), path("b")}), StoreDamaged);
  EXPECT_EQ(fresh.head().seq, 0u);
  EXPECT_EQ(a.head().hash, head.hash);
  EXPECT_EQ(a.verify().orphans, 0u);
}

TEST_F(MergeTest, RejectsDamagedSources) {
  computed("b", {{0, 2, 2}});
  Store a = open("a");
  const auto record = open("b").checkpoints(run_id(0)).at(1);
  copy("b", "cut");
  fs::resize_file(path("cut") / record.file, 1000);
  expect_refused<StoreDamaged>([&] { a.merge({path("b"), path("cut")}); }, {record.file});
  copy("b", "forged");
  sqlite::Database(path("forged") / "store.sqlite", Access::write)
      .execute(
          "DROP TRIGGER events_are_never_updated; UPDATE events SET type = 'RunFailed' WHERE "
          "type = 'RunCompleted'");
  expect_refused<StoreDamaged>([&] { a.merge({path("forged")}); }, {"forged: event 6"});
  EXPECT_EQ(a.head().seq, 0u);
  EXPECT_EQ(a.verify().orphans, 0u);
  EXPECT_THROW(a.merge({path("a")}), NotFound);
  EXPECT_THROW(a.merge({path("nowhere")}), NotFound);
}

TEST_F(MergeTest, NamesTheSourceWhoseEventsDoNotFit) {
  computed("b", {{0, 2, 2}});
  const Event recorded = open("b").events("run/" + run_id(0), "CheckpointRecorded").at(0);
  copy("b", "orphan");
  append_to_run(open("orphan"), run_id(3), {recorded.type, recorded.body()});
  Store a = open("a");
  expect_refused<StoreDamaged>([&] { a.merge({path("orphan")}); }, {"orphan: event 7 (Checkpoint"});
  EXPECT_EQ(a.head().seq, 0u);
  EXPECT_EQ(a.verify().orphans, 0u);
  // An event of a later version, whose members may mean something else.
  copy("b", "later");
  append_to_run(open("later"), run_id(0), {"CheckpointMoved", {{"sha256", 3}}});
  EXPECT_EQ(a.merge({path("later")}).at(0).events, 7u);
}

TEST_F(MergeTest, NeitherWaitsForNorStopsOtherPrograms) {
  computed("b", {{0, 2, 2}});
  Store a = open("a");
  Store runner = open("a");
  runner.declare_stage(sample_run(0, 2));
  runner.start_stage(run_id(0), {});
  EXPECT_THROW(a.merge({path("b")}), MachineError);
  runner.interrupt_stage(run_id(0), "done");
  EXPECT_EQ(a.merge({path("b")}).at(0).checkpoints, 3u);
}

TEST_F(MergeTest, RepairsDamageAndKeepsPrunedCheckpointsPruned) {
  Store a = open("a");
  advance(a, 0, 3, 3);
  copy("a", "b");
  Store fresh = open("fresh");
  const auto records = a.checkpoints(run_id(0));
  a.prune({records[1]});
  fs::remove(path("a") / records[2].file);
  fresh.merge({path("b")});
  a.merge({path("fresh")});
  EXPECT_FALSE(fs::exists(path("a") / records[1].file)) << "it was pruned on purpose";
  // The record of a pruned checkpoint comes without its file.
  Store other = open("other");
  fs::copy(path("b") / records[2].file, path("a") / records[2].file);
  other.merge({path("a")});
  EXPECT_EQ(other.checkpoints(run_id(0), Listed::all).size(), 4u);
  EXPECT_EQ(other.checkpoints(run_id(0)).size(), 3u);
  EXPECT_TRUE(other.verify().ok());
}

TEST_F(MergeTest, OfABackupRestoresRejectedFiles) {
  computed("a", {{0, 3, 3}});
  copy("a", "backup");
  Store a = open("a");
  const std::string id = run_id(0);
  fs::resize_file(path("a") / a.checkpoints(id).back().file, 1000);
  std::vector<std::string> damage;
  a.newest_valid_checkpoint(id, &damage);
  ASSERT_EQ(damage.size(), 1u);
  ASSERT_EQ(a.stage(id).cycle, 2);
  EXPECT_EQ(a.merge({path("backup")}).at(0).checkpoints, 1u);
  EXPECT_EQ(a.stage(id).cycle, 3);
  EXPECT_EQ(a.newest_valid_checkpoint(id)->record.cycle, 3);
  EXPECT_TRUE(a.verify().findings.empty());
  EXPECT_EQ(a.merge({path("backup")}).at(0).checkpoints, 0u);
}

TEST_F(MergeTest, ReadsAStoreOfTheFirstSchema) {
  Store a = open("a");
  a.merge({fs::path(SHEARCELL_TEST_DATA) / "store_v1"});
  EXPECT_EQ(a.stages().size(), 2u);
  EXPECT_EQ(a.events().size(), 16u);
  EXPECT_EQ(a.events().at(4).schema, 1u);
  EXPECT_TRUE(a.verify().ok());
}

}  // namespace
}  // namespace shearcell
