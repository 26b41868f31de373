// SPDX-License-Identifier: GPL-3.0-or-later
// A temporary folder in which another program works; it does not outlive its owner for long.
#pragma once

#include <filesystem>

#include "provenance/io/child_process.hpp"

namespace shearcell {

/// An empty folder `shearcell-lammps-XXXXXX` under the system's own for temporary files; it goes
/// away with the object. A file `lock` in it is locked as long as its owner lives, so that what a
/// killed one left behind can be told.
class ScratchFolder {
 public:
  /// Throws EngineError.
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  Descriptor lock_;
};

/// Removes such folders of this user whose owners are gone: those whose lock can be taken. Links,
/// other names and folders without a lock stay.
void remove_abandoned_folders();

}  // namespace shearcell
