// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/lammps/scratch_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string>
#include <string_view>
#include <system_error>

namespace shearcell {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "shearcell-lammps-";
constexpr const char* kLock = "lock";
constexpr const char* kNewLock = "lock.new";

// Another user cannot replace the folder between the check and the removal: the folder of temporary
// files is sticky, and this user owns the scratch folder.
bool abandoned(const fs::path& path) {
  const Descriptor folder(open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  struct stat facts {};
  if (!folder.valid() || fstat(folder.get(), &facts) != 0) return false;
  if (facts.st_uid != geteuid() || (facts.st_mode & 07777) != S_IRWXU) return false;
  const Descriptor lock(
      openat(folder.get(), kLock, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  return lock.valid() && flock(lock.get(), LOCK_EX | LOCK_NB) == 0;
}

}  // namespace

ScratchFolder::ScratchFolder()
    : folder_(std::string(kPrefix)),
      lock_(open((path() / kNewLock).c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600)) {
  // The file is renamed to `lock` only after it is locked, so no other process can lock it first.
  std::error_code failure;
  if (lock_.valid() && flock(lock_.get(), LOCK_EX | LOCK_NB) == 0)
    fs::rename(path() / kNewLock, path() / kLock, failure);
}

void remove_abandoned_folders() {
  std::error_code ignored;
  fs::directory_iterator entry(fs::temp_directory_path(ignored), ignored);
  for (const fs::directory_iterator end; !ignored && entry != end; entry.increment(ignored)) {
    const std::string name = entry->path().filename();
    if (!name.starts_with(kPrefix) || name.size() != kPrefix.size() + TemporaryFolder::kRandom)
      continue;
    std::error_code kept;
    if (abandoned(entry->path())) fs::remove_all(entry->path(), kept);
  }
}

}  // namespace shearcell
