// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/run_end.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

/// The first checkpoint on the cadence of `ask` at which its `until` is reached, or, if it is
/// unread, may be; null without one.
const MeasuredCycle* first_reached(std::span<const MeasuredCycle> measured, const RunAsk& ask) {
  if (!ask.until) return nullptr;
  const std::string_view measure = name_of(ask.until->measure);
  const auto every = static_cast<double>(ask.checkpoint_every);
  const auto found = std::ranges::find_if(measured, [&](const MeasuredCycle& m) {
    return std::fmod(m.cycle, every) == 0 &&
           (m.unread || m.measures.number(measure) >= ask.until->value);
  });
  return found == measured.end() ? nullptr : &*found;
}

[[noreturn]] void refuse_unread(const CheckpointRecord& record) {
  const bool pruned = record.state == CheckpointState::pruned;
  const std::string why = fmt::format(
      "checkpoint {:.12} of run {:.12} (cycle {:g}), which may decide where the run ends "
      "(`until`), "
      "{}; `shearcell regenerate {:.12}` restores it",
      record.sha256, record.run, record.cycle, pruned ? "was pruned" : "cannot be read",
      record.sha256);
  if (pruned) throw FilePruned(why);
  throw StoreDamaged(why);
}

/// The cycle at which the run ends for this experiment alone: its number of cycles, or the first
/// checkpoint at or after the end that its `until` gives when that is reached at `reached`.
double asked_end(const RunAsk& ask, const MeasuredCycle* reached) {
  const auto target = static_cast<double>(ask.target_cycles);
  if (reached == nullptr) return target;
  const auto every = static_cast<double>(ask.checkpoint_every);
  const double end = reached->cycle + static_cast<double>(ask.until->extra_cycles);
  return std::min(target, std::ceil(end / every) * every);
}

/// Whether every `until` is reached; then only numbers of cycles decide.
bool all_reached(std::span<const RunAsk> asks, std::span<const MeasuredCycle> measured) {
  return std::ranges::all_of(
      asks, [&](const RunAsk& ask) { return !ask.until || first_reached(measured, ask); });
}

std::vector<MeasuredCycle> measure(const Store& store, std::span<const CheckpointRecord> records,
                                   const MeasureOptions& options) {
  static const std::array<std::string, 1> scalars = {"scalars"};
  MeasuredCheckpoints found = measure_checkpoints(store, records, scalars, options);
  std::vector<MeasuredCycle> measured;
  for (std::size_t k = 0; k < records.size(); ++k) {
    MeasuredCycle& one = measured.emplace_back(MeasuredCycle{.cycle = records[k].cycle});
    one.measures = std::move(found.measures[k]);
    if (found.lacks(k, "scalars")) one.unread = records[k];
  }
  return measured;
}

/// Whether it is what ended_early() gives.
bool is_early_end(const json& ended) {
  return member_of(ended, "by") == "until" && member_of(ended, "measure").is_string() &&
         member_of(ended, "value").is_number() &&
         member_of(ended, "reached_at_cycle").is_number() &&
         member_of(ended, "extra_cycles").is_number_unsigned();
}

/// Whether the recorded end is by this `until`.
bool ended_by(const json& ended, const Until& until) {
  return ended.at("measure") == name_of(until.measure) && ended.at("value") == until.value &&
         ended.at("extra_cycles") == until.extra_cycles;
}

/// The most cycles [at most those that the run has] for which an experiment without this `until`
/// asked when the run ended; 0 without any.
double longest_length(const Store& store, const RunRecord& run, const json& ended) {
  const json known = member_of(ended, "memberships");
  std::size_t left = known.is_number_unsigned() ? known.get<std::size_t>() : 0;
  double longest = 0;
  for (const Membership& m : run.memberships) {  // in the order of declaration
    if (left-- == 0) break;
    const auto cycles = static_cast<double>(m.target_cycles);
    if (cycles > run.cycle || cycles <= longest) continue;
    const std::optional<Until> until = ask_of(store, run.id, m).until;
    if (!until || !ended_by(ended, *until)) longest = cycles;
  }
  return longest;
}

/// The cycle at which the run reached the `until` of `ask`, as a completion records it; nothing
/// without such a completion.
std::optional<double> recorded_reach(const Store& store, const RunRecord& run, const RunAsk& ask) {
  for (const Event& event : store.events(run_stream(run.id), "RunCompleted")) {
    const json ended = member_of(member_of(event.body(), "summary"), "ended");
    if (!is_early_end(ended) || !ended_by(ended, *ask.until)) continue;
    const auto cycle = ended["reached_at_cycle"].get<double>();
    if (std::fmod(cycle, static_cast<double>(ask.checkpoint_every)) == 0) return cycle;
  }
  return std::nullopt;
}

}  // namespace

std::optional<json> ended_early(std::span<const RunAsk> asks,
                                std::span<const MeasuredCycle> measured, double now) {
  double end = -1;
  json why;
  for (const RunAsk& ask : asks) {
    const MeasuredCycle* reached = first_reached(measured, ask);
    if (reached != nullptr && reached->unread) refuse_unread(*reached->unread);
    const double own = asked_end(ask, reached);
    if (now < own) return std::nullopt;
    if (own <= end || reached == nullptr) continue;
    end = own;
    why = {{"by", "until"},
           {"measure", name_of(ask.until->measure)},
           {"value", ask.until->value},
           {"extra_cycles", ask.until->extra_cycles},
           {"reached_at_cycle", reached->cycle},
           {"memberships", asks.size()}};
  }
  if (why.is_null()) return std::nullopt;
  return why;
}

double end_for(const Store& store, const RunRecord& run, const RunAsk& ask,
               const MeasureOptions& options) {
  const auto target = static_cast<double>(ask.target_cycles);
  // With one membership no other experiment can have continued it.
  if (run.memberships.size() < 2 || !ask.until) return target;
  std::vector<CheckpointRecord> records = store.checkpoints(run.id, Listed::and_pruned);
  std::erase_if(records, [&](const CheckpointRecord& record) {
    return std::fmod(record.cycle, static_cast<double>(ask.checkpoint_every)) != 0;
  });
  const auto measured =
      measure(store, records, {.workers = options.workers, .report = options.report});
  const MeasuredCycle* reached = first_reached(measured, ask);
  if (reached == nullptr || !reached->unread) return asked_end(ask, reached);
  const std::optional<double> recorded = recorded_reach(store, run, ask);
  if (!recorded) refuse_unread(*reached->unread);
  const MeasuredCycle there{.cycle = *recorded};
  return asked_end(ask, &there);
}

json recorded_end(const Store& store, const std::string& run) {
  const std::vector<Event> ends = store.events(run_stream(run), "RunCompleted");
  if (ends.empty()) return json();
  return member_of(member_of(ends.back().body(), "summary"), "ended");
}

json end_of(const Store& store, const RunRecord& run) {
  if (run.state != RunState::completed || run.cycle >= static_cast<double>(run.target_cycles)) {
    return json();
  }
  json ended = recorded_end(store, run.id);
  if (!is_early_end(ended)) return json();
  const double reached =
      ended["reached_at_cycle"].get<double>() + ended["extra_cycles"].get<double>();
  if (const double asked = longest_length(store, run, ended); asked > reached) {
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

std::optional<double> expected_end(const Store& store, const Until& until) {
  double sum = 0, count = 0;
  for (const RunRecord& run : store.runs()) {
    const json ended = end_of(store, run);
    if (ended.is_null() || ended.contains("cycles_asked") || !ended_by(ended, until)) continue;
    sum += run.cycle;
    ++count;
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

RunEnd::RunEnd(const Store& store, const RunRecord& run, std::uint64_t step)
    : store_(store), run_(run.id), cadence_(checkpoint_cadence(run)) {
  for (const CheckpointRecord& record : store.checkpoints(run.id, Listed::and_pruned)) {
    if (record.step <= step) add(record);
  }
}

void RunEnd::add(const CheckpointRecord& record) {
  const bool on_cadence = std::fmod(record.cycle, static_cast<double>(cadence_)) == 0;
  if (on_cadence) records_.push_back(record);
}

std::optional<json> RunEnd::ended() {
  if (records_.empty()) return std::nullopt;
  const std::vector<RunAsk> asks = asks_of(store_, run_);
  // The crystallites come from the same analysis, and figures need them.
  const MeasureOptions options{.report = {}, .also = {"crystallites"}};
  for (; next_ < records_.size() && !all_reached(asks, measured_); ++next_) {
    std::ranges::move(measure(store_, {&records_[next_], 1}, options),
                      std::back_inserter(measured_));
  }
  return ended_early(asks, measured_, records_.back().cycle);
}

}  // namespace shearcell
