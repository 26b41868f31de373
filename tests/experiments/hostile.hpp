// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of damaged and forged stores: each case damages a copy of one small store.
#pragma once

#include <algorithm>
#include <ostream>

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

/// `says` is searched for on both streams; the word RUN stands for the id of a run that shears.
template <class... Says>
Case reported(const char* name, const std::string& command, int code, Damage damage, Says... says) {
  return {name, std::move(damage), split(command), code, {says...}};
}

/// A store with a figure, and the figure's file.
class HostileStore : public ProgramTest, public testing::WithParamInterface<Case> {
 protected:
  void SetUp() override {
    const std::string manifest = tiny_manifest("  grains: 200\n", kBothFluids);
    write("m.yaml", manifest);
    shared("with a figure", ".", [&](const std::string& folder) {
      const std::string store = folder + "/shearcell-store";
      expect(0, {"run", "m.yaml", "--cycles", "1", "-q", "--store", store});
      expect(0, {"figures", "S2", "--store", store, "--out", folder});
    });
  }

  /// Damages the store, runs the command and compares.
  void expect_reported(const Case& damaged) {
    std::vector<std::string> command = damaged.command;
    std::replace(command.begin(), command.end(), "RUN"s, last_run());
    damaged.damage(path("shearcell-store"));
    const std::filesystem::path log = path("shearcell-store/store.sqlite");
    const bool refused = damaged.code == 4 && std::filesystem::is_regular_file(log) &&
                         std::string(testing::UnitTest::GetInstance()->current_test_suite()->name())
                             .starts_with("Logs/");
    const std::string before = refused ? read_bytes(log) : "";
    const Outcome outcome = expect(damaged.code, command, damaged.says);
    EXPECT_FALSE(has(outcome.out + outcome.err, "\x1b"));
    if (refused) {
      EXPECT_EQ(read_bytes(log), before) << "a log that is refused was changed";
    }
  }
};

inline const auto case_name = [](const auto& damaged) { return std::string(damaged.param.name); };

}  // namespace shearcell::test
