// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/measure.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <utility>

#include "analysis/error.hpp"
#include "experiments/figures/parallel_reads.hpp"
#include "provenance/derived.hpp"
#include "provenance/errors.hpp"

namespace shearcell {
namespace {

using nlohmann::json;
using Results = std::optional<std::vector<json>>;

// Results are kept in batches: one transaction each would take longer than a small analysis.
constexpr std::size_t kBatch = 64;

class Measuring {
 public:
  Measuring(const Store& store, std::span<const CheckpointRecord> records,
            std::span<const DerivedMeasure> measures, const MeasureOptions& options)
      : store_(store), measures_(measures), options_(options), cache_(store.folder()) {
    std::map<std::string_view, std::size_t> known;  // a run of two experiments comes twice
    for (const CheckpointRecord& record : records) {
      const auto [entry, fresh] = known.try_emplace(record.sha256, distinct_.size());
      if (fresh) distinct_.push_back(&record);
      place_.push_back(entry->second);
    }
    results_.resize(distinct_.size());
  }

  MeasuredCheckpoints run() {
    look_up();
    for (std::size_t i = 0; i < distinct_.size(); ++i) {
      if (options_.fresh || !results_[i]) todo_.push_back(i);
    }
    outcome_.kept = distinct_.size() - todo_.size();
    UnreadCheckpoints unread;
    try {
      unread = read_in_parallel(
          todo_.size(), options_.workers, [this](std::size_t n) { compute(todo_[n]); },
          options_.report);
    } catch (...) {
      keep();
      throw;
    }
    keep();
    outcome_.computed = todo_.size() - unread.damaged.size() - unread.pruned.size();
    outcome_.damage = std::move(unread.damaged);
    outcome_.pruned = std::move(unread.pruned);
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
        // Foreign bytes with a correct hash: computed again and replaced.
      }
    }
  }

  void compute(std::size_t i) {
    const Results before = std::exchange(results_[i], std::nullopt);
    Checkpoint checkpoint = store_.load_checkpoint(*distinct_[i]);
    if (options_.prepare) options_.prepare(*distinct_[i], checkpoint);
    const Analysis analysis = options_.instead ? Analysis() : analyse(checkpoint);
    std::vector<json> results;
    std::vector<DerivedObject> objects;
    std::vector<DerivedKey> names = keys(i);
    bool changed = false;
    for (std::size_t m = 0; m < measures_.size(); ++m) {
      results.push_back(options_.instead ? options_.instead(*distinct_[i], checkpoint)
                                         : measures_[m].from(analysis));
      objects.push_back({std::move(names[m]), encode_result(results[m])});
      changed = changed || (before && encode_result((*before)[m]) != objects[m].content);
    }
    results_[i] = std::move(results);
    const std::lock_guard lock(mutex_);
    if (changed) outcome_.changed.push_back(distinct_[i]->sha256);
    std::move(objects.begin(), objects.end(), std::back_inserter(pending_));
    if (pending_.size() >= kBatch) keep();
  }

  void keep() {
    if (!pending_.empty()) cache_.put(pending_);
    pending_.clear();
  }

  const Store& store_;
  const std::span<const DerivedMeasure> measures_;
  const MeasureOptions& options_;
  std::vector<const CheckpointRecord*> distinct_;
  std::vector<std::size_t> place_;  // of each record in distinct_
  std::vector<std::size_t> todo_;
  std::vector<Results> results_;  // of each checkpoint that is left; a thread writes only its own
  std::mutex mutex_;              // guards the members below while threads run
  DerivedCache cache_;
  std::vector<DerivedObject> pending_;
  MeasuredCheckpoints outcome_;
};

}  // namespace

MechanicalUnits mechanical_units(const RunRecord& run, const CheckpointRecord& checkpoint) {
  const json none = json::object();
  const auto parameters = run.resolved.find("parameters");
  const json& known =
      parameters != run.resolved.end() && parameters->is_object() ? *parameters : none;
  const auto number = [&](const char* key) {
    const auto found = known.find(key);
    return found != known.end() && found->is_number() ? found->get<double>() : std::nan("");
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
