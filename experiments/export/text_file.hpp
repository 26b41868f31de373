// SPDX-License-Identifier: GPL-3.0-or-later
// A new file that is written piece by piece, each at once and whole.
#pragma once

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>

namespace shearcell {

class TextFile {
 public:
  explicit TextFile(const std::filesystem::path& path)
      : path_(path), stream_(path, std::ios::binary | std::ios::trunc) {
    check();
  }

  /// Throws std::runtime_error that names the file.
  void add(std::string_view text) {
    stream_.write(text.data(), static_cast<std::streamsize>(text.size()));
    stream_.flush();
    check();
  }

 private:
  void check() const {
    if (!stream_) throw std::runtime_error(path_.string() + ": cannot be written");
  }

  std::filesystem::path path_;
  std::ofstream stream_;
};

}  // namespace shearcell
