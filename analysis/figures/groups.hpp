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

/// Runs by the value of a parameter, ascending. Runs without a number are left out.
std::map<double, std::vector<const FigureRun*>> runs_by(std::span<const FigureRun> runs,
                                                        const std::string& parameter);

/// Mean over runs of the measure at their first checkpoint; NaN if there is none.
double at_start(RunGroup runs, const std::string& measure);
/// The supplement's N_inves for N = `grains`; none if the supplement has no such N.
std::optional<double> published_interior(double grains);
/// The claim that runs of `grains` grains, a size of the supplement, have the supplement's N_inves.
Verdict interior_is_published(double grains, RunGroup runs);
/// The claim that the onset by method 1 is at phi = 0.646.
Verdict onset_is_published(RunGroup runs, std::string claim);

}  // namespace shearcell
