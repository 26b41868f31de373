// SPDX-License-Identifier: GPL-3.0-or-later
// A libFuzzer program: fuzz --target=NAME [--write-seeds=DIR | libFuzzer's own options]. libFuzzer
// leaves out the options that begin with two dashes.
#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "tests/fuzz/targets.hpp"

using shearcell::fuzz::Target;

namespace {
const Target* target = nullptr;
}

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  const std::vector<std::string> words(*argv + 1, *argv + *argc);
  const auto after = [&](const std::string& option) -> std::string {
    for (const std::string& word : words) {
      if (word.starts_with(option + '=')) return word.substr(option.size() + 1);
    }
    return "";
  };
  target = std::ranges::find(shearcell::fuzz::all_targets, after("--target"), &Target::name);
  if (target == shearcell::fuzz::all_targets.end()) std::exit(2);
  const std::filesystem::path folder = after("--write-seeds");
  if (folder.empty()) return 0;
  std::filesystem::create_directories(folder);
  int number = 0;
  for (const std::string& seed : target->seeds()) {
    std::ofstream(folder / ("seed-" + std::to_string(number++)), std::ios::binary) << seed;
  }
  std::exit(0);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  target->run({data, size});
  return 0;
}
