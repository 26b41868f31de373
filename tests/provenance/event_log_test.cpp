// SPDX-License-Identifier: GPL-3.0-or-later
// The log only grows, orders all writers, and reveals any change made without it.
#include "provenance/event_log.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include "provenance/errors.hpp"
#include "tests/provenance/samples.hpp"
#include "tests/support/text.hpp"

namespace shearcell {
namespace {

class EventLogTest : public ::testing::Test {
 protected:
  EventLogTest() { fill(); }

  sqlite::Database open() { return open_database(folder_.path() / "store.sqlite", Access::create); }

  static void append(sqlite::Database& database, const std::string& stream, const NewEvent& event) {
    sqlite::WriteTransaction lock(database);
    EventLog(database).append(lock, stream, event);
    lock.commit();
  }

  void fill() {
    sqlite::Database database = open();
    append(database, "test/a", {"First", {{"x", 1}}});
    append(database, "test/a", {"Second", {{"x", 2}}});
    append(database, "test/b", {"First", {{"x", 3}}});
    append(database, "test/a", {"Third", {{"x", 4}}});
  }

  TemporaryFolder folder_;
};

TEST_F(EventLogTest, NumbersAndChainsEventsInTheLogAndInTheirStream) {
  sqlite::Database database = open();
  const EventLog log(database);
  std::uint64_t seq = 0;
  std::string last(64, '0');
  for (const Event& event : log.events()) {
    EXPECT_EQ(event.seq, ++seq);
    EXPECT_EQ(event.prev_hash, last);
    last = event.hash;
  }
  EXPECT_EQ(seq, 4u);
  EXPECT_EQ(log.head().seq, 4u);
  EXPECT_EQ(log.head().hash, last);
  EXPECT_FALSE(log.verify_chain().has_value());
  EXPECT_EQ(log.version("test/a"), 3u);
  EXPECT_EQ(log.version("test/b"), 1u);
  EXPECT_EQ(log.version("test/c"), 0u);
}

TEST_F(EventLogTest, SelectsEventsByStreamAndType) {
  sqlite::Database database = open();
  const EventLog log(database);
  const auto numbers = [&](const char* stream, const char* type) {
    std::vector<int> found;
    for (const Event& event : log.events(stream, type)) found.push_back(event.body()["x"]);
    return found;
  };
  EXPECT_EQ(numbers("", ""), (std::vector{1, 2, 3, 4}));
  EXPECT_EQ(numbers("test/a", ""), (std::vector{1, 2, 4}));
  EXPECT_EQ(numbers("", "First"), (std::vector{1, 3}));
  EXPECT_EQ(numbers("test/a", "First"), (std::vector{1}));
  EXPECT_TRUE(numbers("test/b", "Third").empty());
}

TEST_F(EventLogTest, HashesAreThoseOfNetstrings) {
  const Event event{.seq = 7,
                    .stream = "run/ab",
                    .version = 2,
                    .type = "RunStarted",
                    .schema = 1,
                    .recorded_at = "2020-12-22T00:00:00.000Z",
                    .payload = "{}",
                    .prev_hash = std::string(64, '0'),
                    .hash = ""};
  EXPECT_EQ(event_hash(event),
            sha256_hex("17:shearcell event 1,64:" + std::string(64, '0') +
                       ",1:7,6:run/ab,1:2,10:RunStarted,1:1,24:2020-12-22T00:00:00.000Z,2:{},"));
}

TEST_F(EventLogTest, AppendsAllOrNothing) {
  sqlite::Database database = open();
  {
    EventLog log(database);
    sqlite::WriteTransaction lock(database);
    log.append(lock, "test/a", {"Fourth", {}});
    log.append(lock, "test/a", {"Fifth", {}});
  }  // not committed
  EXPECT_EQ(EventLog(database).version("test/a"), 3u);
}

TEST_F(EventLogTest, RejectsUpdateAndDelete) {
  sqlite::Database database = open();
  for (const std::string sql : {"UPDATE events SET type = 'Other' WHERE seq = 1",
                                "DELETE FROM events WHERE seq = 4", "DELETE FROM events"}) {
    EXPECT_THROW(database.execute(sql), StoreDamaged) << sql;
  }
  EXPECT_FALSE(EventLog(database).verify_chain().has_value());
}

TEST_F(EventLogTest, KeepsEveryByteOfAPayload) {
  sqlite::Database database = open();
  const nlohmann::json payload = {{"text", std::string("a\0b\n\"\\\u00e9\U0001F600\0", 13)},
                                  {"x", 0.1},
                                  {"tiny", 5e-324},
                                  {"seed", 0xffffffffffffffffu}};
  append(database, "test/c", {"First", payload});
  EXPECT_EQ(EventLog(database).events("test/c").at(0).body(), payload);
  append(database, "test/c", {"Second", {{"path", "caf\xe9.yaml"}}});
  EXPECT_EQ(EventLog(database).events("test/c").at(1).body()["path"], "caf\uFFFD.yaml")
      << "JSON cannot hold the byte";
  EXPECT_FALSE(EventLog(database).verify_chain().has_value());
}

TEST_F(EventLogTest, SyncsEachCommit) {
  sqlite::Database database = open();
  EXPECT_EQ(database.integer("PRAGMA synchronous"), 3);  // EXTRA
  EXPECT_EQ(database.integer("PRAGMA foreign_keys"), 1);
  sqlite::Statement mode(database, "PRAGMA journal_mode");
  ASSERT_TRUE(mode.step());
  EXPECT_EQ(mode.text(0), "delete");
}

TEST(Clock, FormatsTimesBefore1970) {
  EXPECT_EQ(utc_text(0), "1970-01-01T00:00:00.000Z");
  EXPECT_EQ(utc_text(-1), "1969-12-31T23:59:59.999Z");
  EXPECT_EQ(utc_text(-86'400'850), "1969-12-30T23:59:59.150Z");
  EXPECT_EQ(utc_text(1'795'341'345'123), "2026-11-22T09:55:45.123Z");
}

/// Files that are not root's are protected also when root runs the tests.
class AsNobody {
 public:
  AsNobody() { root_ = geteuid() == 0 && seteuid(65534) == 0; }
  ~AsNobody() { EXPECT_TRUE(!root_ || seteuid(0) == 0); }

 private:
  bool root_ = false;
};

TEST_F(EventLogTest, SaysHowToRecoverWhatAKilledWriterLeftOnAReadOnlyDisk) {
  namespace fs = std::filesystem;
  fs::permissions(folder_.path(), fs::perms{0755});
  const auto head_of = [](const fs::path& folder) {
    sqlite::Database database = open_database(folder / "store.sqlite", Access::read);
    return EventLog(database).head().hash;
  };
  const std::string head = head_of(folder_.path());
  struct Case {
    std::string name;
    unsigned log, journal, folder;
    std::string unwritable;
  };
  const std::vector<Case> cases = {{"all", 0444, 0444, 0555, "store.sqlite-journal"},
                                   {"log", 0444, 0666, 0777, "store.sqlite ("},
                                   {"journal", 0666, 0444, 0777, "store.sqlite-journal ("},
                                   {"unreadable", 0666, 0600, 0777, "store.sqlite-journal ("},
                                   {"folder", 0666, 0666, 0555, "/folder ("}};
  {
    sqlite::Database killed = open();
    killed.execute(
        "PRAGMA cache_size=1; BEGIN IMMEDIATE; CREATE TABLE half_written(x); WITH RECURSIVE "
        "n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 200) INSERT INTO half_written "
        "SELECT randomblob(1000) FROM n;");
    for (const Case& c : cases) {
      for (const char* file : {"store.sqlite", "store.sqlite-journal"}) {
        fs::create_directories(folder_.path() / c.name);
        fs::copy(folder_.path() / file, folder_.path() / c.name / file);
      }
    }
    killed.execute("ROLLBACK");
  }
  for (const Case& c : cases) {
    const testing::ScopedTrace trace(__FILE__, __LINE__, c.name);
    const fs::path folder = folder_.path() / c.name, log = folder / "store.sqlite";
    fs::permissions(log, fs::perms{c.log});
    fs::permissions(log.string() + "-journal", fs::perms{c.journal});
    fs::permissions(folder, fs::perms{c.folder});
    try {
      const AsNobody nobody;
      if (access(folder_.path().c_str(), X_OK) != 0) GTEST_SKIP() << "others cannot come here";
      open_database(log, Access::read);
      ADD_FAILURE() << "opened";
    } catch (const MachineError& error) {
      for (const std::string& part :
           {log.string() + ": a program was writing to this store when it was killed",
            "cannot write to " + folder_.path().string(), c.unwritable,
            std::string("Copy the whole folder to a disk where you can write")}) {
        EXPECT_TRUE(test::has(error.what(), part)) << part << "\n" << error.what();
      }
    }
    // As the message says.
    const fs::path copy = folder_.path() / (c.name + " copy");
    fs::copy(folder, copy);
    for (const fs::path& path : {copy, copy / "store.sqlite", copy / "store.sqlite-journal"}) {
      fs::permissions(path, fs::perms{0755});
    }
    EXPECT_EQ(head_of(copy), head);
    EXPECT_FALSE(fs::exists(copy / "store.sqlite-journal"));
    fs::permissions(folder, fs::perms{0755});
  }
}

}  // namespace
}  // namespace shearcell
