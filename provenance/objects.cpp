// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/objects.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <system_error>
#include <utility>

#include "core/memory.hpp"
#include "provenance/errors.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {

namespace {

constexpr const char* kFolder = "objects";

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&&) = delete;
  ~Descriptor() {
    if (number_ >= 0) close(number_);
  }
  int get() const { return number_; }

 private:
  int number_;
};

[[noreturn]] void fail(const std::filesystem::path& path, const char* doing) {
  throw std::system_error(errno, std::generic_category(),
                          fmt::format("{}: cannot {}", path.string(), doing));
}

void sync(const Descriptor& file, const std::filesystem::path& path) {
  if (fsync(file.get()) != 0) fail(path, "write to disk (fsync)");
}

/// Opens a folder below another one, or makes it. Each step refuses links, so that nothing is read
/// or written outside the store.
Descriptor open_folder(const Descriptor& parent, const std::string& name,
                       const std::filesystem::path& path, bool create) {
  if (create) {
    if (mkdirat(parent.get(), name.c_str(), 0777) == 0) {
      sync(parent, path);
    } else if (errno != EEXIST) {
      fail(path, "make the folder");
    }
  }
  const int number =
      openat(parent.get(), name.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (number < 0) {
    if (errno == ENOTDIR || errno == ELOOP) {
      throw StoreDamaged(fmt::format(
          "{}: a folder of the store should stand here, and a file or a link does; remove it",
          path.string()));
    }
    if (errno != ENOENT) fail(path, "open the folder");
  }
  return Descriptor(number);
}

/// The folder of one object; its number is negative when it does not exist.
Descriptor open_object_folder(const std::filesystem::path& store, std::string_view sha256,
                              bool create) {
  Descriptor root(open(store.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (root.get() < 0) fail(store, "open the folder");
  Descriptor objects = open_folder(root, kFolder, store / kFolder, create);
  if (objects.get() < 0) return objects;
  const std::string two(sha256.substr(0, 2));
  return open_folder(objects, two, store / kFolder / two, create);
}

void write_all(const Descriptor& file, std::span<const std::byte> bytes,
               const std::filesystem::path& path) {
  while (!bytes.empty()) {
    const ssize_t written = write(file.get(), bytes.data(), bytes.size());
    if (written < 0) {
      if (errno == EINTR) continue;
      fail(path, "write");
    }
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

/// Fewer bytes than asked for when the file ends early.
std::vector<std::byte> read_all(const Descriptor& file, std::uint64_t size,
                                const std::filesystem::path& path) {
  std::vector<std::byte> bytes(size);
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = read(file.get(), bytes.data() + done, bytes.size() - done);
    if (count < 0) {
      if (errno == EINTR) continue;
      fail(path, "read");
    }
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  bytes.resize(done);
  return bytes;
}

/// A file of its own in the folder, under a name that no object has.
std::pair<Descriptor, std::string> create_temporary(const Descriptor& folder,
                                                    const std::filesystem::path& path) {
  static std::atomic<unsigned> counter = 0;
  for (;;) {
    std::string name = fmt::format(".tmp-{}-{}", getpid(), counter++);
    const int number = openat(folder.get(), name.c_str(),
                              O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644);
    if (number >= 0) return {Descriptor(number), std::move(name)};
    if (errno != EEXIST) fail(path / name, "create");
  }
}

}  // namespace

ObjectStore::ObjectStore(std::filesystem::path store_folder) : folder_(std::move(store_folder)) {}

std::string ObjectStore::file_of(std::string_view sha256) {
  return fmt::format("{}/{}/{}.h5", kFolder, sha256.substr(0, 2), sha256);
}

ObjectInfo ObjectStore::put(std::span<const std::byte> bytes) {
  ObjectInfo info{.file = {}, .sha256 = sha256_hex(bytes), .size = bytes.size()};
  info.file = file_of(info.sha256);
  const std::filesystem::path path = folder_ / info.file;
  const Descriptor folder = open_object_folder(folder_, info.sha256, true);
  try {
    get(info.sha256, info.size);
    sync(folder, path);  // whoever wrote it may have been killed before this
    return info;
  } catch (const StoreDamaged&) {
    // Missing or damaged: written below.
  }
  const auto [file, temporary] = create_temporary(folder, path.parent_path());
  try {
    write_all(file, bytes, path);
    sync(file, path);
    if (renameat(folder.get(), temporary.c_str(), folder.get(), path.filename().c_str()) != 0) {
      fail(path, "give the file its name");
    }
  } catch (...) {
    unlinkat(folder.get(), temporary.c_str(), 0);
    throw;
  }
  sync(folder, path);
  return info;
}

std::vector<std::byte> ObjectStore::get(std::string_view sha256, std::uint64_t size) const {
  const auto damaged = [&](const std::string& why) {
    return StoreDamaged(
        fmt::format("{}: {}; restore the file from a backup, or let `resume` go on from an older "
                    "checkpoint",
                    (folder_ / file_of(sha256)).string(), why));
  };
  if (!is_sha256_hex(sha256)) throw damaged("the log names it by something that is no SHA-256");
  const std::filesystem::path path = folder_ / file_of(sha256);
  const Descriptor folder = open_object_folder(folder_, sha256, false);
  if (folder.get() < 0) throw damaged("the file is missing");
  // O_NONBLOCK: opening a pipe that somebody put there must not wait for a writer.
  const Descriptor file(openat(folder.get(), path.filename().c_str(),
                               O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (file.get() < 0) {
    if (errno == ENOENT) throw damaged("the file is missing");
    if (errno == ELOOP) throw damaged("a symbolic link stands in its place");
    fail(path, "open");
  }
  struct stat status {};
  if (fstat(file.get(), &status) != 0) fail(path, "examine");
  if (!S_ISREG(status.st_mode)) throw damaged("it is not a regular file");
  const auto found = static_cast<std::uint64_t>(status.st_size);
  if (found != size) throw damaged(fmt::format("it has {} bytes instead of {}", found, size));
  // A file with holes may claim more than any disk has. Decoding takes a few copies.
  if (static_cast<double>(size) > machine_memory() / 4) {
    throw std::runtime_error(fmt::format(
        "{}: its {} bytes do not fit into the memory of this machine", path.string(), size));
  }
  std::vector<std::byte> bytes = read_all(file, size, path);
  if (sha256_hex(bytes) != sha256) {
    throw damaged("its SHA-256 is not the recorded one, so its content was changed");
  }
  return bytes;
}

bool ObjectStore::contains(std::string_view sha256) const {
  if (!is_sha256_hex(sha256)) return false;
  const Descriptor folder = open_object_folder(folder_, sha256, false);
  const std::string name = std::filesystem::path(file_of(sha256)).filename();
  struct stat status {};
  return folder.get() >= 0 &&
         fstatat(folder.get(), name.c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0;
}

bool ObjectStore::remove(std::string_view sha256) {
  if (!is_sha256_hex(sha256)) return false;
  const std::filesystem::path path = folder_ / file_of(sha256);
  const Descriptor folder = open_object_folder(folder_, sha256, false);
  if (folder.get() < 0) return false;
  if (unlinkat(folder.get(), path.filename().c_str(), 0) != 0) {
    if (errno == ENOENT) return false;
    fail(path, "remove the file");
  }
  sync(folder, path);
  return true;
}

std::vector<std::string> ObjectStore::strangers(const std::set<std::string>& known) const {
  namespace fs = std::filesystem;
  std::set<std::string> expected;
  for (const std::string& sha256 : known) expected.insert(file_of(sha256));
  std::vector<std::string> found;
  const fs::path objects = folder_ / kFolder;
  if (!fs::is_directory(fs::symlink_status(objects))) return found;
  const auto note = [&](const fs::path& path) {
    const std::string file = path.lexically_relative(folder_).generic_string();
    if (!expected.contains(file)) found.push_back(file);
  };
  for (const fs::directory_entry& entry : fs::directory_iterator(objects)) {
    if (!fs::is_directory(entry.symlink_status())) {
      note(entry.path());
      continue;
    }
    for (const fs::directory_entry& file : fs::directory_iterator(entry.path())) note(file.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace shearcell
