// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/figures/claims.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include "analysis/agreement.hpp"
#include "analysis/binning.hpp"

namespace shearcell {
namespace {

/// `compare` gives nothing for two curves that do not reach what the claim is about.
Verdict worst_pair(
    std::span<const Curve> curves, std::string claim, const std::string& missing,
    std::size_t together,
    const std::function<std::optional<CurveDifference>(const Curve&, const Curve&)>& compare) {
  Verdict verdict{std::move(claim),
                  "difference of the worst pair of curves, root mean square in standard errors",
                  std::nullopt,
                  std::nullopt,
                  Ruling::too_few_runs,
                  missing};
  const std::size_t pairs = curves.empty() ? 0 : curves.size() * (curves.size() - 1) / 2;
  double worst = -1;
  bool all = pairs > 0;
  for (std::size_t a = 0; a < curves.size(); ++a) {
    for (std::size_t b = a + 1; b < curves.size(); ++b) {
      const std::optional<CurveDifference> found = compare(curves[a], curves[b]);
      if (!found || !found->rms) {
        all = false;
        continue;
      }
      const double limit = limit_of_agreement(found->freedom, pairs * together);
      if (*found->rms / limit <= worst) continue;
      worst = *found->rms / limit;
      verdict.value = found->rms;
      verdict.limit = limit;
      verdict.note = fmt::format("{} and {}, {} points, {} degrees of freedom", curves[a].variant,
                                 curves[b].variant, found->points, found->freedom);
    }
  }
  if (worst >= 1) {
    verdict.ruling = Ruling::fail;
  } else if (all) {
    verdict.ruling = Ruling::pass;
  } else if (worst >= 0) {
    verdict.note += "; " + missing;
  }
  return verdict;
}

std::optional<CurveDifference> compare_phi(const Curve& a, const Curve& b, std::int64_t until) {
  std::map<std::int64_t, const CurvePoint*> second;
  for (const CurvePoint& point : b.points) second[point.cycle] = &point;
  std::vector<ComparedPoint> points;
  bool reached = false;
  for (const CurvePoint& point : a.points) {
    const auto other = second.find(point.cycle);
    if (point.cycle < 1 || point.cycle > until || other == second.end()) continue;
    points.push_back({over(point, &Measures::phi), over(*other->second, &Measures::phi)});
    reached = reached || (point.cycle == until &&
                          std::min(points.back().a.runs, points.back().b.runs) >= runs_to_tell);
  }
  if (!reached) return std::nullopt;
  constexpr double resolution = 1e-6;  // of phi: rounding, and far below any error over runs
  return difference(points, resolution);
}

/// One grain of the smallest packing [%].
double one_grain_percent(const Curve& curve) {
  std::size_t least = 0;
  for (const Measures* measures : curve.points.front().runs) {
    least = least == 0 ? measures->interior_grains : std::min(least, measures->interior_grains);
  }
  return least == 0 ? 100 : 100 / static_cast<double>(least);
}

std::optional<CurveDifference> compare_crystallinity(const Curve& a, const Curve& b) {
  constexpr double crystallized_percent = 1;
  constexpr std::size_t least_bins = 3;
  std::map<double, PhiBin> second;
  for (const PhiBin& bin : binned_by_phi(b.runs, &Measures::crystalline_percent)) {
    second[bin.low] = bin;
  }
  std::vector<ComparedPoint> points;
  for (const PhiBin& bin : binned_by_phi(a.runs, &Measures::crystalline_percent)) {
    const auto other = second.find(bin.low);
    if (other == second.end()) continue;
    const RunStatistics& value = other->second.value;
    if (std::max(bin.value.mean.value(), value.mean.value()) < crystallized_percent) continue;
    points.push_back({bin.value, value});
  }
  const CurveDifference found =
      difference(points, std::max(one_grain_percent(a), one_grain_percent(b)));
  if (found.points < least_bins) return std::nullopt;
  return found;
}

}  // namespace

Verdict phi_agrees_until(std::span<const Curve> curves, std::int64_t until, std::string claim,
                         std::size_t together) {
  return worst_pair(
      curves, std::move(claim),
      fmt::format("needs two curves of {} runs or more that reach cycle {}", runs_to_tell, until),
      together, [until](const Curve& a, const Curve& b) { return compare_phi(a, b, until); });
}

Verdict crystallinity_agrees(std::span<const Curve> curves, std::string claim) {
  return worst_pair(curves, std::move(claim),
                    fmt::format("needs every two curves to share 3 bins of phi with over 1 % "
                                "crystalline grains and {} runs each",
                                runs_to_tell),
                    1, compare_crystallinity);
}

FigureResult two_panels(std::span<const Curve> curves, const Comparison& comparison) {
  const std::string& what = comparison.what;
  return {{phi_against_cycle(comparison.name + "a", curves),
           crystallinity_against_phi(comparison.name + "b", curves)},
          {phi_agrees_until(curves, comparison.similar_until,
                            fmt::format("{}: phi against cycle is similar for {} until cycle {}",
                                        comparison.section, what, comparison.similar_until)),
           crystallinity_agrees(
               curves, fmt::format("{}: percentage crystalline against phi is one curve for {}",
                                   comparison.section, what))}};
}

}  // namespace shearcell
