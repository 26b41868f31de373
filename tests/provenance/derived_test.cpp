// SPDX-License-Identifier: GPL-3.0-or-later
// A derived object is returned exactly as stored or not at all, even if the file is damaged.
#include "provenance/derived.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/threads.hpp"
#include "provenance/limits.hpp"
#include "tests/provenance/samples.hpp"

namespace shearcell {
namespace {

namespace fs = std::filesystem;
using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

class DerivedCacheTest : public testing::Test {
 protected:
  static DerivedKey key(int checkpoint, const std::string& measure = "scalars {}",
                        std::uint64_t version = 1) {
    return {run_id(checkpoint), measure, version};
  }
  std::optional<std::vector<std::byte>> get(const DerivedKey& wanted) {
    DerivedCache cache(folder_.path());
    return cache.get(std::span(&wanted, 1)).at(0);
  }
  static void put(DerivedCache& cache, const DerivedKey& key, const std::string& content) {
    const DerivedObject object{key, bytes_of(content)};
    cache.put(std::span(&object, 1));
  }
  void put(const DerivedKey& key, const std::string& content) {
    DerivedCache cache(folder_.path());
    put(cache, key, content);
    EXPECT_EQ(cache.trouble(), "");
  }
  void sql(const std::string& statement) {
    sqlite::Database(file(), Access::write).execute(statement);
  }
  fs::path file() const { return folder_.path() / DerivedCache::kFile; }

  TemporaryFolder folder_;
};

TEST_F(DerivedCacheTest, ReturnsStoredResults) {
  const std::string content("\0\xff CBOR \0", 9);
  put(key(1), content);
  EXPECT_EQ(get(key(1)), bytes_of(content));
  put(key(1), "newer");
  EXPECT_EQ(get(key(1)), bytes_of("newer"));
  put(key(2), "");
  EXPECT_EQ(get(key(2)), bytes_of(""));
}

TEST_F(DerivedCacheTest, LeavesOutWhatIsTooLargeAndKeepsTheRest) {
  put(key(1), "content");
  put(key(2), std::string(StoreLimits::value_bytes, 'x'));
  put(key(3), std::string(StoreLimits::value_bytes + 1, 'x'));
  EXPECT_EQ(get(key(1)), bytes_of("content"));
  EXPECT_NE(get(key(2)), std::nullopt);
  EXPECT_EQ(get(key(3)), std::nullopt);
}

TEST_F(DerivedCacheTest, EveryPartOfTheKeyMatters) {
  put(key(1), "content");
  EXPECT_EQ(get(key(2)), std::nullopt);
  EXPECT_EQ(get(key(1, "scalars {\"q6\":1}")), std::nullopt);
  EXPECT_EQ(get(key(1, "scalars {}", 2)), std::nullopt);
}

TEST_F(DerivedCacheTest, DoesNotReturnADamagedOrMisplacedObject) {
  put(key(1), "content");
  put(key(2), "content");
  sql("UPDATE derived SET content = x'00' WHERE checkpoint = '" + run_id(1) + "'");
  EXPECT_EQ(get(key(1)), std::nullopt);
  EXPECT_EQ(get(key(2)), bytes_of("content"));
  {
    DerivedCache cache(folder_.path());
    const DerivedObject object{key(2), bytes_of("content")};
    EXPECT_EQ(cache.digests(run_id(1)), Digests());
    EXPECT_EQ(cache.digests(run_id(2)), Digests({digest_entry(object)}));
    const Digests damaged = cache.digests(run_id(1), true);
    ASSERT_EQ(damaged.size(), 1U);
    EXPECT_EQ(damaged.begin()->first, digest_entry(object).first);
    EXPECT_EQ(damaged.begin()->second, "");
  }
  // A sound object under the key of another.
  sql("UPDATE derived SET checkpoint = '" + run_id(3) + "' WHERE checkpoint = '" + run_id(2) + "'");
  EXPECT_EQ(get(key(3)), std::nullopt);
  put(key(1), "content");
  EXPECT_EQ(get(key(1)), bytes_of("content"));
}

TEST_F(DerivedCacheTest, StartsOverIfTheFileIsNotADatabase) {
  put(key(1), "content");
  const std::string sound = read_bytes(file());
  for (const std::string& damaged : {std::string("no database at all, and long enough to be read"),
                                     sound.substr(0, sound.size() / 2), std::string(8192, '\0'),
                                     sound.substr(0, 100) + std::string(sound.size() - 100, 'x')}) {
    write_bytes(file(), damaged);
    EXPECT_EQ(get(key(1)), std::nullopt) << damaged.size() << " bytes";
    put(key(1), "content");
    EXPECT_EQ(get(key(1)), bytes_of("content")) << damaged.size() << " bytes";
  }
  // They may hold the only measures of pruned checkpoints.
  for (int n = 1; n <= 4; ++n) {
    EXPECT_TRUE(std::filesystem::exists(file().string() + fmt::format(".damaged-{}", n)));
  }
}

TEST_F(DerivedCacheTest, NoFlippedByteChangesTheContent) {
  put(key(1), "content");
  const std::string sound = read_bytes(file());
  int given = 0, lost = 0;
  for (std::size_t at = 0; at < sound.size(); at += 37) {
    std::string flipped = sound;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x10);
    write_bytes(file(), flipped);
    const auto content = get(key(1));
    EXPECT_EQ(content.value_or(bytes_of("content")), bytes_of("content")) << "byte " << at;
    ++(content ? given : lost);
  }
  std::printf("%d flipped bytes: %d times given right, %d times not given\n", given + lost, given,
              lost);
  EXPECT_GT(lost, 0);
}

TEST_F(DerivedCacheTest, MayBeDeletedWhileInUse) {
  DerivedCache cache(folder_.path());
  fs::remove(file());
  put(cache, key(1), "content");
  put(key(2), "content");
  EXPECT_EQ(get(key(2)), bytes_of("content"));
}

TEST_F(DerivedCacheTest, KeepsTheFileOfANewerVersion) {
  put(key(1), "content");
  sqlite::Database(file(), Access::write).execute("PRAGMA user_version = 9");
  DerivedCache cache(file().parent_path());
  EXPECT_TRUE(has(cache.trouble(), "a newer version of this program"));
  EXPECT_FALSE(std::filesystem::exists(file().string() + ".damaged-1"));
}

TEST_F(DerivedCacheTest, TouchesNoForeignFile) {
  const std::string elsewhere = (folder_.path() / "elsewhere").string();
  write_bytes(elsewhere, "mine");
  fs::create_symlink(elsewhere, file());
  {
    DerivedCache cache(folder_.path());
    EXPECT_TRUE(has(cache.trouble(), "link"));
    put(cache, key(1), "content");
  }
  EXPECT_EQ(read_bytes(elsewhere), "mine");
  fs::remove(file());
  sqlite::Database(file(), Access::create)
      .execute("PRAGMA application_id=7; CREATE TABLE mine(x); INSERT INTO mine VALUES(1);");
  DerivedCache cache(folder_.path());
  EXPECT_TRUE(has(cache.trouble(), "another program"));
  EXPECT_EQ(sqlite::Database(file(), Access::write).integer("SELECT x FROM mine"), 1);
}

TEST_F(DerivedCacheTest, SeveralProgramsMayWriteAtOnce) {
  start_threads(5, [this](std::size_t thread) {
    DerivedCache cache(folder_.path());  // a connection of its own, as another process has
    for (int i = 0; i < 50; ++i) put(cache, key(i), "content " + std::to_string(i));
    EXPECT_EQ(cache.trouble(), "") << thread;
  });
  for (int i = 0; i < 50; ++i) EXPECT_EQ(get(key(i)), bytes_of("content " + std::to_string(i)));
}

}  // namespace
}  // namespace shearcell
