// SPDX-License-Identifier: GPL-3.0-or-later
// Ranges of cycles as text: "1.25", "0:60", "0:60:10" (every tenth), "::10".
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

namespace shearcell {

struct CycleRange {
  double first = 0;
  double last = std::numeric_limits<double>::infinity();
  double every = 0;  ///< 0: all checkpoints

  /// `near` [cycles]: how far the cycle may be from one of the range.
  bool holds(double cycle, double near) const;
};

/// Throws std::invalid_argument, which names `what`, if the text is not such a range.
CycleRange parse_cycles(const std::string& text, const std::string& what);

/// Rising cycles as ranges, separated by commas: "0:120:1", "0:30:10,33.5".
std::string cycles_text(std::span<const double> cycles);

/// Reads cycles_text(). Throws std::invalid_argument.
std::vector<CycleRange> read_cycles(const std::string& text);

/// Half the distance below which two cycles of cycles_text() are the same. A cycle has at most 1e9
/// time steps.
inline constexpr double kSameCycle = 1e-10;

}  // namespace shearcell
