// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/manifest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <system_error>
#include <tuple>

#include "experiments/manifest/document.hpp"
#include "experiments/manifest/reader.hpp"
#include "experiments/manifest/variants.hpp"

namespace shearcell {
namespace {

constexpr std::size_t kMostReported = 20;

std::vector<ManifestProblem> in_text_order(std::vector<ManifestProblem> problems) {
  std::ranges::stable_sort(problems, {}, [](const ManifestProblem& problem) {
    return std::tuple(problem.at.line, problem.at.column);
  });
  return problems;
}

std::string join(const std::vector<ManifestProblem>& problems) {
  std::string text;
  for (std::size_t i = 0; i < std::min(problems.size(), kMostReported); ++i) {
    if (i > 0) text += '\n';
    text += problems[i].text();
  }
  if (problems.size() > kMostReported) {
    text += fmt::format("\nand {} more problems", problems.size() - kMostReported);
  }
  return text;
}

[[noreturn]] void refuse_file(const std::string& file, std::string problem, std::string remedy) {
  throw ManifestError({{file, {}, "", std::move(problem), "", std::move(remedy)}});
}

std::string read_file(const std::filesystem::path& path, const std::string& name) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    refuse_file(name, "there is no such file", "");
  }
  if (error) refuse_file(name, fmt::format("cannot be read: {}", error.message()), "");
  if (std::filesystem::is_directory(status)) {
    refuse_file(name, "is a directory", "Name a manifest file in it.");
  }
  // A pipe or a device might never end.
  if (!std::filesystem::is_regular_file(status)) refuse_file(name, "is not a regular file", "");
  std::ifstream stream(path, std::ios::binary);
  std::string text(ManifestLimits::bytes + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream.is_open() || stream.bad()) refuse_file(name, "cannot be read", "");
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return text;
}

}  // namespace

std::string ManifestProblem::text() const {
  std::string result = printable(file, 4096);
  if (at.line > 0) result += fmt::format(":{}:{}", at.line, at.column);
  result += ": ";
  if (!key.empty()) result += key + ": ";
  result += problem;
  if (!got.empty()) result += fmt::format(" (got {})", got);
  if (!remedy.empty()) result += ". " + remedy;
  return result;
}

ManifestError::ManifestError(std::vector<ManifestProblem> problems)
    : UsageError(join(in_text_order(problems))), problems_(in_text_order(std::move(problems))) {}

Manifest load_manifest(const std::filesystem::path& path) {
  const std::string name = path.string();
  return parse_manifest(read_file(path, name), name);
}

Manifest parse_manifest(std::string_view text, std::string_view file) {
  Manifest manifest = read_manifest(read_document(text, file), file);
  manifest.text = text;
  std::vector<ManifestProblem> problems = check_variants(manifest);
  if (!problems.empty()) throw ManifestError(std::move(problems));
  return manifest;
}

}  // namespace shearcell
