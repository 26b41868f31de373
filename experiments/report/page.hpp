// SPDX-License-Identifier: GPL-3.0-or-later
// Makes the HTML report of a store from the template page.html.
#pragma once

#include <cstddef>
#include <set>
#include <string>

#include "experiments/figures/select_runs.hpp"
#include "experiments/report/packings.hpp"
#include "provenance/store.hpp"

namespace shearcell {

struct ReportOptions : MeasureOptions {
  RunSelection runs;  ///< runs to show; each figure shows only those of one scale
  PackingChoice packings;
  bool interactive = true;    ///< false: gnuplot's drawings only, as in a build without Node
  ReadProgress encoded = {};  ///< called after each encoded packing
};

/// Whether this program contains the front end of the report. Building the front end needs Node.
bool has_front_end();

/// A page. MeasureOutcome lists the damaged and pruned checkpoints that the page leaves out.
struct Report : MeasureOutcome {
  /// The whole page: markup, style, data and, if the page is interactive, the front end. Texts from
  /// a store or a file are escaped.
  std::string html;
  bool interactive = false;
  std::size_t experiments = 0, figures = 0, stages = 0;  ///< how many of each the page has
  std::size_t packings = 0, checkpoints = 0;  ///< runs shown in 3D, and their checkpoints
  std::set<std::string> undrawn;   ///< a line for each drawing that failed, with the reason
  std::set<std::string> problems;  ///< a line for each figure that is unknown or invalid
  std::set<std::string> notes;     ///< lines about runs, figures and tables
};

/// Makes the report. The same program, store and options give the same bytes, if static drawings
/// use the same gnuplot. Writes only measures to the store (derived.sqlite). Throws NotFound if the
/// store has no experiment or a run of `packings.runs` is unknown.
Report make_report(const Store& store, const ReportOptions& options);

}  // namespace shearcell
