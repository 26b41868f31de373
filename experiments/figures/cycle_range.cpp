// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/cycle_range.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <sstream>
#include <stdexcept>

#include "provenance/io/read_number.hpp"

namespace shearcell {

bool CycleRange::holds(double cycle, double near) const {
  return cycle >= first - near && cycle <= last + near &&
         (every == 0 || std::abs(std::remainder(cycle - first, every)) <= near);
}

CycleRange parse_cycles(const std::string& text, const std::string& what) {
  CycleRange range;
  std::istringstream parts(text);
  double* const values[] = {&range.first, &range.last, &range.every};
  std::size_t k = 0;
  for (std::string part; std::getline(parts, part, ':'); ++k) {
    if (part.empty() && k < 3) continue;
    const auto value = read_number<double>(part);
    const bool fits = value && std::isfinite(*value) && *value >= (k == 2 ? 1e-9 : 0);
    if (k >= 3 || !fits || (k == 1 && *value < range.first)) {
      throw std::invalid_argument(fmt::format(
          "{} takes A, A:B or A:B:STEP, such as 1.25, 0:60 or ::10 (got {})", what, text));
    }
    *values[k] = *value;
  }
  if (k == 1 && text.find(':') == std::string::npos) range.last = range.first;
  return range;
}

std::string cycles_text(std::span<const double> cycles) {
  std::string text;
  for (std::size_t k = 0, next = 0; k < cycles.size(); k = next) {
    const double first = cycles[k], every = k + 1 < cycles.size() ? cycles[k + 1] - first : 0;
    const auto continues = [&] {
      const double expected = first + static_cast<double>(next - k) * every;
      return next < cycles.size() && std::abs(cycles[next] - expected) < kSameCycle;
    };
    for (next = k + 1; continues();) ++next;
    if (next - k < 3) next = k + 1;
    text += fmt::format("{}{}", text.empty() ? "" : ",", first);
    if (next - k > 1) text += fmt::format(":{}:{}", cycles[next - 1], every);
  }
  return text;
}

std::vector<CycleRange> read_cycles(const std::string& text) {
  std::vector<CycleRange> ranges;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    ranges.push_back(parse_cycles(part, "`cycles`"));
  }
  return ranges;
}

}  // namespace shearcell
