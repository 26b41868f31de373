// SPDX-License-Identifier: GPL-3.0-or-later
// Every hard case ends as expected; a case that crashes or hangs is reported.
#include <gtest/gtest.h>

#include <cctype>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ostream>
#include <set>
#include <stdexcept>
#include <thread>

#include "experiments/bench/stability/stability.hpp"

namespace shearcell {

namespace stability {

void PrintTo(const HardCase& hard, std::ostream* out) {
  *out << hard.name;
}

}  // namespace stability

namespace {

using stability::HardCase;
using stability::Outcome;

class Hard : public testing::TestWithParam<HardCase> {};

// The long cases take fewer steps here; in full: ctest -C sweep -L sweep.
TEST_P(Hard, CaseEndsAsExpected) {
  const HardCase& hard = GetParam();
  const Outcome outcome = hard.run(true);
  std::printf("%s: %s\n", hard.done.c_str(), outcome.text.c_str());
  EXPECT_TRUE(outcome.as_expected) << "expected: " << hard.expected << "\n  got: " << outcome.text;
}

std::string name_of(const testing::TestParamInfo<HardCase>& info) {
  std::string name = info.param.name;
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return name;
}

INSTANTIATE_TEST_SUITE_P(Cases, Hard, testing::ValuesIn(stability::hard_cases()), name_of);

TEST(HardCases, HaveUniqueNamesAndExpectations) {
  std::set<std::string> names;
  for (const HardCase& hard : stability::hard_cases()) {
    EXPECT_TRUE(names.insert(hard.name).second) << hard.name;
    EXPECT_FALSE(hard.done.empty() || hard.expected.empty()) << hard.name;
  }
}

StabilityResult map(std::function<Outcome(bool)> run, double seconds = 60) {
  return map_case({"made-up", "what this test makes up", "", std::move(run)}, true, seconds);
}

TEST(HardCases, ReportTheirOutcome) {
  const std::string text(200'000, 'x');
  const StabilityResult result = map([&](bool) { return Outcome{true, text}; });
  EXPECT_TRUE(result.as_expected);
  EXPECT_EQ(result.outcome, text);
  EXPECT_FALSE(map([](bool) { return Outcome{false, "off"}; }).as_expected);
}

TEST(HardCases, ThatCrashHangOrThrowAreReported) {
  const StabilityResult crash = map([](bool) -> Outcome { std::abort(); });
  EXPECT_FALSE(crash.as_expected);
  EXPECT_NE(crash.outcome.find("signal 6"), std::string::npos) << crash.outcome;

  const StabilityResult hang = map(
      [](bool) -> Outcome {
        for (;;) std::this_thread::sleep_for(std::chrono::milliseconds(10));
      },
      0.3);
  EXPECT_FALSE(hang.as_expected);
  EXPECT_NE(hang.outcome.find("hangs"), std::string::npos) << hang.outcome;

  const StabilityResult thrown =
      map([](bool) -> Outcome { throw std::runtime_error("no such thing"); });
  EXPECT_FALSE(thrown.as_expected);
  EXPECT_EQ(thrown.outcome, "threw: no such thing");

  const StabilityResult silent = map([](bool) -> Outcome { std::_Exit(0); });
  EXPECT_FALSE(silent.as_expected);
  EXPECT_EQ(silent.outcome, "ended without an outcome");
}

TEST(HardCases, RefuseAnUnknownName) {
  StabilityOptions options;
  options.only = {"no-such-case"};
  EXPECT_THROW(map_stability(options), std::invalid_argument);
  EXPECT_EQ(unknown_case("vacancy"), "");
  EXPECT_EQ(unknown_case("limit"), "") << "four begin so";
  EXPECT_EQ(unknown_case("vacanzy"), "no hard case is named 'vacanzy'; did you mean 'vacancy'?");
}

}  // namespace
}  // namespace shearcell
