// SPDX-License-Identifier: GPL-3.0-or-later
// Where LAMMPS runs.
#pragma once

#include <filesystem>

#include "provenance/io/file.hpp"

namespace shearcell {

/// A temporary folder `shearcell-lammps-XXXXXX` in which LAMMPS works. Its file `lock` is locked
/// while the owner lives, so that folders of killed owners can be recognized.
class ScratchFolder {
 public:
  /// Throws std::system_error.
  ScratchFolder();
  const std::filesystem::path& path() const { return folder_.path(); }

 private:
  TemporaryFolder folder_;
  Descriptor lock_;
};

/// Deletes leftover scratch folders of this user that are not locked. Links, other names and
/// folders without a lock are kept.
void remove_abandoned_folders();

}  // namespace shearcell
