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

/// Whether the provider needs a file that was pruned before. Such a measure was lost then, as where
/// a pruned run was continued.
bool needs_a_pruned_file(const MeasureSources& sources, const CheckpointRecord& record,
                         std::uint64_t every, const Provider& provider) {
  const CheckpointRecord* earlier = sources.earlier(record, provider, every);
  return earlier != nullptr && earlier->state == CheckpointState::pruned;
}

/// The figures that the store's manifests list and that need simulations, by experiment.
std::map<std::string, std::vector<Figure>> simulating_figures(const Store& store) {
  std::map<std::string, std::vector<Figure>> figures;
  for (WantedFigure& wanted : wanted_figures(store).figures) {
    if (std::ranges::none_of(wanted.figure.needs, is_simulated)) continue;
    figures[wanted.experiment].push_back(std::move(wanted.figure));
  }
  return figures;
}

/// Writes the cache to the disk. DerivedCache does not, because measures can be recomputed; after a
/// prune they cannot.
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
  std::vector<std::string> analyses;
  for (const Provider& one : all_providers()) {
    if (one.is_kept() && !is_simulated(one.name)) analyses.push_back(one.name);
  }
  std::map<std::string, std::vector<Figure>> simulating = simulating_figures(store);
  MeasureOutcome outcome;
  std::set<std::string> unmeasured;  // SHA-256
  std::vector<FrameRun> batch;
  const auto measure_batch = [&] {
    measure_runs(store, batch, analyses, options, outcome);
    MeasureSources sources(store);
    for (const FrameRun& run : batch) {
      sources.read_run(run.stage.id);
      for (const CheckpointMeasures& one : run.checkpoints) {
        for (const std::string& name : one.lacking) {
          if (needs_a_pruned_file(sources, one, run.ask.checkpoint_every, provider(name))) continue;
          unmeasured.insert(one.sha256);
        }
      }
    }
    batch.clear();
  };
  std::set<std::string> seen;
  std::size_t in_batch = 0;
  for (const CheckpointRecord& record : records) {
    if (!seen.insert(record.run).second) continue;
    Stage stage = store.stage(record.run);
    if (stage.memberships.empty())
      stage.memberships.emplace_back();  // no experiment of a damaged store has it
    std::set<std::uint64_t> cadences;
    for (const auto& [place, ask, newest] : stage.memberships) {
      FrameRun run{{place, ask, stage}};
      for (CheckpointRecord& own : store.checkpoints(stage.id)) {
        run.checkpoints.push_back({std::move(own)});
      }
      for (const Figure& figure : simulating[place.experiment]) {
        // Only of the cycles that figures take, since a simulation takes longer than an analysis.
        MeasureOptions some = options;
        some.simulated = figure.simulated ? figure.simulated : figure.within;
        std::vector<std::string> names = figure.needs;
        names.insert(names.begin(), "scalars");
        std::vector<FrameRun> alone = {run};
        measure_runs(store, alone, names, some, outcome);
      }
      if (!cadences.insert(ask.checkpoint_every).second) continue;
      in_batch += run.checkpoints.size();
      batch.push_back(std::move(run));
    }
    if (in_batch < kAtOnce) continue;
    measure_batch();
    in_batch = 0;
  }
  measure_batch();
  std::erase_if(records, [&](const CheckpointRecord& c) {
    return !outcome.cache_trouble.empty() || unmeasured.contains(c.sha256);
  });
  if (!records.empty()) sync_cache(store);
  return outcome;
}

}  // namespace shearcell
