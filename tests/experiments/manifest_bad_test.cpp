// SPDX-License-Identifier: GPL-3.0-or-later
// Every bad manifest is rejected with a message that says where it is wrong and how to correct it.
// Any bytes give a Manifest or a ManifestError, nothing else.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "tests/experiments/plan_of.hpp"
#include "tests/support/bad_manifests.hpp"
#include "tests/support/files.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

const std::map<std::string, BadManifest> kBad = bad_manifests(SHEARCELL_TEST_DATA);

std::vector<std::string> names_of_bad_manifests() {
  std::vector<std::string> names;
  for (const auto& [name, manifest] : kBad) names.push_back(name);
  return names;
}

std::string message_for(const fs::path& path) {
  return message_of<ManifestError>([&] { load_manifest(path); });
}

std::string message_for_text(std::string_view text, const std::string& file = "text.yaml") {
  return message_of<ManifestError>([&] { parse_manifest(text, file); });
}

class BadManifest : public testing::TestWithParam<std::string> {};

TEST_P(BadManifest, IsRejectedWithTheStatedMessage) {
  const auto& [text, message] = kBad.at(GetParam());
  EXPECT_EQ(message_for_text(text, "bad.yaml"), message);
}

INSTANTIATE_TEST_SUITE_P(Files, BadManifest, testing::ValuesIn(names_of_bad_manifests()),
                         [](const auto& name) { return name.param; });

TEST(BadFile, IsRejected) {
  const TemporaryFolder temporary;
  const fs::path folder = temporary.path();
  const auto at = [&](const char* name) { return folder / name; };
  write_bytes(at("file"), "experiment: a");
  write_bytes(at("empty"), "");
  write_bytes(at("large"), "#" + std::string(ManifestLimits::bytes, 'x'));
  ASSERT_EQ(mkfifo(at("pipe").c_str(), 0600), 0);
  struct Case {
    fs::path path;
    const char* says;
  };
  for (const auto& [path, says] :
       {Case{folder, ": is a directory. Choose a file in this directory."},
        Case{at("none"), ": there is no such file"}, Case{at("file/none"), ": "},
        Case{at("pipe"), ": is not a regular file"}, Case{at("empty"), "the manifest is empty"},
        Case{at("large"), "is larger than 1048576 bytes"},
        Case{"/no\x1b[31m", "/no\\x1b[31m: there is no such file"}}) {
    EXPECT_TRUE(has(message_for(path), says));
  }
  fs::permissions(at("file"), fs::perms::none);
  if (geteuid() != 0) {  // root reads everything
    EXPECT_EQ(message_for(at("file")), at("file").string() + ": cannot be read");
  }
}

TEST(BadText, IsNotUtf8) {
  EXPECT_EQ(message_for_text("experiment: a\nquestion: \xC3\x28\n"),
            "text.yaml:2:11: is not valid UTF-8. Save the file as UTF-8 text.");
  for (const char* bytes : {"\xFF\xFE\x61", "\xC0\x80", "\xED\xA0\x80", "\xF4\x90\x80\x80",
                            "\xE0\x80\x80", "\xF0\x80\x80\x80", "\x80", "\xE2\x82"}) {
    EXPECT_TRUE(has(message_for_text(bytes), "text.yaml:1:1: is not valid UTF-8"));
  }
}

TEST(BadText, HoldsControlCharacters) {
  const std::string nul("experiment: a\0b\n", 16);
  EXPECT_EQ(message_for_text(nul),
            "text.yaml:1:14: holds the control character 0x00. A manifest is plain text.");
  EXPECT_NE(message_for_text("experiment: a\n\x04"), "");
}

// An escape in double quotes can name any character. What is kept must be fit for JSON and XML.
TEST(BadText, EveryTextThatIsKeptIsPlain) {
  std::size_t kept = 0, refused = 0;
  const auto take = [&](const std::string& escape) {
    try {
      const std::string text =
          read_manifest("experiment: a\nquestion: \"x" + escape + "y\"\n", "text.yaml").question;
      EXPECT_NO_THROW(nlohmann::json(text).dump()) << escape;
      for (const char* bad : {"\xEF\xBF\xBE", "\xEF\xBF\xBF", "\xC2\x85", "\xE2\x80\xAE"}) {
        EXPECT_FALSE(has(text, bad)) << escape;
      }
      for (const char c : text) EXPECT_TRUE(c == '\n' || std::iscntrl(c) == 0) << escape;
      ++kept;
    } catch (const ManifestError&) {
      ++refused;
    }
  };
  for (char c = ' '; c <= '~'; ++c) take({'\\', c});
  for (std::uint32_t c = 0; c < 0x110000; c += c < 0x800 || (c & 0xFFFF) > 0xFDC0 ? 1 : 61) {
    take(fmt::format("\\U{:08X}", c));
  }
  std::printf("%zu kept, %zu refused\n", kept, refused);
  EXPECT_GT(kept, 20'000U);
  EXPECT_GT(refused, 150U);
}

TEST(BadText, HasTooManyValues) {
  std::string list = "experiment: a\nbase: {}\nseeds: [1";
  for (int i = 2; i <= 1001; ++i) list += ", " + std::to_string(i);
  EXPECT_TRUE(has(message_for_text(list + "]"), "has more than 1000 values (got 1001 values)"));
  std::string nodes = "experiment: a\nbase: {}\nseeds: [1";
  for (int i = 0; i < 100'000; ++i) nodes += ",1";
  EXPECT_TRUE(has(message_for_text(nodes + "]"), "holds more than 100000 values"));
}

TEST(BadText, ExpandsWithoutLimit) {
  std::string text = "experiment: a\nbase: {}\nsweep:\n  grid:\n";
  for (const char* key : {"period_s", "amplitude_rad", "mass_kg", "drag_kg_per_s", "pressure_Pa",
                          "settle_time_limit_s", "gravity_m_per_s2"}) {
    text += std::string("    ") + key + ": [0.1";
    for (int i = 1; i < 1000; ++i) text += ", " + std::to_string(0.1 + 1e-4 * i);
    text += "]\n";
  }
  EXPECT_TRUE(has(message_for_text(text), "expands to more than 10000 runs"));
}

TEST(BadText, ReportsTwentyProblemsAndCountsTheRest) {
  std::string text = "experiment: a\nbase:\n";
  for (int i = 0; i < 30; ++i) text += "  nonsense_" + std::to_string(i) + ": 1\n";
  const std::string message = message_for_text(text);
  EXPECT_EQ(std::ranges::count(message, '\n'), 20);
  EXPECT_TRUE(message.ends_with("and 10 more problems"));
}

// A list where a map belongs, a map where a number belongs, and so on.
TEST(BadText, AnyKeyWithAnyKindOfValueIsReadOrRefused) {
  std::vector<std::string> texts = {"seeds: {}",
                                    "sweep: {grid: {}}",
                                    "sweep: {zip: {}}",
                                    "sweep: {grid: {fluid: {}}}",
                                    "base: {}",
                                    "base: {grains: {}}",
                                    "until: {phi: {}}",
                                    "checkpoints: {phases: {}}",
                                    "labels: {fluid: {}}",
                                    "labels: {\"fluid=still\": {}}",
                                    "scales: {a: {}}"};
  std::istringstream tables(manifest_markdown());
  std::string before, after;  // in the top level, a plot, a claim
  for (std::string line; std::getline(tables, line);) {
    if (line == "Keys of a plot:") before = "plots: [{name: p, y: phi, by: fluid, ", after = "}]";
    if (line == "Keys of a claim:") before = "claims: [{name: c, compare: phi, at_cycle: 1, ";
    if (!line.starts_with("| `")) continue;
    const std::string key = line.substr(3, line.find('`', 3) - 3);
    texts.push_back(before + key + ": {}" + after);
    for (const char* inner : {"{still: {}}", "[{}]", "[{label: {}}]", "[{}, {}]"}) {
      texts.push_back(before + key + ": " + inner + after);
    }
  }
  std::size_t read = 0, refused = 0;
  for (const std::string& text : texts) {
    const std::size_t place = text.rfind("{}");
    if (place == std::string::npos) continue;
    for (const char* value :
         {"", "3", "a", "''", "[]", "[1, 2]", "[[1], [2]]", "{}", "{a: 1}", "{fluid: still}",
          "[{a: 1}, {fluid: still}]", "{a: [1], b: {c: 2}}"}) {
      std::string whole = text;
      whole.replace(place, 2, value);
      SCOPED_TRACE(whole);
      const bool stated = whole.starts_with("experiment:");
      message_for_text((stated ? "" : "experiment: a\n") + whole).empty() ? ++read : ++refused;
    }
  }
  std::printf("%zu read, %zu refused\n", read, refused);
  EXPECT_GT(read, 20U);
  EXPECT_GT(refused, 1000U);
}

// The smallest number of steps that the message names is accepted, and one less is not.
TEST(BadText, NamesTheSmallestNumberOfStepsThatWorks) {
  const auto with_steps = [](int steps) {
    return message_for_text("experiment: a\nbase: {steps_per_cycle: " + std::to_string(steps) +
                            "}");
  };
  EXPECT_EQ(with_steps(16175), "");
  EXPECT_TRUE(has(with_steps(16174), "Use at least 16175 steps per cycle, or `auto`."));
}

}  // namespace
}  // namespace shearcell::test
