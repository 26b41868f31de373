// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/derive.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <map>
#include <mutex>

#include "analysis/error.hpp"
#include "core/threads.hpp"
#include "provenance/derived.hpp"
#include "provenance/errors.hpp"

namespace shearcell {
namespace {

using nlohmann::json;
using Results = std::optional<std::vector<json>>;

// Results are kept in batches: one transaction each would take longer than a small analysis.
constexpr std::size_t kBatch = 64;

class Deriving {
 public:
  Deriving(const Store& store, std::span<const CheckpointRecord> records,
           std::span<const DerivedMeasure> measures, const DeriveOptions& options)
      : store_(store), measures_(measures), options_(options), cache_(store.folder()) {
    std::map<std::string_view, std::size_t> known;  // a run that two experiments share comes twice
    for (const CheckpointRecord& record : records) {
      const auto [entry, fresh] = known.try_emplace(record.sha256, distinct_.size());
      if (fresh) distinct_.push_back(&record);
      place_.push_back(entry->second);
    }
    results_.resize(distinct_.size());
  }

  Derived run() {
    look_up();
    for (std::size_t i = 0; i < distinct_.size(); ++i) {
      if (options_.fresh || !results_[i]) todo_.push_back(i);
    }
    outcome_.kept = distinct_.size() - todo_.size();
    {
      const auto threads = start_threads(std::min<std::size_t>(options_.workers, todo_.size()),
                                         [this](std::size_t) { compute_some(); });
      compute_some();
    }
    keep();
    if (error_) std::rethrow_exception(error_);
    std::sort(outcome_.damage.begin(), outcome_.damage.end());
    std::sort(outcome_.pruned.begin(), outcome_.pruned.end());
    std::sort(outcome_.changed.begin(), outcome_.changed.end());
    const bool distinct = place_.size() == distinct_.size();
    for (const std::size_t i : place_) {
      outcome_.results.push_back(distinct ? std::move(results_[i]) : results_[i]);
    }
    outcome_.trouble = cache_.trouble();
    return std::move(outcome_);
  }

 private:
  std::vector<DerivedKey> keys(std::size_t i) const {
    std::vector<DerivedKey> list;
    for (const DerivedMeasure& measure : measures_) {
      list.push_back({distinct_[i]->sha256, measure.key(), analysis_version});
    }
    return list;
  }

  void look_up() {
    std::vector<DerivedKey> all;
    for (std::size_t i = 0; i < distinct_.size(); ++i) {
      for (DerivedKey& key : keys(i)) all.push_back(std::move(key));
    }
    const auto found = cache_.get(all);
    for (std::size_t i = 0; i < distinct_.size(); ++i) {
      try {
        std::vector<json> results;
        for (std::size_t m = 0; m < measures_.size(); ++m) {
          const auto& content = found[i * measures_.size() + m];
          if (content) results.push_back(decode_result(*content));
        }
        if (results.size() == measures_.size()) results_[i] = std::move(results);
      } catch (const AnalysisError&) {
        // Somebody else's bytes under a right hash: computed again and replaced.
      }
    }
  }

  void compute_some() {
    for (std::size_t next = next_++; next < todo_.size(); next = next_++) {
      const std::size_t i = todo_[next];
      try {
        take(i, compute(*distinct_[i]));
      } catch (const StoreDamaged& error) {
        const std::lock_guard lock(mutex_);
        results_[i].reset();
        outcome_.damage.emplace_back(error.what());
      } catch (const CheckpointPruned& error) {
        const std::lock_guard lock(mutex_);
        results_[i].reset();
        outcome_.pruned.emplace_back(error.what());
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (!error_) error_ = std::current_exception();
        return;
      }
    }
  }

  std::vector<json> compute(const CheckpointRecord& record) const {
    const Analysis analysis = analyse(store_.load_checkpoint(record));
    std::vector<json> results;
    for (const DerivedMeasure& measure : measures_) results.push_back(measure.from(analysis));
    return results;
  }

  void take(std::size_t i, std::vector<json> results) {
    std::vector<DerivedObject> objects;
    std::vector<DerivedKey> names = keys(i);
    bool changed = false;
    for (std::size_t m = 0; m < results.size(); ++m) {
      objects.push_back({std::move(names[m]), encode_result(results[m])});
      changed = changed || (results_[i] && encode_result((*results_[i])[m]) != objects[m].content);
    }
    const std::lock_guard lock(mutex_);
    results_[i] = std::move(results);
    if (changed) outcome_.changed.push_back(distinct_[i]->sha256);
    std::move(objects.begin(), objects.end(), std::back_inserter(pending_));
    ++outcome_.computed;
    if (pending_.size() >= kBatch) keep();
    if (options_.report) options_.report(outcome_.computed, todo_.size());
  }

  void keep() {
    if (!pending_.empty()) cache_.put(pending_);
    pending_.clear();
  }

  const Store& store_;
  const std::span<const DerivedMeasure> measures_;
  const DeriveOptions& options_;
  std::vector<const CheckpointRecord*> distinct_;
  std::vector<std::size_t> place_;  // of each record in distinct_
  std::vector<std::size_t> todo_;
  std::atomic<std::size_t> next_{0};
  std::mutex mutex_;  // guards what follows while threads run
  DerivedCache cache_;
  std::vector<Results> results_;
  std::vector<DerivedObject> pending_;
  Derived outcome_;
  std::exception_ptr error_;
};

}  // namespace

Derived derive(const Store& store, std::span<const CheckpointRecord> records,
               std::span<const DerivedMeasure> measures, const DeriveOptions& options) {
  return Deriving(store, records, measures, options).run();
}

}  // namespace shearcell
