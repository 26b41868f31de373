// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/io/file.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <utility>

#include "provenance/io/read_number.hpp"

namespace shearcell {

namespace {

namespace fs = std::filesystem;

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

/// Up to `most` bytes from the beginning of a file; nothing if it is not a readable regular file.
std::optional<std::string> beginning_of(const fs::path& path, std::size_t most) {
  // Without O_NONBLOCK, opening a named pipe would wait for a writer.
  const Descriptor file(open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  struct stat status {};
  if (!file.valid() || fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode)) {
    return std::nullopt;
  }
  try {
    const auto bytes =
        read_all(file, std::min(most, static_cast<std::size_t>(status.st_size)), path);
    return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  } catch (const std::system_error&) {
    return std::nullopt;
  }
}

}  // namespace

Descriptor::Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  std::swap(number_, other.number_);
  return *this;
}

Descriptor::~Descriptor() {
  if (number_ >= 0) close(number_);
}

void fail_on(const std::filesystem::path& path, const std::string& doing) {
  throw std::system_error(errno, std::generic_category(), path.string() + ": cannot " + doing);
}

void write_all(const Descriptor& file, std::span<const std::byte> bytes,
               const std::filesystem::path& path) {
  while (!bytes.empty()) {
    const ssize_t written = write(file.get(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_on(path, "write");
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

std::vector<std::byte> read_all(const Descriptor& file, std::size_t size,
                                const std::filesystem::path& path) {
  std::vector<std::byte> bytes(size);
  std::size_t done = 0;
  while (done < size) {
    const ssize_t count = read(file.get(), bytes.data() + done, size - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail_on(path, "read");
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  bytes.resize(done);
  return bytes;
}

void sync(const Descriptor& file, const std::filesystem::path& path) {
  if (fsync(file.get()) != 0) fail_on(path, "write to disk (fsync)");
}

void remove_leftovers(const fs::path& folder, bool below) {
  constexpr std::string_view mark = ".tmp-";
  std::error_code ignored;
  fs::recursive_directory_iterator entry(folder, ignored);
  for (; entry != fs::recursive_directory_iterator(); entry.increment(ignored)) {
    const fs::path path = entry->path();
    const std::string name = path.filename();
    const std::size_t at = name.rfind(mark), from = at + mark.size(), last = name.rfind('-');
    if (!below || name[0] == '.') entry.disable_recursion_pending();
    if (name[0] != '.' || at == name.npos || last <= from) continue;
    const auto pid = read_number<pid_t>(std::string_view(name).substr(from, last - from));
    if (!pid || *pid < 1 || kill(*pid, 0) == 0 || errno != ESRCH) continue;
    const Descriptor file(open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    if (flock(file.get(), LOCK_EX | LOCK_NB) == 0) fs::remove_all(path, ignored);
  }
}

void replace_file(const Descriptor& folder, const std::filesystem::path& path,
                  std::span<const std::byte> bytes, bool synced) {
  static std::atomic<unsigned> counter = 0;
  std::string name;
  int number = -1;
  do {
    name = ".tmp-" + std::to_string(getpid()) + '-' + std::to_string(counter++);
    number = openat(folder.get(), name.c_str(),
                    O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  } while (number < 0 && errno == EEXIST);
  if (number < 0) fail_on(path, "write");
  const Descriptor file(number);
  flock(file.get(), LOCK_EX);  // tells remove_leftovers() that the file is in use
  try {
    write_all(file, bytes, path);
    if (synced) sync(file, path);
    if (renameat(folder.get(), name.c_str(), folder.get(), path.filename().c_str()) != 0) {
      fail_on(path, "rename the new file");
    }
  } catch (...) {
    unlinkat(folder.get(), name.c_str(), 0);
    throw;
  }
  if (synced) sync(folder, path);
}

std::optional<std::string> read_plain(const fs::path& path, std::size_t limit) {
  auto bytes = beginning_of(path, limit + 1);
  if (bytes && bytes->size() > limit) bytes.reset();
  return bytes;
}

void require_ours(const fs::path& path, const std::function<bool(std::string_view)>& ours) {
  std::error_code failure;
  const fs::file_type type = fs::symlink_status(path, failure).type();
  if (type == fs::file_type::not_found) return;
  if (failure) throw std::system_error(failure, path.string() + ": cannot write");
  if (type != fs::file_type::regular) {
    throw NotOurs(path.string() +
                  ": this is a folder, link or device, but the output is a file; choose another "
                  "path with --out");
  }
  const auto beginning = beginning_of(path, 4096);
  if (beginning && ours(*beginning)) return;
  throw NotOurs(path.string() +
                ": this file was not made by shearcell, so it is not overwritten; move it, or "
                "write elsewhere with --out");
}

void write_output(const fs::path& path, std::string_view bytes) {
  const fs::path parent = path.has_parent_path() ? path.parent_path() : ".";
  std::error_code ignored;  // if create_directories() fails, open() reports the reason
  fs::create_directories(parent, ignored);
  const Descriptor folder(open(parent.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  if (!folder.valid()) fail_on(path, "write");
  remove_leftovers(parent);
  replace_file(folder, path, bytes_of(bytes), false);
}

void append(const fs::path& path, std::string_view text) {
  constexpr int flags = O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW | O_CLOEXEC;
  const Descriptor file(open(path.c_str(), flags, 0666));
  if (!file.valid()) fail_on(path, "write");
  write_all(file, bytes_of(text), path);
}

TemporaryFolder::TemporaryFolder(const std::string& prefix) {
  const bool named = fs::path(prefix).is_absolute();
  const char* set = std::getenv("TMPDIR");
  const fs::path whole = fs::path(set != nullptr && *set != '\0' ? set : "/tmp") /
                         (prefix + std::to_string(getpid()) + "-XXXXXX");
  remove_leftovers(whole.parent_path());
  std::string pattern = whole;
  if (mkdtemp(pattern.data()) == nullptr) {
    fail_on(whole.parent_path(),
            named ? "make a temporary folder in it"
                  : "make a temporary folder in it (set TMPDIR to use another folder)");
  }
  path_ = pattern;
  flock(held_.emplace(open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)).get(), LOCK_EX);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace shearcell
