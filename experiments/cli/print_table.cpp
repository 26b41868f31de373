// SPDX-License-Identifier: GPL-3.0-or-later
// Prints results as JSON, tables and lines of text.
#include <fmt/color.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <sstream>
#include <utility>

#include "experiments/cli/command.hpp"
#include "provenance/json_text.hpp"

namespace shearcell::cli {
namespace {

using Row = std::vector<std::string>;  // cells

constexpr std::size_t kGap = 2;
constexpr std::size_t kNarrowest = 6;  // smallest width of a column whose texts are cut

struct Column {
  std::size_t width = 0;
  bool right = true;  // right-aligned, since all cells are numbers
};

bool is_number(const std::string& cell) {
  return cell.empty() || cell.find_first_not_of("0123456789.-+e:%/") == std::string::npos;
}

/// Column widths; `rows[0]` is the header.
std::vector<Column> measure(const std::vector<Row>& rows) {
  std::vector<Column> columns(rows.front().size());
  for (const Row& row : rows) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      columns[c].width = std::max(columns[c].width, columns_of(row[c]));
      columns[c].right = columns[c].right && (&row == &rows.front() || is_number(row[c]));
    }
  }
  return columns;
}

/// Narrows the widest text columns until the table fits into `limit` terminal columns.
void narrow(std::vector<Column>& columns, std::size_t limit) {
  std::size_t total = kGap * (columns.size() - 1);
  for (const Column& column : columns) total += column.width;
  for (; total > limit; --total) {
    Column* widest = nullptr;
    for (Column& column : columns) {
      if (!column.right && column.width > (widest == nullptr ? kNarrowest : widest->width)) {
        widest = &column;
      }
    }
    if (widest == nullptr) return;
    --widest->width;
  }
}

std::string fitted(const std::string& cell, const Column& column) {
  const bool cut = columns_of(cell) > column.width;
  const std::string shown = cut ? std::string(first_columns(cell, column.width - 1)) + "~" : cell;
  const std::string room(column.width - columns_of(shown), ' ');
  return column.right ? room + shown : shown + room;
}

std::string painted(const std::string& word, const std::string& text) {
  using fmt::terminal_color;
  static const std::map<std::string, terminal_color> colours = {
      {"completed", terminal_color::green},    {"done", terminal_color::green},
      {"ok", terminal_color::green},           {"running", terminal_color::cyan},
      {"failed", terminal_color::red},         {"missing", terminal_color::red},
      {"interrupted", terminal_color::yellow}, {"to extend", terminal_color::yellow},
      {"to replay", terminal_color::yellow}};
  const auto found = colours.find(word);
  return found == colours.end() ? text : fmt::format(fmt::fg(found->second), "{}", text);
}

std::string text_of(const Fact& fact) {
  return fact.text ? *fact.text : short_text(fact.value);
}

}  // namespace

nlohmann::json to_json(const Facts& facts) {
  nlohmann::json all = nlohmann::json::object();
  for (const Fact& fact : facts) {
    if (!fact.key.empty()) all[fact.key] = fact.value;
  }
  return all;
}

nlohmann::json to_json(const std::vector<Facts>& rows) {
  return list_of(rows, [](const Facts& row) { return to_json(row); });
}

void print_table(const std::vector<Facts>& all) {
  if (all.empty()) return;
  std::vector<Row> rows(1);  // the header
  for (const Facts& facts : all) {
    Row cells;
    rows.front().clear();
    for (const Fact& fact : facts) {
      if (!fact.heading) continue;
      rows.front().push_back(*fact.heading);
      cells.push_back(for_terminal(text_of(fact)));
    }
    rows.push_back(std::move(cells));
  }
  std::vector<Column> columns = measure(rows);
  if (const auto limit = terminal_columns(stdout)) narrow(columns, *limit);
  const bool colours = shows_colours(stdout);
  for (const Row& row : rows) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (c > 0) line.append(kGap, ' ');
      std::string text = fitted(row[c], columns[c]);
      if (c + 1 == row.size()) text.erase(text.find_last_not_of(' ') + 1);
      if (colours && &row == &rows.front()) text = fmt::format(fmt::emphasis::bold, "{}", text);
      if (colours && &row != &rows.front()) text = painted(row[c], text);
      line += text;
    }
    line.erase(line.find_last_not_of(' ') + 1);
    fmt::print("{}\n", line);
  }
}

void print_lines(const Facts& facts) {
  std::size_t widest = 0;
  for (const Fact& fact : facts) widest = std::max(widest, fact.heading.value_or("").size());
  for (const Fact& fact : facts) {
    if (!fact.heading) continue;
    std::string heading = *fact.heading;
    std::istringstream lines(text_of(fact));
    for (std::string line; std::getline(lines, line);) {
      print_text("{:<{}}  {}\n", std::exchange(heading, ""), widest, line);
    }
  }
}

void print_list(const char* name, const std::vector<Facts>& rows, const Context& context) {
  if (context.json) return print_json({{name, to_json(rows)}});
  print_table(rows);
}

}  // namespace shearcell::cli
