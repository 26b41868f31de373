// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "experiments/export/formats.hpp"
#include "provenance/io/plain_file.hpp"

namespace shearcell {
namespace {

std::string header(const Frame& f) {
  const double tilt = f.edges(0, 1) / f.edges(1, 1);
  const double low_y = f.position.row(1).minCoeff() - f.radius;
  const double high_y = f.position.row(1).maxCoeff() + f.radius;
  const Eigen::RowVectorXd along = f.position.row(0) - tilt * f.position.row(1);
  const double low_x = along.minCoeff() + tilt * low_y - f.radius;
  const double high_x = along.maxCoeff() + tilt * low_y + f.radius;
  return fmt::format(
      "LAMMPS data file by shearcell, units si, atom_style sphere, step {}, cycle {:.17g}, "
      "run {:.64}\n\n"
      "{} atoms\n5 atom types\n\n"
      "{:.17g} {:.17g} xlo xhi\n{:.17g} {:.17g} ylo yhi\n0 {:.17g} zlo zhi\n{:.17g} 0 0 xy xz "
      "yz\n\n",
      f.step, f.cycle, f.facts.front().second.get<std::string>(), f.particles(), low_x, high_x,
      low_y, high_y, f.edges(2, 2), tilt * (high_y - low_y));
}

}  // namespace

FrameWriter lammps_writer(const std::filesystem::path& folder) {
  return [folder](const Frame& f) {
    const double density = f.mass / (4.0 / 3.0 * std::numbers::pi * std::pow(f.radius, 3));
    std::string text = header(f) + "Atoms # sphere\n\n";
    for (std::size_t i = 0; i < f.particles(); ++i) {
      const auto r = f.position.col(static_cast<Eigen::Index>(i));
      fmt::format_to(std::back_inserter(text),
                     "{} {} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} 0 0 {}\n", i + 1, f.type[i] + 1,
                     2 * f.radius, density, r.x(), r.y(), r.z(), f.image[i]);
    }
    text += "\nVelocities\n\n";
    for (std::size_t i = 0; i < f.particles(); ++i) {
      const auto v = f.velocity.col(static_cast<Eigen::Index>(i));
      fmt::format_to(std::back_inserter(text), "{} {:.17g} {:.17g} {:.17g} 0 0 0\n", i + 1, v.x(),
                     v.y(), v.z());
    }
    NewFile(folder / fmt::format("frame_{:g}.data", f.cycle)).add(text);
  };
}

}  // namespace shearcell
