// SPDX-License-Identifier: GPL-3.0-or-later
// What a run's numbers say of it before it is run: how its time step compares with the springs, and
// how deep its grains will overlap.
#pragma once

#include <optional>
#include <string>

#include "experiments/manifest/parameters.hpp"

namespace shearcell {

/// A time step beside the two times that it is measured by.
struct TimeStep {
  double seconds = 0;
  double over_contact_time = 0;     ///< of a collision, pi/sqrt(2 k/m)
  double over_stability_limit = 0;  ///< of stability_limit_s()
};

TimeStep shear_time_step(const Parameters& parameters);
TimeStep settle_time_step(const Parameters& parameters);

/// Mean overlap of touching grains at rest [d], to leading order in it. The mean pressure p of a
/// packing with n grains and n z/2 contacts per volume is p = n z k <overlap> d/6 (virial), so
///   <overlap>/d = 6 p d/(n d^3 z k),   n d^3 = 1.2, z = 6.3,
/// with p the pressure at half the height: P less half the grains' weight per area above a moving
/// bottom wall, and P plus as much under a moving top wall. z lies between 6, of hard grains, and
/// 6.4, found at Table I's stiffness; settled packings of 600 and 2000 grains have the overlap
/// within 3 % (core/ACCURACY.md).
double expected_overlap(const Parameters& parameters);

/// Below this part of the stability limit a smaller time step changes nothing that seeds would
/// show, and above the other the fastest vibrations are off by more than 10 % (core/ACCURACY.md).
inline constexpr double kNeedlesslySmallStep = 0.15;
inline constexpr double kTooLargeStep = 0.7;

/// What is unwise about a time step named `key` ("steps_per_cycle"), with the remedy, or nothing.
std::optional<std::string> time_step_advice(const TimeStep& step, const std::string& key);

}  // namespace shearcell
