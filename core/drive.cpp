// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/drive.hpp"

#include <cmath>
#include <set>

#include "core/trigonometry.hpp"

namespace shearcell {

Tilt tilt(const Drive& drive, std::uint64_t step) {
  const std::uint64_t phase = step % cycle_steps(drive);
  if (drive.amplitude == 0 || phase >= drive.steps_per_cycle) return {};
  const SineCosine sc = turn_sine_cosine(phase, drive.steps_per_cycle);
  return {drive.amplitude * sc.sine, drive.amplitude * sc.cosine};
}

std::vector<std::uint64_t> steps_at(std::span<const double> phases, const Drive& drive) {
  const std::uint64_t whole = cycle_steps(drive);
  std::set<std::uint64_t> steps;
  for (const double phase : phases) {
    if (!(phase > 0 && phase < 1)) continue;
    const auto step = static_cast<std::uint64_t>(std::llround(phase * static_cast<double>(whole)));
    if (step > 0 && step < whole) steps.insert(step);
  }
  return {steps.begin(), steps.end()};
}

}  // namespace shearcell
