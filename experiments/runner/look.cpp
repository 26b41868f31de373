// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/look.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "experiments/manifest/identity.hpp"
#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"
#include "provenance/limits.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

[[noreturn]] void refuse_unread(const CheckpointRecord& record) {
  const bool pruned = record.state == CheckpointState::pruned;
  const std::string why = fmt::format(
      "checkpoint {:.12} of run {:.12} (cycle {:g}), which may decide where the run ends "
      "(`until`), {}; `shearcell regenerate {:.12}` restores it",
      record.sha256, record.run, record.cycle, pruned ? "was pruned" : "cannot be read",
      record.sha256);
  if (pruned) throw FilePruned(why);
  throw StoreDamaged(why);
}

/// Measures the checkpoint and the next ones at whole cycles, as many as there are workers.
void measure_from(const Store& store, const CheckpointRecord& first,
                  std::vector<SeenCheckpoint>& checkpoints, const MeasureOptions& options) {
  std::vector<SeenCheckpoint*> chosen;
  std::vector<CheckpointRecord> records;
  for (SeenCheckpoint& one : checkpoints) {
    const bool whole = one.record.cycle == std::floor(one.record.cycle);
    if (one.record.step < first.step || !whole || one.measures) continue;
    chosen.push_back(&one);
    records.push_back(one.record);
    if (chosen.size() == options.workers) break;
  }
  // The crystallites come from the same analysis, and figures need them.
  static const std::array<std::string, 1> scalars = {"scalars"};
  const MeasureOptions also = {
      .workers = options.workers, .report = options.report, .also = {"crystallites"}};
  MeasuredCheckpoints found = measure_checkpoints(store, records, scalars, also);
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    if (!found.lacks(k, "scalars")) chosen[k]->measures = std::move(found.measures[k]);
  }
  if (!chosen.front()->measures) refuse_unread(first);
}

/// Whether it is Outlook::ended.
bool is_early_end(const json& ended) {
  return member_of(ended, "by") == "until" && member_of(ended, "measure").is_string() &&
         member_of(ended, "value").is_number() &&
         member_of(ended, "extra_cycles").is_number_unsigned() &&
         member_of(ended, "reached_at_cycle").is_number();
}

/// Whether the recorded end is by this `until` of an ask.
bool ended_by(const json& ended, const json& until) {
  const auto measure = ended.at("measure").get<std::string>();
  return member_of(until, measure.c_str()) == ended.at("value") &&
         member_of(until, "extra_cycles") == ended.at("extra_cycles");
}

/// The most cycles [at most those that the stage has] for which an experiment without this `until`
/// asked when the stage ended; 0 without any.
double longest_length(const Stage& stage, const json& ended) {
  const json known = member_of(ended, "memberships");
  std::size_t left = known.is_number_unsigned() ? known.get<std::size_t>() : 0;
  double longest = 0;
  for (const Ask& ask : stage.asks) {  // in the order of declaration
    if (left-- == 0) break;
    const auto cycles = static_cast<double>(ask.target_cycles);
    if (cycles <= stage.cycle && !ended_by(ended, ask.until)) longest = std::max(longest, cycles);
  }
  return longest;
}

}  // namespace

Outlook look_at(const Store& store, const Stage& stage) {
  try {
    return outlook(stage, stage.asks, seen_checkpoints(store, stage.id));
  } catch (const StoreDamaged& damage) {
    const bool completed = stage.state == StageState::completed;
    return {.done = completed, .from = stage.cycle, .unreadable = damage.what()};
  }
}

std::vector<PlannedStage> look_at(const Plan& plan, const Store* store) {
  std::map<std::string, Stage> known;
  if (store != nullptr) {
    for (Stage& stage : store->stages()) known.emplace(stage.id, std::move(stage));
  }
  std::vector<PlannedStage> stages;
  std::set<std::string> seen;
  for (const PlannedRun& run : plan.runs) {
    for (const Stage* planned : {&run.prepare, &run.last}) {
      if (!seen.insert(planned->id).second) continue;
      PlannedStage& one = stages.emplace_back(PlannedStage{.run = &run, .stage = *planned});
      if (const auto found = known.find(planned->id); found != known.end()) {
        one.stage = std::move(found->second);
        one.stage.resolved = planned->resolved;  // that of the store may be damaged
        one.asks = one.stage.asks;
        one.checkpoints = seen_checkpoints(*store, one.stage.id);
      }
      if (planned == &run.last) std::ranges::copy(run.asks, std::back_inserter(one.asks));
      one.look = outlook(one.stage, one.asks, one.checkpoints);
    }
  }
  return stages;
}

std::vector<SeenCheckpoint> seen_checkpoints(const Store& store, const std::string& stage) {
  std::vector<SeenCheckpoint> seen;
  for (CheckpointRecord& record : store.checkpoints(stage, Listed::and_pruned)) {
    seen.push_back({std::move(record)});
  }
  return seen;
}

Outlook decide(const Store& store, const Stage& stage, std::span<const Ask> asks,
               std::vector<SeenCheckpoint>& checkpoints, const MeasureOptions& options) {
  for (;;) {
    Outlook look = outlook(stage, asks, checkpoints);
    if (!look.undecided) return look;
    measure_from(store, *look.undecided, checkpoints, options);
  }
}

double end_for(const Store& store, const Stage& stage, const Ask& ask,
               const MeasureOptions& options) {
  // With one ask no other experiment can have continued it.
  if (stage.asks.size() < 2 || !has_until(ask)) {
    return static_cast<double>(ask.target_cycles);
  }
  std::vector<SeenCheckpoint> checkpoints = seen_checkpoints(store, stage.id);
  return decide(store, stage, {&ask, 1}, checkpoints, options).end;
}

std::vector<CheckpointRecord> checkpoints_for(const Store& store, const Stage& stage,
                                              std::span<const Ask> asks, double first,
                                              double last) {
  std::vector<CheckpointRecord> found = store.checkpoints(stage.id, Listed::and_pruned);
  const double end = found.empty() ? 0 : std::min(last, found.back().cycle);
  const bool every = asks.empty() || !shear_drive(stage);
  std::set<std::uint64_t> steps;
  for (const Ask& ask : asks) {
    const auto asked = asked_steps(stage, ask, first, end);
    steps.insert(asked.begin(), asked.end());
  }
  std::erase_if(found, [&](const CheckpointRecord& record) {
    const bool asked =
        every ? record.cycle == std::floor(record.cycle) : steps.contains(record.step);
    return record.cycle < first || record.cycle > last || !asked;
  });
  return found;
}

std::vector<CheckpointRecord> checkpoints_for(const Store& store, const Stage& stage,
                                              const Ask& ask, const MeasureOptions& options) {
  return checkpoints_for(store, stage, {&ask, 1}, 0, end_for(store, stage, ask, options));
}

json end_of(const Stage& stage) {
  if (stage.state != StageState::completed || stage.ends.empty() ||
      stage.cycle >= static_cast<double>(stage.target_cycles)) {
    return json();
  }
  json ended = stage.ends.back();
  if (!is_early_end(ended)) return json();
  const double reached =
      ended["reached_at_cycle"].get<double>() + ended["extra_cycles"].get<double>();
  if (const double asked = longest_length(stage, ended); asked > reached) {
    ended["cycles_asked"] = asked;
  }
  return ended;
}

std::string describe_end(const json& ended) {
  if (ended.is_null()) return "";
  const auto extra = ended.at("extra_cycles").get<std::uint64_t>();
  std::string why =
      fmt::format("{} >= {} at cycle {}{}", ended.at("measure").get<std::string>(),
                  ended.at("value").get<double>(), ended.at("reached_at_cycle").get<double>(),
                  extra > 0 ? fmt::format(" and {}", counted(extra, "more cycle")) : "");
  if (const json asked = member_of(ended, "cycles_asked"); !asked.is_null()) {
    why = fmt::format("an experiment asks for {} cycles; {}", asked.get<double>(), why);
  }
  return why;
}

std::optional<double> expected_end(std::span<const Stage> stages, const json& until) {
  double sum = 0, count = 0;
  for (const Stage& stage : stages) {
    const json ended = end_of(stage);
    if (ended.is_null() || ended.contains("cycles_asked") || !ended_by(ended, until)) continue;
    sum += stage.cycle;
    ++count;
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

}  // namespace shearcell
