// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/page.hpp"

#include <fmt/format.h>
#include <openssl/sha.h>

#include <span>
#include <vector>

#include "experiments/report/html.hpp"
#include "provenance/words.hpp"

// Files of the front end (web_assets.S).
extern "C" {
extern const char shearcell_style[], shearcell_style_end[];
extern const char shearcell_script[], shearcell_script_end[];  // empty if built without Node
extern const char shearcell_licences[], shearcell_licences_end[];
}

namespace shearcell {
namespace {

using nlohmann::json;

std::string_view front_end_script() {
  return {shearcell_script, shearcell_script_end};
}

/// The hash of the script for a Content-Security-Policy that allows no other script.
std::string script_hash(std::string_view script) {
  unsigned char digest[SHA256_DIGEST_LENGTH];
  SHA256(reinterpret_cast<const unsigned char*>(script.data()), script.size(), digest);
  return "sha256-" + base64(std::as_bytes(std::span(digest)));
}

std::string head_html(const ReportData& data) {
  const std::string scripts =
      data.interactive ? fmt::format("script-src '{}'; ", script_hash(front_end_script())) : "";
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n"
      // The browser fetches nothing and runs only our script.
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; {}"
      "style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action 'none'\">\n"
      "<title>{} · shearcell report</title>\n<style>\n{}</style>\n</head>\n",
      scripts, escape_html(data.store), std::string_view(shearcell_style, shearcell_style_end));
}

std::string title_html(const ReportData& data) {
  return fmt::format(
      "<header>\n<p class=\"eyebrow\">shearcell report</p>\n<h1>{}</h1>\n<p class=\"lead\">{}, {}, "
      "{}. Log at event {}, <code title=\"{}\">{}</code>. Made by shearcell {} ({}).</p>\n"
      "<label class=\"theme\" hidden>Colours <select id=\"theme\"><option value=\"system\">as the "
      "system</option><option value=\"light\">light</option><option "
      "value=\"dark\">dark</option></select></label>\n</header>\n",
      escape_html(data.store), counted(data.experiments.size(), "experiment"),
      counted(data.figures.size(), "figure"), counted(data.runs.size(), "stage"), data.head.seq,
      escape_html(data.head.hash), brief(data.head.hash),
      escape_html(data.program.value("version", "")),
      escape_html(data.program.value("commit", "")));
}

std::string overview_html(const ReportData& data) {
  std::vector<HtmlRow> rows;
  for (const ReportExperiment& experiment : data.experiments) {
    std::string figures;
    for (const std::size_t index : experiment.figures) {
      figures += figure_link(data.figures.at(index)) + " ";
    }
    rows.push_back(
        {fmt::format("<a href=\"#experiment-{0}\">{1}</a> <span "
                     "class=\"small\">{0}</span>",
                     escape_html(experiment.manifest.experiment), question_html(experiment)),
         ruling_html(ruling_of(data, experiment)), figures,
         std::to_string(experiment.runs.size())});
  }
  std::string html = "<nav aria-label=\"Experiments\">" +
                     html_table({"question", "verdict", "figures", "#stages"}, rows, "overview") +
                     "\n<p class=\"small\">";
  if (data.interactive) html += "<a href=\"#compare\">Two variants side by side</a> · ";
  if (!data.packings.runs.empty()) html += "<a href=\"#packings\">Packings in 3D</a> · ";
  return html +
         "<a href=\"#runs\">Runs and manifests</a> · <a href=\"#about\">About this file</a></p>"
         "</nav>\n";
}

std::string packings_html(const ReportData& data) {
  if (data.packings.runs.empty()) return "";
  return fmt::format(
      "<section id=\"packings\" hidden>\n<h2>Packings</h2>\n<div class=\"viewer\"></div>\n<p "
      "class=\"small\">{} of {}. Positions are rounded to {:.2g} d (16 bits an axis), "
      "φ<sub>local</sub> and q<sub>6</sub> to 1.6e-5; the store has the exact values. Spheres are "
      "drawn with the diameter d, without perspective; x is the shear direction, y points up, z is "
      "periodic. Crystallites consist of interior grains, at least 1.5 d from the walls. Drag to "
      "turn; click, then use the wheel to zoom.</p>\n</section>\n",
      counted(data.packings.frames, "checkpoint"), counted(data.packings.runs.size(), "run"),
      data.packings.largest_step);
}

/// A section that the front end fills.
std::string compare_html(const ReportData& data) {
  if (!data.interactive) return "";
  return "<section id=\"compare\" hidden>\n<h2>Two variants side by side</h2>\n<div "
         "class=\"comparison\"></div>\n</section>\n";
}

/// Figures of all experiments together.
std::string across_html(const ReportData& data) {
  std::string html;
  for (const ReportFigure& figure : data.figures) {
    if (figure.summary.experiment.empty()) html += figure_html(data, figure);
  }
  if (html.empty()) return html;
  return "<section id=\"across\">\n<h2>All experiments together</h2>\n" + html + "</section>\n";
}

std::string about_html(const ReportData& data) {
  std::string html =
      "<section id=\"about\">\n<h2>About this file</h2>\n<p>This file is complete: it fetches "
      "nothing. "
      "Errors are standard errors over runs. It is made from the store alone; the same store gives "
      "the same file.</p>\n";
  if (!data.interactive) {
    html += has_front_end()
                ? "<p>Figures are drawings, as requested.</p>\n"
                : "<p>Figures are drawings, and there are no packings: this program was built "
                  "without Node, which bundles the interactive part.</p>\n";
  } else {
    html += fmt::format(
        "<details><summary>Licences of the libraries in this file</summary><pre "
        "tabindex=\"0\">{}</pre></details>\n",
        escape_html({shearcell_licences, shearcell_licences_end}));
  }
  return html + "</section>\n";
}

std::string data_html(const ReportData& data) {
  if (!data.interactive) return "";
  json charts = json::object(), experiments = json::array();
  const auto add = [&](const std::vector<ReportPanel>& panels) {
    for (const ReportPanel& panel : panels) {
      if (!panel.chart.is_null()) charts[panel.id] = panel.chart;
    }
  };
  for (const ReportFigure& figure : data.figures) add(figure.panels);
  for (const ReportExperiment& experiment : data.experiments) {
    experiments.push_back(
        {{"experiment", experiment.manifest.experiment}, {"runs", experiment.traces}});
  }
  return fmt::format(
      "<script type=\"application/json\" id=\"report-data\">{}</script>\n<script>{}</script>\n",
      script_json({{"charts", charts},
                   {"packings", data.packings.runs},
                   {"experiments", std::move(experiments)}}),
      front_end_script());
}

}  // namespace

bool has_front_end() {
  return !front_end_script().empty();
}

std::string report_page(const ReportData& data) {
  std::string html =
      head_html(data) + "<body>\n" + title_html(data) + "<main>\n" + overview_html(data);
  for (const ReportExperiment& experiment : data.experiments) {
    html += experiment_html(data, experiment);
  }
  html += across_html(data) + compare_html(data) + packings_html(data) + runs_html(data) +
          about_html(data);
  return html + "</main>\n" + data_html(data) + "</body>\n</html>\n";
}

}  // namespace shearcell
