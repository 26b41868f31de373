// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/gnuplot_script.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace shearcell {
namespace {

constexpr std::string_view style =
    "set encoding utf8\n"
    "set datafile separator ','\n"
    "set border 15 lw 1.2\n"
    "set xtics in mirror scale 0.9,0.5\n"
    "set ytics in mirror scale 0.9,0.5\n"
    "set format '%h'\n"
    "set mxtics 2\n"
    "set mytics 2\n"
    // Ranges end a little outside the data, not at the next tick, so that no point or bar is cut.
    "set autoscale noextend\n"
    // Above the frame, the one place where no data can be.
    "set key above horizontal center noautotitle Left reverse samplen 1.5 width 2\n"
    "set bars 0.5\n";

/// gnuplot's single-quoted text, in which only the quote itself is special.
std::string literal(const std::string& text) {
  std::string inside;
  for (const char c : text) {
    if (c == '\'') inside += '\'';
    if (static_cast<unsigned char>(c) >= 0x20) inside += c;  // a line end would end the text
  }
  return fmt::format("'{}'", inside);
}

/// gnuplot's enhanced text.
std::string markup(const Text& text) {
  std::string result;
  for (const TextRun& run : text.runs) {
    std::string plain;
    for (const char c : run.text) {
      if (std::string_view("_^@&{}\\~").find(c) != std::string_view::npos) plain += '\\';
      plain += c;
    }
    result += run.style == "i"     ? "{/:Italic " + plain + "}"
              : run.style == "sub" ? "_{" + plain + "}"
              : run.style == "sup" ? "^{" + plain + "}"
                                   : plain;
  }
  return result;
}

std::string label_of(const Axis& axis) {
  std::string label = markup(axis.name);
  for (const std::string& part :
       {markup(axis.symbol), axis.unit.empty() ? "" : "[" + markup(axis.unit) + "]"}) {
    if (!part.empty()) label += (label.empty() ? "" : "  ") + part;
  }
  return label;
}

/// What an axis has to show.
struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void take(double value, const std::optional<double>& error) {
    low = std::min({low, value, value - error.value_or(0)});
    high = std::max({high, value, value + error.value_or(0)});
  }
};

/// One end of a range: fixed, or that of the data and of the reference lines.
std::string end_of(const std::optional<double>& fixed, bool holds, const std::string& otherwise) {
  return fixed && holds ? digits(*fixed) : otherwise;
}

class Script {
 public:
  explicit Script(const FigureTable& table) : table_(table), chart_(table.chart) {
    for (const Series& series : chart_.series) {
      points_.push_back(points_of(table, series));
      for (const ChartPoint& p : points_.back()) {
        x_.take(p.x + series.shift, p.x_error);
        y_.take(p.y, p.y_error);
      }
    }
    any_ = x_.low <= x_.high;
  }

  std::string text() {
    if (!chart_.title.empty()) {
      add("set title {} font ',12'\n", literal(markup(chart_.title)));
    }
    if (!any_) {
      add("set xlabel {}\nset ylabel {}\n", literal(label_of(chart_.x)),
          literal(label_of(chart_.y)));
      add("set label 'no data' at graph 0.5, graph 0.5 center\nplot [0:1] [0:1] NaN notitle\n");
      return text_;
    }
    axis("x", chart_.x, x_);
    axis("y", chart_.y, y_);
    offsets();
    for (const ReferenceLine& line : chart_.lines) reference(line);
    const char* separator = "plot ";
    for (std::size_t k = 0; k < chart_.series.size(); ++k) inline_points(k);
    for (std::size_t k = 0; k < chart_.series.size(); ++k) {
      for (const std::string& part : parts(k)) {
        add("{}{}", separator, part);
        separator = ", \\\n     ";
      }
    }
    return text_ + "\n";
  }

 private:
  template <class... Values>
  void add(fmt::format_string<Values...> format, Values&&... values) {
    text_ += fmt::format(format, std::forward<Values>(values)...);
  }

  static bool low_holds(const Axis& axis, const Extent& data) {
    return axis.low && (axis.clip || data.low >= *axis.low);
  }
  static bool high_holds(const Axis& axis, const Extent& data) {
    return axis.high && (axis.clip || data.high <= *axis.high);
  }

  void axis(const char* name, const Axis& axis, const Extent& data) {
    add("set {}label {}\n", name, literal(label_of(axis)));
    if (axis.log) {
      add("set logscale {}\n", name);
      if (std::log10(data.high / data.low) > 1)
        add("set format {0} '10^{{%T}}'\nset m{0}tics 10\n", name);
    }
    if (axis.whole && data.high <= 10) add("set {0}tics 1\nunset m{0}tics\n", name);
    // The range includes every horizontal line, with a little room.
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const ReferenceLine& line : chart_.lines) {
      if (line.vertical || *name != 'y') continue;
      low = std::min(low, line.at);
      high = std::max(high, line.at);
    }
    const bool lines = low < high;
    const double room = lines ? (high - low) / 4 : 0;
    add("set {}range [{}:{}]\n", name,
        end_of(axis.low, low_holds(axis, data), lines ? "*<" + digits(low - room) : "*"),
        end_of(axis.high, high_holds(axis, data), lines ? digits(high + room) + "<*" : "*"));
  }

  /// Room at the ends that the data decide.
  void offsets() {
    const auto room = [](bool fixed, const char* share) { return fixed ? "0" : share; };
    add("set offsets {}, {}, {}, {}\n", room(low_holds(chart_.x, x_), "graph 0.03"),
        room(high_holds(chart_.x, x_), "graph 0.03"), room(high_holds(chart_.y, y_), "graph 0.05"),
        room(low_holds(chart_.y, y_), "graph 0.05"));
  }

  void reference(const ReferenceLine& line) {
    const std::string at = digits(line.at);
    if (line.vertical) {
      add("set arrow from {0}, graph 0 to {0}, graph {1} nohead {2} lc rgb '{3}'\n", at,
          line.stub ? "0.06" : "1", line.stub ? "lw 2" : "dt 2", line.colour);
    } else {
      add("set arrow from graph 0, first {0} to graph 1, first {0} nohead dt 2 lc rgb '{1}'\n", at,
          line.colour);
    }
  }

  void inline_points(std::size_t k) {
    if (!chart_.series[k].columns.x.empty() || points_[k].empty()) return;
    add("$points{} << EOD\n", k);
    const auto field = [](const std::optional<double>& value) {
      return value ? digits(*value) : std::string();
    };
    for (const ChartPoint& p : points_[k]) {
      add("{},{},{},{}\n", digits(p.x), digits(p.y), field(p.x_error), field(p.y_error));
    }
    add("EOD\n");
  }

  /// The columns of a series as gnuplot names them; 0 for an error that there is not.
  struct Source {
    std::string file;
    std::string x;
    std::string condition;  ///< that a row belongs to the series; empty when all do
    int y = 2;
    int x_error = 3;
    int y_error = 4;
  };

  Source source_of(std::size_t k) const {
    const Series& series = chart_.series[k];
    const SeriesColumns& columns = series.columns;
    if (columns.x.empty()) return {fmt::format("$points{}", k), shifted("1", series), ""};
    const auto number = [&](const std::string& name) {
      return name.empty() ? 0 : column_number(table_, name);
    };
    const int x = number(columns.x);
    Source source{
        "data", "", "", number(columns.y), number(columns.x_error), number(columns.y_error)};
    if (!series.filter.column.empty()) {
      const int filter = number(series.filter.column);
      const auto* text = std::get_if<std::string>(&series.filter.value);
      const auto* whole = std::get_if<std::int64_t>(&series.filter.value);
      source.condition = text != nullptr ? fmt::format("strcol({}) eq {}", filter, literal(*text))
                         : whole != nullptr
                             ? fmt::format("column({}) == {}", filter, *whole)
                             : fmt::format("column({}) == {}", filter,
                                           digits(std::get<double>(series.filter.value)));
    }
    source.x = columns.x_high.empty() ? shifted(std::to_string(x), series)
                                      : fmt::format("((${}+${})/2)", x, number(columns.x_high));
    return source;
  }

  static std::string shifted(const std::string& column, const Series& series) {
    return series.shift == 0 ? column : fmt::format("(${} + {})", column, digits(series.shift));
  }

  static std::string where(const std::string& condition, const std::string& value) {
    return condition.empty() ? value : fmt::format("({} ? {} : NaN)", condition, value);
  }

  /// Every how many cycles a joined curve has a mark, so that marks stay apart.
  std::size_t spacing(std::size_t k) const {
    constexpr std::size_t most_marks = 60;
    if (!chart_.x.whole || chart_.series[k].join == Join::none) return 1;
    std::size_t longest = 0;
    for (const auto& points : points_) longest = std::max(longest, points.size());
    std::size_t every = 1;
    for (const std::size_t step : {2U, 5U, 10U, 20U, 50U, 100U, 200U, 500U, 1000U}) {
      if (longest / every > most_marks) every = step;
    }
    return every;
  }

  /// What the plot command says of a series: errors, line, points. `yerrorbars` alone would leave
  /// out points without an error.
  std::vector<std::string> parts(std::size_t k) const {
    const Series& series = chart_.series[k];
    const std::string title =
        series.title.empty() ? "notitle" : "title " + literal(markup(series.title));
    const std::string line =
        fmt::format("lc rgb '{}'{}", series.colour, series.join == Join::dashes ? " dt 2" : "");
    const std::string mark = fmt::format("pt {} ps 0.6", series.point);
    const char* how = series.point == 0           ? "lines"
                      : series.join == Join::none ? "points"
                                                  : "linespoints";
    const std::string look = series.point == 0 ? line : line + " " + mark;
    if (points_[k].empty()) return {fmt::format("keyentry with {} {} {}", how, look, title)};

    const Source source = source_of(k);
    const std::string y = fmt::format("column({})", source.y);
    const std::string values =
        source.condition.empty() ? std::to_string(source.y) : where(source.condition, y);
    const std::size_t every = spacing(k);
    const std::string marked =
        every == 1 ? values
                   : where(fmt::format("{}int(column({})) % {} == 0",
                                       source.condition.empty() ? "" : source.condition + " && ",
                                       source.x, every),
                           y);
    std::vector<std::string> found;
    if (series.band && source.y_error > 0) {
      const std::string error = fmt::format("column({})", source.y_error);
      found.push_back(fmt::format(
          "{} using {}:{}:{} with filledcurves fc rgb '{}' fs transparent solid 0.2 noborder "
          "notitle",
          source.file, source.x, where(source.condition, y + "-" + error),
          where(source.condition, y + "+" + error), series.colour));
    } else if (source.y_error > 0) {
      const bool both = source.x_error > 0;
      found.push_back(fmt::format("{} using {}:{}:{}{} with {} lc rgb '{}' lw 0.8 pt 0 notitle",
                                  source.file, source.x, marked,
                                  both ? fmt::format("{}:", source.x_error) : "", source.y_error,
                                  both ? "xyerrorbars" : "yerrorbars", series.colour));
    }
    if (every == 1) {
      found.push_back(fmt::format("{} using {}:{} with {} {} {}", source.file, source.x, values,
                                  how, look, title));
    } else {
      found.push_back(
          fmt::format("{} using {}:{} with lines {} notitle", source.file, source.x, values, line));
      found.push_back(fmt::format("{} using {}:{} with points {} {}", source.file, source.x, marked,
                                  look, title));
    }
    return found;
  }

  const FigureTable& table_;
  const Chart& chart_;
  std::vector<std::vector<ChartPoint>> points_;  ///< of each series
  Extent x_;
  Extent y_;
  bool any_ = false;
  std::string text_;
};

constexpr int row_height = 26;  // of a table drawn as text [px]
constexpr int cell_margin = 10;

int width_of(const TextTable& table) {
  int width = 0;
  for (const int column : table.widths) width += column;
  return width;
}

int height_of(const TextTable& table) {
  return row_height * (static_cast<int>(table.rows.size()) + 1);
}

/// Texts at places of the drawing; the first column is left aligned, others are centred.
std::string text_table_commands(const TextTable& table) {
  std::string text = "unset border\nunset tics\nunset key\nset margins 0,0,0,0\n";
  const double width = width_of(table), height = height_of(table);
  int y = row_height / 2 + 3;
  const auto label = [&](const Text& words, int x, const char* how, const std::string& colour) {
    text += fmt::format("set label {} at screen {:.5f}, screen {:.5f} {} tc rgb '{}'\n",
                        literal(markup(words)), x / width, 1 - y / height, how, colour);
  };
  for (std::size_t r = 0; r < table.rows.size(); ++r, y += row_height) {
    int left = 0;
    for (std::size_t k = 0; k < table.rows[r].size(); ++k) {
      const TextTable::Cell& cell = table.rows[r][k];
      label(cell.text, k == 0 ? cell_margin : left + table.widths.at(k) / 2,
            k == 0 ? "left" : "center", cell.colour);
      left += table.widths.at(k);
    }
    if (r > 0 && r + 1 < table.rows.size() && r != 1) continue;
    text += fmt::format(
        "set arrow from screen 0, screen {0:.5f} to screen 1, screen {0:.5f} nohead lw 0.8\n",
        1 - (y + row_height / 2) / height);
  }
  label(table.note, cell_margin, "left", "#555555");
  return text + "plot [0:1] [0:1] NaN\n";
}

}  // namespace

std::string gnuplot_script(const FigureTable& table) {
  const bool words = !table.text.rows.empty();
  return fmt::format(
      "{}{},{} enhanced font 'Helvetica,14' background '#ffffff'\n{}set output '{}.svg'\ndata = "
      "'{}.csv'\n{}set output\n",
      gnuplot_script_beginning, words ? width_of(table.text) : table.chart.width,
      words ? height_of(table.text) : table.chart.height, style, table.name, table.name,
      words ? text_table_commands(table.text) : Script(table).text());
}

}  // namespace shearcell
