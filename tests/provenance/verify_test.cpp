// SPDX-License-Identifier: GPL-3.0-or-later
// Any change made without the store is found and named by `verify`; `rebuild` repairs the tables.
#include "provenance/store.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <random>

#include "provenance/projections.hpp"
#include "tests/provenance/samples.hpp"

namespace shearcell {
namespace {

namespace fs = std::filesystem;
using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

class VerifyTest : public ::testing::Test {
 protected:
  /// Two runs with three checkpoints each, one completed, one failed; a pruned and a rejected
  /// checkpoint, a replay and a figure.
  VerifyTest() {
    Store store(path_, Access::create);
    store.register_manifest("a: 1\n", "a.yaml", {{"experiment", "a"}});
    for (int i = 0; i < 2; ++i) {
      const std::string id = run_id(i);
      Stage declaration = sample_run(i);
      if (i == 1) declaration.parent = run_id(0);
      store.declare_stage(declaration);
      store.start_stage(id, {{"cpu", "test"}});
      for (std::uint64_t step = 0; step < 3; ++step) {
        records_.push_back(store.record_checkpoint(id, sample_checkpoint(id, step), {0.1, 60}));
      }
    }
    store.complete_stage(run_id(0), {{"cycles", 3}});
    store.fail_stage(run_id(1), "unstable");
    store.reject_checkpoint(run_id(1), records_.back().sha256, "test");
    store.prune({records_[0]});
    store.record(run_stream(run_id(0)), {"ReplayVerified", {{"step", 2}}});
    store.declare_stage(sample_run(0, 9));
    store.record("figure/S2a", {"FigureGenerated", {{"inputs", {records_[2].sha256}}}});
    head_ = store.head();
    events_ = store.events();
    fs::copy_file(log_, path_.parent_path() / "kept");
  }

  void execute(const std::string& sql) {  // without syncs: some thousand changes
    sqlite::Database(log_, Access::write).execute("PRAGMA synchronous=OFF;" + sql);
  }

  /// The log as it was, without the triggers that refuse changes.
  void restore_without_triggers() {
    fs::copy_file(path_.parent_path() / "kept", log_, fs::copy_options::overwrite_existing);
    execute("DROP TRIGGER events_are_never_updated; DROP TRIGGER events_are_never_deleted");
  }

  VerifyReport verify(const std::optional<Head>& against = std::nullopt) const {
    return Store(path_, Access::read).verify(against);
  }

  std::map<std::string, TableRows> rows() {
    return projection_rows(sqlite::Database(log_, Access::write));
  }

  /// Whether an error of this subject says these words.
  static bool names(const VerifyReport& report, const std::string& subject,
                    const std::string& words = "") {
    return std::ranges::any_of(report.findings, [&](const Finding& finding) {
      return finding.severity == Finding::Severity::error && finding.subject == subject &&
             finding.message.find(words) != std::string::npos;
    });
  }

  /// The one finding of the report.
  static Finding only(const VerifyReport& report) {
    EXPECT_EQ(report.findings.size(), 1u);
    return report.findings.empty() ? Finding{} : report.findings.front();
  }

  static std::string event(std::uint64_t seq) { return "event " + std::to_string(seq); }

  TemporaryFolder folder_;
  fs::path path_ = folder_.path() / "store", log_ = path_ / "store.sqlite";
  std::vector<CheckpointRecord> records_;
  std::vector<Event> events_;
  Head head_;
};

TEST_F(VerifyTest, FindsNothingInASoundStore) {
  const VerifyReport report = verify();
  EXPECT_TRUE(report.findings.empty());
  EXPECT_EQ(report.events, events_.size());
  EXPECT_EQ(report.checkpoints, 5u);
  EXPECT_EQ(report.head.seq, events_.size());
}

TEST_F(VerifyTest, RebuildRepairsTheTables) {
  const auto before = rows();
  EXPECT_EQ(before.at("runs").size(), 2u);
  EXPECT_EQ(before.at("memberships").size(), 2u);
  EXPECT_EQ(before.at("checkpoints").size(), 6u);
  EXPECT_EQ(before.at("figures").size(), 1u);
  Store(path_, Access::write).rebuild();
  EXPECT_EQ(rows(), before);
  execute("UPDATE runs SET state = 'completed' WHERE state = 'failed'");
  const Finding finding = only(verify());
  EXPECT_EQ(finding.subject, "table runs");
  EXPECT_TRUE(has(finding.message, "rebuild"));
  EXPECT_TRUE(has(finding.message,
                  run_id(1) + "') should have state = 'failed', but has state = 'completed'"));
  EXPECT_LT(finding.message.size(), 300u);
  execute("DELETE FROM memberships WHERE run = '" + run_id(1) + "'");
  EXPECT_TRUE(names(verify(), "table memberships", "') is missing;"));
  execute("DELETE FROM figures; DELETE FROM checkpoints");
  EXPECT_FALSE(verify().ok());
  Store(path_, Access::write).rebuild();
  EXPECT_TRUE(verify().ok());
  EXPECT_EQ(rows(), before);
}

TEST_F(VerifyTest, ChecksTheRestOfAStoreWithABadEvent) {
  for (const std::string payload : {"not json", "[]", "{}", "{\"sha256\":7}"}) {
    restore_without_triggers();
    execute("UPDATE events SET payload = '" + payload +
            "' WHERE type = 'CheckpointRecorded' AND stream = 'run/" + run_id(0) + "'");
    const VerifyReport report = verify();
    EXPECT_FALSE(report.ok());
    EXPECT_EQ(report.checkpoints, 3u) << "the other run's";
  }
}

TEST_F(VerifyTest, ReportsOtherFaultsBesideAForgedEndOfARun) {
  for (const std::string ended : {"[1]", "7", "{\"memberships\":[]}"}) {
    restore_without_triggers();
    execute("UPDATE events SET payload = '{\"summary\":{\"ended\":" + ended +
            "},\"target_cycles\":null}' WHERE type = 'RunCompleted'");
    const VerifyReport report = verify();
    EXPECT_TRUE(std::ranges::any_of(report.findings, [](const Finding& finding) {
      return finding.message.find("match its content") != std::string::npos;
    })) << ended;
    EXPECT_EQ(report.checkpoints, 5u);
    EXPECT_EQ(report.head.seq, events_.size());
    Store(path_, Access::write).rebuild();
  }
}

TEST_F(VerifyTest, KeepsTheFilesOfAStoreWithADamagedTable) {
  std::uint64_t page = 0, page_size = 0;
  {
    const sqlite::Database database(log_, Access::write);
    sqlite::Statement root(database, "SELECT rootpage FROM sqlite_master WHERE name = 'runs'");
    sqlite::Statement size(database, "PRAGMA page_size");
    ASSERT_TRUE(root.step() && size.step());
    page = root.u64(0);
    page_size = size.u64(0);
  }
  std::fstream file(log_, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>((page - 1) * page_size));
  file << std::string(64, '\x7f');
  file.close();
  const VerifyReport report = verify();
  EXPECT_FALSE(report.ok());
  EXPECT_EQ(report.checkpoints, 5u);
  EXPECT_EQ(report.orphans, 0u);
  EXPECT_TRUE(names(report, log_.string(), "the log is readable, so `shearcell merge`"));
}

TEST_F(VerifyTest, ReportsALinkInPlaceOfTheFolderOfAPrunedFile) {
  const fs::path object = path_ / records_[0].file;
  fs::remove_all(object.parent_path());
  fs::create_directory_symlink("/tmp", object.parent_path());
  const VerifyReport report = verify();
  EXPECT_TRUE(names(report, records_[0].file, "link"));
  EXPECT_EQ(report.events, events_.size());
}

TEST_F(VerifyTest, FindsAChangedByteOfAnyFieldOfAnyEvent) {
  restore_without_triggers();
  std::mt19937_64 random(1);
  std::size_t changes = 0;
  for (const Event& e : events_) {
    const std::vector<std::pair<std::string, std::string>> texts = {
        {"stream", e.stream},   {"type", e.type},           {"recorded_at", e.recorded_at},
        {"payload", e.payload}, {"prev_hash", e.prev_hash}, {"hash", e.hash}};
    const auto expect_found = [&](const std::string& field, const std::string& changed,
                                  const std::string& original) {
      const std::string where = " WHERE seq = " + std::to_string(e.seq);
      execute("UPDATE events SET " + field + " = " + changed + where);
      EXPECT_TRUE(names(verify(), event(e.seq), "match its content"))
          << e.type << "." << field << " = " << changed;
      execute("UPDATE events SET " + field + " = " + original + where);
      ++changes;
    };
    for (const auto& [field, text] : texts) {
      // The first byte, the last, and two between.
      for (const std::size_t at :
           {std::size_t{0}, text.size() - 1, random() % text.size(), random() % text.size()}) {
        std::string changed = text;
        changed[at] = changed[at] == '0' ? '1' : '0';
        if (changed != text) expect_found(field, sql_text(changed), sql_text(text));
      }
      expect_found(field, sql_text(text + " "), sql_text(text));
    }
    expect_found("version", std::to_string(e.version + 100), std::to_string(e.version));
    expect_found("schema", std::to_string(e.schema + 1), std::to_string(e.schema));
  }
  EXPECT_TRUE(verify().ok()) << "the changes were taken back";
  std::printf("%zu changes of %zu events, each found and named\n", changes, events_.size());
  EXPECT_GT(changes, 500u);
}

TEST_F(VerifyTest, FindsARemovedEvent) {
  for (const Event& e : events_) {
    restore_without_triggers();
    execute("DELETE FROM events WHERE seq = " + std::to_string(e.seq));
    const bool last = e.seq == events_.size();  // shown only by a head that was kept elsewhere
    EXPECT_TRUE(last ? names(verify(head_), event(e.seq))
                     : names(verify(), event(e.seq + 1), event(e.seq) + " is missing here"));
  }
}

TEST_F(VerifyTest, FindsASwappedPair) {
  for (std::size_t seq = 1; seq < events_.size(); ++seq) {
    restore_without_triggers();
    const std::string a = std::to_string(seq), b = std::to_string(seq + 1);
    execute("UPDATE events SET seq = -1 WHERE seq = " + a + "; UPDATE events SET seq = " + a +
            " WHERE seq = " + b + "; UPDATE events SET seq = " + b + " WHERE seq = -1");
    EXPECT_TRUE(names(verify(), event(seq))) << seq;
  }
}

TEST_F(VerifyTest, FindsATruncatedLogFromARecordedHead) {
  for (std::size_t kept = events_.size(); kept-- > 0;) {
    restore_without_triggers();
    execute("DELETE FROM events WHERE seq > " + std::to_string(kept));
    Store(path_, Access::write).rebuild();  // as a forger would
    EXPECT_TRUE(names(verify(head_), event(head_.seq), "cut off: it ends at " + event(kept)));
  }
}

TEST_F(VerifyTest, FindsARewrittenLogFromARecordedHead) {
  restore_without_triggers();
  // A new, valid chain from event 5 on.
  std::string prev = events_[3].hash;
  for (std::size_t i = 4; i < events_.size(); ++i) {
    Event forged = events_[i];
    if (i == 4) forged.recorded_at = "2001-01-01T00:00:00.000Z";
    forged.prev_hash = prev;
    prev = forged.hash = event_hash(forged);
    execute("UPDATE events SET recorded_at = " + sql_text(forged.recorded_at) + ", prev_hash = '" +
            forged.prev_hash + "', hash = '" + forged.hash +
            "' WHERE seq = " + std::to_string(forged.seq));
    if (i == 4) {
      EXPECT_TRUE(names(verify(), event(6), "prev_hash is not"));
    }
  }
  Store(path_, Access::write).rebuild();
  EXPECT_TRUE(verify().ok()) << "the chain itself is valid";
  EXPECT_TRUE(names(verify(head_), event(head_.seq)));
  EXPECT_TRUE(verify(Head{4, events_[3].hash}).ok()) << "nothing before event 5 was changed";
}

TEST_F(VerifyTest, FindsAChangedByteOfACheckpoint) {
  const CheckpointRecord& record = records_[4];
  const std::string bytes = read_bytes(path_ / record.file);
  std::mt19937_64 random(2);
  std::vector<std::size_t> places = {0, 511, 512, bytes.size() - 1};
  while (places.size() < 64) places.push_back(random() % bytes.size());
  for (const std::size_t at : places) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ (1 << (at % 8)));
    write_bytes(path_ / record.file, changed);
    EXPECT_TRUE(names(verify(), record.file)) << "byte " << at;
  }
  EXPECT_EQ(only(verify()).run, run_id(1));
  write_bytes(path_ / record.file, bytes + "x");
  EXPECT_TRUE(names(verify(), record.file));
  write_bytes(path_ / record.file, read_bytes(path_ / records_[3].file));
  EXPECT_TRUE(names(verify(), record.file)) << "another checkpoint in its place";
  fs::remove(path_ / record.file);
  EXPECT_TRUE(names(verify(), record.file));
}

TEST_F(VerifyTest, ReportsALostRejectedObject) {
  fs::remove(path_ / records_.back().file);
  const Finding finding = only(verify());
  EXPECT_EQ(finding.severity, Finding::Severity::note);
  EXPECT_EQ(finding.subject, records_.back().file);
  EXPECT_FALSE(has(finding.message, finding.subject)) << finding.message;
}

TEST_F(VerifyTest, NamesOrphans) {
  const std::string orphan = ObjectStore(path_).put(bytes_of("written before a crash"));
  const VerifyReport report = verify();
  EXPECT_TRUE(report.ok());
  EXPECT_EQ(report.orphans, 1u);
  EXPECT_EQ(only(report).subject, ObjectStore::file_of(orphan));
}

TEST_F(VerifyTest, ReportsAStepThatWasReproducedDifferently) {
  Store store(path_, Access::write);
  store.start_stage(run_id(1), {}, records_[4].sha256);
  Checkpoint other = sample_checkpoint(run_id(1), 1);
  other.state.position(0, 1) += 1;
  store.record_checkpoint(run_id(1), other);
  const VerifyReport report = store.verify();
  EXPECT_TRUE(report.ok());
  EXPECT_TRUE(has(only(report).message, "different states at step 1"));
}

}  // namespace
}  // namespace shearcell
