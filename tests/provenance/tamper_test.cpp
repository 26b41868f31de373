// SPDX-License-Identifier: GPL-3.0-or-later
// Whatever is changed behind the store's back, `verify` finds and names it.
#include <gtest/gtest.h>

#include <cstdio>
#include <random>

#include "tests/provenance/samples.hpp"

namespace shearcell {
namespace {

namespace fs = std::filesystem;
using test::run_id;
using test::sample_checkpoint;
using test::sample_run;

class TamperTest : public ::testing::Test {
 protected:
  TamperTest() {
    Store store(path_, Access::create);
    store.register_manifest("a: 1\n", "a.yaml", {{"experiment", "a"}});
    for (int i = 0; i < 2; ++i) {
      store.declare_run(sample_run(i));
      store.start_run(run_id(i), {{"cpu", "test"}});
      for (std::uint64_t step = 0; step < 3; ++step) {
        records_.push_back(store.record_checkpoint(run_id(i), sample_checkpoint(run_id(i), step)));
      }
    }
    store.complete_run(run_id(0));
    store.fail_run(run_id(1), "unstable");
    store.prune({records_[0]});
    store.record_replay(run_id(0), true, {{"step", 2}});
    store.record_figure("S2", {{"inputs", {records_[2].sha256}}});
    head_ = store.head();
    events_ = store.events();
  }

  void execute(const std::string& sql) {
    sqlite::Database(path_ / "store.sqlite", sqlite::Open::existing).execute(sql);
  }

  void open_the_events() {
    execute("DROP TRIGGER events_are_never_updated; DROP TRIGGER events_are_never_deleted");
  }

  VerifyReport verify(const std::optional<Head>& against = std::nullopt) const {
    return Store(path_, Access::read).verify(against);
  }

  static bool names(const VerifyReport& report, const std::string& subject) {
    return std::any_of(report.findings.begin(), report.findings.end(), [&](const Finding& finding) {
      return finding.severity == Finding::Severity::error && finding.subject == subject;
    });
  }

  test::Folder folder_;
  fs::path path_ = folder_.path() / "store";
  std::vector<CheckpointRecord> records_;
  std::vector<Event> events_;
  Head head_;
};

std::string literal_of(const std::string& text) {
  std::string text_literal = "'";
  for (const char c : text) text_literal.append(c == '\'' ? 2 : 1, c);
  text_literal.push_back('\'');
  return text_literal;
}

TEST_F(TamperTest, AChangedByteOfAnyFieldOfAnyEvent) {
  open_the_events();
  // The column's constraint on (stream, version) would refuse some changes; a forger drops it.
  std::mt19937_64 random(1);
  std::size_t changes = 0;
  for (const Event& event : events_) {
    const std::vector<std::pair<std::string, std::string>> texts = {
        {"stream", event.stream},           {"type", event.type},
        {"recorded_at", event.recorded_at}, {"payload", event.payload},
        {"prev_hash", event.prev_hash},     {"hash", event.hash}};
    const auto expect_found = [&](const std::string& field, const std::string& changed,
                                  const std::string& original) {
      const std::string where = " WHERE seq = " + std::to_string(event.seq);
      execute("UPDATE events SET " + field + " = " + changed + where);
      const VerifyReport report = verify();
      EXPECT_TRUE(names(report, "event " + std::to_string(event.seq)))
          << event.type << "." << field << " = " << changed;
      execute("UPDATE events SET " + field + " = " + original + where);
      ++changes;
    };
    for (const auto& [field, text] : texts) {
      // The first byte, the last, and two between.
      for (const std::size_t at :
           {std::size_t{0}, text.size() - 1, random() % text.size(), random() % text.size()}) {
        std::string changed = text;
        changed[at] = changed[at] == '0' ? '1' : '0';
        if (changed != text) expect_found(field, literal_of(changed), literal_of(text));
      }
      expect_found(field, literal_of(text + " "), literal_of(text));
    }
    expect_found("version", std::to_string(event.version + 100), std::to_string(event.version));
    expect_found("schema", std::to_string(event.schema + 1), std::to_string(event.schema));
  }
  EXPECT_TRUE(verify().ok()) << "the changes were taken back";
  std::printf("%zu changes of %zu events, each found and named\n", changes, events_.size());
  EXPECT_GT(changes, 500u);
}

TEST_F(TamperTest, ARemovedEvent) {
  open_the_events();
  fs::copy_file(path_ / "store.sqlite", path_ / "kept");
  for (const Event& event : events_) {
    fs::copy_file(path_ / "kept", path_ / "store.sqlite", fs::copy_options::overwrite_existing);
    execute("DELETE FROM events WHERE seq = " + std::to_string(event.seq));
    if (event.seq < events_.size()) {
      EXPECT_TRUE(names(verify(), "event " + std::to_string(event.seq + 1))) << event.seq;
    } else {
      EXPECT_TRUE(names(verify(head_), "event " + std::to_string(head_.seq)));
    }
  }
}

TEST_F(TamperTest, ASwappedPair) {
  open_the_events();
  fs::copy_file(path_ / "store.sqlite", path_ / "kept");
  for (std::size_t seq = 1; seq < events_.size(); ++seq) {
    fs::copy_file(path_ / "kept", path_ / "store.sqlite", fs::copy_options::overwrite_existing);
    const std::string a = std::to_string(seq), b = std::to_string(seq + 1);
    execute("UPDATE events SET seq = -1 WHERE seq = " + a + "; UPDATE events SET seq = " + a +
            " WHERE seq = " + b + "; UPDATE events SET seq = " + b + " WHERE seq = -1");
    EXPECT_TRUE(names(verify(), "event " + a)) << seq;
  }
}

// What no chain can show by itself, and a head that was kept elsewhere does.
TEST_F(TamperTest, ATruncatedTailAgainstAKeptHead) {
  open_the_events();
  fs::copy_file(path_ / "store.sqlite", path_ / "kept");
  for (std::size_t kept = events_.size(); kept-- > 0;) {
    fs::copy_file(path_ / "kept", path_ / "store.sqlite", fs::copy_options::overwrite_existing);
    execute("DELETE FROM events WHERE seq > " + std::to_string(kept));
    Store(path_, Access::write).rebuild();  // a forger makes the tables fit
    const VerifyReport report = verify(head_);
    EXPECT_TRUE(names(report, "event " + std::to_string(head_.seq))) << kept;
    bool said = false;
    for (const Finding& finding : report.findings) {
      said = said || finding.message.find("cut off: it ends at event " + std::to_string(kept)) !=
                         std::string::npos;
    }
    EXPECT_TRUE(said) << kept;
  }
}

TEST_F(TamperTest, ARewrittenPastAgainstAKeptHead) {
  open_the_events();
  // A new chain from event 5 on, without a fault in itself.
  std::string prev = events_[3].hash;
  for (std::size_t i = 4; i < events_.size(); ++i) {
    Event forged = events_[i];
    if (i == 4) forged.recorded_at = "2001-01-01T00:00:00.000Z";
    forged.prev_hash = prev;
    prev = forged.hash = event_hash(forged);
    execute("UPDATE events SET recorded_at = " + literal_of(forged.recorded_at) +
            ", prev_hash = '" + forged.prev_hash + "', hash = '" + forged.hash +
            "' WHERE seq = " + std::to_string(forged.seq));
  }
  Store(path_, Access::write).rebuild();
  EXPECT_TRUE(verify().ok()) << "by itself it is sound";
  EXPECT_TRUE(names(verify(head_), "event " + std::to_string(head_.seq)));
  EXPECT_TRUE(verify(Head{4, events_[3].hash}).ok()) << "until event 4 nothing was changed";
}

TEST_F(TamperTest, AChangedByteOfACheckpoint) {
  const CheckpointRecord& record = records_[4];
  const std::string bytes = test::read_bytes(path_ / record.file);
  std::mt19937_64 random(2);
  std::vector<std::size_t> places = {0, 511, 512, bytes.size() - 1};
  while (places.size() < 64) places.push_back(random() % bytes.size());
  for (const std::size_t at : places) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ (1 << (at % 8)));
    test::write_bytes(path_ / record.file, changed);
    EXPECT_TRUE(names(verify(), record.file)) << "byte " << at;
  }
  test::write_bytes(path_ / record.file, bytes + "x");
  EXPECT_TRUE(names(verify(), record.file));
  test::write_bytes(path_ / record.file, test::read_bytes(path_ / records_[3].file));
  EXPECT_TRUE(names(verify(), record.file)) << "another checkpoint in its place";
  fs::remove(path_ / record.file);
  EXPECT_TRUE(names(verify(), record.file));
}

}  // namespace
}  // namespace shearcell
