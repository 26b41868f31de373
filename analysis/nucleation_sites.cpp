// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/nucleation_sites.hpp"

#include <algorithm>
#include <cstdint>
#include <set>

#include "analysis/published.hpp"
#include "analysis/statistics.hpp"

namespace shearcell {
namespace {

double place(const CrystalliteMap& map, const Eigen::Vector3d& centre, CellAxis axis) {
  if (axis == CellAxis::x) return (centre.x() + 1) / (map.width + 2);
  const double height = axis == CellAxis::y ? map.top - map.bottom : nominal_height * map.width;
  return (centre.y() - map.bottom) / height;
}

std::vector<double> histogram(std::span<const double> places, std::size_t bins) {
  std::vector<double> counts(bins);
  for (const double p : places) {
    const double k = std::clamp(p * static_cast<double>(bins), 0.0, static_cast<double>(bins - 1));
    ++counts[static_cast<std::size_t>(k)];
  }
  return counts;
}

/// Density of bin k over the selected runs.
std::optional<double> pooled(std::span<const std::vector<double>> histograms,
                             std::span<const std::size_t> selection, std::size_t k) {
  double inside = 0;
  double all = 0;
  for (const std::size_t run : selection) {
    inside += histograms[run][k];
    for (const double count : histograms[run]) all += count;
  }
  if (all <= 0) return std::nullopt;
  return inside / all * static_cast<double>(histograms.front().size());
}

}  // namespace

std::vector<double> nucleus_places(const FigureRun& run, CellAxis axis) {
  std::vector<double> places;
  for (const CheckpointMeasures& checkpoint : run.checkpoints) {
    if (!checkpoint.crystallites) continue;
    const CrystalliteMap& map = *checkpoint.crystallites;
    for (std::size_t c = 0; c < map.size.size(); ++c) {
      if (map.size[c] < nucleus_smallest || map.size[c] > nucleus_largest) continue;
      places.push_back(place(map, map.centre[c], axis));
    }
  }
  return places;
}

std::vector<double> nucleus_births(const FigureRun& run, CellAxis axis) {
  std::vector<double> places;
  std::set<std::int32_t> known;  // grains that have been in a nucleus
  for (const CheckpointMeasures& checkpoint : run.checkpoints) {
    if (!checkpoint.crystallites) continue;
    const CrystalliteMap& map = *checkpoint.crystallites;
    std::vector<std::int32_t> seen(map.size.size());
    for (std::size_t k = 0; k < map.grain.size(); ++k) {
      if (known.contains(map.grain[k])) ++seen[static_cast<std::size_t>(map.label[k])];
    }
    for (std::size_t k = 0; k < map.grain.size(); ++k) {
      if (map.size[static_cast<std::size_t>(map.label[k])] >= nucleus_smallest) {
        known.insert(map.grain[k]);
      }
    }
    for (std::size_t c = 0; c < map.size.size(); ++c) {
      const bool is_new = map.size[c] >= nucleus_smallest && 2 * seen[c] < map.size[c];
      if (is_new && map.size[c] <= nucleus_largest) {
        places.push_back(place(map, map.centre[c], axis));
      }
    }
  }
  return places;
}

std::vector<DensityBin> density(std::span<const std::vector<double>> runs, std::size_t bins) {
  std::vector<std::vector<double>> histograms;
  std::vector<std::size_t> every;
  for (const std::vector<double>& places : runs) {
    every.push_back(histograms.size());
    histograms.push_back(histogram(places, bins));
  }
  std::vector<DensityBin> result;
  const double width = 1 / static_cast<double>(bins);
  for (std::size_t k = 0; k < bins; ++k) {
    const std::optional<double> value = pooled(histograms, every, k);
    if (!value) return {};
    const auto low = static_cast<double>(k) * width;
    result.push_back({low, low + width, *value,
                      bootstrap_error(runs.size(), [&](std::span<const std::size_t> selection) {
                        return pooled(histograms, selection, k);
                      })});
  }
  return result;
}

}  // namespace shearcell
