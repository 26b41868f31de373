// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/io/temporary_folder.hpp"

#include <cstdlib>
#include <system_error>

#include "provenance/io/descriptor.hpp"

namespace shearcell {

TemporaryFolder::TemporaryFolder(const std::string& prefix) {
  std::string pattern =
      std::filesystem::temp_directory_path() / (prefix + std::string(kRandom, 'X'));
  if (mkdtemp(pattern.data()) == nullptr) {
    fail_on(pattern, "make a temporary folder (is TMPDIR writable?)");
  }
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace shearcell
