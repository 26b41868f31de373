// SPDX-License-Identifier: GPL-3.0-or-later
// Measures by their names, for tables, plots, claims, exports, the report and Python.
//
// A provider computes some measures of a checkpoint, or of a whole run, in one function. To add
// measures, write a provider beside the function that computes them and add it to the providers of
// that file, which measures.cpp lists. Elsewhere only single measures are named, where a figure or
// a page needs them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/analyse.hpp"
#include "core/scene.hpp"
#include "provenance/records.hpp"

namespace shearcell {

struct FrameRun;  // analysis/figure.hpp
struct RunValue;

/// Raise this version with every change that may alter a bit of any result: results stored with
/// another version are recomputed. tests/analysis/test_derived_measures.cpp pins results to it.
inline constexpr std::uint64_t analysis_version = 2;

/// A function measured on one packing, as g(r): values at ascending x.
struct MeasuredCurve {
  std::vector<double> x, y;
  NLOHMANN_DEFINE_TYPE_INTRUSIVE(MeasuredCurve, x, y)
};

/// What was measured on one checkpoint, by the names of the measures.
struct Measures {
  std::map<std::string, double, std::less<>> numbers = {};
  std::map<std::string, MeasuredCurve, std::less<>> curves = {};
  std::map<std::string, std::vector<double>, std::less<>> of_grains = {};  ///< by grain id
  std::optional<CrystalliteMap> crystallite_map = {};

  /// Not a number where it was not measured.
  double number(std::string_view name) const;
};

/// A `count` is a whole number. `grains` has one number for each grain. `run` is one number of a
/// whole run.
enum class MeasureKind { number, count, curve, grains, run };

/// How a measure of each grain is shown: numbers from `low` to `high`, or 0, 1, ... for classes.
struct GrainScale {
  double low = 0, high = 0;
  std::string_view parameter = {};  ///< parameter of the run: the unit of `low` and `high`
  bool logarithmic = false;
  std::vector<std::string> classes = {};
  bool whole = false;         ///< a whole number, such as a class
  double of_wall_grains = 0;  ///< the value that exports give wall grains
};

struct Measure {
  std::string_view name;  ///< ends in its unit, unless it is a count or a pure number
  std::string_view unit;  ///< "1" for none
  std::string_view meaning;
  MeasureKind kind = MeasureKind::number;
  std::string_view x = {}, x_unit = {};  ///< of a curve
  GrainScale scale = {};                 ///< of a measure of each grain
  RunValue (*of_run)(const FrameRun& run) = nullptr;
  /// The name in sentences; "": `name`. Required for numbers of a whole run and measures of each
  /// grain.
  std::string_view words = {};
  std::string_view reach = {};  ///< what a run must reach to have it
  bool waits = false;           ///< the cycle of an event, before which a run may end
};

/// Energies of all grains and the moving wall over one cycle [m d^2/s^2].
struct CycleEnergies {
  double work_of_walls = 0, dissipation = 0, stored = 0;
};

/// What measures need to know of the run of a checkpoint. The runner fills it in
/// (experiments/runner/measure_sources.hpp), since analysis knows neither manifests nor protocols.
struct RunFacts {
  nlohmann::json parameters = {};   ///< by their keys in a manifest
  std::optional<Drive> drive = {};  ///< of a shear
  /// The state `seconds` after the checkpoint, between upright walls that are held in place. `rest`
  /// and `next_cycle` throw NumericalFailure.
  std::function<State(const Checkpoint& from, double seconds)> rest = {};
  /// Energies of the cycle that begins at the checkpoint, sampled every `stride` steps.
  std::function<CycleEnergies(const Checkpoint& from, std::uint64_t stride)> next_cycle = {};

  /// A number among the parameters; not a number if there is none.
  double number(const char* key) const;
};

/// What measures of a checkpoint are computed from.
struct MeasureInput {
  /// The packing of the checkpoint; may be null for a provider that simulates.
  const Analysis* analysis = nullptr;
  const Checkpoint* checkpoint = nullptr;
  /// Returns the checkpoint of this run that is `Provider::cycles_back` cycles earlier; null if the
  /// run has none.
  std::function<const Checkpoint*()> earlier = {};
  const CheckpointRecord* record = nullptr;
  const RunFacts* run = nullptr;
};

/// SI values of the units of Mechanics at the checkpoint, after any stiffening; not a number if the
/// run's parameters are unknown.
MechanicalUnits mechanical_units(const MeasureInput& input);

/// What a provider needs: `record`, the checkpoint's record in the log; `checkpoint`, its file;
/// `simulation`, a simulation that begins at the checkpoint, which takes longer than an analysis;
/// `history`, the measured checkpoints of a whole run.
enum class ComputedFrom { record, checkpoint, simulation, history };

struct Provider {
  std::string name;
  nlohmann::json parameters =
      nlohmann::json::object();        ///< what results depend on besides the checkpoint
  std::vector<Measure> measures = {};  ///< all of each grain, or none
  /// Returns an object with a value for each measure, by name. A curve is {"x", "y"}; a measure of
  /// each grain is an array. A measure is left out if the run lacks the checkpoint or the shear
  /// that it needs.
  nlohmann::json (*compute)(const MeasureInput& input) = nullptr;
  std::uint64_t cycles_back = 0;  ///< to the earlier checkpoint that it needs; 0 for none
  ComputedFrom from = ComputedFrom::checkpoint;
  std::string_view cost = {};  ///< cost of a simulation, in words
  /// Reads what a result has besides its measures, and checks it.
  void (*read_more)(const nlohmann::json& result, Measures& measures) = nullptr;

  /// Name and parameters as one text: equal texts, equal computation.
  std::string key() const { return name + " " + parameters.dump(); }
  /// Whether results are stored. Results of `record` follow from the log, and measures of each
  /// grain would take more room than the checkpoint.
  bool is_kept() const;
  bool has(MeasureKind kind) const;
  /// Adds a result to the measures. Throws AnalysisError if another provider made the result.
  void read(const nlohmann::json& result, Measures& measures) const;
};

/// All providers, in the order of the columns of tables.
std::span<const Provider> all_providers();
/// The provider of that name, which must exist.
const Provider& provider(std::string_view name);
/// The names of the providers for which the function returns true.
std::vector<std::string> provider_names(bool (*fits)(const Provider&));
/// The provider of volume fractions and numbers of crystallites, which every measured frame has.
inline constexpr const char* scalars_provider = "scalars";
/// The provider of the computing time, which follows from the log (FrameRun::core_time_s).
inline constexpr const char* cost_provider = "cost";

/// The measures of one kind, of all providers. Numbers include counts.
std::vector<const Measure*> all_measures(MeasureKind kind);
/// The measure of that name and kind, or null. Numbers include counts.
const Measure* find_measure(std::string_view name, MeasureKind kind = MeasureKind::number);
/// The provider of a measure that exists.
const Provider& provider_of(const Measure& measure);

/// CBOR (RFC 8949): every double and integer exactly, equal results in equal bytes.
std::vector<std::byte> encode_result(const nlohmann::json& result);
/// Throws AnalysisError when the bytes are not CBOR.
nlohmann::json decode_result(std::span<const std::byte> bytes);

// Parameters of providers.
nlohmann::json with(nlohmann::json parameters, const nlohmann::json& more);
nlohmann::json surface_criteria();
nlohmann::json interior_criteria();
nlohmann::json crystal_criteria();

}  // namespace shearcell
