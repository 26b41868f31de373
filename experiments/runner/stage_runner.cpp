// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/stage_runner.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "experiments/runner/engine.hpp"
#include "experiments/runner/host.hpp"
#include "experiments/runner/look.hpp"
#include "experiments/runner/stop.hpp"
#include "provenance/errors.hpp"
#include "provenance/io/child_process.hpp"
#include "provenance/io/clock.hpp"

namespace shearcell {
namespace {

// One attempt to compute a stage.
class StageAttempt {
 public:
  StageAttempt(Store& store, Stage run, const StageOptions& options)
      : store_(store), options_(options), plan_(ready_stage(store, std::move(run))) {}

  StageOutcome run() {
    std::vector<std::string> damage;
    Beginning beginning = continue_stage(store_, plan_, &damage);
    for (const std::string& what : damage) {
      if (options_.damaged) options_.damaged(what);
    }
    const bool fresh = !beginning.from;
    nlohmann::json facts = host_facts();
    std::optional<LammpsProgram> lammps;
    if (plan_.stage.parameters.engine == EngineKind::lammps) {
      lammps = find_lammps(options_.parallel.ranks);
      facts["engine"] = {{"name", "LAMMPS"},
                         {"version", lammps->version},
                         {"program", lammps->path},
                         {"processes", options_.parallel.ranks}};
    }
    start(beginning, facts);
    if (options_.begun) options_.begun();
    return guarded([&] {
      seen_ = seen_checkpoints(store_, id());
      if (ends_early()) return StageOutcome::completed;
      const auto engine = make_engine(plan_, std::move(beginning), options_.parallel, lammps);
      first_step_ = engine->step();
      // The settled packing is cycle 0 of what follows.
      if (fresh && plan_.stage.stage != StageKind::prepare) record(*engine, 0);
      if (ends_early()) return StageOutcome::completed;
      return advance(*engine);
    });
  }

  // Records the checkpoints at these steps of a completed run, which lacks them.
  StageOutcome fill(const std::vector<std::uint64_t>& steps) {
    Beginning beginning = continue_stage(store_, plan_, nullptr, steps.front());
    const bool fresh = !beginning.from;
    const nlohmann::json& ends = plan_.run.ends;
    nlohmann::json ended = ends.empty() ? nlohmann::json() : ends.back();
    if (ended.is_null()) ended = {{"by", "cycles"}};
    // The stage is completed for all that were declared since.
    if (ended.contains("memberships")) ended["memberships"] = plan_.run.asks.size();
    start(beginning, host_facts(), true);
    return guarded([&] {
      const auto engine = make_engine(plan_, std::move(beginning), options_.parallel);
      first_step_ = engine->step();
      auto next = steps.begin();
      if (fresh && *next == 0) {
        record(*engine, 0);
        ++next;
      }
      while (next != steps.end()) {
        const StageProgress progress = engine->advance();
        if (progress.checkpoint_due && engine->step() == *next) {
          record(*engine, progress.cycle);
          ++next;
        }
        if (stop_requested()) return interrupted();
        if (!store_.holds(id())) return StageOutcome::lost;
        report(*engine, progress.cycle);
      }
      complete(ended);
      return StageOutcome::completed;
    });
  }

  /// Whether a checkpoint was recorded.
  bool computed() const { return computed_; }

 private:
  StageOutcome guarded(const std::function<StageOutcome()>& compute) {
    try {
      return compute();
    } catch (const Interrupted&) {
      return interrupted();
    } catch (const ProgramError& error) {
      store_.fail_stage(id(), error.what(), nlohmann::json::object());
      return StageOutcome::failed;
    } catch (const NumericalFailure& failure) {
      store_.fail_stage(id(), failure.what(),
                        {{"quantity", failure.quantity},
                         {"value", failure.value},
                         {"limit", failure.limit},
                         {"grain", failure.grain},
                         {"step", failure.step}});
      return StageOutcome::failed;
    } catch (const std::exception& failure) {
      release(failure);  // the disk, the memory or the store
      throw;
    }
  }

  void start(const Beginning& beginning, const nlohmann::json& facts, bool filling = false) {
    const auto from = beginning.from ? std::optional(beginning.from->sha256) : std::nullopt;
    try {
      store_.start_stage(id(), facts, from, beginning.parent_checkpoint, filling);
    } catch (const ConcurrencyConflict&) {
      throw;
    } catch (const std::exception& failure) {
      release(failure);  // a failed sync of the folder may leave the start recorded
      throw;
    }
  }

  // Lets other programs continue the run.
  void release(const std::exception& failure) {
    try {
      store_.interrupt_stage(id(), failure.what());
    } catch (const std::exception&) {  // for the same reason; then the run's lease expires
    }
  }

  StageOutcome advance(Engine& engine) {
    for (;;) {
      StageProgress progress = engine.advance();
      const bool stop = !progress.finished && stop_requested();
      if (stop && !progress.checkpoint_due) progress = engine.halt();
      if (progress.checkpoint_due) record(engine, progress.cycle);
      if (progress.finished) {
        complete({{"by", plan_.stage.stage == StageKind::prepare ? "settled" : "cycles"}});
        return StageOutcome::completed;
      }
      // `until` is checked at whole cycles only.
      const bool whole = progress.cycle == std::floor(progress.cycle);
      if (progress.checkpoint_due && whole && ends_early()) return StageOutcome::completed;
      if (stop) return interrupted();
      if (!store_.holds(id())) return StageOutcome::lost;
      report(engine, progress.cycle);
    }
  }

  StageOutcome interrupted() {
    store_.interrupt_stage(id(), "stopped by a signal");
    return StageOutcome::interrupted;
  }

  // Completes the stage when what is recorded is all that the experiments ask for, those included
  // that declared it meanwhile.
  bool ends_early() {
    const Stage now = store_.stage(id());
    if (seen_.empty() || std::ranges::none_of(now.asks, has_until)) return false;
    const nlohmann::json ended = decide(store_, now, now.asks, seen_, {}).ended;
    recorded_.restart();  // measuring is not computing
    if (!ended.is_null()) complete(ended);
    return !ended.is_null();
  }

  void complete(const nlohmann::json& ended) {
    store_.complete_stage(id(), {{"ended", ended}}, plan_.run.target_cycles);
  }

  const std::string& id() const { return plan_.run.id; }

  void record(const Engine& engine, double cycle) {
    const Checkpoint checkpoint = engine.checkpoint(cycle);
    const auto steps = static_cast<double>(engine.evaluations() - recorded_evaluations_);
    const CheckpointRecord recorded = store_.record_checkpoint(
        id(), checkpoint, {recorded_.seconds(), steps * static_cast<double>(plan_.run.grains)});
    computed_ = true;
    seen_.push_back({recorded});
    recorded_.restart();
    recorded_evaluations_ = engine.evaluations();
  }

  void report(const Engine& engine, double cycle) {
    const double since = reported_.seconds();
    if (!options_.report || since < 0.2) return;
    StageStatus status;
    status.cycle = cycle;
    status.target_cycles =
        plan_.stage.stage != StageKind::prepare ? static_cast<double>(plan_.run.target_cycles) : 0;
    status.steps_per_second =
        static_cast<double>(engine.evaluations() - reported_evaluations_) / since;
    status.grains = plan_.run.grains;
    status.step = engine.step();
    const std::uint64_t end = plan_.protocol->last_step();
    const double mean_rate = static_cast<double>(engine.step() - first_step_) / started_.seconds();
    status.seconds_left =
        end == 0 || !(mean_rate > 0) ? -1 : static_cast<double>(end - engine.step()) / mean_rate;
    options_.report(status);
    reported_.restart();
    reported_evaluations_ = engine.evaluations();
  }

  Store& store_;
  const StageOptions& options_;
  ReadyStage plan_;
  std::vector<SeenCheckpoint> seen_;
  bool computed_ = false;
  std::uint64_t first_step_ = 0, recorded_evaluations_ = 0, reported_evaluations_ = 0;
  Stopwatch started_, recorded_, reported_;
};

// If it is not, run_stage reports what is wrong with it.
bool newest_is_sound(const Store& store, const Stage& run) {
  const auto recorded = store.checkpoints(run.id);
  return !recorded.empty() && store.load_if_readable(recorded.back());
}

}  // namespace

StageOutcome run_stage(Store& store, const std::string& id, const StageOptions& options) {
  try {
    Stage run = store.stage(id);
    bool computed = false;
    if (run.state != StageState::completed || !newest_is_sound(store, run)) {
      StageAttempt attempt(store, std::move(run), options);
      const StageOutcome outcome = attempt.run();
      run = store.stage(id);
      if (outcome != StageOutcome::completed || run.state != StageState::completed) return outcome;
      computed = attempt.computed();
    }
    // A denser cadence may have been asked for.
    const std::vector<std::uint64_t> missing =
        outlook(run, run.asks, seen_checkpoints(store, id)).missing;
    if (!missing.empty()) return StageAttempt(store, std::move(run), options).fill(missing);
    return computed ? StageOutcome::completed : StageOutcome::already;
  } catch (const RunHeld&) {
    return StageOutcome::held;
  } catch (const Interrupted&) {
    return StageOutcome::interrupted;  // before an attempt was recorded
  } catch (const ConcurrencyConflict&) {
    return StageOutcome::lost;
  }
}

bool is_done(const Store& store, const Stage& stage) {
  return outlook(stage, stage.asks, seen_checkpoints(store, stage.id)).done &&
         newest_is_sound(store, stage);
}

}  // namespace shearcell
