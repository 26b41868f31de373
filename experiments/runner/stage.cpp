// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/stage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <memory>
#include <utility>

#include "core/bits_version.hpp"
#include "core/diagnostics.hpp"
#include "core/drive.hpp"
#include "core/filling.hpp"
#include "core/machine.hpp"
#include "core/simulation.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/manifest/start.hpp"
#include "experiments/runner/host.hpp"
#include "experiments/runner/lammps/lammps_run.hpp"
#include "experiments/runner/outlook.hpp"
#include "experiments/runner/stop.hpp"
#include "protocols/cyclic_shear.hpp"
#include "protocols/settle.hpp"
#include "protocols/stiffen.hpp"
#include "provenance/errors.hpp"
#include "provenance/io/child_process.hpp"
#include "provenance/io/clock.hpp"
#include "provenance/json_text.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

// --- Building a stage from its record ---

Scene make_scene(const StageInputs& inputs) {
  if (inputs.stage == StageKind::shear) return shear_scene(inputs.parameters);
  Scene scene = settle_scene(inputs.parameters);
  if (inputs.stage == StageKind::stiffen) scene.time_step = 0;  // no time passes in a stiffening
  return scene;
}

void require_memory(const StageInputs& inputs) {
  const double needed = run_bytes(geometry(inputs.parameters));
  if (needed <= machine_memory()) return;
  throw TooLittleMemory(fmt::format(
      "{} grains need about {:.3g} GB, and this machine has {:.3g} GB; use fewer grains",
      inputs.parameters.grains, needed / 1e9, machine_memory() / 1e9));
}

Protocol make_protocol(const StageInputs& inputs, const Stage& stage, const Scene& scene) {
  const Parameters& p = inputs.parameters;
  const std::uint64_t cycles = stage.target_cycles;
  if (inputs.file && !inputs.file->settles) {
    return cyclic_shear({}, 0, {});  // no cycles: the grains keep their positions
  }
  if (inputs.stage == StageKind::prepare) {
    const SettleParameters settle{p.settle_force_tolerance, p.settle_kinetic_tolerance,
                                  p.settle_time_limit_s, p.max_overlap_diameters};
    return {.advance = std::bind_front(&Settle::advance, Settle(settle, scene))};
  }
  if (inputs.stage == StageKind::stiffen) {
    StiffenParameters parameters{p.stiffness_steps_per_decade, cycles, {}};
    parameters.minimize.force_tolerance = p.minimize_force_tolerance;
    return stiffen(parameters, scene);
  }
  return cyclic_shear(drive(p), cycles, cadences_of(stage, asks_of(stage.memberships), drive(p)));
}

// The watchdog's overlap limit [d]: the largest limit in the manifests that use the stage.
// `otherwise`: the limit for a manifest that sets none. The limit is not part of the run's id.
double overlap_limit(const Store& store, const Stage& stage, double otherwise) {
  double limit = stage.memberships.empty() ? otherwise : 0;
  for (const Membership& m : stage.memberships) {
    const auto manifest = find_manifest(store, m.place.manifest);
    const nlohmann::json limits =
        member_of(manifest ? manifest->info : nlohmann::json(), "max_overlap_diameters");
    const nlohmann::json stated = member_of(limits, m.place.scale.c_str());
    if (!stated.is_null() && !stated.is_number()) {
      throw StoreDamaged(fmt::format(
          "manifest {:.12}: its recorded overlap limit is not a number; `shearcell verify` reports "
          "all damage",
          m.place.manifest));
    }
    limit = std::max(limit, stated.is_number() ? stated.get<double>() : otherwise);
  }
  return limit;
}

struct ReadyStage {
  Stage stage;
  StageInputs inputs;
  Scene scene;
  Protocol protocol;
};

ReadyStage ready_stage(const Store& store, Stage stage) {
  if (stage_key(stage.resolved) != stage.id) {
    throw StoreDamaged("run " + stage.id.substr(0, 12) +
                       ": the id is not the hash of the recorded parameters");
  }
  StageInputs inputs = read_stage(stage.resolved);
  double& limit = inputs.parameters.max_overlap_diameters;
  limit = overlap_limit(store, stage, limit);
  require_memory(inputs);
  const Scene scene = make_scene(inputs);
  Protocol protocol = make_protocol(inputs, stage, scene);
  return {std::move(stage), std::move(inputs), scene, std::move(protocol)};
}

/// The state from which an attempt starts to compute a stage.
struct Beginning {
  Cell cell;
  State state;
  /// The checkpoint with this state, recorded by the stage or its parent. Empty for new grains.
  std::optional<CheckpointRecord> record = {};

  const CheckpointRecord* from(const std::string& stage) const {
    return record && record->run == stage ? &*record : nullptr;
  }
};

/// Recomputes the file of a checkpoint if it was pruned. Throws FilePruned if the options do not
/// permit this, or if this program cannot reproduce the bits.
void restore_if_pruned(Store& store, const CheckpointRecord& record, const StageOptions& options);

/// The state that starting_state() gives, with noise added to the positions.
Beginning beginning_after_parent(Store& store, const ReadyStage& plan,
                                 const StageOptions& options) {
  const Parameters& p = plan.inputs.parameters;
  const auto record = starting_state(store, plan.stage, p);
  const std::string what =
      fmt::format("run {:.12}: the state from which run {:.12} starts (cycle {})",
                  plan.stage.parent, plan.stage.id, p.start_cycle);
  if (!record) {
    throw NotFound(what +
                   " was never recorded. If the parent is a packing, settle it with "
                   "`shearcell resume`. If it is a sheared run, start from a recorded cycle, or "
                   "request more checkpoints");
  }
  restore_if_pruned(store, *record, options);
  auto checkpoint = store.load_if_readable(*record);
  if (!checkpoint) {
    throw StoreDamaged(fmt::format("{} is damaged; `shearcell regenerate {:.12}` restores its file",
                                   what, record->sha256));
  }
  checkpoint->state.step = 0;
  add_noise(checkpoint->state, p.start_noise_d, plan.inputs.seed);
  return {std::move(checkpoint->cell), std::move(checkpoint->state), *record};
}

/// The stage's newest valid checkpoint before `before_step`, or the initial state of the stage if
/// there is no such checkpoint. Throws Interrupted if a stop is requested while a cell is filled.
/// `damage`: as for Store::newest_valid_checkpoint().
Beginning beginning_of(Store& store, const ReadyStage& plan, const StageOptions& options,
                       std::vector<std::string>* damage, std::uint64_t before_step = UINT64_MAX) {
  const StageInputs& inputs = plan.inputs;
  if (auto newest = store.newest_valid_checkpoint(plan.stage.id, damage, before_step)) {
    return {std::move(newest->checkpoint.cell), std::move(newest->checkpoint.state),
            std::move(newest->record)};
  }
  if (inputs.file) {
    auto [text, path] = store.packing_text(inputs.file->sha256);
    PlacedGrains grains =
        placed({path, text, *inputs.file}, inputs.parameters, inputs.seed, give_up_if_requested);
    return {std::move(grains.cell), std::move(grains.state)};
  }
  if (!plan.stage.parent.empty()) return beginning_after_parent(store, plan, options);
  const Geometry shape = geometry(inputs.parameters);
  Cell cell = make_cell(shape, inputs.seed, give_up_if_requested);
  State state = fill_cell(cell, shape, inputs.seed, give_up_if_requested);
  return {std::move(cell), std::move(state)};
}

Simulation make_simulation(const ReadyStage& plan, Beginning&& beginning, std::size_t threads) {
  SimulationSettings settings;
  settings.threads = threads;
  settings.limits.overlap = plan.inputs.parameters.max_overlap_diameters;
  return Simulation(std::move(beginning.cell), plan.scene, beginning.state, settings);
}

/// Makes a checkpoint of `state`. `scene`: the scene with the present stiffness (see stiffen()).
Checkpoint make_checkpoint(const ReadyStage& plan, const Cell& cell, const Scene& scene,
                           const State& state, double cycle) {
  Checkpoint checkpoint;
  checkpoint.run = plan.stage.id;
  checkpoint.cell = cell;
  checkpoint.state = state;
  checkpoint.cycle = cycle;
  checkpoint.time_s = static_cast<double>(state.step) * plan.scene.time_step;
  checkpoint.theta = tilt(plan.protocol.drive, state.step).theta;
  checkpoint.units = units(plan.inputs.parameters);
  const WallPose pose = pose_of(checkpoint);
  const Diagnostics facts = diagnose(cell, scene, state, pose);
  checkpoint.observables = {{"kinetic_energy_per_grain_m_d2_per_s2", facts.kinetic_energy},
                            {"mean_overlap_d", facts.mean_overlap},
                            {"largest_overlap_d", facts.largest_overlap},
                            {"contacts_per_grain", facts.contacts_per_grain},
                            {"wall_force_imbalance", facts.wall_imbalance},
                            {"cell_height_d", pose.top - pose.bottom}};
  if (plan.inputs.stage == StageKind::stiffen) {
    const Parameters& p = plan.inputs.parameters;
    const double raised = scene.stiffness / plan.scene.stiffness;
    checkpoint.observables["stiffness_N_per_m"] = raised * p.stiffness_N_per_m;
    checkpoint.observables["force_residual_P_d2"] = force_residual(cell, scene, state);
  }
  return checkpoint;
}

// --- Engines: our own simulation in this process, or LAMMPS in another process ---

/// Steps between two checks for signals and leases: about 50 ms at 50 million particle-steps/s.
std::uint64_t chunk_steps(std::size_t grains) {
  return std::max<std::uint64_t>(1, 2'500'000 / std::max<std::size_t>(1, grains));
}

class Engine {
 public:
  virtual ~Engine() = default;

  /// Computes for about 50 ms and returns the progress of the stage. Throws NumericalFailure, or
  /// ProgramError if LAMMPS failed.
  virtual StageProgress advance() = 0;

  /// Stops before the end of the stage. Sets `checkpoint_due`, so that the caller records the last
  /// state. If LAMMPS does not answer, `checkpoint_due` is false, and the steps since the last
  /// checkpoint are lost.
  virtual StageProgress halt() = 0;

  /// A checkpoint of the newest state (LAMMPS: of its last frame). Throws NumericalFailure.
  virtual Checkpoint checkpoint(double cycle) const = 0;

  virtual std::uint64_t step() const = 0;
  virtual std::uint64_t evaluations() const = 0;  ///< force evaluations since construction
  /// Processor time [s] of all steps since construction; empty if unknown.
  virtual std::optional<double> core_seconds() const = 0;
};

class OwnEngine final : public Engine {
 public:
  OwnEngine(const ReadyStage& plan, Beginning&& beginning, std::size_t threads)
      : plan_(plan),
        threads_(static_cast<double>(threads)),
        simulation_(make_simulation(plan, std::move(beginning), threads)) {}

  StageProgress advance() override { return advance_by(UINT64_MAX); }
  StageProgress advance_by(std::uint64_t most) {
    const std::uint64_t steps = std::min(most, chunk_steps(simulation_.grains()));
    const double before = thread_seconds();
    progress_ = plan_.protocol.advance(simulation_, steps);
    core_seconds_ += threads_ * (thread_seconds() - before);  // assumes equally busy threads
    return progress_;
  }
  StageProgress halt() override {
    progress_.checkpoint_due = true;
    return progress_;
  }
  Checkpoint checkpoint(double cycle) const override {
    simulation_.check_recordable();
    return make_checkpoint(plan_, simulation_.cell(), simulation_.scene(), simulation_.state(),
                           cycle);
  }
  std::uint64_t step() const override { return simulation_.step(); }
  std::uint64_t evaluations() const override { return simulation_.evaluations(); }
  std::optional<double> core_seconds() const override { return core_seconds_; }

 private:
  const ReadyStage& plan_;
  double threads_;
  double core_seconds_ = 0;
  Simulation simulation_;
  StageProgress progress_;
};

/// Advances to `step`, or to the end of the stage if the end comes first. About every 50 ms, calls
/// the function `between` with the progress.
StageProgress advance_to(OwnEngine& engine, std::uint64_t step, const auto& between) {
  StageProgress progress;  // stays at cycle 0 if `step` is 0
  while (engine.step() < step && !progress.finished) {
    progress = engine.advance_by(step - engine.step());
    if (engine.step() < step) between(progress);
  }
  return progress;
}

// Longest time to wait until LAMMPS has written a frame. LAMMPS checks for a stop request about
// every half second. Batch systems kill a job half a minute after their first signal.
constexpr std::chrono::seconds kPatience{10};

class LammpsEngine final : public Engine {
 public:
  LammpsEngine(const ReadyStage& plan, Beginning&& beginning, const Parallel& parallel,
               const LammpsProgram& program)
      : plan_(plan),
        stride_(checkpoint_cadence(asks_of(plan.stage.memberships)) *
                cycle_steps(plan.protocol.drive)),
        cell_(std::move(beginning.cell)),
        state_(std::move(beginning.state)),
        first_(state_.step),
        step_(first_) {
    const std::uint64_t end = plan.protocol.last_step;
    if (first_ >= end) return;
    const LammpsTask task{.cell = cell_,
                          .scene = plan.scene,
                          .drive = plan.protocol.drive,
                          .state = state_,
                          .end = end,
                          .stride = stride_,
                          .check_every = lammps_check_steps(plan.stage.grains, parallel.ranks)};
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
  std::optional<double> core_seconds() const override {
    return run_ ? run_->core_seconds() : std::optional(0.0);
  }

 private:
  // Stores the frame in state_. Computes one step with our engine for the watchdog's checks.
  bool take(std::optional<State> frame) {
    if (!frame) return false;
    state_ = std::move(*frame);
    Simulation watched = make_simulation(plan_, {cell_, state_}, 1);
    watched.advance(plan_.protocol.drive, 1);
    watched.check();
    step_ = state_.step;
    return true;
  }

  StageProgress progress(bool at_frame) const {
    StageProgress progress;
    const auto per_cycle = static_cast<double>(cycle_steps(plan_.protocol.drive));
    progress.cycle = static_cast<double>(step_) / per_cycle;
    progress.finished = state_.step >= plan_.protocol.last_step;
    progress.checkpoint_due = progress.finished || (at_frame && step_ % stride_ == 0);
    return progress;
  }

  const ReadyStage& plan_;
  std::uint64_t stride_;
  Cell cell_;
  State state_;  ///< initial state, later the state of the last frame from LAMMPS
  std::uint64_t first_;
  std::uint64_t step_;  ///< where LAMMPS is
  std::optional<LammpsRun> run_;
};

class StageAttempt {
 public:
  StageAttempt(Store& store, Stage stage, const StageOptions& options)
      : store_(store), options_(options), plan_(ready_stage(store, std::move(stage))) {}

  StageOutcome run() {
    std::vector<std::string> damage;
    const std::vector<CheckpointRecord> known = store_.checkpoints(id(), Listed::and_pruned);
    if (!known.empty()) restore_if_pruned(store_, known.back(), options_);
    Beginning beginning = beginning_of(store_, plan_, options_, &damage);
    for (const std::string& what : damage) {
      if (options_.damaged) options_.damaged(what);
    }
    const bool fresh = beginning.from(id()) == nullptr;
    nlohmann::json facts = host_facts();
    std::optional<LammpsProgram> lammps;
    if (plan_.inputs.parameters.engine == EngineKind::lammps) {
      lammps = find_lammps(options_.parallel.ranks);
      facts["engine"] = {{"name", "LAMMPS"},
                         {"version", lammps->version},
                         {"program", lammps->path},
                         {"processes", options_.parallel.ranks}};
    }
    return attempt(beginning, facts, false, [&] {
      seen_ = store_.checkpoints(id(), Listed::and_pruned);
      if (ends_early()) return StageOutcome::completed;
      std::unique_ptr<Engine> engine;
      if (lammps) {
        engine =
            std::make_unique<LammpsEngine>(plan_, std::move(beginning), options_.parallel, *lammps);
      } else {
        engine =
            std::make_unique<OwnEngine>(plan_, std::move(beginning), options_.parallel.threads);
      }
      first_step_ = engine->step();
      if (fresh && plan_.inputs.stage != StageKind::prepare) record(*engine, 0);
      if (ends_early()) return StageOutcome::completed;
      return advance(*engine);
    });
  }

  // Records the missing checkpoints of a completed run. `steps`: steps of these checkpoints.
  StageOutcome fill(const std::vector<std::uint64_t>& steps) {
    Beginning beginning = beginning_of(store_, plan_, options_, nullptr, steps.front());
    const nlohmann::json& ends = plan_.stage.ends;
    nlohmann::json ended = ends.empty() ? nlohmann::json() : ends.back();
    if (ended.is_null()) ended = {{"by", "cycles"}};
    // The end is recorded again, with the number of experiments that use the stage now. Some may
    // have been declared after the stage ended.
    if (ended.contains("memberships")) ended["memberships"] = plan_.stage.memberships.size();
    return attempt(beginning, host_facts(), true, [&] {
      OwnEngine engine(plan_, std::move(beginning), options_.parallel.threads);
      first_step_ = engine.step();
      for (const std::uint64_t step : steps) {
        const auto pause = [&](const StageProgress& progress) {
          give_up_if_requested();
          report(engine, progress.cycle);
        };
        const StageProgress there = advance_to(engine, step, pause);
        record(engine, there.cycle);
        pause(there);
      }
      complete(ended);
      return StageOutcome::completed;
    });
  }

  bool computed() const { return computed_; }

 private:
  // Records the start of an attempt and calls compute(). After an exception, records the end, too.
  StageOutcome attempt(const Beginning& beginning, const nlohmann::json& facts, bool filling,
                       const std::function<StageOutcome()>& compute) {
    const std::optional<CheckpointRecord> first = beginning.record;
    const CheckpointRecord* const own_first = beginning.from(id());
    bool started = false;
    try {
      store_.start_stage(id(), facts,
                         own_first != nullptr ? std::optional(own_first->sha256) : std::nullopt,
                         first && own_first == nullptr ? first->sha256 : "", filling);
      started = true;
      if (options_.begun) options_.begun();
      RunLineages known;
      const bool own = plan_.inputs.parameters.engine == EngineKind::shearcell;
      const auto other = own && first ? why_not_again(store_, *first, known) : std::nullopt;
      if (other && options_.continuing)
        options_.continuing("the starting state cannot be repeated bit for bit: " + *other);
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
      // The disk, memory or store failed, or another process computes the stage. start_stage() may
      // have recorded the start of the attempt before it threw, except if it found a conflict.
      if (started || dynamic_cast<const ConcurrencyConflict*>(&failure) == nullptr)
        release(failure);
      throw;
    }
  }

  // Records the end of the attempt, so that another process can continue the run.
  void release(const std::exception& failure) {
    try {
      store_.interrupt_stage(id(), failure.what());
    } catch (const std::exception&) {
      // The end of the attempt could not be recorded. Another process can continue the run when
      // this process's lease has expired.
    }
  }

  StageOutcome advance(Engine& engine) {
    for (;;) {
      StageProgress progress = engine.advance();
      const bool stop = !progress.finished && stop_requested();
      if (stop && !progress.checkpoint_due) progress = engine.halt();
      if (progress.checkpoint_due) record(engine, progress.cycle);
      if (progress.finished) {
        complete({{"by", plan_.inputs.stage == StageKind::prepare ? "settled" : "cycles"}});
        return StageOutcome::completed;
      }
      const bool whole = progress.cycle == std::floor(progress.cycle);
      if (progress.checkpoint_due && whole && ends_early()) return StageOutcome::completed;
      if (stop) return interrupted();
      report(engine, progress.cycle);
    }
  }

  StageOutcome interrupted() {
    store_.interrupt_stage(id(), "stopped by a signal");
    return StageOutcome::interrupted;
  }

  // If an `until` ends the stage now (Outlook::ended), records that the stage is completed and
  // returns true. Considers all experiments that use the stage, also those declared during the
  // computation.
  bool ends_early() {
    const Stage now = store_.stage(id());
    const std::vector<Ask> asks = asks_of(now.memberships);
    const auto lacks_until = [](const Ask& ask) { return ask.until.is_null(); };
    if (seen_.empty() || std::ranges::all_of(asks, lacks_until)) return false;
    const nlohmann::json ended = measured_outlook(store_, now, asks, seen_, measures_, {}).ended;
    recorded_.restart();  // the recorded effort excludes the time for measures
    if (!ended.is_null()) complete(ended);
    return !ended.is_null();
  }

  void complete(const nlohmann::json& ended) {
    store_.complete_stage(id(), {{"ended", ended}}, plan_.stage.target_cycles);
  }

  const std::string& id() const { return plan_.stage.id; }

  void record(const Engine& engine, double cycle) {
    const Checkpoint checkpoint = engine.checkpoint(cycle);
    const auto steps = static_cast<double>(engine.evaluations() - recorded_evaluations_);
    Effort effort{recorded_.seconds(), steps * static_cast<double>(plan_.stage.grains)};
    const std::optional<double> core_seconds = engine.core_seconds();
    if (core_seconds) effort.core_seconds = *core_seconds - recorded_core_seconds_;
    const CheckpointRecord recorded = store_.record_checkpoint(id(), checkpoint, effort);
    recorded_core_seconds_ = core_seconds.value_or(0);
    computed_ = true;
    seen_.push_back(recorded);
    recorded_.restart();
    recorded_evaluations_ = engine.evaluations();
  }

  // Throws ConcurrencyConflict if another process now computes the stage.
  void report(const Engine& engine, double cycle) {
    if (!store_.holds(id())) throw ConcurrencyConflict("another process now computes the stage");
    const double since = reported_.seconds();
    if (!options_.report || since < 0.2) return;
    const auto steps = static_cast<double>(engine.evaluations() - reported_evaluations_);
    const double rate = 1e-6 * steps * static_cast<double>(plan_.stage.grains) / since;
    const std::uint64_t target = plan_.stage.target_cycles, end = plan_.protocol.last_step;
    const std::string where = target > 0 ? fmt::format("cycle {:.2f} of {}", cycle, target)
                                         : fmt::format("step {}", engine.step());
    const double mean_rate = static_cast<double>(engine.step() - first_step_) / started_.seconds();
    const bool known = end > 0 && mean_rate > 0;
    const double left = static_cast<double>(end - engine.step()) / mean_rate;
    options_.report(fmt::format("{:<18} {:6.1f} M particle-steps/s  {}", where, rate,
                                known ? format_duration(left) + " left" : ""));
    reported_.restart();
    reported_evaluations_ = engine.evaluations();
  }

  Store& store_;
  const StageOptions& options_;
  ReadyStage plan_;
  std::vector<CheckpointRecord> seen_;
  KnownMeasures measures_;
  bool computed_ = false;
  std::uint64_t first_step_ = 0, recorded_evaluations_ = 0, reported_evaluations_ = 0;
  double recorded_core_seconds_ = 0;
  Stopwatch started_, recorded_, reported_;
};

// True if the newest checkpoint can be read or was pruned; false if it is damaged or missing.
bool newest_is_sound(const Store& store, const Stage& stage) {
  const auto found = store.checkpoints(stage.id, Listed::and_pruned);
  return !found.empty() &&
         (found.back().state == CheckpointState::pruned || store.load_if_readable(found.back()));
}

// --- Recomputing a recorded state ---

std::uint64_t ulp_distance(double a, double b) {
  // A larger double gives a larger integer. The integers of adjacent doubles differ by 1.
  const auto ordered = [](double x) {
    const auto bits = std::bit_cast<std::uint64_t>(x), sign = std::uint64_t{1} << 63;
    return bits < sign ? bits + sign : ~bits;
  };
  const std::uint64_t x = ordered(a), y = ordered(b);
  return x > y ? x - y : y - x;
}

void compare(const char* field, double a, double b, Divergence& worst, Eigen::Index grain = -1) {
  const std::uint64_t ulp = ulp_distance(a, b);
  if (ulp <= worst.ulp) return;
  worst.field = field;
  worst.grain = grain;
  worst.ulp = ulp;
}

void compare(const char* field, const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b,
             Divergence& worst) {
  if (a.cols() != b.cols()) return;
  for (Eigen::Index i = 0; i < a.cols(); ++i) {
    for (Eigen::Index k = 0; k < 3; ++k) compare(field, a(k, i), b(k, i), worst, i);
  }
}

void diverge(Replay& replay, std::uint64_t step, const std::string& message,
             const std::string& field = "") {
  const std::uint64_t first = replay.from ? replay.from->step : 0;
  replay.divergence = Divergence{first, step, field, -1, 0, message};
}

/// Recomputes the state at the step of replay.record; empty if the replay does not reach it.
std::optional<Checkpoint> compute_again(Store& store, Replay& replay, const StageOptions& options) {
  const CheckpointRecord& record = replay.record;
  const ReadyStage plan = ready_stage(store, store.stage(record.run));
  try {
    Beginning beginning = beginning_of(store, plan, options, nullptr, record.step);
    if (const auto* from = beginning.from(record.run)) replay.from = *from;
    OwnEngine engine(plan, std::move(beginning), options.parallel.threads);
    const std::uint64_t first = engine.step();
    const StageProgress progress = advance_to(engine, record.step, [&](const StageProgress&) {
      replay.steps = engine.step() - first;
      give_up_if_requested();
      if (!options.report) return;
      options.report(fmt::format("restoring step {} of {}", engine.step(), record.step));
    });
    replay.steps = engine.step() - first;
    if (engine.step() == record.step) return engine.checkpoint(progress.cycle);
    diverge(replay, engine.step(),
            fmt::format("the stage already ended at step {}", engine.step()));
  } catch (const Interrupted&) {
    replay.interrupted = true;
  } catch (const NumericalFailure& failure) {
    diverge(replay, failure.step, failure.what());
  }
  return std::nullopt;
}

/// Compares `found` with the recorded state. If the states are equal, also compares the cycle, the
/// time, the tilt and the observables.
void compare_again(const Store& store, const Checkpoint& found, Replay& replay) {
  const CheckpointRecord& record = replay.record;
  const std::string hash = state_hash(found);
  if (hash != record.state_hash) {
    diverge(replay, record.step,
            fmt::format("the state hash is {:.12} instead of {:.12}", hash, record.state_hash));
    if (const auto recorded = store.load_if_readable(record)) {
      const State &a = recorded->state, &b = found.state;
      Divergence& worst = *replay.divergence;
      compare("position", a.position, b.position, worst);
      compare("velocity", a.velocity, b.velocity, worst);
      compare("wall_height", a.wall_height, b.wall_height, worst);
      compare("wall_velocity", a.wall_velocity, b.wall_velocity, worst);
    }
    return;
  }
  const auto require = [&](const std::string& field, double computed, double recorded) {
    if (computed == recorded || replay.divergence) return;
    diverge(replay, record.step, fmt::format("{} is {} instead of {}", field, computed, recorded),
            field);
    compare(field.c_str(), computed, recorded, *replay.divergence);
  };
  require("cycle", found.cycle, record.cycle);
  require("time_s", found.time_s, record.time_s);
  // Earlier versions may have recorded fewer observables.
  for (const auto& [name, value] : record.observables) {
    const auto again = found.observables.find(name);
    require(name, again == found.observables.end() ? std::nan("") : again->second, value);
  }
  if (const auto recorded = store.load_if_readable(record)) {
    require("theta", found.theta, recorded->theta);
  }
}

/// Recomputes a checkpoint and compares it with the record. Writes the file if options.restores.
Replay replay(Store& store, const CheckpointRecord& record, const StageOptions& options) {
  Replay result{.record = record};
  const auto found = compute_again(store, result, options);
  if (found) compare_again(store, *found, result);
  if (options.restores && found && !result.divergence) {
    try {
      store.restore_checkpoint(record, *found);
    } catch (const StoreDamaged& other_bytes) {
      diverge(result, record.step, other_bytes.what(), "file");
    }
  }
  if (options.restores ? !result.divergence : result.interrupted) return result;
  nlohmann::json facts = {{"sha256", record.sha256}, {"step", record.step},
                          {"cycle", record.cycle},   {"state_hash", record.state_hash},
                          {"from", nullptr},         {"steps", result.steps},
                          {"host", host_facts()}};
  if (result.from) facts["from"] = {{"sha256", result.from->sha256}, {"step", result.from->step}};
  if (result.divergence) facts.update(to_json(*result.divergence));
  store.record(run_stream(record.run),
               {result.divergence ? "ReplayDiverged" : "ReplayVerified", facts});
  return result;
}

/// Why this program would give the steps before the checkpoint other bits; "" if it would not.
std::string other_bits(const RunLineage& run, const CheckpointHistory& made) {
  if (engine_of(run.stage.resolved) != EngineKind::shearcell) {
    return "LAMMPS computed this state, and LAMMPS runs cannot be repeated bit for bit";
  }
  if (!made.attempt) return "";
  const Attempt& by = run.attempts[*made.attempt];
  if (by.bits_version == bits_version) return "";
  return fmt::format(
      "shearcell {} computed this state with bits_version {}, but this program has bits_version "
      "{}, so its results differ in the last bits",
      maker_of(by.host).version, by.bits_version, bits_version);
}

void restore_if_pruned(Store& store, const CheckpointRecord& record, const StageOptions& options) {
  if (record.state != CheckpointState::pruned) return;
  RunLineages known;
  if (!options.restores || why_not_again(store, record, known)) {
    store.load_checkpoint(record);  // throws, unless the file was restored meanwhile
    return;
  }
  const std::string what = fmt::format("checkpoint {:.12} of run {:.12} (cycle {:g})",
                                       record.sha256, record.run, record.cycle);
  if (options.restoring) options.restoring(what + " was pruned; its file is recomputed");
  const Replay again = replay(store, record, options);
  if (again.interrupted) throw Interrupted();
  if (!again.divergence) return;
  throw StoreDamaged(what + " cannot be recomputed: " + again.divergence->message);
}

}  // namespace

StageOutcome run_stage(Store& store, const std::string& id, const StageOptions& options) {
  try {
    Stage stage = store.stage(id);
    bool computed = false;
    if (stage.state != StageState::completed || !newest_is_sound(store, stage)) {
      StageAttempt attempt(store, std::move(stage), options);
      const StageOutcome outcome = attempt.run();
      stage = store.stage(id);
      if (outcome != StageOutcome::completed || stage.state != StageState::completed)
        return outcome;
      computed = attempt.computed();
    }
    // A manifest that was declared later may ask for more frequent checkpoints.
    const std::vector<std::uint64_t> missing =
        outlook(stage, asks_of(stage.memberships), store.checkpoints(id, Listed::and_pruned))
            .missing;
    if (!missing.empty()) return StageAttempt(store, std::move(stage), options).fill(missing);
    return computed ? StageOutcome::completed : StageOutcome::already;
  } catch (const Interrupted&) {
    return StageOutcome::interrupted;  // interrupted before an attempt was recorded
  } catch (const ConcurrencyConflict&) {
    return StageOutcome::lost;
  }
}

bool is_done(const Store& store, const Stage& stage) {
  const auto known = store.checkpoints(stage.id, Listed::and_pruned);
  return outlook(stage, asks_of(stage.memberships), known).done && newest_is_sound(store, stage);
}

std::optional<CheckpointRecord> starting_state(const Store& store, const Stage& stage,
                                               const Parameters& parameters) {
  const Stage parent = store.stage(stage.parent);
  const bool settles = parent.kind == name_of(StageKind::prepare);
  if (settles && parent.state != StageState::completed) return std::nullopt;
  const double cycle = static_cast<double>(parameters.start_cycle);
  for (const CheckpointRecord& record : store.checkpoints(stage.parent, Listed::and_pruned)) {
    if (settles ? record.step == parent.step : record.cycle == cycle) return record;
  }
  return std::nullopt;
}

nlohmann::json to_json(const Divergence& divergence) {
  return {{"last_same_step", divergence.same_step},
          {"first_step", divergence.first_step},
          {"field", divergence.field},
          {"grain", divergence.grain},
          {"ulp", divergence.ulp},
          {"why", divergence.message}};
}

std::optional<std::string> why_not_again(const Store& store, const CheckpointRecord& record,
                                         RunLineages& known) {
  add_run_lineage(store, record.run, known);
  const RunLineage& run = known.at(record.run);
  const CheckpointHistory* made = run.find(record.sha256);
  if (made == nullptr) return std::nullopt;
  if (std::string why = other_bits(run, *made); !why.empty()) return why;
  // The computation begins at the newest earlier state that this program cannot compute.
  std::optional<CheckpointRecord> from;
  for (const CheckpointHistory& earlier : run.checkpoints) {
    if (earlier.record.step >= record.step) break;
    if (!other_bits(run, earlier).empty()) from = earlier.record;
  }
  if (!from && !run.stage.parent.empty()) {
    from = starting_state(store, run.stage, read_stage(run.stage.resolved).parameters);
    if (from && !why_not_again(store, *from, known)) return std::nullopt;
  }
  if (!from || store.load_if_readable(*from)) return std::nullopt;
  return fmt::format(
      "this state was computed from cycle {:g} of run {:.12}, whose file is lost, and this program "
      "cannot compute that file again",
      from->cycle, from->run);
}

Replay verify_by_replay(Store& store, const CheckpointRecord& record, std::size_t threads) {
  return replay(store, record, {.parallel = {.threads = threads}, .restores = false});
}

Replay regenerate_checkpoint(Store& store, const CheckpointRecord& record, std::size_t threads) {
  return replay(store, record, {.parallel = {.threads = threads}});
}

}  // namespace shearcell
