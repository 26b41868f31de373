// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/keep_measures.hpp"

#include <fcntl.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "experiments/figures/collect.hpp"
#include "experiments/runner/measure_sources.hpp"
#include "provenance/derived.hpp"
#include "provenance/io/file.hpp"

namespace shearcell {
namespace {

constexpr std::size_t kAtOnce = 500;  // checkpoints whose results are in memory at a time

bool is_simulated(const std::string& name) {
  return provider(name).from == ComputedFrom::simulation;
}

/// All but the simulated ones.
std::vector<std::string> analysing_providers() {
  std::vector<std::string> names;
  for (const Provider& one : all_providers()) {
    if (one.is_kept() && !is_simulated(one.name)) names.push_back(one.name);
  }
  return names;
}

/// Measures checkpoints of whole runs in batches.
class Keeping {
 public:
  Keeping(const Store& store, const MeasureOptions& options) : store_(store), options_(options) {
    for (const WantedFigure& wanted : wanted_figures(store).figures) {
      if (std::ranges::any_of(wanted.figure.needs, is_simulated)) {
        simulating_[wanted.experiment].push_back(wanted.figure);
      }
    }
  }

  /// For the experiments that ask for a checkpoint every so many cycles.
  void measure(const std::set<std::string>& runs, std::uint64_t every) {
    MeasureOptions options = options_;
    std::vector<CheckpointRecord> batch;
    for (auto run = runs.begin(); run != runs.end();) {
      options.cadence[*run] = every;
      const std::vector<CheckpointRecord> own = store_.checkpoints(*run);
      batch.insert(batch.end(), own.begin(), own.end());
      simulate(*run, own, options);
      if (++run != runs.end() && batch.size() < kAtOnce) continue;
      take(measure_checkpoints(store_, batch, analysing_providers(), options), batch,
           MeasureSources(store_, options.cadence));
      batch.clear();
    }
  }

  bool lacks_a_measure(const CheckpointRecord& record) const {
    return !outcome_.cache_trouble.empty() || unmeasured_.contains(record.sha256);
  }
  MeasureOutcome outcome() && { return std::move(outcome_); }

 private:
  void take(const MeasuredCheckpoints& found, const std::vector<CheckpointRecord>& records,
            MeasureSources sources) {
    for (std::size_t k = 0; k < records.size(); ++k) {
      for (const std::string& name : found.lacking[k]) {
        if (!needs_a_pruned_file(records[k], provider(name), sources)) {
          unmeasured_.insert(records[k].sha256);
        }
      }
    }
    take(found);
  }

  /// Such a measure was lost before, as where a pruned run was continued.
  static bool needs_a_pruned_file(const CheckpointRecord& record, const Provider& provider,
                                  MeasureSources& sources) {
    sources.read_run(record.run);
    return std::ranges::any_of(provider.earlier, [&](std::uint64_t cycles) {
      const CheckpointRecord* earlier = sources.find(record, cycles);
      return earlier != nullptr && earlier->state == CheckpointState::pruned;
    });
  }

  void take(const MeasureOutcome& found) {
    outcome_.measured += found.measured;
    add_unread(found, outcome_);
    if (!found.cache_trouble.empty()) outcome_.cache_trouble = found.cache_trouble;
  }

  /// Only of the cycles that figures take, since a simulation takes longer than an analysis.
  void simulate(const std::string& run, const std::vector<CheckpointRecord>& records,
                const MeasureOptions& options) {
    for (const Ask& m : store_.stage(run).asks) {
      for (const Figure& figure : simulating_[m.experiment]) {
        MeasureOptions some = options;
        some.simulated = figure.simulated ? figure.simulated : figure.within;
        std::vector<std::string> names = figure.needs;
        names.insert(names.begin(), "scalars");
        take(measure_checkpoints(store_, records, names, some));
      }
    }
  }

  const Store& store_;
  MeasureOptions options_;
  std::map<std::string, std::vector<Figure>> simulating_;  // figures, by experiment
  std::set<std::string> unmeasured_;                       // SHA-256
  MeasureOutcome outcome_;
};

/// The cache itself is not synced, since it can be computed again; not after a prune.
void sync_cache(const Store& store) {
  const std::filesystem::path file = store.folder() / DerivedCache::kFile;
  for (const std::filesystem::path& path : {file, store.folder()}) {
    const Descriptor open_file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (!open_file.valid()) fail_on(path, "open");
    sync(open_file, path);
  }
}

}  // namespace

MeasureOutcome keep_measures(const Store& store, std::vector<CheckpointRecord>& records,
                             const MeasureOptions& options) {
  std::map<std::uint64_t, std::set<std::string>> runs;  // by cadence
  std::set<std::string> seen;
  for (const CheckpointRecord& record : records) {
    if (!seen.insert(record.run).second) continue;
    const std::vector<Ask> asks = store.stage(record.run).asks;
    for (const Ask& m : asks) runs[m.checkpoint_every].insert(record.run);
    if (asks.empty()) runs[1].insert(record.run);  // no experiment of a damaged store has it
  }
  Keeping keeping(store, options);
  for (const auto& [every, of_cadence] : runs) keeping.measure(of_cadence, every);
  std::erase_if(records, [&](const CheckpointRecord& c) { return keeping.lacks_a_measure(c); });
  if (!records.empty()) sync_cache(store);
  return std::move(keeping).outcome();
}

}  // namespace shearcell
