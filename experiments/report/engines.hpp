// SPDX-License-Identifier: GPL-3.0-or-later
// Our engine beside LAMMPS in one scene: trajectories from one state, then means over seeds, then
// speed and memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "analysis/statistics.hpp"

namespace shearcell {

struct EngineCheckOptions {
  std::size_t grains = 2000;
  bool gravity = true;
  std::uint64_t steps = 1000;  ///< of the trajectories, and of the timing
  std::uint64_t cycles = 3;    ///< before the means; 0 leaves them out
  std::size_t seeds = 3;
  std::size_t ranks = 1;                           ///< processes of LAMMPS, besides one alone
  std::function<void(const std::string&)> report;  ///< what is being done now; may be empty
};

/// How far two runs from one settled packing are apart after the same time under shear.
struct TrajectoryCheck {
  std::string scene;
  std::uint64_t steps = 0;
  double distance = 0;  ///< largest of a grain from where our engine has it [d]
  double height = 0;    ///< of the moving walls from each other [d]
  /// Largest distance [d] between two runs of our own engine, one of whose grains began 1e-16 d
  /// elsewhere: what rounding alone does. 0 where it was not measured.
  double rounding = 0;
};

struct EngineMean {
  std::string name;
  std::vector<RunStatistics> of;  ///< in the order of EngineCheck::engines
  /// Of each engine's mean from ours, in standard errors of that difference; 0 for ours.
  std::vector<double> apart;
};

struct EngineSpeed {
  std::string engine;
  double million_particle_steps_per_second = 0;
  double bytes = 0;  ///< ours: of the simulation; LAMMPS: of its largest process
};

struct EngineCheck {
  std::string lammps_version;
  std::size_t grains = 0;
  double settle_seconds = 0, settled_phi = 0;  ///< of the first packing, by our engine
  std::vector<TrajectoryCheck> trajectories;
  double explicit_drag_order = 0;  ///< log2 of the ratio of errors at dt and dt/2
  std::vector<std::string> engines;
  std::vector<EngineMean> means;
  double limit = 0;  ///< of `apart`, by Student's t, shared among all comparisons
  std::vector<EngineSpeed> speeds;

  /// Whether trajectories agree as far as rounding lets them, and means within the limit.
  bool agree() const;
};

/// Table I in a rough cell. Throws EngineError when LAMMPS is missing or fails, NumericalFailure
/// when a packing does not settle.
EngineCheck check_engines(const EngineCheckOptions& options);

}  // namespace shearcell
