// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>

namespace shearcell {
namespace {

// Number of steps between two watchdog checks. A check takes as long as about four steps.
constexpr std::uint64_t kWatchInterval = 1024;

}  // namespace

Simulation::Simulation(Cell cell, const Scene& scene, const State& state,
                       SimulationSettings settings)
    : cell_(std::move(cell)),
      scene_(scene),
      settings_(settings),
      kernels_(*settings.kernels),
      team_(settings.threads),
      walls_(cell_),
      lists_(kernels_, settings.lists, cell_.depth, walls_, team_) {
  if (state.position.cols() == 0 || state.position.cols() != state.velocity.cols()) {
    throw std::invalid_argument(
        "a simulation needs at least one grain, and one velocity for each grain");
  }
  // A neighbour list can hold only one periodic image of each neighbour.
  if (!(cell_.depth > 2 + 4 * settings.lists.widest_margin(cell_.depth))) {
    throw std::invalid_argument("the depth of the cell, " + std::to_string(cell_.depth) +
                                " d, is less than twice the cutoff of the neighbour list. A "
                                "grain could touch two images of one neighbour, or an image of "
                                "itself. Use a deeper cell");
  }
  const auto grains = static_cast<std::size_t>(state.position.cols());
  const std::size_t room = padded(grains);
  id_.resize(grains);
  std::iota(id_.begin(), id_.end(), 0);
  for (auto& axis : velocity_) axis.assign(room, 0.0);
  moving_wall_force_y_.assign(room, 0.0);
  // Rows of spare lanes are placed far to the right and the padding row far to the left, so that
  // they touch nothing, not even each other. NaN would not be safe, since 0 * NaN is NaN.
  for (auto& rows : rows_) {
    rows.assign(4 * (room + 1 + walls_.size()), 0.0);
    for (std::size_t g = grains; g < room; ++g) rows[4 * g] = 1e30;
    rows[4 * room] = -1e30;
  }
  copy_in(state);
  set_constants();
}

void Simulation::copy_in(const State& state) {
  step_ = state.step;
  wall_height_ = state.wall_height;
  wall_velocity_ = state.wall_velocity;
  for (std::size_t g = 0; g < id_.size(); ++g) {
    Eigen::Map<Eigen::Vector3d>(rows_[0].data() + 4 * g) = state.position.col(id_[g]);
    const double* v = state.velocity.col(id_[g]).data();
    for (std::size_t axis = 0; axis < 3; ++axis) velocity_[axis][g] = v[axis];
  }
}

void Simulation::set_constants() {
  const double half = 0.5 * scene_.drag_rate * scene_.time_step;
  const double implicit = 1 / (1 + half);
  task_.grains = id_.size();
  task_.depth = cell_.depth;
  task_.per_depth = 1 / cell_.depth;
  task_.velocity_factor = (1 - half) * implicit;
  task_.contact_kick = scene_.time_step * scene_.stiffness * implicit;
  task_.gravity_step = -scene_.time_step * scene_.gravity * implicit;
  task_.time_step = scene_.time_step;
}

void Simulation::set_scene(const Scene& scene) {
  scene_ = scene;
  set_constants();
}

WallPose Simulation::pose_at(const Drive& drive, std::uint64_t step) const {
  return wall_pose(cell_, tilt(drive, step).theta, wall_height_);
}

double Simulation::shear_rate(const Drive& drive) const {
  if (drive.amplitude == 0) return 0;
  // The time derivative of tan(theta) is theta' sec^2(theta).
  const double omega =
      2 * std::numbers::pi / (static_cast<double>(drive.steps_per_cycle) * scene_.time_step);
  return tilt(drive, step_).rate * omega / (pose_.cos_theta * pose_.cos_theta);
}

void Simulation::advance(const Drive& drive, std::uint64_t steps) {
  if (steps == 0) return;
  pose_ = pose_at(drive, step_);
  if (counts_.builds == 0 || was_set_) {
    refresh_lists(drive);
    was_set_ = false;
    // Check now, because an invalid initial state may look valid at the next check.
    if (step_ == 0) watch(settings_.limits, scene_.time_step);
  }
  for (std::uint64_t n = 0; n < steps; ++n) step_once(drive);
}

void Simulation::set_state(const State& state) {
  const auto grains = static_cast<Eigen::Index>(id_.size());
  if (state.position.cols() != grains || state.velocity.cols() != grains) {
    throw std::invalid_argument("the state and the simulation have different numbers of grains");
  }
  copy_in(state);
  pose_ = pose_at(Drive{}, step_);
  if (counts_.builds > 0) walls_.place(pose_, rows_[0].data() + wall_offset(id_.size()), team_);
  was_set_ = true;
}

// Prepares a kernel call at the present positions. The kernel will check the list margins at
// `tan_theta`.
void Simulation::set_contacts(double tan_theta) {
  task_.rows = rows_[0].data();
  task_.next_rows = rows_[1].data();
  task_.tan_theta = tan_theta;
  task_.margin_loss = lists_.reference().margin_loss(tan_theta);
  task_.ahead = order_.ahead();
  task_.planes = walls_.planes(pose_);
}

// Runs the kernel on all blocks. The result is positive if a grain has exceeded its margin.
double Simulation::over_blocks(const StepTask& task) {
  const std::size_t blocks = (id_.size() + kernels_.lanes - 1) / kernels_.lanes;
  ++evaluations_;
  return team_.largest(blocks, [&](std::size_t first, std::size_t last) {
    return kernels_.step(task, first, last);
  });
}

// Writes the contact sums into sum_. Calls the kernel with constants for which no grain moves.
// Returns false if the lists were not valid.
bool Simulation::sum_contacts() {
  set_contacts(pose_.tan_theta);
  StepTask task = task_;
  task.velocity_factor = task.fluid_step = task.time_step = 0;
  task.contact_kick = 1;
  task.gravity_step = -0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    sum_[axis].assign(padded(id_.size()), 0.0);
    task.velocity[axis] = sum_[axis].data();
  }
  return lists_.inner_valid(over_blocks(task), pose_);
}

const Forces& Simulation::forces() {
  const Drive upright;
  pose_ = pose_at(upright, step_);
  if (counts_.builds == 0) refresh_lists(upright);
  if (!sum_contacts()) {
    refresh_lists(upright);
    sum_contacts();
  }
  was_set_ = false;
  forces_.on_grain.resize(3, static_cast<Eigen::Index>(id_.size()));
  for (std::size_t g = 0; g < id_.size(); ++g) {
    const Eigen::Vector3d sum(sum_[0][g], sum_[1][g], sum_[2][g]);
    forces_.on_grain.col(id_[g]) = scene_.stiffness * sum;
    forces_.on_grain(1, id_[g]) -= scene_.gravity;
  }
  forces_.on_wall = force_on_wall();
  return forces_;
}

// Sets the constants of the fluid's shear (Eq. S5). The fluid is at rest at the top wall.
void Simulation::set_fluid_step(const Drive& drive) {
  const double share = fluid_share(scene_.fluid);
  const double rate = share == 0 ? 0 : share * shear_rate(drive);
  task_.fluid_step =
      scene_.time_step * scene_.drag_rate * rate / (1 + 0.5 * scene_.drag_rate * scene_.time_step);
  task_.fluid_rest_height = pose_.top;
}

void Simulation::step_once(const Drive& drive) {
  set_fluid_step(drive);
  WallPose next = pose_at(drive, step_ + 1);
  set_contacts(next.tan_theta);
  const double excess = over_blocks(task_);

  if (holds_wall(drive, step_)) {
    wall_velocity_ = 0;
  } else {
    move_wall();
  }
  (cell_.moving == MovingWall::bottom ? next.bottom : next.top) = wall_height_;
  pose_ = next;
  walls_.place(pose_, rows_[1].data() + wall_offset(id_.size()), team_);
  std::swap(rows_[0], rows_[1]);
  ++step_;
  if (!lists_.inner_valid(excess, pose_)) refresh_lists(drive);
  if (step_ % kWatchInterval == 0) {
    zero_slowest_velocities();
    watch(settings_.limits, scene_.time_step);
  } else if (drive.amplitude != 0 && step_ % cycle_steps(drive) == 0) {
    watch(settings_.limits, 0);  // a run may be shorter than kWatchInterval
  }
}

// Drag alone can reduce a velocity to a subnormal number. Operations on subnormal numbers take a
// hundred times as long, and a velocity this small changes no position.
void Simulation::zero_slowest_velocities() {
  const auto zero = [](double& v) {
    if (v != 0 && std::fabs(v) < 0x1p-1000) v = 0;
  };
  for (auto& axis : velocity_) std::for_each(axis.begin(), axis.end(), zero);
  zero(wall_velocity_);
}

void Simulation::check() const {
  // Without neighbour lists, no step was made: the state is as loaded, and is not checked.
  if (counts_.builds > 0) watch(settings_.limits, 0);
}

void Simulation::check_recordable() const {
  WatchdogLimits limits = settings_.limits;
  limits.overlap = std::numeric_limits<double>::infinity();
  if (counts_.builds > 0) watch(limits, 0);
}

void Simulation::watch(const WatchdogLimits& limits, double time_step) const {
  check_grains({.cell = cell_,
                .scene = scene_,
                .planes = wall_planes(cell_, pose_),
                .limits = limits,
                .rows = rows_[0].data(),
                .velocity = {velocity_[0].data(), velocity_[1].data(), velocity_[2].data()},
                .id = id_,
                .neighbours = lists_.rows(),
                .lanes = kernels_.lanes,
                .step = step_,
                .time_step = time_step,
                .wall_height = wall_height_,
                .wall_velocity = wall_velocity_});
}

// Force on the moving wall without its drag, positive upwards: the load, which pushes the wall into
// the cell, plus the contact forces of the grains on the wall.
double Simulation::force_on_wall() const {
  double contacts = 0;
  for (const std::int32_t g : lists_.at_moving_wall()) {
    contacts += moving_wall_force_y_[static_cast<std::size_t>(g)];
  }
  const double area = cell_.width * cell_.depth;
  const double load = scene_.pressure * area + carried_weight(scene_, cell_, id_.size());
  return inwards(cell_) * load - scene_.stiffness * contacts;
}

void Simulation::move_wall() {
  const double mass = scene_.wall_mass * (cell_.width * cell_.depth);
  const double half = 0.5 * scene_.time_step * scene_.wall_drag / scene_.wall_mass;
  wall_velocity_ =
      ((1 - half) * wall_velocity_ + scene_.time_step * (force_on_wall() / mass)) / (1 + half);
  wall_height_ += scene_.time_step * wall_velocity_;
}

Snapshot Simulation::snapshot(const Drive& drive) {
  return {.rows = rows_[0].data(),
          .velocity = {velocity_[0].data(), velocity_[1].data(), velocity_[2].data()},
          .grains = id_.size(),
          .pose = pose_,
          .time_step = scene_.time_step,
          .shear_rate = shear_rate(drive),
          .wall_speed = std::fabs(wall_velocity_),
          .step = step_};
}

void Simulation::refresh_lists(const Drive& drive) {
  const bool first = counts_.builds == 0;
  if (first || !lists_.prune(snapshot(drive))) rebuild_lists(drive);
  if (first) rebuild_lists(drive);  // sort_memory() needs the lists of the first build
  ++counts_.prunes;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    task_.velocity[axis] = velocity_[axis].data();
    task_.reference[axis] = lists_.reference().data(axis);
  }
  task_.moving_wall_force_y = moving_wall_force_y_.data();
  task_.frame_height = lists_.reference().frame_height();
  task_.neighbours = lists_.rows();
}

void Simulation::rebuild_lists(const Drive& drive) {
  lists_.set_outer_margins(snapshot(drive));
  const double reach = 1 + 2 * lists_.widest_margin();
  walls_.choose_active(pose_, 2 * reach);
  const auto walls = static_cast<std::int32_t>(walls_.size());
  std::vector<Site> sites;
  sites.reserve(walls_.active().size() + id_.size());
  for (const std::int32_t w : walls_.active()) {
    sites.push_back({wall_offset(id_.size()) + 4 * w, w});
  }
  for (std::size_t g = 0; g < id_.size(); ++g) {
    sites.push_back({static_cast<std::int32_t>(4 * g), walls + id_[g]});
  }
  order_.build(cell_, pose_, reach, rows_[0].data(), sites, team_);
  // Not every rebuild sorts the grains in memory: if many grains are fast, the lists must be
  // rebuilt much more often than the grains must be sorted.
  const bool stale = counts_.builds < 2 || step_ - sorted_at_ >= 200;
  if (settings_.lists.sort_memory && stale) sort_memory();
  lists_.build(snapshot(drive), id_, order_);
  // Both buffers need the padding row and the rows of all wall grains. These rows are copied
  // here, because Walls::place() later writes only the rows of the active wall grains.
  std::copy(rows_[0].begin() + padding_offset(id_.size()), rows_[0].end(),
            rows_[1].begin() + padding_offset(id_.size()));
  ++counts_.builds;
}

// Sorts the grains by grid cell, so that neighbours are close together in memory. Then sorts each
// group of 256 grains by flags (near a wall or the periodic boundary) and number of neighbours. So
// grains that share a vector need the same branches and have neighbour lists of similar length.
void Simulation::sort_memory() {
  constexpr std::size_t kStretch = 256;
  const auto first_grain = static_cast<std::int32_t>(walls_.active().size());
  std::vector<std::int32_t> from;
  from.reserve(id_.size());
  for (const std::int32_t site : order_.site()) {
    if (site >= first_grain) from.push_back(site - first_grain);
  }
  const std::vector<std::uint16_t>& neighbours = lists_.inner_count();
  if (!neighbours.empty()) {
    const auto key = [&](std::int32_t g) {
      const auto at = static_cast<std::size_t>(g);
      return (lists_.near()[at] << 16) + neighbours[at];
    };
    const std::size_t stretches = (from.size() + kStretch - 1) / kStretch;
    team_.run(stretches, [&](std::size_t, std::size_t first, std::size_t last) {
      for (std::size_t stretch = first; stretch < last; ++stretch) {
        const std::size_t end = std::min((stretch + 1) * kStretch, from.size());
        std::stable_sort(from.begin() + static_cast<std::ptrdiff_t>(stretch * kStretch),
                         from.begin() + static_cast<std::ptrdiff_t>(end),
                         [&](std::int32_t a, std::int32_t b) { return key(a) < key(b); });
      }
    });
  }
  const auto old_id = id_;
  const auto old_velocity = velocity_;
  team_.run(id_.size(), [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t g = first; g < last; ++g) {
      const auto old = static_cast<std::size_t>(from[g]);
      id_[g] = old_id[old];
      std::copy_n(rows_[0].data() + 4 * old, 4, rows_[1].data() + 4 * g);
      for (std::size_t axis = 0; axis < 3; ++axis) velocity_[axis][g] = old_velocity[axis][old];
    }
  });
  std::copy(rows_[0].begin() + padding_offset(id_.size()), rows_[0].end(),
            rows_[1].begin() + padding_offset(id_.size()));
  std::swap(rows_[0], rows_[1]);
  sorted_at_ = step_;
}

State Simulation::state() const {
  State state;
  state.step = step_;
  state.wall_height = wall_height_;
  state.wall_velocity = wall_velocity_;
  const auto grains = static_cast<Eigen::Index>(id_.size());
  state.position.resize(3, grains);
  state.velocity.resize(3, grains);
  for (std::size_t g = 0; g < id_.size(); ++g) {
    state.position.col(id_[g]) = Eigen::Map<const Eigen::Vector3d>(rows_[0].data() + 4 * g);
    state.velocity.col(id_[g]) << velocity_[0][g], velocity_[1][g], velocity_[2][g];
  }
  return state;
}

std::size_t Simulation::bytes() const {
  return 8 * (rows_[0].size() + rows_[1].size() + 3 * velocity_[0].size() +
              moving_wall_force_y_.size()) +
         4 * id_.size() + lists_.bytes() + walls_.bytes() + order_.bytes();
}

}  // namespace shearcell
