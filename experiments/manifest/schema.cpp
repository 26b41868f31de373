// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/schema.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

namespace shearcell {
namespace {

using std::string_view;

constexpr Identity kPrepare = {.stage = Stage::prepare};
constexpr Identity kShear = {.stage = Stage::shear};
constexpr Identity kStiffen = {.stage = Stage::stiffen};
constexpr Identity kNoKey = {};

template <auto Member>
ChoiceMember choice() {
  using Enum = std::remove_reference_t<decltype(std::declval<Parameters&>().*Member)>;
  return {kNameList<Enum>, [](const Parameters& p) { return name_of(p.*Member); },
          [](Parameters& p, string_view name) { p.*Member = value_of<Enum>(name).value(); }};
}

Field number(string_view name, string_view symbol, string_view unit, double Parameters::*member,
             double min, bool min_excluded, double max, const Identity& identity, string_view doc) {
  return {name, symbol, unit, member, min, max, min_excluded, identity, doc};
}

Field above_zero(string_view name, string_view symbol, string_view unit, double Parameters::*member,
                 double max, const Identity& identity, string_view doc) {
  return number(name, symbol, unit, member, 0, true, max, identity, doc);
}

Field from_zero(string_view name, string_view symbol, string_view unit, double Parameters::*member,
                double max, const Identity& identity, string_view doc) {
  return number(name, symbol, unit, member, 0, false, max, identity, doc);
}

Field integer(string_view name, string_view symbol, std::uint64_t Parameters::*member, double min,
              double max, const Identity& identity, string_view doc) {
  return {name, symbol, "1", member, min, max, false, identity, doc};
}

Field names(string_view name, string_view symbol, ChoiceMember member, Identity identity,
            string_view doc) {
  return {name, symbol, "", member, 0, 0, false, identity, doc};
}

std::vector<Field> grain_fields() {
  using P = Parameters;
  return {
      integer("grains", "N", &P::grains, 1, 1e8, kPrepare, "number of grains"),
      above_zero("mass_kg", "m", "kg", &P::mass_kg, 1e6, kPrepare, "mass of a grain (Table I)"),
      above_zero("diameter_m", "d", "m", &P::diameter_m, 1e3, kPrepare,
                 "diameter of a grain (Table I)"),
      above_zero("stiffness_N_per_m", "k", "N/m", &P::stiffness_N_per_m, 1e15, kPrepare,
                 "spring constant of a contact (Table I)"),
      from_zero("drag_kg_per_s", "b", "kg/s", &P::drag_kg_per_s, 1e9, kPrepare,
                "Stokes drag constant (Table I)"),
      names("fluid", "", choice<&P::fluid>(), kShear,
            "velocity of the fluid in the drag under shear: at rest, or that of the walls at the "
            "same height (B.3, Eq. S5)"),
      from_zero("gravity_m_per_s2", "g", "m/s^2", &P::gravity_m_per_s2, 1e6, kPrepare,
                "gravitational acceleration (Table I); 0 turns it off (D)"),
      above_zero("pressure_Pa", "P", "Pa", &P::pressure_Pa, 1e12, kPrepare,
                 "pressure on the moving wall (Table I)"),
      names("pressure_at", "", choice<&P::pressure_at>(),
            {.stage = Stage::prepare, .omitted_at = "moving_wall"},
            "where the pressure acts: `moving_wall`, whose load is P A_w, or `top`, for which a "
            "moving bottom wall is loaded with P A_w and the grains' weight; the same without "
            "gravity and for a moving top wall"),
  };
}

std::vector<Field> cell_fields() {
  using P = Parameters;
  return {
      names("walls", "", choice<&P::walls>(), kPrepare,
            "texture of the walls; rough walls carry fixed wall grains"),
      names("moving_wall", "", choice<&P::moving_wall>(), kPrepare,
            "the wall that moves vertically under the pressure (B.6)"),
      number("height_over_width", "", "1", &P::height_over_width, 0.1, false, 100, kPrepare,
             "nominal height of the cell over its width L (E)"),
      number("nominal_packing_fraction", "", "1", &P::nominal_packing_fraction, 1e-9, false, 0.74,
             kPrepare, "packing fraction at which N grains fill the nominal cell; fixes L"),
      from_zero("wall_grain_area_fraction", "", "1", &P::wall_grain_area_fraction, 0.53, kPrepare,
                "area fraction of a rough wall covered by wall grains; random sequential addition "
                "jams at 0.547"),
      from_zero("wall_grain_recess_diameters", "", "d", &P::wall_grain_recess_diameters, 0.5,
                kPrepare, "wall grain centres lie up to this depth behind the wall plane"),
      integer("wall_grain_draw", "", &P::wall_grain_draw, 0, 1e6,
              {.stage = Stage::prepare, .omitted_at = "0"},
              "draws other wall grains from the same seed"),
      above_zero("wall_mass_grains_per_d2", "", "m/d^2", &P::wall_mass_grains_per_d2, 1e6, kPrepare,
                 "mass of the moving wall per area"),
      from_zero("wall_drag_grains_per_d2_s", "", "m/(d^2 s)", &P::wall_drag_grains_per_d2_s, 1e9,
                kPrepare, "drag constant of the moving wall per area"),
  };
}

std::vector<Field> settle_fields() {
  using P = Parameters;
  return {
      number("fill_packing_fraction", "", "1", &P::fill_packing_fraction, 1e-9, false, 0.35,
             kPrepare,
             "packing fraction of the random sequential addition that settling starts from; "
             "it jams at 0.384"),
      number("settle_time_step_s", "", "s", &P::settle_time_step_s, 1e-15, false, 1, kPrepare,
             "time step while settling; not tied to that of the shear, so that variants of "
             "the latter share their packing; `auto` keeps Table I's part of the stability limit"),
      above_zero("settle_force_tolerance", "", "1", &P::settle_force_tolerance, 1, kPrepare,
                 "settling ends when the moving wall's force imbalance over P A_w is below this"),
      above_zero("settle_kinetic_tolerance", "", "1", &P::settle_kinetic_tolerance, 1, kPrepare,
                 "settling also needs a kinetic energy per grain over P d^3 below this"),
      above_zero("settle_time_limit_s", "", "s", &P::settle_time_limit_s, 1e6, kPrepare,
                 "simulated time after which a packing that has not settled is a failure"),
      above_zero("max_overlap_diameters", "", "d", &P::max_overlap_diameters, 0.5,
                 {.stage = Stage::prepare, .recorded_as = "0.1"},
                 "a stage whose largest overlap exceeds this stops as failed; a larger value "
                 "continues it"),
  };
}

std::vector<Field> shear_fields() {
  using P = Parameters;
  return {
      names(
          "protocol", "", choice<&P::protocol>(), kShear,
          "what is done to the settled packing: shear without or with pauses (B.5), or stiffening "
          "(B.2)"),
      from_zero("amplitude_rad", "A", "rad", &P::amplitude_rad, 0.5, kShear,
                "amplitude of the tilt theta = A sin(omega t)"),
      above_zero("period_s", "T", "s", &P::period_s, 1e6, kShear,
                 "duration of a cycle, 2 pi/omega (Table I: omega = pi rad/s)"),
      integer("steps_per_cycle", "", &P::steps_per_cycle, 4, 1e9, kShear,
              "time steps in a cycle (Table I, B.4); `auto` keeps Table I's part of the stability "
              "limit, 0.355"),
      above_zero("pause_s", "", "s", &P::pause_s, 1e6,
                 {.stage = Stage::shear, .under = ProtocolKind::paused},
                 "rest between fixed walls after each cycle, under protocol paused (B.5); rounded "
                 "to whole time steps"),
      names("pause_walls", "", choice<&P::pause_walls>(),
            {.stage = Stage::shear, .under = ProtocolKind::paused, .omitted_at = "moving"},
            "the moving wall during a pause: held at its height, or moving under its load"),
      integer("cycles", "n", &P::cycles, 0, 1e6, kNoKey,
              "cycles to shear for; a larger value extends a run"),
      names("engine", "", choice<&P::engine>(), {.stage = Stage::shear, .omitted_at = "shearcell"},
            "what computes the shear: this program, or LAMMPS (another run, equal up to rounding; "
            "settling is always ours)"),
  };
}

std::vector<Field> stiffen_fields() {
  using P = Parameters;
  return {
      integer("stiffness_decades", "", &P::stiffness_decades, 0, 6, kNoKey,
              "under protocol stiffen: the spring constant is raised by 10 to this power (B.2); a "
              "larger value extends a run"),
      integer("stiffness_steps_per_decade", "", &P::stiffness_steps_per_decade, 1, 100, kStiffen,
              "number of equal factors for each power of ten (B.2)"),
      above_zero("minimize_force_tolerance", "", "1", &P::minimize_force_tolerance, 1, kStiffen,
                 "after each factor the enthalpy is minimized until the largest net force on a "
                 "grain over P d^2, and that on the moving wall over P A_w, are below this"),
  };
}

std::vector<Field> make_schema() {
  std::vector<Field> all = grain_fields();
  for (const auto& part : {cell_fields(), settle_fields(), shear_fields(), stiffen_fields()}) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

std::string range_markdown(const Field& field) {
  if (const auto* member = std::get_if<ChoiceMember>(&field.member)) {
    return fmt::format("{}", fmt::join(member->names, ", "));
  }
  return fmt::format("{}{:g} .. {:g}", field.min_excluded ? "> " : "", field.min, field.max);
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

std::span<const Field> schema() {
  static const std::vector<Field> fields = make_schema();
  return fields;
}

const Field* find_field(string_view name) {
  const auto found = std::ranges::find(schema(), name, &Field::name);
  return found == schema().end() ? nullptr : &*found;
}

std::vector<string_view> field_names() {
  std::vector<string_view> all;
  for (const Field& field : schema()) all.push_back(field.name);
  return all;
}

nlohmann::json get_value(const Field& field, const Parameters& parameters) {
  if (const auto* real = std::get_if<double Parameters::*>(&field.member)) {
    return parameters.**real;
  }
  if (const auto* whole = std::get_if<std::uint64_t Parameters::*>(&field.member)) {
    return parameters.**whole;
  }
  return std::get<ChoiceMember>(field.member).get(parameters);
}

void set_value(const Field& field, const nlohmann::json& value, Parameters& parameters) {
  if (const auto* real = std::get_if<double Parameters::*>(&field.member)) {
    parameters.** real = value.get<double>() + 0.0;  // -0 and 0 are one value
  } else if (const auto* whole = std::get_if<std::uint64_t Parameters::*>(&field.member)) {
    parameters.** whole = value.get<std::uint64_t>();
  } else {
    std::get<ChoiceMember>(field.member).set(parameters, value.get_ref<const std::string&>());
  }
}

bool enters(const Identity& identity, Stage stage, std::optional<ProtocolKind> protocol,
            const nlohmann::json& value) {
  if (!identity.stage || (*identity.stage != Stage::prepare && *identity.stage != stage))
    return false;
  if (identity.under && identity.under != protocol) return false;
  return identity.omitted_at.empty() || value_text(value) != identity.omitted_at;
}

std::string value_text(const nlohmann::json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return fmt::format("{}", value.get<double>());
  return value.dump();
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
