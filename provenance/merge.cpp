// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/merge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "provenance/errors.hpp"
#include "provenance/events.hpp"
#include "provenance/merge_run.hpp"
#include "provenance/projections.hpp"
#include "provenance/queries.hpp"
#include "provenance/schema.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {

namespace {

using sqlite::Database;

/// Equal for events of different logs that are the same event.
std::string content_key(const Event& event) {
  Sha256 sha;
  sha.add_field(event.stream).add_field(event.type).add_field(std::to_string(event.schema));
  return sha.add_field(event.recorded_at).add_field(event.payload).hex();
}

std::set<std::string> content_keys(const EventLog& log) {
  std::set<std::string> keys;
  log.for_each([&keys](const Event& event) { keys.insert(content_key(event)); });
  return keys;
}

using Step = std::pair<std::string, std::uint64_t>;  // run and step

std::map<Step, std::set<std::string>> states_of(const Database& tables) {
  std::map<Step, std::set<std::string>> states;
  for (const CheckpointRecord& record : query_checkpoints(tables)) {
    if (record.state == CheckpointState::rejected) continue;
    states[{record.run, record.step}].insert(record.state_hash);
  }
  return states;
}

bool share(const std::set<std::string>& a, const std::set<std::string>& b) {
  return std::any_of(a.begin(), a.end(), [&b](const std::string& x) { return b.contains(x); });
}

void require_equal_states(const Database& a, const std::string& a_name, const Database& b,
                          const std::string& b_name) {
  const auto known = states_of(a);
  for (const auto& [step, states] : states_of(b)) {
    const auto same_step = known.find(step);
    if (same_step == known.end() || share(same_step->second, states)) continue;
    throw MergeConflict(fmt::format(
        "run {} at step {}: {} has state {:.12} and {} has state {:.12}; one of them is wrong: "
        "run `shearcell verify --replay` in each. Nothing was merged",
        step.first, step.second, a_name, *same_step->second.begin(), b_name, *states.begin()));
  }
}

void require_equal_runs(const Database& a, const std::string& a_name, const Database& b,
                        const std::string& b_name) {
  std::map<std::string, RunRecord> known;
  for (RunRecord& run : query_runs(a)) known.emplace(run.id, std::move(run));
  for (const RunRecord& run : query_runs(b)) {
    const auto same = known.find(run.id);
    if (same == known.end()) continue;
    const RunRecord& other = same->second;
    if (other.resolved == run.resolved && other.parent == run.parent && other.kind == run.kind &&
        other.grains == run.grains) {
      continue;
    }
    throw MergeConflict(fmt::format(
        "run {}: {} and {} have different parameters for it; one of them was changed by "
        "hand. Nothing was merged",
        run.id, a_name, b_name));
  }
}

/// Checkpoints of the source whose files must be copied.
std::vector<CheckpointRecord> needed_objects(const Database& into, const Database& tables) {
  std::vector<CheckpointRecord> needed;
  for (CheckpointRecord& record : query_checkpoints(tables)) {
    if (record.state == CheckpointState::recorded && is_news(into, record)) {
      needed.push_back(std::move(record));
    }
  }
  return needed;
}

std::vector<std::byte> read_object(const MergeSource& source, const CheckpointRecord& record) {
  try {
    return source.objects.get(record.sha256, record.size);
  } catch (const StoreDamaged& damage) {
    throw StoreDamaged(
        fmt::format("{}. Nothing was merged from {}", damage.what(), source.folder.string()));
  }
}

constexpr std::string_view kMergeStream = "store/merge";

bool merged_before(const EventLog& log, const Head& head) {
  for (const Event& event : log.events(kMergeStream)) {
    const events::Any decoded = events::decode(event);
    const auto* merged = std::get_if<events::StoreMerged>(&decoded);
    if (merged != nullptr && merged->head.is_object() &&
        merged->head.value("hash", nlohmann::json()) == head.hash) {
      return true;
    }
  }
  return false;
}

}  // namespace

MergeSource read_merge_source(const std::filesystem::path& folder,
                              const std::set<std::string>& runs) {
  const std::filesystem::path file = folder / "store.sqlite";
  if (!std::filesystem::exists(file)) {
    throw NotFound(fmt::format("{}: there is no store here to merge", folder.string()));
  }
  Database database = open_database(file, sqlite::Open::existing, true);
  const EventLog log(database);
  MergeSource source{.folder = folder,
                     .head = {},
                     .events = {},
                     .tables = std::make_unique<Database>(Database::in_memory()),
                     .objects = ObjectStore(folder)};
  {
    const sqlite::ReadTransaction snapshot(database);
    if (const auto fault = log.verify_chain()) {
      throw StoreDamaged(
          fmt::format("{}: {}. Nothing was merged from it", folder.string(), fault->message));
    }
    source.head = log.head();
    source.events = log.events();
  }
  if (!runs.empty()) {
    std::erase_if(source.events, [&runs](const Event& event) {
      return !event.stream.starts_with("manifest/") &&
             !(event.stream.starts_with("run/") && runs.contains(event.stream.substr(4)));
    });
  }
  create_projections(*source.tables);
  for (const Event& event : source.events) apply(*source.tables, event);
  return source;
}

void require_agreement(const Database& into, const std::string& name,
                       const std::vector<MergeSource>& sources) {
  for (std::size_t s = 0; s < sources.size(); ++s) {
    const std::string source = sources[s].folder.string();
    require_equal_runs(into, name, *sources[s].tables, source);
    require_equal_states(into, name, *sources[s].tables, source);
    for (std::size_t t = 0; t < s; ++t) {
      const std::string other = sources[t].folder.string();
      require_equal_runs(*sources[t].tables, other, *sources[s].tables, source);
      require_equal_states(*sources[t].tables, other, *sources[s].tables, source);
    }
  }
}

void check_objects(const Database& into, const MergeSource& source) {
  for (const CheckpointRecord& record : needed_objects(into, *source.tables)) {
    read_object(source, record);
  }
}

void copy_objects(const Database& into, ObjectStore& objects, const MergeSource& source,
                  MergeReport& report) {
  for (const CheckpointRecord& record : needed_objects(into, *source.tables)) {
    objects.put(read_object(source, record));
    ++report.checkpoints;
    report.bytes += record.size;
  }
}

void merge_events(Database& into, EventLog& log, const sqlite::WriteTransaction& lock,
                  const MergeSource& source, MergeReport& report) {
  const std::set<std::string> known = content_keys(log);
  const std::vector<FigureRecord> figures = query_figures(into);
  std::map<std::string, RunMerge> runs;
  for (const RunRecord& run : query_runs(*source.tables)) {
    runs.emplace(run.id, plan_run(into, log, *source.tables, source.events, run));
  }
  std::set<std::string> new_streams;
  for (const Event& event : source.events) {
    if (event.stream.starts_with("manifest/") && log.version(event.stream) == 0) {
      new_streams.insert(event.stream);
    }
  }
  const auto take = [&](const Event& event) {
    apply(into, log.append_copy(lock, event));
    ++report.events;
  };
  for (const Event& event : source.events) {
    if (known.contains(content_key(event))) continue;
    if (event.stream.starts_with("manifest/") && !new_streams.contains(event.stream)) continue;
    if (event.stream.starts_with("run/")) {
      const auto run = runs.find(event.stream.substr(4));
      if (run == runs.end() || !run->second.wants(into, event)) continue;
    }
    take(event);
  }
  for (const auto& [id, run] : runs) {
    if (const auto closing = run.closing_event(into)) take(*closing);
  }
  // A copied figure follows the store's own in the log; the one that was made later stays the
  // newest.
  for (const FigureRecord& copied : query_figures(into)) {
    const auto own = std::ranges::find(figures, copied.name, &FigureRecord::name);
    if (own == figures.end() || own->recorded_at <= copied.recorded_at) continue;
    for (const Event& event : log.events("figure/" + copied.name)) {
      if (event.seq == own->seq) take(event);
    }
  }
  if (merged_before(log, source.head)) return;
  const NewEvent merged = events::encode(
      events::StoreMerged{.source = source.folder.string(),
                          .head = {{"seq", source.head.seq}, {"hash", source.head.hash}},
                          .events = report.events,
                          .checkpoints = report.checkpoints});
  log.append(lock, kMergeStream, log.version(kMergeStream), std::span(&merged, 1));
}

}  // namespace shearcell
