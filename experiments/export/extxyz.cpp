// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "experiments/export/formats.hpp"
#include "provenance/io/plain_file.hpp"

namespace shearcell {
namespace {

// Quoted as ASE and OVITO read it; a text of a damaged store must not end the quotes or the line.
std::string quoted(std::string text) {
  for (char& c : text) {
    if (c == '"' || c == '\\' || static_cast<unsigned char>(c) < 0x20) c = '_';
  }
  return '"' + text + '"';
}

std::string comment(const Frame& f, Lengths lengths) {
  const bool si = lengths == Lengths::metres;
  const double d = 2 * f.radius;
  const Eigen::Matrix3d e = f.edges / (si ? 1 : d);
  const Eigen::Vector3d o = f.origin / (si ? 1 : d);
  std::string line = fmt::format(
      "Lattice=\"{:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\" "
      "Origin=\"{:.17g} {:.17g} {:.17g}\" pbc=\"F F T\" Time={:.17g} step={} cycle={:.17g} "
      "theta={:.17g} Properties=species:S:1:pos:R:3:velo:R:3:id:I:1:radius:R:1",
      e(0, 0), e(1, 0), e(2, 0), e(0, 1), e(1, 1), e(2, 1), e(0, 2), e(1, 2), e(2, 2), o.x(), o.y(),
      o.z(), f.time_s, f.step, f.cycle, f.theta);
  for (const FrameColumn& column : frame_columns()) {
    line += fmt::format(":{}:{}:1", column.name, column.real != nullptr ? 'R' : 'I');
  }
  line += fmt::format(" length_unit={} velocity_unit={} d_m={:.17g} checkpoint={}", si ? "m" : "d",
                      si ? "m/s" : "d/s", d, quoted(f.checkpoint));
  for (const auto& [key, value] : f.facts) {
    line += fmt::format(" {}={}", key,
                        value.is_string() ? quoted(value.get<std::string>()) : value.dump());
  }
  for (const auto& [name, value] : f.scalars) {
    if (std::isfinite(value)) line += fmt::format(" {}={:.17g}", name, value);
  }
  return line;
}

}  // namespace

FrameWriter extxyz_writer(const std::filesystem::path& file, Lengths lengths) {
  return [lengths, out = std::make_shared<NewFile>(file)](const Frame& f) {
    const double unit = lengths == Lengths::metres ? 1 : 2 * f.radius;
    std::string text = fmt::format("{}\n{}\n", f.particles(), comment(f, lengths));
    for (std::size_t i = 0; i < f.particles(); ++i) {
      const Eigen::Vector3d r = f.position.col(static_cast<Eigen::Index>(i)) / unit;
      const Eigen::Vector3d v = f.velocity.col(static_cast<Eigen::Index>(i)) / unit;
      fmt::format_to(std::back_inserter(text),
                     "{} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {} {:.17g}",
                     f.type[i] == 0 ? "H" : "He", r.x(), r.y(), r.z(), v.x(), v.y(), v.z(), i + 1,
                     f.radius / unit);
      for (const FrameColumn& column : frame_columns()) {
        if (column.real != nullptr) {
          fmt::format_to(std::back_inserter(text), " {:.17g}", (f.*column.real)[i]);
        } else {
          fmt::format_to(std::back_inserter(text), " {}", (f.*column.integer)[i]);
        }
      }
      text += '\n';
    }
    out->add(text);
  };
}

}  // namespace shearcell
