// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/packing_numbers.hpp"

#include <cmath>

#include "analysis/measures.hpp"
#include "core/diagnostics.hpp"

namespace shearcell {
namespace {

EngineMean mean_of(const std::string& name,
                   const std::vector<std::vector<PackingNumbers>>& of_engine,
                   double PackingNumbers::*member) {
  EngineMean mean{name, {}, {}};
  for (const std::vector<PackingNumbers>& packings : of_engine) {
    std::vector<double> values;
    for (const PackingNumbers& numbers : packings) values.push_back(numbers.*member);
    mean.of.push_back(over_runs(values));
    const RunStatistics &a = mean.of.front(), &b = mean.of.back();
    const double error = std::hypot(a.standard_error.value_or(0), b.standard_error.value_or(0));
    mean.apart.push_back(error > 0 ? std::fabs(*b.mean - *a.mean) / error : 0);
  }
  return mean;
}

}  // namespace

PackingNumbers numbers_of(const Cell& cell, const Scene& scene, double theta, const State& state) {
  const WallPose pose = wall_pose(cell, theta, state.wall_height);
  const Measures measures = analyse(cell, pose, state.position).measures;
  const Diagnostics facts = diagnose(cell, scene, state, pose);
  return {measures.phi, measures.contacts_per_grain, measures.mean_overlap,
          std::fabs(facts.wall_imbalance), pose.top - pose.bottom};
}

std::vector<EngineMean> engine_means(const std::vector<std::vector<PackingNumbers>>& of_engine) {
  using N = PackingNumbers;
  return {mean_of("phi", of_engine, &N::phi),
          mean_of("contacts per grain", of_engine, &N::contacts),
          mean_of("mean overlap [d]", of_engine, &N::overlap),
          mean_of("force imbalance of the wall", of_engine, &N::imbalance),
          mean_of("height [d]", of_engine, &N::height)};
}

}  // namespace shearcell
