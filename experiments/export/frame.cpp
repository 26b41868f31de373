// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/export/frame.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/common_neighbours.hpp"
#include "analysis/motion.hpp"
#include "experiments/figures/more_measures.hpp"

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

void add_grains(const Checkpoint& c, const GrainMeasures& measures, Frame& frame) {
  const double d = c.units.diameter_m;
  for (Eigen::Index i = 0; i < c.state.position.cols(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double periods = std::floor(c.state.position(2, i) / c.cell.depth);
    Eigen::Vector3d r = c.state.position.col(i);
    r.z() -= periods * c.cell.depth;
    frame.position.col(i) = r * d;
    frame.velocity.col(i) = c.state.velocity.col(i) * d;
    frame.image.push_back(static_cast<std::int32_t>(periods));
    frame.type.push_back(0);
    frame.phi_local.push_back(measures.phi_local[k]);
    frame.q6.push_back(measures.q6[k]);
    frame.overlap.push_back(measures.largest_overlap[k]);
    frame.pressure.push_back(measures.pressure[k]);
    frame.contacts.push_back(measures.contacts[k]);
    frame.structure.push_back(static_cast<std::int32_t>(measures.structure[k]));
    frame.crystallite.push_back(measures.crystallites.label[k] + 1);
  }
}

void add_lattices(const Checkpoint& c, const WallPose& pose, Frame& frame) {
  for (const Lattice lattice : common_neighbour_analysis(c.cell, pose, c.state.position)) {
    frame.lattice.push_back(static_cast<std::int32_t>(lattice));
  }
}

void add_motion(const Checkpoint& c, const std::optional<Checkpoint>& earlier, Frame& frame) {
  if (!earlier) {
    frame.displacement.assign(frame.grains, std::nan(""));
    frame.nonaffine.assign(frame.grains, std::nan(""));
    return;
  }
  Motion moved = motion(*earlier, c);
  for (const auto& way : moved.displacement.colwise()) frame.displacement.push_back(way.norm());
  frame.nonaffine = std::move(moved.nonaffine);
}

/// What `table` measures besides an Analysis; only its scalars.
void add_numbers(const Checkpoint& checkpoint, const CheckpointRecord& record,
                 MeasureSources& sources, Analysis& analysis) {
  for (const DerivedMeasure& measure : table_measures()) {
    sources.key(record, measure);
    const auto result = sources.measure(record, checkpoint, analysis, measure);
    if (result) measure.read(*result, analysis.measures);
  }
}

void add_wall_grains(const Checkpoint& c, const WallPose& pose, Frame& frame) {
  const Eigen::Matrix3Xd positions = wall_grain_positions(c.cell, pose);
  const auto grains = static_cast<Eigen::Index>(frame.grains);
  for (Eigen::Index w = 0; w < positions.cols(); ++w) {
    const WallSide side = c.cell.wall_grains[static_cast<std::size_t>(w)].side;
    const bool moves =
        side == (c.cell.moving == MovingWall::bottom ? WallSide::bottom : WallSide::top);
    frame.position.col(grains + w) = positions.col(w) * c.units.diameter_m;
    frame.velocity.col(grains + w) =
        Eigen::Vector3d(0, moves ? c.state.wall_velocity * c.units.diameter_m : 0.0, 0);
    frame.image.push_back(0);
    frame.type.push_back(1 + static_cast<std::int32_t>(side));
    frame.phi_local.push_back(0);
    frame.q6.push_back(0);
    frame.pressure.push_back(0);
    frame.overlap.push_back(0);
    frame.displacement.push_back(0);
    frame.nonaffine.push_back(0);
    frame.contacts.push_back(0);
    frame.lattice.push_back(-1);
    frame.structure.push_back(-1);
    frame.crystallite.push_back(-1);
  }
}

void add_facts(const CheckpointRecord& record, const SelectedRun& selected,
               const Measures& measures, Frame& frame) {
  const Membership& m = selected.membership;
  frame.facts = {{"run", selected.run.id},
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
  const nlohmann::json& resolved = selected.run.resolved;
  const nlohmann::json parameters =
      resolved.is_object() ? resolved.value("parameters", nlohmann::json()) : nlohmann::json();
  for (const auto& [key, value] : parameters.items()) {
    // `grains` is a measure too.
    const bool known =
        std::ranges::any_of(frame.scalars, [&](const auto& scalar) { return scalar.first == key; });
    if (!known && (value.is_number() || value.is_string())) frame.facts.emplace_back(key, value);
  }
}

}  // namespace

Frame frame_of(const Checkpoint& checkpoint, const CheckpointRecord& record, const SelectedRun& run,
               MeasureSources* sources) {
  Analysis analysis = analyse(checkpoint);
  if (sources != nullptr) add_numbers(checkpoint, record, *sources, analysis);
  analysis.measures.units = mechanical_units(run.run, record);
  add_drive(run.run, record, analysis.measures);
  for (double& pressure : analysis.grains.pressure) pressure *= analysis.measures.units.stress_Pa;
  const WallPose pose = wall_pose(checkpoint.cell, checkpoint.theta, checkpoint.state.wall_height);
  Frame frame;
  frame.step = checkpoint.state.step;
  frame.time_s = checkpoint.time_s;
  frame.cycle = checkpoint.cycle;
  frame.theta = checkpoint.theta;
  frame.grains = static_cast<std::size_t>(checkpoint.state.position.cols());
  frame.radius = checkpoint.units.diameter_m / 2;
  frame.mass = checkpoint.units.mass_kg;
  const auto total = checkpoint.state.position.cols() +
                     static_cast<Eigen::Index>(checkpoint.cell.wall_grains.size());
  frame.position.resize(3, total);
  frame.velocity.resize(3, total);
  add_facts(record, run, analysis.measures, frame);
  place_cell(checkpoint, pose, frame);
  add_grains(checkpoint, analysis.grains, frame);
  add_lattices(checkpoint, pose, frame);
  add_motion(checkpoint, sources == nullptr ? std::nullopt : sources->earlier(record, 1), frame);
  add_wall_grains(checkpoint, pose, frame);
  return frame;
}

const std::vector<FrameColumn>& frame_columns() {
  static const std::vector<FrameColumn> columns = {
      {"type", nullptr, &Frame::type},
      {"phi_local", &Frame::phi_local, nullptr},
      {"q6", &Frame::q6, nullptr},
      {"overlap", &Frame::overlap, nullptr},
      {"grain_pressure_Pa", &Frame::pressure, nullptr},
      {"displacement_d", &Frame::displacement, nullptr},
      {"d2min_d2", &Frame::nonaffine, nullptr},
      {"contacts", nullptr, &Frame::contacts},
      {"structure", nullptr, &Frame::structure},
      {"lattice", nullptr, &Frame::lattice},
      {"crystallite", nullptr, &Frame::crystallite},
  };
  return columns;
}

}  // namespace shearcell
