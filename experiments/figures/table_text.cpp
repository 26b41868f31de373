// SPDX-License-Identifier: GPL-3.0-or-later
// A table as CSV and as JSON.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "analysis/chart.hpp"
#include "experiments/figures/run_table.hpp"
#include "experiments/manifest/suggest.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

std::string csv_cell(const json& value) {
  return value.is_null() ? "" : csv_field(value_text(value));
}

ordered_json rows_of(const RunTable& table) {
  ordered_json rows = ordered_json::array();
  for (const std::vector<json>& row : table.rows) {
    ordered_json& object = rows.emplace_back(ordered_json::object());
    for (std::size_t c = 0; c < row.size(); ++c) object[table.columns[c].name] = row[c];
  }
  return rows;
}

std::string text_of(const ordered_json& value) {
  return value.dump(1, ' ', false, json::error_handler_t::replace) + '\n';
}

}  // namespace

std::string to_csv(const RunTable& table) {
  std::string text = fmt::format("{}\n", fmt::join(names_of(table.columns), ","));
  for (const std::vector<json>& row : table.rows) {
    std::vector<std::string> cells;
    std::ranges::transform(row, std::back_inserter(cells), csv_cell);
    text += fmt::format("{}\n", fmt::join(cells, ","));
  }
  return text;
}

std::string to_json(const RunTable& table) {
  return text_of(rows_of(table));
}

std::string to_json_with_notes(const RunTable& table) {
  return text_of({{"rows", rows_of(table)},
                  {"notes", table.notes},
                  {"damage", table.damage},
                  {"pruned", table.pruned}});
}

bool is_table(std::string_view beginning) {
  return beginning.starts_with("experiment,scale,variant,run,seed,") || beginning == "[]\n" ||
         beginning.starts_with("[\n {\n  \"experiment\": ") ||
         beginning.starts_with("{\n \"rows\": [");
}

}  // namespace shearcell
