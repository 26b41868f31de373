// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/report.hpp"

#include "experiments/report/page.hpp"
#include "experiments/report/report_data.hpp"
#include "experiments/report/web_assets.hpp"

namespace shearcell {

bool has_front_end() {
  return !front_end_script().empty();
}

Report make_report(const Store& store, const ReportOptions& options) {
  Report report;
  const ReportData data = collect_report(store, options, report);
  report.html = report_page(data);
  report.experiments = data.experiments.size();
  report.figures = data.figures.size();
  report.runs = data.runs.size();
  report.packings = data.packings.runs.size();
  report.frames = data.packings.frames;
  report.interactive = data.interactive;
  if (!data.drawing_trouble.empty()) report.notes.push_back(data.drawing_trouble);
  return report;
}

}  // namespace shearcell
