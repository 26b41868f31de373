// SPDX-License-Identifier: GPL-3.0-or-later
// Files of the tests. Temporary folders are provenance/io's.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "provenance/io/file.hpp"

namespace shearcell::test {

inline std::string read_bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void write_bytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

}  // namespace shearcell::test
