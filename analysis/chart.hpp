// SPDX-License-Identifier: GPL-3.0-or-later
// A table and how it is drawn. The gnuplot script (analysis/gnuplot_script) and the report's
// interactive plot (chart_json) are both made from this one description.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
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
  Text(const char* plain) : Text(std::string(plain)) {}  // NOLINT: implicit for string literals
  Text(std::string plain) { parts.push_back({std::move(plain), ""}); }  // NOLINT
  bool empty() const { return parts.empty(); }
};
Text operator+(Text first, const Text& second);

/// Reads a text that has formulas between `$` signs, as in TeX: "drag $v_{fluid}$". Letters in
/// formulas are italic; `_` lowers and `^` raises the next character or the text in braces.
Text formula(std::string_view text);

/// A number, a whole number, text, or empty. A cell is empty if its value was not measured, or if
/// it is a standard error and there is only one run.
struct TableCell : std::variant<std::monostate, double, std::int64_t, std::string> {
  using variant::variant;
  TableCell(std::size_t count) : variant(static_cast<std::int64_t>(count)) {}  // NOLINT
  TableCell(const std::optional<double>& value) {                              // NOLINT
    if (value) emplace<double>(*value);
  }
};
using TableRow = std::vector<TableCell>;

/// Converts a JSON null, number or text to a cell.
TableCell cell_of(const nlohmann::json& value);
nlohmann::json json_of(const TableCell& cell);

/// A column. Its name ends in the unit, except for counts and pure numbers.
struct TableColumn {
  std::string name;
  std::string meaning = {};

  TableColumn(std::string of, std::string means = {})  // NOLINT: most columns need only a name
      : name(std::move(of)), meaning(std::move(means)) {}
  TableColumn(const char* of) : name(of) {}  // NOLINT
  bool operator==(const TableColumn&) const = default;
};

struct Axis {
  Text name = {};    ///< "volume fraction"
  Text symbol = {};  ///< "ϕ"
  Text unit = {};    ///< empty: no unit
  bool log = false;
  bool whole = false;                        ///< only whole numbers are meaningful
  std::optional<double> low = std::nullopt;  ///< lower end of the axis, unless data lie below
  std::optional<double> high = std::nullopt;
  bool clip = false;  ///< the axis ends at low and high even if data lie beyond
};

/// Name, symbol and unit, separated by `space`: "mean overlap ⟨δ⟩ [d]".
Text label_of(const Axis& axis, const char* space);

struct ChartPoint {
  double x = 0;
  double y = 0;
  std::optional<double> x_error = std::nullopt;  ///< standard error; stored, but not drawn
  std::optional<double> y_error = std::nullopt;  ///< bar or band from y - y_error to y + y_error
  std::optional<double> runs = std::nullopt;     ///< number of runs averaged in y
};

enum class Join { none, line, dashes };

struct Series {
  Text title = {};           ///< in the legend; a series without a title has no entry
  std::string colour = {};   ///< "#rrggbb"
  int point = 7;             ///< symbol: 0 none, 4 square, 6 circle, 8 triangle, 10 triangle down,
                             ///< 12 diamond; add 1 for the filled symbol
  Join join = Join::none;    ///< line between successive points
  bool band = false;         ///< errors of y are drawn as a band
  bool thin = false;         ///< a thin line, for one run of many
  bool large = false;        ///< larger points, which stay visible around smaller points
  std::string variant = {};  ///< name of the curve's variant in the table; "": no variant
  std::vector<ChartPoint> points = {};
  /// Number of independent packings in the curve. 0 if it is not given, and for curves in which
  /// each run contributes to only one point.
  std::size_t runs = 0;
  double shift = 0;  ///< added to x in the drawing, so that points with equal x stay visible
};

/// A dashed line across the frame. With `stub`, a vertical line is a short mark at the lower edge.
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
  Text title = {};           ///< text above the frame, such as "fluid = still"
  bool wide = false;         ///< two journal columns wide (17.8 cm) instead of one (8.6 cm)
  std::string letter = {};   ///< of the panel: "a"
  std::string note = {};     ///< a sentence of the caption, without its full stop
  std::string sources = {};  ///< sources of published numbers, for the caption, without full stop
  /// The meaning of bars and bands, for the caption; "": standard errors over runs.
  std::string errors = {};
};

/// A table that is drawn as text: the first row is the heading.
struct TextTable {
  struct Cell {
    Text text;
    std::string colour = "#000000";
  };
  std::vector<int> widths = {};  ///< widths of the columns [px]
  std::vector<std::vector<Cell>> rows = {};
  Text note = {};
};

/// The data of one panel, with a chart, a text, or neither. With neither, the panel is not drawn.
struct Table {
  std::string name = {};  ///< "S2a": letters, digits, '-' and '_'
  std::vector<TableColumn> columns = {};
  std::vector<TableRow> rows = {};
  Chart chart = {};
  TextTable text = {};

  /// Returns the index of a column, or the number of columns if no column has this name.
  std::size_t place(std::string_view column) const {
    return static_cast<std::size_t>(std::ranges::find(columns, column, &TableColumn::name) -
                                    columns.begin());
  }
};

/// Digits of the numbers in a CSV file. `enough`: digits_between() for the smallest and the largest
/// number of the column. `all`: the shortest text that reads back to the same double.
enum class Digits { enough, all };

/// RFC 4180 with a header row and "\n" line ends. A number that is not finite is an empty field.
std::string to_csv(const Table& table, Digits digits = Digits::enough);

/// An array with one object for each row; the keys are in the order of the columns.
nlohmann::ordered_json to_json(const Table& table);

/// The smallest and the largest of some numbers. Without numbers, `low` is larger than `high`.
struct DataRange {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void take(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  /// A place on an axis, a share of the length of the range above `high` or, if `share` is
  /// negative, below `low`. The length is measured on the logarithmic scale if `log`.
  double beyond(double share, bool log) const {
    const double end = share < 0 ? low : high;
    const double room = share * (log ? std::log(high / low) : high - low);
    return log ? end * std::exp(room) : end + room;
  }
};

/// The points of one series that have finite x and y. If the error of y is infinite, only the error
/// is left out. Series::shift is not added.
std::vector<ChartPoint> points_of(const Series& series);

/// Adds the number of runs per point, such as "(3 to 5 runs)", to the title of each series in which
/// this number varies or is less than Series::runs. Readers need this number: if two points average
/// over different runs, the means can differ even if no run changes between these points. If all
/// series have the same numbers, the caption gives them once.
void name_run_counts(Table& table);

/// Number of significant digits for values from `low` to `high`: 9, or more (up to 17) if needed to
/// show high - low to five digits. A relative difference up to 1e-11 is ignored as rounding error.
int digits_between(double low, double high);
std::string digits(double value, int significant = 9);

/// The text without styles. A subscript follows "_", a superscript follows "^".
std::string plain_text(const Text& text);

/// The points_of() the series that the chart draws. A logarithmic axis shows only positive values.
std::vector<ChartPoint> drawn_points(const Chart& chart, const Series& series);
/// Whether the chart draws the reference line.
bool is_drawn(const Chart& chart, const ReferenceLine& line);

/// The caption of a figure: one paragraph that begins with `title` and explains the panels, the
/// error bars and the reference lines.
std::string caption_of(const std::string& title, std::span<const Table> tables);

/// The parts of the text as [[text, style], ...].
nlohmann::json to_json(const Text& text);

/// The chart with its points, for the front end of the report. Equal tables give equal bytes.
nlohmann::json chart_json(const Table& table);

}  // namespace shearcell
