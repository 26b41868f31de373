// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/manifest.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <ranges>
#include <system_error>

#include "experiments/manifest/diagnosis.hpp"
#include "experiments/manifest/document.hpp"
#include "provenance/json_text.hpp"
#include "provenance/limits.hpp"
#include "provenance/words.hpp"

namespace shearcell {

std::string read_text(const std::filesystem::path& path, std::size_t limit) {
  const std::string name = path.string();
  const auto refuse_file = [&](const std::string& why, const char* remedy = "") {
    refuse(name, {}, "", why, "", remedy);
  };
  std::error_code error;
  const std::filesystem::file_type type = std::filesystem::status(path, error).type();
  if (type == std::filesystem::file_type::not_found) refuse_file("there is no such file");
  if (error) refuse_file(fmt::format("cannot be read: {}", error.message()));
  if (type == std::filesystem::file_type::directory) {
    refuse_file("is a directory", "Choose a file in this directory.");
  }
  // Reading a pipe or a device might never end.
  if (type != std::filesystem::file_type::regular) refuse_file("is not a regular file");
  std::ifstream stream(path, std::ios::binary);
  std::string text(limit + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream.is_open() || stream.bad()) refuse_file("cannot be read");
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return text;
}

std::string problem_text(std::string_view file, Position at, const std::string& key,
                         const std::string& problem, const std::string& got,
                         const std::string& remedy) {
  std::string text = printable(file, 4096);
  if (at.line > 0) text += fmt::format(":{}:{}", at.line, at.column);
  text += ": ";
  if (!key.empty()) text += key + ": ";
  text += problem;
  if (!got.empty()) text += fmt::format(" (got {})", got);
  if (!remedy.empty()) text += ". " + remedy;
  return text;
}

void refuse(std::string_view file, Position at, const std::string& key, const std::string& problem,
            const std::string& got, const std::string& remedy) {
  throw ManifestError(problem_text(file, at, key, problem, got, remedy));
}

void ProblemList::add(Position at, const std::string& key, const std::string& problem,
                      const std::string& got, const std::string& remedy) {
  problems_.emplace(at, problem_text(file_, at, key, problem, got, remedy));
}

void ProblemList::raise() const {
  if (problems_.empty()) return;
  constexpr std::size_t most = 20;
  std::vector<std::string> lines;
  for (const auto& [at, text] : problems_ | std::views::take(most)) lines.push_back(text);
  if (size() > most) lines.push_back(fmt::format("and {} more problems", size() - most));
  throw ManifestError(fmt::format("{}", fmt::join(lines, "\n")));
}

Manifest load_manifest(const std::filesystem::path& path) {
  return parse_manifest(read_text(path, ManifestLimits::bytes), path.string());
}

Manifest parse_manifest(std::string_view text, std::string_view file) {
  Manifest manifest = read_manifest(text, file);
  check_variants(manifest);
  return manifest;
}

Manifest recorded_manifest(std::string_view text) try {
  return read_manifest(text, "manifest");
} catch (const ManifestError&) {
  return {};  // the text has keys that this version cannot read
}

bool can_be_until(std::string_view measure) {
  return std::ranges::any_of(all_providers(), [&](const Provider& by) {
    const Measure* found = find_named(by.measures, measure);
    return found != nullptr && by.from != ComputedFrom::simulation && by.cycles_back == 0 &&
           (found->kind == MeasureKind::number || found->kind == MeasureKind::count);
  });
}

nlohmann::json to_json(const Until& until) {
  return {{until.measure, until.value}, {"extra_cycles", until.extra_cycles}};
}

Until until_from_json(const nlohmann::json& json) {
  const nlohmann::json extra = member_of(json, "extra_cycles");
  const bool fits = json.size() == 2 && extra.is_number_unsigned() && extra <= StoreLimits::cycles;
  for (const auto& [name, value] : json.items()) {
    if (!fits || !value.is_number() || !can_be_until(name)) continue;
    return {name, value.get<double>(), extra.get<std::uint64_t>()};
  }
  throw std::runtime_error("until: is not {MEASURE: VALUE, extra_cycles: N} with N <= 1000000");
}

std::string describe(const Until& until) {
  std::string text = fmt::format("{} >= {}", until.measure, until.value);
  if (until.extra_cycles > 0)
    text += fmt::format(" and {}", counted(until.extra_cycles, "more cycle"));
  return text;
}

}  // namespace shearcell
