// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/accuracy_charts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <string_view>

#include "provenance/errors.hpp"

namespace shearcell {
namespace {

constexpr std::size_t largest_file = 2'000'000;  // bytes
constexpr std::size_t most_files = 64;
constexpr std::size_t most_columns = 64;

struct CsvTable {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
};

/// RFC 4180: fields may be quoted and a quote in them doubled.
class CsvReader {
 public:
  CsvReader(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

  CsvTable read() {
    CsvTable table;
    table.columns = row();
    if (table.columns.size() > most_columns) fail("it has too many columns");
    while (at_ < text_.size()) {
      std::vector<std::string> fields = row();
      if (fields.size() != table.columns.size()) {
        fail(fmt::format("{} fields where the header has {}", fields.size(), table.columns.size()));
      }
      table.rows.push_back(std::move(fields));
    }
    return table;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw NotFound(
        fmt::format("{}:{}: this is no table of `bench accuracy --out`: {}", file_, line_, what));
  }

  std::vector<std::string> row() {
    ++line_;
    std::vector<std::string> fields;
    while (true) {
      fields.push_back(field());
      if (at_ < text_.size() && text_[at_] == ',') {
        ++at_;
        continue;
      }
      if (at_ < text_.size() && text_[at_] == '\r') ++at_;
      if (at_ < text_.size() && text_[at_] != '\n') fail("text after a quoted field");
      ++at_;
      return fields;
    }
  }

  std::string field() {
    if (at_ >= text_.size() || text_[at_] != '"') {
      const std::size_t end = std::min(text_.find_first_of(",\r\n", at_), text_.size());
      std::string plain(text_.substr(at_, end - at_));
      at_ = end;
      return plain;
    }
    std::string quoted;
    for (++at_; at_ < text_.size(); ++at_) {
      if (text_[at_] == '"') {
        ++at_;
        if (at_ >= text_.size() || text_[at_] != '"') return quoted;
      }
      quoted += text_[at_];
    }
    fail("a quote that is never closed");
  }

  std::string_view text_;
  std::string file_;
  std::size_t at_ = 0;
  std::size_t line_ = 0;
};

TableValue value_of(const std::string& field) {
  if (field.empty()) return {};
  double number = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), number);
  if (error == std::errc() && end == field.data() + field.size()) return number;
  return field;
}

/// The first column is text, whatever it holds, so that it can name curves.
FigureTable table_of(std::string name, CsvTable&& csv) {
  FigureTable table{.name = std::move(name), .columns = std::move(csv.columns), .rows = {}};
  for (const auto& fields : csv.rows) {
    auto& row = table.rows.emplace_back();
    for (const std::string& field : fields) row.push_back(value_of(field));
    row.front() = fields.front();
  }
  return table;
}

bool has(const FigureTable& table, std::string_view column) {
  return std::find(table.columns.begin(), table.columns.end(), column) != table.columns.end();
}

constexpr std::array colours = {"#000000", "#d62728", "#1f77b4", "#2ca02c",
                                "#9467bd", "#ff7f0e", "#8c564b", "#17becf"};

Series series_of(std::size_t index, const Text& title, SeriesColumns columns) {
  return {.title = title,
          .colour = colours[index % colours.size()],
          .point = 4 + static_cast<int>(index % 10),
          .join = Join::line,
          .columns = std::move(columns)};
}

/// A curve for each text of the first column.
std::vector<Series> curves_by_first_column(const FigureTable& table, const SeriesColumns& columns) {
  std::vector<Series> curves;
  std::set<std::string> names;
  for (const auto& row : table.rows) {
    const auto& name = std::get<std::string>(row.front());
    if (!names.insert(name).second) continue;
    curves.push_back(series_of(curves.size(), name, columns));
    curves.back().filter = {table.columns.front(), name};
  }
  return curves;
}

/// "exit_speed_error" as "exit speed error"; "distance_d" as "distance" with the unit d.
Axis axis_of(std::string column, bool log) {
  Axis axis{.log = log};
  for (const auto& [ending, unit] : {std::pair{"_d", italic("d")}, std::pair{"_s", Text("s")}}) {
    if (!column.ends_with(ending)) continue;
    column.resize(column.size() - 2);
    axis.unit = unit;
  }
  std::replace(column.begin(), column.end(), '_', ' ');
  axis.name = column;
  return axis;
}

Axis cost_axis() {
  return {.name = "cost: seconds per cycle of 600 sheared grains", .log = true};
}

/// Work against precision: one curve a method.
bool work_precision(FigureTable& table) {
  const std::string& error = table.columns.back();
  if (table.columns.front() != "method" || !has(table, "seconds_per_cycle") ||
      error == "seconds_per_cycle") {
    return false;
  }
  table.chart = {.x = cost_axis(),
                 .y = axis_of(error, true),
                 .series = curves_by_first_column(table, {.x = "seconds_per_cycle", .y = error})};
  return true;
}

/// The distance between two runs that begin alike.
bool separation(FigureTable& table) {
  if (!has(table, "time_s") || !has(table, "distance_d") || table.columns.front() != "run") {
    return false;
  }
  table.chart = {.x = axis_of("time_s", false),
                 .y = axis_of("distance_d", true),
                 .series = curves_by_first_column(table, {.x = "time_s", .y = "distance_d"})};
  return true;
}

/// The effect of a finite stiffness or time step on a mean: `NAME` with `NAME_error` against cost.
bool means_against_cost(FigureTable& table) {
  if (!has(table, "seconds_per_cycle")) return false;
  table.chart = {.x = cost_axis(), .y = {.name = "mean over runs"}};
  for (const std::string name : {"phi_uncorrected_bias", "phi_bias", "phi"}) {
    const std::string error = name + "_error";
    if (!has(table, name) || !has(table, error)) continue;
    table.chart.series.push_back(
        series_of(table.chart.series.size(), axis_of(name, false).name,
                  {.x = "seconds_per_cycle", .y = name, .y_error = error}));
  }
  return !table.chart.series.empty();
}

ReportPanel read_panel(const std::filesystem::path& file) {
  if (std::filesystem::file_size(file) > largest_file) {
    throw NotFound(file.string() + ": larger than a table of `bench accuracy --out` ever is");
  }
  std::ifstream in(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in) throw NotFound(file.string() + ": cannot be read");
  FigureTable table = table_of(file.stem().string(), CsvReader(text, file.string()).read());
  const bool drawn = work_precision(table) || separation(table) || means_against_cost(table);
  return {table.name, drawn ? chart_json(table) : nlohmann::json(), std::move(text), {}, ""};
}

}  // namespace

std::vector<ReportPanel> read_accuracy_charts(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code problem;
  for (const auto& entry : std::filesystem::directory_iterator(folder, problem)) {
    if (entry.is_regular_file() && entry.path().extension() == ".csv") files.push_back(entry);
  }
  if (problem) throw NotFound(folder.string() + ": " + problem.message());
  if (files.empty() || files.size() > most_files) {
    throw NotFound(
        fmt::format("{}: it holds {} CSV files; name the folder that `shearcell bench "
                    "accuracy --out` wrote",
                    folder.string(), files.size()));
  }
  std::sort(files.begin(), files.end());
  std::vector<ReportPanel> panels;
  for (const std::filesystem::path& file : files) panels.push_back(read_panel(file));
  return panels;
}

}  // namespace shearcell
