// SPDX-License-Identifier: GPL-3.0-or-later
// A table and how it is drawn. The gnuplot script (analysis/gnuplot_script) and the report's
// interactive plot (chart_json) are both made from this one description.
#pragma once

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace shearcell {

/// A piece of text in one style. The style is the HTML element that shows it: "" (plain), "i",
/// "sub" or "sup".
struct TextPart {
  std::string text;
  std::string style;
};
struct Text {
  std::vector<TextPart> parts;

  Text() = default;
  Text(const char* plain) : Text(std::string(plain)) {}  // NOLINT: a label is often plain
  Text(std::string plain) { parts.push_back({std::move(plain), ""}); }  // NOLINT
  bool empty() const { return parts.empty(); }
};
Text operator+(Text first, const Text& second);

/// Text in which formulas stand between `$`, as in TeX: letters are italic there, and `_` and `^`
/// lower and raise the next character or the text in the next braces: "drag $v_{fluid}$".
Text formula(std::string_view text);

/// Empty (not measured, or no error from one run), a number, a whole number, or text.
struct TableCell : std::variant<std::monostate, double, std::int64_t, std::string> {
  using variant::variant;
  TableCell(std::size_t count) : variant(static_cast<std::int64_t>(count)) {}  // NOLINT
  TableCell(const std::optional<double>& value) {                              // NOLINT
    if (value) emplace<double>(*value);
  }
};
using TableRow = std::vector<TableCell>;

/// The cell of a JSON null, number or text.
TableCell cell_of(const nlohmann::json& value);
nlohmann::json json_of(const TableCell& cell);

/// A column. Its name ends in the unit, except for counts and pure numbers.
struct TableColumn {
  std::string name;
  std::string meaning = {};

  TableColumn(std::string of, std::string means = {})  // NOLINT: most columns are names alone
      : name(std::move(of)), meaning(std::move(means)) {}
  TableColumn(const char* of) : name(of) {}  // NOLINT
  bool operator==(const TableColumn&) const = default;
};

struct Axis {
  Text name = {};    ///< "volume fraction"
  Text symbol = {};  ///< "ϕ"
  Text unit = {};    ///< empty where there is none
  bool log = false;
  bool whole = false;                        ///< only whole numbers have a meaning: cycles
  std::optional<double> low = std::nullopt;  ///< the axis ends here unless data lie beyond
  std::optional<double> high = std::nullopt;
  bool clip = false;  ///< the axis ends there even if data lie beyond
};

struct ChartPoint {
  double x = 0;
  double y = 0;
  std::optional<double> x_error = std::nullopt;  ///< standard error, one sided
  std::optional<double> y_error = std::nullopt;
  std::optional<double> runs = std::nullopt;  ///< over which y is a mean
};

/// Names of columns; an empty name of an error, or of `runs`, means that there is none. With
/// `x_high`, x is the middle of both.
struct SeriesColumns {
  std::string x = {};
  std::string y = {};
  std::string x_error = {};
  std::string y_error = {};
  std::string x_high = {};
  std::string runs = {};  ///< over which y is a mean
};

/// The rows that have `value` in that column; every row when `column` is empty.
struct RowFilter {
  std::string column;
  TableCell value;
};

enum class Join { none, line, dashes };

struct Series {
  Text title = {};          ///< in the key; no entry if empty
  std::string colour = {};  ///< "#rrggbb"
  int point = 7;  ///< 0 none, 4 square, 6 circle, 8 triangle, 10 triangle down, 12 diamond;
                  ///< + 1 filled
  Join join = Join::none;  ///< points are joined in their order
  bool band = false;       ///< errors of y are drawn as a band; errors of x are not drawn
  bool thin = false;       ///< one of many traces
  bool large = false;      ///< larger points, which stay visible around smaller ones
  SeriesColumns columns = {};
  RowFilter filter = {};
  std::vector<ChartPoint> points = {};  ///< used where `columns` names no x
  /// Number of independent packings per point, if all points of the curve have the same runs; else
  /// 0.
  std::size_t runs = 0;
  double shift = 0;  ///< added to x in the drawing, so that points with equal x stay visible
};

/// A dashed line across the frame; `stub` is a short mark at the lower end of a vertical one.
struct ReferenceLine {
  double at = 0;
  bool vertical = false;
  bool stub = false;
  std::string colour = "#888888";
  Text title = {};  ///< in the caption
};

struct Chart {
  Axis x = {};
  Axis y = {};
  std::vector<Series> series = {};
  std::vector<ReferenceLine> lines = {};
  Text title = {};           ///< above the frame; figures have none
  bool wide = false;         ///< drawn over two columns of a journal (17.8 cm), not one (8.6 cm)
  std::string letter = {};   ///< of the panel: "a"
  std::string note = {};     ///< a sentence of the caption, without its full stop
  std::string sources = {};  ///< a sentence on the sources of published numbers, also without it
  /// For the caption: what bars and bands are if they are not standard errors over runs.
  std::string errors = {};
};

/// A table that is drawn as text: the first row is the heading.
struct TextTable {
  struct Cell {
    Text text;
    std::string colour = "#000000";
  };
  std::vector<int> widths = {};  ///< of the columns [px]
  std::vector<std::vector<Cell>> rows = {};
  Text note = {};
};

/// One panel: its data and one way to draw them. With neither chart nor text it is not drawn.
struct Table {
  std::string name = {};  ///< "S2a": letters, digits, '-' and '_'
  std::vector<TableColumn> columns = {};
  std::vector<TableRow> rows = {};
  Chart chart = {};
  TextTable text = {};

  /// The index of a column; the number of columns if there is none of that name.
  std::size_t place(std::string_view column) const {
    return static_cast<std::size_t>(std::ranges::find(columns, column, &TableColumn::name) -
                                    columns.begin());
  }
};

/// A text as a CSV field (RFC 4180), in quotes if it needs them.
std::string csv_field(const std::string& text);

/// Digits of the numbers in a CSV. `enough`: digits_between() the smallest and the largest number
/// of the column. `all`: the shortest text that reads back to the same double.
enum class Digits { enough, all };

/// RFC 4180 with a header row and "\n" line ends. A number that is not finite leaves its field
/// empty.
std::string to_csv(const Table& table, Digits digits = Digits::enough);

/// An array of objects, one for each row, keys in the order of the columns.
nlohmann::ordered_json to_json(const Table& table);

/// The points of one series, without its shift. Points of which x or y is not a finite number are
/// left out.
std::vector<ChartPoint> points_of(const Table& table, const Series& series);

/// Adds the number of runs behind the points to the title of each series, as "(3 to 5 runs)", if
/// this number differs between points or is less than Series::runs. A mean may change along a curve
/// only because other runs enter it. If all series have the same numbers, the caption states them
/// once.
void name_run_counts(Table& table);

/// Significant digits of values from `low` to `high`: nine, or more where nine would not show the
/// spread in five digits. A spread as small as rounding errors does not count.
int digits_between(double low, double high);
std::string digits(double value, int significant = 9);

/// The text without styles. A subscript becomes "v_fluid".
std::string plain_text(const Text& text);

/// Whether the chart can draw the point or line: a logarithmic axis has positive values only.
bool is_on_log_axes(const Chart& chart, const ChartPoint& point);
bool is_on_log_axes(const Chart& chart, const ReferenceLine& line);

/// The caption of a figure: what each panel shows, what the errors are, and what the reference
/// lines are. One paragraph that begins with `title`.
std::string caption_of(const std::string& title, std::span<const Table> tables);

/// The text as [[text, style], ...].
nlohmann::json to_json(const Text& text);

/// The chart with the points of its series, for the front end of the report. The same table gives
/// the same bytes.
nlohmann::json chart_json(const Table& table);

}  // namespace shearcell
