// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <iterator>
#include <random>
#include <utility>

#include "core/watchdog.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/runner/host.hpp"
#include "experiments/runner/stage.hpp"
#include "experiments/runner/stop.hpp"
#include "provenance/errors.hpp"

namespace shearcell {
namespace {

// Integers in the order of the reals: neighbouring doubles differ by 1, and so do -0 and +0.
std::int64_t ordered_bits(double x) {
  const auto bits = std::bit_cast<std::int64_t>(x);
  return bits >= 0 ? bits : std::int64_t{-1} - (bits & INT64_MAX);
}

std::uint64_t ulp_distance(double a, double b) {
  const std::int64_t x = ordered_bits(a), y = ordered_bits(b);
  return x > y ? static_cast<std::uint64_t>(x) - static_cast<std::uint64_t>(y)
               : static_cast<std::uint64_t>(y) - static_cast<std::uint64_t>(x);
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

class Replaying {
 public:
  Replaying(Store& store, const CheckpointRecord& record)
      : store_(store), plan_(ready_stage(store, store.stage(record.run))) {
    replay_.record = record;
  }

  /// The state at the record's step; nothing when that was not reached.
  std::optional<Checkpoint> compute(std::size_t threads) {
    const CheckpointRecord& record = replay_.record;
    try {
      Beginning beginning = continue_stage(store_, plan_, nullptr, record.step);
      replay_.from = beginning.from;
      Simulation simulation = make_simulation(plan_, std::move(beginning), threads);
      first_ = simulation.step();
      double cycle = 0;  // where nothing is stepped: at the beginning of the stage
      const std::uint64_t chunk = chunk_steps(simulation.grains());
      while (simulation.step() < record.step) {
        const std::uint64_t left = record.step - simulation.step();
        const StageProgress progress = plan_.protocol->advance(simulation, std::min(chunk, left));
        replay_.steps = simulation.step() - first_;
        cycle = progress.cycle;
        if (progress.finished && simulation.step() < record.step) {
          diverge(simulation.step(),
                  fmt::format("the stage ended at step {} already", simulation.step()));
          return std::nullopt;
        }
        give_up_if_requested();
      }
      return make_checkpoint(plan_, simulation, cycle);
    } catch (const Interrupted&) {
      replay_.interrupted = true;
      return std::nullopt;
    } catch (const NumericalFailure& failure) {
      diverge(failure.step, failure.what());
      return std::nullopt;
    }
  }

  void compare_with(const Checkpoint& found) {
    const CheckpointRecord& record = replay_.record;
    const std::string hash = state_hash(found);
    if (hash == record.state_hash) return compare_numbers(found);
    diverge(record.step, fmt::format("state {:.12} instead of {:.12}", hash, record.state_hash));
    Divergence& worst = *replay_.divergence;
    if (const auto recorded = store_.load_if_readable(record)) {
      const State& a = recorded->state;
      const State& b = found.state;
      compare("position", a.position, b.position, worst);
      compare("velocity", a.velocity, b.velocity, worst);
      compare("wall_height", a.wall_height, b.wall_height, worst);
      compare("wall_velocity", a.wall_velocity, b.wall_velocity, worst);
    }
  }

  // Compares the numbers that the log and the file have beside the state.
  void compare_numbers(const Checkpoint& found) {
    const auto require = [this](const std::string& field, double computed, double recorded) {
      if (computed == recorded || replay_.divergence) return;
      diverge(replay_.record.step, fmt::format("{} {} instead of {}", field, computed, recorded),
              field);
      compare(field.c_str(), computed, recorded, *replay_.divergence);
    };
    const CheckpointRecord& record = replay_.record;
    require("cycle", found.cycle, record.cycle);
    require("time_s", found.time_s, record.time_s);
    // Versions before this one may have recorded fewer observables.
    for (const auto& [name, value] : record.observables) {
      const auto again = found.observables.find(name);
      require(name, again == found.observables.end() ? std::nan("") : again->second, value);
    }
    if (const auto recorded = store_.load_if_readable(record)) {
      require("theta", found.theta, recorded->theta);
    }
  }

  void diverge(std::uint64_t step, const std::string& message, const std::string& field = "") {
    replay_.divergence = Divergence{first_, step, field, -1, 0, message};
  }

  void record_outcome() {
    const CheckpointRecord& record = replay_.record;
    nlohmann::json facts = {{"sha256", record.sha256}, {"step", record.step},
                            {"cycle", record.cycle},   {"state_hash", record.state_hash},
                            {"from", nullptr},         {"steps", replay_.steps},
                            {"host", host_facts()}};
    if (replay_.from) {
      facts["from"] = {{"sha256", replay_.from->sha256}, {"step", replay_.from->step}};
    }
    if (replay_.divergence) facts.update(to_json(*replay_.divergence));
    store_.record_replay(record.run, !replay_.divergence, facts);
  }

  Replay& result() { return replay_; }

 private:
  Store& store_;
  ReadyStage plan_;
  Replay replay_;
  std::uint64_t first_ = 0;
};

}  // namespace

nlohmann::json to_json(const Divergence& divergence) {
  return {{"last_same_step", divergence.same_step},
          {"first_step", divergence.first_step},
          {"field", divergence.field},
          {"grain", divergence.grain},
          {"ulp", divergence.ulp},
          {"why", divergence.message}};
}

std::vector<CheckpointRecord> replayable(const Store& store) {
  std::vector<CheckpointRecord> found;
  for (const Stage& run : store.stages()) {
    if (why_not_again(run)) continue;
    std::ranges::move(store.checkpoints(run.id, Listed::and_pruned), std::back_inserter(found));
  }
  return found;
}

std::optional<std::string> why_not_again(const Stage& run) {
  if (engine_of(run.resolved) == EngineKind::shearcell) return std::nullopt;
  return "LAMMPS made it, whose runs are not repeated bit for bit";
}

std::vector<CheckpointRecord> sample(std::vector<CheckpointRecord> records, std::size_t count,
                                     std::uint64_t seed) {
  count = std::min(count, records.size());
  // Distributions of the standard library differ between libraries; a remainder does not.
  std::mt19937_64 random(seed);
  for (std::size_t i = 0; i < count; ++i) {
    std::swap(records[i], records[i + random() % (records.size() - i)]);
  }
  records.resize(count);
  return records;
}

std::uint64_t seed_of(const Head& head) {
  const std::string digits = head.hash.substr(0, 12);
  std::uint64_t seed = 0;  // 0 if a damaged log has no digits
  std::from_chars(digits.data(), digits.data() + digits.size(), seed, 16);
  return seed;
}

Replay verify_by_replay(Store& store, const CheckpointRecord& record, std::size_t threads) {
  Replaying replaying(store, record);
  if (const auto found = replaying.compute(threads)) replaying.compare_with(*found);
  if (!replaying.result().interrupted) replaying.record_outcome();
  return std::move(replaying.result());
}

Replay regenerate_checkpoint(Store& store, const CheckpointRecord& record, std::size_t threads) {
  Replaying replaying(store, record);
  const auto found = replaying.compute(threads);
  if (found) replaying.compare_with(*found);
  if (found && !replaying.result().divergence) {
    try {
      store.restore_checkpoint(record, *found);
    } catch (const StoreDamaged& other_bytes) {
      replaying.diverge(record.step, other_bytes.what(), "file");
    }
  }
  if (replaying.result().divergence) replaying.record_outcome();
  return std::move(replaying.result());
}

}  // namespace shearcell
