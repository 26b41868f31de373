// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/engine.hpp"

#include <chrono>
#include <utility>

#include "core/drive.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/runner/outlook.hpp"

namespace shearcell {
namespace {

// Time for LAMMPS to write a frame and end. It checks for a stop every half second; batch systems
// kill half a minute after their first signal.
constexpr std::chrono::seconds kPatience{10};

class OwnEngine final : public Engine {
 public:
  OwnEngine(const ReadyStage& plan, Beginning&& beginning, std::size_t threads)
      : plan_(plan), simulation_(make_simulation(plan, std::move(beginning), threads)) {}

  StageProgress advance() override {
    return progress_ = plan_.protocol->advance(simulation_, chunk_steps(simulation_.grains()));
  }
  StageProgress halt() override {
    progress_.checkpoint_due = true;
    return progress_;
  }
  Checkpoint checkpoint(double cycle) const override {
    return make_checkpoint(plan_, simulation_, cycle);
  }
  std::uint64_t step() const override { return simulation_.step(); }
  std::uint64_t evaluations() const override { return simulation_.evaluations(); }

 private:
  const ReadyStage& plan_;
  Simulation simulation_;
  StageProgress progress_;
};

class LammpsEngine final : public Engine {
 public:
  LammpsEngine(const ReadyStage& plan, Beginning&& beginning, const Parallel& parallel,
               const LammpsProgram& program)
      : plan_(plan),
        stride_(checkpoint_cadence(plan.run.asks) * cycle_steps(plan.protocol->drive())),
        cell_(std::move(beginning.cell)),
        state_(std::move(beginning.state)),
        first_(state_.step),
        step_(first_) {
    const std::uint64_t end = plan.protocol->last_step();
    if (first_ >= end) return;
    const LammpsTask task{.cell = cell_,
                          .scene = plan.scene,
                          .drive = plan.protocol->drive(),
                          .state = state_,
                          .end = end,
                          .stride = stride_,
                          .check_every = lammps_check_steps(plan.run.grains, parallel.ranks)};
    run_.emplace(program, task, parallel.ranks);
  }

  StageProgress advance() override {
    constexpr std::chrono::milliseconds patience{50};
    const bool moved = run_ && take(run_->next_frame(patience));
    if (run_ && !moved) step_ = run_->step();
    return progress(moved);
  }

  StageProgress halt() override {
    run_->ask_to_stop();
    const bool answered = take(run_->next_frame(kPatience));
    StageProgress halted = progress(answered);
    halted.checkpoint_due = answered;
    return halted;
  }

  Checkpoint checkpoint(double cycle) const override {
    return make_checkpoint(plan_, cell_, plan_.scene, state_, cycle);
  }
  std::uint64_t step() const override { return step_; }
  std::uint64_t evaluations() const override { return step_ - first_; }

 private:
  // The watchdog checks the frame after a step of our own engine from it.
  bool take(std::optional<State> frame) {
    if (!frame) return false;
    state_ = std::move(*frame);
    Simulation watched = make_simulation(plan_, {cell_, state_, std::nullopt, ""}, 1);
    watched.advance(plan_.protocol->drive(), 1);
    watched.check();
    step_ = state_.step;
    return true;
  }

  StageProgress progress(bool at_frame) const {
    StageProgress progress;
    const auto per_cycle = static_cast<double>(cycle_steps(plan_.protocol->drive()));
    progress.cycle = static_cast<double>(step_) / per_cycle;
    progress.finished = state_.step >= plan_.protocol->last_step();
    progress.checkpoint_due = progress.finished || (at_frame && step_ % stride_ == 0);
    return progress;
  }

  const ReadyStage& plan_;
  std::uint64_t stride_;
  Cell cell_;
  State state_;  ///< of the last frame
  std::uint64_t first_;
  std::uint64_t step_;  ///< where LAMMPS is
  std::optional<LammpsRun> run_;
};

}  // namespace

std::unique_ptr<Engine> make_engine(const ReadyStage& plan, Beginning&& beginning,
                                    const Parallel& parallel,
                                    const std::optional<LammpsProgram>& lammps) {
  if (lammps) {
    return std::make_unique<LammpsEngine>(plan, std::move(beginning), parallel, *lammps);
  }
  return std::make_unique<OwnEngine>(plan, std::move(beginning), parallel.threads);
}

std::vector<std::string> lammps_caveats() {
  return {
      "LAMMPS computes the shear alone; packings are placed and settled by this program, and "
      "shared.",
      "Results equal ours up to rounding; the bits differ, also between numbers of processes.",
      "These runs have ids of their own. verify --replay, regenerate and prune leave them out.",
      "The watchdog sees their checkpoints, not every 1024th step; a grain whose centre reaches a "
      "wall's plane ends a run."};
}

}  // namespace shearcell
