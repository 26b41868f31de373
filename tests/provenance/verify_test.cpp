// SPDX-License-Identifier: GPL-3.0-or-later
// What verify and rebuild find and mend; the damage is done behind the store's back.
#include "provenance/verify.hpp"

#include <gtest/gtest.h>

#include "provenance/projections.hpp"
#include "tests/provenance/samples.hpp"

namespace shearcell {
namespace {

namespace fs = std::filesystem;
using test::run_id;
using test::sample_checkpoint;
using test::sample_run;

class VerifyTest : public ::testing::Test {
 protected:
  /// Two runs with three checkpoints each, one failed, one rejected checkpoint, and a figure.
  VerifyTest() {
    Store store(path_, Access::create);
    store.register_manifest("a: 1\n", "a.yaml", {});
    for (int i = 0; i < 2; ++i) {
      const std::string id = run_id(i);
      RunDeclaration declaration = sample_run(i);
      if (i == 1) declaration.parent = run_id(0);
      store.declare_run(declaration);
      store.start_run(id, {{"cpu", "test"}});
      for (std::uint64_t step = 0; step < 3; ++step) {
        records_.push_back(store.record_checkpoint(id, sample_checkpoint(id, step), {0.1, 60}));
      }
    }
    store.complete_run(run_id(0), {{"cycles", 3}});
    store.fail_run(run_id(1), "unstable");
    store.reject_checkpoint(run_id(1), records_.back().sha256, "test");
    store.declare_run(sample_run(0, 9));
    store.record_figure("S2a", {{"inputs", {records_[0].sha256}}});
  }

  VerifyReport verify() { return Store(path_, Access::read).verify(); }

  void tamper(const std::string& sql) {
    sqlite::Database(path_ / "store.sqlite", sqlite::Open::existing).execute(sql);
  }

  std::map<std::string, std::vector<std::string>> rows() {
    return projection_rows(sqlite::Database(path_ / "store.sqlite", sqlite::Open::existing));
  }

  /// The one error in the report.
  Finding error_of(const VerifyReport& report) {
    Finding found;
    int errors = 0;
    for (const Finding& finding : report.findings) {
      if (finding.severity != Finding::Severity::error) continue;
      if (++errors == 1) found = finding;
    }
    EXPECT_EQ(errors, 1);
    return found;
  }

  test::Folder folder_;
  fs::path path_ = folder_.path() / "store";
  std::vector<CheckpointRecord> records_;
};

TEST_F(VerifyTest, FindsNothingInASoundStore) {
  const VerifyReport report = verify();
  EXPECT_TRUE(report.findings.empty());
  EXPECT_EQ(report.events, 16u);
  EXPECT_EQ(report.checkpoints, 6u);
  EXPECT_EQ(report.head.seq, 16u);
}

TEST_F(VerifyTest, RebuildGivesTheSameTables) {
  const auto before = rows();
  EXPECT_EQ(before.at("runs").size(), 2u);
  EXPECT_EQ(before.at("memberships").size(), 2u);
  EXPECT_EQ(before.at("checkpoints").size(), 6u);
  EXPECT_EQ(before.at("figures").size(), 1u);
  Store(path_, Access::write).rebuild();
  EXPECT_EQ(rows(), before);
}

TEST_F(VerifyTest, RebuildMendsWhatVerifyFindsInTheTables) {
  const auto before = rows();
  tamper("UPDATE runs SET state = 'completed' WHERE state = 'failed'");
  const Finding finding = error_of(verify());
  EXPECT_EQ(finding.subject, "table runs");
  EXPECT_NE(finding.message.find("rebuild"), std::string::npos);
  tamper("DELETE FROM figures; DELETE FROM checkpoints");
  EXPECT_FALSE(verify().ok());
  Store(path_, Access::write).rebuild();
  EXPECT_TRUE(verify().ok());
  EXPECT_EQ(rows(), before);
}

TEST_F(VerifyTest, NamesAChangedEvent) {
  tamper(
      "DROP TRIGGER events_are_never_updated;"
      "UPDATE events SET payload = replace(payload, 'unstable', 'stable') "
      "WHERE type = 'RunFailed'");
  const VerifyReport report = verify();
  EXPECT_FALSE(report.ok());
  EXPECT_EQ(report.findings.at(0).subject, "event 13");
  EXPECT_EQ(report.checkpoints, 6u);  // the rest is still examined
}

TEST_F(VerifyTest, SurvivesAnEventThatMakesNoSense) {
  for (const std::string payload : {"not json", "[]", "{}", "{\"sha256\":7}"}) {
    tamper(
        "DROP TRIGGER IF EXISTS events_are_never_updated;"
        "UPDATE events SET payload = '" +
        payload + "' WHERE type = 'CheckpointRecorded' AND stream = 'run/" + run_id(0) + "'");
    const VerifyReport report = verify();
    EXPECT_FALSE(report.ok());
    EXPECT_EQ(report.checkpoints, 3u) << "the other run's";
  }
}

TEST_F(VerifyTest, NamesADamagedObjectAndItsRun) {
  const std::string file = records_[1].file;
  std::string bytes = test::read_bytes(path_ / file);
  bytes[bytes.size() / 2] ^= 1;
  test::write_bytes(path_ / file, bytes);
  const VerifyReport report = verify();
  EXPECT_EQ(error_of(report).subject, file);
  EXPECT_EQ(error_of(report).run, run_id(0));
  EXPECT_EQ(report.checkpoints, 5u);
}

TEST_F(VerifyTest, TheLossOfARejectedObjectIsNoError) {
  fs::remove(path_ / records_.back().file);
  const VerifyReport report = verify();
  EXPECT_TRUE(report.ok());
  EXPECT_EQ(report.findings.size(), 1u);
}

TEST_F(VerifyTest, NamesOrphans) {
  ObjectStore objects(path_);
  const std::string text = "written before a crash, never recorded";
  const ObjectInfo orphan = objects.put(std::as_bytes(std::span(text)));
  const VerifyReport report = verify();
  EXPECT_TRUE(report.ok());
  EXPECT_EQ(report.orphans, 1u);
  ASSERT_EQ(report.findings.size(), 1u);
  EXPECT_EQ(report.findings[0].subject, orphan.file);
}

TEST_F(VerifyTest, NotesAStepThatWasReproducedDifferently) {
  {
    Store store(path_, Access::write);
    store.start_run(run_id(1), {}, records_[4].sha256);
    Checkpoint other = sample_checkpoint(run_id(1), 1);
    other.state.position(0, 0) += 1e-16;
    other.state.position(0, 1) += 1;
    store.record_checkpoint(run_id(1), other);
  }
  const VerifyReport report = verify();
  EXPECT_TRUE(report.ok());
  ASSERT_EQ(report.findings.size(), 1u);
  EXPECT_NE(report.findings[0].message.find("different states at step 1"), std::string::npos);
}

TEST_F(VerifyTest, SurvivesADamagedDatabasePage) {
  std::string bytes = test::read_bytes(path_ / "store.sqlite");
  for (std::size_t page = 2; page * 4096 < bytes.size(); ++page) {
    SCOPED_TRACE(page);
    std::string bad = bytes;
    for (std::size_t i = 0; i < 200; ++i) bad[page * 4096 + i] = '\x5a';
    test::write_bytes(path_ / "store.sqlite", bad);
    bool found = false;
    try {
      found = !verify().ok();
    } catch (const StoreDamaged&) {
      found = true;
    }
    EXPECT_TRUE(found);
  }
}

}  // namespace
}  // namespace shearcell
