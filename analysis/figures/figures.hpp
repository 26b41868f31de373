// SPDX-License-Identifier: GPL-3.0-or-later
// The functions of the figures in analysis/figure.cpp.
#pragma once

#include "analysis/figure.hpp"

namespace shearcell {

using MakeFigure = FigureResult(const Frame& frame);

// Table I and the parameters of the runs.
MakeFigure figure_table1;

// Growth of crystallites (C), and the places where crystallites nucleate (S7).
MakeFigure figure_c, figure_s7;

// The share of runs without an onset as a function of the cycle, and the rate of nucleation as a
// function of phi. figure_nucleation_core: the rate for the grains at least 4 d from the walls.
MakeFigure figure_nucleation, figure_nucleation_core;

// The probability that a crystallite grows, from clones of recorded states.
MakeFigure figure_committor;

}  // namespace shearcell
