// SPDX-License-Identifier: GPL-3.0-or-later
// Colours and symbols of variants, which are equal in every panel and figure of an experiment.
#pragma once

#include <array>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/chart.hpp"
#include "analysis/frame.hpp"
#include "analysis/published.hpp"

namespace shearcell {

/// Colours for readers with any colour vision (Okabe and Ito, jfly.uni-koeln.de/color), and their
/// names in manifests.
inline constexpr std::array<const char*, 7> safe_colours = {
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"};
inline constexpr std::array<std::string_view, 7> colour_names = {
    "blue", "vermilion", "green", "purple", "orange", "sky", "black"};

/// Names of symbols in manifests: "none", followed by the symbols of curve_symbol() in their order.
inline constexpr std::array<std::string_view, 11> marker_names = {
    "none",        "square",      "circle",        "triangle",           "triangle_down", "diamond",
    "open_square", "open_circle", "open_triangle", "open_triangle_down", "open_diamond"};

/// Series::point of the k-th curve: five filled symbols, then five open symbols.
inline int curve_symbol(std::size_t k) {
  return (k / 5 % 2 == 0 ? 5 : 4) + 2 * static_cast<int>(k % 5);
}
inline constexpr std::size_t curve_symbols = 10;

struct Look {
  std::string colour = {};  ///< "#rrggbb"
  int point = 0;            ///< like Series::point
  /// How the points are joined if the curve has no symbols. Among curves of one colour, solid lines
  /// and dashes alternate.
  Join join = Join::line;
};

/// A colour or symbol that a manifest states for the curves with the parameters `where`.
struct StatedLook {
  nlohmann::json where;
  std::string colour = {};  ///< "": not stated
  int point = -1;           ///< -1: not stated
};

/// Colour and symbol of a curve of one amplitude. An amplitude of the supplement has the same
/// colour and symbol in all figures. Any other amplitude gets the k-th colour and the k-th symbol.
Look amplitude_look(double amplitude_rad, std::size_t k);

/// The runs of one amplitude. Runs without an amplitude are left out.
struct AmplitudeRuns {
  double amplitude;  ///< [rad]
  std::vector<const FrameRun*> runs;
  Text title;  ///< "A = 0.05"
  Look look;
  const PublishedAmplitude* published;  ///< the nearest amplitude of the supplement

  /// A line at the supplement's critical size.
  ReferenceLine critical_line() const {
    return {.at = published->critical_size,
            .colour = look.colour,
            .title = "the supplement's critical sizes"};
  }
};
/// Groups the runs by amplitude, ascending.
std::vector<AmplitudeRuns> by_amplitude(std::span<const FrameRun> runs);

/// Chooses the colour and symbol (Look) of each variant from the keys that vary in the frame. The
/// first of these keys decides the colour, by the rank of its value. The other keys decide the
/// symbol, by the rank of their combination of values. The amplitudes of the supplement have the
/// colours of amplitude_look(). Colours and symbols of a StatedLook replace the chosen ones. A
/// stated colour is not chosen for other variants.
class Looks {
 public:
  /// `shared`: keys that do not distinguish the curves of one panel. When of() decides whether a
  /// stated symbol belongs to a single curve, it ignores these keys.
  explicit Looks(const Frame& frame, std::vector<StatedLook> stated = {},
                 std::vector<std::string> shared = {});

  /// Colour and symbol of a curve. If all runs of the curve belong to one variant, the swept values
  /// of this variant decide. Otherwise the values in `key` decide, which all these runs share.
  ///
  /// A StatedLook is used if the curve has the parameter values in StatedLook::where, and if all
  /// variants that match StatedLook::where agree in the parameter that decides the colour. The
  /// curve then has the stated colour. It also has the stated symbol, unless StatedLook::where
  /// matches other curves of the panel, too.
  Look of(RunGroup curve, const nlohmann::json& key) const;

 private:
  std::vector<nlohmann::json> variants_;
  std::vector<std::string> keys_;
  std::vector<StatedLook> stated_;  ///< if several match a curve, the first is used
  std::vector<std::string> shared_;
};

}  // namespace shearcell
