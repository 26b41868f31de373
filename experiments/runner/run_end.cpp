// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/run_end.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "analysis/derived_measures.hpp"
#include "analysis/error.hpp"
#include "experiments/manifest/identity.hpp"
#include "provenance/errors.hpp"

namespace shearcell {
namespace {

using nlohmann::json;
using namespace nlohmann::literals;

double value_of(const Measures& measures, StopMeasure measure) {
  switch (measure) {
    case StopMeasure::crystalline_percent:
      return measures.crystalline_percent;
    case StopMeasure::largest_crystallite:
      return static_cast<double>(measures.largest_crystallite);
    case StopMeasure::phi:
      return measures.phi;
  }
  return 0;
}

DerivedKey key_of(const CheckpointRecord& record, const DerivedMeasure& measure) {
  return {record.sha256, measure.key(), analysis_version};
}

}  // namespace

std::vector<RunAsk> asks_of(const Store& store, const std::string& run) {
  std::map<json, RunAsk> asks;
  for (const Event& event : store.events("run/" + run)) {
    if (event.type != "RunDeclared") continue;
    const json body = event.body();
    try {
      const json& m = body.at("membership");
      json key;
      for (const char* part : {"experiment", "scale", "variant", "seed", "manifest"}) {
        key.push_back(m.at(part));
      }
      RunAsk& ask = asks[std::move(key)];
      ask.target_cycles =
          std::max(ask.target_cycles, body.at("target_cycles").get<std::uint64_t>());
      const json until = m.value("until", json());
      ask.until = until.is_null() ? std::nullopt : std::optional(until_from_json(until));
    } catch (const std::exception& problem) {
      throw StoreDamaged(fmt::format("event {} ({}): {}", event.seq, event.type, problem.what()));
    }
  }
  std::vector<RunAsk> list;
  for (auto& [key, ask] : asks) list.push_back(std::move(ask));
  return list;
}

std::uint64_t checkpoint_cadence(const RunRecord& run) {
  std::uint64_t cadence = 0;
  for (const Membership& m : run.memberships) cadence = std::gcd(cadence, m.checkpoint_every);
  return std::max<std::uint64_t>(cadence, 1);
}

std::vector<std::uint64_t> missing_checkpoints(const Store& store, const RunRecord& run) {
  if (run.kind != name_of(Stage::shear) || engine_of(run.resolved) != EngineKind::shearcell) {
    return {};
  }
  std::set<std::uint64_t> cycles;
  for (const Membership& m : run.memberships) {
    constexpr double longest = 1e6;  // that a manifest may ask for; the store is not trusted
    const double end = std::min({run.cycle, static_cast<double>(m.target_cycles), longest});
    const std::uint64_t every = std::max<std::uint64_t>(m.checkpoint_every, 1);
    for (std::uint64_t cycle = 0; static_cast<double>(cycle) < end; cycle += every) {
      cycles.insert(cycle);
    }
  }
  if (cycles.empty()) return {};
  for (const CheckpointRecord& record : store.checkpoints(run.id, true)) {
    if (record.state == CheckpointState::rejected || std::floor(record.cycle) != record.cycle)
      continue;
    cycles.erase(static_cast<std::uint64_t>(record.cycle));
  }
  return {cycles.begin(), cycles.end()};
}

std::optional<json> ended_early(std::span<const RunAsk> asks,
                                std::span<const MeasuredCycle> measured) {
  if (measured.empty()) return std::nullopt;
  const double now = measured.back().cycle;
  double end = -1;
  json why;
  for (const auto& [target_cycles, until] : asks) {
    const auto reached = std::ranges::find_if(measured, [&](const MeasuredCycle& m) {
      return until && value_of(m.measures, until->measure) >= until->value;
    });
    auto own = static_cast<double>(target_cycles);
    if (reached != measured.end()) {
      own = std::min(own, reached->cycle + static_cast<double>(until->extra_cycles));
    }
    if (now < own) return std::nullopt;
    if (own <= end || reached == measured.end()) continue;
    end = own;
    why = {{"by", "until"},
           {"measure", name_of(until->measure)},
           {"value", until->value},
           {"extra_cycles", until->extra_cycles},
           {"reached_at_cycle", reached->cycle},
           {"memberships", asks.size()}};
  }
  if (why.is_null()) return std::nullopt;
  return why;
}

json end_of(const Store& store, const RunRecord& run) {
  json ended;
  if (run.state != RunState::completed || run.cycle >= static_cast<double>(run.target_cycles)) {
    return ended;
  }
  for (const Event& event : store.events("run/" + run.id)) {
    if (event.type == "RunCompleted")
      ended = event.body().value("/summary/ended"_json_pointer, json());
  }
  return ended.is_object() && ended.value("by", "") == "until" ? ended : json();
}

std::string describe_end(const json& ended) {
  if (ended.is_null()) return "";
  const auto extra = ended.at("extra_cycles").get<std::uint64_t>();
  return fmt::format("{} >= {} at cycle {}{}", ended.at("measure").get<std::string>(),
                     ended.at("value").get<double>(), ended.at("reached_at_cycle").get<double>(),
                     extra > 0 ? fmt::format(" and {} cycles more", extra) : "");
}

std::optional<double> expected_end(const Store& store, const Until& until) {
  double sum = 0, count = 0;
  for (const RunRecord& run : store.runs()) {
    const json ended = end_of(store, run);
    if (ended.is_null() || ended.at("measure") != name_of(until.measure) ||
        ended.at("value") != until.value || ended.at("extra_cycles") != until.extra_cycles) {
      continue;
    }
    sum += run.cycle;
    ++count;
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

RunEnd::RunEnd(const Store& store, const RunRecord& run, std::uint64_t step)
    : store_(store), run_(run.id), cadence_(checkpoint_cadence(run)), cache_(store.folder()) {
  for (const CheckpointRecord& record : store.checkpoints(run.id, true)) {
    if (record.state == CheckpointState::rejected || record.step > step) continue;
    if (!on_cadence(record.cycle)) continue;
    if (auto measures = kept(record)) {
      measured_.push_back({record.cycle, *measures});
      continue;
    }
    try {
      measured_.push_back({record.cycle, measure(record, store.load_checkpoint(record))});
    } catch (const StoreDamaged&) {
    } catch (const CheckpointPruned&) {
    }
  }
}

void RunEnd::add(const CheckpointRecord& record, const Checkpoint& checkpoint) {
  if (on_cadence(record.cycle)) measured_.push_back({record.cycle, measure(record, checkpoint)});
}

std::optional<json> RunEnd::ended() const {
  return ended_early(asks_of(store_, run_), measured_);
}

std::optional<Measures> RunEnd::kept(const CheckpointRecord& record) {
  const DerivedKey key = key_of(record, scalar_measures());
  const auto found = cache_.get(std::span(&key, 1));
  if (!found.front()) return std::nullopt;
  try {
    return read_measures(decode_result(*found.front()));
  } catch (const AnalysisError&) {
    return std::nullopt;  // measured again and replaced
  }
}

Measures RunEnd::measure(const CheckpointRecord& record, const Checkpoint& checkpoint) {
  const Analysis analysis = analyse(checkpoint);
  std::vector<DerivedObject> objects;
  for (const DerivedMeasure* measure : {&scalar_measures(), &crystallite_measure()}) {
    objects.push_back({key_of(record, *measure), encode_result(measure->from(analysis))});
  }
  cache_.put(objects);
  return analysis.measures;
}

bool RunEnd::on_cadence(double cycle) const {
  return std::fmod(cycle, static_cast<double>(cadence_)) == 0;
}

}  // namespace shearcell
