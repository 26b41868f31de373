// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/io/plain_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "provenance/errors.hpp"

namespace shearcell {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBeginning = 4096;

[[noreturn]] void cannot_be(const fs::path& path, const char* doing) {
  throw std::runtime_error(
      fmt::format("{}: cannot be {}: {}", path.string(), doing, std::strerror(errno)));
}

/// At most `most` bytes of a regular file from its beginning; nothing when it is none.
std::optional<std::string> beginning_of(const fs::path& path, std::size_t most) {
  // O_NONBLOCK: opening a pipe that somebody put there must not wait for a writer.
  const int number = open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (number < 0) return std::nullopt;
  struct stat status {};
  std::optional<std::string> bytes;
  if (fstat(number, &status) == 0 && S_ISREG(status.st_mode)) {
    bytes.emplace(std::min(most, static_cast<std::size_t>(status.st_size)), '\0');
    const ssize_t count = read(number, bytes->data(), bytes->size());
    bytes->resize(count < 0 ? 0 : static_cast<std::size_t>(count));
  }
  close(number);
  return bytes;
}

int create(const fs::path& path) {
  return open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644);
}

void write_all(int number, std::string_view bytes, const fs::path& path) {
  while (!bytes.empty()) {
    const ssize_t written = write(number, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) cannot_be(path, "written");
    bytes.remove_prefix(static_cast<std::size_t>(written));
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
    throw NotOurs(fmt::format(
        "{}: a folder, link or device stands there; remove it, or write elsewhere with --out",
        path.string()));
  }
  const auto beginning = beginning_of(path, kBeginning);
  if (beginning && ours(*beginning)) return;
  throw NotOurs(fmt::format(
      "{}: this file was not made by shearcell, so it is not overwritten; move it, or write "
      "elsewhere with --out",
      path.string()));
}

void write_output(const fs::path& path, std::string_view bytes) {
  static std::atomic<unsigned> counter = 0;
  fs::path temporary;
  int number = -1;
  do {
    temporary = path.parent_path() /
                fmt::format(".{}.tmp-{}-{}", path.filename().string(), getpid(), counter++);
    number = create(temporary);
  } while (number < 0 && errno == EEXIST);
  if (number < 0) cannot_be(path, "written");
  try {
    write_all(number, bytes, path);
    if (rename(temporary.c_str(), path.c_str()) != 0) cannot_be(path, "written");
  } catch (...) {
    close(number);
    unlink(temporary.c_str());
    throw;
  }
  close(number);
}

NewFile::NewFile(const fs::path& path) : path_(path), number_(create(path)) {
  if (number_ < 0) cannot_be(path_, "written");
}

NewFile::~NewFile() {
  close(number_);
}

void NewFile::add(std::string_view text) {
  write_all(number_, text, path_);
}

}  // namespace shearcell
