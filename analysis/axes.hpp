// SPDX-License-Identifier: GPL-3.0-or-later
// Axes, columns and reference lines that several figures share.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/figure.hpp"
#include "analysis/statistics.hpp"

namespace shearcell {

inline const Axis cycle_axis = {.name = "shear cycle", .symbol = formula("$n$"), .whole = true};
inline const Axis phi_axis = {.name = "volume fraction", .symbol = formula("$ϕ$")};
inline const Axis amplitude_axis = {
    .name = "amplitude", .symbol = formula("$A$"), .unit = "rad", .low = 0, .high = 0.12};

/// A line at the supplement's critical size [grains] for one amplitude.
ReferenceLine critical_line(double size, const std::string& colour);

/// Adds columns for a size, the ends of its interval and its standard error, all in grains.
void add_size_columns(const std::string& name, std::vector<TableColumn>& columns);
/// The chart point that shows `size` at x. Its y_error is the standard error of the size.
ChartPoint point_of(double x, const Estimate& size);
/// Adds the values for the columns of add_size_columns(); empty cells if there is no estimate.
void add_size(const std::optional<Estimate>& size, TableRow& row);

}  // namespace shearcell
