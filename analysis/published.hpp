// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers that the supplement of Phys. Rev. Lett. 125, 258003 states, for tests and drawings.
#pragma once

#include <array>
#include <cstdint>

namespace shearcell {

/// Table I: what every simulation has, unless its own section varies it. omega is pi rad/s.
inline constexpr double published_mass_kg = 2.0e-5;
inline constexpr double published_diameter_m = 3.0e-3;
inline constexpr double published_stiffness_N_per_m = 6.54e2;
inline constexpr double published_drag_kg_per_s = 1.28e-3;
inline constexpr double published_pressure_Pa = 9.54e2;
inline constexpr double published_period_s = 2;
inline constexpr double published_steps_per_cycle = 45600;
inline constexpr double published_gravity_m_per_s2 = 9.81;

/// Section C. n_bin of A = 0.04 is not stated: that of 0.05 is taken. [choice]
struct PublishedAmplitude {
  double amplitude_rad;
  double critical_size;  ///< grains
  std::int64_t n_bin;    ///< cycles over which a crystallite is followed
};
inline constexpr std::array published_amplitudes = {
    PublishedAmplitude{0.04, 10, 300}, PublishedAmplitude{0.05, 10, 300},
    PublishedAmplitude{0.0667, 13, 40}, PublishedAmplitude{0.0833, 16, 15},
    PublishedAmplitude{0.1, 20, 1}};

/// The stated amplitude nearest to `amplitude_rad`: others have its numbers. [choice]
const PublishedAmplitude& published_nearest(double amplitude_rad);

/// phi at the onset of crystallization in the limit of small A, Figs. S5(b) and S6.
inline constexpr double published_onset_phi = 0.646;
inline constexpr double published_onset_error = 0.001;
/// "Small" A: the two smallest amplitudes of Fig. S5(a). [choice]
inline constexpr double small_amplitude_rad = 0.051;

/// The experiment of Rietz et al., Phys. Rev. Lett. 120, 055701 (2018): where it begins to
/// crystallize.
inline constexpr double experiment_amplitude_rad = 0.01;
inline constexpr double experiment_onset_phi = 0.645;

/// Section C: grains at least 1.5 d from the walls.
struct PublishedSize {
  std::int64_t grains;
  std::int64_t interior_grains;
};
inline constexpr std::array published_sizes = {PublishedSize{5200, 3335}, PublishedSize{7900, 5345},
                                               PublishedSize{11400, 8055},
                                               PublishedSize{18200, 13610}};
/// The onset no longer depends on the size from here on.
inline constexpr double converged_interior_grains = 6000;

/// Section E: sizes of the crystallites of Fig. S7.
inline constexpr std::int32_t nucleus_smallest = 15;
inline constexpr std::int32_t nucleus_largest = 25;

}  // namespace shearcell
