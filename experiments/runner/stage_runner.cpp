// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/stage_runner.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>

#include "core/diagnostics.hpp"
#include "core/drive.hpp"
#include "core/filling.hpp"
#include "core/simulation.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/runner/host.hpp"
#include "experiments/runner/stop.hpp"
#include "protocols/cyclic_shear.hpp"
#include "protocols/settle.hpp"
#include "provenance/errors.hpp"

namespace shearcell {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// About 50 ms of work at 50 million particle-steps/s.
std::uint64_t chunk_steps(std::size_t grains) {
  return std::max<std::uint64_t>(1, 2'500'000 / std::max<std::size_t>(1, grains));
}

std::unique_ptr<Protocol> make_protocol(const StageRecord& stage, std::uint64_t cycles,
                                        std::uint64_t checkpoint_every) {
  const Parameters& p = stage.parameters;
  if (stage.stage == Stage::prepare) {
    return std::make_unique<Settle>(
        SettleParameters{p.settle_force_tolerance, p.settle_kinetic_tolerance,
                         p.settle_time_limit_s},
        settle_scene(p));
  }
  return std::make_unique<CyclicShear>(drive(p), cycles, checkpoint_every);
}

struct Beginning {
  Cell cell;
  State state;
  std::optional<std::string> from;  ///< checkpoint of this stage that it continues
};

Beginning begin(Store& store, const RunRecord& run, const StageRecord& stage,
                std::vector<std::string>& damage) {
  if (auto newest = store.newest_valid_checkpoint(run.id, &damage)) {
    return {std::move(newest->checkpoint.cell), std::move(newest->checkpoint.state),
            newest->record.sha256};
  }
  if (run.parent.empty()) {
    const Geometry shape = geometry(stage.parameters);
    Cell cell = make_cell(shape, stage.seed);
    State state = fill_cell(cell, shape, stage.seed);
    return {std::move(cell), std::move(state), std::nullopt};
  }
  auto parent = store.newest_valid_checkpoint(run.parent, &damage);
  if (!parent) {
    throw StoreDamaged("run " + run.parent.substr(0, 12) + ": the settled packing that run " +
                       run.id.substr(0, 12) +
                       " starts from is missing; run the manifest again to make it anew");
  }
  parent->checkpoint.state.step = 0;
  return {std::move(parent->checkpoint.cell), std::move(parent->checkpoint.state), std::nullopt};
}

// A stage in progress: the simulation and what has not been recorded of it yet.
class Attempt {
 public:
  Attempt(Store& store, RunRecord run, const StageOptions& options)
      : store_(store),
        run_(std::move(run)),
        options_(options),
        stage_(read_stage(run_.resolved)),
        scene_(stage_.stage == Stage::prepare ? settle_scene(stage_.parameters)
                                              : shear_scene(stage_.parameters)),
        protocol_(make_protocol(stage_, run_.target_cycles, options.checkpoint_every)) {}

  StageOutcome run() {
    std::vector<std::string> damage;
    Beginning beginning = begin(store_, run_, stage_, damage);
    for (const std::string& what : damage) {
      if (options_.damaged) options_.damaged(what);
    }
    store_.start_run(run_.id, host_facts(), beginning.from);
    EngineSettings settings;
    settings.threads = options_.threads;
    settings.limits.overlap = stage_.parameters.max_overlap_diameters;
    Simulation simulation(std::move(beginning.cell), scene_, beginning.state, settings);
    first_step_ = recorded_step_ = simulation.step();
    try {
      // The settled packing is cycle 0 of what follows.
      if (!beginning.from && stage_.stage == Stage::shear) record(simulation, 0);
      return advance(simulation);
    } catch (const NumericalFailure& failure) {
      store_.fail_run(run_.id, failure.what(),
                      {{"quantity", failure.quantity},
                       {"value", failure.value},
                       {"limit", failure.limit},
                       {"grain", failure.grain},
                       {"step", failure.step}});
      return StageOutcome::failed;
    }
  }

 private:
  StageOutcome advance(Simulation& simulation) {
    const std::uint64_t chunk = chunk_steps(simulation.grains());
    for (;;) {
      const StageProgress progress = protocol_->advance(simulation, chunk);
      if (progress.checkpoint_due) record(simulation, progress.cycle);
      if (progress.finished) {
        store_.complete_run(run_.id);
        return StageOutcome::completed;
      }
      if (stop_requested()) {
        if (!progress.checkpoint_due) record(simulation, progress.cycle);
        store_.interrupt_run(run_.id, "stopped by a signal");
        return StageOutcome::interrupted;
      }
      report(simulation, progress.cycle);
    }
  }

  // Throws NumericalFailure rather than keep a state that went wrong.
  void record(const Simulation& simulation, double cycle) {
    simulation.check();
    Checkpoint checkpoint;
    checkpoint.run = run_.id;
    checkpoint.cell = simulation.cell();
    checkpoint.state = simulation.state();
    checkpoint.cycle = cycle;
    checkpoint.time_s = static_cast<double>(simulation.step()) * scene_.time_step;
    checkpoint.theta = tilt(protocol_->drive(), simulation.step()).theta;
    checkpoint.units = units(stage_.parameters);
    const WallPose pose =
        wall_pose(checkpoint.cell, checkpoint.theta, checkpoint.state.wall_height);
    const Diagnostics facts = diagnose(checkpoint.cell, scene_, checkpoint.state, pose);
    checkpoint.observables = {{"kinetic_energy_per_grain_m_d2_per_s2", facts.kinetic_energy},
                              {"mean_overlap_d", facts.mean_overlap},
                              {"largest_overlap_d", facts.largest_overlap},
                              {"contacts_per_grain", facts.contacts_per_grain},
                              {"wall_force_imbalance", facts.wall_imbalance},
                              {"cell_height_d", pose.top - pose.bottom}};
    const auto steps = static_cast<double>(simulation.step() - recorded_step_);
    store_.record_checkpoint(
        run_.id, checkpoint,
        {seconds_since(recorded_at_), steps * static_cast<double>(simulation.grains())});
    recorded_at_ = Clock::now();
    recorded_step_ = simulation.step();
  }

  void report(const Simulation& simulation, double cycle) {
    const double since = seconds_since(reported_at_);
    if (!options_.report || since < 0.2) return;
    StageStatus status;
    status.cycle = cycle;
    status.target_cycles =
        stage_.stage == Stage::shear ? static_cast<double>(run_.target_cycles) : 0;
    status.steps_per_second = static_cast<double>(simulation.step() - reported_step_) / since;
    status.grains = simulation.grains();
    status.step = simulation.step();
    const std::uint64_t end = protocol_->expected_steps();
    const double mean_rate =
        static_cast<double>(simulation.step() - first_step_) / seconds_since(started_at_);
    status.seconds_left = end == 0 ? -1 : static_cast<double>(end - simulation.step()) / mean_rate;
    options_.report(status);
    reported_at_ = Clock::now();
    reported_step_ = simulation.step();
  }

  Store& store_;
  RunRecord run_;
  const StageOptions& options_;
  StageRecord stage_;
  Scene scene_;
  std::unique_ptr<Protocol> protocol_;
  std::uint64_t first_step_ = 0, recorded_step_ = 0, reported_step_ = 0;
  Clock::time_point started_at_ = Clock::now(), recorded_at_ = started_at_,
                    reported_at_ = started_at_;
};

}  // namespace

StageOutcome run_stage(Store& store, const std::string& id, const StageOptions& options) {
  RunRecord run = store.run(id);
  if (stage_key(run.resolved) != id) {
    throw StoreDamaged("run " + id.substr(0, 12) +
                       ": its recorded parameters are not those that it is named after");
  }
  return Attempt(store, std::move(run), options).run();
}

bool stage_done(const Store& store, const RunRecord& run) {
  if (run.state != RunState::completed) return false;
  const auto recorded = store.checkpoints(run.id);
  if (recorded.empty()) return false;
  try {
    store.load_checkpoint(recorded.back());
    return true;
  } catch (const StoreDamaged&) {
    return false;  // run_stage says what is wrong with it
  }
}

}  // namespace shearcell
