// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <vector>

#include "experiments/manifest/parameters.hpp"
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
    for (const auto& [text, colour] : row) {
      cells.push_back(colour == TextTable::Cell().colour
                          ? text_html(text)
                          : fmt::format("<span class=\"tint\" style=\"--tint: {}\">{}</span>",
                                        colour, text_html(text)));
    }
  }
  const HtmlRow head = std::move(rows.front());
  rows.erase(rows.begin());
  return scroll_box(panel.name, html_table(head, rows), "scroll tall") + "<p class=\"small\">" +
         text_html(panel.text.note) + "</p>";
}

struct Count {
  const char* css_class;
  const char* mark;  ///< distinguishes the states without colour
  const char* name;
  std::size_t number;
};

/// A bar with a part for each state, and the counts below it.
std::string counts_html(const std::vector<Count>& counts) {
  std::string bar, list;
  for (const Count& count : counts) {
    if (count.number == 0) continue;
    bar += fmt::format("<span class=\"{}\" style=\"flex-grow: {}\"></span>", count.css_class,
                       count.number);
    list += fmt::format("<li class=\"{}\"><span aria-hidden=\"true\">{}</span> {} {}</li>",
                        count.css_class, count.mark, count.number, count.name);
  }
  if (list.empty()) return "<p>none</p>";
  return "<div class=\"bar\" aria-hidden=\"true\">" + bar + "</div><ul>" + list + "</ul>";
}

std::string box_html(const char* title, const std::string& html) {
  return fmt::format("<li class=\"box\"><h4>{}</h4>{}</li>\n", title, html);
}

std::string stages_html(const ReportExperiment& experiment, bool prepare) {
  std::map<RunState, std::size_t> in;
  for (const RunRecord& run : experiment.runs) {
    if ((run.kind == name_of(Stage::prepare)) == prepare) ++in[run.state];
  }
  return counts_html({{"done", "✓", "done", in[RunState::completed]},
                      {"running", "▸", "running", in[RunState::running]},
                      {"stopped", "‖", "interrupted", in[RunState::interrupted]},
                      {"failed", "✗", "failed", in[RunState::failed]},
                      {"waiting", "·", "waiting", in[RunState::declared]}});
}

std::string checkpoints_html(const ReportData& data, const ReportExperiment& experiment) {
  std::map<CheckpointState, std::size_t> count;
  for (const RunRecord& run : experiment.runs) {
    for (const CheckpointHistory& c : data.runs.at(run.id).checkpoints) ++count[c.record.state];
  }
  return counts_html({{"done", "✓", "stored", count[CheckpointState::recorded]},
                      {"stopped", "‖", "pruned", count[CheckpointState::pruned]},
                      {"failed", "✗", "damaged", count[CheckpointState::rejected]},
                      {"waiting", "·", "to come, at most", experiment.checkpoints_left}});
}

std::string figures_html(const ReportData& data, const ReportExperiment& experiment) {
  std::string names;
  for (const std::size_t index : experiment.figures) {
    names += " " + figure_link(data.figures.at(index));
  }
  for (const std::string& name : experiment.unmade) names += " " + escape_html(name);
  return counts_html({{"done", "✓", "made", experiment.figures.size()},
                      {"failed", "✗", "cannot be made", experiment.unmade.size()}}) +
         (names.empty() ? "" : "<p>" + names.substr(1) + "</p>");
}

std::string manifest_html(const ReportExperiment& experiment) {
  return fmt::format("<p><a href=\"#manifest-{0}\">{1}</a></p><p class=\"id\">{0}</p>",
                     brief(experiment.manifest.sha256), escape_html(experiment.manifest_path));
}

/// Boxes from the manifest to the figures of the experiment, with the states of each. The style
/// sheet arranges them in a row or, on a narrow page, in a column.
std::string workflow_html(const ReportData& data, const ReportExperiment& experiment) {
  return fmt::format("<ol class=\"workflow\" aria-label=\"Workflow of {}\">\n",
                     escape_html(experiment.manifest.experiment)) +
         box_html("Manifest", manifest_html(experiment)) +
         box_html("Packings", stages_html(experiment, true)) +
         box_html("Runs", stages_html(experiment, false)) +
         box_html("Checkpoints", checkpoints_html(data, experiment)) +
         box_html("Figures", figures_html(data, experiment)) + "</ol>\n";
}

}  // namespace

std::string question_html(const ReportExperiment& experiment) {
  const RegisteredManifest& manifest = experiment.manifest;
  return escape_html(manifest.question.empty() ? manifest.experiment : manifest.question);
}

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

std::string figure_link(const ReportFigure& figure) {
  return fmt::format("<a href=\"#figure-{}\">{}</a>", escape_html(figure.id),
                     escape_html(figure.summary.name));
}

std::string figure_html(const ReportData& data, const ReportFigure& figure) {
  std::string html = fmt::format(
      "<section class=\"figure\" id=\"figure-{0}\">\n<h3>Figure {1}. "
      "{2}</h3>\n<div class=\"panels\">\n",
      escape_html(figure.id), escape_html(figure.summary.name), escape_html(figure.summary.title));
  for (const ReportPanel& panel : figure.panels) html += panel_html(data, panel);
  html += "</div>\n<ul class=\"claims\">\n";
  for (const Verdict& verdict : figure.summary.verdicts) html += claim_html(verdict);
  html += "</ul>\n";
  for (const auto* list : {&figure.summary.damage, &figure.summary.pruned}) {
    for (const std::string& line : *list) {
      html += fmt::format("<p class=\"warning\">Left out: {}</p>\n", escape_html(line));
    }
  }
  for (const std::string& line : figure.summary.notes) {
    html += fmt::format("<p class=\"warning\">{}</p>\n", escape_html(line));
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
    plot = fmt::format("<p class=\"warning\">No drawing: {}</p>", escape_html(panel.trouble));
  }
  return fmt::format(
      "<figure id=\"panel-{3}\"{4}>\n{1}\n<figcaption>{0} <button type=\"button\" hidden "
      "data-csv=\"{3}\">CSV</button></figcaption>\n<details class=\"numbers\"><summary>Numbers of "
      "{0}</summary><pre tabindex=\"0\" id=\"csv-{3}\">{2}</pre></details>\n</figure>\n",
      name, plot, escape_html(panel.csv), id, panel.text.rows.empty() ? "" : " class=\"wide\"");
}

std::string experiment_html(const ReportData& data, const ReportExperiment& experiment) {
  std::string html = fmt::format(
      "<section class=\"experiment\" id=\"experiment-{0}\">\n<p class=\"eyebrow\">{0}</p>\n"
      "<h2>{1}</h2>\n",
      escape_html(experiment.manifest.experiment), question_html(experiment));
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
