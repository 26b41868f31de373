// SPDX-License-Identifier: GPL-3.0-or-later
// Reading and writing files. Output files (figures, reports, exports) are never written through a
// link or over a file that this program did not make.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
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
  synced    ///< and the new file survives a power cut
};

/// Deletes temporary files and folders (".*.tmp-<pid>-*") that killed programs left in the folder,
/// with `below` also in the folders in it: the process has ended, and no process, as of another
/// container, holds the lock.
void remove_leftovers(const std::filesystem::path& folder, bool below = false);

/// Writes a file under a temporary name in the open `folder` (`temporary` + "<pid>-<n>", mode 0666
/// less umask). Then renames the file to the last part of `path`, in place of a file or link of
/// that name. On any error deletes the temporary file and throws as fail_on does.
void replace_file(const Descriptor& folder, const std::filesystem::path& path,
                  std::span<const std::byte> bytes, const std::string& temporary,
                  Durability durability);

/// The output path is occupied by something that this program did not make.
class NotOurs : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The bytes of a regular file of at most `limit` bytes; nothing when it is missing, a link, a pipe
/// or larger, or cannot be read.
std::optional<std::string> read_plain(const std::filesystem::path& path, std::size_t limit);

/// Recognizes a file of this program by its first 4096 bytes.
using Recognize = std::function<bool(std::string_view beginning)>;

/// Throws NotOurs unless the path is free or a regular file that `ours` recognizes, and
/// std::system_error when this user may not read the file.
void require_ours(const std::filesystem::path& path, const Recognize& ours);

/// Writes a whole file under a temporary name beside `path`, whose folder is created if it is
/// missing, and renames it (replace_file).
void write_output(const std::filesystem::path& path, std::string_view bytes);

/// A new file that is written in parts; an existing file is never overwritten. If writing fails,
/// both functions delete the file and throw std::system_error, which names it.
class NewFile {
 public:
  explicit NewFile(const std::filesystem::path& path);
  void add(std::string_view text);

 private:
  std::filesystem::path path_;
  Descriptor file_;
};

/// A new folder PREFIX + "<pid>-" + six random characters, in the folder for temporary files
/// (TMPDIR) unless the prefix is an absolute path; remove_leftovers() is called there. The folder
/// is readable by this user only, and deleted with its content at the end of the object's life. The
/// constructor throws std::system_error, which names the folder.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const std::string& prefix = ".shearcell.tmp-");
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::optional<Descriptor> held_;  ///< a lock: the folder is in use
};

}  // namespace shearcell
