// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>

#include "experiments/manifest/identity.hpp"
#include "experiments/report/html.hpp"
#include "experiments/report/page.hpp"
#include "provenance/json_text.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

std::string row(const char* name, const std::string& html) {
  return fmt::format("<dt>{}</dt><dd>{}</dd>\n", name, html);
}

std::string code(const std::string& text) {
  return "<code>" + escape_html(text) + "</code>";
}

/// "shearcell 0.1.0 (dd11cbe), GNU 12.2.0 Release; HOST, CPU, 4 cores, AVX-512".
std::string made_by(const Maker& maker) {
  return fmt::format("{}; {}, {}", maker.program, maker.host, maker.machine);
}

std::string makers_html(const ReportFigure& figure) {
  std::set<std::string> makers;
  for (const auto& [id, stage] : figure.lineage.runs) {
    for (const Attempt& attempt : stage.attempts) makers.insert(made_by(maker_of(attempt.host)));
  }
  std::string html;
  for (const std::string& maker : makers) html += escape_html(maker) + "<br>";
  return html;
}

std::string record_html(const ReportFigure& figure) {
  if (!figure.recorded) {
    return "no; " +
           code("shearcell figures " + figure.summary.name +
                (figure.summary.experiment.empty()
                     ? ""
                     : " --experiment " + figure.summary.experiment)) +
           " records it with its drawings";
  }
  return fmt::format("event {} of {}", figure.recorded->seq,
                     escape_html(figure.recorded->recorded_at));
}

std::string outputs_html(const ReportFigure& figure) {
  std::string html;
  for (const ReportPanel& panel : figure.panels) {
    const std::string file = panel.name + ".csv";
    const std::string sha256 = sha256_hex(panel.csv);
    html += escape_html(file) + " " + code(sha256);
    if (figure.recorded) {
      const json outputs = member_of(figure.recorded->provenance, "outputs");
      html += text_at(outputs, file.c_str()) == sha256 ? ", as recorded" : ", NOT as recorded";
    }
    html += "<br>";
  }
  return html;
}

std::string manifests_html(const ReportFigure& figure) {
  std::string html;
  for (const ManifestText& manifest : figure.lineage.manifests) {
    html += fmt::format("<a href=\"#manifest-{}\">{}</a> {}<br>", brief(manifest.sha256),
                        escape_html(manifest.path), code(manifest.sha256));
  }
  return html;
}

std::string span_of_cycles(const FigureInput& input, const RunLineage& run) {
  std::vector<double> cycles;
  for (const std::string& sha256 : input.checkpoints) {
    if (const CheckpointHistory* known = run.find(sha256)) cycles.push_back(known->record.cycle);
  }
  return cycles.empty() ? "?" : fmt::format("{:g} to {:g}", cycles.front(), cycles.back());
}

/// Lets lines break after the commas of the variant.
std::string breakable(const std::string& variant) {
  std::string html;
  for (const char c : escape_html(variant)) html += c == ',' ? ",<wbr>" : std::string(1, c);
  return html;
}

std::string inputs_table(const ReportFigure& figure) {
  std::vector<HtmlRow> rows;
  for (const FigureInput& input : figure.lineage.inputs) {
    std::set<int> lines;
    for (const ManifestLine& line : input.lines) lines.insert(line.line);
    rows.push_back({run_link(input.run), escape_html(input.experiment), breakable(input.variant),
                    std::to_string(input.seed), std::to_string(input.checkpoints.size()),
                    span_of_cycles(input, figure.lineage.runs.at(input.run)),
                    fmt::format("{}", fmt::join(lines, ", "))});
  }
  const HtmlRow head = {"run",          "experiment", "variant",       "#seed",
                        "#checkpoints", "cycles",     "manifest lines"};
  return scroll_box("Inputs", html_table(head, rows));
}

std::string attempts_html(const RunLineage& stage) {
  std::string html;
  for (std::size_t a = 0; a < stage.attempts.size(); ++a) {
    const Attempt& attempt = stage.attempts[a];
    const Maker maker = maker_of(attempt.host);
    html += fmt::format("<p>Attempt {}, {}, {}: {}{}.<br><span class=\"small\">{}; flags {}</span>",
                        a + 1, escape_html(attempt.started_at), name_of(attempt.outcome),
                        attempt.from_run.empty() ? "from a fresh filling"
                                                 : "from a state of " + run_link(attempt.from_run),
                        attempt.from_checkpoint.empty()
                            ? ""
                            : ", checkpoint " + code(attempt.from_checkpoint.substr(0, 12)),
                        escape_html(made_by(maker)), code(maker.flags));
    if (!attempt.why.empty()) html += "<br>" + escape_html(attempt.why);
    html += "</p>\n";
  }
  return html;
}

std::string run_html(const RunLineage& stage) {
  const RunRecord& run = stage.run;
  std::string html = fmt::format(
      "<details class=\"run\" id=\"run-{0}\"><summary><span class=\"id\">{0}</span> {1}, "
      "N = {2}, {3}</summary>\n<dl>\n",
      brief(run.id), escape_html(run.kind), run.grains, name_of(run.state));
  html += row("id", code(run.id));
  if (!run.parent.empty()) html += row("begins from", run_link(run.parent));
  for (const Membership& member : run.memberships) {
    html += row("member of", fmt::format("{1} at scale {2}, {3}, seed {4}, manifest <a "
                                         "href=\"#manifest-{0}\">{0}</a>",
                                         brief(member.manifest), escape_html(member.experiment),
                                         escape_html(scale_name(member.scale)),
                                         escape_html(member.variant), member.seed));
  }
  if (!run.error.empty()) html += row("error", escape_html(run.error));
  nlohmann::json shown = run.resolved;
  if (shown.contains("parameters")) shown["parameters"] = effective_parameters(run.resolved);
  html += row("parameters", code(shown.dump()));
  html += "</dl>\n" + attempts_html(stage);
  html += fmt::format("<details><summary>{} checkpoints</summary><pre tabindex=\"0\">",
                      stage.checkpoints.size());
  for (const CheckpointHistory& c : stage.checkpoints) {
    html += fmt::format("cycle {:<8g} {}{}{}\n", c.record.cycle, escape_html(c.record.sha256),
                        c.kept() ? "" : " ", c.kept() ? "" : name_of(c.record.state));
  }
  return html + "</pre></details>\n</details>\n";
}

}  // namespace

std::string brief(const std::string& id) {
  return escape_html(id.substr(0, 12));
}

std::string run_link(const std::string& id, std::size_t digits) {
  return fmt::format("<a class=\"id\" href=\"#run-{}\">{}</a>", brief(id),
                     escape_html(id.substr(0, digits)));
}

std::string lineage_html(const ReportData& data, const ReportFigure& figure) {
  std::string html = fmt::format(
      "<details class=\"lineage\" id=\"lineage-{0}\"><summary>Where {0} "
      "comes from</summary>\n<dl>\n",
      escape_html(figure.id));
  html += row("log", fmt::format("event {}, {}", data.head.seq, code(data.head.hash)));
  html += row("scale", escape_html(scale_name(figure.lineage.scale)));
  html += row("inputs",
              fmt::format("{} runs, {} checkpoints; analysis version {}", figure.summary.runs,
                          figure.summary.checkpoints, short_text(figure.lineage.analysis_version)));
  html += row("computed by", makers_html(figure));
  html += row("manifests", manifests_html(figure));
  html += row("outputs", outputs_html(figure));
  html += row("recorded", record_html(figure));
  html += row("check it", code("shearcell show " + figure.lineage.record.name) + ", " +
                              code("shearcell verify"));
  return html + "</dl>\n" + inputs_table(figure) + "</details>\n";
}

std::string runs_html(const ReportData& data) {
  std::string html =
      "<section id=\"runs\">\n<h2>Runs and manifests</h2>\n<p class=\"small\">Every stage with its "
      "parameters, who computed it, and the SHA-256 of each checkpoint.</p>\n";
  for (const auto& [id, stage] : data.runs) html += run_html(stage);
  for (const auto& [sha256, manifest] : data.manifests) {
    html += fmt::format(
        "<details class=\"run\" id=\"manifest-{0}\"><summary><span "
        "class=\"id\">{0}</span> {1}</summary><pre "
        "tabindex=\"0\">{2}</pre></details>\n",
        brief(sha256), escape_html(manifest.path), escape_html(manifest.text));
  }
  return html + "</section>\n";
}

}  // namespace shearcell
