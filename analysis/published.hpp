// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers given in the supplement of Phys. Rev. Lett. 125, 258003, and the margins of
// the verdicts of computed figures.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace shearcell {

/// Section C. n_bin of A = 0.04 is not published; n_bin of A = 0.05 is used instead. [choice]
struct PublishedAmplitude {
  double amplitude_rad;
  double critical_size;                ///< grains
  std::int64_t n_bin;                  ///< cycles over which a crystallite is followed
  const char* cannot_be_decided = "";  ///< why no claim on critical_size can be decided, or ""
};
inline constexpr std::array published_amplitudes = {
    PublishedAmplitude{0.04, 10, 300}, PublishedAmplitude{0.05, 10, 300},
    PublishedAmplitude{0.0667, 13, 40},
    PublishedAmplitude{
        0.0833, 16, 15,
        "the published size comes from about 8 runs; another study with 8 runs may find a size on "
        "either side of 12 grains, the lower limit of the margin; more runs of ours do not make "
        "the published size more certain"},
    PublishedAmplitude{
        0.1, 20, 1,
        "our critical size (25.3 grains, from 40 runs) is near the upper limit of the margin, 25 "
        "grains; a study with about 8 runs, as in the supplement, may find a size on either side "
        "of this limit"}};
/// Why it cannot be decided whether the critical size grows with A.
inline constexpr const char* growth_cannot_be_decided =
    "the answer depends on the number of cycles over which crystallites are followed: with 1 cycle "
    "the critical size grows with A; with 20 cycles it falls; with 5 cycles the ratio of the "
    "critical sizes is near 1, the threshold of the claim";

/// Returns the published amplitude that is nearest to `amplitude_rad`. The numbers published for
/// this amplitude are also used for `amplitude_rad`. The supplement does not say which numbers to
/// use for other amplitudes.
inline const PublishedAmplitude& published_nearest(double amplitude_rad) {
  return *std::ranges::min_element(published_amplitudes, {}, [&](const PublishedAmplitude& one) {
    return std::abs(one.amplitude_rad - amplitude_rad);
  });
}

/// phi at the onset of crystallization in the limit of small A, Figs. S5(b) and S6.
inline constexpr double published_onset_phi = 0.646;

/// Section E: smallest and largest crystallites in Fig. S7 [grains].
inline constexpr std::int32_t nucleus_smallest = 15;
inline constexpr std::int32_t nucleus_largest = 25;

// Margins: two results agree if they differ by less than the margin. The margins of the figures
// in analysis/figures are defined here; all other margins are in manifests. Margins are chosen
// before the runs are made. The uncertainty of a published critical size widens the interval of the
// verdict, not the margin (README.md).

/// Margin of the critical size, relative to the published size. Published sizes of neighbouring
/// amplitudes differ by a quarter.
inline constexpr double margin_critical_size = 0.25;
/// Margin for the shares of nuclei in two parts of the cell: the smallest difference that can be
/// seen in Fig. S7 (60 % in one part and 40 % in the other).
inline constexpr double margin_share = 0.2;

}  // namespace shearcell
