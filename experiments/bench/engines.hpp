// SPDX-License-Identifier: GPL-3.0-or-later
// Compares our engine with LAMMPS in one scene: settling from one loose filling (optional),
// trajectories from one state, means over seeds, speed and memory.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/bench/packing.hpp"
#include "experiments/runner/lammps/lammps_run.hpp"

namespace shearcell::bench {

struct EngineCheckOptions {
  std::size_t grains = 2000;
  bool gravity = true;
  std::uint64_t steps = 1000;  ///< of the trajectories, and of the timing
  std::uint64_t cycles = 3;    ///< before the means; 0 leaves them out
  std::size_t seeds = 3;
  std::size_t ranks = 1;  ///< processes of LAMMPS, in addition to one alone
  bool settle = false;    ///< settle in LAMMPS too, with `ranks` processes
  double settle_time_limit = SettleParameters{}.time_limit;  ///< [s], of both engines
  std::function<void(const std::string&)> report;            ///< progress messages
};

/// The distance between the runs of both engines from one settled packing, after the same time
/// under shear.
struct TrajectoryCheck {
  std::string scene;
  std::uint64_t steps = 0;
  double distance = 0;  ///< largest distance between the two positions of a grain [d]
  double height = 0;    ///< difference of the heights of the moving walls [d]
  /// The same distance [d] between two runs of our own engine, one of which starts with one
  /// coordinate changed by a unit in the last place: the effect of rounding alone.
  double rounding = 0;
};

struct EngineSpeed {
  std::string engine;
  double million_particle_steps_per_second = 0;  ///< of LAMMPS: in its time loop alone
  double bytes = 0;  ///< ours: of the simulation; LAMMPS: of its largest process
};

/// One quantity, averaged over the packings of one engine.
struct EngineMean {
  std::string quantity, engine;
  RunStatistics of;
  double apart = 0;  ///< |mean - ours| in standard errors of the difference; 0 for ours
};

struct EngineMeans {
  std::vector<EngineMean>
      means;         ///< for each quantity that all packings have, ours first; empty for one seed
  double limit = 0;  ///< of `apart`, by Student's t, shared among all comparisons

  bool agree() const;
};

struct Settling : EngineSpeed {
  std::uint64_t seed = 0;
  State state;         ///< settled; its step counts from the loose grains
  double seconds = 0;  ///< wall time of the whole settling
  PackingNumbers numbers;
};

/// Settles the grains in LAMMPS with `ranks` processes, or in our engine if `ranks` is 0. Throws
/// NumericalFailure, for example when a packing is not settled after the time limit, and
/// ProgramError. `seen` gets the state of LAMMPS every 0.1 s of simulated time.
Settling settle_by(std::size_t ranks, const LammpsProgram& program, const Packing& loose,
                   const SettleParameters& parameters,
                   const std::function<void(const State&)>& seen = {});

struct EngineCheck {
  std::string lammps_version;
  std::size_t grains = 0;
  std::vector<Settling> settlings;  ///< ours, and LAMMPS's with the option `settle`
  EngineMeans settled;              ///< over the seeds of `settlings`
  std::vector<TrajectoryCheck> trajectories;
  EngineMeans sheared;  ///< after shear from our packings
  std::vector<EngineSpeed> speeds;

  /// Trajectories agree within the effect of rounding, and means within the limit.
  bool agree() const;
};

/// Table I in a rough cell. Throws ProgramError if LAMMPS is missing or fails, NumericalFailure if
/// a packing does not settle.
EngineCheck check_engines(const EngineCheckOptions& options);

}  // namespace shearcell::bench
