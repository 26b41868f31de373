// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/export/exported_state.hpp"

#include <fmt/format.h>

#include <cmath>

#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/manifest/schema.hpp"

namespace shearcell {
namespace {

bool enters_frames(const Provider& one) {
  return one.from == ComputedFrom::checkpoint &&
         (one.has(MeasureKind::number) || one.has(MeasureKind::grains));
}

void add_columns(const Measures& measures, ExportedState& frame) {
  for (const Measure* measure : all_measures(MeasureKind::grains)) {
    const auto found = measures.of_grains.find(measure->name);
    std::vector<double> values(frame.grains, measure->scale.whole ? -1 : std::nan(""));
    if (found != measures.of_grains.end()) values = found->second;
    values.resize(frame.particles(), measure->scale.of_wall_grains);
    frame.columns.push_back({std::string(measure->name), measure->scale.whole, std::move(values)});
  }
}

// The task that continues the stage in LAMMPS. A shear keeps its scene and drive. A packing keeps
// the scene of settling, in which the walls are upright.
std::optional<LammpsTask> continued(const Checkpoint& c, const Stage& stage) {
  try {
    const auto [kind, parent, seed, p, file] = read_stage(stage.resolved);
    if (kind == StageKind::stiffen || c.state.position.cols() == 0) return std::nullopt;
    const bool shears = kind == StageKind::shear;
    return LammpsTask{.cell = c.cell,
                      .scene = shears ? shear_scene(p) : settle_scene(p),
                      .drive = shears ? drive(p) : Drive{},
                      .state = c.state,
                      .units = c.units};
  } catch (const UnreadableRecord&) {
    return std::nullopt;
  }
}

void add_facts(const CheckpointRecord& record, const Run& selected, const RunFacts& run,
               const Measures& measures, ExportedState& frame) {
  frame.run = {{"run", selected.stage.id},
               {"experiment", selected.place.experiment},
               {"scale", scale_name(selected.place.scale)},
               {"variant", selected.place.variant},
               {"seed", selected.place.seed}};
  frame.sha256 = record.sha256;
  for (const auto& [column, cell] : facts_of(record, measures)) {
    const nlohmann::json value = json_of(cell);
    // ExportedState has members for these values.
    if (column.name == "cycle" || column.name == "time_s" || column.name == "checkpoint") continue;
    frame.scalars.emplace_back(column.name, value.is_null() ? std::nan("") : value.get<double>());
  }
  const nlohmann::json parameters = effective_parameters(selected.stage.resolved);
  for (const auto& [key, value] : parameters.items()) {
    if (find_field(key) == nullptr) continue;  // a forged store may have other keys
    if (value.is_number() || value.is_string()) frame.parameters.emplace_back(key, value);
  }
  const double raised = measures.number("raised_stiffness_N_per_m");  // NaN unless `stiffen`
  frame.stiffness_N_per_m = std::isnan(raised) ? run.number("stiffness_N_per_m") : raised;
}

}  // namespace

std::string frame_name(const ExportedState& frame) {
  const double cycle = frame.checkpoint.cycle;
  const std::uint64_t step = frame.checkpoint.state.step;
  return cycle == 0 && step > 0 ? fmt::format("step{}", step) : fmt::format("{}", cycle);
}

ExportedState frame_of(const Checkpoint& checkpoint, const CheckpointRecord& record, const Run& run,
                       const MeasureSources& sources, std::uint64_t every) {
  ExportedState frame;
  const Analysis analysis = analyse_stored(record, checkpoint);
  const Measures measures =
      sources.measures_of(record, every, &checkpoint, &analysis, enters_frames, frame.unread);
  const double rate = measures.number("shear_rate_per_s");  // known only for a shear
  static_cast<Particles&>(frame) =
      particles_of(checkpoint.cell, pose_of(checkpoint), checkpoint.state,
                   std::isnan(rate) ? 0 : rate, checkpoint.units);
  frame.checkpoint = checkpoint;
  add_facts(record, run, sources.facts(record.run), measures, frame);
  add_columns(measures, frame);
  frame.continued = continued(checkpoint, run.stage);
  return frame;
}

}  // namespace shearcell
