// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>

#include "experiments/report/html.hpp"
#include "experiments/report/page.hpp"

namespace shearcell {
namespace {

std::string claim_html(const Verdict& verdict) {
  return fmt::format("<li>{}<div><p>{}</p><p class=\"small\">{}: {}{}</p></div></li>\n",
                     ruling_html(verdict.ruling), escape_html(verdict.claim),
                     escape_html(verdict.quantity), numbers_of(verdict),
                     verdict.note.empty() ? "" : ". " + escape_html(verdict.note));
}

std::string table_html(const ReportPanel& panel) {
  std::vector<HtmlRow> rows;
  for (const std::vector<TextTable::Cell>& row : panel.text.rows) {
    HtmlRow& cells = rows.emplace_back();
    for (const TextTable::Cell& cell : row) {
      cells.push_back({cell.colour == TextTable::Cell().colour
                           ? text_html(cell.text)
                           : fmt::format("<span class=\"tint\" style=\"--tint: {}\">{}</span>",
                                         cell.colour, text_html(cell.text))});
    }
  }
  const HtmlRow head = std::move(rows.front());
  rows.erase(rows.begin());
  return scroll_box(panel.name, html_table(head, rows), "scroll tall") + "<p class=\"small\">" +
         text_html(panel.text.note) + "</p>";
}

}  // namespace

std::string ruling_html(std::optional<Ruling> ruling) {
  if (!ruling) return "";
  const char* mark = ruling == Ruling::agrees ? "✓" : ruling == Ruling::differs ? "✗" : "?";
  return fmt::format("<span class=\"ruling {0}\"><span aria-hidden=\"true\">{1}</span> {0}</span>",
                     name_of(*ruling), mark);
}

std::optional<Ruling> ruling_of(const ReportData& data, const ReportExperiment& experiment) {
  std::vector<Verdict> all;
  for (const std::size_t figure : experiment.figures) {
    const std::vector<Verdict>& own = data.figures.at(figure).summary.verdicts;
    all.insert(all.end(), own.begin(), own.end());
  }
  return overall(all);
}

std::string figure_html(const ReportData& data, const ReportFigure& figure) {
  std::string html = fmt::format(
      "<section class=\"figure\" id=\"figure-{0}\">\n<h3>Figure {1}. "
      "{2}</h3>\n<div class=\"panels\">\n",
      escape_html(figure.id), escape_html(figure.name), escape_html(figure.title));
  for (const ReportPanel& panel : figure.panels) html += panel_html(data, panel);
  html += "</div>\n<ul class=\"claims\">\n";
  for (const Verdict& verdict : figure.summary.verdicts) html += claim_html(verdict);
  html += "</ul>\n";
  for (const auto* list : {&figure.summary.damage, &figure.summary.pruned}) {
    for (const std::string& line : *list) {
      html += fmt::format("<p class=\"warning\">Left out: {}</p>\n", escape_html(line));
    }
  }
  return html + lineage_html(data, figure) + "</section>\n";
}

std::string panel_html(const ReportData& data, const ReportPanel& panel) {
  const std::string name = escape_html(panel.name), id = escape_html(panel.id);
  std::string plot;
  if (data.interactive && !panel.chart.is_null()) {
    plot = fmt::format(
        "<div class=\"plot\" data-chart=\"{}\"><noscript>Plots need JavaScript; "
        "the numbers are below.</noscript></div>",
        id);
  } else if (!panel.drawing.empty()) {
    plot = fmt::format("<img alt=\"{}\" src=\"data:image/svg+xml;base64,{}\">", name,
                       base64(std::as_bytes(std::span(panel.drawing))));
  } else if (!panel.text.rows.empty()) {
    plot = table_html(panel);
  } else if (!data.interactive) {
    plot =
        fmt::format("<p class=\"warning\">No drawing: {}</p>", escape_html(data.drawing_trouble));
  }
  return fmt::format(
      "<figure id=\"panel-{3}\"{4}>\n{1}\n<figcaption>{0} <button type=\"button\" hidden "
      "data-csv=\"{3}\">CSV</button></figcaption>\n<details class=\"numbers\"><summary>Numbers of "
      "{0}</summary><pre tabindex=\"0\" id=\"csv-{3}\">{2}</pre></details>\n</figure>\n",
      name, plot, escape_html(panel.csv), id, panel.text.rows.empty() ? "" : " class=\"wide\"");
}

std::string experiment_html(const ReportData& data, const ReportExperiment& experiment) {
  const std::string name = escape_html(experiment.name);
  std::string html = fmt::format(
      "<section class=\"experiment\" id=\"experiment-{0}\">\n<p class=\"eyebrow\">{0}</p>\n"
      "<h2>{1}</h2>\n",
      name, experiment.question.empty() ? name : escape_html(experiment.question));
  if (experiment.figures.empty()) {
    html += "<p class=\"small\">No figure can be made of this experiment yet.</p>\n";
  } else if (const auto ruling = ruling_of(data, experiment)) {
    html += "<p class=\"verdict\">Verdict: " + ruling_html(ruling) + "</p>\n";
  }
  html += workflow_html(data, experiment);
  for (const std::size_t figure : experiment.figures) {
    html += figure_html(data, data.figures.at(figure));
  }
  return html + run_table_html(data, experiment) + "</section>\n";
}

}  // namespace shearcell
