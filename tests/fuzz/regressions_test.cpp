// SPDX-License-Identifier: GPL-3.0-or-later
// Every fuzz target with its seeds, with truncated and slightly changed seeds, and with every input
// that once found a fault.
#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include "tests/fuzz/targets.hpp"
#include "tests/provenance/samples.hpp"

namespace shearcell::fuzz {
namespace {

class FuzzTarget : public testing::TestWithParam<Target> {
 protected:
  static void run(const std::string& input) {
    GetParam().run({reinterpret_cast<const std::uint8_t*>(input.data()), input.size()});
  }
};

TEST_P(FuzzTarget, ReadsItsSeeds) {
  const std::vector<std::string> seeds = GetParam().seeds();
  ASSERT_FALSE(seeds.empty());
  for (const std::string& seed : seeds) EXPECT_NO_THROW(run(seed));
  EXPECT_NO_THROW(run(""));
}

TEST_P(FuzzTarget, SurvivesDamagedSeeds) {
  std::mt19937 random(11);
  const std::vector<std::string> seeds = GetParam().seeds();
  for (int round = 0; round < 200; ++round) {
    std::string input = seeds[random() % seeds.size()];
    for (unsigned change = 0; change < 1 + random() % 4 && !input.empty(); ++change) {
      char& byte = input[random() % input.size()];
      byte = static_cast<char>(byte ^ (1 << random() % 8));
    }
    if (random() % 4 == 0) input.resize(random() % (input.size() + 1));
    EXPECT_NO_THROW(run(input)) << "round " << round;
  }
}

TEST_P(FuzzTarget, SurvivesInputsThatOnceFoundAFault) {
  const auto folder = std::filesystem::path(SHEARCELL_FUZZ_REGRESSIONS) / GetParam().name;
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no fault was found with this target";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    EXPECT_NO_THROW(run(test::read_bytes(entry.path()))) << entry.path();
  }
}

INSTANTIATE_TEST_SUITE_P(All, FuzzTarget, testing::ValuesIn(all_targets),
                         [](const auto& target) { return std::string(target.param.name); });

}  // namespace
}  // namespace shearcell::fuzz
