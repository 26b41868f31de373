// SPDX-License-Identifier: GPL-3.0-or-later
// Files outside of any store: figures, reports, exports. None is written through a link or over a
// file that this program did not make.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "provenance/io/descriptor.hpp"

namespace shearcell {

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

/// Throws NotOurs unless the path is free or a regular file that `ours` recognizes.
void require_ours(const std::filesystem::path& path, const Recognize& ours);

/// Writes a whole file under a temporary name beside `path` and renames it (replace_file).
void write_output(const std::filesystem::path& path, std::string_view bytes,
                  Existing existing = Existing::replaced);

/// A new file that is written in parts; an existing file is never overwritten. Both functions throw
/// std::system_error that names the file.
class NewFile {
 public:
  explicit NewFile(const std::filesystem::path& path);
  void add(std::string_view text);

 private:
  std::filesystem::path path_;
  Descriptor file_;
};

}  // namespace shearcell
