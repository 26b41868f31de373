// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <string_view>

#include "experiments/manifest/schema.hpp"
#include "experiments/report/html.hpp"
#include "experiments/report/page.hpp"
#include "provenance/json_text.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

using nlohmann::json;
using CellText = std::function<std::string(const json& value)>;

/// A column of the page.
struct ShownColumn {
  std::size_t at = 0;  ///< column of RunTable
  std::string head;    ///< HTML
  CellText text;       ///< HTML
  bool number = true;
};

std::string as_text(const json& value) {
  return escape_html(short_text(value));
}

CellText decimals(int count, double factor = 1) {
  return [=](const json& value) {
    return fmt::format("{:.{}f}", factor * value.get<double>(), count);
  };
}

std::string record_link(const json& id) {
  return run_link(id.get_ref<const std::string&>(), 8);
}

std::string state_html(const json& state) {
  return fmt::format("<span class=\"state {0}\">{0}</span>", as_text(state));
}

std::string duration(const json& seconds) {
  return seconds.get<double>() > 0 ? format_duration(seconds.get<double>()) : "";
}

/// A heading: "<i>A</i> [rad]" for amplitude_rad, "fluid" for fluid.
std::string head_of(const std::string& key) {
  const Field* field = find_field(key);
  if (field == nullptr || field->symbol.empty()) {
    std::string words = key;
    std::ranges::replace(words, '_', ' ');
    return escape_html(words);
  }
  return fmt::format("<i>{}</i>{}", field->symbol,
                     field->unit == "1" ? "" : fmt::format(" [{}]", field->unit));
}

std::vector<ShownColumn> columns_of(const ReportExperiment& experiment) {
  const std::vector<TableColumn>& all = experiment.table.columns;
  const auto place = [&](std::string_view name) { return experiment.table.place(name); };
  const auto several = [&](std::string_view name) {
    const std::size_t at = place(name);
    const auto& rows = experiment.table.rows;
    return std::ranges::any_of(rows, [&](const auto& row) { return row[at] != rows.front()[at]; });
  };
  std::vector<std::string> swept;  // between the seed and the cycle
  for (std::size_t c = place("seed") + 1; c < place("cycle"); ++c) {
    if (all[c].name != "grains") swept.push_back(all[c].name);  // has a column of its own below
  }

  std::vector<ShownColumn> shown = {{place("run"), "run", record_link, false}};
  if (several("scale")) shown.push_back({place("scale"), "scale", as_text, false});
  if (experiment.labelled || swept.empty()) {
    shown.push_back({place("variant"), "variant", as_text, false});
  }
  for (const std::string& key : swept) {
    const Field* field = find_field(key);
    shown.push_back({place(key), head_of(key), as_text, field != nullptr && !field->unit.empty()});
  }
  shown.insert(shown.end(),
               std::initializer_list<ShownColumn>{
                   {place("seed"), "seed", as_text},
                   {place("grains"), "<i>N</i>", as_text},
                   {place("state"), "state", state_html, false},
                   {place("cycle"), "cycle", as_text},
                   {place("target_cycles"), "of", as_text},
                   {place("phi"), "<i>ϕ</i>", decimals(4)},
                   {place("crystalline_percent"), "crystalline [%]", decimals(1)},
                   {place("largest_crystallite"), "largest crystallite", as_text},
                   {place("onset_size_cycle"), "onset cycle", as_text},
                   {place("onset_size_phi"), "onset <i>ϕ</i>", decimals(4)},
                   {place("wall_time_s"), "time", duration},
                   {place("particle_steps_per_s"), "10<sup>6</sup> steps/s", decimals(1, 1e-6)}});
  return shown;
}

/// The value by which the browser sorts and filters.
std::string value_attribute(const json& value) {
  if (value.is_null()) return "";
  return fmt::format(" data-value=\"{}\"",
                     escape_html(value.is_string() ? value.get<std::string>() : value.dump()));
}

std::string table_head(const ReportExperiment& experiment,
                       const std::vector<ShownColumn>& columns) {
  std::string html = "<thead><tr>";
  for (const ShownColumn& column : columns) {
    const TableColumn& source = experiment.table.columns.at(column.at);
    html += fmt::format("<th scope=\"col\"{} data-key=\"{}\" title=\"{}\">{}</th>",
                        column.number ? " class=\"number\"" : "", escape_html(source.name),
                        escape_html(source.meaning), column.head);
  }
  return html + "<th><span class=\"visually-hidden\">packings</span></th></tr></thead>\n";
}

std::string row_html(const ReportData& data, const std::vector<json>& row, std::size_t number,
                     const std::vector<ShownColumn>& columns) {
  std::string html = fmt::format("<tbody data-row=\"{}\"><tr>", number);
  for (const ShownColumn& column : columns) {
    const json& value = row.at(column.at);
    html += fmt::format("<td{}{}>{}{}</td>", column.number ? " class=\"number\"" : "",
                        value_attribute(value), card_label(column.head),
                        value.is_null() ? "<span class=\"none\">–</span>" : column.text(value));
  }
  const json& id = row.at(columns.front().at);
  const bool packed =
      std::ranges::any_of(data.packings.runs, [&](const json& run) { return run.at("id") == id; });
  return html +
         (packed ? fmt::format("<td><a hidden data-packing=\"{}\" href=\"#packings\">3D</a></td>",
                               escape_html(id.get<std::string>()))
                 : "<td></td>") +
         "</tr></tbody>\n";
}

}  // namespace

std::string run_table_html(const ReportData& data, const ReportExperiment& experiment) {
  if (experiment.table.rows.empty()) return "";
  const std::vector<ShownColumn> columns = columns_of(experiment);
  std::string html = fmt::format(
      "<h3 id=\"table-{0}\">Runs</h3>\n<div class=\"runs\" data-runs=\"{0}\">\n<table "
      "class=\"cards\" "
      "aria-label=\"Runs of {0}\">",
      escape_html(experiment.manifest.experiment));
  html += table_head(experiment, columns);
  for (std::size_t r = 0; r < experiment.table.rows.size(); ++r) {
    html += row_html(data, experiment.table.rows[r], r, columns);
  }
  return html + "</table></div>\n";
}

}  // namespace shearcell
