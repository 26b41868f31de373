// SPDX-License-Identifier: GPL-3.0-or-later
// The functions of the figures in analysis/figure.cpp.
#pragma once

#include "analysis/figure.hpp"

namespace shearcell {

using MakeFigure = FigureResult(const Frame& frame);

// Table I and the parameters of the runs.
MakeFigure figure_table1;

// Growth of crystallites; where they nucleate.
MakeFigure figure_c, figure_s7;

// Onsets as survival data: share of runs without one, and rate of nucleation against phi; that rate
// for the grains at least 4 d from the walls.
MakeFigure figure_nucleation, figure_nucleation_core;

// The probability that a crystallite grows, from clones of its state.
MakeFigure figure_committor;

}  // namespace shearcell
