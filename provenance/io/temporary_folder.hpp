// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

#include "provenance/io/descriptor.hpp"

namespace shearcell {

/// A new folder PREFIX + six random characters in the folder for temporary files (TMPDIR), readable
/// by this user only; deleted with its content at the end of the object's life. The constructor
/// throws std::system_error.
class TemporaryFolder {
 public:
  static constexpr std::size_t kRandom = 6;

  explicit TemporaryFolder(const std::string& prefix = "shearcell-") {
    std::string pattern =
        std::filesystem::temp_directory_path() / (prefix + std::string(kRandom, 'X'));
    if (mkdtemp(pattern.data()) == nullptr) {
      fail_on(pattern, "make a temporary folder (is TMPDIR writable?)");
    }
    path_ = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace shearcell
