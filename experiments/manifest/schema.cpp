// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/schema.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "core/simulation.hpp"
#include "experiments/manifest/document.hpp"
#include "experiments/manifest/suggest.hpp"
#include "provenance/io/read_number.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {
namespace {

using nlohmann::json;
using std::string_view;

constexpr Identity kPrepare = {.stage = StageKind::prepare};
constexpr Identity kSettling = {.stage = StageKind::prepare, .settles = true};
constexpr Identity kShear = {.stage = StageKind::shear};
constexpr Identity kStiffen = {.stage = StageKind::stiffen};
constexpr Identity kNoKey = {};

// Lower limit of parameters that are divisors in the conversion to d, m and s. It keeps results
// finite.
constexpr double kSmallest = 1e-30;

constexpr Range above(double min, double max) {
  return {min, max, true};
}

// Describes a member of Parameters. Values in JSON are a float, an unsigned integer, or a name.
template <auto Member>
Field row(string_view name, string_view symbol, string_view unit, const Range& range,
          const Identity& identity, string_view doc) {
  using T = std::remove_reference_t<decltype(std::declval<Parameters&>().*Member)>;
  Field field = with_type<T>({name, symbol, unit, range, identity, doc});
  field.get = [](const Parameters& p) -> json {
    if constexpr (std::is_enum_v<T>)
      return name_of(p.*Member);
    else
      return p.*Member;
  };
  field.set = [](Parameters& p, const json& value) {
    if constexpr (std::is_enum_v<T>) {
      p.*Member = value_of<T>(value.get_ref<const std::string&>()).value();
    } else {
      p.*Member = value.get<T>() + T{};  // turns -0 into 0
    }
  };
  return field;
}

// The finite number in a text, or nothing.
std::optional<double> parse_real(string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto value = read_number<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

ValueProblem not_a_number(const Field& field, std::string remedy) {
  return {field.whole ? "is not a whole number" : "is not a number", std::move(remedy)};
}

std::string takes(const Field& field) {
  constexpr std::size_t shown = 20;
  return field.names.size() > shown ? "`shearcell manual` lists them."
                                    : fmt::format("It takes {}.", expected_values(field));
}

std::string range_markdown(const Field& field) {
  if (field.is_choice()) return fmt::format("{}", fmt::join(field.names, ", "));
  return fmt::format("{}{:g} .. {:g}", field.range.min_excluded ? "> " : "", field.range.min,
                     field.range.max);
}

std::string identity_markdown(const Identity& identity) {
  if (!identity.stage) return "none";
  if (identity.selects_parent) return "parent";
  std::string text(name_of(*identity.stage));
  if (identity.under) text += fmt::format(", if {}", name_of(*identity.under));
  if (!identity.recorded_as.empty())
    return fmt::format("none; recorded as {}", identity.recorded_as);
  if (!identity.omitted_at.empty()) text += fmt::format(", if not {}", identity.omitted_at);
  return text;
}

}  // namespace

std::span<const Field> schema() {
  using P = Parameters;
  static const std::array fields = {
      // Grains and what acts on them.
      row<&P::grains>("grains", "N", "1", {1, 1e8}, kPrepare, "number of grains"),
      row<&P::mass_kg>("mass_kg", "m", "kg", {kSmallest, 1e6}, kPrepare,
                       "mass of a grain (Table I)"),
      row<&P::diameter_m>("diameter_m", "d", "m", {kSmallest, 1e3}, kPrepare,
                          "diameter of a grain (Table I)"),
      row<&P::stiffness_N_per_m>("stiffness_N_per_m", "k", "N/m", {kSmallest, 1e15}, kSettling,
                                 "spring constant of a contact (Table I)"),
      row<&P::drag_kg_per_s>("drag_kg_per_s", "b", "kg/s", {0, 1e9}, kSettling,
                             "Stokes drag constant (Table I)"),
      row<&P::fluid>("fluid", "", "", {}, kShear,
                     "fluid that drags the grains during shear: `still` is at rest, `cell` moves "
                     "like the walls at the same height (B.3, Eq. S5)"),
      row<&P::gravity_m_per_s2>("gravity_m_per_s2", "g", "m/s^2", {0, 1e6}, kSettling,
                                "gravitational acceleration (Table I); 0 turns it off (section D)"),
      row<&P::pressure_Pa>("pressure_Pa", "P", "Pa", {kSmallest, 1e12}, kSettling,
                           "confining pressure (Table I); pressure_at says where it acts"),
      row<&P::pressure_at>(
          "pressure_at", "", "", {},
          {.stage = StageKind::prepare, .omitted_at = "moving_wall", .settles = true},
          "wall on which the pressure is P. With `moving_wall`, the load on the moving wall is P "
          "A_w. With `top`, the load on a moving bottom wall is P A_w plus the grains' weight. "
          "`moving_wall` and `top` are equivalent without gravity or with a moving top wall"),
      // The cell.
      row<&P::walls>("walls", "", "", {}, kPrepare,
                     "texture of the walls; rough walls carry fixed wall grains"),
      row<&P::moving_wall>("moving_wall", "", "", {}, kPrepare,
                           "the wall that moves vertically under the pressure (B.6)"),
      row<&P::height_over_width>("height_over_width", "", "1", {0.1, 100}, kPrepare,
                                 "nominal height of the cell divided by its width L (section E)"),
      row<&P::nominal_packing_fraction>(
          "nominal_packing_fraction", "", "1", {1e-9, 0.74}, kPrepare,
          "volume fraction at which N grains fill the nominal cell; fixes L"),
      row<&P::wall_grain_area_fraction>(
          "wall_grain_area_fraction", "", "1", {0, 0.53}, kPrepare,
          "fraction of a rough wall's area that is covered by wall grains; random sequential "
          "addition jams at 0.547"),
      row<&P::wall_grain_recess_diameters>(
          "wall_grain_recess_diameters", "", "d", {0, 0.5}, kPrepare,
          "largest distance of wall grain centres behind the wall plane. Measures that use the "
          "surface of a rough wall assume the value 0.25"),
      row<&P::wall_grain_draw>(
          "wall_grain_draw", "", "1", {0, 1e6}, {.stage = StageKind::prepare, .omitted_at = "0"},
          "each value gives other random positions of the wall grains for the same seed"),
      row<&P::wall_mass_grains_per_d2>("wall_mass_grains_per_d2", "", "m/d^2", above(0, 1e6),
                                       kSettling, "mass per area of the moving wall"),
      row<&P::wall_drag_grains_per_d2_s>("wall_drag_grains_per_d2_s", "", "m/(d^2 s)", {0, 1e9},
                                         kSettling, "drag constant per area of the moving wall"),
      // Preparation.
      row<&P::fill_packing_fraction>("fill_packing_fraction", "", "1", {1e-9, 0.35}, kPrepare,
                                     "volume fraction of the grains before they settle; they are "
                                     "placed by random sequential addition, which jams at 0.384"),
      row<&P::settle_time_step_s>("settle_time_step_s", "", "s", {1e-15, 1}, kPrepare,
                                  "time step while settling; independent of the time step of the "
                                  "shear, so that variants of the shear share their packing; "
                                  "`auto`: 0.355 times the stability limit, as in Table I"),
      row<&P::settle_force_tolerance>(
          "settle_force_tolerance", "", "1", above(0, 1), kPrepare,
          "upper limit of the force imbalance and of the drag force of the moving wall, each "
          "divided by P A_w. Settling ends when both forces are below this limit, and the kinetic "
          "energy is below settle_kinetic_tolerance"),
      row<&P::settle_kinetic_tolerance>("settle_kinetic_tolerance", "", "1", above(0, 1), kPrepare,
                                        "limit of the kinetic energy per grain, divided by P "
                                        "d^3; see settle_force_tolerance"),
      row<&P::settle_time_limit_s>(
          "settle_time_limit_s", "", "s", above(0, 1e6), kPrepare,
          "simulated time after which a run fails if its packing has not settled"),
      row<&P::max_overlap_diameters>("max_overlap_diameters", "", "d",
                                     above(0, kLargestOverlapLimit),
                                     {.stage = StageKind::prepare, .recorded_as = "0.1"},
                                     "a stage fails and stops if its largest overlap exceeds this "
                                     "value. To continue the stage, raise the value"),
      // Shear.
      row<&P::protocol>(
          "protocol", "", "", {}, kShear,
          "what is done to the settled packing: shear without or with pauses (B.5), or stiffening "
          "(B.2)"),
      row<&P::amplitude_rad>("amplitude_rad", "A", "rad", {0, 0.5}, kShear,
                             "amplitude of the tilt theta = A sin(omega t)"),
      // Smallest settle_time_step_s = smallest period_s / largest steps_per_cycle.
      row<&P::period_s>("period_s", "T", "s", {1e-6, 1e6}, kShear,
                        "duration of a cycle, 2 pi/omega (Table I: omega = pi rad/s)"),
      row<&P::steps_per_cycle>(
          "steps_per_cycle", "", "1", {4, 1e9}, kShear,
          "time steps in a cycle (Table I, B.4); `auto` keeps the time step at 0.355 times the "
          "stability limit, as in Table I"),
      row<&P::pause_s>(
          "pause_s", "", "s", above(0, 1e6),
          {.stage = StageKind::shear, .under = ProtocolKind::paused},
          "with protocol `paused`: duration of the pause at zero tilt after each cycle "
          "(B.5); rounded to whole time steps"),
      row<&P::pause_walls>(
          "pause_walls", "", "", {},
          {.stage = StageKind::shear, .under = ProtocolKind::paused, .omitted_at = "moving"},
          "whether, during a pause, the moving wall is held at its height or moves under its load"),
      row<&P::cycles>("cycles", "n", "1", {0, 1e6}, kNoKey,
                      "number of shear cycles; if the value is raised later, an existing run "
                      "continues"),
      row<&P::engine>("engine", "", "", {}, {.stage = StageKind::shear, .omitted_at = "shearcell"},
                      "program that computes the shear. A run with LAMMPS has a different id and "
                      "different rounding errors. shearcell always computes the settling"),
      // Start from a recorded state.
      row<&P::start_seed>("start_seed", "", "1", {0, 9007199254740991},
                          {.stage = StageKind::shear, .selects_parent = true},
                          "with `start`: the seed of the recorded run"),
      row<&P::start_cycle>("start_cycle", "", "1", {0, 1e6},
                           {.stage = StageKind::shear, .omitted_at = "0"},
                           "with `start`: the cycle of the recorded run at which this run begins"),
      row<&P::start_noise_d>("start_noise_d", "", "d", {0, 0.1},
                             {.stage = StageKind::shear, .omitted_at = "0"},
                             "with `start`: standard deviation of normal noise on the positions; "
                             "the seed decides the noise"),
      // Stiffening.
      row<&P::stiffness_decades>("stiffness_decades", "", "1", {0, 6}, kNoKey,
                                 "under protocol stiffen: number of powers of ten by which the "
                                 "stiffness increases (B.2); if the value is raised later, an "
                                 "existing run continues"),
      row<&P::stiffness_steps_per_decade>(
          "stiffness_steps_per_decade", "", "1", {1, 100}, kStiffen,
          "number of steps that together raise the stiffness by a factor of ten (B.2)"),
      row<&P::minimize_force_tolerance>(
          "minimize_force_tolerance", "", "1", above(0, 1), kStiffen,
          "after each step the enthalpy is minimized until the largest net force on a grain, "
          "divided by P d^2, and the net force on the moving wall, divided by P A_w, are below "
          "this value"),
  };
  return fields;
}

const Field* find_field(string_view name) {
  return find_named(schema(), name);
}

bool enters(const Identity& identity, StageKind stage, std::optional<ProtocolKind> protocol,
            const json& value) {
  if (!identity.stage || identity.selects_parent) return false;
  if (*identity.stage != StageKind::prepare && *identity.stage != stage) return false;
  if (identity.under && identity.under != protocol) return false;
  return identity.omitted_at.empty() || value_text(value) != identity.omitted_at;
}

std::string expected_values(const Field& field) {
  if (field.is_choice()) {
    return fmt::format("one of {}{}", fmt::join(field.names, ", "), field.besides);
  }
  if (field.whole) {
    return fmt::format("an integer from {:.0f} to {:.0f}{}", field.range.min, field.range.max,
                       field.besides);
  }
  std::string text = "a number";
  if (std::isfinite(field.range.min)) {
    text += fmt::format(" {} {:g}", field.range.min_excluded ? ">" : ">=", field.range.min);
  }
  if (std::isfinite(field.range.max)) text += fmt::format(" and <= {:g}", field.range.max);
  return has_unit(field) ? text + fmt::format(" [{}]", field.unit) : text;
}

std::variant<json, ValueProblem> read_value(const Field& field, string_view text, bool quoted) {
  json value = text;
  if (!field.is_choice()) {
    const std::optional<double> real = quoted ? std::nullopt : parse_real(text);
    if (!real) {
      return not_a_number(field, takes(field) +
                                     " Write the number alone, with a decimal point, without "
                                     "quotes, separators or a unit.");
    }
    if (text.size() > 1 && text[0] == '0' && std::isdigit(text[1]) != 0) {
      return ValueProblem{"begins with a zero",
                          fmt::format("{} Otherwise write {}.", kDecimalPoint, *real)};
    }
    const bool whole = field.whole && field.range.contains(*real) && *real == std::floor(*real);
    value = whole ? json(static_cast<std::uint64_t>(*real)) : json(*real);
  }
  if (auto wrong = check_value(field, value)) return std::move(*wrong);
  return value;
}

std::optional<ValueProblem> check_value(const Field& field, const json& value) {
  if (field.is_choice()) {
    if (!value.is_string()) return ValueProblem{"is not a name", takes(field)};
    const auto& name = value.get_ref<const std::string&>();
    if (std::ranges::find(field.names, name) != field.names.end()) return std::nullopt;
    return ValueProblem{with_nearest("is unknown", name, field.names), takes(field)};
  }
  if (!value.is_number()) return not_a_number(field, takes(field));
  if (!field.range.contains(value.get<double>())) {
    return ValueProblem{"is out of range", takes(field)};
  }
  // A real field also accepts an integer, because other JSON writers may write 2.0 as 2.
  if (field.whole && !value.is_number_integer()) return not_a_number(field, takes(field));
  return std::nullopt;
}

std::string schema_markdown() {
  std::string text =
      "| key | symbol | unit | default | values | key of | meaning |\n"
      "|---|---|---|---|---|---|---|\n";
  for (const Field& field : schema()) {
    text += fmt::format("| `{}` | {} | {} | {} | {} | {} | {} |\n", field.name, field.symbol,
                        field.unit, value_text(field.get(Parameters{})), range_markdown(field),
                        identity_markdown(field.identity), field.doc);
  }
  return text;
}

}  // namespace shearcell
