// SPDX-License-Identifier: GPL-3.0-or-later
// The charts of error against cost that `bench accuracy --out` wrote.
#pragma once

#include <filesystem>
#include <vector>

#include "experiments/report/report_data.hpp"

namespace shearcell {

/// A panel for each CSV file of the folder, by name: the numbers, the chart of NAME.chart.json and
/// the drawing of NAME.svg, if there are such files. Files are not trusted. Throws NotFound for a
/// file that is unreadable or too large, a chart that is malformed, and a folder without a CSV
/// file.
std::vector<ReportPanel> read_accuracy_charts(const std::filesystem::path& folder);

}  // namespace shearcell
