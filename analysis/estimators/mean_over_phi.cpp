// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "analysis/estimators.hpp"

namespace shearcell {
namespace {

/// Means over the checkpoints of one run in one bin of phi.
struct PhiMean {
  double phi, value;
};

/// Means of the column in each bin of phi, in ascending order. Checkpoints without a finite phi and
/// bins without a finite value are left out.
std::vector<PhiMean> means_over_phi(const FrameRun& run, const NumberColumn& column) {
  std::map<double, std::pair<std::vector<double>, std::vector<double>>> bins;
  for (const CheckpointMeasures& checkpoint : run.checkpoints) {
    const double phi = checkpoint.measures.number("phi");
    if (!std::isfinite(phi)) continue;
    auto& [phis, values] = bins[std::floor(phi / phi_bin)];
    phis.push_back(phi);
    values.push_back(column(run, &checkpoint));
  }
  std::vector<PhiMean> means;
  for (const auto& [bin, members] : bins) {
    const auto value = over_runs(members.second).mean;
    if (value) means.push_back({over_runs(members.first).mean.value(), *value});
  }
  return means;
}

}  // namespace

Scalar over_phi(const std::string& name, const std::string& column, double low, double high) {
  const auto of = [low, high, number = NumberColumn(column)](const FrameRun& run) -> RunValue {
    const std::vector<PhiMean> bins = means_over_phi(run, number);
    if (bins.empty()) return {0, Missing::too_short};
    if (bins.front().phi > low) return {0, Missing::too_late};
    if (bins.back().phi < high) return {0, Missing::too_short};
    double area = 0;
    for (std::size_t k = 1; k < bins.size(); ++k) {
      const double x0 = bins[k - 1].phi, x1 = bins[k].phi;
      const double begin = std::max(x0, low), end = std::min(x1, high);
      if (begin >= end) continue;
      const double middle = ((begin + end) / 2 - x0) / (x1 - x0);
      area += (end - begin) * std::lerp(bins[k - 1].value, bins[k].value, middle);
    }
    return measured(area / (high - low));
  };
  return {fmt::format("{}, mean over phi from {} to {}", name, low, high),
          fmt::format("phi from {} to {}", low, high), of};
}

const Estimator mean_over_phi = {.name = "mean_over_phi",
                                 .meaning = "mean over the volume fractions in the range `phi`",
                                 .key = "phi",
                                 .scalar = [](const ClaimSpec& claim) {
                                   return over_phi(words_of_column(claim.compare), claim.compare,
                                                   claim.phi->at(0), claim.phi->at(1));
                                 }};

}  // namespace shearcell
