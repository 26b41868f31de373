// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/keep_measures.hpp"

#include <fcntl.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "experiments/figures/collect.hpp"
#include "experiments/runner/measure_sources.hpp"
#include "provenance/derived.hpp"
#include "provenance/io/file.hpp"

namespace shearcell {
namespace {

constexpr std::size_t kAtOnce = 500;  // a batch is measured when it has this many checkpoints

/// Whether the provider needs the file of an earlier checkpoint that is already pruned, for example
/// because a pruned run was continued. In this case the measure was lost with the earlier file.
bool needs_a_pruned_file(const MeasureSources& sources, const CheckpointRecord& record,
                         std::uint64_t every, const Provider& provider) {
  const CheckpointRecord* earlier = sources.earlier(record, provider, every);
  return earlier != nullptr && earlier->state == CheckpointState::pruned;
}

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
  std::set<std::string> unmeasured;  // SHA-256
  std::vector<FrameRun> batch;
  std::size_t in_batch = 0;  // checkpoints
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
    in_batch = 0;
  };
  std::set<std::string> seen;
  for (const CheckpointRecord& record : records) {
    if (!seen.insert(record.run).second) continue;
    Stage stage = store.stage(record.run);
    if (stage.memberships.empty())
      stage.memberships.emplace_back();  // damaged store: no experiment declared the stage
    for (const auto& [place, ask, newest] : stage.memberships) {
      FrameRun run{{place, ask, stage}};
      for (CheckpointRecord& own : store.checkpoints(stage.id)) {
        run.checkpoints.push_back({std::move(own)});
      }
      in_batch += run.checkpoints.size();
      batch.push_back(run);
      for (const auto& [figure, experiment, also, manifests] : simulating) {
        if (experiment != place.experiment) continue;
        // Simulations are slow, so only the cycles that figures show are simulated.
        MeasureOptions some = options;
        some.simulated = figure.simulated ? figure.simulated : figure.within;
        std::vector<std::string> names = figure.needs;
        names.insert(names.begin(), scalars_provider);
        std::vector<FrameRun> alone = {run};
        measure_runs(store, alone, names, some, outcome);
      }
    }
    if (in_batch >= kAtOnce) measure_batch();
  }
  measure_batch();
  std::erase_if(records, [&](const CheckpointRecord& c) {
    return !outcome.cache_trouble.empty() || unmeasured.contains(c.sha256);
  });
  if (!records.empty()) sync_cache(store);
  return outcome;
}

}  // namespace shearcell
