// SPDX-License-Identifier: GPL-3.0-or-later
// Reads and writes files. Output files (figures, reports, exports) are never written through a link
// or over a file that this program did not make.
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

/// Owns a file descriptor, which is negative if no file is open. The destructor closes the file.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept;
  Descriptor& operator=(Descriptor&& other) noexcept;
  ~Descriptor();
  int get() const { return number_; }
  bool valid() const { return number_ >= 0; }

 private:
  int number_;
};

/// Throws std::system_error with the message "PATH: cannot DOING: REASON"; errno gives the reason.
[[noreturn]] void fail_on(const std::filesystem::path& path, const std::string& doing);

/// Writes all bytes. Errors are thrown by fail_on(), which names `path` in the message.
void write_all(const Descriptor& file, std::span<const std::byte> bytes,
               const std::filesystem::path& path);
/// Reads the next `size` bytes, or fewer if the file ends earlier. Errors are thrown by fail_on().
std::vector<std::byte> read_all(const Descriptor& file, std::size_t size,
                                const std::filesystem::path& path);
/// Calls fsync on a file or folder. Errors are thrown by fail_on().
void sync(const Descriptor& file, const std::filesystem::path& path);

/// Deletes temporary files and folders (".tmp-<pid>-*" and ".*.tmp-<pid>-*") of killed programs in
/// `folder` and, if `below` is true, in the subfolders. A file or folder is kept while process
/// <pid> runs, and while any process, perhaps in a container, holds a lock on it.
void remove_leftovers(const std::filesystem::path& folder, bool below = false);

/// Writes `bytes` to a temporary file in the open `folder`, named ".tmp-<pid>-<n>", with mode 0666
/// minus umask. Then renames it to the last component of `path`; an existing file or link is
/// replaced. If `synced` is true, the new file survives a power cut. After an error, deletes the
/// temporary file and throws as fail_on() does.
void replace_file(const Descriptor& folder, const std::filesystem::path& path,
                  std::span<const std::byte> bytes, bool synced);

/// Thrown when the output path names a file, folder or link that this program did not make.
struct NotOurs : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The content of a regular file of at most `limit` bytes. Nothing when the file is larger,
/// missing, a link or a pipe, or cannot be read.
std::optional<std::string> read_plain(const std::filesystem::path& path, std::size_t limit);

/// Throws NotOurs if `path` exists and is not a regular file that this program wrote. `ours` gets
/// the first bytes of the file (at most 4096) and returns whether this program wrote the file.
/// Throws std::system_error when the type of the file cannot be determined.
void require_ours(const std::filesystem::path& path,
                  const std::function<bool(std::string_view)>& ours);

/// Writes a file with replace_file(), so a reader sees the old file or the complete new file.
/// Creates the folder of `path` if it is missing.
void write_output(const std::filesystem::path& path, std::string_view bytes);

/// Appends to a file, which is created if it is missing. Errors are thrown by fail_on().
void append(const std::filesystem::path& path, std::string_view text);

/// A new temporary folder that only this user can read; the destructor deletes it with its content.
/// The folder lies in TMPDIR (by default /tmp), unless `prefix` is an absolute path. The name is
/// `prefix` + "<pid>-" + six random characters. The constructor calls remove_leftovers() for the
/// parent folder. Throws std::system_error, which names the parent folder, if the temporary folder
/// cannot be created.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const std::string& prefix = ".shearcell.tmp-");
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::optional<Descriptor> held_;  ///< lock that marks the folder as in use
};

}  // namespace shearcell
