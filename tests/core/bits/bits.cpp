// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the golden states with those of this build: test_bits [NAME...]. tests/bits.sh runs it.
#include <algorithm>
#include <cstring>

#include "tests/core/golden.hpp"

int main(int argc, char** argv) {
  bool all = true;
  int compared = 0;
  for (const auto& golden : shearcell::test::kGolden) {
    const auto named = [&](const char* word) { return std::strcmp(word, golden.name) == 0; };
    if (argc > 1 && std::none_of(argv + 1, argv + argc, named)) continue;
    all = shearcell::test::is_reached(golden) && all;
    ++compared;
  }
  return all && compared > 0 && (argc == 1 || compared == argc - 1) ? 0 : 1;
}
