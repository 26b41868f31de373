// SPDX-License-Identifier: GPL-3.0-or-later
// Runs grouped by a number: amplitude, or size of the system.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/figure.hpp"
#include "analysis/onset.hpp"

namespace shearcell {

/// Ascending. Runs that do not say the number are left out.
std::map<double, std::vector<const FigureRun*>> runs_by(std::span<const FigureRun> runs,
                                                        const std::string& parameter);

/// N_inves at the first checkpoint, mean over runs; NaN when there is none.
double interior_grains(std::span<const FigureRun* const> runs);
/// What the supplement counts for a packing of that size; none when it has no such size.
std::optional<double> published_interior(double grains);
/// Rough runs of `grains` grains, a size of the supplement, have its N_inves within 3 %.
Verdict interior_is_published(double grains, std::span<const FigureRun* const> runs);

/// The onset is that of the supplement: within 0.646 +- 0.001, plus two standard errors of ours
/// (Student's t for few runs).
Verdict onset_is_published(const Onset& onset, std::string claim);

/// "6 runs, 2 never reach the size, 0 begin beyond it".
std::string runs_in_words(const Onset& onset);

/// The columns that tell an onset, behind others.
std::vector<std::string> onset_columns(std::vector<std::string> columns);
/// Their values, behind those of the others.
std::vector<TableValue> onset_row(std::vector<TableValue> row, const Onset& onset);

}  // namespace shearcell
