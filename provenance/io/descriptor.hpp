// SPDX-License-Identifier: GPL-3.0-or-later
// An open file, and reading and writing it whole.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace shearcell {

/// Owns a file descriptor and closes it at the end. A negative number stands for no file.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept;
  Descriptor& operator=(Descriptor&&) = delete;
  ~Descriptor();
  int get() const { return number_; }
  bool valid() const { return number_ >= 0; }

 private:
  int number_;
};

/// Throws std::system_error: "PATH: cannot DOING: the reason in errno".
[[noreturn]] void fail_on(const std::filesystem::path& path, const std::string& doing);

/// Writes all bytes; throws as fail_on does. `path` is for the message.
void write_all(const Descriptor& file, std::span<const std::byte> bytes,
               const std::filesystem::path& path);
/// The next `size` bytes, or fewer when the file ends before. Throws as fail_on does.
std::vector<std::byte> read_all(const Descriptor& file, std::size_t size,
                                const std::filesystem::path& path);
/// fsync of a file or a folder.
void sync(const Descriptor& file, const std::filesystem::path& path);

enum class Durability {
  renamed,  ///< a reader sees the old file or the whole new one
  synced    ///< and it survives a power cut: file and folder are synced
};

enum class Existing {
  replaced,  ///< a file or link of the same name
  kept       ///< it is an error: errno EEXIST
};

/// Writes a file under a temporary name in the open `folder` (`temporary` + "<pid>-<n>", mode 0644
/// less umask), then gives it the last part of `path` as its name. On any error the temporary file
/// is deleted and fail_on's exception thrown.
void replace_file(const Descriptor& folder, const std::filesystem::path& path,
                  std::span<const std::byte> bytes, const std::string& temporary,
                  Durability durability, Existing existing = Existing::replaced);

}  // namespace shearcell
