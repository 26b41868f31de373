// SPDX-License-Identifier: GPL-3.0-or-later
// Preloaded into the program under test (LD_PRELOAD): replaces the C library's file functions, also
// for SQLite, counts the calls that touch one folder, and makes one of them fail.
//
//   FAULT_FOLDER  absolute path; calls on other files pass through, uncounted
//   FAULT_AT      number of the call that fails, from 1; 0: no call
//   FAULT_KIND    kill    the process dies instead of the call
//                 enospc  the call fails with "no space left on device"; so does every later write
//                 eio     the call fails with "input/output error"
//                 torn    a write puts down its first half, then the process dies
//                 lost    a write says it succeeded and does nothing; the process dies at the next
//                         sync of that file, as after a power cut before the bytes had reached it
//   FAULT_READS   calls that read count too
//   FAULT_COUNT   file that gets one line for each counted call: its name and the file's
#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <string_view>

namespace {

/// The C library's own function of this name.
template <typename Result, typename... Args>
Result real(const char* name, Args... args) {
  return reinterpret_cast<Result (*)(Args...)>(dlsym(RTLD_NEXT, name))(args...);
}

enum class Kind { none, kill, enospc, eio, torn, lost };

struct Settings {
  const char* folder = std::getenv("FAULT_FOLDER");
  const char* count = std::getenv("FAULT_COUNT");
  bool reads = std::getenv("FAULT_READS") != nullptr;
  long at = std::getenv("FAULT_AT") ? std::atol(std::getenv("FAULT_AT")) : 0;
  Kind kind = Kind::none;
  int log = -1;
};

Kind kind_of(const char* name) {
  constexpr std::string_view names[] = {"none", "kill", "enospc", "eio", "torn", "lost"};
  const auto* found = std::find(std::begin(names), std::end(names), name ? name : "none");
  return found == std::end(names) ? Kind::none : static_cast<Kind>(found - names);
}

Settings& settings() {
  static Settings all = [] {
    Settings fresh;
    fresh.kind = kind_of(std::getenv("FAULT_KIND"));
    if (fresh.count) {
      fresh.log = open(fresh.count, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
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
    if (length > 0) {
      real<ssize_t, int, const void*, size_t>("write", s.log, line, static_cast<size_t>(length));
    }
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

// `write_some` writes so many of the bytes.
template <typename Write>
ssize_t faulty_write(const char* call, int fd, size_t size, Write&& write_some) {
  const OpenFile file(fd);
  if (!file) return write_some(size);
  const bool now = chosen(call, file.path);
  const Kind kind = settings().kind;
  if (disk_full || (now && (kind == Kind::enospc || kind == Kind::eio))) {
    disk_full = kind == Kind::enospc;
    errno = kind == Kind::enospc ? ENOSPC : EIO;
    return -1;
  }
  if (!now || kind == Kind::none) return write_some(size);
  if (kind == Kind::lost) {
    lost_file = inode(fd);
    return static_cast<ssize_t>(size);
  }
  if (kind == Kind::torn) write_some(size / 2);
  die();
}

template <typename Offset>
ssize_t faulty_pwrite(const char* call, int fd, const void* bytes, size_t size, Offset at) {
  return faulty_write(call, fd, size, [&](size_t part) {
    return real<ssize_t, int, const void*, size_t, Offset>(call, fd, bytes, part, at);
  });
}

ssize_t faulty_read(const char* call, int fd, void* bytes, size_t size, off_t at = -1) {
  if (settings().reads) {
    const OpenFile file(fd);
    if (file && goes_wrong(call, file.path)) return -1;
  }
  return at < 0 ? real<ssize_t, int, void*, size_t>(call, fd, bytes, size)
                : real<ssize_t, int, void*, size_t, off_t>(call, fd, bytes, size, at);
}

int faulty_sync(const char* call, int fd) {
  const OpenFile file(fd);
  if (file) {
    if (lost_file != 0 && inode(fd) == lost_file) die();
    if (goes_wrong(call, file.path)) return -1;
  }
  return real<int, int>(call, fd);
}

template <typename Offset>
int faulty_truncate(const char* call, int fd, Offset size) {
  const OpenFile file(fd);
  return file && goes_wrong(call, file.path) ? -1 : real<int, int, Offset>(call, fd, size);
}

// A call whose first argument is a path.
template <typename... Args>
int faulty_path(const char* call, const char* path, Args... rest) {
  if (path && is_ours(path) && goes_wrong(call, path)) return -1;
  return real<int, const char*, Args...>(call, path, rest...);
}

// A call whose first arguments are an open folder and a name in it.
template <typename... Args>
int faulty_at(const char* call, int folder, const char* name, Args... rest) {
  const bool absolute = name && name[0] == '/';
  const OpenFile parent(folder);
  if ((absolute ? is_ours(name) : bool(parent)) && goes_wrong(call, name)) return -1;
  return real<int, int, const char*, Args...>(call, folder, name, rest...);
}

}  // namespace

extern "C" {

ssize_t write(int fd, const void* bytes, size_t size) {
  return faulty_write("write", fd, size, [&](size_t part) {
    return real<ssize_t, int, const void*, size_t>("write", fd, bytes, part);
  });
}

ssize_t pwrite(int fd, const void* bytes, size_t size, off_t at) {
  return faulty_pwrite("pwrite", fd, bytes, size, at);
}

ssize_t pwrite64(int fd, const void* bytes, size_t size, off64_t at) {
  return faulty_pwrite("pwrite64", fd, bytes, size, at);
}

ssize_t read(int fd, void* bytes, size_t size) {
  return faulty_read("read", fd, bytes, size);
}

ssize_t pread(int fd, void* bytes, size_t size, off_t at) {
  return faulty_read("pread", fd, bytes, size, at);
}

ssize_t pread64(int fd, void* bytes, size_t size, off64_t at) {
  return faulty_read("pread64", fd, bytes, size, at);
}

int openat(int folder, const char* name, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(more, mode_t) : 0;
  va_end(more);
  return settings().reads
             ? faulty_at("openat", folder, name, flags, mode)
             : real<int, int, const char*, int, mode_t>("openat", folder, name, flags, mode);
}

int fsync(int fd) {
  return faulty_sync("fsync", fd);
}

int fdatasync(int fd) {
  return faulty_sync("fdatasync", fd);
}

int ftruncate(int fd, off_t size) noexcept {
  return faulty_truncate("ftruncate", fd, size);
}

int ftruncate64(int fd, off64_t size) noexcept {
  return faulty_truncate("ftruncate64", fd, size);
}

int close(int fd) {
  const OpenFile file(fd);
  const bool wrong = file && goes_wrong("close", file.path);
  const int error = errno;
  const int result = real<int, int>("close", fd);  // Linux closes it even when it reports an error
  if (wrong) errno = error;
  return wrong ? -1 : result;
}

int unlink(const char* path) noexcept {
  return faulty_path("unlink", path);
}

int unlinkat(int folder, const char* name, int flags) noexcept {
  return faulty_at("unlinkat", folder, name, flags);
}

int rename(const char* from, const char* to) noexcept {
  return faulty_path("rename", from, to);
}

int renameat(int from_folder, const char* from, int to_folder, const char* to) noexcept {
  return faulty_at("renameat", from_folder, from, to_folder, to);
}

int renameat2(int from_folder, const char* from, int to_folder, const char* to,
              unsigned flags) noexcept {
  return faulty_at("renameat2", from_folder, from, to_folder, to, flags);
}

int mkdir(const char* path, mode_t mode) noexcept {
  return faulty_path("mkdir", path, mode);
}

int mkdirat(int folder, const char* name, mode_t mode) noexcept {
  return faulty_at("mkdirat", folder, name, mode);
}

}  // extern "C"
