// SPDX-License-Identifier: GPL-3.0-or-later
// Measures by name, for tables, plots, claims, exports, the report and Python.
//
// A provider is one function that computes some measures of a checkpoint or of a whole run. To add
// measures, write a provider in the file that computes them, and add it to the list of providers
// in the same file; measures.cpp joins these lists. Figures and pages may refer to single measures.
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

struct FrameRun;  // analysis/frame.hpp
struct RunValue;

/// Increase this version if any result may no longer be bit-identical. Stored results of other
/// versions are recomputed. tests/analysis/test_derived_measures.cpp checks some results.
inline constexpr std::uint64_t analysis_version = 2;

/// A function measured on one packing, such as g(r): values y at ascending x.
struct MeasuredCurve {
  std::vector<double> x, y;
  NLOHMANN_DEFINE_TYPE_INTRUSIVE(MeasuredCurve, x, y)
};

/// The results of one checkpoint, by the names of the measures.
struct Measures {
  std::map<std::string, double, std::less<>> numbers = {};
  std::map<std::string, MeasuredCurve, std::less<>> curves = {};
  std::map<std::string, std::vector<double>, std::less<>> of_grains = {};  ///< by grain id
  std::optional<CrystalliteMap> crystallite_map = {};

  /// The value of the measure `name`; NaN if it was not measured.
  double number(std::string_view name) const;
};

/// What a measure is: a number, a whole number (`count`), a function (`curve`), one number for each
/// grain (`grains`), or one number of a whole run (`run`).
enum class MeasureKind { number, count, curve, grains, run };

/// How a measure of each grain is displayed: from `low` to `high`, or as classes 0, 1, ...
struct GrainScale {
  double low = 0, high = 0;
  std::string_view parameter = {};  ///< run parameter by which `low` and `high` are multiplied
  bool logarithmic = false;
  std::vector<std::string> classes = {};
  bool whole = false;         ///< values are integers
  double of_wall_grains = 0;  ///< the value that exports write for wall grains
};

struct Measure {
  std::string name;       ///< ends in the unit, unless the measure is a count or a pure number
  std::string_view unit;  ///< "1" if it has no unit
  std::string meaning;
  MeasureKind kind = MeasureKind::number;
  /// Name for use in sentences. The kinds `run` and `grains` require it. For the other kinds it may
  /// be empty; sentences then use `name`.
  std::string_view words = {};
  std::string_view x = {}, x_unit = {};  ///< x axis of a curve
  GrainScale scale = {};                 ///< used if `kind` is `grains`
  RunValue (*of_run)(const FrameRun& run) = nullptr;
  std::string_view reach = {};  ///< the event that a run must reach to have a value
  bool waits = false;           ///< the value is the cycle of an event that may never occur
};

inline Measure of_grains(std::string name, std::string_view unit, std::string meaning,
                         std::string_view words, GrainScale scale) {
  return {std::move(name), unit, std::move(meaning), MeasureKind::grains, words, {}, {},
          std::move(scale)};
}

/// Energies of all grains and the moving wall over one cycle [m d^2/s^2].
struct CycleEnergies {
  double work_of_walls = 0, dissipation = 0, stored = 0;
};

/// What providers know about the run of a checkpoint. The runner (experiments/runner/measure.hpp)
/// fills it in, since analysis does not depend on manifests and protocols.
struct RunFacts {
  nlohmann::json parameters = {};   ///< values by their keys in a manifest
  std::optional<Drive> drive = {};  ///< only of a shear
  /// Continues the simulation from the checkpoint for `seconds`, between upright walls that are
  /// held in place. Both `rest` and `next_cycle` throw NumericalFailure.
  std::function<State(const Checkpoint& from, double seconds)> rest = {};
  /// Simulates the cycle that begins at the checkpoint, with a sample every `stride` steps.
  std::function<CycleEnergies(const Checkpoint& from, std::uint64_t stride)> next_cycle = {};

  /// The parameter as a number; NaN if it is not a number.
  double number(const char* key) const;
};

struct MeasureInput {
  /// Analysis of the checkpoint's packing; may be null for a provider that simulates.
  const Analysis* analysis = nullptr;
  const Checkpoint* checkpoint = nullptr;
  /// Returns the checkpoint of this run that is `Provider::cycles_back` cycles earlier; null if the
  /// run has none.
  std::function<const Checkpoint*()> earlier = {};
  const CheckpointRecord* record = nullptr;
  const RunFacts* run = nullptr;
};

/// SI values of the units of Mechanics. If the checkpoint was stiffened, the raised stiffness is
/// used. NaN if the run's parameters are unknown.
MechanicalUnits mechanical_units(const MeasureInput& input);

/// What a provider needs. `record`: the checkpoint's record in the log. `checkpoint`: its file.
/// `simulation`: a simulation that begins at the checkpoint (slower than an analysis).
/// `history`: the measured checkpoints of a whole run.
enum class ComputedFrom { record, checkpoint, simulation, history };

struct Provider {
  std::string name;
  nlohmann::json parameters = nlohmann::json::object();  ///< settings on which the results depend
  std::vector<Measure> measures = {};  ///< either all are per-grain measures, or none is
  /// Returns an object with a value for each measure, by name. A curve is {"x", "y"}; a per-grain
  /// measure is an array. A measure is left out if it cannot be computed, for example because
  /// the run has no earlier checkpoint or because the stage is not a shear.
  std::function<nlohmann::json(const MeasureInput& input)> compute = {};
  /// If not 0, the provider needs a second checkpoint, this many cycles earlier.
  std::uint64_t cycles_back = 0;
  ComputedFrom from = ComputedFrom::checkpoint;
  std::string_view cost = {};  ///< computing time of a simulation, in words
  /// Reads and checks the parts of a result that are not measures.
  void (*read_more)(const nlohmann::json& result, Measures& measures) = nullptr;

  /// Name and parameters as one text. Providers with equal texts compute the same results.
  std::string key() const { return name + " " + parameters.dump(); }
  /// Whether results are stored. Results from `record` and `history` are not stored, because they
  /// are cheap to compute. Measures of each grain are not stored, because they need more space than
  /// the checkpoint.
  bool is_kept() const;
  bool has(MeasureKind kind) const;
  /// Adds a result to `measures`. Throws AnalysisError if the result is not from this provider.
  void read(const nlohmann::json& result, Measures& measures) const;
};

/// All providers, in the order of table columns.
std::span<const Provider> all_providers();
/// The provider with this name, which must exist.
const Provider& provider(std::string_view name);
std::vector<std::string> provider_names(bool (*fits)(const Provider&));
/// Provider of volume fractions and numbers of crystallites. Every measured frame contains them.
inline constexpr const char* scalars_provider = "scalars";
/// Provider of the computing time, which is read from the log (FrameRun::core_time_s).
inline constexpr const char* cost_provider = "cost";

/// The measures of one kind from all providers. Kind `number` includes `count`.
std::vector<const Measure*> all_measures(MeasureKind kind);
/// The measure with this name and kind, or null. Kind `number` includes `count`.
const Measure* find_measure(std::string_view name, MeasureKind kind = MeasureKind::number);
/// The provider that computes `measure`. There must be such a provider.
const Provider& provider_of(const Measure& measure);

/// Encodes a result exactly, as CBOR (RFC 8949). Equal results have equal bytes.
std::vector<std::byte> encode_result(const nlohmann::json& result);
/// Decodes CBOR. Throws AnalysisError if the bytes are not CBOR.
nlohmann::json decode_result(std::span<const std::byte> bytes);

// Parameters of providers. with() adds `more` to `parameters`.
nlohmann::json with(nlohmann::json parameters, const nlohmann::json& more);
nlohmann::json surface_criteria();
nlohmann::json interior_criteria();
nlohmann::json crystal_criteria();

}  // namespace shearcell
