// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/more_measures.hpp"

#include <algorithm>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "analysis/published.hpp"
#include "core/drive.hpp"
#include "core/trigonometry.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/runner/measure_sources.hpp"
#include "protocols/ledger.hpp"
#include "protocols/rest.hpp"

namespace shearcell {
namespace {

constexpr double kRest = 0.1;  // [s]
/// Steps between samples of an energy ledger: a period of the fastest vibration at Table I's time
/// step.
constexpr std::uint64_t kLedgerStride = 8;

struct Shear {
  Scene scene;
  Drive drive;
  double unit_J = 0;  // m d^2/s^2 [J]
};

Shear shear_of(const Store& store, const std::string& run) {
  const RunRecord record = store.run(run);
  if (record.kind != name_of(Stage::shear)) return {};
  const Parameters parameters = read_stage(record.resolved).parameters;
  return {shear_scene(parameters), drive(parameters),
          mechanical_units(record, CheckpointRecord()).kinetic_J};
}

/// Checkpoints to simulate from, and the measures to which each result is added.
struct Origins {
  std::vector<CheckpointRecord> from = {};
  std::vector<std::optional<Measures>*> to = {};
};

/// Computes the measure as simulate(record, checkpoint). Calls read(record, result, measures) for
/// each checkpoint that could be read and from which the simulation did not fail.
template <class Simulate, class Read>
void add_simulated(const Store& store, const DerivedMeasure& measure, const Origins& origins,
                   MeasureOptions options, MeasuredPackings& made, const Simulate& simulate,
                   const Read& read) {
  options.instead = [&](const CheckpointRecord& record, const Checkpoint& checkpoint) {
    try {
      return simulate(record, checkpoint);
    } catch (const NumericalFailure&) {
      return nlohmann::json::object();
    }
  };
  const MeasuredCheckpoints found =
      measure_checkpoints(store, origins.from, {&measure, 1}, options);
  made.measured = std::max(made.measured, found.measured);
  add_unread(found, made);
  for (const std::string& sha256 : found.changed) {
    if (std::ranges::count(made.changed, sha256) == 0) made.changed.push_back(sha256);
  }
  if (made.cache_trouble.empty()) made.cache_trouble = found.cache_trouble;
  for (std::size_t n = 0; n < found.results.size(); ++n) {
    const nlohmann::json& result = found.results[n].front();
    if (!result.empty() && *origins.to[n]) read(origins.from[n], result, **origins.to[n]);
  }
}

/// The derived measures among the names, each once.
std::vector<DerivedMeasure> derived_among(std::span<const std::string> names) {
  std::vector<DerivedMeasure> measures;
  for (const std::string& name : names) {
    if (name == "drive" || is_simulated(name)) continue;
    if (std::ranges::find(measures, name, &DerivedMeasure::name) == measures.end()) {
      measures.push_back(derived_measure(name));
    }
  }
  return measures;
}

/// Adds the energies of all grains and the moving wall in the cycle that ends at each checkpoint.
/// The cycle is simulated again from the checkpoint one cycle earlier, which takes three to four
/// times as long as the run did (protocols/ledger.hpp). The result is cached. Adds nothing to a
/// checkpoint within a cycle, or if the earlier checkpoint does not exist or cannot be read.
void add_cycle_energies(const Store& store, std::span<const CheckpointRecord> records,
                        const MeasureOptions& options, MeasuredPackings& made) {
  std::map<std::string, Shear> shears;  // by run; threads must not read the log
  MeasureSources sources(store, options.cadence);
  Origins origins;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const CheckpointRecord& record = records[i];
    auto shear = shears.find(record.run);
    if (shear == shears.end()) {
      shear = shears.emplace(record.run, shear_of(store, record.run)).first;
    }
    if (record.step % cycle_steps(shear->second.drive) != 0) continue;
    sources.read_run(record.run);
    const CheckpointRecord* begin = sources.find(record, 1);
    if (begin == nullptr) continue;
    made.earlier[begin->run].emplace(begin->step, begin->sha256);
    origins.from.push_back(*begin);
    origins.to.push_back(&made.measures[i]);
  }
  const auto simulate = [&](const CheckpointRecord& record, const Checkpoint& checkpoint) {
    const Shear& shear = shears.at(record.run);
    const Ledger sum = ledger(checkpoint.cell, shear.scene, shear.drive, checkpoint.state,
                              cycle_steps(shear.drive), kLedgerStride);
    return nlohmann::json{{"work_of_walls", sum.work_of_walls},
                          {"dissipation", sum.dissipation()},
                          {"stored", sum.stored()}};
  };
  const DerivedMeasure measure{
      "ledger_of_next_cycle", {{"stride", kLedgerStride}}, nullptr, nullptr};
  add_simulated(
      store, measure, origins, options, made, simulate,
      [&](const CheckpointRecord& begin, const nlohmann::json& result, Measures& measures) {
        const double unit_J = shears.at(begin.run).unit_J;
        for (const auto& [name, kept] : {std::pair("work_of_walls_per_cycle_J", "work_of_walls"),
                                         {"dissipation_per_cycle_J", "dissipation"},
                                         {"energy_stored_per_cycle_J", "stored"}}) {
          measures.numbers[name] = result.at(kept).get<double>() * unit_J;
        }
      });
}

/// Adds phi (Eq. S4) after 0.1 s between held walls (protocols/rest.hpp), to compare protocols
/// whose checkpoints are recorded at different shear rates. Only in cycles 1 to early_cycles. The
/// result is cached.
void add_phi_at_rest(const Store& store, std::span<const CheckpointRecord> records,
                     const MeasureOptions& options, MeasuredPackings& made) {
  Origins origins;
  std::map<std::string, Scene> scenes;  // by run; threads must not read the log
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (records[i].cycle < 1 || records[i].cycle > early_cycles) continue;
    origins.from.push_back(records[i]);
    origins.to.push_back(&made.measures[i]);
    const std::string& run = records[i].run;
    if (scenes.contains(run)) continue;
    scenes[run] = shear_scene(read_stage(store.run(run).resolved).parameters);
  }
  DerivedMeasure measure = derived_measure("scalars");
  const auto rest = [&](const CheckpointRecord& record, Checkpoint checkpoint) {
    checkpoint.state =
        rested(checkpoint.cell, scenes.at(record.run), std::move(checkpoint.state), kRest);
    return measure.from({analyse_stored(record, checkpoint)});
  };
  measure.name = "scalars_at_rest";
  measure.parameters["rest_s"] = kRest;
  add_simulated(store, measure, origins, options, made, rest,
                [&](const CheckpointRecord&, const nlohmann::json& result, Measures& measures) {
                  measures.phi_at_rest = read_results({&measure, 1}, {&result, 1}).phi;
                });
}

}  // namespace

bool is_simulated(const std::string& name) {
  return name == "ledger" || name == "at_rest";
}

MeasuredPackings measures_of(const Store& store, std::span<const CheckpointRecord> records,
                             std::span<const std::string> names, const MeasureOptions& options) {
  const std::vector<DerivedMeasure> derived = derived_among(names);
  MeasuredCheckpoints found = measure_checkpoints(store, records, derived, options);
  MeasuredPackings made;
  std::map<std::string, RunRecord> runs;
  for (std::size_t i = 0; i < records.size(); ++i) {
    std::optional<Measures>& one = made.measures.emplace_back();
    if (found.results[i].front().is_null()) continue;
    one = read_results(derived, found.results[i]);
    found.results[i].clear();  // JSON takes more memory than the measures
    const auto [run, first] = runs.try_emplace(records[i].run);
    if (first) run->second = store.run(records[i].run);
    one->units = mechanical_units(run->second, records[i]);
    add_drive(run->second, records[i], *one);
  }
  static_cast<MeasureOutcome&>(made) = std::move(found);
  const auto asks_for = [&](const char* name) {
    return std::ranges::find(names, name) != names.end();
  };
  if (asks_for("at_rest")) add_phi_at_rest(store, records, options, made);
  if (asks_for("ledger")) add_cycle_energies(store, records, options, made);
  return made;
}

void add_drive(const RunRecord& run, const CheckpointRecord& checkpoint, Measures& measures) {
  if (run.kind != name_of(Stage::shear)) return;
  try {
    const Parameters parameters = read_stage(run.resolved).parameters;
    const Drive motion = drive(parameters);
    const auto [theta, rate] = tilt(motion, checkpoint.step);
    const SineCosine sc = sine_cosine(theta);
    // Adding 0 turns -0 into 0.
    measures.numbers["shear_strain"] = sc.sine / sc.cosine + 0.0;
    measures.numbers["shear_rate_per_s"] =
        2 * std::numbers::pi / parameters.period_s * rate / (sc.cosine * sc.cosine) + 0.0;
  } catch (const std::runtime_error&) {
    // This program cannot read the record.
  }
}

}  // namespace shearcell
