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

}  // namespace shearcell
