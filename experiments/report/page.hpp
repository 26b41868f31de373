// SPDX-License-Identifier: GPL-3.0-or-later
// The report as HTML: page.html filled with what a store holds.
#pragma once

#include <string>

#include "experiments/report/report_data.hpp"

namespace shearcell {

/// The whole page: markup, style, data and, if it is interactive, the front end. The same store and
/// options give the same bytes with the same program (drawings also need the same gnuplot). Texts
/// from a store or a file are escaped.
std::string report_page(const ReportData& data);

/// The lineage of a figure, collapsed.
std::string lineage_html(const ReportData& data, const ReportFigure& figure);

/// Every run with its attempts, builds and checkpoints, and the manifests.
std::string runs_html(const ReportData& data);

/// The beginning of an id. It is cut before it is escaped, since an escape must stay whole.
std::string brief(const std::string& id);

}  // namespace shearcell
