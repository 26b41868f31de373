// SPDX-License-Identifier: GPL-3.0-or-later
// The text formats: extended XYZ, LAMMPS data, contacts, and run.json for formats that are folders.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/diagnostics.hpp"
#include "experiments/export/formats.hpp"
#include "experiments/manifest/suggest.hpp"
#include "provenance/io/file.hpp"

namespace shearcell {
namespace {

/// Whether ASE or OVITO may read a quoted text as a number, a logical value or JSON. Both programs
/// ignore the quotes. ASE splits the text at spaces and commas. It converts the text only if the
/// first item is a number, a logical value or JSON, so only the first item is tested.
bool looks_like_a_value(std::string_view text) {
  std::string word = lower(text.substr(0, text.find_first_of(" ,")));
  const auto of_a_name = [](char c) { return c >= 'a' && c <= 'z' && c != 'd' && c != 'e'; };
  const bool number = std::ranges::none_of(word, of_a_name);  // also "1e3" and Fortran's "1d3"
  word.erase(0, word.find_first_not_of("+-"));
  constexpr std::string_view kValues[] = {"t",   "f",   "true",     "false",
                                          "nan", "inf", "infinity", "_json"};
  return number || std::ranges::find(kValues, word) != std::end(kValues);
}

// Quotes a text. A text that ASE or OVITO would not read as text gets single quotes inside the
// double quotes. Characters that would end the quotes or the line are replaced.
std::string quoted(std::string text) {
  for (char& c : text) {
    if (c == '"' || c == '\\' || static_cast<unsigned char>(c) < 0x20) c = '_';
  }
  return looks_like_a_value(text) ? "\"'" + text + "'\"" : '"' + text + '"';
}

/// The comment line of a frame. `length`: the length of one `unit` [m].
std::string xyz_comment(const ExportedState& f, LengthUnit unit, double length) {
  const Checkpoint& c = f.checkpoint;
  const Eigen::Matrix3d e = f.edges / length;
  const Eigen::Vector3d o = f.origin / length;
  std::string line = fmt::format(
      "Lattice=\"{:.17g}\" Origin=\"{:.17g}\" pbc=\"F F T\" Time={:.17g} step={} cycle={:.17g} "
      "theta={:.17g} Properties=species:S:1:pos:R:3:velo:R:3:id:I:1:radius:R:1:wall_side:I:1",
      fmt::join(e.reshaped(), " "), fmt::join(o, " "), c.time_s, c.state.step, c.cycle, c.theta);
  for (const ExportedColumn& column : f.columns) {
    line += fmt::format(":{}:{}:1", column.name, column.whole ? 'I' : 'R');
  }
  line += fmt::format(" length_unit={0} velocity_unit={0}/s d_m={1:.17g} checkpoint={2}",
                      name_of(unit), 2 * f.radius, quoted(f.sha256));
  for (const auto* facts : {&f.run, &f.parameters}) {
    for (const auto& [key, value] : *facts) {
      if (value == "") continue;  // ASE would read the next key as the value
      line += fmt::format(" {}={}", key,
                          value.is_string() ? quoted(value.get<std::string>()) : value.dump());
    }
  }
  for (const auto& [name, value] : f.scalars) {
    if (std::isfinite(value)) line += fmt::format(" {}={:.17g}", name, value);
  }
  return line;
}

// The title gives the planes of the cell, because the box in the file is larger than the cell.
std::string lammps_title(const ExportedState& f) {
  const Eigen::Vector3d high = f.origin + f.edges.diagonal();
  return fmt::format(
      "LAMMPS data file by shearcell, units si, atom_style sphere, step {}, cycle {:.17g}, run "
      "{:.64}, cell {:.17g} {:.17g} {:.17g} {:.17g} 0 {:.17g} tilt {:.17g}",
      f.checkpoint.state.step, f.checkpoint.cycle, f.run.front().second.get<std::string>(),
      f.origin.x(), high.x(), f.origin.y(), high.y(), high.z(), f.edges(0, 1));
}

}  // namespace

FrameWriter extxyz_writer(const std::filesystem::path& file, LengthUnit unit) {
  return [unit, file](const ExportedState& f) {
    const double length = metres(unit, 2 * f.radius);
    std::string text = fmt::format("{}\n{}\n", f.particles(), xyz_comment(f, unit, length));
    for (std::size_t i = 0; i < f.particles(); ++i) {
      const Eigen::Vector3d r = f.position.col(static_cast<Eigen::Index>(i)) / length;
      const Eigen::Vector3d v = f.velocity.col(static_cast<Eigen::Index>(i)) / length;
      const auto line = std::back_inserter(text);
      fmt::format_to(line, "{} {:.17g} {:.17g} {} {:.17g} {}", f.type[i] == 0 ? "H" : "He",
                     fmt::join(r, " "), fmt::join(v, " "), i + 1, f.radius / length, f.type[i]);
      for (const ExportedColumn& column : f.columns) {
        fmt::format_to(line, " {:.17g}", column.values[i]);
      }
      text += '\n';
    }
    append(file, text);
  };
}

FrameWriter lammps_writer(const std::filesystem::path& folder) {
  return [folder](const ExportedState& f) {
    const std::string name = "frame_" + frame_name(f);
    append(folder / (name + ".data"), lammps_data(f, lammps_title(f)));
    if (!f.continued) return;
    append(folder / ("in." + name), lammps_script(*f.continued, name + ".data", name));
  };
}

FrameWriter contacts_writer(const std::filesystem::path& folder) {
  return [folder](const ExportedState& f) {
    std::string text = "grain,other,wall_side,overlap_d,force_N,normal_x,normal_y,normal_z\n";
    const Checkpoint& c = f.checkpoint;
    for_each_contact(c.cell, c.state.position, pose_of(c), [&](const Contact& one) {
      const bool pair = one.kind == Contact::Kind::grain;
      const bool plane = one.kind == Contact::Kind::wall_plane;
      const auto other = static_cast<std::size_t>(one.other) + (pair ? 1 : f.grains + 1);
      fmt::format_to(std::back_inserter(text), "{},{},{},{:.17g},{:.17g},{:.17g}\n", one.grain + 1,
                     plane ? 0 : other, pair ? 0 : 1 + static_cast<int>(one.side), one.overlap,
                     f.stiffness_N_per_m * one.overlap * c.units.diameter_m,
                     fmt::join(one.normal, ","));
    });
    append(folder / fmt::format("contacts_{}.csv", frame_name(f)), text);
  };
}

FrameWriter facts_writer(const std::filesystem::path& folder, std::size_t count) {
  using Json = nlohmann::ordered_json;
  return [folder, count, frames = std::make_shared<Json>(Json::array())](const ExportedState& f) {
    const Checkpoint& c = f.checkpoint;
    Json frame = {{"cycle", c.cycle}, {"time_s", c.time_s}, {"checkpoint", f.sha256}};
    for (const auto& [name, value] : f.scalars) frame[name] = value;  // NaN as null
    frames->push_back(std::move(frame));
    if (frames->size() < count) return;
    Json all = {{"units", "SI: m, kg, s. Values in other units have the unit in their names"}};
    for (const auto& [key, value] : f.run) all[key] = value;
    for (const auto& [key, value] : f.parameters) all["parameters"][key] = value;
    all["frames"] = *frames;
    write_output(folder / "run.json",
                 all.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
  };
}

}  // namespace shearcell
