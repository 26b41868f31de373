// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/schema.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

namespace shearcell {
namespace {

using std::string_view;

// In the order of their enumerators.
constexpr std::array<string_view, 2> kFluids = {"still", "cell"};
constexpr std::array<string_view, 2> kTextures = {"rough", "smooth"};
constexpr std::array<string_view, 2> kEngines = {"shearcell", "lammps"};
constexpr std::array<string_view, 2> kMovingWalls = {"bottom", "top"};
// What can be done to a settled packing. One more protocol is one more name here.
constexpr std::array<string_view, 3> kProtocols = {"continuous", "paused", "stiffen"};

template <auto Member>
ChoiceMember choice(std::span<const string_view> names) {
  using Enum = std::remove_reference_t<decltype(std::declval<Parameters&>().*Member)>;
  return {names, [](const Parameters& p) { return static_cast<std::size_t>(p.*Member); },
          [](Parameters& p, std::size_t index) { p.*Member = static_cast<Enum>(index); }};
}

ChoiceMember protocol_choice() {
  return {kProtocols,
          [](const Parameters& p) {
            return static_cast<std::size_t>(std::ranges::find(kProtocols, p.protocol) -
                                            kProtocols.begin());
          },
          [](Parameters& p, std::size_t index) { p.protocol = kProtocols[index]; }};
}

Field number(string_view name, string_view symbol, string_view unit, double Parameters::*member,
             double min, bool min_excluded, double max, Identity identity, string_view doc) {
  return {name, symbol, unit, member, min, max, min_excluded, identity, doc};
}

Field above_zero(string_view name, string_view symbol, string_view unit, double Parameters::*member,
                 double max, Identity identity, string_view doc) {
  return number(name, symbol, unit, member, 0, true, max, identity, doc);
}

Field from_zero(string_view name, string_view symbol, string_view unit, double Parameters::*member,
                double max, Identity identity, string_view doc) {
  return number(name, symbol, unit, member, 0, false, max, identity, doc);
}

Field integer(string_view name, string_view symbol, std::uint64_t Parameters::*member, double min,
              double max, Identity identity, string_view doc) {
  return {name, symbol, "1", member, min, max, false, identity, doc};
}

Field names(string_view name, string_view symbol, ChoiceMember member, Identity identity,
            string_view doc) {
  return {name, symbol, "", member, 0, 0, false, identity, doc};
}

std::vector<Field> grain_fields() {
  using P = Parameters;
  constexpr Identity prepare = Identity::prepare;
  return {
      integer("grains", "N", &P::grains, 1, 1e8, prepare, "number of grains"),
      above_zero("mass_kg", "m", "kg", &P::mass_kg, 1e6, prepare, "mass of a grain (Table I)"),
      above_zero("diameter_m", "d", "m", &P::diameter_m, 1e3, prepare,
                 "diameter of a grain (Table I)"),
      above_zero("stiffness_N_per_m", "k", "N/m", &P::stiffness_N_per_m, 1e15, prepare,
                 "spring constant of a contact (Table I)"),
      from_zero("drag_kg_per_s", "b", "kg/s", &P::drag_kg_per_s, 1e9, prepare,
                "Stokes drag constant (Table I)"),
      names("fluid", "", choice<&P::fluid>(kFluids), Identity::shear,
            "velocity of the fluid in the drag under shear: at rest, or that of the walls at the "
            "same height (B.3, Eq. S5)"),
      from_zero("gravity_m_per_s2", "g", "m/s^2", &P::gravity_m_per_s2, 1e6, prepare,
                "gravitational acceleration (Table I); 0 turns it off (D)"),
      above_zero("pressure_Pa", "P", "Pa", &P::pressure_Pa, 1e12, prepare,
                 "pressure on the moving wall (Table I)"),
      names("pressure_at", "", choice<&P::pressure_at>(kNameList<PressureAt>),
            Identity::prepare_if_set,
            "where the pressure acts: `moving_wall`, whose load is P A_w, or `top`, for which a "
            "moving bottom wall is loaded with P A_w and the grains' weight; the same without "
            "gravity and for a moving top wall"),
  };
}

std::vector<Field> cell_fields() {
  using P = Parameters;
  constexpr Identity prepare = Identity::prepare;
  return {
      names("walls", "", choice<&P::walls>(kTextures), prepare,
            "texture of the walls; rough ones carry fixed wall grains"),
      names("moving_wall", "", choice<&P::moving_wall>(kMovingWalls), prepare,
            "the wall that moves vertically under the pressure (B.6)"),
      number("height_over_width", "", "1", &P::height_over_width, 0.1, false, 100, prepare,
             "nominal height of the cell over its width L (E)"),
      above_zero("nominal_packing_fraction", "", "1", &P::nominal_packing_fraction, 0.74, prepare,
                 "packing fraction at which N grains fill the nominal cell; fixes L"),
      from_zero("wall_grain_area_fraction", "", "1", &P::wall_grain_area_fraction, 0.53, prepare,
                "area fraction of a rough wall covered by wall grains; random sequential addition "
                "jams at 0.547"),
      from_zero("wall_grain_recess_diameters", "", "d", &P::wall_grain_recess_diameters, 0.5,
                prepare, "wall grain centres lie up to this depth behind the wall plane"),
      integer("wall_grain_draw", "", &P::wall_grain_draw, 0, 1e6, Identity::prepare_if_set,
              "another number draws other wall grains, from the same seed"),
      above_zero("wall_mass_grains_per_d2", "", "m/d^2", &P::wall_mass_grains_per_d2, 1e6, prepare,
                 "mass of the moving wall per area"),
      from_zero("wall_drag_grains_per_d2_s", "", "m/(d^2 s)", &P::wall_drag_grains_per_d2_s, 1e9,
                prepare, "drag constant of the moving wall per area"),
  };
}

std::vector<Field> settle_fields() {
  using P = Parameters;
  constexpr Identity prepare = Identity::prepare;
  return {
      above_zero("fill_packing_fraction", "", "1", &P::fill_packing_fraction, 0.35, prepare,
                 "packing fraction of the random sequential addition that settling starts from; "
                 "it jams at 0.384"),
      above_zero("settle_time_step_s", "", "s", &P::settle_time_step_s, 1, prepare,
                 "time step while settling; not tied to that of the shear, so that variants of "
                 "the latter share their packing"),
      above_zero("settle_force_tolerance", "", "1", &P::settle_force_tolerance, 1, prepare,
                 "settled when the moving wall's force imbalance over P A_w is below this"),
      above_zero("settle_kinetic_tolerance", "", "1", &P::settle_kinetic_tolerance, 1, prepare,
                 "and the kinetic energy per grain over P d^3 is below this"),
      above_zero("settle_time_limit_s", "", "s", &P::settle_time_limit_s, 1e6, prepare,
                 "simulated time after which a packing that has not settled is a failure"),
      above_zero("max_overlap_diameters", "", "d", &P::max_overlap_diameters, 0.5, prepare,
                 "a stage whose largest overlap exceeds this stops as failed"),
  };
}

std::vector<Field> shear_fields() {
  using P = Parameters;
  return {
      names(
          "protocol", "", protocol_choice(), Identity::shear,
          "what is done to the settled packing: shear without or with pauses (B.5), or stiffening "
          "(B.2)"),
      from_zero("amplitude_rad", "A", "rad", &P::amplitude_rad, 0.5, Identity::shear,
                "amplitude of the tilt theta = A sin(omega t)"),
      above_zero("period_s", "T", "s", &P::period_s, 1e6, Identity::shear,
                 "duration of a cycle, 2 pi/omega (Table I: omega = pi rad/s)"),
      integer("steps_per_cycle", "", &P::steps_per_cycle, 4, 1e9, Identity::shear,
              "time steps in a cycle (Table I, B.4)"),
      above_zero("pause_s", "", "s", &P::pause_s, 1e6, Identity::paused_shear,
                 "rest between fixed walls after each cycle, under protocol paused (B.5); rounded "
                 "to whole time steps"),
      integer("cycles", "n", &P::cycles, 0, 1e6, Identity::none,
              "cycles to shear for; a larger value extends a run"),
      names("engine", "", choice<&P::engine>(kEngines), Identity::shear_if_set,
            "what computes the shear: this program, or LAMMPS (another run, equal up to rounding; "
            "settling is always ours)"),
  };
}

std::vector<Field> stiffen_fields() {
  using P = Parameters;
  return {
      integer("stiffness_decades", "", &P::stiffness_decades, 0, 6, Identity::none,
              "under protocol stiffen the spring constant is raised by 10 to this power (B.2); a "
              "larger value extends a run"),
      integer("stiffness_steps_per_decade", "", &P::stiffness_steps_per_decade, 1, 100,
              Identity::stiffen, "in this many equal factors for each power of ten (B.2)"),
      above_zero("minimize_force_tolerance", "", "1", &P::minimize_force_tolerance, 1,
                 Identity::stiffen,
                 "and then the enthalpy is minimized until the largest net force on a grain over "
                 "P d^2, and that on the moving wall over P A_w, are below this"),
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

string_view identity_markdown(Identity identity) {
  switch (identity) {
    case Identity::prepare:
      return "prepare";
    case Identity::prepare_if_set:
      return "prepare, if not the default";
    case Identity::shear:
      return "shear";
    case Identity::shear_if_set:
      return "shear, if lammps";
    case Identity::paused_shear:
      return "shear, if paused";
    case Identity::stiffen:
      return "stiffen";
    case Identity::none:
      break;
  }
  return "none";
}

std::string default_markdown(const Field& field) {
  const nlohmann::json value = get_value(field, Parameters{});
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return fmt::format("{}", value.get<double>());
  return fmt::format("{}", value.get<std::uint64_t>());
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
  const auto& member = std::get<ChoiceMember>(field.member);
  return member.names[member.get(parameters)];
}

void set_value(const Field& field, const nlohmann::json& value, Parameters& parameters) {
  if (const auto* real = std::get_if<double Parameters::*>(&field.member)) {
    parameters.** real = value.get<double>() + 0.0;  // -0 and 0 are one value
  } else if (const auto* whole = std::get_if<std::uint64_t Parameters::*>(&field.member)) {
    parameters.** whole = value.get<std::uint64_t>();
  } else {
    const auto& member = std::get<ChoiceMember>(field.member);
    const auto found = std::ranges::find(member.names, value.get_ref<const std::string&>());
    member.set(parameters, static_cast<std::size_t>(found - member.names.begin()));
  }
}

std::string schema_markdown() {
  std::string text =
      "| key | symbol | unit | default | values | key of | meaning |\n"
      "|---|---|---|---|---|---|---|\n";
  for (const Field& field : schema()) {
    text += fmt::format("| `{}` | {} | {} | {} | {} | {} | {} |\n", field.name, field.symbol,
                        field.unit, default_markdown(field), range_markdown(field),
                        identity_markdown(field.identity), field.doc);
  }
  return text;
}

}  // namespace shearcell
