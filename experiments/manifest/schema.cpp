// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/schema.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/named.hpp"
#include "core/simulation.hpp"
#include "experiments/manifest/suggest.hpp"
#include "provenance/io/read_number.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {
namespace {

using nlohmann::json;
using std::string_view;

constexpr Identity kPrepare = {.stage = Stage::prepare};
constexpr Identity kShear = {.stage = Stage::shear};
constexpr Identity kStiffen = {.stage = Stage::stiffen};
constexpr Identity kNoKey = {};

template <auto Member>
ChoiceMember choice() {
  using Enum = std::remove_reference_t<decltype(std::declval<Parameters&>().*Member)>;
  return {kNames<Enum>, [](const Parameters& p) { return name_of(p.*Member); },
          [](Parameters& p, string_view name) { p.*Member = value_of<Enum>(name).value(); }};
}

constexpr Range from(double min, double max) {
  return {min, max};
}

// Lower limit of parameters whose quotients are values in units of d, m and s: keeps these finite.
constexpr double kSmallest = 1e-30;

constexpr Range above(double min, double max) {
  return {min, max, true};
}

Field row(string_view name, string_view symbol, string_view unit, decltype(Field::member) member,
          const Range& range, const Identity& identity, string_view doc) {
  return {name, symbol, unit, member, range, identity, doc};
}

// The number that the text is, infinite if it is too large or too small for a double; else nothing.
std::optional<double> parse_real(string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (stop != end || text.starts_with('+')) return std::nullopt;
  if (error == std::errc::result_out_of_range) return std::numeric_limits<double>::infinity();
  return error == std::errc() ? std::optional(value) : std::nullopt;
}

// Whether the text is like .inf, -.Inf, .nan, inf or NaN.
bool names_no_number(string_view text) {
  std::string word = lower(text);
  std::erase_if(word, [](char c) { return c == '.' || c == '+' || c == '-'; });
  return word == "inf" || word == "infinity" || word == "nan";
}

std::string takes(const Field& field) {
  return fmt::format("It takes {}.", expected_values(field));
}

// The problem with a text that is not an unsigned integer.
ValueProblem not_an_integer(const Field& field, string_view text) {
  const std::optional<double> number = parse_real(text);
  if (number && !field.range.contains(*number)) return {"is out of range", takes(field)};
  if (!number || *number != std::floor(*number)) return {"is not a whole number", takes(field)};
  return {"is not written as a plain whole number", fmt::format("Write {:.0f}.", *number)};
}

std::string range_markdown(const Field& field) {
  if (const auto* member = std::get_if<ChoiceMember>(&field.member)) {
    return fmt::format("{}", fmt::join(member->names, ", "));
  }
  return fmt::format("{}{:g} .. {:g}", field.range.min_excluded ? "> " : "", field.range.min,
                     field.range.max);
}

std::string identity_markdown(const Identity& identity) {
  if (!identity.stage) return "none";
  std::string text(name_of(*identity.stage));
  if (identity.under) text += fmt::format(", if {}", name_of(*identity.under));
  if (!identity.recorded_as.empty())
    return fmt::format("none; recorded as {}", identity.recorded_as);
  if (!identity.omitted_at.empty()) text += fmt::format(", if not {}", identity.omitted_at);
  return text;
}

}  // namespace

Field real_number(string_view name, string_view unit, const Range& range) {
  constexpr double Parameters::*none = nullptr;
  return row(name, "", unit, none, range, {}, "");
}

Field whole_number(string_view name, const Range& range) {
  constexpr std::uint64_t Parameters::*none = nullptr;
  return row(name, "", "1", none, range, {}, "");
}

std::span<const Field> schema() {
  using P = Parameters;
  static const std::array fields = {
      // Grains and what acts on them.
      row("grains", "N", "1", &P::grains, from(1, 1e8), kPrepare, "number of grains"),
      row("mass_kg", "m", "kg", &P::mass_kg, from(kSmallest, 1e6), kPrepare,
          "mass of a grain (Table I)"),
      row("diameter_m", "d", "m", &P::diameter_m, from(kSmallest, 1e3), kPrepare,
          "diameter of a grain (Table I)"),
      row("stiffness_N_per_m", "k", "N/m", &P::stiffness_N_per_m, from(kSmallest, 1e15), kPrepare,
          "spring constant of a contact (Table I)"),
      row("drag_kg_per_s", "b", "kg/s", &P::drag_kg_per_s, from(0, 1e9), kPrepare,
          "Stokes drag constant (Table I)"),
      row("fluid", "", "", choice<&P::fluid>(), {}, kShear,
          "velocity of the fluid in the drag under shear: at rest, or that of the walls at the "
          "same height (B.3, Eq. S5)"),
      row("gravity_m_per_s2", "g", "m/s^2", &P::gravity_m_per_s2, from(0, 1e6), kPrepare,
          "gravitational acceleration (Table I); 0 turns it off (D)"),
      row("pressure_Pa", "P", "Pa", &P::pressure_Pa, from(kSmallest, 1e12), kPrepare,
          "confining pressure (Table I); pressure_at says where it acts"),
      row("pressure_at", "", "", choice<&P::pressure_at>(), {},
          {.stage = Stage::prepare, .omitted_at = "moving_wall"},
          "wall on which the pressure is P: `moving_wall`, whose load is then P A_w, or `top`, for "
          "which a moving bottom wall is loaded with P A_w plus the grains' weight; both are the "
          "same without gravity or with a moving top wall"),
      // The cell.
      row("walls", "", "", choice<&P::walls>(), {}, kPrepare,
          "texture of the walls; rough walls carry fixed wall grains"),
      row("moving_wall", "", "", choice<&P::moving_wall>(), {}, kPrepare,
          "the wall that moves vertically under the pressure (B.6)"),
      row("height_over_width", "", "1", &P::height_over_width, from(0.1, 100), kPrepare,
          "nominal height of the cell over its width L (E)"),
      row("nominal_packing_fraction", "", "1", &P::nominal_packing_fraction, from(1e-9, 0.74),
          kPrepare, "volume fraction at which N grains fill the nominal cell; fixes L"),
      row("wall_grain_area_fraction", "", "1", &P::wall_grain_area_fraction, from(0, 0.53),
          kPrepare,
          "area fraction of a rough wall covered by wall grains; random sequential addition jams "
          "at 0.547"),
      row("wall_grain_recess_diameters", "", "d", &P::wall_grain_recess_diameters, from(0, 0.5),
          kPrepare,
          "wall grain centres lie up to this far behind the wall plane; measures assume 0.25 for "
          "the "
          "walls' surface"),
      row("wall_grain_draw", "", "1", &P::wall_grain_draw, from(0, 1e6),
          {.stage = Stage::prepare, .omitted_at = "0"},
          "other values give other random places of the wall grains for the same seed"),
      row("wall_mass_grains_per_d2", "", "m/d^2", &P::wall_mass_grains_per_d2, above(0, 1e6),
          kPrepare, "mass of the moving wall per area"),
      row("wall_drag_grains_per_d2_s", "", "m/(d^2 s)", &P::wall_drag_grains_per_d2_s, from(0, 1e9),
          kPrepare, "drag constant of the moving wall per area"),
      // Preparation.
      row("fill_packing_fraction", "", "1", &P::fill_packing_fraction, from(1e-9, 0.35), kPrepare,
          "volume fraction of the random sequential addition that settling starts from; it jams "
          "at 0.384"),
      row("settle_time_step_s", "", "s", &P::settle_time_step_s, from(1e-15, 1), kPrepare,
          "time step while settling; not tied to that of the shear, so that variants of the latter "
          "share their packing; `auto` keeps Table I's fraction of the stability limit"),
      row("settle_force_tolerance", "", "1", &P::settle_force_tolerance, above(0, 1), kPrepare,
          "settling ends when the moving wall's force imbalance and drag force over P A_w are "
          "below this"),
      row("settle_kinetic_tolerance", "", "1", &P::settle_kinetic_tolerance, above(0, 1), kPrepare,
          "settling also needs a kinetic energy per grain over P d^3 below this"),
      row("settle_time_limit_s", "", "s", &P::settle_time_limit_s, above(0, 1e6), kPrepare,
          "simulated time after which a packing that has not settled is a failure"),
      row("max_overlap_diameters", "", "d", &P::max_overlap_diameters,
          above(0, kLargestOverlapLimit), {.stage = Stage::prepare, .recorded_as = "0.1"},
          "a stage whose largest overlap exceeds this stops as failed; with a larger value it "
          "continues"),
      // Shear.
      row("protocol", "", "", choice<&P::protocol>(), {}, kShear,
          "what is done to the settled packing: shear without or with pauses (B.5), or stiffening "
          "(B.2)"),
      row("amplitude_rad", "A", "rad", &P::amplitude_rad, from(0, 0.5), kShear,
          "amplitude of the tilt theta = A sin(omega t)"),
      row("period_s", "T", "s", &P::period_s, from(kSmallest, 1e6), kShear,
          "duration of a cycle, 2 pi/omega (Table I: omega = pi rad/s)"),
      row("steps_per_cycle", "", "1", &P::steps_per_cycle, from(4, 1e9), kShear,
          "time steps in a cycle (Table I, B.4); `auto` keeps Table I's fraction of the stability "
          "limit, 0.355"),
      row("pause_s", "", "s", &P::pause_s, above(0, 1e6),
          {.stage = Stage::shear, .under = ProtocolKind::paused},
          "rest between fixed walls after each cycle, under protocol paused (B.5); rounded to "
          "whole time steps"),
      row("pause_walls", "", "", choice<&P::pause_walls>(), {},
          {.stage = Stage::shear, .under = ProtocolKind::paused, .omitted_at = "moving"},
          "the moving wall during a pause: held at its height, or moving under its load"),
      row("cycles", "n", "1", &P::cycles, from(0, 1e6), kNoKey,
          "cycles to shear for; a larger value extends a run"),
      row("engine", "", "", choice<&P::engine>(), {},
          {.stage = Stage::shear, .omitted_at = "shearcell"},
          "what computes the shear: this program, or LAMMPS (another run, equal up to rounding; "
          "settling is always ours)"),
      // Stiffening.
      row("stiffness_decades", "", "1", &P::stiffness_decades, from(0, 6), kNoKey,
          "under protocol stiffen: the spring constant is raised by 10 to this power (B.2); a "
          "larger value extends a run"),
      row("stiffness_steps_per_decade", "", "1", &P::stiffness_steps_per_decade, from(1, 100),
          kStiffen, "number of equal factors for each power of ten (B.2)"),
      row("minimize_force_tolerance", "", "1", &P::minimize_force_tolerance, above(0, 1), kStiffen,
          "after each factor the enthalpy is minimized until the largest net force on a grain over "
          "P d^2, and that on the moving wall over P A_w, are below this"),
  };
  return fields;
}

const Field* find_field(string_view name) {
  return find_named(schema(), name);
}

json get_value(const Field& field, const Parameters& parameters) {
  if (const auto* real = std::get_if<double Parameters::*>(&field.member)) {
    return parameters.**real;
  }
  if (const auto* whole = std::get_if<std::uint64_t Parameters::*>(&field.member)) {
    return parameters.**whole;
  }
  return std::get<ChoiceMember>(field.member).get(parameters);
}

void set_value(const Field& field, const json& value, Parameters& parameters) {
  if (const auto* real = std::get_if<double Parameters::*>(&field.member)) {
    parameters.** real = value.get<double>() + 0.0;  // -0 and 0 are one value
  } else if (const auto* whole = std::get_if<std::uint64_t Parameters::*>(&field.member)) {
    parameters.** whole = value.get<std::uint64_t>();
  } else {
    std::get<ChoiceMember>(field.member).set(parameters, value.get_ref<const std::string&>());
  }
}

bool enters(const Identity& identity, Stage stage, std::optional<ProtocolKind> protocol,
            const json& value) {
  if (!identity.stage || (*identity.stage != Stage::prepare && *identity.stage != stage))
    return false;
  if (identity.under && identity.under != protocol) return false;
  return identity.omitted_at.empty() || value_text(value) != identity.omitted_at;
}

std::string expected_values(const Field& field) {
  if (const auto* member = std::get_if<ChoiceMember>(&field.member)) {
    return fmt::format("one of {}", fmt::join(member->names, ", "));
  }
  if (field.is_whole()) {
    return fmt::format("an integer from {:.0f} to {:.0f}", field.range.min, field.range.max);
  }
  std::string text = "a number";
  if (std::isfinite(field.range.min)) {
    text += fmt::format(" {} {:g}", field.range.min_excluded ? ">" : ">=", field.range.min);
  }
  if (std::isfinite(field.range.max)) text += fmt::format(" and <= {:g}", field.range.max);
  return field.unit == "1" ? text : text + fmt::format(" [{}]", field.unit);
}

std::variant<json, ValueProblem> read_value(const Field& field, string_view text, bool quoted) {
  json value;
  if (std::holds_alternative<ChoiceMember>(field.member)) {
    value = text;
  } else if (quoted) {
    return ValueProblem{"is a quoted text where a number belongs",
                        "Write the number alone, without quotes or a unit."};
  } else if (names_no_number(text)) {
    return ValueProblem{"is not finite", takes(field)};
  } else if (field.is_whole()) {
    const auto whole = read_number<std::uint64_t>(text);
    const bool leading_zero = text.size() > 1 && text.front() == '0';
    if (!whole || leading_zero) return not_an_integer(field, text);
    value = *whole;
  } else {
    const std::optional<double> real = parse_real(text);
    if (!real) return ValueProblem{"is not a number", takes(field)};
    if (std::isinf(*real)) return ValueProblem{"is out of range", takes(field)};
    value = *real;
  }
  if (auto wrong = check_value(field, value)) return std::move(*wrong);
  return value;
}

std::optional<ValueProblem> check_value(const Field& field, const json& value) {
  if (const auto* member = std::get_if<ChoiceMember>(&field.member)) {
    if (!value.is_string()) return ValueProblem{"is not a name", takes(field)};
    const auto& name = value.get_ref<const std::string&>();
    if (std::ranges::find(member->names, name) != member->names.end()) return std::nullopt;
    return ValueProblem{with_nearest("is unknown", name, member->names), takes(field)};
  }
  const bool whole = field.is_whole();
  // Other JSON writers may write a real number without a fraction as an integer.
  if (whole ? !value.is_number_integer() : !value.is_number()) {
    return ValueProblem{whole ? "is not a whole number" : "is not a number", takes(field)};
  }
  const double number = value.get<double>();
  if (!std::isfinite(number)) return ValueProblem{"is not finite", takes(field)};
  if (!field.range.contains(number)) return ValueProblem{"is out of range", takes(field)};
  return std::nullopt;
}

std::string schema_markdown() {
  std::string text =
      "| key | symbol | unit | default | values | key of | meaning |\n"
      "|---|---|---|---|---|---|---|\n";
  for (const Field& field : schema()) {
    text += fmt::format("| `{}` | {} | {} | {} | {} | {} | {} |\n", field.name, field.symbol,
                        field.unit, value_text(get_value(field, Parameters{})),
                        range_markdown(field), identity_markdown(field.identity), field.doc);
  }
  return text;
}

}  // namespace shearcell
