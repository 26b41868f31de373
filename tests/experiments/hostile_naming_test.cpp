// SPDX-License-Identifier: GPL-3.0-or-later
// No file is visible under its final name before it is whole: whoever reads it meanwhile, or a
// program that is killed, must not leave or find half of one.
#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <map>

#include "tests/experiments/program.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

/// What happens to names below a folder, whose folders exist already, while a program runs.
class NameWatch {
 public:
  explicit NameWatch(const fs::path& folder) {
    watch(folder);
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_directory()) watch(entry.path());
    }
  }
  ~NameWatch() { close(descriptor_); }
  NameWatch(const NameWatch&) = delete;
  NameWatch& operator=(const NameWatch&) = delete;

  /// File -> the events that happened to its name since the last call.
  std::map<fs::path, std::uint32_t> events() {
    std::map<fs::path, std::uint32_t> seen;
    alignas(inotify_event) std::array<char, 1 << 16> buffer{};
    for (ssize_t size = 0; (size = read(descriptor_, buffer.data(), buffer.size())) > 0;) {
      for (const char* at = buffer.data(); at < buffer.data() + size;) {
        inotify_event event{};
        std::memcpy(&event, at, sizeof(event));
        EXPECT_EQ(event.mask & IN_Q_OVERFLOW, 0U);
        if (event.len > 0) seen[folders_[event.wd] / (at + sizeof(event))] |= event.mask;
        at += sizeof(event) + event.len;
      }
    }
    return seen;
  }

 private:
  void watch(const fs::path& folder) {
    const int wd =
        inotify_add_watch(descriptor_, folder.c_str(), IN_CREATE | IN_MODIFY | IN_MOVED_TO);
    ASSERT_GE(wd, 0) << folder;
    folders_[wd] = folder;
  }

  int descriptor_ = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
  std::map<int, fs::path> folders_;
};

class FinalNames : public ProgramTest {
 protected:
  void SetUp() override {
    campaign(tiny_manifest("  grains: 200\n", kBothFluids), {"--cycles", "3"});
    id_ = json({"status", "--json"})["runs"].back()["id"];
  }

  /// Removes the files below `folder`, but keeps its folders.
  void clear(const std::string& folder) const {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(path(folder))) {
      if (entry.is_regular_file()) files.push_back(entry.path());
    }
    for (const fs::path& file : files) fs::remove(file);
  }

  /// Everything that there is at the end and that was touched came by a rename or a hard link.
  /// Returns how many there are.
  static std::size_t expect_whole(NameWatch& watch) {
    std::size_t files = 0;
    for (const auto& [file, mask] : watch.events()) {
      if (!fs::exists(file) || file.filename().string().find(".sqlite") != std::string::npos) {
        continue;  // a temporary name; a database
      }
      ++files;
      EXPECT_EQ(mask & IN_MODIFY, 0U) << file << " was written under its name";
      if ((mask & IN_MOVED_TO) != 0) continue;
      EXPECT_TRUE(fs::is_regular_file(file)) << file << " is a folder that was made empty";
    }
    return files;
  }

  std::string id_;
};

TEST_F(FinalNames, AreGivenToWholeFilesAndFolders) {
  for (const Arguments& command :
       std::vector<Arguments>{{"export", id_, "--to", "extxyz", "--out", "out/e.xyz"},
                              {"export", id_, "--to", "h5md", "--out", "out/e.h5md"},
                              {"export", id_, "--to", "vtk", "--out", "out/vtk"},
                              {"export", id_, "--to", "lammps", "--out", "out/lammps"},
                              {"export", id_, "--to", "ro-crate", "--out", "out/crate"},
                              {"new", "out/n.yaml"}}) {
    SCOPED_TRACE(command.back());
    fs::create_directories(path("out"));
    NameWatch watch(path("out"));
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(expect_whole(watch), 1U);
    fs::remove_all(path("out"));
  }
}

TEST_F(FinalNames, AreGivenToWholeFilesWhereOthersStood) {
  struct Case {
    Arguments command;
    std::size_t files;
  };
  for (const auto& [command, files] : std::vector<Case>{{{"figures", "S2", "--out", "out/f"}, 11},
                                                        {{"table", "--out", "out/t.csv"}, 1},
                                                        {{"report", "--out", "out/r.html"}, 1}}) {
    SCOPED_TRACE(command.front());
    fs::create_directories(path("out"));
    ASSERT_EQ(run(command).code, 0);  // which leaves the folders to watch
    NameWatch watch(path("out"));
    EXPECT_EQ(run(command).code, 0);
    EXPECT_EQ(expect_whole(watch), files) << "over its own files";
    clear("out");
    watch.events();
    EXPECT_EQ(run(command).code, 0);
    EXPECT_EQ(expect_whole(watch), files) << "where there were none";
    fs::remove_all(path("out"));
  }
}

TEST_F(FinalNames, AreGivenToWholeCheckpoints) {
  Arguments again = {"regenerate"};
  const nlohmann::json pruning = json({"prune", "--keep-every", "2", "--yes", "--json"});
  for (const auto& pruned : pruning.at("checkpoints")) {
    again.push_back(pruned["sha256"]);
  }
  NameWatch watch(path("shearcell-store"));
  ASSERT_EQ(run(again).code, 0);
  EXPECT_EQ(expect_whole(watch), again.size() - 1);
}

}  // namespace
}  // namespace shearcell::test
