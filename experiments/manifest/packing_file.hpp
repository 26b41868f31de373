// SPDX-License-Identifier: GPL-3.0-or-later
// Positions of equal grains from a text of another program: XYZ and extended XYZ, LAMMPS data and
// LAMMPS dumps, CSV with a header. README.md lists what is read of each.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/named.hpp"

namespace shearcell {

/// Unit of the lengths of a file: metres or grain diameters.
enum class LengthUnit : std::uint8_t { m, d };
template <>
inline constexpr auto kNames<LengthUnit> = names_in_order<LengthUnit>("m", "d");

/// The grains, by id if the file has ids, else in its order. Wall grains that an export of this
/// program holds are left out.
struct PackingFile {
  Eigen::Matrix3Xd position;                 ///< 3 x N [d]; z within the box if there is one
  std::optional<Eigen::Matrix3Xd> velocity;  ///< 3 x N [d/s]
  std::optional<Eigen::AlignedBox3d> box;    ///< [d]; of an export, the planes of its cell
  LengthUnit unit = LengthUnit::d;           ///< of the file's lengths
  std::vector<std::string> not_read;         ///< names of columns, sections and keys, at most 100
};

/// Facts that the manifest and the parameters of the run add to a file.
struct PackingFacts {
  std::optional<LengthUnit> unit = {};  ///< of lengths, for a file that states no unit
  double diameter_m = 0;                ///< of the run's grains
  double largest_overlap = 0;           ///< of two grains [d], below 1
};

/// Largest text [bytes].
inline constexpr std::size_t kLargestPackingFile = std::size_t{32} << 20;

/// Reads a text in the format that its content shows; `file` is the name for messages. Positions
/// are not moved, except that z is wrapped into the box. Throws ManifestError, with line, value and
/// remedy, unless the text is a packing of equal grains within its box. Grains may overlap by at
/// most facts.largest_overlap, with a box also across the periodic boundary in z.
PackingFile read_packing(std::string_view text, std::string_view file, const PackingFacts& facts);

/// "150 grains, box 6 x 7.2 x 6 d, no velocities; not read: element".
std::string describe(const PackingFile& packing);

}  // namespace shearcell
