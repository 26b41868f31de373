// SPDX-License-Identifier: GPL-3.0-or-later
// The charts of error against cost that `bench accuracy --out` wrote.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>

#include "experiments/report/report_data.hpp"
#include "provenance/errors.hpp"
#include "provenance/io/file.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

constexpr std::size_t largest_file = 2'000'000;  // bytes
constexpr std::size_t most_files = 64;

std::optional<std::string> read_beside(const std::filesystem::path& csv, const char* ending) {
  std::filesystem::path file = csv;
  file.replace_extension(ending);
  if (!std::filesystem::exists(file)) return std::nullopt;
  auto text = read_plain(file, largest_file);
  if (!text) throw UsageError(file.string() + ": not a readable file of at most 2 MB");
  return text;
}

/// Whether `value` has the structure of the example `like`. An object must have the example's keys.
/// A list of one element stands for any number of such elements, a longer list for that number.
/// Null stands for a number or null, an integer for integers.
bool fits(const json& value, const json& like) {
  if (like.is_null()) return value.is_null() || value.is_number();
  if (like.is_number())
    return like.is_number_integer() ? value.is_number_integer() : value.is_number();
  if (value.type() != like.type()) return false;
  if (like.is_array()) {
    const bool tuple = like.size() > 1;
    if (tuple && value.size() != like.size()) return false;
    for (std::size_t k = 0; k < value.size(); ++k) {
      if (!fits(value[k], like[tuple ? k : 0])) return false;
    }
  }
  return !like.is_object() || std::ranges::all_of(like.items(), [&](const auto& member) {
    return value.contains(member.key()) && fits(value.at(member.key()), member.value());
  });
}

/// A chart as chart_json() writes it; the front end cannot draw others.
json example_chart() {
  const json text = json::parse(R"([["", ""]])");
  const json axis = {{"label", text}, {"unit", text},   {"log", true},    {"whole", true},
                     {"clip", true},  {"low", nullptr}, {"high", nullptr}};
  const json series = {{"title", text}, {"colour", ""},
                       {"point", 0},    {"shift", 0.0},
                       {"line", true},  {"dashed", true},
                       {"band", true},  {"points", json::parse("[[0.0, 0.0, null, null]]")}};
  const json line = {{"at", 0.0}, {"vertical", true}, {"stub", true}, {"colour", ""}};
  return {{"x", axis},
          {"y", axis},
          {"title", text},
          {"series", json::array({series})},
          {"lines", json::array({line})}};
}

ReportPanel read_panel(const std::filesystem::path& csv) {
  ReportPanel panel;
  panel.name = csv.stem().string();
  panel.id = "accuracy." + panel.name;
  panel.csv = read_beside(csv, ".csv").value_or("");
  if (const auto text = read_beside(csv, ".chart.json")) {
    panel.chart = parse_json(*text);
    if (!fits(panel.chart, example_chart())) {
      throw UsageError((csv.parent_path() / panel.name).string() +
                       ".chart.json: not a chart of `bench accuracy --out`");
    }
  }
  panel.drawing = read_beside(csv, ".svg").value_or("");
  return panel;
}

}  // namespace

std::vector<ReportPanel> read_accuracy_charts(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code problem;
  for (const auto& entry : std::filesystem::directory_iterator(folder, problem)) {
    if (entry.is_regular_file() && entry.path().extension() == ".csv") files.push_back(entry);
  }
  if (problem) throw UsageError(folder.string() + ": " + problem.message());
  if (files.empty() || files.size() > most_files) {
    throw UsageError(
        fmt::format("{}: {} CSV files; name the folder that `shearcell bench accuracy "
                    "--out` wrote",
                    folder.string(), files.size()));
  }
  std::ranges::sort(files);
  std::vector<ReportPanel> panels;
  for (const std::filesystem::path& file : files) panels.push_back(read_panel(file));
  return panels;
}

}  // namespace shearcell
