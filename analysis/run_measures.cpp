// SPDX-License-Identifier: GPL-3.0-or-later
// Measures that need the run of a checkpoint: its drive, the values that the engine recorded,
// simulations that begin at the checkpoint, and the computing time of the run.
#include <numbers>

#include "analysis/figure.hpp"
#include "analysis/measures.hpp"
#include "core/drive.hpp"
#include "core/trigonometry.hpp"
#include "core/watchdog.hpp"
#include "provenance/errors.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

constexpr double rest_s = 0.1;
/// Steps between samples of an energy ledger. At the time step of Table I these steps last one
/// period of the fastest vibration.
constexpr std::uint64_t ledger_stride = 8;

json drive_of(const MeasureInput& input) {
  if (!input.run->drive) return json::object();
  const auto [theta, rate] = tilt(*input.run->drive, input.record->step);
  const SineCosine sc = sine_cosine(theta);
  const double omega = 2 * std::numbers::pi / input.run->number("period_s");
  // Adding 0 turns -0 into 0.
  return {{"shear_strain", sc.sine / sc.cosine + 0.0},
          {"shear_rate_per_s", omega * rate / (sc.cosine * sc.cosine) + 0.0}};
}

/// Repeats the simulation of the last cycle before the checkpoint. The simulation
/// begins at the checkpoint that was recorded one cycle earlier.
json ledger_of(const MeasureInput& input) try {
  if (!input.run->drive || input.record->step % cycle_steps(*input.run->drive) != 0) {
    return json::object();
  }
  const Checkpoint* begin = input.earlier();
  if (begin == nullptr) return json::object();
  const CycleEnergies sum = input.run->next_cycle(*begin, ledger_stride);
  const double unit_J = mechanical_units(input).kinetic_J;
  return {{"work_of_walls_per_cycle_J", sum.work_of_walls * unit_J},
          {"dissipation_per_cycle_J", sum.dissipation * unit_J},
          {"energy_stored_per_cycle_J", sum.stored * unit_J}};
} catch (const NumericalFailure&) {
  return json::object();
}

json rest_of(const MeasureInput& input) try {
  if (!input.run->rest) return json::object();
  Checkpoint rested = *input.checkpoint;
  rested.state = input.run->rest(rested, rest_s);
  return {{"phi_at_rest", analyse(rested).measures.phi}};
} catch (const NumericalFailure&) {
  return json::object();
} catch (const AnalysisError&) {  // grains left the cell
  return json::object();
}

json record_of(const MeasureInput& input) {
  json found = {{"time_s", input.record->time_s}};
  for (const auto& [name, value] : input.record->observables) {
    found[name == "stiffness_N_per_m" ? "raised_stiffness_N_per_m" : name] = value;
  }
  return found;
}

}  // namespace

std::vector<Provider> run_providers() {
  return {
      {.name = "drive",
       .measures =
           {{"shear_strain", "1", "tan(theta), where theta is the tilt of the side walls"},
            {"shear_rate_per_s", "1/s",
             "rate of change of shear_strain; at the end of a pause, the rate at which shear "
             "starts again"}},
       .compute = drive_of,
       .from = ComputedFrom::record},
      // protocols/ledger.hpp defines the energy balance.
      {.name = "ledger",
       .parameters = {{"stride", ledger_stride}},
       .measures =
           {{"work_of_walls_per_cycle_J", "J",
             "work of the tilting walls on all grains in the cycle before the checkpoint"},
            {"dissipation_per_cycle_J", "J",
             "energy that all grains and the moving wall lost by drag in the cycle before the "
             "checkpoint"},
            {"energy_stored_per_cycle_J", "J",
             "change of the total energy in the cycle before the checkpoint: elastic, kinetic and "
             "gravitational energy of all grains, and energy of the load"}},
       .compute = ledger_of,
       .cycles_back = 1,
       .from = ComputedFrom::simulation,
       .cost = "3 to 4 times as long as the cycle"},
      // Makes checkpoints with different shear rates comparable (protocols/rest.hpp).
      {.name = "rest",
       .parameters = {{"rest_s", rest_s}},
       .measures = {{"phi_at_rest", "1",
                     "volume fraction of interior grains (Eq. S4), after the walls were held in "
                     "place for 0.1 s",
                     MeasureKind::number, "phi at rest"}},
       .compute = rest_of,
       .from = ComputedFrom::simulation,
       .cost = "a twentieth of a cycle"},
      {.name = "record",
       .measures = {{"time_s", "s", "simulated time since the stage began"},
                    {"cell_height_d", "d", "distance between the bottom and top walls"},
                    {"largest_overlap_d", "d",
                     "largest overlap of two grains, or of a grain and a wall grain"},
                    {"kinetic_energy_per_grain_m_d2_per_s2", "m d^2/s^2",
                     "mean kinetic energy of a grain of mass m"},
                    {"wall_force_imbalance", "1",
                     "load minus contact force on the moving wall, divided by P A_w"},
                    {"raised_stiffness_N_per_m", "N/m", "spring constant in a stiffening stage"},
                    {"force_residual_P_d2", "P d^2",
                     "largest net force on a grain, divided by P d^2, at a checkpoint of a "
                     "stiffening stage"}},
       .compute = record_of,
       .from = ComputedFrom::record},
      {.name = cost_provider,
       .measures = {{.name = "core_time_s",
                     .unit = "s",
                     .meaning = "processor time of all steps of the run, over all attempts and "
                                "machines, without the time to make the packing. If several "
                                "experiments use one run, each counts the full time. Without "
                                "recorded processor time: wall-clock time x number of processes",
                     .kind = MeasureKind::run,
                     .words = "the core time",
                     .of_run = [](const FrameRun& run) { return measured(run.core_time_s); },
                     .reach = "its end"}},
       .from = ComputedFrom::history}};
}

}  // namespace shearcell
