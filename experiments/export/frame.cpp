// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/export/frame.hpp"

#include <fmt/format.h>

#include <cmath>

#include "analysis/voronoi.hpp"
#include "core/diagnostics.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/manifest/schema.hpp"

namespace shearcell {
namespace {

void place_cell(const Checkpoint& c, const WallPose& pose, Frame& frame) {
  const double d = c.units.diameter_m;
  const double height = (pose.top - pose.bottom) * d;
  const double shift = height * pose.tan_theta;
  frame.origin = Eigen::Vector3d(-shift, pose.bottom * d, 0);
  frame.edges << c.cell.width * d, shift, 0,  //
      0, height, 0,                           //
      0, 0, c.cell.depth * d;
}

void add_grains(const Checkpoint& c, const Eigen::Matrix3Xd& sites, Frame& frame) {
  for (Eigen::Index i = 0; i < c.state.position.cols(); ++i) {
    frame.velocity.col(i) = c.state.velocity.col(i) * c.units.diameter_m;
    const double periods = (c.state.position(2, i) - sites(2, i)) / c.cell.depth;
    frame.image.push_back(static_cast<std::int32_t>(std::lround(periods)));
    frame.type.push_back(0);
  }
}

bool enters_frames(const Provider& one) {
  return one.from == ComputedFrom::checkpoint &&
         (one.has(MeasureKind::number) || one.has(MeasureKind::grains));
}

void add_columns(const Measures& measures, Frame& frame) {
  for (const Measure* measure : all_measures(MeasureKind::grains)) {
    const auto found = measures.of_grains.find(measure->name);
    std::vector<double> values(frame.grains, std::nan(""));
    if (found != measures.of_grains.end()) values = found->second;
    values.resize(frame.particles(), measure->scale.of_wall_grains);
    FrameColumn& column = frame.columns.emplace_back();
    column.name = measure->name;
    if (measure->scale.whole) {
      column.values = std::vector<std::int32_t>(values.begin(), values.end());
    } else {
      column.values = std::move(values);
    }
  }
}

void add_wall_grains(const Checkpoint& c, const WallPose& pose, const Measures& measures,
                     Frame& frame) {
  const double rate = measures.number("shear_rate_per_s");  // only of a shear
  const double shear_rate = std::isnan(rate) ? 0 : rate;
  frame.velocity.rightCols(static_cast<Eigen::Index>(c.cell.wall_grains.size())) =
      wall_grain_velocities(c.cell, pose, shear_rate, c.state.wall_velocity) * c.units.diameter_m;
  for (const WallGrain& grain : c.cell.wall_grains) {
    frame.image.push_back(0);
    frame.type.push_back(1 + static_cast<std::int32_t>(grain.side));
  }
}

void add_facts(const CheckpointRecord& record, const Run& selected, const Measures& measures,
               Frame& frame) {
  const Ask& m = selected.ask;
  frame.run = {{"run", selected.stage.id},
               {"experiment", m.experiment},
               {"scale", m.scale},
               {"variant", m.variant},
               {"seed", m.seed}};
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
               const MeasureSources* sources) {
  const MeasureSources alone(record.run, run.stage);
  const Measures measures =
      (sources == nullptr ? alone : *sources)
          .measures_of(record, checkpoint, analyse_stored(record, checkpoint), enters_frames);
  const WallPose pose = pose_of(checkpoint);
  Frame frame;
  frame.step = checkpoint.state.step;
  frame.time_s = checkpoint.time_s;
  frame.cycle = checkpoint.cycle;
  frame.theta = checkpoint.theta;
  frame.grains = static_cast<std::size_t>(checkpoint.state.position.cols());
  frame.radius = checkpoint.units.diameter_m / 2;
  frame.mass = checkpoint.units.mass_kg;
  const Eigen::Matrix3Xd sites = wrapped_sites(checkpoint.cell, pose, checkpoint.state.position);
  frame.position = sites * checkpoint.units.diameter_m;
  frame.velocity.resize(3, sites.cols());
  add_facts(record, run, measures, frame);
  place_cell(checkpoint, pose, frame);
  add_grains(checkpoint, sites, frame);
  add_wall_grains(checkpoint, pose, measures, frame);
  add_columns(measures, frame);
  add_contacts(checkpoint, pose, measures, frame);
  return frame;
}

}  // namespace shearcell
