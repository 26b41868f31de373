// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/within_cycle.hpp"

#include <map>
#include <string>
#include <utility>

#include "core/drive.hpp"
#include "core/trigonometry.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/identity.hpp"
#include "protocols/ledger.hpp"

namespace shearcell {
namespace {

constexpr double kTurn = 6.28318530717958647692;

// A run that shears, and its checkpoints that may begin a cycle.
struct Shear {
  Scene scene;
  Drive drive;
  double unit_J = 0;                                      // m d^2/s^2
  std::map<std::uint64_t, CheckpointRecord> begins = {};  // by step
};

Shear shear_of(const Store& store, const std::string& run) {
  const RunRecord record = store.run(run);
  if (record.kind != name_of(Stage::shear)) return {};
  const Parameters parameters = read_stage(record.resolved).parameters;
  Shear shear{shear_scene(parameters), drive(parameters),
              mechanical_units(record, CheckpointRecord()).kinetic_J};
  for (CheckpointRecord& checkpoint : store.checkpoints(run, true)) {
    if (checkpoint.state == CheckpointState::rejected) continue;
    if (checkpoint.step % cycle_steps(shear.drive) != 0) continue;
    shear.begins.insert_or_assign(checkpoint.step, std::move(checkpoint));
  }
  return shear;
}

const DerivedMeasure& cycle_ledger() {
  static const DerivedMeasure measure{"ledger_of_next_cycle", {{"stride", kLedgerStride}}, nullptr};
  return measure;
}

CycleEnergy read_energy(const nlohmann::json& kept, double unit_J) {
  return {kept.at("work_of_walls").get<double>() * unit_J,
          kept.at("dissipation").get<double>() * unit_J, kept.at("stored").get<double>() * unit_J};
}

}  // namespace

void add_drive(const RunRecord& run, const CheckpointRecord& checkpoint, Measures& measures) {
  if (run.kind != name_of(Stage::shear)) return;
  try {
    const Parameters parameters = read_stage(run.resolved).parameters;
    const Drive motion = drive(parameters);
    const auto [theta, rate] = tilt(motion, checkpoint.step);
    const SineCosine sc = sine_cosine(theta);
    // Adding 0 makes -0 a 0.
    measures.numbers["shear_strain"] = sc.sine / sc.cosine + 0.0;
    measures.numbers["shear_rate_per_s"] =
        kTurn / parameters.period_s * rate / (sc.cosine * sc.cosine) + 0.0;
  } catch (const std::runtime_error&) {
    // Not a run of this program.
  }
}

void add_energy(const CycleEnergy& energy, Measures& measures) {
  measures.numbers["work_of_walls_per_cycle_J"] = energy.work_of_walls;
  measures.numbers["dissipation_per_cycle_J"] = energy.dissipation;
  measures.numbers["energy_stored_per_cycle_J"] = energy.stored;
}

std::vector<CycleEnergy> cycle_energies(const Store& store,
                                        std::span<const CheckpointRecord> records,
                                        const MeasureOptions& options) {
  std::map<std::string, Shear> shears;  // by run; threads must not read the log
  std::vector<CheckpointRecord> begins;
  std::vector<std::size_t> place;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const CheckpointRecord& record = records[i];
    auto shear = shears.find(record.run);
    if (shear == shears.end()) {
      shear = shears.emplace(record.run, shear_of(store, record.run)).first;
    }
    const std::uint64_t whole = cycle_steps(shear->second.drive);
    if (record.step < whole) continue;
    const auto begin = shear->second.begins.find(record.step - whole);
    if (begin == shear->second.begins.end()) continue;
    begins.push_back(begin->second);
    place.push_back(i);
  }
  MeasureOptions simulating = options;
  simulating.instead = [&](const CheckpointRecord& record, const Checkpoint& checkpoint) {
    const Shear& shear = shears.at(record.run);
    const Ledger sum = ledger(checkpoint.cell, shear.scene, shear.drive, checkpoint.state,
                              cycle_steps(shear.drive), kLedgerStride);
    return nlohmann::json{{"work_of_walls", sum.work_of_walls},
                          {"dissipation", sum.dissipation()},
                          {"stored", sum.stored()}};
  };
  const auto found = measure_checkpoints(store, begins, std::span(&cycle_ledger(), 1), simulating);
  std::vector<CycleEnergy> energies(records.size());
  for (std::size_t n = 0; n < begins.size(); ++n) {
    const nlohmann::json& result = found.results[n].front();
    if (result.is_null()) continue;
    energies[place[n]] = read_energy(result, shears.at(begins[n].run).unit_J);
  }
  return energies;
}

}  // namespace shearcell
