// SPDX-License-Identifier: GPL-3.0-or-later
// What follows from the numbers of a run before it starts: its time step compared with the
// springs, and the expected overlap of its grains.
#pragma once

#include <optional>
#include <string>
#include <string_view>

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

/// Whether a manifest may set the key to `auto`: steps_per_cycle and settle_time_step_s.
bool takes_auto(std::string_view key);

/// Sets the parameter to the value that keeps the time step at Table I's part of the stability
/// limit, 0.3547: a whole number of steps in a cycle, or in 2 s of settling. The parameters of
/// Table I give Table I's time step. The result may be out of range (check_value).
void resolve_auto(std::string_view key, Parameters& parameters);

/// Mean overlap of touching grains at rest [d], to leading order in it: 0.75 p d/k. By the virial
/// the mean pressure of a packing with n grains per volume and z contacts of each is p = n z k
/// <overlap> d/6, so <overlap>/d = 6/(n d^3 z) p d/k, which is 0.78 for n d^3 = 1.22 and z = 6.36
/// (found at N = 2000); 0.75 fits five settled packings within 7 % (core/ACCURACY.md), as
/// rough side walls bear a part. The pressure p is that at half the height: P less half the grains'
/// weight per area where P acts on a moving bottom wall, and P plus as much where it acts at the
/// top.
double expected_overlap(const Parameters& parameters);

/// Below this part of the stability limit a smaller time step changes nothing that seeds would
/// show, and above the other the fastest vibrations are off by more than 10 % (core/ACCURACY.md).
inline constexpr double kNeedlesslySmallStep = 0.15;
inline constexpr double kTooLargeStep = 0.7;

/// What is unwise about a time step named `key` ("steps_per_cycle"), with the remedy, or nothing.
std::optional<std::string> time_step_advice(const TimeStep& step, const std::string& key);

}  // namespace shearcell
