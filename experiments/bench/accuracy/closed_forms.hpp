// SPDX-License-Identifier: GPL-3.0-or-later
// Errors of an integrator against motions that are known in closed form.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "experiments/bench/accuracy/integrate.hpp"

namespace shearcell::accuracy {

/// Half the period of two grains on one spring, pi/sqrt(2 k/m) [s]: how long a collision lasts.
double contact_time(const Scene& scene);

/// Frequency [rad/s] of the longitudinal wave number `n` (n periods in the box) in a row of
/// `grains` along z whose neighbours overlap by 0.003 d: exactly
/// 2 sqrt(k/m) sin(pi n / grains), and as a method finds it without drag over `steps` steps.
double row_frequency(const Scene& scene, int grains, int n);
double found_row_frequency(const Scene& scene, const Method& method, double dt, int grains, int n,
                           std::uint64_t steps);

/// How thoroughly the closed forms are compared.
struct Thoroughness {
  int phases = 32;      ///< of a collision within a step
  double periods = 10;  ///< of the oscillations
  int waves = 8;        ///< in a row of twice as many grains
  std::uint64_t wave_steps = 2000;
};

/// One error of a method at a time step [s]; 0 for the exact motion.
struct ClosedForm {
  std::string name;   ///< of its files
  std::string title;  ///< what the error is of
  std::string error;  ///< column and axis
  std::function<double(const Method& method, double dt)> measure;
  /// Single errors scatter, because a contact ends within a step: fit the order over many steps.
  bool irregular = false;
};
std::vector<ClosedForm> closed_forms(const Scene& scene, const Thoroughness& how);

/// Order of convergence: the slope of log(error) against log(step), over `count` time steps from
/// `largest` down by factors of the fourth root of 2.
double fitted_order(const std::function<double(double dt)>& error, double largest, int count);

}  // namespace shearcell::accuracy
