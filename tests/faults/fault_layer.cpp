// SPDX-License-Identifier: GPL-3.0-or-later
// Preloaded into the program under test (LD_PRELOAD): stands between it, SQLite included, and the
// C library's file functions, counts the calls that touch one folder, and lets one of them fail.
//
//   FAULT_FOLDER  absolute path; calls on other files pass through, uncounted
//   FAULT_AT      number of the call that goes wrong, from 1; 0 for none
//   FAULT_KIND    kill    the process dies instead of the call
//                 enospc  the call fails with "no space left on device"; so does every later write
//                 eio     the call fails with "input/output error"
//                 torn    a write puts down its first half, then the process dies
//                 lost    a write says it succeeded and does nothing; the process dies at the next
//                         sync of that file, as after a power cut before the bytes had reached it
//   FAULT_COUNT   file that gets one line for each counted call: its name and the file's
#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>

namespace {

template <typename Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

enum class Kind { none, kill, enospc, eio, torn, lost };

struct Settings {
  const char* folder = std::getenv("FAULT_FOLDER");
  const char* count = std::getenv("FAULT_COUNT");
  long at = std::getenv("FAULT_AT") ? std::atol(std::getenv("FAULT_AT")) : 0;
  Kind kind = Kind::none;
  int log = -1;
};

Kind kind_of(const char* name) {
  const std::string_view text = name ? name : "";
  if (text == "kill") return Kind::kill;
  if (text == "enospc") return Kind::enospc;
  if (text == "eio") return Kind::eio;
  if (text == "torn") return Kind::torn;
  if (text == "lost") return Kind::lost;
  return Kind::none;
}

Settings& settings() {
  static Settings all = [] {
    Settings fresh;
    fresh.kind = kind_of(std::getenv("FAULT_KIND"));
    if (fresh.count) {
      fresh.log = next<int(const char*, int, ...)>("open")(
          fresh.count, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    }
    return fresh;
  }();
  return all;
}

std::atomic<long> calls{0};
std::atomic<bool> disk_full{false};
std::atomic<ino_t> lost_file{0};

[[noreturn]] void die() {
  raise(SIGKILL);
  _exit(99);
}

bool is_ours(std::string_view path) {
  const char* folder = settings().folder;
  return folder && path.starts_with(folder);
}

// The file's path, or "" when the descriptor is outside the folder.
struct OpenFile {
  char path[PATH_MAX] = "";

  explicit OpenFile(int fd) {
    char link[64];
    std::snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    const ssize_t length = readlink(link, path, sizeof path - 1);
    path[length > 0 ? length : 0] = '\0';
    if (!is_ours(path)) path[0] = '\0';
  }
  explicit operator bool() const { return path[0] != '\0'; }
};

// Whether this call is the one that goes wrong.
bool chosen(const char* call, const char* path) {
  const long number = ++calls;
  const Settings& s = settings();
  if (s.log >= 0) {
    char line[PATH_MAX + 64];
    const int length = std::snprintf(line, sizeof line, "%ld %s %s\n", number, call, path);
    static auto* write_out = next<ssize_t(int, const void*, size_t)>("write");
    if (length > 0) write_out(s.log, line, static_cast<size_t>(length));
  }
  return number == s.at;
}

ino_t inode(int fd) {
  struct stat status {};
  return fstat(fd, &status) == 0 ? status.st_ino : 0;
}

// What every call but a write does when it is chosen: true when it is to fail with errno.
bool goes_wrong(const char* call, const char* path) {
  if (!chosen(call, path)) return false;
  switch (settings().kind) {
    case Kind::none:
      return false;
    case Kind::enospc:
      errno = ENOSPC;
      return true;
    case Kind::eio:
      errno = EIO;
      return true;
    default:
      die();
  }
}

// Bytes to report, -1 to fail with errno, or -2 to let the call pass.
template <typename Write>
ssize_t wrong_write(const char* call, int fd, size_t size, Write&& write_some) {
  const OpenFile file(fd);
  if (!file) return -2;
  const bool now = chosen(call, file.path);
  if (disk_full && settings().kind == Kind::enospc) {
    errno = ENOSPC;
    return -1;
  }
  if (!now) return -2;
  switch (settings().kind) {
    case Kind::none:
      return -2;
    case Kind::kill:
      die();
    case Kind::enospc:
      disk_full = true;
      errno = ENOSPC;
      return -1;
    case Kind::eio:
      errno = EIO;
      return -1;
    case Kind::torn:
      write_some(size / 2);
      die();
    case Kind::lost:
      lost_file = inode(fd);
      return static_cast<ssize_t>(size);
  }
  return -2;
}

int wrong_sync(const char* call, int fd, int (*real)(int)) {
  const OpenFile file(fd);
  if (file) {
    if (lost_file != 0 && inode(fd) == lost_file) die();
    if (goes_wrong(call, file.path)) return -1;
  }
  return real(fd);
}

bool wrong_path(const char* call, const char* path) {
  return path && is_ours(path) && goes_wrong(call, path);
}

bool wrong_at(const char* call, int folder, const char* name) {
  if (name && name[0] == '/') return wrong_path(call, name);
  const OpenFile parent(folder);
  return parent && goes_wrong(call, name);
}

}  // namespace

extern "C" {

ssize_t write(int fd, const void* bytes, size_t size) {
  static auto* real = next<ssize_t(int, const void*, size_t)>("write");
  const ssize_t wrong =
      wrong_write("write", fd, size, [&](size_t part) { return real(fd, bytes, part); });
  return wrong == -2 ? real(fd, bytes, size) : wrong;
}

ssize_t pwrite(int fd, const void* bytes, size_t size, off_t at) {
  static auto* real = next<ssize_t(int, const void*, size_t, off_t)>("pwrite");
  const ssize_t wrong =
      wrong_write("pwrite", fd, size, [&](size_t part) { return real(fd, bytes, part, at); });
  return wrong == -2 ? real(fd, bytes, size, at) : wrong;
}

ssize_t pwrite64(int fd, const void* bytes, size_t size, off64_t at) {
  static auto* real = next<ssize_t(int, const void*, size_t, off64_t)>("pwrite64");
  const ssize_t wrong =
      wrong_write("pwrite64", fd, size, [&](size_t part) { return real(fd, bytes, part, at); });
  return wrong == -2 ? real(fd, bytes, size, at) : wrong;
}

int fsync(int fd) {
  static auto* real = next<int(int)>("fsync");
  return wrong_sync("fsync", fd, real);
}

int fdatasync(int fd) {
  static auto* real = next<int(int)>("fdatasync");
  return wrong_sync("fdatasync", fd, real);
}

int ftruncate(int fd, off_t size) noexcept {
  static auto* real = next<int(int, off_t)>("ftruncate");
  const OpenFile file(fd);
  return file && goes_wrong("ftruncate", file.path) ? -1 : real(fd, size);
}

int ftruncate64(int fd, off64_t size) noexcept {
  static auto* real = next<int(int, off64_t)>("ftruncate64");
  const OpenFile file(fd);
  return file && goes_wrong("ftruncate64", file.path) ? -1 : real(fd, size);
}

int close(int fd) {
  static auto* real = next<int(int)>("close");
  const OpenFile file(fd);
  if (!file || !goes_wrong("close", file.path)) return real(fd);
  const int error = errno;
  real(fd);  // Linux closes the descriptor even when it reports an error
  errno = error;
  return -1;
}

int unlink(const char* path) noexcept {
  static auto* real = next<int(const char*)>("unlink");
  return wrong_path("unlink", path) ? -1 : real(path);
}

int unlinkat(int folder, const char* name, int flags) noexcept {
  static auto* real = next<int(int, const char*, int)>("unlinkat");
  return wrong_at("unlinkat", folder, name) ? -1 : real(folder, name, flags);
}

int rename(const char* from, const char* to) noexcept {
  static auto* real = next<int(const char*, const char*)>("rename");
  return wrong_path("rename", from) ? -1 : real(from, to);
}

int renameat(int from_folder, const char* from, int to_folder, const char* to) noexcept {
  static auto* real = next<int(int, const char*, int, const char*)>("renameat");
  return wrong_at("renameat", from_folder, from) ? -1 : real(from_folder, from, to_folder, to);
}

int mkdir(const char* path, mode_t mode) noexcept {
  static auto* real = next<int(const char*, mode_t)>("mkdir");
  return wrong_path("mkdir", path) ? -1 : real(path, mode);
}

int mkdirat(int folder, const char* name, mode_t mode) noexcept {
  static auto* real = next<int(int, const char*, mode_t)>("mkdirat");
  return wrong_at("mkdirat", folder, name) ? -1 : real(folder, name, mode);
}

}  // extern "C"
