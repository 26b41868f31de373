// SPDX-License-Identifier: GPL-3.0-or-later
// Our engine beside LAMMPS in one scene: settling from one loose filling where that is asked for,
// trajectories from one state, then means over seeds, then speed and memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "experiments/bench/settling.hpp"

namespace shearcell {

struct EngineCheckOptions {
  std::size_t grains = 2000;
  bool gravity = true;
  std::uint64_t steps = 1000;  ///< of the trajectories, and of the timing
  std::uint64_t cycles = 3;    ///< before the means; 0 leaves them out
  std::size_t seeds = 3;
  std::size_t ranks = 1;  ///< processes of LAMMPS, besides one alone
  bool settle = false;    ///< settle in LAMMPS too, by `ranks` processes
  double settle_time_limit = SettleParameters{}.time_limit;  ///< [s], of either
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

struct EngineSpeed {
  std::string engine;
  double million_particle_steps_per_second = 0;
  double bytes = 0;  ///< ours: of the simulation; LAMMPS: of its largest process
};

/// Means of several engines, ours first.
struct EngineMeans {
  std::vector<std::string> engines;
  std::vector<EngineMean> means;  ///< none where there was one seed
  double limit = 0;               ///< of `apart`, by Student's t, shared among all comparisons

  bool agree() const;
};

/// Loose grains of one seed, settled by one engine.
struct EngineSettling {
  std::string engine;
  std::uint64_t seed = 0;
  Settling result;
};

struct EngineCheck {
  std::string lammps_version;
  std::size_t grains = 0;
  std::vector<EngineSettling> settlings;  ///< ours, and LAMMPS's where that was asked for
  EngineMeans settled;                    ///< over the seeds of `settlings`
  std::vector<TrajectoryCheck> trajectories;
  double explicit_drag_order = 0;  ///< log2 of the ratio of errors at dt and dt/2
  EngineMeans sheared;             ///< after some cycles from our packings
  std::vector<EngineSpeed> speeds;

  /// Whether trajectories agree as far as rounding lets them, and means within the limit.
  bool agree() const;
};

/// Table I in a rough cell. Throws EngineError when LAMMPS is missing or fails, NumericalFailure
/// when a packing does not settle.
EngineCheck check_engines(const EngineCheckOptions& options);

}  // namespace shearcell
