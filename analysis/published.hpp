// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers that the supplement of Phys. Rev. Lett. 125, 258003 states, and the margins and
// windows of the verdicts.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
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

/// Section C. n_bin of A = 0.04 is not stated; the value is n_bin of A = 0.05. [choice]
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
inline const PublishedAmplitude& published_nearest(double amplitude_rad) {
  return *std::ranges::min_element(published_amplitudes, {}, [&](const PublishedAmplitude& one) {
    return std::abs(one.amplitude_rad - amplitude_rad);
  });
}

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
  double grains;
  double interior_grains;
};
inline constexpr std::array published_sizes = {PublishedSize{5200, 3335}, PublishedSize{7900, 5345},
                                               PublishedSize{11400, 8055},
                                               PublishedSize{18200, 13610}};
/// The supplement's onset does not depend on the size from this N_inves on.
inline constexpr double converged_interior_grains = 6000;

/// Section B.2: relative fall of phi_u over a hundredfold k, "roughly 2 %".
inline constexpr double published_fall_of_phi_u = 0.02;

/// Section E: sizes of the crystallites of Fig. S7.
inline constexpr std::int32_t nucleus_smallest = 15;
inline constexpr std::int32_t nucleus_largest = 25;

/// Window of phi in which the percentage of crystalline grains is compared: from the onset to where
/// a fifth of the grains is crystalline. [choice]
inline constexpr double window_low = 0.646;
inline constexpr double window_high = 0.67;

// Margins: two results that differ by less agree. Margins are stated here, or in the manifest of
// the claim, before the runs are made. The uncertainty of a published number is part of its margin.

/// Percentage crystalline, mean over phi from 0.646 to 0.67 [points]: it rises by 2 points over
/// 0.002 in phi.
inline constexpr double margin_percentage = 2;
/// phi at the onset: the supplement's +-0.001. Chosen after seeing: earlier verdicts had 0.002,
/// within which everything agreed.
inline constexpr double margin_onset_phi = 0.001;
/// Change of phi at the onset with ln N_inves: over the supplement's sizes, 1.4 in ln N_inves, it
/// is hardly more than +-0.001.
inline constexpr double margin_onset_slope = 0.0007;
/// Critical size, relative to the published one: published sizes differ by a quarter between
/// neighbouring amplitudes.
inline constexpr double margin_critical_size = 0.25;
/// Share of nuclei in one part of the cell less that in another: 60 % against 40 % is the least
/// that shows in Fig. S7.
inline constexpr double margin_share = 0.2;
/// Relative fall of phi_u over a hundredfold k: 2 % in one digit is 1.5 to 2.5 %.
inline constexpr double margin_fall_of_phi_u = 0.005;
/// Change of phi over a hundredfold k: a seventh of the fall of phi_u.
inline constexpr double margin_hard_phi = 0.002;
/// N_inves, relative: the surface of a rough wall, a choice, displaced by 0.12 d.
inline constexpr double margin_interior = 0.03;

}  // namespace shearcell
