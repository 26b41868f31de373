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

bool all(const json& list, bool (*holds)(const json&)) {
  return list.is_array() && std::ranges::all_of(list, holds);
}

bool is_text(const json& text) {
  return all(text, [](const json& run) {
    return run.is_array() && run.size() == 2 && run[0].is_string() && run[1].is_string();
  });
}

bool is_axis(const json& axis) {
  const auto end = [&](const char* key) {
    return axis.at(key).is_null() || axis.at(key).is_number();
  };
  return is_text(axis.at("label")) && is_text(axis.at("unit")) && axis.at("log").is_boolean() &&
         axis.at("whole").is_boolean() && axis.at("clip").is_boolean() && end("low") && end("high");
}

bool is_point(const json& point) {
  const auto error = [&](std::size_t k) { return point[k].is_null() || point[k].is_number(); };
  return point.is_array() && point.size() == 4 && point[0].is_number() && point[1].is_number() &&
         error(2) && error(3);
}

bool is_series(const json& series) {
  return is_text(series.at("title")) && series.at("colour").is_string() &&
         series.at("point").is_number_integer() && series.at("shift").is_number() &&
         series.at("line").is_boolean() && series.at("dashed").is_boolean() &&
         series.at("band").is_boolean() && all(series.at("points"), is_point);
}

bool is_line(const json& line) {
  return line.at("at").is_number() && line.at("vertical").is_boolean() &&
         line.at("stub").is_boolean() && line.at("colour").is_string();
}

/// What chart_json() writes, and nothing that the front end could stumble over.
bool is_chart(const json& chart) {
  try {
    return is_axis(chart.at("x")) && is_axis(chart.at("y")) && is_text(chart.at("title")) &&
           all(chart.at("series"), is_series) && all(chart.at("lines"), is_line);
  } catch (const json::exception&) {
    return false;
  }
}

ReportPanel read_panel(const std::filesystem::path& csv) {
  ReportPanel panel;
  panel.name = panel.id = csv.stem().string();
  panel.csv = read_beside(csv, ".csv").value_or("");
  if (const auto text = read_beside(csv, ".chart.json")) {
    panel.chart = parse_json(*text);
    if (!is_chart(panel.chart)) {
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
