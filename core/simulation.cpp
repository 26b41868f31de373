// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>

namespace shearcell {
namespace {

// Steps between two looks of the watchdog, which cost less than two steps each.
constexpr std::uint64_t kWatchInterval = 1024;

const Kernels& require_kernels(const Kernels* kernels) {
  if (kernels == nullptr) {
    throw std::invalid_argument("this machine lacks the instructions of the kernel asked for");
  }
  return *kernels;
}

}  // namespace

Simulation::Simulation(Cell cell, const Scene& scene, const State& state, EngineSettings settings)
    : cell_(std::move(cell)),
      scene_(scene),
      settings_(settings),
      kernels_(require_kernels(settings.kernels)),
      team_(std::make_unique<Team>(settings.threads)),
      lists_(kernels_, settings.lists, cell_.depth, *team_),
      walls_(kernels_, cell_) {
  if (state.position.cols() == 0 || state.position.cols() != state.velocity.cols()) {
    throw std::invalid_argument("a simulation needs as many velocities as positions, and a grain");
  }
  // A grain must not meet a neighbour through both seams.
  if (!(cell_.depth > 2 * settings.lists.outer_cutoff)) {
    throw std::invalid_argument("the depth of the cell, " + std::to_string(cell_.depth) +
                                " d, is less than twice the cutoff of the neighbour list");
  }
  farthest_of_thread_.resize(team_->size());
  load(state);
  set_constants();
}

void Simulation::load(const State& state) {
  const auto grains = static_cast<std::size_t>(state.position.cols());
  const std::size_t room = padded(grains);
  step_ = state.step;
  wall_height_ = state.wall_height;
  wall_velocity_ = state.wall_velocity;
  id_.resize(grains);
  std::iota(id_.begin(), id_.end(), 0);
  for (auto& axis : velocity_) axis.assign(room, 0.0);
  for (auto& axis : wall_sum_) axis.assign(room, 0.0);
  // Spare lanes sit far off on one side and the padding of the lists far off on the other, so that
  // neither touches anything (nor each other, for which NaN would not be safe: 0 * NaN).
  for (auto& rows : rows_) {
    rows.assign(4 * (room + 1), 0.0);
    for (std::size_t g = grains; g < room; ++g) rows[4 * g] = 1e30;
    rows[4 * room] = -1e30;
  }
  for (std::size_t g = 0; g < grains; ++g) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      rows_[0][4 * g + axis] = state.position(a, static_cast<Eigen::Index>(g));
      velocity_[axis][g] = state.velocity(a, static_cast<Eigen::Index>(g));
    }
  }
}

void Simulation::set_constants() {
  const double half = 0.5 * scene_.drag_rate * scene_.time_step;
  const double implicit = 1 / (1 + half);
  task_.grains = id_.size();
  task_.depth = cell_.depth;
  task_.per_depth = 1 / cell_.depth;
  task_.keep = (1 - half) * implicit;
  task_.kick = scene_.time_step * scene_.stiffness * implicit;
  task_.fall = -scene_.time_step * scene_.gravity * implicit;
  task_.time_step = scene_.time_step;
}

void Simulation::set_scene(const Scene& scene) {
  scene_ = scene;
  set_constants();
}

WallPose Simulation::pose_at(const Drive& drive, std::uint64_t step) const {
  return wall_pose(cell_, tilt(drive, step).theta, wall_height_);
}

void Simulation::advance(const Drive& drive, std::uint64_t steps) {
  if (steps == 0) return;
  pose_ = pose_at(drive, step_);
  if (counts_.builds == 0) rebuild_lists();
  for (std::uint64_t n = 0; n < steps; ++n) step_once(drive);
}

void Simulation::step_once(const Drive& drive) {
  const double push = walls_.evaluate(rows_[0].data(), pose_, wall_sum_);
  move_wall(push);
  const WallPose next = pose_at(drive, step_ + 1);

  const bool flow = scene_.fluid == Fluid::cell && drive.amplitude != 0;
  if (flow) {
    // du/dy of Eq. S5 with the height counted from the top wall: theta' sec^2(theta).
    const double omega =
        2 * std::numbers::pi / (static_cast<double>(drive.steps_per_cycle) * scene_.time_step);
    const double shear_rate = tilt(drive, step_).rate * omega / (pose_.cos_theta * pose_.cos_theta);
    task_.flow = scene_.time_step * scene_.drag_rate * shear_rate /
                 (1 + 0.5 * scene_.drag_rate * scene_.time_step);
    task_.top = pose_.top;
  }
  task_.rows = rows_[0].data();
  task_.next_rows = rows_[1].data();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    task_.velocity[axis] = velocity_[axis].data();
    task_.wall_sum[axis] = wall_sum_[axis].data();
    task_.reference[axis] = lists_.reference().data(axis);
  }
  task_.neighbours = lists_.rows();
  task_.walled = walls_.walled().data();
  task_.next_shear = next.tan_theta;
  task_.next_top = next.top;
  const std::size_t blocks = (id_.size() + kernels_.lanes - 1) / kernels_.lanes;
  const auto step = kernels_.step[scene_.gravity != 0][flow];
  std::vector<double>& squares = farthest_of_thread_;
  team_->run(blocks, [&](std::size_t thread, std::size_t first, std::size_t last) {
    squares[thread] = step(task_, first, last);
  });
  const double square = *std::max_element(squares.begin(), squares.end());

  std::swap(rows_[0], rows_[1]);
  ++step_;
  pose_ = next;
  if (!lists_.inner_valid(std::sqrt(square), pose_)) refresh_lists();
  if (step_ % kWatchInterval == 0) check();
}

void Simulation::check() const {
  if (counts_.builds == 0) return;  // nothing has happened to the state that was loaded
  WatchTask task;
  task.rows = rows_[0].data();
  for (std::size_t axis = 0; axis < 3; ++axis) task.velocity[axis] = velocity_[axis].data();
  task.id = &id_;
  task.neighbours = lists_.rows();
  task.lanes = kernels_.lanes;
  task.step = step_;
  check_grains(task, cell_, scene_, pose_, settings_.limits);
}

void Simulation::move_wall(double push) {
  // Contacts push the wall by minus what they push the grains by. The pressure points inwards.
  const double area = cell_.width * cell_.depth;
  const double inwards = cell_.moving == MovingWall::bottom ? 1.0 : -1.0;
  const double force = inwards * scene_.pressure * area - scene_.stiffness * push;
  const double mass = scene_.wall_mass * area;
  const double half = 0.5 * scene_.time_step * scene_.wall_drag / scene_.wall_mass;
  wall_velocity_ = ((1 - half) * wall_velocity_ + scene_.time_step * (force / mass)) / (1 + half);
  wall_height_ += scene_.time_step * wall_velocity_;
}

void Simulation::refresh_lists() {
  if (!lists_.outer_valid(rows_[0].data(), id_.size(), pose_)) {
    rebuild_lists();
  } else {
    prune_lists();
  }
}

void Simulation::rebuild_lists() {
  const double cutoff = settings_.lists.outer_cutoff;
  order_.build(cell_, pose_, cutoff, rows_[0].data(), id_);
  if (settings_.lists.sort_memory) sort_memory();
  lists_.build(rows_[0].data(), id_, order_, pose_);
  walls_.build(rows_[0].data(), id_, pose_, cutoff);
  ++counts_.builds;
  prune_lists();
}

void Simulation::prune_lists() {
  lists_.prune(rows_[0].data(), id_.size(), pose_);
  walls_.prune(rows_[0].data(), pose_, settings_.lists.inner_cutoff);
  for (auto& axis : wall_sum_) std::fill(axis.begin(), axis.end(), 0.0);
  ++counts_.prunes;
}

// Near in space is near in memory, and within a stretch of memory the grains with equally many
// neighbours share a vector, whose lanes all wait for the longest list.
void Simulation::sort_memory() {
  constexpr std::size_t kStretch = 64;
  std::vector<std::int32_t> from = order_.grain();
  const std::vector<std::uint16_t>& neighbours = lists_.inner_count();
  if (!neighbours.empty()) {
    for (std::size_t first = 0; first < from.size(); first += kStretch) {
      const std::size_t last = std::min(first + kStretch, from.size());
      std::stable_sort(from.begin() + static_cast<std::ptrdiff_t>(first),
                       from.begin() + static_cast<std::ptrdiff_t>(last),
                       [&](std::int32_t a, std::int32_t b) {
                         return neighbours[static_cast<std::size_t>(a)] <
                                neighbours[static_cast<std::size_t>(b)];
                       });
    }
  }
  const auto old_id = id_;
  const auto old_velocity = velocity_;
  for (std::size_t g = 0; g < id_.size(); ++g) {
    const auto old = static_cast<std::size_t>(from[g]);
    id_[g] = old_id[old];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      rows_[1][4 * g + axis] = rows_[0][4 * old + axis];
      velocity_[axis][g] = old_velocity[axis][old];
    }
  }
  std::swap(rows_[0], rows_[1]);
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
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      state.position(a, id_[g]) = rows_[0][4 * g + axis];
      state.velocity(a, id_[g]) = velocity_[axis][g];
    }
  }
  return state;
}

std::size_t Simulation::bytes() const {
  return 8 * (rows_[0].size() + rows_[1].size() + 3 * (velocity_[0].size() + wall_sum_[0].size())) +
         4 * id_.size() + lists_.bytes() + walls_.bytes() + order_.bytes();
}

}  // namespace shearcell
