// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/accuracy_charts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <iterator>
#include <optional>
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

  int column(std::string_view name) const {  // from 1; 0 when there is none
    const auto found = std::find(columns.begin(), columns.end(), name);
    return found == columns.end() ? 0 : static_cast<int>(found - columns.begin()) + 1;
  }
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

/// The first column as text, so that curves can be told apart by it whatever it holds.
TableRows rows_of(const CsvTable& table) {
  TableRows rows;
  for (const auto& fields : table.rows) {
    auto& row = rows.emplace_back();
    for (const std::string& field : fields) row.push_back(value_of(field));
    row.front() = fields.front();
  }
  return rows;
}

/// gnuplot's markup means nothing in names from a file.
std::string plain(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (std::string_view("_^@&{}\\~").find(c) != std::string_view::npos) result += '\\';
    result += c;
  }
  return result;
}

constexpr std::array colours = {"#000000", "#d62728", "#1f77b4", "#2ca02c",
                                "#9467bd", "#ff7f0e", "#8c564b", "#17becf"};

ChartSeries series_of(std::size_t index, const std::string& title) {
  return {
      plain(title), colours[index % colours.size()], 4 + static_cast<int>(index % 10), true, {}};
}

/// A curve for each text of the first column.
std::vector<ChartSeries> curves_by_first_column(const CsvTable& table,
                                                const CurveColumns& columns) {
  const TableRows rows = rows_of(table);
  std::vector<ChartSeries> curves;
  std::vector<std::string> names;
  for (const auto& fields : table.rows) {
    const std::string& name = fields.front();
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    names.push_back(name);
    ChartSeries curve = series_of(curves.size(), name);
    curve.points = chart_points(rows, columns, 1, name);
    curves.push_back(std::move(curve));
  }
  return curves;
}

std::string words(std::string name) {
  for (const auto& [unit, written] :
       {std::pair{"_d", "  [{/:Italic d}]"}, std::pair{"_s", "  [s]"}}) {
    if (!name.ends_with(unit)) continue;
    name.resize(name.size() - std::string_view(unit).size());
    std::replace(name.begin(), name.end(), '_', ' ');
    return plain(name) + written;
  }
  std::replace(name.begin(), name.end(), '_', ' ');
  return plain(name);
}

constexpr const char* cost_label = "cost: seconds per cycle of 600 sheared grains";

/// Work against precision: one curve a method.
std::optional<Chart> work_precision(const CsvTable& table) {
  const int cost = table.column("seconds_per_cycle");
  const int error = static_cast<int>(table.columns.size());
  if (table.column("method") != 1 || cost == 0 || cost == error) return std::nullopt;
  return Chart{{.label = cost_label, .log = true},
               {.label = words(table.columns.back()), .log = true},
               curves_by_first_column(table, {.x = cost, .x_error = 0, .y = error, .y_error = 0}),
               {}};
}

/// How two runs that begin alike part.
std::optional<Chart> separation(const CsvTable& table) {
  const int time = table.column("time_s");
  const int distance = table.column("distance_d");
  if (time == 0 || distance == 0 || table.column("run") != 1) return std::nullopt;
  Chart chart{{.label = words("time_s")},
              {.label = words("distance_d"), .log = true},
              curves_by_first_column(table, {.x = time, .x_error = 0, .y = distance, .y_error = 0}),
              {}};
  return chart;
}

/// What finite stiffness, or a time step, does to a mean: `NAME` with `NAME_error` against cost.
std::optional<Chart> means_against_cost(const CsvTable& table) {
  const int cost = table.column("seconds_per_cycle");
  if (cost == 0) return std::nullopt;
  Chart chart{{.label = cost_label, .log = true}, {.label = "mean over runs"}, {}, {}};
  const TableRows rows = rows_of(table);
  for (const char* name : {"phi_uncorrected_bias", "phi_bias", "phi"}) {
    const int y = table.column(name);
    const int error = table.column(std::string(name) + "_error");
    if (y == 0 || error == 0) continue;
    ChartSeries curve = series_of(chart.series.size(), words(name));
    curve.points = chart_points(rows, {.x = cost, .x_error = 0, .y = y, .y_error = error});
    chart.series.push_back(std::move(curve));
  }
  if (chart.series.empty()) return std::nullopt;
  return chart;
}

Chart chart_of(const CsvTable& table) {
  for (const auto rule : {work_precision, separation, means_against_cost}) {
    if (auto chart = rule(table)) return std::move(*chart);
  }
  return {};
}

ReportPanel read_panel(const std::filesystem::path& file) {
  if (std::filesystem::file_size(file) > largest_file) {
    throw NotFound(file.string() + ": larger than a table of `bench accuracy --out` ever is");
  }
  std::ifstream in(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in) throw NotFound(file.string() + ": cannot be read");
  Chart chart = chart_of(CsvReader(text, file.string()).read());
  return {file.stem().string(), std::move(chart), std::move(text), {}, ""};
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
