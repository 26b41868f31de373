// SPDX-License-Identifier: GPL-3.0-or-later
// Cases of damaged and forged stores: each is one line of a table over copies of one small store.
#pragma once

#include <algorithm>
#include <ostream>
#include <sstream>

#include "tests/experiments/damage.hpp"
#include "tests/experiments/program.hpp"

namespace shearcell::test {

using namespace std::string_literals;

struct Case {
  const char* name;
  Damage damage;
  std::vector<std::string> command;
  int code;
  std::vector<std::string> says;  ///< on either stream
};

inline void PrintTo(const Case& damaged, std::ostream* out) {
  *out << damaged.name;
}

/// `says` is looked for on both streams; the word RUN stands for the id of a run that shears.
template <class... Says>
Case told(const char* name, const std::string& command, int code, Damage damage, Says... says) {
  Case made{name, std::move(damage), {}, code, {says...}};
  std::istringstream words(command);
  for (std::string word; words >> word;) made.command.push_back(word);
  return made;
}

/// A store with a figure, and the figure's file.
class HostileStore : public ProgramTest, public testing::WithParamInterface<Case> {
 protected:
  void SetUp() override {
    campaign(tiny_manifest("  grains: 200\n", kBothFluids), {"--cycles", "1"});
    ASSERT_EQ(run({"figures", "S2", "--out", "."}).code, 0);
  }

  /// Damages the store, runs the command and compares.
  void expect(const Case& damaged) {
    std::vector<std::string> command = damaged.command;
    const std::string id = Store(path("shearcell-store"), Access::read).runs().back().id;
    std::replace(command.begin(), command.end(), "RUN"s, id);
    damaged.damage(path("shearcell-store"));
    const std::filesystem::path log = path("shearcell-store/store.sqlite");
    const bool refused = damaged.code == 4 && std::filesystem::is_regular_file(log) &&
                         std::string(testing::UnitTest::GetInstance()->current_test_suite()->name())
                             .starts_with("Logs/");
    const std::string before = refused ? read_bytes(log) : "";
    const Outcome outcome = run(command);
    const std::string said = outcome.out + outcome.err;
    EXPECT_EQ(outcome.signal, 0);
    EXPECT_EQ(outcome.code, damaged.code) << said.substr(0, 2000);
    for (const std::string& words : damaged.says) {
      EXPECT_NE(said.find(words), std::string::npos) << words << "\n" << said.substr(0, 2000);
    }
    EXPECT_EQ(said.find('\x1b'), std::string::npos);
    if (refused) {
      EXPECT_EQ(read_bytes(log), before) << "a log that is refused was changed";
    }
  }
};

inline const auto case_name = [](const auto& damaged) { return std::string(damaged.param.name); };

}  // namespace shearcell::test
