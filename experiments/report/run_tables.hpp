// SPDX-License-Identifier: GPL-3.0-or-later
// The runs of each experiment with their results, and how those came about over the cycles.
#pragma once

#include "experiments/report/report_data.hpp"

namespace shearcell {

/// Fills ReportExperiment::table and `traces`. What keeps an experiment from having them goes to
/// report.notes.
void add_run_tables(const Store& store, const ReportOptions& options, ReportData& data,
                    Report& report);

/// For the front end: [{experiment, runs: [{id, kind, scale, variant, seed, cycle, phi,
/// percent}]}], the runs in the order of the rows of the table; the last three are arrays with null
/// for no value.
nlohmann::json run_traces(const ReportData& data);

}  // namespace shearcell
