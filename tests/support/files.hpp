// SPDX-License-Identifier: GPL-3.0-or-later
// Files of the tests. Temporary folders are provenance/io's.
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "provenance/io/file.hpp"

namespace shearcell::test {

inline std::string read_bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream bytes;
  bytes << in.rdbuf();
  return bytes.str();
}

inline void write_bytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

/// A program of the test's own.
inline void write_script(const std::filesystem::path& file, const std::string& text) {
  write_bytes(file, text);
  std::filesystem::permissions(file, std::filesystem::perms::owner_all);
}

}  // namespace shearcell::test
