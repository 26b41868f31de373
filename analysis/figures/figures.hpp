// SPDX-License-Identifier: GPL-3.0-or-later
// The functions of the figures in analysis/figure.cpp.
#pragma once

#include <span>

#include "analysis/figure.hpp"

namespace shearcell {

// Table I and the parameters of the runs.
FigureResult figure_table1(std::span<const FigureRun> runs);

// phi and phi_u of a packing whose springs are made stiffer.
FigureResult figure_s1(std::span<const FigureRun> runs);

// The two panels of S2 to S4 are phi against cycle, and percentage crystalline against phi, with a
// curve per variant. B5 and walls have the percentage against cycle between them.
FigureResult figure_s2(std::span<const FigureRun> runs);
FigureResult figure_s3(std::span<const FigureRun> runs);
FigureResult figure_s4(std::span<const FigureRun> runs);
FigureResult figure_b5(std::span<const FigureRun> runs);
FigureResult figure_walls(std::span<const FigureRun> runs);
// phi against cycle alone.
FigureResult figure_choices(std::span<const FigureRun> runs);

// Growth of crystallites; onset of crystallization; where they nucleate.
FigureResult figure_c(std::span<const FigureRun> runs);
FigureResult figure_s5a(std::span<const FigureRun> runs);
FigureResult figure_s5b(std::span<const FigureRun> runs);
FigureResult figure_s6(std::span<const FigureRun> runs);
FigureResult figure_s7(std::span<const FigureRun> runs);
// Onsets as survival data: share of runs without one, and rate of nucleation against phi.
FigureResult figure_nucleation(std::span<const FigureRun> runs);
// That rate for the grains at least 4 d from the walls.
FigureResult figure_nucleation_core(std::span<const FigureRun> runs);

}  // namespace shearcell
