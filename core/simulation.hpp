// SPDX-License-Identifier: GPL-3.0-or-later
// Simulates one cell: the time loop with contacts, drag, gravity, drive and moving wall.
//
// The integrator is a leapfrog with implicit drag. With velocities v at half steps,
//   v' = [(1 - b dt/2m) v + dt (F/m + b/m u)] / (1 + b dt/2m),   x' = x + dt v',
// where F depends only on positions and u is the velocity of the fluid. The moving wall is
// integrated by the same scheme. The scheme is velocity Verlet with velocities stored at half
// steps. A restart from (x, v, step) is exact.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/aligned.hpp"
#include "core/cell.hpp"
#include "core/cell_order.hpp"
#include "core/drive.hpp"
#include "core/kernel.hpp"
#include "core/neighbour_lists.hpp"
#include "core/scene.hpp"
#include "core/state.hpp"
#include "core/team.hpp"
#include "core/walls.hpp"
#include "core/watchdog.hpp"

namespace shearcell {

/// Settings that change the speed of a simulation, not its result.
struct SimulationSettings {
  const Kernels* kernels = kernels_here().front();  ///< not null
  std::size_t threads = 1;
  ListSettings lists;
  WatchdogLimits limits;  ///< limits that decide when a run fails; they change no result
};

/// How often the outer lists were built and how often the inner lists were pruned.
struct ListCounts {
  std::uint64_t builds = 0;
  std::uint64_t prunes = 0;
};

/// Net forces [m d/s^2] on the grains and the moving wall.
struct Forces {
  Eigen::Matrix3Xd on_grain;  ///< force from contacts and gravity, by permanent id
  double on_wall = 0;         ///< upward force on the moving wall from load and contacts
};

/// Upper bound of the overlap limit of a run [d]. Simulations that begin with a recorded state use
/// this limit, because the run that recorded the state checked the overlaps against its own limit.
inline constexpr double kLargestOverlapLimit = 0.5;

class Simulation {
 public:
  /// Copies `state`. Throws std::invalid_argument if there is no grain, if the numbers of positions
  /// and velocities differ, or if the cell is too shallow for the cutoffs of the neighbour lists.
  Simulation(Cell cell, const Scene& scene, const State& state, SimulationSettings settings = {});

  /// Advances by `steps` time steps. The watchdog runs at step 0 and every 1024 steps. It also runs
  /// at the end of each cycle, without the time-step check. It runs at no other step, because a
  /// failure must not depend on where the run was recorded or continued. Throws NumericalFailure.
  void advance(const Drive& drive, std::uint64_t steps);

  /// Runs all watchdog checks now, except the time-step check. Throws NumericalFailure.
  void check() const;

  /// Checks that all numbers are finite and all grains are inside the cell. A state that fails this
  /// check must not be recorded. Throws NumericalFailure.
  void check_recordable() const;

  /// Replaces the state by another state of the same grains, with upright walls. Throws
  /// std::invalid_argument if the number of grains differs.
  void set_state(const State& state);

  /// Forces at the present positions, without drag and with upright walls. The forces have the same
  /// bits as in a time step. After steps with tilted walls, call set_state() first. The returned
  /// reference is valid until the next call.
  const Forces& forces();

  /// The state in the order of the permanent ids.
  State state() const;
  std::uint64_t step() const { return step_; }
  const Cell& cell() const { return cell_; }
  const Scene& scene() const { return scene_; }
  std::size_t grains() const { return id_.size(); }
  /// Number of force evaluations by advance() and forces() since construction.
  std::uint64_t evaluations() const { return evaluations_; }
  const ListCounts& list_counts() const { return counts_; }
  /// Memory used for grains, walls and lists [bytes].
  std::size_t bytes() const;

  /// Replaces the scene from the next step on. The state does not change.
  void set_scene(const Scene& scene);

  /// Sets the largest overlap that the watchdog allows [d].
  void set_overlap_limit(double limit) { settings_.limits.overlap = limit; }

 private:
  void copy_in(const State& state);
  void set_constants();
  void rebuild_lists(const Drive& drive);
  void refresh_lists(const Drive& drive);
  void sort_memory();
  void step_once(const Drive& drive);
  void set_contacts(double tan_theta);
  double over_blocks(const StepTask& task);
  bool sum_contacts();
  void set_fluid_step(const Drive& drive);
  double force_on_wall() const;
  void move_wall();
  void zero_slowest_velocities();
  void watch(const WatchdogLimits& limits, double time_step) const;
  WallPose pose_at(const Drive& drive, std::uint64_t step) const;
  double shear_rate(const Drive& drive) const;
  Snapshot snapshot(const Drive& drive);

  Cell cell_;
  Scene scene_;
  SimulationSettings settings_;
  const Kernels& kernels_;
  Team team_;
  std::uint64_t step_ = 0;
  std::uint64_t sorted_at_ = 0;  // step of the last sort_memory()
  double wall_height_ = 0, wall_velocity_ = 0;
  std::vector<std::int32_t> id_;  // permanent id of each grain, in memory order
  std::array<AlignedVector<double>, 2> rows_;
  std::array<AlignedVector<double>, 3> velocity_;
  std::vector<double> moving_wall_force_y_;  // output of the kernel, see StepTask
  CellOrder order_;
  Walls walls_;
  NeighbourLists lists_;
  WallPose pose_;  // at step_
  StepTask task_;
  std::array<AlignedVector<double>, 3> sum_;  // contact sums for forces()
  Forces forces_;
  bool was_set_ = false;  // set_state() was called after the last check of the lists
  std::uint64_t evaluations_ = 0;
  ListCounts counts_;
};

}  // namespace shearcell
