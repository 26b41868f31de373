// SPDX-License-Identifier: GPL-3.0-or-later
// An object is whole or absent, is what its name says, and never lies outside the store.
#include "provenance/objects.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <thread>

#include "provenance/errors.hpp"
#include "tests/provenance/samples.hpp"

namespace shearcell {
namespace {

namespace fs = std::filesystem;
using test::expect_refused;

class ObjectStoreTest : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  ObjectStore objects_{folder_.path()};
  const std::vector<std::byte> bytes_ = test::bytes_of("abc");
};

TEST_F(ObjectStoreTest, GivesBackWhatWasPut) {
  const ObjectInfo info = objects_.put(bytes_);
  EXPECT_EQ(info.sha256, sha256_hex("abc"));
  EXPECT_EQ(info.file, "objects/ba/" + info.sha256 + ".h5");
  EXPECT_EQ(info.size, 3u);
  EXPECT_EQ(objects_.get(info.sha256, 3), bytes_);
  const auto written = fs::last_write_time(folder_.path() / info.file);
  objects_.put(bytes_);
  EXPECT_EQ(fs::last_write_time(folder_.path() / info.file), written) << "it was written again";
  EXPECT_TRUE(objects_.strangers({info.sha256}).empty());
}

TEST_F(ObjectStoreTest, ObeysTheUmask) {
  const mode_t old = umask(022);
  const ObjectInfo info = objects_.put(bytes_);
  umask(old);
  struct stat status {};
  ASSERT_EQ(stat((folder_.path() / info.file).c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0644u);
  ASSERT_EQ(stat((folder_.path() / "objects/ba").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0755u);
}

TEST_F(ObjectStoreTest, NamesADamagedFileAndMendsItWithTheNextPut) {
  const ObjectInfo info = objects_.put(bytes_);
  for (const std::string wrong : {"", "ab", "abd", "abcd"}) {
    test::write_bytes(folder_.path() / info.file, wrong);
    expect_refused<StoreDamaged>([&] { objects_.get(info.sha256, info.size); }, {info.file});
  }
  objects_.put(bytes_);
  EXPECT_EQ(objects_.get(info.sha256, info.size), bytes_);
}

TEST_F(ObjectStoreTest, ReportsAMissingFileAndANameThatIsNoDigest) {
  expect_refused<StoreDamaged>([&] { objects_.get(sha256_hex("absent"), 1); }, {"missing"});
  EXPECT_THROW(objects_.get("../../../../etc/passwd", 1), StoreDamaged);
  EXPECT_THROW(objects_.get("", 1), StoreDamaged);
}

TEST_F(ObjectStoreTest, FollowsNoLink) {
  const ObjectInfo info = objects_.put(bytes_);
  const fs::path outside = folder_.path() / "outside.h5";
  fs::rename(folder_.path() / info.file, outside);
  fs::create_symlink(outside, folder_.path() / info.file);
  expect_refused<StoreDamaged>([&] { objects_.get(info.sha256, info.size); }, {"symbolic link"});

  objects_.put(bytes_);  // replaces the link and leaves what it named
  EXPECT_FALSE(fs::is_symlink(folder_.path() / info.file));
  EXPECT_EQ(objects_.get(info.sha256, info.size), bytes_);
  EXPECT_EQ(test::read_bytes(outside), "abc");
}

TEST_F(ObjectStoreTest, FollowsNoLinkToAFolder) {
  const ObjectInfo info = objects_.put(bytes_);
  fs::rename(folder_.path() / "objects/ba", folder_.path() / "elsewhere");
  fs::create_symlink(folder_.path() / "elsewhere", folder_.path() / "objects/ba");
  EXPECT_THROW(objects_.get(info.sha256, info.size), StoreDamaged);
  EXPECT_THROW(objects_.put(bytes_), StoreDamaged);
  EXPECT_EQ(objects_.strangers({info.sha256}), std::vector<std::string>{"objects/ba"});
}

TEST_F(ObjectStoreTest, NamesStrangers) {
  const ObjectInfo info = objects_.put(bytes_);
  test::write_bytes(folder_.path() / "objects/ba/.tmp-1-0", "half");
  test::write_bytes(folder_.path() / "objects/note.txt", "");
  EXPECT_EQ(objects_.strangers({info.sha256}),
            (std::vector<std::string>{"objects/ba/.tmp-1-0", "objects/note.txt"}));
  EXPECT_EQ(objects_.strangers({}).size(), 3u);
}

TEST_F(ObjectStoreTest, TakesTheSameObjectFromSeveralThreads) {
  const std::vector<std::byte> large(1 << 20, std::byte{7});
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) threads.emplace_back([&] { objects_.put(large); });
  for (std::thread& thread : threads) thread.join();
  const std::string sha256 = sha256_hex(large);
  EXPECT_EQ(objects_.get(sha256, large.size()), large);
  EXPECT_TRUE(objects_.strangers({sha256}).empty());
}

}  // namespace
}  // namespace shearcell
