// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <memory>

#include "experiments/export/formats.hpp"
#include "provenance/io/plain_file.hpp"

namespace shearcell {
namespace {

std::string comment(const Frame& f) {
  const Eigen::Matrix3d& e = f.edges;
  std::string line = fmt::format(
      "Lattice=\"{:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\" "
      "Origin=\"{:.17g} {:.17g} {:.17g}\" pbc=\"F F T\" Time={:.17g} step={} cycle={:.17g} "
      "theta={:.17g} Properties=id:I:1:species:S:1:pos:R:3:velo:R:3:radius:R:1",
      e(0, 0), e(1, 0), e(2, 0), e(0, 1), e(1, 1), e(2, 1), e(0, 2), e(1, 2), e(2, 2), f.origin.x(),
      f.origin.y(), f.origin.z(), f.time_s, f.step, f.cycle, f.theta);
  for (const FrameColumn& column : frame_columns()) {
    line += fmt::format(":{}:{}:1", column.name, column.real != nullptr ? 'R' : 'I');
  }
  return line;
}

}  // namespace

FrameWriter extxyz_writer(const std::filesystem::path& file) {
  return [out = std::make_shared<NewFile>(file)](const Frame& f) {
    std::string text = fmt::format("{}\n{}\n", f.particles(), comment(f));
    for (std::size_t i = 0; i < f.particles(); ++i) {
      const auto r = f.position.col(static_cast<Eigen::Index>(i));
      const auto v = f.velocity.col(static_cast<Eigen::Index>(i));
      fmt::format_to(
          std::back_inserter(text), "{} {} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}",
          i + 1, f.type[i] == 0 ? "H" : "He", r.x(), r.y(), r.z(), v.x(), v.y(), v.z(), f.radius);
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
