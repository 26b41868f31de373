// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/keep_measures.hpp"

#include <fcntl.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "experiments/figures/collect.hpp"
#include "provenance/derived.hpp"
#include "provenance/io/file.hpp"

namespace shearcell {
namespace {

/// Syncs the cache to the disk. DerivedCache itself does not sync, because lost measures can
/// usually be computed again. After a prune this is impossible.
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
  const std::vector<std::string> analyses = provider_names(
      [](const Provider& one) { return one.is_kept() && one.from != ComputedFrom::simulation; });
  std::vector<WantedFigure> simulating = wanted_figures(store).figures;
  std::erase_if(simulating, [](const WantedFigure& wanted) {
    return std::ranges::none_of(wanted.figure.needs, [](const std::string& name) {
      return provider(name).from == ComputedFrom::simulation;
    });
  });
  MeasureOutcome outcome;
  std::set<std::string> seen, unmeasured;  // seen: ids of runs; unmeasured: SHA-256 of checkpoints
  for (const CheckpointRecord& record : records) {
    if (!seen.insert(record.run).second) continue;
    Stage stage = store.stage(record.run);
    if (stage.memberships.empty())
      stage.memberships.emplace_back();  // damaged store: no experiment declared the stage
    std::vector<FrameRun> runs;          // one for each element of stage.memberships
    for (const auto& [place, ask, newest] : stage.memberships) {
      FrameRun& run = runs.emplace_back(FrameRun{{place, ask, stage}});
      for (CheckpointRecord& own : store.checkpoints(stage.id)) {
        run.checkpoints.push_back({std::move(own)});
      }
      for (const auto& [figure, experiment, also, manifests, plots] : simulating) {
        if (experiment != place.experiment) continue;
        // Measures that need a simulation are slow to compute. They are therefore computed only at
        // the cycles that figures show.
        MeasureOptions some = options;
        some.simulated = figure.simulated ? figure.simulated : figure.within;
        std::vector<std::string> names = figure.needs;
        names.insert(names.begin(), scalars_provider);
        std::vector<FrameRun> alone = {run};
        outcome += measure_runs(store, alone, names, some);
      }
    }
    outcome += measure_runs(store, runs, analyses, options);
    MeasureSources sources(store);
    sources.read_run(stage.id);
    for (const FrameRun& run : runs) {
      for (const CheckpointMeasures& one : run.checkpoints) {
        for (const std::string& name : one.lacking) {
          // The provider may need an earlier checkpoint. If that checkpoint is already pruned, as
          // can happen in a continued run, the measure cannot be computed, and keeping the file
          // of `one` would not help.
          const auto* earlier = sources.earlier(one, provider(name), run.ask.checkpoint_every);
          const bool lost = earlier != nullptr && earlier->state == CheckpointState::pruned;
          if (!lost) unmeasured.insert(one.sha256);
        }
      }
    }
  }
  std::erase_if(records, [&](const CheckpointRecord& c) {
    return !outcome.cache_trouble.empty() || unmeasured.contains(c.sha256);
  });
  if (!records.empty()) sync_cache(store);
  return outcome;
}

}  // namespace shearcell
