// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/io/descriptor.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

namespace shearcell {

Descriptor::Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}

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

void replace_file(const Descriptor& folder, const std::filesystem::path& path,
                  std::span<const std::byte> bytes, const std::string& temporary,
                  Durability durability, Existing existing) {
  static std::atomic<unsigned> counter = 0;
  std::string name;
  int number = -1;
  do {
    name = temporary + std::to_string(getpid()) + '-' + std::to_string(counter++);
    number = openat(folder.get(), name.c_str(),
                    O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644);
  } while (number < 0 && errno == EEXIST);
  if (number < 0) fail_on(path, "write");
  const Descriptor file(number);
  try {
    write_all(file, bytes, path);
    if (durability == Durability::synced) sync(file, path);
    const std::string last = path.filename();
    if (existing == Existing::replaced) {
      if (renameat(folder.get(), name.c_str(), folder.get(), last.c_str()) != 0) {
        fail_on(path, "rename the new file");
      }
    } else {
      if (linkat(folder.get(), name.c_str(), folder.get(), last.c_str(), 0) != 0) {
        fail_on(path, "write");
      }
      unlinkat(folder.get(), name.c_str(), 0);
    }
  } catch (...) {
    unlinkat(folder.get(), name.c_str(), 0);
    throw;
  }
  if (durability == Durability::synced) sync(folder, path);
}

}  // namespace shearcell
