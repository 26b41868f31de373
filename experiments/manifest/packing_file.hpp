// SPDX-License-Identifier: GPL-3.0-or-later
// Reads positions of equal grains from a file of another program: XYZ, extended XYZ, LAMMPS data,
// LAMMPS dump, or CSV with a header. README.md lists what is read from each format.
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

/// Unit of the lengths of a file; d is the grain diameter.
enum class LengthUnit : std::uint8_t { m, d, mm, cm, um };
template <>
inline constexpr auto kNames<LengthUnit> = names_in_order<LengthUnit>("m", "d", "mm", "cm", "um");

/// Length of one unit [m]. `diameter_m`: diameter of the grains.
double metres(LengthUnit unit, double diameter_m);

/// The grains of a file, sorted by id, or in the order of the file if it has no ids. Wall grains in
/// an export of this program are left out.
struct PackingFile {
  Eigen::Matrix3Xd position;                 ///< 3 x N [d]; if there is a box, z is wrapped into it
  std::optional<Eigen::Matrix3Xd> velocity;  ///< 3 x N [d/s]
  std::optional<Eigen::AlignedBox3d> box;    ///< [d]; in exports of this program, the wall planes
  LengthUnit unit = LengthUnit::d;           ///< of lengths in the file
  double largest_overlap = 0;                ///< [d]; without a box, periodic images are ignored
  std::vector<std::string> not_read;         ///< unread columns, sections and keys, at most 100
};

/// Facts about a file that come from the manifest and from the parameters of the run.
struct PackingFacts {
  std::optional<LengthUnit> unit = {};  ///< unit of lengths, if the file does not give it
  double diameter_m = 0;                ///< of the run's grains
  double largest_overlap = 0;           ///< largest allowed overlap of two grains [d], below 1
  std::uint64_t grains = 0;             ///< of the run; 0: not known
};

/// Largest allowed size of a file [bytes].
inline constexpr std::size_t kLargestPackingFile = std::size_t{32} << 20;

/// Detects the format of the text and reads it. `file`: the name for messages. Positions are kept,
/// except that z is wrapped into the box. Throws ManifestError, with line, value and remedy, if the
/// text cannot be read; if the number of grains is not facts.grains; if the file gives a diameter
/// other than facts.diameter_m; if a grain is outside of the box in x or y; or if two grains
/// overlap by more than facts.largest_overlap, directly or across the periodic boundary of the box.
PackingFile read_packing(std::string_view text, std::string_view file, const PackingFacts& facts);

/// For example "150 grains, box 6 x 7.2 x 6 d, no velocities; not read: element".
std::string describe(const PackingFile& packing);

}  // namespace shearcell
