// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/drive.hpp"

#include "core/trigonometry.hpp"

namespace shearcell {

Tilt tilt(const Drive& drive, std::uint64_t step) {
  const std::uint64_t phase = step % cycle_steps(drive);
  if (drive.amplitude == 0 || phase >= drive.steps_per_cycle) return {};
  const SineCosine sc = turn_sine_cosine(phase, drive.steps_per_cycle);
  return {drive.amplitude * sc.sine, drive.amplitude * sc.cosine};
}

}  // namespace shearcell
