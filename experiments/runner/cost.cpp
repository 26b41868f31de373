// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/cost.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/drive.hpp"
#include "core/minimizer.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/identity.hpp"

namespace shearcell {
namespace {

// Particle-steps/s assumed until the store has measured them: rough cells on one core of an EPYC
// (Zen 4), from `bench speed`; LAMMPS 29 Sep 2021 with one process (SCALING.md).
struct MeasuredRate {
  double grains, rate;
};
constexpr MeasuredRate kOurRates[] = {{5200, 74e6}, {1e5, 57e6}, {1e6, 53e6}};
constexpr MeasuredRate kLammpsRates[] = {{5200, 6.6e6}, {1e5, 3.0e6}};

// A power law in N between two measured sizes, constant beyond the outermost ones.
double assumed_rate(std::span<const MeasuredRate> rates, double grains) {
  if (grains <= rates.front().grains) return rates.front().rate;
  for (std::size_t i = 1; i < rates.size(); ++i) {
    const MeasuredRate &a = rates[i - 1], &b = rates[i];
    if (grains > b.grains) continue;
    const double part = std::log(grains / a.grains) / std::log(b.grains / a.grains);
    return a.rate * std::pow(b.rate / a.rate, part);
  }
  return rates.back().rate;
}

// Size of a checkpoint file, measured: its grains, its wall grains, and the layout around them.
constexpr double kBytesPerGrain = 121;
constexpr double kBytesPerWallGrain = 98;
constexpr double kBytesPerFile = 18e3;

// Simulated time [s] to settle a packing of height h [d]; within a third of the measured 0.9, 1.1,
// 1.6 and 2.8 s at N = 600, 2000, 5200 and 18200.
double settling_time(double height) {
  return 0.6 + 0.00175 * height * height;
}

// Evaluations of the forces in one minimization at the default tolerance, on average over the nine
// of B.2; within a sixth of the measured 8.2e3, 16e3 and 52e3 at N = 600, 2000 and 7900.
double minimization(double grains) {
  return 18e3 * std::pow(grains / 2000, 0.7);
}

/// What the run's memberships ask for that the store does not know yet.
std::vector<RunAsk> planned_asks(const PlannedRun& run, const RunRecord& known) {
  std::vector<RunAsk> planned;
  for (const Membership& one : run.memberships) {
    const bool declared = std::ranges::any_of(
        known.memberships, [&](const Membership& m) { return place_of(m) == place_of(one); });
    if (declared) continue;
    planned.push_back({one.target_cycles, {}, one.checkpoint_every, one.checkpoint_phases});
  }
  return planned;
}

/// Cycle of the last checkpoint before the first one that is missing; nothing when none is missing.
std::optional<double> cycle_to_replay(const Store& store, const RunRecord& known,
                                      std::span<const RunAsk> planned) {
  const std::vector<std::uint64_t> missing = missing_checkpoints(store, known, planned);
  if (missing.empty()) return std::nullopt;
  double from = 0;
  for (const CheckpointRecord& record : store.checkpoints(known.id)) {
    if (record.step < missing.front()) from = record.cycle;
  }
  return from;
}

}  // namespace

double run_bytes(const Geometry& shape) {
  return kRunBytesPerGrain * (static_cast<double>(shape.grains) + wall_grain_count(shape));
}

double checkpoint_bytes(const Geometry& shape) {
  return kBytesPerFile + kBytesPerGrain * static_cast<double>(shape.grains) +
         kBytesPerWallGrain * wall_grain_count(shape);
}

std::size_t take_longer_targets(const std::vector<RunRecord>& known, Plan& plan) {
  std::map<std::string, std::uint64_t> longest;
  for (const RunRecord& run : known) {
    if (run.state != RunState::completed) longest[run.id] = run.target_cycles;
  }
  std::size_t longer = 0;
  for (PlannedRun& run : plan.runs) {
    const auto found = longest.find(run.last.key);
    if (found == longest.end() || found->second <= run.target_cycles) continue;
    run.target_cycles = found->second;
    ++longer;
  }
  return longer;
}

std::optional<double> cycle_to_continue(const PlannedRun& run, const StageSpec& stage,
                                        const RunRecord* known, const Store* store) {
  if (known == nullptr) return 0;
  const bool completed = known->state == RunState::completed;
  if (stage.stage == Stage::prepare) return completed ? std::nullopt : std::optional(known->cycle);
  const std::vector<RunAsk> asks = asks_of(*store, known->id);
  const bool has_its_length = std::ranges::all_of(run.memberships, [&](const Membership& planned) {
    return known->cycle >= static_cast<double>(planned.target_cycles) ||
           std::ranges::any_of(asks, [&](const RunAsk& ask) {
             return ask.until && to_json(*ask.until) == planned.until &&
                    ask.target_cycles >= planned.target_cycles &&
                    ask.checkpoint_every % planned.checkpoint_every == 0;
           });
  });
  const std::optional<double> replayed = cycle_to_replay(*store, *known, planned_asks(run, *known));
  if (completed && has_its_length) return replayed;
  return std::min(known->cycle, replayed.value_or(known->cycle));
}

double checkpoints_left(std::string_view kind, const RunAsk& ask, double cycle) {
  const auto target = static_cast<double>(ask.target_cycles);
  if (kind == name_of(Stage::stiffen)) return std::max(0.0, target - cycle);
  const auto every = static_cast<double>(ask.checkpoint_every);
  const double cycles = std::ceil(target / every) - std::floor(cycle / every);
  const double whole = std::ceil(target / every) - std::ceil(cycle / every);
  return std::max(0.0, cycles) + std::max(0.0, whole) * static_cast<double>(ask.phases.size());
}

StageCost stage_cost(const PlannedRun& run, const StageSpec& stage, double cycle) {
  const Geometry shape = geometry(run.parameters);
  const double width = cell_width(shape);
  const double bytes = checkpoint_bytes(shape);
  const auto grains = static_cast<double>(run.parameters.grains);
  if (stage.stage == Stage::prepare) {
    const double settling = settling_time(shape.height_over_width * width);
    const double time = std::min(std::max(settling, damping_time_s(run.parameters)),
                                 run.parameters.settle_time_limit_s);
    return {grains * time / run.parameters.settle_time_step_s, bytes * (1 + std::floor(time / 2))};
  }
  const RunAsk ask = {run.target_cycles, {}, run.checkpoint_every, run.checkpoint_phases};
  const double files = checkpoints_left(name_of(stage.stage), ask, cycle) + (cycle == 0 ? 1 : 0);
  const double left = std::max(0.0, static_cast<double>(run.target_cycles) - cycle);
  const double steps = stage.stage == Stage::stiffen
                           ? minimization(grains)
                           : static_cast<double>(cycle_steps(drive(run.parameters)));
  return {grains * steps * left, bytes * files};
}

Rates::Rates(const std::vector<RunRecord>& runs) {
  for (const RunRecord& run : runs) {
    Sum& sum = sums_[engine_of(run.resolved)];
    sum.steps += run.particle_steps;
    sum.seconds += run.wall_seconds;
  }
}

Rate Rates::of(EngineKind engine, double grains) const {
  const auto sum = sums_.find(engine);
  if (sum != sums_.end() && sum->second.seconds >= 1) {
    return {sum->second.steps / sum->second.seconds, true};
  }
  if (engine == EngineKind::lammps) return {assumed_rate(kLammpsRates, grains), false};
  return {assumed_rate(kOurRates, grains), false};
}

void RemainingWork::add(const std::string& id, const std::string& parent, double steps_left,
                        const Rate& rate) {
  const double own_seconds = steps_left / rate.particle_steps_per_second;
  ++stages;
  particle_steps += steps_left;
  core_seconds += own_seconds;
  measured = measured && rate.measured;
  longest_seconds = std::max(longest_seconds, chain[id] = chain[parent] + own_seconds);
}

double RemainingWork::seconds(std::size_t at_a_time) const {
  return std::max(longest_seconds, core_seconds / static_cast<double>(at_a_time));
}

std::set<std::string> waiting_for_failed(const std::vector<RunRecord>& runs) {
  std::set<std::string> failed, waiting;
  for (const RunRecord& run : runs) {
    if (run.state == RunState::failed) failed.insert(run.id);
  }
  for (const RunRecord& run : runs) {
    if (!has_ended(run.state) && failed.contains(run.parent)) waiting.insert(run.id);
  }
  return waiting;
}

RemainingWork remaining_work(const Store& store, const std::vector<RunRecord>& stages) {
  RemainingWork work;
  const std::vector<RunRecord> all = store.runs();
  const Rates rates(all);
  const std::set<std::string> waiting = waiting_for_failed(all);
  for (const RunRecord& run : stages) {
    if (has_ended(run.state) || waiting.contains(run.id)) continue;
    const StageRecord record = read_stage(run.resolved);
    PlannedRun planned;
    planned.parameters = record.parameters;
    planned.target_cycles = run.target_cycles;
    const bool replays =
        record.stage == Stage::shear && run.cycle >= static_cast<double>(run.target_cycles);
    const double from = replays ? cycle_to_replay(store, run, {}).value_or(run.cycle) : run.cycle;
    const double steps =
        stage_cost(planned, {record.stage, run.id, run.parent, {}}, from).particle_steps;
    const Rate rate = rates.of(record.parameters.engine, static_cast<double>(run.grains));
    work.add(run.id, run.parent, steps, rate);
  }
  return work;
}

}  // namespace shearcell
