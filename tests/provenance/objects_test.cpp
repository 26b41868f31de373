// SPDX-License-Identifier: GPL-3.0-or-later
// An object is complete or missing, matches the digest in its name, and is never outside the store.
#include "provenance/objects.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/threads.hpp"
#include "provenance/errors.hpp"
#include "tests/provenance/samples.hpp"
#include "tests/support/variable.hpp"

namespace shearcell {
namespace {

namespace fs = std::filesystem;
using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

class ObjectStoreTest : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  ObjectStore objects_{folder_.path()};
  const std::vector<std::byte> bytes_ = bytes_of("abc");
};

TEST_F(ObjectStoreTest, ReturnsStoredBytes) {
  const std::string sha256 = objects_.put(bytes_);
  EXPECT_EQ(sha256, sha256_hex("abc"));
  EXPECT_EQ(ObjectStore::file_of(sha256), "objects/ba/" + sha256 + ".h5");
  EXPECT_EQ(objects_.get(sha256, 3), bytes_);
  const fs::path file = folder_.path() / ObjectStore::file_of(sha256);
  const auto earlier = fs::last_write_time(file) - std::chrono::hours(1);
  fs::last_write_time(file, earlier);
  objects_.put(bytes_);
  EXPECT_EQ(fs::last_write_time(file), earlier) << "it was written again";
  EXPECT_TRUE(objects_.strangers({sha256}).empty());
}

TEST_F(ObjectStoreTest, RefusesAFileThatTheMemoryDoesNotHold) {
  const std::string sha256 = objects_.put(bytes_);
  fs::resize_file(folder_.path() / ObjectStore::file_of(sha256), std::uintmax_t{1} << 40);
  expect_refused<TooLittleMemory>([&] { objects_.get(sha256, std::uint64_t{1} << 40); },
                                  {"memory"});
}

TEST_F(ObjectStoreTest, ObeysTheUmask) {
  const mode_t old = umask(022);
  const std::string sha256 = objects_.put(bytes_);
  umask(old);
  struct stat status {};
  ASSERT_EQ(stat((folder_.path() / ObjectStore::file_of(sha256)).c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0644u);
  ASSERT_EQ(stat((folder_.path() / "objects/ba").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0755u);
}

TEST_F(ObjectStoreTest, NamesADamagedFileAndRepairsItAtTheNextPut) {
  const std::string sha256 = objects_.put(bytes_);
  for (const std::string wrong : {"", "ab", "abd", "abcd"}) {
    write_bytes(folder_.path() / ObjectStore::file_of(sha256), wrong);
    expect_refused<StoreDamaged>([&] { objects_.get(sha256, 3); }, {ObjectStore::file_of(sha256)});
  }
  objects_.put(bytes_);
  EXPECT_EQ(objects_.get(sha256, 3), bytes_);
}

TEST_F(ObjectStoreTest, ReportsAMissingFileAndANameThatIsNotADigest) {
  expect_refused<StoreDamaged>([&] { objects_.get(sha256_hex("absent"), 1); }, {"missing"});
  EXPECT_THROW(objects_.get("../../../../etc/passwd", 1), StoreDamaged);
  EXPECT_THROW(objects_.get("", 1), StoreDamaged);
}

TEST_F(ObjectStoreTest, FollowsNoLink) {
  const std::string sha256 = objects_.put(bytes_);
  const fs::path outside = folder_.path() / "outside.h5";
  fs::rename(folder_.path() / ObjectStore::file_of(sha256), outside);
  fs::create_symlink(outside, folder_.path() / ObjectStore::file_of(sha256));
  expect_refused<StoreDamaged>([&] { objects_.get(sha256, 3); }, {"symbolic link"});

  objects_.put(bytes_);  // replaces the link and leaves what it named
  EXPECT_FALSE(fs::is_symlink(folder_.path() / ObjectStore::file_of(sha256)));
  EXPECT_EQ(objects_.get(sha256, 3), bytes_);
  EXPECT_EQ(read_bytes(outside), "abc");
}

TEST_F(ObjectStoreTest, FollowsNoLinkToAFolder) {
  const std::string sha256 = objects_.put(bytes_);
  fs::rename(folder_.path() / "objects/ba", folder_.path() / "elsewhere");
  fs::create_symlink(folder_.path() / "elsewhere", folder_.path() / "objects/ba");
  EXPECT_THROW(objects_.get(sha256, 3), StoreDamaged);
  EXPECT_THROW(objects_.put(bytes_), StoreDamaged);
  EXPECT_EQ(objects_.strangers({sha256}), std::vector<std::string>{"objects/ba"});
}

TEST_F(ObjectStoreTest, NamesForeignFiles) {
  const std::string sha256 = objects_.put(bytes_);
  write_bytes(folder_.path() / "objects/ba/.tmp-1-0", "half");
  write_bytes(folder_.path() / "objects/note.txt", "");
  EXPECT_EQ(objects_.strangers({sha256}),
            (std::vector<std::string>{"objects/ba/.tmp-1-0", "objects/note.txt"}));
  EXPECT_EQ(objects_.strangers({}).size(), 3u);
}

TEST_F(ObjectStoreTest, AcceptsTheSameObjectFromSeveralThreads) {
  const std::vector<std::byte> large(1 << 20, std::byte{7});
  start_threads(5, [&](std::size_t) { objects_.put(large); });
  const std::string sha256 = sha256_hex(large);
  EXPECT_EQ(objects_.get(sha256, large.size()), large);
  EXPECT_TRUE(objects_.strangers({sha256}).empty());
}

TEST(TemporaryFolder, NamesTheMissingFolder) {
  const TemporaryFolder place;
  const std::string gone = place.path() / "gone";
  const Variable tmpdir("TMPDIR", gone);
  expect_refused<std::system_error>([] { TemporaryFolder(); }, {gone, "TMPDIR"});
  const TemporaryFolder beside((place.path() / ".x.tmp-").string());  // which does not need it
  EXPECT_EQ(beside.path().parent_path(), place.path());
}

TEST(Output, CreatesItsFolder) {
  const TemporaryFolder place;
  write_output(place.path() / "new" / "a.csv", "x\n");
  EXPECT_EQ(read_bytes(place.path() / "new" / "a.csv"), "x\n");
}

TEST(Output, ToAnUnreadableFolderIsRejected) {
  if (geteuid() == 0) GTEST_SKIP() << "root reads everything";
  const TemporaryFolder folder;
  fs::permissions(folder.path(), fs::perms::none);
  const auto ours = [](std::string_view) { return true; };
  expect_refused<std::system_error>([&] { require_ours(folder.path() / "x.csv", ours); },
                                    {"x.csv: cannot write", "ermission denied"});
  fs::permissions(folder.path(), fs::perms::owner_all);
}

TEST(Append, NamesTheFileThatCannotBeWritten) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "new";
  append(path, "abc");
  append(path, "de");
  EXPECT_EQ(read_bytes(path), "abcde");
  fs::create_symlink(path, folder.path() / "link");
  for (const char* name : {"link", "missing/new"}) {
    expect_refused<std::system_error>([&] { append(folder.path() / name, "x"); }, {name});
  }
  EXPECT_EQ(read_bytes(path), "abcde");
}

}  // namespace
}  // namespace shearcell
