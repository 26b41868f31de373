// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "analysis/plot.hpp"

namespace shearcell {
namespace {

// In pixels, at 96 px per inch. The widths are 8.6 cm and 17.8 cm.
constexpr int column_width = 325, double_width = 673, chart_height = 215, key_row = 15;
constexpr double type_size = 10.67;  // 8 pt

constexpr std::string_view style =
    "set encoding utf8\n"
    "set datafile separator ','\n"
    "set border 15 lw 0.8\n"
    "set xtics in mirror scale 0.9,0.5\n"
    "set ytics in mirror scale 0.9,0.5\n"
    "set mxtics 2\n"
    "set mytics 2\n"
    // Ranges do not extend to the next tick. They end a little outside the data, so that no point
    // or bar is cut.
    "set autoscale noextend\n"
    // The legend is above the frame, since inside the frame it could hide data.
    "set key above horizontal center noautotitle Left reverse samplen 1.2 spacing 0.9\n";

/// The text in gnuplot's enhanced markup, as a single-quoted gnuplot string. In such a string each
/// quote is doubled. The `\` before a quote is needed, too: without it, gnuplot misreads a string
/// that begins with a quote or contains `''`. The `{}` after a backslash prevents gnuplot from
/// reading `\\U+0041` as the character "A".
std::string literal(const Text& text) {
  std::string result;
  for (const TextPart& part : text.parts) {
    std::string plain;
    for (const char c : part.text) {
      if (static_cast<unsigned char>(c) < 0x20) continue;  // a line break would end the string
      if (std::string_view("_^@&{}\\~'").find(c) != std::string_view::npos) plain += '\\';
      if (c == '\'') plain += c;
      plain += c;
      if (c == '\\') plain += "{}";
    }
    result += part.style == "i"     ? "{/:Italic " + plain + "}"
              : part.style == "sub" ? "_{" + plain + "}"
              : part.style == "sup" ? "^{" + plain + "}"
                                    : plain;
  }
  return "'" + result + "'";
}

/// Takes a value and both ends of its error bar. On a logarithmic axis, the lower end is left out
/// unless it is positive.
void take(double value, const std::optional<double>& error, bool log, DataRange& range) {
  range.take(value);
  range.take(value + error.value_or(0));
  if (const double end = value - error.value_or(0); !log || end > 0) range.take(end);
}

/// Ticks of a logarithmic axis for data whose range contains at most one power of ten. If the
/// highest value is less than four times the lowest, the ticks have equal steps. Otherwise they are
/// 1, 2 and 5 times powers of ten.
std::vector<std::string> ticks_of_decades(const DataRange& data) {
  std::vector<std::string> ticks;
  const bool narrow = data.high < 4 * data.low;
  const double power =
      std::pow(10, std::floor(std::log10(narrow ? (data.high - data.low) / 2 : data.low)));
  const bool one_value = data.high - data.low < 1e-8 * data.low;  // equal up to rounding
  if (one_value || !(power > 0) || !std::isfinite(power)) return {digits(data.low)};
  if (narrow) {
    const double step = power * ((data.high - data.low) / power > 5 ? 2 : 1);
    for (double at = std::ceil(data.low / step - 1e-9); at * step <= data.high * (1 + 1e-9); ++at) {
      ticks.push_back(digits(at * step));
    }
    return ticks;
  }
  for (double decade = power; decade <= data.high; decade *= 10) {
    for (const double at : {decade, 2 * decade, 5 * decade}) {
      if (at >= data.low && at <= data.high) ticks.push_back(digits(at));
    }
  }
  return ticks;
}

/// Size of a drawing, including its legend [px], and the layout of the legend.
struct Layout {
  int width = column_width;
  int height = chart_height;
  std::size_t columns = 1;
  std::size_t longest = 0;  ///< number of letters of the longest title in the legend
};

/// The drawing has the width of two journal columns if the chart is wide, if a title in the legend
/// is too long for one journal column, or if the legend would have more than eight rows.
Layout layout_of(const Chart& chart) {
  constexpr double letter = 5.2, symbol = 32;  // [px]
  constexpr std::size_t most_letters = 42;
  constexpr int most_rows = 8;
  Layout layout;
  std::size_t entries = 0;
  for (const Series& series : chart.series) {
    const std::size_t length = plain_text(series.title).size();
    entries += length > 0 ? 1 : 0;
    layout.longest = std::max(layout.longest, length);
  }
  const auto rows_in = [&](int width) {
    const double entry = letter * static_cast<double>(layout.longest) + symbol;
    layout.columns = std::max<std::size_t>(1, static_cast<std::size_t>((width - 65) / entry));
    return static_cast<int>((entries + layout.columns - 1) / layout.columns);
  };
  int rows = rows_in(column_width);
  if (chart.wide || layout.longest > most_letters || rows > most_rows) {
    layout.width = double_width;
    rows = rows_in(double_width);
  }
  layout.height += key_row * (rows + (chart.title.empty() ? 0 : 1));
  return layout;
}

/// The commands for one chart, including the data that they draw.
class Script {
 public:
  explicit Script(const Table& table) : chart_(table.chart) {
    for (const Series& series : chart_.series) {
      points_.push_back(drawn_points(chart_, series));
      for (ChartPoint& p : points_.back()) {
        p.x += series.shift;
        take(p.x, p.x_error, chart_.x.log, x_);
        take(p.y, p.y_error, chart_.y.log, y_);
      }
      longest_ = std::max(longest_, points_.back().size());
    }
    for (const ReferenceLine& line : chart_.lines) {
      if (line.vertical || !is_drawn(chart_, line)) continue;
      y_.take(line.at);
      lines_ = true;
    }
  }

  std::string text() {
    if (!chart_.title.empty()) add("set title {}\n", literal(chart_.title));
    if (!chart_.letter.empty()) {
      add("set label '({})' at screen 0.015, screen 0.96 left front\n", chart_.letter);
    }
    // gnuplot overestimates the width of legend titles by about a quarter. Without the correction
    // `width`, it would use too few columns.
    const Layout layout = layout_of(chart_);
    add("set key maxcols {} width -{}\n", layout.columns, layout.longest / 4);
    add("set xlabel {}\nset ylabel {}\n", literal(label_of(chart_.x, "  ")),
        literal(label_of(chart_.y, "  ")));
    if (longest_ == 0) {
      add("set label 'no data' at graph 0.5, graph 0.5 center\nplot [0:1] [0:1] NaN notitle\n");
      return text_;
    }
    ticks("x", chart_.x, x_);
    ticks("y", chart_.y, y_);
    ranges();
    for (const ReferenceLine& line : chart_.lines) {
      if (is_drawn(chart_, line)) reference(line);
    }
    for (std::size_t k = 0; k < points_.size(); ++k) data(k);
    // The legend lists the series in order. The first curve is drawn last, on top of the others.
    std::vector<std::string> plots;
    for (const Series& series : chart_.series) plots.push_back(key_entry(series));
    for (const bool bands : {true, false}) {
      for (std::size_t k = points_.size(); k-- > 0;) {
        if (points_[k].empty()) continue;
        if (bands == chart_.series[k].band) errors(k, plots);
        if (!bands) curve(k, plots);
      }
    }
    return text_ + fmt::format("plot {}\n", fmt::join(plots, ", \\\n     "));
  }

 private:
  template <class... Values>
  void add(fmt::format_string<Values...> format, Values&&... values) {
    text_ += fmt::format(format, std::forward<Values>(values)...);
  }

  void ticks(const char* name, const Axis& axis, const DataRange& data) {
    if (axis.log) add("set logscale {}\n", name);
    if (axis.log && std::floor(std::log10(data.high)) > std::ceil(std::log10(data.low))) {
      add("set format {0} '10^{{%T}}'\nset m{0}tics 10\n", name);
    } else if (axis.log) {
      add("unset m{0}tics\nset {0}tics ({1})\n", name, fmt::join(ticks_of_decades(data), ","));
    }
    if (axis.whole && !axis.log && data.high <= 10) add("set {0}tics 1\nunset m{0}tics\n", name);
    if (axis.log || axis.whole) return;
    const double low = std::min(data.low, axis.low.value_or(data.low));
    const double high = std::max(data.high, axis.high.value_or(data.high));
    const double length = axis.clip && axis.low && axis.high ? *axis.high - *axis.low : high - low;
    if (!(length > 0) || !std::isfinite(length)) return;
    // A step of the axis is 1, 2 or 5 times a power of ten. The axis has about five steps, or
    // fewer if the labels of x would touch. All labels have the same number of decimals.
    constexpr double letter = 6, gap = 8, margins = 65;  // [px]
    double step = 0;
    int decimals = 0;
    for (double steps = 5; steps > 0; --steps) {
      const double power = std::pow(10, std::floor(std::log10(length / steps)));
      const double ratio = length / steps / power;
      step = power * (ratio < 1.5 ? 1 : ratio < 3.5 ? 2 : ratio < 7.5 ? 5 : 10);
      decimals = std::clamp(-static_cast<int>(std::floor(std::log10(step) + 1e-9)), 0, 15);
      const double letters =
          static_cast<double>(std::max(fmt::formatted_size("{:.{}f}", low, decimals),
                                       fmt::formatted_size("{:.{}f}", high, decimals)));
      const double room = layout_of(chart_).width - margins;
      if (name == std::string_view("y") || length / step * (letter * letters + gap) < room) break;
    }
    if (step >= 1e6) return;
    add("set {0}tics {1}\nset format {0} '%.{2}f'\n", name, digits(step), decimals);
  }

  /// Sets the ranges of both axes. If an end is not fixed, gnuplot places it a little beyond the
  /// data, but ignores horizontal lines. If there are such lines, the script fixes both ends of y.
  void ranges() {
    const Axis &x = chart_.x, &y = chart_.y;
    const auto outside = [&](double share) {
      return digits(y_.beyond(share, y.log), digits_between(y_.low, y_.high));
    };
    const std::string above = outside(0.05), below = outside(-0.05);
    const bool stated = lines_ && above != below;
    const auto end = [](const std::optional<double>& fixed, bool holds, std::string otherwise) {
      return fixed && holds ? digits(*fixed) : otherwise;
    };
    const auto offset = [](const std::string& end_of_range, const char* beyond) {
      return end_of_range == "*" ? beyond : "0";
    };
    const std::string left = end(x.low, x.clip || x_.low >= x.low, "*");
    const std::string right = end(x.high, x.clip || x_.high <= x.high, "*");
    const std::string top = end(y.high, y.clip || y_.high <= y.high, stated ? above : "*");
    const std::string bottom = end(y.low, y.clip || y_.low >= y.low, stated ? below : "*");
    add("set xrange [{}:{}]\nset yrange [{}:{}]\nset offsets {}, {}, {}, {}\n", left, right, bottom,
        top, offset(left, "graph 0.03"), offset(right, "graph 0.03"), offset(top, "graph 0.05"),
        offset(bottom, "graph 0.05"));
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

  void data(std::size_t k) {
    if (points_[k].empty()) return;
    add("$series{} << EOD\n", k);
    const auto field = [](const std::optional<double>& value) {
      return value ? digits(*value) : std::string();
    };
    for (const ChartPoint& p : points_[k]) {
      add("{},{},{},{}\n", digits(p.x, digits_between(x_.low, x_.high)),
          digits(p.y, digits_between(y_.low, y_.high)), field(p.x_error), field(p.y_error));
    }
    add("EOD\n");
  }

  /// Returns n: a joined curve has a symbol at every n-th point, so that symbols do not overlap.
  std::size_t spacing(const Series& series) const {
    constexpr std::size_t most_marks = 20;
    std::size_t every = 1;
    if (series.join == Join::none) return every;
    for (const std::size_t step : {2U, 5U, 10U, 20U, 50U, 100U, 200U, 500U, 1000U}) {
      if (longest_ / every > most_marks) every = step;
    }
    return every;
  }

  static std::string line_style(const Series& series) {
    return fmt::format("lc rgb '{}' lw {}{}{}", series.colour, series.thin ? 0.6 : 1.2,
                       series.join == Join::dashes ? " dt 2" : "",
                       series.point == 0
                           ? ""
                           : fmt::format(" pt {} ps {}", series.point, series.large ? 1.1 : 0.4));
  }

  static const char* kind_of(const Series& series) {
    return series.point == 0 ? "lines" : series.join == Join::none ? "points" : "linespoints";
  }

  static std::string key_entry(const Series& series) {
    return fmt::format("keyentry with {} {} {}", kind_of(series), line_style(series),
                       series.title.empty() ? "notitle" : "title " + literal(series.title));
  }

  void errors(std::size_t k, std::vector<std::string>& plots) const {
    const Series& series = chart_.series[k];
    const bool any =
        std::ranges::any_of(points_[k], [](const ChartPoint& p) { return p.y_error.has_value(); });
    if (!any) return;
    if (series.band) {
      plots.push_back(
          fmt::format("$series{} using 1:($2-$4):($2+$4) with filledcurves fc rgb '{}' fs "
                      "transparent solid 0.2 noborder notitle",
                      k, series.colour));
      return;
    }
    // On a logarithmic axis, a bar that reaches zero ends at the lowest drawn value, or at
    // Axis::low if that is lower.
    std::string low = "$2-$4";
    const double lowest = std::min(y_.low, chart_.y.low.value_or(y_.low));
    if (chart_.y.log) low = fmt::format("{0}>0?{0}:{1}", low, digits(lowest > 0 ? lowest : y_.low));
    // Error bars are drawn as arrows. The arrow heads are the caps, 2 px to each side. `yerrorbars`
    // is not used, because gnuplot 5.4 then paints white discs behind the points, and these discs
    // hide other curves.
    plots.push_back(
        fmt::format("$series{0} every {1} using 1:({2}):(0):($2+$4-({2})) with vectors heads size "
                    "screen {3},90 "
                    "fixed lc rgb '{4}' lw 0.7 notitle",
                    k, spacing(series), low, digits(2.0 / layout_of(chart_).width), series.colour));
  }

  void curve(std::size_t k, std::vector<std::string>& plots) const {
    const Series& series = chart_.series[k];
    const std::size_t every = spacing(series);
    const std::string drawn = line_style(series);
    if (every > 1)
      plots.push_back(fmt::format("$series{} using 1:2 with lines {} notitle", k, drawn));
    if (every > 1 && series.point == 0) return;
    plots.push_back(fmt::format("$series{} every {} using 1:2 with {} {} notitle", k, every,
                                every > 1 ? "points" : kind_of(series), drawn));
  }

  const Chart& chart_;
  std::vector<std::vector<ChartPoint>> points_;  ///< of each series
  std::size_t longest_ = 0;                      ///< largest number of points of a series
  DataRange x_, y_;     ///< of the drawn points with their error bars, and of horizontal lines
  bool lines_ = false;  ///< y_ includes horizontal lines
  std::string text_;
};

constexpr int row_height = 26;  // of a table drawn as text [px]
constexpr int cell_margin = 10;

int width_of(const TextTable& table) {
  return std::accumulate(table.widths.begin(), table.widths.end(), 0);
}

int height_of(const TextTable& table) {
  return row_height * (static_cast<int>(table.rows.size()) + 1);
}

/// Writes each cell as a label. The first column is left-aligned; the other columns are centred.
std::string text_table_commands(const TextTable& table) {
  std::string text = "unset border\nunset tics\nunset key\nset margins 0,0,0,0\n";
  const double width = width_of(table), height = height_of(table);
  int y = row_height / 2 + 3;
  const auto label = [&](const Text& words, int x, const char* how, const std::string& colour) {
    text += fmt::format("set label {} at screen {:.5f}, screen {:.5f} {} tc rgb '{}'\n",
                        literal(words), x / width, 1 - y / height, how, colour);
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

std::string gnuplot_script(const Table& table) {
  const bool words = !table.text.rows.empty();
  const Layout layout =
      words ? Layout{width_of(table.text), height_of(table.text)} : layout_of(table.chart);
  return fmt::format(
      "{}{},{} enhanced font 'Helvetica,{}' background '#ffffff'\n{}set output '{}.svg'\n{}set "
      "output\n",
      gnuplot_script_beginning, layout.width, layout.height, words ? 14 : type_size, style,
      table.name, words ? text_table_commands(table.text) : Script(table).text());
}

}  // namespace shearcell
