// SPDX-License-Identifier: GPL-3.0-or-later
// The one table of manifest parameters: name, unit, type, range, default, part in a run's
// identity, and meaning. Validation, suggestions, identity and the reference all read it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "experiments/manifest/parameters.hpp"

namespace shearcell {

/// The stage whose key a parameter enters. Settling comes first, so what settling feels enters the
/// key of `prepare` and, through its parent's key, that of `shear` as well. `paused_shear` enters
/// that of `shear` where the protocol is `paused`, and `stiffen` that of the stage of that name.
/// `prepare_if_set` and `shear_if_set` are as `prepare` and `shear` where the value is not the
/// default: for a parameter that is younger than the stores, whose runs it must not rename.
enum class Identity : std::uint8_t {
  prepare,
  prepare_if_set,
  shear,
  shear_if_set,
  paused_shear,
  stiffen,
  none
};

/// A parameter that takes one of a few names; the index of the name stands for its value.
struct ChoiceMember {
  std::span<const std::string_view> names;
  std::size_t (*get)(const Parameters&);
  void (*set)(Parameters&, std::size_t);
};

struct Field {
  std::string_view name;
  std::string_view symbol;  ///< as the supplement writes it; empty when it has none
  std::string_view unit;    ///< "1" for a pure number, empty for a choice
  std::variant<double Parameters::*, std::uint64_t Parameters::*, ChoiceMember> member;
  double min = 0;             ///< smallest value allowed, numbers only
  double max = 0;             ///< largest value allowed
  bool min_excluded = false;  ///< the value must be greater than `min`
  Identity identity = Identity::none;
  std::string_view doc;
};

/// Every parameter, in the order in which the reference lists them.
std::span<const Field> schema();

/// The parameter of that name, or nullptr.
const Field* find_field(std::string_view name);

/// What is wrong with a value, and what to write instead.
struct ValueProblem {
  std::string problem;
  std::string remedy;
};

/// Reads one value from its text in a manifest; a real number is always a JSON float and an integer
/// always unsigned, so that 1 and 1.0 are the same value. The range is not checked here.
std::variant<nlohmann::json, ValueProblem> read_value(const Field& field, std::string_view text,
                                                      bool quoted);

/// Type and range. nullopt when the value may be used.
std::optional<ValueProblem> check_value(const Field& field, const nlohmann::json& value);

/// One parameter as JSON, and back. `value` must have passed check_value.
nlohmann::json get_value(const Field& field, const Parameters& parameters);
void set_value(const Field& field, const nlohmann::json& value, Parameters& parameters);

/// Reads exactly the parameters for which `expected` holds; the others keep their defaults. The
/// JSON is not trusted: throws std::runtime_error that names the key.
Parameters read_parameters(const nlohmann::json& json,
                           const std::function<bool(const Field&)>& expected);

/// "a number > 0 and <= 1e+06", "one of still, cell".
std::string expected_values(const Field& field);

/// Names of all parameters, in schema order.
std::vector<std::string_view> field_names();

/// The table of keys in experiments/manifest/README.md.
std::string schema_markdown();

}  // namespace shearcell
