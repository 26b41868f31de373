// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/io/plain_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <system_error>

namespace shearcell {

namespace {

namespace fs = std::filesystem;

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

/// At most `most` bytes from the beginning of a regular file; nothing when it is not one.
std::optional<std::string> beginning_of(const fs::path& path, std::size_t most) {
  // O_NONBLOCK: opening a pipe must not wait for a writer.
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

std::optional<std::string> read_plain(const fs::path& path, std::size_t limit) {
  auto bytes = beginning_of(path, limit + 1);
  if (bytes && bytes->size() > limit) bytes.reset();
  return bytes;
}

void require_ours(const fs::path& path, const Recognize& ours) {
  std::error_code ignored;
  const fs::file_type type = fs::symlink_status(path, ignored).type();
  if (type == fs::file_type::not_found) return;
  if (type != fs::file_type::regular) {
    throw NotOurs(path.string() +
                  ": this is a folder, link or device; remove it, or write elsewhere with --out");
  }
  const auto beginning = beginning_of(path, 4096);
  if (beginning && ours(*beginning)) return;
  throw NotOurs(path.string() +
                ": this file was not made by shearcell, so it is not overwritten; move it, or "
                "write elsewhere with --out");
}

void write_output(const fs::path& path, std::string_view bytes, Existing existing) {
  const fs::path parent = path.has_parent_path() ? path.parent_path() : ".";
  const Descriptor folder(open(parent.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  if (!folder.valid()) fail_on(path, "write");
  replace_file(folder, path, bytes_of(bytes), '.' + path.filename().string() + ".tmp-",
               Durability::renamed, existing);
}

NewFile::NewFile(const fs::path& path)
    : path_(path),
      file_(open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644)) {
  if (!file_.valid()) fail_on(path_, "write");
}

void NewFile::add(std::string_view text) {
  write_all(file_, bytes_of(text), path_);
}

}  // namespace shearcell
