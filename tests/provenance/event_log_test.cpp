// SPDX-License-Identifier: GPL-3.0-or-later
// The log only grows, orders all writers, and shows any change behind its back.
#include "provenance/event_log.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "provenance/errors.hpp"
#include "provenance/io/clock.hpp"
#include "provenance/schema.hpp"
#include "tests/provenance/samples.hpp"

namespace shearcell {
namespace {

class EventLogTest : public ::testing::Test {
 protected:
  EventLogTest() { fill(); }

  sqlite::Database open() {
    return open_database(folder_.path() / "store.sqlite", sqlite::Open::create, false);
  }

  static std::vector<Event> append(sqlite::Database& database, const std::string& stream,
                                   std::uint64_t expected, const std::vector<NewEvent>& events) {
    EventLog log(database);
    sqlite::WriteTransaction lock(database);
    auto appended = log.append(lock, stream, expected, events);
    lock.commit();
    return appended;
  }

  void fill() {
    sqlite::Database database = open();
    append(database, "test/a", 0, {{"First", {{"x", 1}}}, {"Second", {{"x", 2}}}});
    append(database, "test/b", 0, {{"First", {{"x", 3}}}});
    append(database, "test/a", 2, {{"Third", {{"x", 4}}}});
  }

  /// Changes the file as an attacker with the sqlite3 program would.
  void tamper(const std::string& sql) {
    sqlite::Database database = open();
    database.execute(
        "DROP TRIGGER events_are_never_updated; DROP TRIGGER events_are_never_deleted");
    database.execute(sql);
  }

  ChainFault fault() {
    sqlite::Database database = open();
    const auto found = EventLog(database).verify_chain();
    EXPECT_TRUE(found.has_value());
    return found.value_or(ChainFault{});
  }

  TemporaryFolder folder_;
};

TEST_F(EventLogTest, NumbersEventsInTheLogAndInTheirStream) {
  sqlite::Database database = open();
  const EventLog log(database);
  const std::vector<Event> all = log.events();
  ASSERT_EQ(all.size(), 4u);
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[i].seq, i + 1);
  EXPECT_EQ(log.version("test/a"), 3u);
  EXPECT_EQ(log.version("test/b"), 1u);
  EXPECT_EQ(log.version("test/c"), 0u);
  const std::vector<Event> a = log.events("test/a", 1);
  ASSERT_EQ(a.size(), 2u);
  EXPECT_EQ(a[1].body()["x"], 4);
}

TEST_F(EventLogTest, ChainsEachEventToTheOneBefore) {
  sqlite::Database database = open();
  const EventLog log(database);
  std::string last(64, '0');
  for (const Event& event : log.events()) {
    EXPECT_EQ(event.prev_hash, last);
    last = event.hash;
  }
  EXPECT_EQ(log.head().hash, last);
  EXPECT_EQ(log.head().seq, 4u);
  EXPECT_FALSE(log.verify_chain().has_value());
}

TEST_F(EventLogTest, HashesNetstringsThatNeedNoProgramToCheck) {
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

TEST_F(EventLogTest, RefusesAnAppendThatExpectsAnotherVersion) {
  sqlite::Database database = open();
  for (const std::uint64_t wrong : {0U, 2U, 4U}) {
    EXPECT_THROW(append(database, "test/a", wrong, {{"Late", {}}}), ConcurrencyConflict);
  }
  EXPECT_EQ(EventLog(database).head().seq, 4u);
}

TEST_F(EventLogTest, AppendsAllOrNothing) {
  sqlite::Database database = open();
  {
    EventLog log(database);
    sqlite::WriteTransaction lock(database);
    const std::vector<NewEvent> two = {{"Fourth", {}}, {"Fifth", {}}};
    log.append(lock, "test/a", 3, two);
  }  // not committed
  EXPECT_EQ(EventLog(database).version("test/a"), 3u);
}

TEST_F(EventLogTest, RefusesUpdateAndDelete) {
  sqlite::Database database = open();
  for (const std::string sql : {"UPDATE events SET type = 'Other' WHERE seq = 1",
                                "DELETE FROM events WHERE seq = 4", "DELETE FROM events"}) {
    EXPECT_THROW(database.execute(sql), StoreDamaged) << sql;
  }
  EXPECT_FALSE(EventLog(database).verify_chain().has_value());
}

TEST_F(EventLogTest, FindsAChangeOfAnyField) {
  const std::vector<std::pair<std::string, std::string>> changes = {
      {"stream = 'test/z'", "content"},
      {"version = 9", "version"},
      {"type = 'Other'", "content"},
      {"schema = 2", "content"},
      {"recorded_at = '2001-01-01T00:00:00.000Z'", "content"},
      {"payload = '{\"x\":5}'", "content"},
      {"prev_hash = '" + std::string(64, 'a') + "'", "prev_hash"},
      {"hash = '" + std::string(64, 'b') + "'", "hash"}};
  for (const auto& [change, field] : changes) {
    SCOPED_TRACE(change);
    std::filesystem::remove(folder_.path() / "store.sqlite");
    fill();
    tamper("UPDATE events SET " + change + " WHERE seq = 2");
    const ChainFault found = fault();
    EXPECT_EQ(found.seq, 2u);
    EXPECT_EQ(found.field, field);
    EXPECT_NE(found.message.find("event 2"), std::string::npos) << found.message;
  }
}

TEST_F(EventLogTest, FindsAnEventThatWasRehashed) {
  sqlite::Database database = open();
  Event forged = EventLog(database).events().at(1);
  forged.payload = "{\"x\":6}";
  forged.hash = event_hash(forged);
  tamper("UPDATE events SET payload = '" + forged.payload + "', hash = '" + forged.hash +
         "' WHERE seq = 2");
  EXPECT_EQ(fault().seq, 3u);
  EXPECT_EQ(fault().field, "prev_hash");
}

TEST_F(EventLogTest, KeepsEveryByteOfAPayload) {
  sqlite::Database database = open();
  const nlohmann::json payload = {{"text", std::string("a\0b\n\"\\\u00e9\U0001F600\0", 13)},
                                  {"x", 0.1},
                                  {"tiny", 5e-324},
                                  {"seed", 0xffffffffffffffffu}};
  append(database, "test/c", 0, {{"First", payload}});
  EXPECT_EQ(EventLog(database).events("test/c").at(0).body(), payload);
  EXPECT_FALSE(EventLog(database).verify_chain().has_value());
}

TEST_F(EventLogTest, ReplacesBytesThatJsonCannotHold) {
  sqlite::Database database = open();
  append(database, "test/c", 0, {{"First", {{"path", "caf\xe9.yaml"}}}});
  EXPECT_EQ(EventLog(database).events("test/c").at(0).body()["path"], "caf\uFFFD.yaml");
}

TEST_F(EventLogTest, OrdersWritersOfSeveralConnections) {
  constexpr int kThreads = 4;
  constexpr int kEvents = 10;
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([this, t] {
      sqlite::Database database = open();
      for (std::uint64_t i = 0; i < kEvents; ++i) {
        append(database, "test/thread" + std::to_string(t), i, {{"Counted", {{"i", i}}}});
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  sqlite::Database database = open();
  EXPECT_EQ(EventLog(database).head().seq, 4u + kThreads * kEvents);
  EXPECT_FALSE(EventLog(database).verify_chain().has_value());
}

TEST_F(EventLogTest, SyncsAsTheDesignAsks) {
  sqlite::Database database = open();
  EXPECT_EQ(database.integer("PRAGMA synchronous"), 3);  // EXTRA
  EXPECT_EQ(database.integer("PRAGMA foreign_keys"), 1);
  sqlite::Statement mode(database, "PRAGMA journal_mode");
  ASSERT_TRUE(mode.step());
  EXPECT_EQ(mode.text(0), "delete");
}

TEST(Clock, TellsTimesBefore1970) {
  EXPECT_EQ(utc_text(0), "1970-01-01T00:00:00.000Z");
  EXPECT_EQ(utc_text(-1), "1969-12-31T23:59:59.999Z");
  EXPECT_EQ(utc_text(-86'400'850), "1969-12-30T23:59:59.150Z");
  EXPECT_EQ(utc_text(1'795'341'345'123), "2026-11-22T09:55:45.123Z");
}

}  // namespace
}  // namespace shearcell
