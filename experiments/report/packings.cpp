// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/packings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <set>

#include "analysis/chart.hpp"
#include "analysis/voronoi.hpp"
#include "experiments/manifest/suggest.hpp"
#include "experiments/report/html.hpp"
#include "experiments/runner/measure.hpp"
#include "experiments/runner/outlook.hpp"
#include "experiments/runner/registered.hpp"
#include "provenance/json_text.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

using nlohmann::json;
using namespace nlohmann::literals;

constexpr double kSteps = 65534;  // of 16 bits; the word 65535 means unknown

/// Appends a share from 0 to 1 in 16 or 8 bits. The largest number means unknown.
void put(double share, bool wide, std::vector<std::byte>& bytes) {
  const double most = wide ? kSteps : 254;
  const double number = std::isnan(share) ? most + 1 : most * std::clamp(share, 0.0, 1.0);
  const auto word = static_cast<std::uint32_t>(std::lround(number));
  bytes.push_back(static_cast<std::byte>(word & 0xFFU));
  if (wide) bytes.push_back(static_cast<std::byte>(word >> 8U));
}

/// If the measure has 16 bits, the largest value that they hold; 0 for a measure with 8 bits.
double exact_to(const Measure& measure) {
  if (measure.name == "crystallite") return kSteps;
  return measure.name == "phi_local" || measure.name == "q6" ? 1 : 0;
}

double share_of(double value, const GrainField& field) {
  const GrainScale& scale = field.measure->scale;
  if (const double most = exact_to(*field.measure); most > 0) return value / most;
  if (!scale.classes.empty()) return value / 254;
  return scale.logarithmic ? std::log(value / field.low) / std::log(field.high / field.low)
                           : (value - field.low) / (field.high - field.low);
}

/// Estimated size of the facts and profiles of a frame, as JSON [bytes].
constexpr std::size_t kFactsInPage = 2500;

struct ChosenRun : Run {
  std::vector<CheckpointRecord> checkpoints = {};  // after fit() only those that the page shows
  std::size_t bytes = 0;                           // size of one checkpoint in the HTML page
  std::size_t wall_grains = 0;
};

/// Returns the runs of `choice`. If an experiment has more variants than are shown, the shown ones
/// are evenly spaced in the list of variants.
std::vector<ChosenRun> choose(const Store& store, const std::vector<std::string>& experiments,
                              const RunSelection& selection, const PackingChoice& choice) {
  std::vector<ChosenRun> chosen;
  for (const std::string& id : choice.runs) {
    const Stage stage = store.find_stage(id);
    chosen.push_back({{first_place(stage), {}, stage}, store.checkpoints(stage.id)});
  }
  if (!choice.runs.empty()) return chosen;
  std::set<std::string> known;
  const std::vector<Run> runs = newest_runs(select_runs(store, selection)).runs;
  for (const std::string& experiment : experiments) {
    nlohmann::ordered_map<std::string, ChosenRun> last;  // by variant
    for (const Run& run : runs) {
      if (run.place.experiment != experiment) continue;
      auto checkpoints = asked_checkpoints(run.stage, asks_of(run.stage.memberships),
                                           store.checkpoints(run.stage.id))
                             .made;
      if (!checkpoints.empty()) last[run.place.variant] = {run, std::move(checkpoints)};
    }
    for (const std::size_t k : evenly(last.size(), choice.runs_per_experiment)) {
      ChosenRun& run = std::next(last.begin(), static_cast<std::ptrdiff_t>(k))->second;
      if (known.insert(run.stage.id).second) chosen.push_back(std::move(run));
    }
  }
  return chosen;
}

/// Sets ChosenRun::wall_grains and ChosenRun::bytes from the run's newest readable checkpoint.
/// Removes runs without a readable checkpoint.
void weigh(const Store& store, std::vector<ChosenRun>& runs, Packings& packings) {
  std::size_t bytes_per_grain = 0;
  for (const Measure* one : all_measures(MeasureKind::grains)) {
    bytes_per_grain += exact_to(*one) > 0 ? 2 : 1;
  }
  for (ChosenRun& run : runs) {
    while (!run.checkpoints.empty() && run.bytes == 0) {
      const auto read = [&](std::size_t) {
        run.wall_grains = store.load_checkpoint(run.checkpoints.back()).cell.wall_grains.size();
        run.bytes =
            frame_size_in_page(run.stage.grains, run.wall_grains, bytes_per_grain) + kFactsInPage;
      };
      packings += read_in_parallel(1, 1, read, {});
      if (run.bytes == 0) run.checkpoints.pop_back();
    }
  }
  std::erase_if(runs, [](const ChosenRun& run) { return run.checkpoints.empty(); });
}

std::size_t bytes_with(const std::vector<ChosenRun>& runs, std::size_t frames) {
  std::size_t bytes = 0;
  for (const ChosenRun& run : runs) bytes += run.bytes * std::min(frames, run.checkpoints.size());
  return bytes;
}

void fit(std::vector<ChosenRun>& runs, const PackingChoice& choice, Packings& packings) {
  std::vector<std::string> left_out;
  while (!runs.empty() && bytes_with(runs, 1) > choice.budget) {
    left_out.push_back(
        fmt::format("{:.8} of {}", runs.back().stage.id, runs.back().place.experiment));
    runs.pop_back();
  }
  if (!left_out.empty()) {
    packings.notes.push_back(fmt::format(
        "no room for the packings of {} ({}); to show more packings, raise --packings-mb",
        counted(left_out.size(), "run"), some_of(left_out)));
  }
  std::size_t frames = std::max<std::size_t>(1, choice.frames);
  while (frames > 1 && bytes_with(runs, frames) > choice.budget) --frames;
  for (ChosenRun& run : runs) {
    std::vector<CheckpointRecord> kept;
    for (const std::size_t k : evenly(run.checkpoints.size(), frames)) {
      kept.push_back(std::move(run.checkpoints[k]));
    }
    run.checkpoints = std::move(kept);
  }
}

std::string frame_name(const CheckpointRecord& record) {
  const auto stiffness = record.observables.find("stiffness_N_per_m");
  if (stiffness != record.observables.end()) {
    return fmt::format("state {:g}, k = {:.4g} N/m", record.cycle, stiffness->second);
  }
  return fmt::format("cycle {:.6g}", record.cycle);
}

json facts_of(const PackingMeasures& measures, double theta) {
  json facts = json::array();
  if (measures.interior_grains > 0) {
    facts.push_back(to_json(formula(fmt::format("$ϕ$ = {:.4f}", measures.phi))));
    facts.push_back(to_json(
        fmt::format("{:.1f} % of the interior grains crystalline", measures.crystalline_percent)));
    facts.push_back(to_json(fmt::format("largest crystallite {}", measures.largest_crystallite)));
  }
  if (theta != 0) facts.push_back(to_json(fmt::format("tilt {:.4f} rad", theta)));
  return facts;
}

/// The packings of a run share their value ranges, so that their colours can be compared.
std::vector<GrainField> make_fields(const Measures& measures, const GrainMeasures& grains,
                                    const RunFacts& run) {
  std::vector<GrainField> fields;
  for (const Measure* measure : all_measures(MeasureKind::grains)) {
    GrainField& field = fields.emplace_back(GrainField{.measure = measure});
    const GrainScale& scale = measure->scale;
    double unit = 1;
    if (!scale.parameter.empty()) unit = run.number(std::string(scale.parameter).c_str());
    if (!(unit > 0)) unit = 1e3;  // the record of the run is damaged
    field.low = scale.low * unit, field.high = scale.high * unit;
    const auto found = measures.of_grains.find(measure->name);
    field.value = found == measures.of_grains.end() ? std::vector(grains.q6.size(), std::nan(""))
                                                    : found->second;
    if (measure->name != "structure") continue;
    for (std::size_t i = 0; i < field.value.size(); ++i) field.value[i] += 4 * grains.interior[i];
  }
  return fields;
}

/// {"key", "label", "exact_to", "unit", "low", "high"} or {"key", "label", "exact_to", "classes"}.
json describe(const GrainField& field) {
  const Measure& measure = *field.measure;
  json described = {
      {"key", measure.name}, {"label", measure.words}, {"exact_to", exact_to(measure)}};
  if (!measure.scale.classes.empty()) {
    described["classes"] = measure.scale.classes;
  } else {
    described.update({{"unit", measure.unit == "1" ? "" : measure.unit},
                      {"low", field.low},
                      {"high", field.high}});
  }
  return described;
}

json profile_json(const std::vector<double>& values, double unit = 1) {
  return list_of(values, [&](double value) { return rounded(value * unit, 6); });
}

json profiles_json(const Measures& measures) {
  const MeasuredCurve& phi = measures.curves.at("phi_profile");
  return {{"height", profile_json(phi.x)},
          {"phi", profile_json(phi.y)},
          {"pressure", profile_json(measures.curves.at("pressure_profile_Pa").y, 1e-3)},
          {"coordination", profile_json(measures.curves.at("coordination_profile").y)},
          {"crystalline", profile_json(measures.curves.at("crystalline_profile_percent").y)}};
}

bool enters_page(const Provider& one) {
  return one.has(MeasureKind::grains) || one.name == "profiles";
}

json make_frame(const CheckpointRecord& record, const MeasureSources& sources,
                MeasureOutcome& unread) {
  const Checkpoint checkpoint = sources.load(record);
  const Analysis analysis = analyse_stored(record, checkpoint);
  const WallPose pose = pose_of(checkpoint);
  const Measures measures =
      sources.measures_of(record, 1, &checkpoint, &analysis, enters_page, unread);
  const std::vector<GrainField> fields =
      make_fields(measures, analysis.grains, sources.facts(record.run));
  const EncodedFrame encoded = encode_frame(checkpoint, pose, fields);
  return {{"name", frame_name(record)},
          {"cycle", record.cycle},
          {"sha256", record.sha256},
          {"facts", facts_of(analysis.measures, checkpoint.theta)},
          {"crystalline", rounded(analysis.measures.crystalline_percent, 4)},
          {"cell",
           {{"width", checkpoint.cell.width},
            {"depth", checkpoint.cell.depth},
            {"bottom", pose.bottom},
            {"top", pose.top},
            {"tan_theta", pose.tan_theta}}},
          {"fields", list_of(fields, describe)},
          {"profiles", profiles_json(measures)},
          {"origin", std::vector(encoded.origin.begin(), encoded.origin.end())},
          {"step", std::vector(encoded.step.begin(), encoded.step.end())},
          {"data", base64(encoded.bytes)}};
}

}  // namespace

EncodedFrame encode_frame(const Checkpoint& checkpoint, const WallPose& pose,
                          std::span<const GrainField> fields) {
  const Eigen::Matrix3Xd position = wrapped_sites(checkpoint.cell, pose, checkpoint.state.position);
  EncodedFrame frame;
  frame.origin = position.rowwise().minCoeff();
  const Eigen::Vector3d extent = position.rowwise().maxCoeff() - frame.origin;
  frame.step = extent / kSteps;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    for (const double place : position.row(axis)) {
      put((place - frame.origin[axis]) / extent[axis], true, frame.bytes);
    }
  }
  for (const GrainField& field : fields) {
    for (const double value : field.value) {
      put(share_of(value, field), exact_to(*field.measure) > 0, frame.bytes);
    }
  }
  return frame;
}

std::size_t frame_size_in_page(std::size_t grains, std::size_t wall_grains,
                               std::size_t bytes_per_grain) {
  const std::size_t bytes = 6 * (grains + wall_grains) + bytes_per_grain * grains;
  return (bytes + 2) / 3 * 4;
}

std::vector<std::size_t> evenly(std::size_t size, std::size_t count) {
  count = std::min(count, size);
  if (count == 1) return {size - 1};
  std::vector<std::size_t> chosen;
  for (std::size_t k = 0; k < count; ++k) {
    chosen.push_back((k * (size - 1) + (count - 1) / 2) / (count - 1));
  }
  return chosen;
}

Packings collect_packings(const Store& store, const std::vector<std::string>& experiments,
                          const RunSelection& selection, const PackingChoice& choice,
                          std::size_t workers, const ReadProgress& report) {
  Packings packings;
  std::vector<ChosenRun> runs = choose(store, experiments, selection, choice);
  const VariantNames names(store);
  weigh(store, runs, packings);
  fit(runs, choice, packings);

  std::vector<CheckpointRecord> records;
  MeasureSources sources(store);
  for (const ChosenRun& run : runs) {
    for (const CheckpointRecord& record : run.checkpoints) {
      sources.read_run(record.run);
      records.push_back(record);
    }
  }
  std::vector<json> frames(records.size());  // null if a checkpoint cannot be read
  std::vector<MeasureOutcome> unread(records.size());
  const auto make = [&](std::size_t k) { frames[k] = make_frame(records[k], sources, unread[k]); };
  packings += read_in_parallel(records.size(), workers, make, report);
  for (const MeasureOutcome& earlier : unread) packings += earlier;
  auto next = frames.begin();
  for (const ChosenRun& run : runs) {
    json list = json::array();
    for (std::size_t k = 0; k < run.checkpoints.size(); ++k, ++next) {
      if (next->is_null()) continue;
      for (const double step : next->at("step")) {
        packings.largest_step = std::max(packings.largest_step, step);
      }
      list.push_back(std::move(*next));
    }
    packings.frames += list.size();
    if (list.empty()) continue;
    packings.runs.push_back(
        {{"id", run.stage.id},
         {"label", fmt::format("{}, seed {}, N = {}", names.of(run.stage, run.place),
                               run.place.seed, run.stage.grains)},
         {"experiment", run.place.experiment},
         {"grains", run.stage.grains},
         {"wall_grains", run.wall_grains},
         {"frames", std::move(list)}});
  }
  return packings;
}

}  // namespace shearcell
