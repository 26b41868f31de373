// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <iterator>
#include <mutex>
#include <utility>

#include "core/drive.hpp"
#include "core/threads.hpp"
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

using nlohmann::json;

// Results are cached in batches, because writing to the cache takes longer than a small analysis.
constexpr std::size_t kBatch = 64;

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

class Measuring {
 public:
  Measuring(const Store& store, std::span<const ToMeasure> checkpoints,
            std::span<const std::string> names, const MeasureOptions& options)
      : checkpoints_(checkpoints), sources_(store), options_(options), cache_(store.folder()) {
    for (const std::string& name : names) add(provider(name));
    wanted_ = providers_.size();
    for (const std::string& name : options.also) add(provider(name));
    // `checkpoints` lists a checkpoint twice if two experiments share it.
    std::map<std::pair<std::string_view, std::uint64_t>, std::size_t> known;
    for (const ToMeasure& one : checkpoints) {
      const std::pair which = {std::string_view(one.checkpoint->sha256), one.every};
      const auto [entry, fresh] = known.try_emplace(which, tasks_.size());
      place_.push_back(entry->second);
      sources_.read_run(one.checkpoint->run);
      if (!fresh) continue;
      tasks_.push_back({one});
      for (const Provider* each : providers_) {
        keys_.push_back(sources_.key(*one.checkpoint, *each, one.every));
      }
    }
  }

  MeasureOutcome run() {
    const std::vector<Task*> todo = look_up();
    try {
      outcome_ += read_in_parallel(
          todo.size(), options_.workers, [&](std::size_t n) { compute(*todo[n]); },
          options_.report);
    } catch (...) {
      flush();
      throw;
    }
    flush();
    for (std::size_t k = 0; k < place_.size(); ++k) {
      read(*checkpoints_[k].checkpoint, tasks_[place_[k]].results);
    }
    outcome_.cache_trouble = cache_.trouble();
    return std::move(outcome_);
  }

 private:
  /// A checkpoint to measure. Entries of checkpoints_ that have the same checkpoint and the same
  /// value of `every` share one task. `keys` and `results` have one element per provider. A result
  /// is null until it is known.
  struct Task : ToMeasure {
    std::span<const DerivedKey> keys = {};  // in keys_
    std::vector<json> results = {};
  };

  void add(const Provider& one) {
    const bool listed = std::ranges::find(providers_, &one) != providers_.end();
    if (one.is_kept() && !listed) providers_.push_back(&one);
  }

  /// Whether the provider computes a result for this checkpoint.
  bool takes(const CheckpointRecord& record, const Provider& one) const {
    if (one.from != ComputedFrom::simulation || !options_.simulated) return true;
    const auto [first, last] = *options_.simulated;
    return record.cycle >= static_cast<double>(first) && record.cycle <= static_cast<double>(last);
  }

  /// Takes the results that the cache has. Returns the tasks that lack a requested result.
  std::vector<Task*> look_up() {
    std::vector<Task*> todo;
    const auto found = cache_.get(keys_);  // in one transaction
    for (std::size_t k = 0; k < tasks_.size(); ++k) {
      Task& task = tasks_[k];
      const std::size_t first = k * providers_.size();
      task.keys = std::span(keys_).subspan(first, providers_.size());
      take(task, std::span(found).subspan(first, providers_.size()));
      const auto wanted = std::span(task.results).first(wanted_);
      const bool is_missing = std::ranges::any_of(wanted, &json::is_null);
      if (is_missing && !options_.only_cached) todo.push_back(&task);
    }
    return todo;
  }

  /// `found`: the cached object of each key of the task, if there is one.
  void take(Task& task, std::span<const std::optional<std::vector<std::byte>>> found) {
    const CheckpointRecord& record = *task.checkpoint;
    const bool is_pruned = record.state == CheckpointState::pruned;
    if (is_pruned && !cache_.trouble().empty()) {
      const std::string why =
          cache_.trouble() + "; the measures of pruned checkpoints are only in derived.sqlite";
      if (cache_.is_unread()) throw MachineError(why);
      throw StoreDamaged(why);
    }
    const auto pruned = sources_.compare_pruned(record, cache_);
    for (const std::string& damage : {pruned.altered, pruned.absent > 0 ? cache_.replaced() : ""}) {
      if (!damage.empty()) outcome_.damage.insert(damage);
    }
    for (std::size_t p = 0; p < providers_.size(); ++p) {
      json& result = task.results.emplace_back();
      if (!takes(record, *providers_[p])) {
        result = json::object();  // an empty result
        continue;
      }
      const CheckpointRecord* other = sources_.earlier(record, *providers_[p], task.every);
      if (other != nullptr) outcome_.earlier.insert(other->sha256);
      // If the log has digests of other results of this checkpoint, but none of this result, only
      // the checkpoint's file can confirm the result. So the result is not used after pruning.
      if (!found[p] ||
          !sources_.is_as_pruned(record, {task.keys[p], *found[p]}).value_or(!is_pruned)) {
        continue;
      }
      try {
        result = decode_result(*found[p]);
      } catch (const AnalysisError&) {
        // The hash matches, but the bytes are not a result: the result is recomputed and replaced.
      }
    }
  }

  void compute(Task& task) {
    const CheckpointRecord& record = *task.checkpoint;
    const Checkpoint checkpoint = sources_.load(record);
    std::optional<Analysis> analysis;  // computed once, if a provider needs it
    std::vector<DerivedObject> objects;
    MeasureOutcome unread;
    for (std::size_t p = 0; p < providers_.size(); ++p) {
      if (!task.results[p].is_null()) continue;
      const bool analyses = providers_[p]->from != ComputedFrom::simulation;
      if (analyses && !analysis) analysis = analyse_stored(record, checkpoint);
      auto result = sources_.compute(*providers_[p], record, task.every, &checkpoint,
                                     analysis ? &*analysis : nullptr, unread);
      if (!result) continue;
      objects.push_back({task.keys[p], encode_result(*result)});
      task.results[p] = std::move(*result);
    }
    const std::lock_guard lock(mutex_);
    outcome_.measured.insert(record.sha256);
    outcome_ += unread;
    std::move(objects.begin(), objects.end(), std::back_inserter(pending_));
    if (pending_.size() >= kBatch) flush();
  }

  void flush() {
    if (!pending_.empty()) cache_.put(pending_);
    pending_.clear();
  }

  void read(CheckpointMeasures& one, const std::vector<json>& results) try {
    const auto none = [](const Provider&) { return false; };
    one.measures = sources_.measures_of(one, 1, nullptr, nullptr, none, outcome_);
    one.lacking.clear();
    for (std::size_t p = 0; p < wanted_; ++p) {
      if (results[p].is_null()) {
        one.lacking.push_back(providers_[p]->name);
      } else {
        providers_[p]->read(results[p], one.measures);
      }
    }
  } catch (const AnalysisError& problem) {
    throw StoreDamaged(
        fmt::format("{} holds a wrong result ({}); `shearcell regenerate {:.12}` "
                    "deletes the results of this checkpoint, and the next command "
                    "computes them again",
                    DerivedCache::kFile, problem.what(), one.sha256));
  }

  const std::span<const ToMeasure> checkpoints_;
  MeasureSources sources_;
  const MeasureOptions& options_;
  std::vector<const Provider*> providers_;  // the requested providers, then MeasureOptions::also
  std::size_t wanted_ = 0;                  // number of requested providers (without `also`)
  std::vector<Task> tasks_;                 // the results of a task are written by one thread
  std::vector<DerivedKey> keys_;    // one per provider for tasks_[0], then for tasks_[1], ...
  std::vector<std::size_t> place_;  // for each checkpoint, its index in tasks_
  std::mutex mutex_;                // guards the members below while threads run
  DerivedCache cache_;
  std::vector<DerivedObject> pending_;
  MeasureOutcome outcome_;
};

}  // namespace

MeasureOutcome& MeasureOutcome::operator+=(const MeasureOutcome& more) {
  damage.insert(more.damage.begin(), more.damage.end());
  pruned.insert(more.pruned.begin(), more.pruned.end());
  measured.insert(more.measured.begin(), more.measured.end());
  earlier.insert(more.earlier.begin(), more.earlier.end());
  if (!more.cache_trouble.empty()) cache_trouble = more.cache_trouble;
  return *this;
}

MeasureOutcome read_in_parallel(std::size_t count, std::size_t workers,
                                const std::function<void(std::size_t)>& work,
                                const ReadProgress& progress) {
  MeasureOutcome unread;
  std::exception_ptr error;
  std::size_t done = 0;
  std::mutex mutex;  // guards unread, error and done
  std::atomic<std::size_t> next{0};
  const auto work_on_some = [&](std::size_t) {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        work(i);
      } catch (const StoreDamaged& damage) {
        const std::lock_guard lock(mutex);
        unread.damage.insert(damage.what());
      } catch (const FilePruned& pruned) {
        const std::lock_guard lock(mutex);
        unread.pruned.insert(pruned.what());
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!error) error = std::current_exception();
        next = count;
      }
      const std::lock_guard lock(mutex);
      ++done;
      if (progress) progress(done, count);
    }
  };
  {
    const auto threads = start_threads(std::min(workers, count), work_on_some);
    work_on_some(0);
  }
  if (error) std::rethrow_exception(error);
  return unread;
}

Analysis analyse_stored(const CheckpointRecord& record, const Checkpoint& checkpoint) {
  try {
    return analyse(checkpoint);
  } catch (const AnalysisError& problem) {
    throw StoreDamaged(fmt::format("checkpoint {:.12} of run {:.12} (cycle {}): {}", record.sha256,
                                   record.run, record.cycle, problem.what()));
  }
}

MeasureOutcome measure_checkpoints(const Store& store, std::span<const ToMeasure> checkpoints,
                                   std::span<const std::string> providers,
                                   const MeasureOptions& options) {
  if (checkpoints.empty()) return {};
  return Measuring(store, checkpoints, providers, options).run();
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
    pruned.measures.merge(all);  // digests from later events replace earlier ones
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
  const auto run = runs_.find(record.run);
  if (run == runs_.end()) return true;
  const auto log = run->second.digests.find(record.sha256);
  if (log == run->second.digests.end()) return true;
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

Measures MeasureSources::measures_of(const CheckpointRecord& record, std::uint64_t every,
                                     const Checkpoint* checkpoint, const Analysis* analysis,
                                     bool (*wanted)(const Provider&),
                                     MeasureOutcome& unread) const {
  Measures measures;
  for (const Provider& one : all_providers()) {
    if (one.from != ComputedFrom::record && !wanted(one)) continue;
    const auto result = compute(one, record, every, checkpoint, analysis, unread);
    if (result) one.read(*result, measures);
  }
  return measures;
}

}  // namespace shearcell
