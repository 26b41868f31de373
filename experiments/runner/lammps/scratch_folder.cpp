// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/lammps/scratch_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <string_view>
#include <system_error>

#include "experiments/runner/engine_error.hpp"

namespace shearcell {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "shearcell-lammps-";
constexpr std::string_view kPlaces = "XXXXXX";
constexpr const char* kLock = "lock";
constexpr const char* kNewLock = "lock.new";

fs::path make_folder() {
  std::string pattern = fs::temp_directory_path() / (std::string(kPrefix) += kPlaces);
  if (mkdtemp(pattern.data()) == nullptr) {
    throw EngineError("cannot make a temporary folder " + pattern + "; is TMPDIR writable?");
  }
  return pattern;
}

// Nobody can exchange the folder for another one meanwhile: that of temporary files is sticky, and
// this user owns it. Its lock is asked for through the folder that was looked at.
bool abandoned(const fs::path& path) {
  const Descriptor folder(open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  struct stat facts {};
  if (folder.number < 0 || fstat(folder.number, &facts) != 0) return false;
  if (facts.st_uid != geteuid() || (facts.st_mode & 07777) != S_IRWXU) return false;
  const Descriptor lock(
      openat(folder.number, kLock, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  return lock.number >= 0 && flock(lock.number, LOCK_EX | LOCK_NB) == 0;
}

}  // namespace

ScratchFolder::ScratchFolder()
    : path_(make_folder()),
      lock_(open((path_ / kNewLock).c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600)) {
  // It has its name when it is locked, so that no other process can take it before.
  std::error_code failure;
  if (lock_.number >= 0 && flock(lock_.number, LOCK_EX | LOCK_NB) == 0)
    fs::rename(path_ / kNewLock, path_ / kLock, failure);
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void remove_abandoned_folders() {
  std::error_code ignored;
  fs::directory_iterator entry(fs::temp_directory_path(ignored), ignored);
  for (const fs::directory_iterator end; !ignored && entry != end; entry.increment(ignored)) {
    const std::string name = entry->path().filename();
    if (!name.starts_with(kPrefix) || name.size() != kPrefix.size() + kPlaces.size()) continue;
    std::error_code kept;
    if (abandoned(entry->path())) fs::remove_all(entry->path(), kept);
  }
}

}  // namespace shearcell
