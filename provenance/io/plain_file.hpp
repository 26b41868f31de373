// SPDX-License-Identifier: GPL-3.0-or-later
// Files for people, outside of any store: figures, reports, exports. None is written over a file
// that this program did not make, or through a link.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace shearcell {

/// Something that this program did not make stands where it should write.
class NotOurs : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The bytes of a regular file of at most `limit` bytes; nothing when it is missing, a link, a pipe
/// or larger, or cannot be read.
std::optional<std::string> read_plain(const std::filesystem::path& path, std::size_t limit);

/// Recognizes a file of ours by its first bytes, some thousands of them.
using Recognize = std::function<bool(std::string_view beginning)>;

/// Throws NotOurs unless nothing stands there, or a regular file that `ours` recognizes.
void require_ours(const std::filesystem::path& path, const Recognize& ours);

/// Writes a whole file under a temporary name of its own beside `path` (new, no link followed, 0644
/// less umask) and renames it: a reader never sees half of one, and a link at `path` is replaced.
/// Throws std::runtime_error naming the path.
void write_output(const std::filesystem::path& path, std::string_view bytes);

/// A new file in the same way, written piece by piece; what stands there is never overwritten.
class NewFile {
 public:
  explicit NewFile(const std::filesystem::path& path);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  /// Throws std::runtime_error that names the file.
  void add(std::string_view text);

 private:
  std::filesystem::path path_;
  int number_;
};

}  // namespace shearcell
