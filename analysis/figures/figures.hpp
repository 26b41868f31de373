// SPDX-License-Identifier: GPL-3.0-or-later
// The functions behind the registry in analysis/figure.cpp: one per figure, each in its own file.
#pragma once

#include <span>
#include <vector>

#include "analysis/figure.hpp"

namespace shearcell {

/// S2a: phi against cycle; S2b: percentage of crystalline grains against phi; a curve per variant.
std::vector<FigureTable> figure_s2(std::span<const FigureRun> runs);

}  // namespace shearcell
