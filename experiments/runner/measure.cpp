// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <iterator>
#include <map>
#include <mutex>
#include <utility>

#include "analysis/error.hpp"
#include "core/threads.hpp"
#include "experiments/runner/measure_sources.hpp"
#include "provenance/derived.hpp"
#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {
namespace {

using nlohmann::json;
using Results = std::vector<json>;

// Results are cached in batches: one transaction each would take longer than a small analysis.
constexpr std::size_t kBatch = 64;

class Measuring {
 public:
  Measuring(const Store& store, std::span<const CheckpointRecord> records,
            std::span<const DerivedMeasure> measures, const MeasureOptions& options)
      : store_(store),
        sources_(store, options.cadence),
        measures_(measures),
        options_(options),
        cache_(store.folder()) {
    std::map<std::string_view, std::size_t> known;  // a run of two experiments is listed twice
    for (const CheckpointRecord& record : records) {
      const auto [entry, fresh] = known.try_emplace(record.sha256, distinct_.size());
      if (fresh) distinct_.push_back(&record);
      place_.push_back(entry->second);
    }
    for (const std::string& name : options.also) {
      const bool listed = std::ranges::count(measures_, name, &DerivedMeasure::name) > 0;
      if (!listed && !options.fresh && !options.instead) also_.push_back(&derived_measure(name));
    }
    for (const CheckpointRecord* record : distinct_) {
      for (const DerivedMeasure* one : also_) also_keys_.push_back(sources_.key(*record, *one));
      for (const DerivedMeasure& measure : measures_) {
        keys_.push_back(sources_.key(*record, measure));
        for (const std::uint64_t cycles : measure.earlier) {
          const CheckpointRecord* other = sources_.find(*record, cycles);
          if (other != nullptr) outcome_.earlier[other->run].emplace(other->step, other->sha256);
        }
      }
    }
    results_.assign(distinct_.size(), Results(measures_.size()));
  }

  MeasuredCheckpoints run() {
    look_up();
    for (std::size_t i = 0; i < distinct_.size(); ++i) {
      const bool lacks = std::ranges::any_of(results_[i], &json::is_null);
      // A pruned checkpoint cannot be measured again.
      const bool again = options_.fresh && distinct_[i]->state != CheckpointState::pruned;
      if (again || lacks) todo_.push_back(i);
    }
    outcome_.cached = distinct_.size() - todo_.size();
    UnreadCheckpoints& unread = outcome_;
    try {
      unread = read_in_parallel(
          todo_.size(), options_.workers, [this](std::size_t n) { compute(todo_[n]); },
          options_.report);
    } catch (...) {
      flush();
      throw;
    }
    flush();
    outcome_.measured = todo_.size() - unread.damage.size() - unread.pruned.size();
    add_unread(unread_earlier_, outcome_);
    std::sort(outcome_.changed.begin(), outcome_.changed.end());
    const bool distinct = place_.size() == distinct_.size();
    for (const std::size_t i : place_) {
      outcome_.results.push_back(distinct ? std::move(results_[i]) : results_[i]);
    }
    outcome_.cache_trouble = cache_.trouble();
    return std::move(outcome_);
  }

 private:
  void look_up() {
    const auto found = cache_.get(keys_);
    for (std::size_t k = 0; k < keys_.size(); ++k) {
      if (!found[k]) continue;
      try {
        results_[k / measures_.size()][k % measures_.size()] = decode_result(*found[k]);
      } catch (const AnalysisError&) {
        // Foreign bytes with a correct hash: computed again and replaced.
      }
    }
  }

  void compute(std::size_t i) {
    const CheckpointRecord& record = *distinct_[i];
    const Results before =
        options_.fresh ? std::exchange(results_[i], Results(measures_.size())) : results_[i];
    const Checkpoint checkpoint = store_.load_checkpoint(record);
    const Analysis analysis = options_.instead ? Analysis() : analyse_stored(record, checkpoint);
    std::vector<DerivedObject> objects;
    UnreadCheckpoints unread;
    bool changed = false;
    for (std::size_t m = 0; m < measures_.size(); ++m) {
      if (!results_[i][m].is_null()) continue;
      auto result = options_.instead
                        ? std::optional(options_.instead(record, checkpoint))
                        : sources_.measure(record, checkpoint, analysis, measures_[m], unread);
      if (!result) {
        results_[i][m] = before[m];
        continue;
      }
      objects.push_back({keys_[i * measures_.size() + m], encode_result(*result)});
      const bool known = !before[m].is_null();
      changed = changed || (known && encode_result(before[m]) != objects.back().content);
      results_[i][m] = std::move(*result);
    }
    for (std::size_t m = 0; m < also_.size(); ++m) {
      const auto result = sources_.measure(record, checkpoint, analysis, *also_[m], unread);
      if (result) objects.push_back({also_keys_[i * also_.size() + m], encode_result(*result)});
    }
    const std::lock_guard lock(mutex_);
    std::ranges::move(unread.damage, std::back_inserter(unread_earlier_.damage));
    std::ranges::move(unread.pruned, std::back_inserter(unread_earlier_.pruned));
    if (changed) outcome_.changed.push_back(record.sha256);
    std::move(objects.begin(), objects.end(), std::back_inserter(pending_));
    if (pending_.size() >= kBatch) flush();
  }

  void flush() {
    if (!pending_.empty()) cache_.put(pending_);
    pending_.clear();
  }

  const Store& store_;
  MeasureSources sources_;
  const std::span<const DerivedMeasure> measures_;
  const MeasureOptions& options_;
  std::vector<const CheckpointRecord*> distinct_;
  std::vector<std::size_t> place_;  // of each record in distinct_
  std::vector<DerivedKey> keys_;    // of each in distinct_, in the order of the measures
  std::vector<const DerivedMeasure*> also_;
  std::vector<DerivedKey> also_keys_;  // of each in distinct_, in the order of also_
  std::vector<std::size_t> todo_;
  std::vector<Results> results_;  // of each checkpoint that is left; a thread writes only its own
  std::mutex mutex_;              // guards the members below while threads run
  DerivedCache cache_;
  std::vector<DerivedObject> pending_;
  MeasuredCheckpoints outcome_;
  UnreadCheckpoints unread_earlier_;
};

}  // namespace

void add_unread(const UnreadCheckpoints& more, UnreadCheckpoints& all) {
  for (const auto lines : {&UnreadCheckpoints::damage, &UnreadCheckpoints::pruned}) {
    (all.*lines).insert((all.*lines).end(), (more.*lines).begin(), (more.*lines).end());
    std::ranges::sort(all.*lines);
    (all.*lines).erase(std::unique((all.*lines).begin(), (all.*lines).end()), (all.*lines).end());
  }
}

UnreadCheckpoints read_in_parallel(std::size_t count, std::size_t workers,
                                   const std::function<void(std::size_t)>& work,
                                   const ReadProgress& progress) {
  UnreadCheckpoints unread;
  std::exception_ptr error;
  std::size_t done = 0;
  std::mutex mutex;  // guards the three above
  std::atomic<std::size_t> next{0};
  const auto work_on_some = [&](std::size_t) {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        work(i);
      } catch (const StoreDamaged& damage) {
        const std::lock_guard lock(mutex);
        unread.damage.emplace_back(damage.what());
      } catch (const FilePruned& pruned) {
        const std::lock_guard lock(mutex);
        unread.pruned.emplace_back(pruned.what());
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
  std::sort(unread.damage.begin(), unread.damage.end());
  std::sort(unread.pruned.begin(), unread.pruned.end());
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

Measures read_results(std::span<const DerivedMeasure> measures, std::span<const json> results) {
  Measures found;
  try {
    for (std::size_t m = 0; m < measures.size(); ++m) {
      if (!results[m].is_null()) measures[m].read(results[m], found);
    }
  } catch (const AnalysisError& problem) {
    throw AnalysisError(std::string(DerivedCache::kFile) + " holds something else (" +
                        problem.what() + "); delete it, or measure again with --fresh");
  }
  return found;
}

MechanicalUnits mechanical_units(const RunRecord& run, const CheckpointRecord& checkpoint) {
  const json known = member_of(run.resolved, "parameters");
  const auto number = [&](const char* key) {
    const json found = member_of(known, key);
    return found.is_number() ? found.get<double>() : std::nan("");
  };
  const auto raised = checkpoint.observables.find("stiffness_N_per_m");
  return mechanical_units(
      raised == checkpoint.observables.end() ? number("stiffness_N_per_m") : raised->second,
      number("mass_kg"), number("diameter_m"), number("gravity_m_per_s2"));
}

MeasuredCheckpoints measure_checkpoints(const Store& store,
                                        std::span<const CheckpointRecord> records,
                                        std::span<const DerivedMeasure> measures,
                                        const MeasureOptions& options) {
  return Measuring(store, records, measures, options).run();
}

}  // namespace shearcell
