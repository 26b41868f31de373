// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/audit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <map>
#include <random>
#include <utility>

#include "analysis/measures.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/runner/measure.hpp"
#include "experiments/runner/stage.hpp"
#include "provenance/derived.hpp"
#include "provenance/errors.hpp"
#include "provenance/events.hpp"
#include "provenance/json_text.hpp"
#include "provenance/lineage.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

void require_same(const std::string& what, const json& recorded, const json& expected) {
  if (recorded == expected) return;
  throw StoreDamaged(fmt::format("its event has {} = {}, but the run's parameters give {}", what,
                                 recorded.dump(), expected.dump()));
}

/// Throws StoreDamaged if the seed, a swept value or the variant contradicts the parameters. Swept
/// parameters that are not part of the run's id, or have no effect on the run, are not checked.
void check_place(const Place& place, const StageInputs& stage, const json& resolved) {
  require_same("seed", place.seed, stage.seed);
  for (const auto& [key, value] : place.swept.items()) {
    const Field* field = find_field(key);
    const json& parameters = resolved.at("parameters");
    if (field == nullptr || !field->identity.recorded_as.empty() || !parameters.contains(key)) {
      continue;
    }
    require_same("label " + key, value, parameters.at(key));
    const std::string part = key + "=" + value_text(value);
    if (("," + place.variant + ",").find("," + part + ",") == std::string::npos) {
      throw StoreDamaged(fmt::format("its variant '{}' lacks {}", place.variant, part));
    }
  }
}

void check_stage(const Stage& stage) {
  if (stage_key(stage.resolved) != stage.id) {
    throw StoreDamaged("the id is not the hash of the recorded parameters");
  }
  const StageInputs inputs = read_stage(stage.resolved);
  require_same("kind", stage.kind, name_of(inputs.stage));
  require_same("parent", stage.parent, inputs.parent);
  require_same("grains", stage.grains, inputs.parameters.grains);
  for (const Membership& m : stage.memberships) check_place(m.place, inputs, stage.resolved);
}

/// Steps of the parent at which the stage may have started. If the parent is a packing, each of its
/// completed attempts gives two steps: the step of the last checkpoint of this attempt, and the
/// largest step of all checkpoints up to then, including those of earlier attempts. The two steps
/// can differ after a merge. If the parent is not a packing, the only step is that of
/// starting_state().
std::set<std::uint64_t> starting_steps(const Store& store, const Stage& stage) {
  std::set<std::uint64_t> steps;
  if (store.stage(stage.parent).kind != name_of(StageKind::prepare)) {
    const auto start = starting_state(store, stage, read_stage(stage.resolved).parameters);
    if (start) steps.insert(start->step);
    return steps;
  }
  const RunLineage packing = run_lineage(store, stage.parent).back();
  std::uint64_t furthest = 0;
  for (const Attempt& attempt : packing.attempts) {
    std::uint64_t last = furthest;
    for (const std::string& sha256 : attempt.checkpoints) {
      const CheckpointRecord& record = packing.find(sha256)->record;
      last = record.step;
      if (record.state != CheckpointState::rejected) furthest = std::max(furthest, last);
    }
    if (attempt.outcome == AttemptOutcome::completed) steps.insert({last, furthest});
  }
  return steps;
}

/// Throws StoreDamaged if the stage started from a wrong checkpoint of its parent. After a merge,
/// accepts a starting checkpoint that is not in the log, because merge() does not copy a checkpoint
/// if this store already has a file with the same state but different bytes.
void check_beginning(const Store& store, const Stage& stage) {
  if (stage.parent.empty()) return;
  const std::set<std::uint64_t> steps = starting_steps(store, stage);
  const std::vector<CheckpointRecord> known = store.checkpoints(stage.parent, Listed::all);
  for (const Event& event : store.events(run_stream(stage.id), events::RunStarted::kType)) {
    const auto from = std::get<events::RunStarted>(events::decode(event)).parent_checkpoint;
    if (!from) continue;
    const auto record = std::ranges::find(known, *from, &CheckpointRecord::sha256);
    if (record == known.end() ? !store.events("", events::StoreMerged::kType).empty()
                              : steps.contains(record->step)) {
      continue;
    }
    throw StoreDamaged(fmt::format(
        "event {}: this run started from the wrong state: checkpoint {:.12} is not the required "
        "state of the parent run {:.12}; do not use the results, and compute this run in a new "
        "store",
        event.seq, *from, stage.parent));
  }
}

bool nearly_equal(const json& cached, const json& computed) {
  if (!cached.is_number() || !computed.is_number()) return cached == computed;
  const auto a = cached.get<double>(), b = computed.get<double>();
  return a == b || (std::isnan(a) && std::isnan(b)) ||
         std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b));
}

/// Describes the first difference of two results, with both values; "" if they are equal.
std::string difference(const json& cached, const json& computed, const std::string& measure) {
  const json a = cached.flatten(), b = computed.flatten();
  for (const auto& [path, value] : b.items()) {
    if (!a.contains(path)) return measure + path + ": this value is not cached";
    if (nearly_equal(a.at(path), value)) continue;
    return fmt::format("{}{}: the cached value is {}, the computed value is {}", measure, path,
                       a.at(path).dump(), value.dump());
  }
  return a.size() == b.size() ? "" : measure + ": its structure differs";
}

struct CachedMeasure {
  const Provider* provider;
  std::uint64_t every;  // as in ToMeasure
  DerivedObject object;
};

/// The cached measures of a checkpoint, for each interval in MeasureSources::cadences().
std::vector<CachedMeasure> cached_measures(const CheckpointRecord& record, DerivedCache& cache,
                                           MeasureSources& sources) {
  sources.read_run(record.run);
  std::vector<CachedMeasure> all, found;
  std::vector<DerivedKey> keys;
  for (const Provider& one : all_providers()) {
    for (const std::uint64_t every : sources.cadences(record.run)) {
      if (!one.is_kept() || (every != 1 && one.cycles_back == 0)) continue;
      keys.push_back(sources.key(record, one, every));
      all.push_back({&one, every, {keys.back(), {}}});
    }
  }
  auto contents = cache.get(keys);  // in one transaction
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (!contents[k]) continue;
    all[k].object.content = std::move(*contents[k]);
    found.push_back(std::move(all[k]));
  }
  return found;
}

std::string wrong_measure(const Store& store, const CheckpointRecord& record,
                          const std::vector<CachedMeasure>& cached, const MeasureSources& sources) {
  try {
    const Checkpoint checkpoint = store.load_checkpoint(record);
    const Analysis analysis = analyse(checkpoint);
    for (const CachedMeasure& one : cached) {
      MeasureOutcome unread;
      const auto computed =
          sources.compute(*one.provider, record, one.every, &checkpoint, &analysis, unread);
      if (!computed) continue;
      auto found = difference(decode_result(one.object.content), *computed, one.provider->name);
      if (!found.empty()) return found;
    }
  } catch (const AnalysisError& error) {
    return error.what();
  } catch (const FilePruned&) {
    // Another program has just pruned the checkpoint.
  }
  return "";
}

std::vector<CheckpointRecord> all_checkpoints(const Store& store,
                                              Listed listed = Listed::recorded) {
  std::vector<CheckpointRecord> all;
  for (const Stage& stage : store.stages()) {
    std::ranges::move(store.checkpoints(stage.id, listed), std::back_inserter(all));
  }
  return all;
}

/// Compares the cached measures of pruned checkpoints with the log. Returns what was read from it.
MeasureSources check_pruned(const Store& store, DerivedCache& cache, MeasureCheck& check) {
  MeasureSources sources(store);
  using Severity = Finding::Severity;
  const auto note = [&](Severity severity, const std::string& run, const std::string& what) {
    if (!what.empty()) check.findings.push_back({severity, "measures", run, what});
  };
  for (const Stage& stage : store.stages()) {
    sources.read_run(stage.id);
    for (const CheckpointRecord& record : store.checkpoints(stage.id, Listed::and_pruned)) {
      if (record.state != CheckpointState::pruned) continue;
      const auto found = sources.compare_pruned(record, cache);
      if (found.named == 0) ++check.not_covered;
      note(Severity::error, stage.id, found.altered);
      check.absent += found.absent;
    }
  }
  if (cache.is_unread()) {
    note(Severity::unread, "", cache.trouble());
    check.absent = 0;  // unknown
  } else if (check.absent > 0) {
    note(Severity::error, "", cache.trouble());
    note(Severity::error, "", cache.replaced());
  }
  return sources;
}

/// Copies the measures that the store lacks. Leaves out measures that differ from their digests in
/// the log of the store or of the source. Returns why they cannot be copied; "" if they can.
std::string copy_measures(Store& store, DerivedCache& from, const MeasureSources& of_source) {
  DerivedCache into(store.folder());
  MeasureSources sources(store);
  std::vector<DerivedObject> missing;
  std::map<std::string, CheckpointRecord> unnamed;  // pruned, without a logged digest
  for (const CheckpointRecord& record : all_checkpoints(store, Listed::and_pruned)) {
    for (CachedMeasure& one : cached_measures(record, from, sources)) {
      const auto same = sources.is_as_pruned(record, one.object);
      if (!same.value_or(true) || !of_source.is_as_pruned(record, one.object).value_or(true) ||
          into.get({&one.object.key, 1}).front()) {
        continue;
      }
      if (!same && record.state == CheckpointState::pruned) unnamed.emplace(record.sha256, record);
      missing.push_back(std::move(one.object));
    }
  }
  if (!missing.empty()) into.put(missing);
  for (const auto& [sha256, record] : unnamed) {
    const events::CheckpointPruned again{{record}, into.digests(sha256)};
    store.record(run_stream(record.run), events::encode(again));
  }
  return into.trouble().empty() ? from.trouble() : into.trouble();
}

}  // namespace

std::vector<CheckpointRecord> replayable(const Store& store, std::size_t* left_out) {
  RunLineages known;
  std::vector<CheckpointRecord> found = all_checkpoints(store, Listed::and_pruned);
  const std::size_t excluded =
      std::erase_if(found, [&](const auto& c) { return why_not_again(store, c, known); });
  if (left_out != nullptr) *left_out = excluded;
  return found;
}

std::vector<CheckpointRecord> sample(std::vector<CheckpointRecord> records, std::size_t count,
                                     std::uint64_t seed) {
  count = std::min(count, records.size());
  // The distributions of <random> give different numbers in different standard libraries, so the
  // indices are remainders of the generator's numbers.
  std::mt19937_64 random(seed);
  for (std::size_t i = 0; i < count; ++i) {
    std::swap(records[i], records[i + random() % (records.size() - i)]);
  }
  records.resize(count);
  return records;
}

std::uint64_t seed_of(const Head& head) {
  const std::string digits = head.hash.substr(0, 12);
  std::uint64_t seed = 0;  // stays 0 if the hash in a damaged log is not hexadecimal
  std::from_chars(digits.data(), digits.data() + digits.size(), seed, 16);
  return seed;
}

std::vector<Finding> check_runs(const Store& store) {
  const Store::Snapshot snapshot(store);
  std::vector<Finding> findings;
  for (const Stage& stage : store.stages()) {
    const auto note = [&](Finding::Severity severity, const std::exception& problem) {
      findings.push_back({severity, fmt::format("run {:.12}", stage.id), stage.id, problem.what()});
    };
    try {
      check_stage(stage);
      check_beginning(store, stage);
    } catch (const StoreDamaged& damage) {
      note(Finding::Severity::error, damage);
    } catch (const UnreadableRecord& unknown) {  // recorded by another version of the program
      note(Finding::Severity::note, unknown);
    } catch (const NotFound& parent) {
      note(Finding::Severity::note, parent);
    }
  }
  return findings;
}

MeasureCheck check_sample(const Store& store, const std::filesystem::path& folder,
                          std::vector<CheckpointRecord> records, std::size_t count,
                          std::uint64_t seed) {
  DerivedCache cache(folder, Access::read);
  MeasureSources sources(store);
  std::erase_if(records, [&](const CheckpointRecord& record) {
    return cached_measures(record, cache, sources).empty();
  });
  const std::vector<CheckpointRecord> chosen = sample(records, count, seed);
  MeasureCheck check{.cached = records.size(), .computed = chosen.size()};
  for (const CheckpointRecord& record : chosen) {
    const std::string wrong =
        wrong_measure(store, record, cached_measures(record, cache, sources), sources);
    if (wrong.empty()) continue;
    check.findings.push_back(
        {Finding::Severity::error, (folder / DerivedCache::kFile).string(), record.run,
         fmt::format("checkpoint {0:.12}, {1}; `shearcell regenerate {0:.12}` deletes the cached "
                     "values of this checkpoint, and the next command computes them again",
                     record.sha256, wrong)});
  }
  return check;
}

MeasureCheck check_measures(const Store& store, std::size_t count, std::uint64_t seed) {
  MeasureCheck check = check_sample(store, store.folder(), all_checkpoints(store), count, seed);
  DerivedCache cache(store.folder(), Access::read);
  check_pruned(store, cache, check);
  return check;
}

std::vector<MergeReport> merge_stores(Store& store,
                                      const std::vector<std::filesystem::path>& sources,
                                      const std::set<std::string>& runs) {
  std::vector<MergeReport> reports = store.merge(sources, runs);
  // The seed comes from the head of `store`. Someone who forges one of the `sources` does not know
  // this head, and so cannot predict which checkpoints are checked.
  const std::uint64_t seed = seed_of(store.head());
  for (std::size_t k = 0; k < sources.size(); ++k) {
    const std::filesystem::path& source = sources[k];
    MeasureCheck check = check_sample(store, source, all_checkpoints(store), kSampled, seed);
    const bool is_sound = check.findings.empty();
    DerivedCache from(source, Access::read);
    try {
      const Store of_source(source, Access::read);
      const MeasureSources log = check_pruned(of_source, from, check);
      reports[k].absent = check.absent;
      const std::string why = is_sound ? copy_measures(store, from, log) : "";
      if (!why.empty()) check.findings.push_back({Finding::Severity::note, source, "", why});
    } catch (const StoreDamaged& damage) {  // in tables of the source, which Store::merge() ignores
      check.findings.push_back({Finding::Severity::error, source, "", damage.what()});
    }
    reports[k].refused = std::move(check.findings);
  }
  return reports;
}

}  // namespace shearcell
