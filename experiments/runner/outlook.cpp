// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/outlook.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "core/drive.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/manifest/manifest.hpp"
#include "experiments/runner/cost.hpp"
#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"
#include "provenance/limits.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

constexpr std::size_t kMostListed = 1'000'000;  // of one list; the store is not trusted
constexpr double kMostCounted = 10'000;         // one by one; more are extrapolated

std::optional<Until> until_of(const Ask& ask) try {
  if (!has_until(ask)) return std::nullopt;
  return until_from_json(ask.until);
} catch (const std::runtime_error& problem) {
  throw StoreDamaged(fmt::format("a record of experiment {}: {}", ask.experiment, problem.what()));
}

/// The cycle at which the stage reached this `until`, as a completion recorded it.
std::optional<double> recorded_reach(const Stage& stage, const Until& until, double every) {
  for (const json& ended : stage.ends) {
    const json cycle = member_of(ended, "reached_at_cycle");
    if (member_of(ended, "measure") == name_of(until.measure) &&
        member_of(ended, "value") == until.value &&
        member_of(ended, "extra_cycles") == until.extra_cycles && cycle.is_number() &&
        std::fmod(cycle.get<double>(), every) == 0) {
      return cycle.get<double>();
    }
  }
  return std::nullopt;
}

/// Where the stage ends for one ask alone.
struct End {
  double cycle = 0;                             ///< its number of cycles, or earlier
  std::optional<double> reached = {};           ///< the cycle at which its `until` was reached
  const CheckpointRecord* undecided = nullptr;  ///< the first that may have reached it
};

End end_for(const Stage& stage, const Ask& ask, std::span<const SeenCheckpoint> checkpoints) {
  End end{static_cast<double>(ask.target_cycles)};
  const std::optional<Until> until = until_of(ask);
  if (!until) return end;
  const std::string_view measure = name_of(until->measure);
  const auto every = static_cast<double>(ask.checkpoint_every);
  for (const SeenCheckpoint& one : checkpoints) {
    if (std::fmod(one.record.cycle, every) != 0) continue;
    if (!one.measures) {
      // A longer end is unknown until it has been asked for.
      if (ask.target_cycles <= stage.target_cycles) {
        end.reached = recorded_reach(stage, *until, every);
      }
      if (!end.reached) end.undecided = &one.record;
      break;
    }
    if (one.measures->number(measure) < until->value) continue;
    end.reached = one.record.cycle;
    break;
  }
  if (end.reached) {
    // The first checkpoint at or after it.
    const double last = *end.reached + static_cast<double>(until->extra_cycles);
    end.cycle = std::min(end.cycle, std::ceil(last / every) * every);
  }
  return end;
}

/// Whether what the completed stage has recorded meets the ask.
bool is_covered(const Stage& stage, const Ask& ask) {
  return stage.state == StageState::completed && has_until(ask) &&
         std::ranges::any_of(stage.asks, [&](const Ask& recorded) {
           return recorded.until == ask.until && recorded.target_cycles >= ask.target_cycles &&
                  recorded.checkpoint_every % ask.checkpoint_every == 0;
         });
}

/// Sets the end. Returns whether the stage is as long as every ask wants it.
bool find_end(const Stage& stage, std::span<const Ask> asks,
              std::span<const SeenCheckpoint> checkpoints, Outlook& look) {
  bool long_enough = true, reached = true;
  double latest = -1;
  for (const Ask& ask : asks) {
    const End end = end_for(stage, ask, checkpoints);
    const bool earlier =
        end.undecided != nullptr && (!look.undecided || end.undecided->step < look.undecided->step);
    if (earlier) look.undecided = *end.undecided;
    reached = reached && stage.cycle >= end.cycle;
    const bool met = stage.cycle >= end.cycle || is_covered(stage, ask);
    long_enough = long_enough && met;
    look.end = std::max(look.end, met ? std::min(end.cycle, stage.cycle) : end.cycle);
    if (!end.reached || end.cycle <= latest) continue;
    latest = end.cycle;
    const Until until = *until_of(ask);
    look.ended = {{"by", "until"},
                  {"measure", name_of(until.measure)},
                  {"value", until.value},
                  {"extra_cycles", until.extra_cycles},
                  {"reached_at_cycle", *end.reached},
                  {"memberships", asks.size()}};
  }
  if (!reached) look.ended = nullptr;
  return long_enough;
}

/// Steps from `first` to `last` at which a cadence has a checkpoint, at most so many.
std::vector<std::uint64_t> steps_between(std::span<const CheckpointCadence> cadences,
                                         const Drive& drive, std::uint64_t first, double last,
                                         std::size_t most) {
  std::vector<std::uint64_t> steps;
  std::uint64_t step = first == 0 ? 0 : next_checkpoint(cadences, drive, first - 1);
  for (; static_cast<double>(step) <= last && steps.size() < most;
       step = next_checkpoint(cadences, drive, step)) {
    steps.push_back(step);
  }
  return steps;
}

/// Of a shear, whose end is known.
void find_left(const Stage& stage, const Drive& motion, EngineKind engine,
               std::span<const Ask> asks, std::span<const SeenCheckpoint> checkpoints,
               Outlook& look) {
  const auto whole = static_cast<double>(cycle_steps(motion));
  const double length = look.end * whole, now = static_cast<double>(stage.step);
  const std::vector<CheckpointCadence> cadences = cadences_of(asks, motion);
  const std::uint64_t next = checkpoints.empty() ? 0 : stage.step + 1;
  const auto to_come = steps_between(cadences, motion, next, length, kMostCounted);
  look.checkpoints = static_cast<double>(to_come.size());
  if (look.checkpoints == kMostCounted) {
    look.checkpoints *= (length - now) / (static_cast<double>(to_come.back()) - now);
  }
  double steps = std::max(0.0, length - now);
  if (stage.step > 0) {
    std::set<std::uint64_t> known;
    for (const SeenCheckpoint& one : checkpoints) known.insert(one.record.step);
    auto lacking = steps_between(cadences, motion, 0, std::min(now - 1, length), kMostListed);
    std::erase_if(lacking, [&](std::uint64_t step) { return known.contains(step); });
    (engine == EngineKind::shearcell ? look.missing : look.lost) = std::move(lacking);
  }
  if (!look.missing.empty()) {
    std::uint64_t from = 0;
    look.from = 0;
    for (const SeenCheckpoint& one : checkpoints) {
      const CheckpointRecord& record = one.record;
      if (record.state != CheckpointState::recorded || record.step >= look.missing.front())
        continue;
      look.from = record.cycle;
      from = record.step;
    }
    steps += static_cast<double>(look.missing.back() - from);
    look.checkpoints += static_cast<double>(look.missing.size());
  }
  look.particle_steps = static_cast<double>(stage.grains) * steps;
}

}  // namespace

Outlook outlook(const Stage& stage, std::span<const Ask> asks,
                std::span<const SeenCheckpoint> checkpoints) {
  Outlook look{.from = stage.cycle};
  const bool long_enough = find_end(stage, asks, checkpoints, look);
  const bool completed = stage.state == StageState::completed;
  try {
    const StageInputs known = read_stage(stage.resolved);
    const Parameters& p = known.parameters;
    const auto grains = static_cast<double>(stage.grains);
    if (known.stage == StageKind::shear) {
      find_left(stage, drive(p), p.engine, asks, checkpoints, look);
    } else if (known.stage == StageKind::stiffen) {
      const double left = std::max(0.0, look.end - stage.cycle);
      look.particle_steps = grains * minimization_evaluations(grains) * left;
      look.checkpoints = left + (checkpoints.empty() ? 1 : 0);
    } else if (!completed) {
      const double time = settling_time_s(p);
      look.particle_steps = grains * time / p.settle_time_step_s;
      look.checkpoints = 1 + std::floor(time / 2);
    }
    look.bytes = look.checkpoints * checkpoint_bytes(geometry(p));
  } catch (const UnreadableRecord& problem) {
    look.unreadable = problem.what();
  }
  look.done = completed && long_enough && look.missing.empty();
  return look;
}

bool has_until(const Ask& ask) {
  return !ask.until.is_null();
}

std::optional<Drive> shear_drive(const Stage& stage) {
  if (stage.kind != name_of(StageKind::shear)) return std::nullopt;
  try {
    return drive(read_stage(stage.resolved).parameters);
  } catch (const UnreadableRecord&) {
    return std::nullopt;
  }
}

std::vector<CheckpointCadence> cadences_of(std::span<const Ask> asks, const Drive& drive) {
  std::vector<CheckpointCadence> cadences;
  for (const Ask& ask : asks) {
    if (ask.checkpoint_phases.size() > ManifestLimits::values_per_list) {
      throw StoreDamaged(fmt::format("a record of experiment {}: checkpoint_phases: there are {}",
                                     ask.experiment, ask.checkpoint_phases.size()));
    }
    if (ask.target_cycles == 0) continue;  // it asks for cycle 0, which each shear records
    cadences.push_back(
        {ask.checkpoint_every, steps_at(ask.checkpoint_phases, drive), ask.target_cycles});
  }
  return cadences;
}

std::vector<std::uint64_t> asked_steps(const Stage& stage, const Ask& ask, double first,
                                       double last) {
  const std::optional<Drive> motion = shear_drive(stage);
  if (!motion || !(first >= 0 && last <= static_cast<double>(StoreLimits::cycles))) return {};
  const auto whole = static_cast<double>(cycle_steps(*motion));
  return steps_between(cadences_of({&ask, 1}, *motion), *motion,
                       static_cast<std::uint64_t>(std::ceil(first * whole)), last * whole,
                       kMostListed);
}

std::uint64_t checkpoint_cadence(std::span<const Ask> asks) {
  std::uint64_t cadence = 0;
  for (const Ask& ask : asks) cadence = std::gcd(cadence, ask.checkpoint_every);
  return std::max<std::uint64_t>(cadence, 1);
}

}  // namespace shearcell
