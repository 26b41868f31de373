// SPDX-License-Identifier: GPL-3.0-or-later
// The temporary files of a killed run are deleted at the next start, and no other files.
#include "experiments/runner/lammps/scratch_folder.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "provenance/io/file.hpp"
#include "tests/support/variable.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

class Scratch : public testing::Test {
 protected:
  /// A folder of that name as a killed owner leaves it.
  fs::path left_behind(const std::string& name, const std::string& lock = "lock") {
    fs::path folder = place_.path() / name;
    fs::create_directory(folder);
    fs::permissions(folder, fs::perms::owner_all);
    std::ofstream(folder / "scene.data") << "grains";
    if (!lock.empty()) std::ofstream(folder / lock) << "";
    return folder;
  }

  const TemporaryFolder place_;
  const Variable tmpdir_{"TMPDIR", place_.path()};
};

TEST_F(Scratch, IsRemovedWithItsOwner) {
  fs::path path;
  {
    const ScratchFolder folder;
    path = folder.path();
    EXPECT_TRUE(fs::is_directory(path));
    EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_all);
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST_F(Scratch, OfADeadOwnerIsRemoved) {
  const fs::path dead = left_behind("shearcell-lammps-abcXYZ");
  remove_abandoned_folders();
  EXPECT_FALSE(fs::exists(dead));
}

TEST_F(Scratch, OfALivingOwnerStays) {
  const ScratchFolder living;
  std::ofstream(living.path() / "deck.in") << "units lj";
  remove_abandoned_folders();
  EXPECT_TRUE(fs::exists(living.path() / "deck.in"));
}

TEST_F(Scratch, NothingElseIsRemoved) {
  const fs::path elsewhere = left_behind("elsewhere");
  const fs::path file = place_.path() / "shearcell-lammps-a_file";
  std::ofstream(file) << "not a folder";
  const fs::path link = place_.path() / "shearcell-lammps-linked";
  fs::create_directory_symlink(elsewhere, link);
  const fs::path open_to_all = left_behind("shearcell-lammps-public");
  fs::permissions(open_to_all, fs::perms::all);
  const fs::path lock_elsewhere = left_behind("shearcell-lammps-lnlock", "");
  fs::create_symlink(elsewhere / "lock", lock_elsewhere / "lock");
  const fs::path without = left_behind("shearcell-lammps-nolock", "");
  const fs::path in_the_making = left_behind("shearcell-lammps-making", "lock.new");
  const fs::path too_long = left_behind("shearcell-lammps-toolong");
  const fs::path other = left_behind("other-lammps-abcdef");
  remove_abandoned_folders();
  for (const fs::path& path : {elsewhere / "scene.data", file, link, open_to_all, lock_elsewhere,
                               without, in_the_making, too_long, other}) {
    EXPECT_TRUE(fs::exists(path)) << path;
  }
}

}  // namespace
}  // namespace shearcell::test
