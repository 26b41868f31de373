// SPDX-License-Identifier: GPL-3.0-or-later
// The report as HTML: page.html filled with what a store holds.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "experiments/figures/select_runs.hpp"
#include "experiments/report/packings.hpp"
#include "provenance/store.hpp"

namespace shearcell {

struct ReportOptions : MeasureOptions {
  RunSelection runs;  ///< for figures, tables and packings; a figure has one scale
  PackingChoice packings;
  bool interactive = true;    ///< false: drawings only, as in a build without Node
  ReadProgress encoded = {};  ///< called as packings are encoded
};

/// Whether this build holds the front end. Building that needs Node.
bool has_front_end();

/// A page. MeasureOutcome has what was left out of its figures, tables and packings.
struct Report : MeasureOutcome {
  /// The whole page: markup, style, data and, if it is interactive, the front end. Texts from a
  /// store or a file are escaped.
  std::string html;
  bool interactive = false;
  std::size_t experiments = 0, figures = 0, stages = 0;  ///< in the page
  std::size_t packings = 0, checkpoints = 0;  ///< runs shown in 3D, and their checkpoints
  std::set<std::string> undrawn;              ///< which drawings failed and why, one line each
  std::set<std::string> problems;  ///< figures for which `figures` ends with code 2, one line each
  std::set<std::string> notes;     ///< about runs, figures and tables, one line each
};

/// The same store and options give the same bytes with the same program (drawings also need the
/// same gnuplot). Writes nothing but measures into derived.sqlite. Throws NotFound if the store has
/// no experiment or a run of `packings.runs` is unknown.
Report make_report(const Store& store, const ReportOptions& options);

}  // namespace shearcell
