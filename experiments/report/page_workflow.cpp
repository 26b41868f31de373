// SPDX-License-Identifier: GPL-3.0-or-later
// The workflow of an experiment as a picture of boxes, which the style sheet puts in a row or, on a
// narrow page, in a column.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "experiments/report/html.hpp"
#include "experiments/report/page.hpp"

namespace shearcell {
namespace {

struct Count {
  const char* css_class;
  const char* mark;  ///< tells the states apart without colour
  const char* name;
  std::size_t number;
};

/// A bar with a part for each state, and the counts as text below it.
std::string counts_html(std::span<const Count> counts) {
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
  std::array<std::size_t, 5> in_state{};
  for (const RunRecord& run : experiment.runs) {
    if ((run.kind == "prepare") != prepare) continue;
    ++in_state.at(static_cast<std::size_t>(run.state));
  }
  const auto number = [&](RunState state) { return in_state.at(static_cast<std::size_t>(state)); };
  const std::array counts = {
      Count{"done", "✓", "done", number(RunState::completed)},
      Count{"running", "▸", "running", number(RunState::running)},
      Count{"stopped", "‖", "interrupted", number(RunState::interrupted)},
      Count{"failed", "✗", "failed", number(RunState::failed)},
      Count{"waiting", "·", "waiting", number(RunState::declared)},
  };
  return counts_html(counts);
}

/// Checkpoints that an unfinished run will record if nothing ends it early.
std::size_t to_come(const RunRecord& run, const std::string& experiment) {
  double most = 0;
  for (const Membership& m : run.memberships) {
    if (m.experiment != experiment || run.kind != "shear") continue;
    const double every = std::max(1.0, static_cast<double>(m.checkpoint_every));
    const double target = static_cast<double>(m.target_cycles);
    most = std::max(most, std::ceil(target / every) - std::floor(run.cycle / every));
  }
  return run.state == RunState::completed ? 0 : static_cast<std::size_t>(most);
}

std::string checkpoints_html(const ReportData& data, const ReportExperiment& experiment) {
  std::size_t kept = 0, pruned = 0, rejected = 0, waiting = 0;
  for (const RunRecord& run : experiment.runs) {
    waiting += to_come(run, experiment.name);
    for (const CheckpointHistory& c : data.runs.at(run.id).checkpoints) {
      (c.rejected ? rejected : c.pruned ? pruned : kept) += 1;
    }
  }
  const std::array counts = {
      Count{"done", "✓", "stored", kept},
      Count{"stopped", "‖", "pruned", pruned},
      Count{"failed", "✗", "damaged", rejected},
      Count{"waiting", "·", "to come, at most", waiting},
  };
  return counts_html(counts);
}

std::string figures_html(const ReportData& data, const ReportExperiment& experiment) {
  std::string names;
  for (const std::size_t index : experiment.figures) {
    const ReportFigure& figure = data.figures.at(index);
    names += fmt::format(" <a href=\"#figure-{}\">{}</a>", escape_html(figure.id),
                         escape_html(figure.name));
  }
  for (const std::string& name : experiment.unmade) names += " " + escape_html(name);
  const std::array counts = {
      Count{"done", "✓", "made", experiment.figures.size()},
      Count{"failed", "✗", "cannot be made", experiment.unmade.size()},
  };
  return counts_html(counts) + (names.empty() ? "" : "<p>" + names.substr(1) + "</p>");
}

std::string manifest_html(const ReportExperiment& experiment) {
  const std::string brief = escape_html(experiment.manifest.substr(0, 12));
  return fmt::format("<p><a href=\"#manifest-{0}\">{1}</a></p><p class=\"id\">{0}</p>", brief,
                     escape_html(experiment.manifest_path));
}

}  // namespace

std::string workflow_html(const ReportData& data, const ReportExperiment& experiment) {
  return fmt::format("<ol class=\"workflow\" aria-label=\"Workflow of {}\">\n",
                     escape_html(experiment.name)) +
         box_html("Manifest", manifest_html(experiment)) +
         box_html("Packings", stages_html(experiment, true)) +
         box_html("Runs", stages_html(experiment, false)) +
         box_html("Checkpoints", checkpoints_html(data, experiment)) +
         box_html("Figures", figures_html(data, experiment)) + "</ol>\n";
}

}  // namespace shearcell
