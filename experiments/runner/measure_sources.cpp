// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/measure_sources.hpp"

#include <fmt/format.h>

#include <utility>

#include "core/drive.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/runner/outlook.hpp"
#include "protocols/ledger.hpp"
#include "protocols/rest.hpp"
#include "provenance/errors.hpp"
#include "provenance/events.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {

namespace {

RunFacts facts_of(const Stage& stage) {
  RunFacts facts{.parameters = member_of(stage.resolved, "parameters"),
                 .drive = shear_drive(stage)};
  if (!facts.drive) return facts;
  const Scene scene = shear_scene(read_stage(stage.resolved).parameters);
  facts.rest = [scene](const Checkpoint& from, double seconds) {
    return rested(from.cell, scene, from.state, seconds);
  };
  facts.next_cycle = [scene, drive = *facts.drive](const Checkpoint& from, std::uint64_t stride) {
    const Ledger sum = ledger(from.cell, scene, drive, from.state, cycle_steps(drive), stride);
    return CycleEnergies{sum.work_of_walls, sum.dissipation(), sum.stored()};
  };
  return facts;
}

}  // namespace

MeasureSources::MeasureSources(const std::string& id, const Stage& stage) {
  runs_[id].facts = facts_of(stage);
}

void MeasureSources::read_run(const std::string& run) {
  const auto [entry, first] = runs_.try_emplace(run);
  if (!first) return;
  const Stage stage = store_->stage(run);
  entry->second.facts = facts_of(stage);
  for (const Ask& ask : asks_of(stage.memberships))
    entry->second.cadences.insert(ask.checkpoint_every);
  for (const Event& event : store_->events(run_stream(run), events::CheckpointPruned::kType)) {
    auto pruned = std::get<events::CheckpointPruned>(events::decode(event));
    if (pruned.measures.empty()) continue;
    Digests& all = entry->second.digests[pruned.checkpoint.sha256];
    pruned.measures.merge(all);  // if both events have a digest, keeps the later one
    all = std::move(pruned.measures);
  }
  if (!entry->second.facts.drive) return;
  for (CheckpointRecord& one : store_->checkpoints(run, Listed::and_pruned)) {
    const std::uint64_t step = one.step;
    entry->second.checkpoints.insert_or_assign(step, std::move(one));
  }
}

std::optional<bool> MeasureSources::is_as_pruned(const CheckpointRecord& record,
                                                 const DerivedObject& object) const {
  const auto& all = runs_.at(record.run).digests;
  const auto log = all.find(record.sha256);
  if (log == all.end()) return true;
  const auto [name, digest] = digest_entry(object);
  const auto found = log->second.find(name);
  return found == log->second.end() ? std::nullopt : std::optional(found->second == digest);
}

MeasureSources::PrunedMeasures MeasureSources::compare_pruned(const CheckpointRecord& record,
                                                              DerivedCache& cache) const {
  const auto& all = runs_.at(record.run).digests;
  const auto log = all.find(record.sha256);
  PrunedMeasures result;
  if (record.state != CheckpointState::pruned || log == all.end()) return result;
  const Digests cached = cache.digests(record.sha256, true);
  for (const auto& [name, digest] : log->second) {
    const auto now = cached.find(name);
    ++result.named;
    if (now == cached.end()) ++result.absent;
    if (now == cached.end() || now->second == digest) continue;
    result.altered = fmt::format(
        "{}: {} of checkpoint {:.12} (run {:.12}, cycle {:g}) does not have the digest that was "
        "logged when the checkpoint was pruned; restore derived.sqlite from a backup, or run "
        "`shearcell regenerate {:.12}`",
        DerivedCache::kFile, name, record.sha256, record.run, record.cycle, record.sha256);
  }
  return result;
}

DerivedKey MeasureSources::key(const CheckpointRecord& record, const Provider& provider,
                               std::uint64_t every) const {
  std::string text = provider.key();
  if (provider.cycles_back > 0) {
    const CheckpointRecord* other = earlier(record, provider, every);
    text += " " + (other == nullptr ? "none" : other->sha256);
  }
  return {record.sha256, std::move(text), analysis_version};
}

const CheckpointRecord* MeasureSources::earlier(const CheckpointRecord& record,
                                                const Provider& provider,
                                                std::uint64_t every) const {
  const auto run = runs_.find(record.run);
  if (run == runs_.end() || !run->second.facts.drive) return nullptr;
  const std::uint64_t steps = cycle_steps(*run->second.facts.drive);
  const std::uint64_t back = provider.cycles_back * steps;
  if (back == 0 || record.step < back) return nullptr;
  const std::uint64_t step = record.step - back;
  if (step % steps == 0 && step / steps % every != 0) return nullptr;
  const auto found = run->second.checkpoints.find(step);
  return found == run->second.checkpoints.end() ? nullptr : &found->second;
}

std::optional<nlohmann::json> MeasureSources::compute(
    const Provider& provider, const CheckpointRecord& record, std::uint64_t every,
    const Checkpoint* checkpoint, const Analysis* analysis, MeasureOutcome& unread) const {
  Checkpoint other;
  const auto load_earlier = [&]() -> const Checkpoint* {
    const CheckpointRecord* found = earlier(record, provider, every);
    if (found == nullptr) return nullptr;
    other = load(*found);
    return &other;
  };
  try {
    return provider.compute(
        {analysis, checkpoint, load_earlier, &record, &runs_.at(record.run).facts});
  } catch (const FilePruned& pruned) {
    unread.pruned.insert(pruned.what());
  } catch (const StoreDamaged& damage) {
    unread.damage.insert(damage.what());
  }
  return std::nullopt;
}

void MeasureSources::add_recorded(const CheckpointRecord& record, Measures& measures) const {
  MeasureOutcome none;
  for (const Provider& one : all_providers()) {
    if (one.from != ComputedFrom::record) continue;
    if (const auto result = compute(one, record, 1, nullptr, nullptr, none)) {
      one.read(*result, measures);
    }
  }
}

Measures MeasureSources::measures_of(const CheckpointRecord& record, std::uint64_t every,
                                     const Checkpoint& checkpoint, const Analysis& analysis,
                                     bool (*wanted)(const Provider&),
                                     MeasureOutcome& unread) const {
  Measures measures;
  for (const Provider& one : all_providers()) {
    if (!wanted(one)) continue;
    const auto result = compute(one, record, every, &checkpoint, &analysis, unread);
    if (result) one.read(*result, measures);
  }
  add_recorded(record, measures);
  return measures;
}

}  // namespace shearcell
