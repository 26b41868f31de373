// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/chart.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/algorithm/string/replace.hpp>
#include <cmath>

#include "provenance/json_text.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

/// A text as a CSV field (RFC 4180), in quotes if it needs them.
std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  return '"' + boost::replace_all_copy(text, "\"", "\"\"") + '"';
}

/// The table cell as a CSV field. If `significant` is 0, a number is written with all digits.
std::string field_text(const TableCell& value, int significant) {
  if (const auto* text = std::get_if<std::string>(&value)) return csv_field(*text);
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return std::to_string(*whole);
  const auto* real = std::get_if<double>(&value);
  if (real == nullptr || !std::isfinite(*real)) return "";
  return significant > 0 ? digits(*real, significant) : json(*real).dump();
}

/// Empty for a cell without a finite number.
std::optional<double> number_in(const TableCell& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  const auto* real = std::get_if<double>(&value);
  if (real == nullptr || !std::isfinite(*real)) return std::nullopt;
  return *real;
}

/// Returns null if the number is missing or not finite, and 0 instead of -0.
json number(const std::optional<double>& value) {
  constexpr int significant = 15;  // digits; readers may zoom into the plot
  return value ? rounded(*value == 0 ? 0 : *value, significant) : json();
}

json to_json(const Axis& axis) {
  return {{"label", to_json(label_of({.name = axis.name, .symbol = axis.symbol}, "  "))},
          {"unit", to_json(axis.unit)},
          {"log", axis.log},
          {"whole", axis.whole},
          {"low", number(axis.low)},
          {"high", number(axis.high)},
          {"clip", axis.clip}};
}

json to_json(const Series& series) {
  json points = json::array();
  for (const ChartPoint& p : points_of(series)) {
    points.push_back(
        {number(p.x + series.shift), number(p.y), number(p.x_error), number(p.y_error)});
  }
  json facts = {{"title", to_json(series.title)},
                {"colour", series.colour},
                {"point", series.point},
                {"line", series.join != Join::none},
                {"dashed", series.join == Join::dashes},
                {"band", series.band},
                {"shift", series.shift},
                {"points", std::move(points)}};
  if (series.thin) facts["thin"] = true;
  if (series.large) facts["large"] = true;
  if (!series.variant.empty()) facts["of"] = series.variant;
  return facts;
}

}  // namespace

Text operator+(Text first, const Text& second) {
  first.parts.insert(first.parts.end(), second.parts.begin(), second.parts.end());
  return first;
}

Text label_of(const Axis& axis, const char* space) {
  Text label = axis.name;
  for (const Text& part :
       {axis.symbol, axis.unit.empty() ? Text() : Text("[") + axis.unit + Text("]")}) {
    if (!part.empty()) label = label.empty() ? part : label + space + part;
  }
  return label;
}

Text formula(std::string_view text) {
  Text result;
  const auto add = [&](std::string_view part, const char* style) {
    if (part.empty()) return;
    if (result.parts.empty() || result.parts.back().style != style) {
      result.parts.push_back({"", style});
    }
    result.parts.back().text += part;
  };
  const auto take = [&](std::size_t length) {
    const std::string_view part = text.substr(0, length);
    text.remove_prefix(part.size());
    return part;
  };
  for (bool inside = false; !text.empty();) {
    const char c = text.front();
    if (c == '$') {
      inside = !inside;
      take(1);
    } else if (inside && (c == '_' || c == '^') && text.size() > 1) {
      take(1);
      const bool braces = text.front() == '{';
      if (braces) take(1);
      std::size_t length = 1;  // bytes of one UTF-8 character
      while (length < text.size() && (static_cast<unsigned char>(text[length]) & 0xC0) == 0x80) {
        ++length;
      }
      add(take(braces ? std::min(text.find('}'), text.size()) : length), c == '_' ? "sub" : "sup");
      if (braces) take(1);
    } else {
      const bool latin = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
      const bool greek = (static_cast<unsigned char>(c) & 0xFE) == 0xCE;  // first of two bytes
      add(take(greek ? 2 : 1), inside && (latin || greek) ? "i" : "");
    }
  }
  return result;
}

int digits_between(double low, double high) {
  const double spread = (high - low) / std::max(std::abs(low), std::abs(high));
  if (!(spread > 1e-11)) return 9;  // a smaller spread is rounding error
  return std::clamp(5 - static_cast<int>(std::floor(std::log10(spread))), 9, 17);
}

std::string digits(double value, int significant) {
  return fmt::format("{:.{}g}", value == 0 ? 0.0 : value, significant);  // no "-0"
}

TableCell cell_of(const json& value) {
  if (value.is_number_float()) return value.get<double>();
  if (value.is_number()) return value.get<std::int64_t>();
  return value.is_null() ? TableCell() : TableCell(value_text(value));
}

json json_of(const TableCell& cell) {
  return std::visit(
      [](const auto& value) -> json {
        if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::monostate>)
          return nullptr;
        else
          return value;
      },
      static_cast<const TableCell::variant&>(cell));
}

nlohmann::ordered_json to_json(const Table& table) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const TableRow& row : table.rows) {
    nlohmann::ordered_json& object = rows.emplace_back(nlohmann::ordered_json::object());
    for (std::size_t c = 0; c < row.size(); ++c) object[table.columns[c].name] = json_of(row[c]);
  }
  return rows;
}

std::string to_csv(const Table& table, Digits precision) {
  std::string text;
  const auto add_line = [&](const auto& cells, auto field) {
    for (const auto& cell : cells) text += field(cell) + ',';
    if (!cells.empty()) text.back() = '\n';
  };
  add_line(table.columns, [](const TableColumn& column) { return csv_field(column.name); });
  std::vector<int> significant(table.columns.size(), 0);
  for (std::size_t k = 0; precision == Digits::enough && k < significant.size(); ++k) {
    DataRange range;
    for (const TableRow& row : table.rows) {
      if (const std::optional<double> value = number_in(row.at(k))) range.take(*value);
    }
    significant[k] = digits_between(range.low, range.high);
  }
  for (const TableRow& row : table.rows) {
    add_line(row, [&, k = std::size_t{0}](const TableCell& value) mutable {
      return field_text(value, significant[k++]);
    });
  }
  return text;
}

std::vector<ChartPoint> points_of(const Series& series) {
  std::vector<ChartPoint> points = series.points;
  std::erase_if(points,
                [](const ChartPoint& p) { return !std::isfinite(p.x) || !std::isfinite(p.y); });
  for (ChartPoint& p : points) {
    if (!std::isfinite(p.y_error.value_or(0))) p.y_error.reset();
  }
  return points;
}

void name_run_counts(Table& table) {
  std::vector<Series*> means;
  std::vector<std::string> counts;  // for each mean: "3 to 5 of 6"; "" if no run is missing
  for (Series& series : table.chart.series) {
    DataRange averaged;
    for (const ChartPoint& point : points_of(series)) {
      if (point.runs) averaged.take(*point.runs);
    }
    const auto [fewest, most] = averaged;
    if (!(most > 0)) continue;
    const double all = std::max(static_cast<double>(series.runs), most);
    means.push_back(&series);
    std::string& count = counts.emplace_back();
    if (fewest >= all) continue;
    count = fmt::format("{}", fewest);
    if (fewest < most) count += fmt::format(" to {}", most);
    if (most < all) count += fmt::format(" of {}", all);
  }
  const bool equal = std::ranges::all_of(counts, [&](const auto& c) { return c == counts[0]; });
  if (counts.size() > 1 && equal && !counts[0].empty()) {
    return add_note(table.chart.note, fmt::format("Means over {} runs each", counts[0]), ". ");
  }
  for (std::size_t k = 0; k < means.size(); ++k) {
    if (counts[k].empty()) continue;
    Text& title = means[k]->title;
    title = title.empty() ? Text(counts[k] + " runs") : title + Text(" (" + counts[k] + " runs)");
  }
}

std::string plain_text(const Text& text) {
  std::string plain;
  for (const TextPart& part : text.parts) {
    plain += (part.style == "sub" ? "_" : part.style == "sup" ? "^" : "") + part.text;
  }
  return plain;
}

std::vector<ChartPoint> drawn_points(const Chart& chart, const Series& series) {
  std::vector<ChartPoint> points = points_of(series);
  std::erase_if(points, [&](const ChartPoint& p) {
    return (chart.x.log && p.x <= 0) || (chart.y.log && p.y <= 0);
  });
  return points;
}

bool is_drawn(const Chart& chart, const ReferenceLine& line) {
  return line.at > 0 || !(line.vertical ? chart.x : chart.y).log;
}

std::string caption_of(const std::string& title, std::span<const Table> tables) {
  std::string text = title + (title.ends_with('?') ? "" : ".");
  bool bars = false, bands = false, own_errors = false;
  std::vector<std::string> lines, sources;
  std::vector<std::pair<std::string, std::string>> panels;  // {names of panels, sentence}
  nlohmann::ordered_map<std::string, std::vector<std::string>> notes;  // note -> letters of panels
  std::size_t charts = 0;
  const auto add_once = [](std::vector<std::string>& list, const std::string& one) {
    if (!one.empty() && std::ranges::find(list, one) == list.end()) list.push_back(one);
  };
  for (const Table& table : tables) {
    const Chart& chart = table.chart;
    if (chart.series.empty()) continue;
    ++charts;
    // Consecutive panels with equal axes share one sentence.
    const std::string what = fmt::format("{} against {}{}.", plain_text(label_of(chart.y, " ")),
                                         plain_text(label_of(chart.x, " ")),
                                         chart.errors.empty() ? "" : "; " + chart.errors);
    std::string panel = chart.letter.empty() ? "" : "(" + chart.letter + ")";
    if (!chart.title.empty()) panel += (panel.empty() ? "" : " ") + plain_text(chart.title);
    if (panels.empty() || what != panels.back().second) panels.emplace_back("", what);
    std::string& names = panels.back().first;
    if (!panel.empty()) names += (names.empty() ? "" : ", ") + panel;
    own_errors = own_errors || !chart.errors.empty();
    std::size_t lost = 0;
    for (const Series& series : chart.series) {
      const std::vector<ChartPoint> points = points_of(series);
      lost += points.size() - drawn_points(chart, series).size();
      for (const ChartPoint& p : points) {
        if (p.y_error && chart.errors.empty()) (series.band ? bands : bars) = true;
      }
    }
    for (const ReferenceLine& line : chart.lines) {
      add_once(lines, plain_text(line.title));
      lost += is_drawn(chart, line) ? 0 : 1;
    }
    if (!chart.note.empty()) notes[chart.note].push_back(chart.letter);
    add_once(sources, chart.sources);
    if (lost > 0) {
      notes[fmt::format("Values that are not positive are not drawn: {}", lost)].push_back(
          chart.letter);
    }
  }
  for (const auto& [names, what] : panels) {
    const bool titled = names.size() > 3;  // more than "(a)"
    text += " " + names + (names.empty() ? "" : titled ? ": " : " ") + what;
  }
  if (bars || bands) {
    text += fmt::format(" {}: standard errors over runs{}.",
                        bars && bands ? "Bars and bands"
                        : bars        ? "Bars"
                                      : "Bands",
                        own_errors ? ", except where stated" : "");
  }
  if (bars || bands || own_errors) text += " Verdicts give 90 % intervals, not standard errors.";
  for (const auto& [note, letters] : notes) {
    const bool of_all = letters.size() == charts || letters.front().empty();
    text += of_all ? " " : fmt::format(" ({}) ", fmt::join(letters, ", "));
    text += note + ".";
  }
  for (const std::string& source : sources) text += " " + source + ".";
  if (!lines.empty()) text += fmt::format(" Reference lines: {}.", fmt::join(lines, "; "));
  return text;
}

json to_json(const Text& text) {
  json parts = json::array();
  for (const TextPart& part : text.parts) parts.push_back({part.text, part.style});
  return parts;
}

json chart_json(const Table& table) {
  const Chart& chart = table.chart;
  json series = json::array();
  for (const Series& one : chart.series) series.push_back(to_json(one));
  json lines = json::array();
  for (const ReferenceLine& line : chart.lines) {
    lines.push_back({{"at", number(line.at)},
                     {"vertical", line.vertical},
                     {"stub", line.stub},
                     {"colour", line.colour}});
  }
  return {{"x", to_json(chart.x)},
          {"y", to_json(chart.y)},
          {"title", to_json(chart.title)},
          {"series", std::move(series)},
          {"lines", std::move(lines)}};
}

}  // namespace shearcell
