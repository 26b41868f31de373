// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/measure_sources.hpp"

#include <utility>

#include "core/drive.hpp"
#include "experiments/runner/outlook.hpp"
#include "provenance/errors.hpp"

namespace shearcell {

MeasureSources::Shear MeasureSources::read_shear(const std::string& id) const {
  Shear shear;
  const std::optional<Drive> motion = shear_drive(store_.run(id));
  if (!motion) return shear;
  shear.cycle_steps = cycle_steps(*motion);
  for (CheckpointRecord& one : store_.checkpoints(id, Listed::and_pruned)) {
    const std::uint64_t step = one.step;
    shear.checkpoints.insert_or_assign(step, std::move(one));
  }
  return shear;
}

void MeasureSources::read_run(const std::string& run) {
  const auto [entry, first] = runs_.try_emplace(run);
  if (first) entry->second = read_shear(run);
}

DerivedKey MeasureSources::key(const CheckpointRecord& record, const DerivedMeasure& measure) {
  if (measure.earlier.empty()) return {record.sha256, measure.key(), analysis_version};
  read_run(record.run);
  std::string text = measure.key();
  for (const std::uint64_t cycles : measure.earlier) {
    const CheckpointRecord* other = find(record, cycles);
    text += " " + (other == nullptr ? "none" : other->sha256);
  }
  return {record.sha256, std::move(text), analysis_version};
}

const CheckpointRecord* MeasureSources::find(const CheckpointRecord& record,
                                             std::uint64_t cycles) const {
  const auto run = runs_.find(record.run);
  if (run == runs_.end()) return nullptr;
  const Shear& shear = run->second;
  const std::uint64_t back = cycles * shear.cycle_steps;
  if (shear.cycle_steps == 0 || record.step < back) return nullptr;
  const auto every = cadence_.find(record.run);
  const std::uint64_t step = record.step - back, cycle = step / shear.cycle_steps;
  const bool whole = step % shear.cycle_steps == 0;
  if (whole && every != cadence_.end() && cycle % every->second != 0) return nullptr;
  const auto found = shear.checkpoints.find(step);
  return found == shear.checkpoints.end() ? nullptr : &found->second;
}

std::optional<nlohmann::json> MeasureSources::measure(const CheckpointRecord& record,
                                                      const Checkpoint& checkpoint,
                                                      const Analysis& analysis,
                                                      const DerivedMeasure& measure,
                                                      UnreadCheckpoints& unread) const {
  Checkpoint other;
  const auto load = [&](std::uint64_t cycles) -> const Checkpoint* {
    const CheckpointRecord* found = find(record, cycles);
    if (found == nullptr) return nullptr;
    other = store_.load_checkpoint(*found);
    return &other;
  };
  try {
    return measure.from({analysis, &checkpoint, load});
  } catch (const FilePruned& pruned) {
    unread.pruned.emplace_back(pruned.what());
  } catch (const StoreDamaged& damage) {
    unread.damage.emplace_back(damage.what());
  }
  return std::nullopt;
}

std::optional<Checkpoint> MeasureSources::earlier(const CheckpointRecord& record,
                                                  std::uint64_t cycles) const {
  const CheckpointRecord* found = find(record, cycles);
  return found == nullptr ? std::nullopt : store_.load_if_readable(*found);
}

}  // namespace shearcell
