// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/export/frame.hpp"

#include <fmt/format.h>

#include <cmath>

#include "analysis/common_neighbours.hpp"
#include "analysis/motion.hpp"
#include "analysis/voronoi.hpp"
#include "experiments/figures/more_measures.hpp"
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

void add_columns(const Checkpoint& c, const WallPose& pose, const GrainMeasures& measures,
                 const Motion& moved, Frame& frame) {
  const auto add = [&](const char* name, const auto& of_grains, auto of_wall_grains) {
    std::vector<decltype(of_wall_grains)> values;
    for (const auto value : of_grains)
      values.push_back(static_cast<decltype(of_wall_grains)>(value));
    values.resize(frame.particles(), of_wall_grains);
    frame.columns.push_back({name, std::move(values)});
  };
  const Eigen::VectorXd displacement = moved.displacement.colwise().norm();
  add("phi_local", measures.phi_local, 0.0);
  add("q6", measures.q6, 0.0);
  add("overlap", measures.largest_overlap, 0.0);
  add("grain_pressure_Pa", measures.pressure, 0.0);
  add("displacement_d", displacement, 0.0);
  add("d2min_d2", moved.nonaffine, 0.0);
  add("contacts", measures.contacts, 0);
  add("structure", measures.structure, -1);
  add("lattice", common_neighbour_analysis(c.cell, pose, c.state.position), -1);
  std::vector<int> crystallite = measures.crystallites.label;
  for (int& label : crystallite) ++label;
  add("crystallite", crystallite, -1);
}

/// Adds the measures of `table` that analyse_stored() does not give.
void add_numbers(const Checkpoint& checkpoint, const CheckpointRecord& record,
                 MeasureSources& sources, Analysis& analysis) {
  sources.read_run(record.run);
  UnreadCheckpoints unread;
  for (const std::string& name : table_measures()) {
    const DerivedMeasure& measure = derived_measure(name);
    const auto result = sources.measure(record, checkpoint, analysis, measure, unread);
    if (result) measure.read(*result, analysis.measures);
  }
}

void add_wall_grains(const Checkpoint& c, const WallPose& pose, const Measures& measures,
                     Frame& frame) {
  const auto rate = measures.numbers.find("shear_rate_per_s");  // only of a shear
  const double shear_rate = rate == measures.numbers.end() ? 0 : rate->second;
  frame.velocity.rightCols(static_cast<Eigen::Index>(c.cell.wall_grains.size())) =
      wall_grain_velocities(c.cell, pose, shear_rate, c.state.wall_velocity) * c.units.diameter_m;
  for (const WallGrain& grain : c.cell.wall_grains) {
    frame.image.push_back(0);
    frame.type.push_back(1 + static_cast<std::int32_t>(grain.side));
  }
}

void add_facts(const CheckpointRecord& record, const SelectedRun& selected,
               const Measures& measures, Frame& frame) {
  const Membership& m = selected.membership;
  frame.run = {{"run", selected.run.id},
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
  const nlohmann::json parameters = effective_parameters(selected.run.resolved);
  for (const auto& [key, value] : parameters.items()) {
    if (find_field(key) == nullptr) continue;  // a forged store may hold it
    if (value.is_number() || value.is_string()) frame.parameters.emplace_back(key, value);
  }
}

}  // namespace

std::string frame_name(const Frame& frame) {
  const bool settles = frame.cycle == 0 && frame.step > 0;
  return settles ? fmt::format("step{}", frame.step) : fmt::format("{}", frame.cycle);
}

Frame frame_of(const Checkpoint& checkpoint, const CheckpointRecord& record, const SelectedRun& run,
               MeasureSources* sources) {
  Analysis analysis = analyse_stored(record, checkpoint);
  if (sources != nullptr) add_numbers(checkpoint, record, *sources, analysis);
  analysis.measures.units = mechanical_units(run.run, record);
  add_drive(run.run, record, analysis.measures);
  for (double& pressure : analysis.grains.pressure) pressure *= analysis.measures.units.stress_Pa;
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
  add_facts(record, run, analysis.measures, frame);
  place_cell(checkpoint, pose, frame);
  add_grains(checkpoint, sites, frame);
  add_wall_grains(checkpoint, pose, analysis.measures, frame);
  const auto earlier = sources == nullptr ? std::nullopt : sources->earlier(record, 1);
  add_columns(checkpoint, pose, analysis.grains, motion_since(earlier, checkpoint), frame);
  return frame;
}

}  // namespace shearcell
