// SPDX-License-Identifier: GPL-3.0-or-later
// One target as a libFuzzer program. Beside libFuzzer's own options: --write-seeds DIR
#include <filesystem>
#include <fstream>
#include <string_view>

#include "tests/fuzz/targets.hpp"

using shearcell::fuzz::Target;

namespace {
const Target& target = shearcell::fuzz::SHEARCELL_FUZZ_TARGET;
}

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  if (*argc != 3 || std::string_view((*argv)[1]) != "--write-seeds") return 0;
  const std::filesystem::path folder((*argv)[2]);
  std::filesystem::create_directories(folder);
  int number = 0;
  for (const std::string& seed : target.seeds()) {
    std::ofstream(folder / ("seed-" + std::to_string(number++)), std::ios::binary) << seed;
  }
  std::exit(0);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  target.run({data, size});
  return 0;
}
