// SPDX-License-Identifier: GPL-3.0-or-later
// The functions of the figures in analysis/figure.cpp.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/figure.hpp"

namespace shearcell {

using MakeFigure = FigureResult(std::span<const FigureRun> runs);

// Table I and the parameters of the runs.
MakeFigure figure_table1;

// phi and phi_u of a packing whose springs are made stiffer.
MakeFigure figure_s1;

// Growth of crystallites; onset of crystallization; where they nucleate.
MakeFigure figure_c, figure_s5a, figure_s5b, figure_s6, figure_s7;

// Onsets as survival data: share of runs without one, and rate of nucleation against phi; that rate
// for the grains at least 4 d from the walls.
MakeFigure figure_nucleation, figure_nucleation_core;

// The probability that a crystallite grows, from clones of its state.
MakeFigure figure_committor;

/// One figure of one experiment. `summary`, which has no function Figure::make, is made of such
/// parts.
struct FigurePart {
  std::string experiment;
  std::string figure;
  FigureResult result;
};

/// The figures that `summary` uses, in its order.
const std::vector<std::string>& summary_parts();

/// Onset against amplitude and size, critical size against n_bin, and percentage crystalline
/// against phi, each from the tables of all parts that have it, and the largest differences that
/// their verdicts found. `parts` may be any of summary_parts().
FigureResult figure_summary(std::span<const FigurePart> parts);

}  // namespace shearcell
