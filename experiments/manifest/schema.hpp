// SPDX-License-Identifier: GPL-3.0-or-later
// Field describes a key of a manifest: its allowed values and its meaning. schema() lists all
// parameters and how each enters the id of a run. Reading, suggestions, ids and
// experiments/REFERENCE.md use this list.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>

#include "core/named.hpp"
#include "experiments/manifest/parameters.hpp"

namespace shearcell {

/// How a parameter enters the records from which the ids of stages are computed. A parameter of
/// `prepare` enters the records of all stages; others enter only the record of their own stage.
struct Identity {
  /// The first stage whose record has an entry for the parameter. Empty if no record has one.
  std::optional<StageKind> stage = {};
  std::optional<ProtocolKind> under = {};  ///< recorded only for this protocol; empty: for all
  /// The record omits the parameter if its value_text() is this text. All runs that are older than
  /// the parameter have this value, which may differ from the default.
  std::string_view omitted_at = {};
  /// Every new record holds this value, whatever the value of the parameter, because the parameter
  /// is no longer part of the identity. Records of older runs may hold other values.
  std::string_view recorded_as = {};
  /// True if the parameter selects the parent stage. Records then hold the id of the parent stage
  /// instead of the parameter.
  bool selects_parent = false;
  /// True if `settle` may give another value, for the time while the packing settles.
  bool settles = false;

  /// Whether runs with different values of the parameter have different ids.
  bool distinguishes_runs() const { return stage && recorded_as.empty(); }
};

struct Range {
  double min = 0;
  double max = 0;
  bool min_excluded = false;  ///< the value must be greater than `min`

  bool contains(double value) const {
    return (min_excluded ? value > min : value >= min) && value <= max;
  }
};

/// A key of a manifest: its allowed values and its meaning.
struct Field {
  std::string_view name = {};
  std::string_view symbol = {};  ///< in the supplement; "" if the supplement has none
  std::string_view unit = {};    ///< of a number; "1" if it is dimensionless
  Range range = {};              ///< of a number
  Identity identity = {};        ///< of a parameter
  std::string_view doc = {};
  std::span<const std::string_view> names = {};  ///< the allowed values of a choice
  std::string_view besides = {};                 ///< appended to the allowed values in messages
  bool whole = false;                            ///< only whole numbers are allowed
  std::span<const std::string_view> terms = {};  ///< names allowed in expressions; if empty, none
  std::string_view example = {};                 ///< as YAML
  bool required = false;
  std::size_t longest = 0;  ///< maximum length of a free text [bytes]; 0: the text is a name
  bool folds = false;       ///< the text may have several lines, which become one
  /// get() converts a parameter to JSON; set() reads it from valid JSON. Both are null if the
  /// key is not a parameter.
  nlohmann::json (*get)(const Parameters&) = nullptr;
  void (*set)(Parameters&, const nlohmann::json&) = nullptr;

  bool is_choice() const { return !names.empty(); }
};

/// Whether the values of the key are numbers with a unit.
inline bool has_unit(const Field& field) {
  return !field.unit.empty() && field.unit != "1";
}

/// Sets `names` if the member has an enumeration as its type T, and `whole` if T is an integer.
template <class T>
constexpr Field with_type(Field field) {
  if constexpr (std::is_enum_v<T>) field.names = kNames<T>;
  if constexpr (std::is_integral_v<T>) field.whole = true;
  return field;
}

/// Every parameter, in the order in which the reference lists them.
std::span<const Field> schema();

/// The parameter with this name, or nullptr.
const Field* find_field(std::string_view name);

/// True for the keys that set the length of a run or the number of seeds. They are not part of a
/// run's id, so `grid` cannot sweep them; `zip` can set them for each variant.
inline bool is_length(std::string_view key) {
  return key == "cycles" || key == "seeds";
}

/// A problem with a value, and what to write instead.
struct ValueProblem {
  std::string problem;
  std::string remedy;
};

/// Reads a value from its text in a manifest and checks it. The JSON of a real number is always a
/// float, so that 1 and 1.0 are equal; the JSON of an integer is unsigned.
std::variant<nlohmann::json, ValueProblem> read_value(const Field& field, std::string_view text,
                                                      bool quoted);

/// Checks the type and range of a value. Returns nothing if the value is valid.
std::optional<ValueProblem> check_value(const Field& field, const nlohmann::json& value);

/// Whether the record of a stage contains a parameter with this identity and this value.
bool enters(const Identity& identity, StageKind stage, std::optional<ProtocolKind> protocol,
            const nlohmann::json& value);

/// The allowed values: "a number > 0 and <= 1e+06", "one of still, cell".
std::string expected_values(const Field& field);

/// The table of parameters in experiments/REFERENCE.md.
std::string schema_markdown();

}  // namespace shearcell
