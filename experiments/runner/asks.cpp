// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/asks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <stdexcept>
#include <tuple>

#include "core/drive.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/identity.hpp"
#include "provenance/errors.hpp"
#include "provenance/events.hpp"
#include "provenance/limits.hpp"

namespace shearcell {
namespace {

constexpr std::size_t kMostListed = 1'000'000;  // of one list; the store is not trusted

using Place = std::tuple<std::string, std::string, std::string, std::uint64_t, std::string>;

RunAsk ask_in(const events::RunDeclared& declared) {
  const Membership& m = declared.run.membership;
  if (m.checkpoint_every < 1 || m.checkpoint_every > StoreLimits::cycles) {
    throw std::runtime_error("checkpoint_every: is out of range");
  }
  if (declared.run.target_cycles > StoreLimits::cycles) {
    throw std::runtime_error("target_cycles: is out of range");
  }
  if (m.checkpoint_phases.size() > ManifestLimits::values_per_list) {
    throw std::runtime_error("checkpoint_phases: there are too many");
  }
  RunAsk ask{declared.run.target_cycles, {}, m.checkpoint_every, m.checkpoint_phases};
  if (!m.until.is_null()) ask.until = until_from_json(m.until);
  return ask;
}

// By place_of() of the membership.
std::map<Place, RunAsk> asks_by_place(const Store& store, const std::string& run) {
  std::map<Place, RunAsk> asks;
  for (const Event& event : store.events(run_stream(run), "RunDeclared")) {
    const auto declared = std::get<events::RunDeclared>(events::decode(event));
    try {
      RunAsk ask = ask_in(declared);
      RunAsk& newest = asks[place_of(declared.run.membership)];
      ask.target_cycles = std::max(ask.target_cycles, newest.target_cycles);
      newest = std::move(ask);
    } catch (const std::exception& problem) {
      throw StoreDamaged(fmt::format("event {} ({}): {}", event.seq, event.type, problem.what()));
    }
  }
  return asks;
}

}  // namespace

std::optional<Drive> shear_drive(const RunRecord& run) {
  if (run.kind != name_of(Stage::shear)) return std::nullopt;
  try {
    return drive(read_stage(run.resolved).parameters);
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

std::vector<RunAsk> asks_of(const Store& store, const std::string& run) {
  std::vector<RunAsk> list;
  for (auto& [place, ask] : asks_by_place(store, run)) list.push_back(std::move(ask));
  return list;
}

RunAsk ask_of(const Store& store, const std::string& run, const Membership& m) {
  const auto asks = asks_by_place(store, run);
  const auto found = asks.find(place_of(m));
  return found == asks.end() ? RunAsk{m.target_cycles} : found->second;
}

bool may_end_early(const Store& store, const std::string& run) {
  return std::ranges::any_of(asks_of(store, run),
                             [](const RunAsk& ask) { return ask.until.has_value(); });
}

CheckpointCadence cadence_of(const RunAsk& ask, const Drive& drive) {
  return {ask.checkpoint_every, steps_at(ask.phases, drive), ask.target_cycles};
}

std::vector<std::uint64_t> checkpoint_steps(const RunAsk& ask, const Drive& drive, double first,
                                            double last) {
  const CheckpointCadence cadence = cadence_of(ask, drive);
  const auto whole = static_cast<double>(cycle_steps(drive));
  std::vector<std::uint64_t> steps;
  if (!(first >= 0 && last <= static_cast<double>(StoreLimits::cycles))) return steps;
  const auto begin = static_cast<std::uint64_t>(std::ceil(first * whole));
  auto step = begin == 0 ? 0 : next_checkpoint(std::span(&cadence, 1), drive, begin - 1);
  while (static_cast<double>(step) <= last * whole && steps.size() < kMostListed) {
    steps.push_back(step);
    step = next_checkpoint(std::span(&cadence, 1), drive, step);
  }
  return steps;
}

std::uint64_t checkpoint_cadence(const RunRecord& run) {
  std::uint64_t cadence = 0;
  for (const Membership& m : run.memberships) cadence = std::gcd(cadence, m.checkpoint_every);
  return std::max<std::uint64_t>(cadence, 1);
}

std::vector<std::uint64_t> missing_checkpoints(const Store& store, const RunRecord& run,
                                               std::span<const RunAsk> planned) {
  if (run.kind != name_of(Stage::shear) || engine_of(run.resolved) != EngineKind::shearcell) {
    return {};
  }
  if (stage_key(run.resolved) != run.id) return {};  // plan_stage() reports it
  const Drive motion = drive(read_stage(run.resolved).parameters);
  std::set<std::uint64_t> steps;
  std::vector<RunAsk> asks = asks_of(store, run.id);
  asks.insert(asks.end(), planned.begin(), planned.end());
  for (const RunAsk& ask : asks) {
    const double end = std::min(run.cycle, static_cast<double>(ask.target_cycles));
    for (const std::uint64_t step : checkpoint_steps(ask, motion, 0, end)) {
      if (static_cast<double>(step) < run.cycle * static_cast<double>(cycle_steps(motion))) {
        steps.insert(step);
      }
    }
  }
  for (const CheckpointRecord& record : store.checkpoints(run.id, Listed::and_pruned)) {
    steps.erase(record.step);
  }
  return {steps.begin(), steps.end()};
}

bool has_work_left(const Store& store, const RunRecord& run) {
  if (run.state != RunState::completed) return true;
  try {
    return !missing_checkpoints(store, run).empty();
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace shearcell
