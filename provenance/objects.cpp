// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/objects.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "core/machine.hpp"
#include "provenance/errors.hpp"
#include "provenance/io/file.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {

namespace {

constexpr const char* kFolder = "objects";

/// Opens the folder of one object. If `create` is true, creates a missing folder; otherwise the
/// result is not valid() when the folder does not exist. Throws if a folder below the store is a
/// link, so nothing outside the store is read or written.
Descriptor open_object_folder(const std::filesystem::path& store, std::string_view sha256,
                              bool create) {
  constexpr int flags = O_RDONLY | O_DIRECTORY | O_CLOEXEC;
  Descriptor folder(open(store.c_str(), flags));
  if (!folder.valid()) fail_on(store, "open the folder");
  std::filesystem::path path = store;
  for (const std::string& name : {std::string(kFolder), std::string(sha256.substr(0, 2))}) {
    path /= name;
    if (create && mkdirat(folder.get(), name.c_str(), 0777) == 0) {
      sync(folder, path);
    } else if (create && errno != EEXIST) {
      fail_on(path, "make the folder");
    }
    Descriptor next(openat(folder.get(), name.c_str(), flags | O_NOFOLLOW));
    if (!next.valid() && (errno == ENOTDIR || errno == ELOOP)) {
      throw StoreDamaged(fmt::format(
          "{}: this must be a folder of the store, but it is a file or a link; remove it",
          path.string()));
    }
    if (!next.valid() && errno != ENOENT) fail_on(path, "open the folder");
    folder = std::move(next);
    if (!folder.valid()) break;
  }
  return folder;
}

}  // namespace

std::string ObjectStore::file_of(std::string_view sha256) {
  return fmt::format("{}/{}/{}.h5", kFolder, sha256.substr(0, 2), sha256);
}

std::string ObjectStore::put(std::span<const std::byte> bytes) {
  std::string sha256 = sha256_hex(bytes);
  const std::filesystem::path path = folder_ / file_of(sha256);
  const Descriptor folder = open_object_folder(folder_, sha256, true);
  try {
    get(sha256, bytes.size());
    sync(folder, path);  // the program that wrote the file may have been killed before the sync
    return sha256;
  } catch (const StoreDamaged&) {
    // The object is missing or damaged, so it is written below.
  }
  replace_file(folder, path, bytes, true);
  return sha256;
}

std::vector<std::byte> ObjectStore::get(std::string_view sha256, std::uint64_t size) const {
  const auto damaged = [&](const std::string& why) {
    return StoreDamaged(
        fmt::format("{}: {}; restore the file from a backup, or compute it again with `regenerate`",
                    (folder_ / file_of(sha256)).string(), why));
  };
  if (!is_sha256_hex(sha256)) throw damaged("the name in the log is not a SHA-256");
  const std::filesystem::path path = folder_ / file_of(sha256);
  const Descriptor folder = open_object_folder(folder_, sha256, false);
  if (!folder.valid()) throw damaged("the file is missing");
  // Without O_NONBLOCK, opening a named pipe would wait for a writer.
  const Descriptor file(openat(folder.get(), path.filename().c_str(),
                               O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (!file.valid()) {
    if (errno == ENOENT) throw damaged("the file is missing");
    if (errno == ELOOP) throw damaged("it is a symbolic link");
    fail_on(path, "open");
  }
  struct stat status {};
  if (fstat(file.get(), &status) != 0) fail_on(path, "examine");
  if (!S_ISREG(status.st_mode)) throw damaged("it is not a regular file");
  const auto found = static_cast<std::uint64_t>(status.st_size);
  if (found != size) throw damaged(fmt::format("it has {} bytes instead of {}", found, size));
  // The limit is a quarter of the memory, because decoding needs a few copies of the bytes.
  if (static_cast<double>(size) > machine_memory() / 4) {
    throw TooLittleMemory(fmt::format("{}: its {} bytes do not fit into the memory of this machine",
                                      path.string(), size));
  }
  std::vector<std::byte> bytes = read_all(file, size, path);
  if (sha256_hex(bytes) != sha256) {
    throw damaged("its content was changed: its SHA-256 is not the recorded one");
  }
  return bytes;
}

bool ObjectStore::contains(std::string_view sha256) const {
  if (!is_sha256_hex(sha256)) return false;
  const Descriptor folder = open_object_folder(folder_, sha256, false);
  const std::string name = std::filesystem::path(file_of(sha256)).filename();
  struct stat status {};
  return folder.valid() && fstatat(folder.get(), name.c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0;
}

bool ObjectStore::remove(std::string_view sha256) {
  if (!is_sha256_hex(sha256)) return false;
  const std::filesystem::path path = folder_ / file_of(sha256);
  const Descriptor folder = open_object_folder(folder_, sha256, false);
  if (!folder.valid()) return false;
  if (unlinkat(folder.get(), path.filename().c_str(), 0) != 0) {
    if (errno == ENOENT) return false;
    fail_on(path, "remove the file");
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
  const fs::recursive_directory_iterator end;
  // If a folder cannot be read, reading its objects fails, too, and `verify` reports that.
  for (fs::recursive_directory_iterator entry(objects,
                                              fs::directory_options::skip_permission_denied);
       entry != end; ++entry) {
    if (entry.depth() == 0 && fs::is_directory(entry->symlink_status())) continue;  // objects/ab
    entry.disable_recursion_pending();
    const std::string file = entry->path().lexically_relative(folder_).generic_string();
    if (!expected.contains(file)) found.push_back(file);
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace shearcell
