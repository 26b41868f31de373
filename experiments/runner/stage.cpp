// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/stage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/diagnostics.hpp"
#include "core/drive.hpp"
#include "core/filling.hpp"
#include "core/machine.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/runner/cost.hpp"
#include "experiments/runner/outlook.hpp"
#include "experiments/runner/stop.hpp"
#include "protocols/cyclic_shear.hpp"
#include "protocols/settle.hpp"
#include "protocols/stiffen.hpp"
#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {
namespace {

Scene make_scene(const StageInputs& stage) {
  switch (stage.stage) {
    case StageKind::shear:
      return shear_scene(stage.parameters);
    case StageKind::stiffen:
      return stiffen_scene(stage.parameters);
    case StageKind::prepare:
      break;
  }
  return settle_scene(stage.parameters);
}

void require_memory(const StageInputs& stage) {
  const double needed = run_bytes(geometry(stage.parameters));
  if (needed <= machine_memory()) return;
  throw TooLittleMemory(fmt::format(
      "{} grains take about {:.3g} GB, and this machine has {:.3g} GB; use fewer grains",
      stage.parameters.grains, needed / 1e9, machine_memory() / 1e9));
}

std::unique_ptr<Protocol> make_protocol(const StageInputs& stage, const Stage& run) {
  const Parameters& p = stage.parameters;
  const std::uint64_t cycles = run.target_cycles;
  if (stage.stage == StageKind::prepare) {
    return std::make_unique<Settle>(
        SettleParameters{p.settle_force_tolerance, p.settle_kinetic_tolerance,
                         p.settle_time_limit_s, p.max_overlap_diameters},
        settle_scene(p));
  }
  if (stage.stage == StageKind::stiffen) {
    StiffenParameters stiffen{p.stiffness_steps_per_decade, cycles, {}};
    stiffen.minimize.force_tolerance = p.minimize_force_tolerance;
    return std::make_unique<Stiffen>(stiffen, stiffen_scene(p));
  }
  return std::make_unique<CyclicShear>(drive(p), cycles, cycles, cadences_of(run.asks, drive(p)));
}

// The limit is not part of a run's identity. Limits other than the default are recorded with the
// manifest (campaign.cpp); for the other manifests it is `otherwise`.
double overlap_limit(const Store& store, const Stage& run, double otherwise) {
  double limit = run.asks.empty() ? otherwise : 0;
  for (const Ask& ask : run.asks) {
    double stated = otherwise;
    for (const Event& event : store.events("manifest/" + ask.manifest)) {
      try {
        const nlohmann::json info = event.body().at("info");
        stated =
            info.value("max_overlap_diameters", nlohmann::json::object()).value(ask.scale, stated);
      } catch (const nlohmann::json::exception& problem) {
        throw damaged_payload(event, problem);
      }
    }
    limit = std::max(limit, stated);
  }
  return limit;
}

// Where the stage itself begins.
Beginning begin_stage(Store& store, const ReadyStage& plan, std::vector<std::string>* damage) {
  const Stage& run = plan.run;
  if (run.parent.empty()) {
    const Geometry shape = geometry(plan.stage.parameters);
    Cell cell = make_cell(shape, plan.stage.seed, give_up_if_requested);
    State state = fill_cell(cell, shape, plan.stage.seed, give_up_if_requested);
    return {std::move(cell), std::move(state), std::nullopt, ""};
  }
  auto parent = store.newest_valid_checkpoint(run.parent, damage);
  // The checkpoint must be the one at which the parent was completed.
  const Stage ended = store.stage(run.parent);
  if (!parent || ended.state != StageState::completed || parent->record.step != ended.step) {
    const bool recorded = ended.state == StageState::completed && !ended.state_hash.empty();
    throw StoreDamaged(fmt::format(
        "run {:.12}: the settled packing that run {:.12} starts from is missing or damaged; {}",
        run.parent, run.id,
        recorded ? fmt::format("`shearcell regenerate {:.12}` restores its file",
                               store.checkpoints(run.parent).back().sha256)
                 : "`shearcell resume` recomputes it first"));
  }
  parent->checkpoint.state.step = 0;
  return {std::move(parent->checkpoint.cell), std::move(parent->checkpoint.state), std::nullopt,
          parent->record.sha256};
}

}  // namespace

ReadyStage ready_stage(const Store& store, Stage run) {
  if (stage_key(run.resolved) != run.id) {
    throw StoreDamaged("run " + run.id.substr(0, 12) +
                       ": its recorded parameters are not those that it is named after");
  }
  StageInputs stage = read_stage(run.resolved);
  double& limit = stage.parameters.max_overlap_diameters;
  limit = overlap_limit(store, run, limit);
  require_memory(stage);
  const Scene scene = make_scene(stage);
  auto protocol = make_protocol(stage, run);
  return {std::move(run), std::move(stage), scene, std::move(protocol)};
}

Beginning continue_stage(Store& store, const ReadyStage& plan, std::vector<std::string>* damage,
                         std::uint64_t before_step) {
  if (auto newest = store.newest_valid_checkpoint(plan.run.id, damage, before_step)) {
    return {std::move(newest->checkpoint.cell), std::move(newest->checkpoint.state),
            std::move(newest->record), ""};
  }
  return begin_stage(store, plan, damage);
}

Simulation make_simulation(const ReadyStage& plan, Beginning&& beginning, std::size_t threads) {
  SimulationSettings settings;
  settings.threads = threads;
  settings.limits.overlap = plan.stage.parameters.max_overlap_diameters;
  return Simulation(std::move(beginning.cell), plan.scene, beginning.state, settings);
}

// At 50 million particle-steps/s.
std::uint64_t chunk_steps(std::size_t grains) {
  return std::max<std::uint64_t>(1, 2'500'000 / std::max<std::size_t>(1, grains));
}

Checkpoint make_checkpoint(const ReadyStage& plan, const Simulation& simulation, double cycle) {
  simulation.check_recordable();
  return make_checkpoint(plan, simulation.cell(), simulation.scene(), simulation.state(), cycle);
}

Checkpoint make_checkpoint(const ReadyStage& plan, const Cell& cell, const Scene& scene,
                           const State& state, double cycle) {
  Checkpoint checkpoint;
  checkpoint.run = plan.run.id;
  checkpoint.cell = cell;
  checkpoint.state = state;
  checkpoint.cycle = cycle;
  checkpoint.time_s = static_cast<double>(state.step) * plan.scene.time_step;
  checkpoint.theta = tilt(plan.protocol->drive(), state.step).theta;
  checkpoint.units = units(plan.stage.parameters);
  const WallPose pose = pose_of(checkpoint);
  const Diagnostics facts = diagnose(cell, scene, state, pose);
  checkpoint.observables = {{"kinetic_energy_per_grain_m_d2_per_s2", facts.kinetic_energy},
                            {"mean_overlap_d", facts.mean_overlap},
                            {"largest_overlap_d", facts.largest_overlap},
                            {"contacts_per_grain", facts.contacts_per_grain},
                            {"wall_force_imbalance", facts.wall_imbalance},
                            {"cell_height_d", pose.top - pose.bottom}};
  if (plan.stage.stage == StageKind::stiffen) {
    const Parameters& p = plan.stage.parameters;
    const double raised = scene.stiffness / plan.scene.stiffness;
    checkpoint.observables["stiffness_N_per_m"] = raised * p.stiffness_N_per_m;
    checkpoint.observables["force_residual_P_d2"] = force_residual(cell, scene, state);
  }
  return checkpoint;
}

}  // namespace shearcell
