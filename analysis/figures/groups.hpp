// SPDX-License-Identifier: GPL-3.0-or-later
// Runs grouped by a number: amplitude, or size of the system.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/claims.hpp"

namespace shearcell {

std::vector<const FigureRun*> pointers(std::span<const FigureRun> runs);

/// Ascending. Runs without the number are left out.
std::map<double, std::vector<const FigureRun*>> runs_by(std::span<const FigureRun> runs,
                                                        const std::string& parameter);

/// N_inves at the first checkpoint, mean over runs; NaN if there is none.
double interior_grains(RunGroup runs);
/// The supplement's N_inves of a packing of that size; none if it has no such size.
std::optional<double> published_interior(double grains);
/// Runs of `grains` grains, a size of the supplement, have its N_inves.
Verdict interior_is_published(double grains, RunGroup runs);
/// The onset by method 1 is at phi = 0.646.
Verdict onset_is_published(RunGroup runs, std::string claim);

/// The onset by a method, with the supplement's critical size for the amplitude of the runs.
Onset onset_of(RunGroup runs, OnsetMethod method);

/// The columns of an onset, behind others.
std::vector<std::string> onset_columns(std::vector<std::string> columns);
/// Their values, behind those of the others.
TableRow onset_row(TableRow row, const Onset& onset);
/// Points of those columns against the column `x`.
Series onset_points(Text title, const char* colour, int point, const char* x,
                    RowFilter filter = {});

}  // namespace shearcell
