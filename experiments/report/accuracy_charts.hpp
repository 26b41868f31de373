// SPDX-License-Identifier: GPL-3.0-or-later
// The diagrams of error against cost, from the CSV files that `bench accuracy --out` left.
#pragma once

#include <filesystem>
#include <vector>

#include "experiments/report/report_data.hpp"

namespace shearcell {

/// A panel for each CSV file of the folder, by name. Files whose columns this program does not know
/// how to draw give their numbers only. Throws NotFound, naming file and line, when a file is no
/// table or is larger than a report should hold, and when there is no CSV file.
std::vector<ReportPanel> read_accuracy_charts(const std::filesystem::path& folder);

}  // namespace shearcell
