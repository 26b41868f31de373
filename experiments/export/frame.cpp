// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/export/frame.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/diagnostics.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/manifest/schema.hpp"

namespace shearcell {
namespace {

bool enters_frames(const Provider& one) {
  return one.from == ComputedFrom::checkpoint &&
         (one.has(MeasureKind::number) || one.has(MeasureKind::grains));
}

void add_columns(const Measures& measures, Frame& frame) {
  for (const Measure* measure : all_measures(MeasureKind::grains)) {
    const auto found = measures.of_grains.find(measure->name);
    std::vector<double> values(frame.grains, measure->scale.whole ? -1 : std::nan(""));
    if (found != measures.of_grains.end()) values = found->second;
    values.resize(frame.particles(), measure->scale.of_wall_grains);
    frame.columns.push_back({std::string(measure->name), measure->scale.whole, std::move(values)});
  }
}

// A packing goes on settling under the forces of its scene.
std::optional<LammpsTask> continued(const Checkpoint& c, const Stage& stage) {
  const auto kind = value_of<StageKind>(stage.kind);
  if (!kind || kind == StageKind::stiffen || c.state.position.cols() == 0) return std::nullopt;
  try {
    const Parameters p = read_stage(stage.resolved).parameters;
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

void add_facts(const CheckpointRecord& record, const Run& selected, const Measures& measures,
               Frame& frame) {
  frame.run = {{"run", selected.stage.id},
               {"experiment", selected.experiment},
               {"scale", scale_name(selected.scale)},
               {"variant", selected.variant},
               {"seed", selected.seed}};
  frame.checkpoint = record.sha256;
  for (const auto& [column, value] : facts_of(record, measures)) {
    // Members of Frame.
    if (column.name == "cycle" || column.name == "time_s" || column.name == "checkpoint") continue;
    frame.scalars.emplace_back(column.name, value.is_null() ? std::nan("") : value.get<double>());
  }
  const nlohmann::json parameters = effective_parameters(selected.stage.resolved);
  for (const auto& [key, value] : parameters.items()) {
    if (find_field(key) == nullptr) continue;  // a forged store may hold it
    if (value.is_number() || value.is_string()) frame.parameters.emplace_back(key, value);
  }
}

/// After add_facts().
void add_contacts(const Checkpoint& c, const WallPose& pose, const Measures& measures,
                  Frame& frame) {
  double stiffness = measures.number("raised_stiffness_N_per_m");  // only of a stiffening
  for (const auto& [key, value] : frame.parameters) {
    if (key == "stiffness_N_per_m" && std::isnan(stiffness)) stiffness = value.get<double>();
  }
  const auto add = [&](const Contact& contact) {
    const auto other = static_cast<std::size_t>(contact.other) + 1;
    const bool of_grains = contact.kind == Contact::Kind::grain;
    frame.contacts.push_back({.grain = static_cast<std::size_t>(contact.grain) + 1,
                              .other = of_grains ? other
                                       : contact.kind == Contact::Kind::wall_grain
                                           ? frame.grains + other
                                           : 0,
                              .side = of_grains ? 0 : 1 + static_cast<std::int32_t>(contact.side),
                              .overlap = contact.overlap,
                              .force = stiffness * contact.overlap * c.units.diameter_m,
                              .normal = contact.normal});
  };
  for_each_contact(c.cell, c.state.position, pose, add);
}

}  // namespace

std::string frame_name(const Frame& frame) {
  const bool settles = frame.cycle == 0 && frame.step > 0;
  return settles ? fmt::format("step{}", frame.step) : fmt::format("{}", frame.cycle);
}

Frame frame_of(const Checkpoint& checkpoint, const CheckpointRecord& record, const Run& run,
               const MeasureSources* sources, std::uint64_t every) {
  const MeasureSources alone(record.run, run.stage);
  const Measures measures = (sources == nullptr ? alone : *sources)
                                .measures_of(record, every, checkpoint,
                                             analyse_stored(record, checkpoint), enters_frames);
  const WallPose pose = pose_of(checkpoint);
  const double rate = measures.number("shear_rate_per_s");  // only of a shear
  Frame frame;
  static_cast<Particles&>(frame) = particles_of(checkpoint.cell, pose, checkpoint.state,
                                                std::isnan(rate) ? 0 : rate, checkpoint.units);
  frame.step = checkpoint.state.step;
  frame.time_s = checkpoint.time_s;
  frame.cycle = checkpoint.cycle;
  frame.theta = checkpoint.theta;
  add_facts(record, run, measures, frame);
  add_columns(measures, frame);
  add_contacts(checkpoint, pose, measures, frame);
  frame.continued = continued(checkpoint, run.stage);
  return frame;
}

}  // namespace shearcell
