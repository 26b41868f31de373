// SPDX-License-Identifier: GPL-3.0-or-later
// Packings of other programs: what is read, and every bad file with its message.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/packing_file.hpp"
#include "tests/support/files.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

const PackingFacts kInD{.unit = LengthUnit::d, .diameter_m = 3e-3, .largest_overlap = 0.25};
const PackingFacts kUnstated{.diameter_m = 3e-3, .largest_overlap = 0.25};

const std::string kLattice = "Lattice=\"9 0 0 0 9 0 0 0 9\" ";

std::string xyz(const std::string& comment, const std::string& rows, int count = 2) {
  return fmt::format("{}\n{}\n{}", count, comment, rows);
}

std::string data(const std::string& header, const std::string& sections) {
  return "soft atoms\n\n2 atoms\n1 atom types\n" + header + "\n" + sections;
}

const std::string kBounds = "0 9 xlo xhi\n0 9 ylo yhi\n0 9 zlo zhi\n";
const std::string kAtoms = "Atoms # atomic\n\n1 1 1 1 1\n2 1 3 3 3\n";

std::string dump(const std::string& columns, const std::string& rows) {
  return "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS ff ff pp\n0 9\n0 9\n0 9\n"
         "ITEM: ATOMS " +
         columns + "\n" + rows;
}

struct BadPacking {
  std::string name, file, text, message;
  PackingFacts facts = kInD;
};

void PrintTo(const BadPacking& bad, std::ostream* out) {
  *out << bad.name;
}

const std::string kFormats =
    "Use extended XYZ (its first line is the number of grains), LAMMPS data (with \"500 atoms\" in "
    "its header), a LAMMPS dump, or CSV whose first line names the columns, such as x_m,y_m,z_m.";
const std::string kXyz =
    "Use the keys Lattice (9 numbers), Origin (3 numbers), Properties (NAME:TYPE:COUNT of each "
    "column, with pos:R:3, and vel:R:3 if there are velocities), length_unit and velocity_unit, "
    "without blanks around `=`.";
const std::string kSize =
    "At most 100000 d are allowed along each axis, and a box needs at least 3 d along z. Is the "
    "unit of lengths right?";
const std::string kData =
    "Write the box as xlo xhi, ylo yhi and zlo zhi, and the sections Atoms (atom_style sphere or "
    "atomic) and Velocities.";
const std::string kDump =
    "Write ITEM: BOX BOUNDS and ITEM: UNITS as in LAMMPS. Write the columns id x y z vx vy vz. The "
    "coordinates must not be scaled.";
const std::string kCsv =
    kFormats + " Velocities are vx_m_per_s and so on. The unit can be m, d, mm, cm or um.";
const std::string kOrRemove = " Or remove this part.", kOrRemoveColumn = " Or remove this column.";
const std::string kNoNumber = " Write the number with a decimal point, such as 1.5e-3.";
const std::string kFields =
    "Each grain is one line with a value for each column. Write numbers with a decimal point, not "
    "a comma.";
const std::string kOneFrame = " Use a complete file of one frame, or correct the number of grains.";
const std::string kTwoUnits =
    " Write all lengths in one unit, and state it in the file or as `unit` in the manifest.";
const std::string kEqual =
    " This program needs equal grains. Check the unit. If it is right, set `diameter_m` or scale "
    "the lengths in the file. If the column holds something other than diameters or radii, remove "
    "the column. To shear unequal grains, use LAMMPS (`shearcell export --to lammps`).";
const std::string kDeep =
    "At most 0.25 d are allowed (`max_overlap_diameters`). Check `diameter_m` and the unit of "
    "the lengths. If both are right, let the grains relax in the program that made the file.";

const std::vector<BadPacking> kBad = {
    {"Empty", "a.xyz", "", "a.xyz: is empty. " + kFormats},
    {"Blank", "a.csv", " \r\n\n", "a.csv: is empty. " + kFormats},
    {"Picture", "a.xyz", std::string("\x89PNG\r\n\x1a\n\0", 9),
     "a.xyz:1:1: is not valid UTF-8. Save the file as UTF-8 text."},
    {"Binary", "a.data", std::string("12\0\0", 4),
     "a.data:1:3: holds the control character 0x00. Save the positions as text: extended XYZ, "
     "LAMMPS data or CSV."},
    {"Gzip", "a.csv.gz", "\x1f\x8b\x08",
     "a.csv.gz: is compressed. Decompress it with `gzip -dc a.csv.gz > NEW_FILE`, and write the "
     "name "
     "of the new file in the manifest."},
    {"Zip", "a.zip", "PK\3\4",
     "a.zip: is compressed. Decompress it with `unzip -p a.zip > NEW_FILE`, "
     "and write the name of the new file in the manifest."},
    {"SeparatorAlone", "a.csv", "sep=;\n", "a.csv:1:1: the column x is missing. " + kCsv},
    {"DecimalCommaOfExcel", "a.csv", "sep=;\nx;y;z\n1,5;2;3\n",
     "a.csv:3:1: x: is not a number between -1e100 and 1e100 (got 1,5)." + kNoNumber},
    {"HeaderWithBlanksInNames", "a.txt", "x [d] y [d] z [d]\n1 1 1\n",
     "a.txt:2:1: has 3 fields instead of 6. " + kFields},
    {"Latin1", "a.csv", "x,y,z\n1,2,\xe9\n",
     "a.csv:2:5: is not valid UTF-8. Save the file as UTF-8 text."},
    {"Prose", "a.txt", "Dear reader\n", "a.txt:1:1: the column x is missing. " + kCsv},
    {"UnitUnstated", "a.xyz", xyz("", "A 1 1 1\nA 3 3 3\n"),
     "a.xyz: does not give the unit of its lengths. Write `unit: m` or `unit: d` (grain "
     "diameters) "
     "beside `file` in the manifest.",
     kUnstated},
    {"UnitContradicted", "a.csv", "x_m,y_m,z_m\n1,1,1\n",
     "a.csv:1:1: gives lengths in m, but the manifest has lengths in d." + kTwoUnits},
    {"UnitUnknown", "a.xyz", xyz("length_unit=nm", "A 1 1 1\nA 3 3 3\n"),
     "a.xyz:2:13: units: cannot be read (got nm). The unit of lengths must be one of m, d, "
     "mm, cm, um, si, cgs, lj. With lj, the manifest must give the unit."},
    {"UnitsMixed", "a.csv", "x_m,y_m,z_d\n1,1,1\n",
     "a.csv:1:9: is in another unit than the earlier columns (got z_d). Write all lengths in m "
     "(x_m) or all in d (x_d).",
     kUnstated},
    {"NotANumber", "a.xyz", xyz("", "A 1 1 1\nA 3 three 3\n"),
     "a.xyz:4:5: y: is not a number between -1e100 and 1e100 (got three)." + kNoNumber},
    {"NaN", "a.xyz", xyz("", "A 1 1 nan\nA 3 3 3\n"),
     "a.xyz:3:7: z: is not a number between -1e100 and 1e100 (got nan)." + kNoNumber},
    {"Infinite", "a.csv", "x,y,z\n1,2,-inf\n",
     "a.csv:2:5: z: is not a number between -1e100 and 1e100 (got -inf)." + kNoNumber},
    {"BeyondDouble", "a.csv", "x,y,z\n1,2,1e999\n",
     "a.csv:2:5: z: is not a number between -1e100 and 1e100 (got 1e999)." + kNoNumber},
    {"DecimalComma", "a.csv", "x;y;z\n1,5;2;3\n",
     "a.csv:2:1: x: is not a number between -1e100 and 1e100 (got 1,5)." + kNoNumber},
    {"DecimalCommasAmongCommas", "a.csv", "x,y,z\n1,5,2,5,3,5\n",
     "a.csv:2:1: has 6 fields instead of 3. " + kFields},
    {"FieldMissing", "a.csv", "x,y,z\n1,2,3\n4,5\n",
     "a.csv:3:1: has 2 fields instead of 3. " + kFields},
    {"ColumnMissing", "a.csv", "x,y,radius\n1,2,0.5\n",
     "a.csv:1:1: the column z is missing. " + kCsv},
    {"VelocityIncomplete", "a.csv", "x,y,z,vx\n1,2,3,0\n",
     "a.csv:1:1: the column vy is missing. " + kCsv},
    {"ColumnTwice", "a.csv", "x,y,z,x\n1,2,3,4\n",
     "a.csv:1:7: is a column that occurs twice (got x). Keep one of them."},
    {"HeaderAlone", "a.csv", "x,y,z\n", "a.csv:1:1: the file has no grains. " + kFormats},
    {"HeaderMissing", "a.csv", "1,2,3\n", "a.csv:1:1: the column x is missing. " + kCsv},
    {"TooFew", "a.xyz", xyz("", "A 1 1 1\nA 3 3 3\n", 3),
     "a.xyz:1:1: is not the number of rows in this file, 2 (got 3)." + kOneFrame},
    {"TooMany", "a.xyz", xyz("", "A 1 1 1\nA 3 3 3\nA 5 5 5\n"),
     "a.xyz:1:1: is not the number of rows in this file, 3 (got 2)." + kOneFrame},
    {"Zero", "a.xyz", xyz("", "", 0), "a.xyz:2:1: the file has no grains. " + kFormats},
    {"CountAlone", "a.xyz", "5",
     "a.xyz:1:1: is not the number of rows in this file, 0 (got 5)." + kOneFrame},
    {"PropertiesWithoutPositions", "a.xyz", xyz("Properties=species:S:1:radius:R:1", "A 1\nA 1\n"),
     "a.xyz:2:1: the column x is missing. " + kXyz},
    {"PropertiesCut", "a.xyz", xyz("Properties=species:S:1:pos:R", "A 1 1 1\nA 3 3 3\n"),
     "a.xyz:2:24: cannot be read in this form (got pos). " + kXyz + kOrRemove},
    {"PropertiesFlat", "a.xyz", xyz("Properties=pos:R:2", "1 1\n3 3\n"),
     "a.xyz:2:12: has 2 values in each row (got pos). It must have 3."},
    {"KeyTwice", "a.xyz", xyz(kLattice + kLattice, "A 1 1 1\nA 3 3 3\n"),
     "a.xyz:2:29: is a key that occurs twice (got Lattice). Keep one of them."},
    {"BoxLeans", "a.xyz", xyz("Lattice=\"9 0 0 0.5 9 0 0 0 9\"", "A 1 1 1\nA 3 3 3\n"),
     "a.xyz:2:1: the box is not orthogonal: an edge leans by 0.5. Use a rectangular box. A "
     "sheared cell is rectangular at the end of a cycle."},
    {"BoxNegative", "a.xyz", xyz("Lattice=\"9 0 0 0 -9 0 0 0 9\"", "A 1 1 1\nA 3 3 3\n"),
     "a.xyz:2:1: the box is not complete, or has an edge that is not positive: 9 x -9 x 9. " +
         kXyz},
    {"BoxIncomplete", "a.xyz", xyz("Lattice=\"9 9 9\"", "A 1 1 1\nA 3 3 3\n"),
     "a.xyz:2:1: cannot be read in this form (got Lattice=\"9 9 9\"). " + kXyz + kOrRemove},
    {"BoxFlat", "a.xyz", xyz("Lattice=\"9 0 0 0 9 0 0 0 2\"", "A 1 1 1\nA 3 3 1\n"),
     "a.xyz: box and grains together are 9 x 9 x 2 d large. " + kSize},
    {"OutsideOfTheBox", "a.xyz", xyz(kLattice, "A 1 1 1\nA 3 -3 3\n"),
     "a.xyz:4:1: the grain is outside of the box: y = -3 d is not between 0 and 9 d. Only z is "
     "periodic; x and y have walls. Write a box that contains all grains. In extended XYZ, Origin "
     "is the lower corner of the box (default 0 0 0)."},
    {"TooLong", "a.xyz", xyz("", "A 1 1 1\nA 3e9 3 3\n"),
     "a.xyz: box and grains together are 3e+09 x 4 x 4 d large. " + kSize},
    {"AtOnePlace", "a.xyz", xyz("", "A 1 1 1\nA 1 1 1\n"),
     "a.xyz:4:1: the grain overlaps the grain in line 3 by 1 d. " + kDeep},
    {"Overlapping", "a.xyz", xyz(kLattice, "A 1 1 1\nA 1.5 1 1\n"),
     "a.xyz:4:1: the grain overlaps the grain in line 3 by 0.5 d. " + kDeep},
    {"OverlappingAcrossTheBoundary", "a.xyz", xyz(kLattice, "A 1 1 0.25\nA 1 1 8.75\n"),
     "a.xyz:4:1: the grain overlaps the grain in line 3 by 0.5 d. " + kDeep},
    {"RadiiUnequal", "a.xyz",
     xyz("Properties=species:S:1:pos:R:3:radius:R:1", "A 1 1 1 0.5\nA 3 3 3 0.6\n"),
     "a.xyz:4:9: radius: is not the radius of the manifest's grains, 0.5 d (got 0.6)." + kEqual},
    {"RadiusOfZero", "a.csv", "x,y,z,radius\n1,2,3,0\n",
     "a.csv:2:7: radius: is not the radius of the manifest's grains, 0.5 d (got 0)." + kEqual},
    {"DiameterOfAnotherRun", "a.csv", "x_m,y_m,z_m,diameter_m\n1,2,3,0.002\n",
     "a.csv:2:7: diameter_m: is not the diameter of the manifest's grains, 0.003 m (got 0.002)." +
         kEqual,
     kUnstated},
    {"DiameterNotOne", "a.csv", "x,y,z,radius\n1,2,3,1\n",
     "a.csv:2:7: radius: is not the radius of the manifest's grains, 0.5 d (got 1)." + kEqual},
    {"IdTwice", "a.csv", "id,x,y,z\n7,1,2,3\n7,4,5,6\n",
     "a.csv:3:1: the id 7 is also in line 2. Give each grain a different id."},
    {"DataTooFew", "a.data", data(kBounds, "Atoms # atomic\n\n1 1 1 1 1\n"),
     "a.data:3:1: is not the number of rows in this file, 1 (got 2)." + kOneFrame},
    {"DataWithoutAtoms", "a.data", data(kBounds, ""),
     "a.data:3:1: is not the number of rows in this file, 0 (got 2)." + kOneFrame},
    {"DataOfAnotherStyle", "a.data", data(kBounds, "Atoms # full\n\n1 1 1 0 1 1 1\n"),
     "a.data:11:1: atoms of style 'full' with 7 fields cannot be read. " + kData},
    {"DataOfNoStyle", "a.data", data(kBounds, "Atoms\n\n1 1 0 1 1 1\n"),
     "a.data:11:1: atoms of style '' with 6 fields cannot be read. " + kData},
    {"DataTilted", "a.data", data(kBounds + "1 0 0 xy xz yz\n", kAtoms),
     "a.data:8:1: the box is not orthogonal: an edge leans by 1. Use a rectangular box. A "
     "sheared cell is rectangular at the end of a cycle."},
    {"DataReversed", "a.data", data("9 0 xlo xhi\n0 9 ylo yhi\n0 9 zlo zhi\n", kAtoms),
     "a.data:7:1: the box is not complete, or has an edge that is not positive: -9 x 9 x 9. " +
         kData},
    {"DataVelocityMissing", "a.data", data(kBounds, kAtoms + "\nVelocities\n\n1 0 0 0\n"),
     "a.data:12:1: the sections Atoms and Velocities do not have the same ids. Write one velocity "
     "for each atom, or leave out the "
     "section Velocities."},
    {"DataVelocityOfNone", "a.data", data(kBounds, kAtoms + "\nVelocities\n\n1 0 0 0\n3 0 0 0\n"),
     "a.data:17:1: the sections Atoms and Velocities do not have the same ids. Write one velocity "
     "for each atom, or leave out the section Velocities."},
    {"DataNotANumber", "a.data", data(kBounds, "Atoms # atomic\n\n1 1 1 1 1\n2 1 3 3 3,5\n"),
     "a.data:12:9: z: is not a number between -1e100 and 1e100 (got 3,5)." + kNoNumber},
    {"DumpScaled", "a.dump", dump("id type xs ys zs", "1 1 0.1 0.1 0.1\n2 1 0.3 0.3 0.3\n"),
     "a.dump:9:21: is not a valid name for a position or velocity (got xs). " + kDump +
         kOrRemoveColumn},
    {"DumpOfEdgeVectors", "a.dump",
     "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS abc origin ff ff pp\n9 0 0 0\n",
     "a.dump:5:1: cannot be read in this form (got ITEM: BOX BOUNDS abc origin ff ff pp). " +
         kDump + kOrRemove},
    {"DumpCut", "a.dump", dump("id x y z", "1 1 1 1\n"),
     "a.dump:4:1: is not the number of rows in this file, 1 (got 2)." + kOneFrame},
    {"DumpOfTwoFrames", "a.dump", dump("id x y z", "1 1 1 1\n2 3 3 3\nITEM: TIMESTEP\n1\n"),
     "a.dump:12:1: cannot be read in this form (got ITEM: TIMESTEP). " + kDump + kOrRemove},
    {"DumpHeaderAlone", "a.dump", "ITEM: TIMESTEP\n0\n",
     "a.dump:1:1: is not the number of rows in this file, 0 (got ITEM: TIMESTEP)." + kOneFrame},
};

class PackingFileBad : public testing::TestWithParam<BadPacking> {};

TEST_P(PackingFileBad, IsRejectedWithItsMessage) {
  const BadPacking& bad = GetParam();
  EXPECT_EQ(message_of<ManifestError>([&] { read_packing(bad.text, bad.file, bad.facts); }),
            bad.message);
}

INSTANTIATE_TEST_SUITE_P(Files, PackingFileBad, testing::ValuesIn(kBad),
                         [](const auto& bad) { return bad.param.name; });

// Not in the list above, since each test program would copy its 32 MiB when it starts.
TEST(PackingFile, IsRejectedIfTooLarge) {
  const std::string text(kLargestPackingFile + 1, '1');
  EXPECT_EQ(message_of<ManifestError>([&] { read_packing(text, "a.xyz", kInD); }),
            "a.xyz: is larger than 32 MiB. Leave out columns that are not positions, velocities or "
            "radii.");
}

/// Two grains at (1, 1, 1) and (3, 3, 3) d.
void expect_two(const std::string& file, const std::string& text, const PackingFacts& facts) {
  SCOPED_TRACE(text);
  const PackingFile packing = read_packing(text, file, facts);
  ASSERT_EQ(packing.position.cols(), 2);
  EXPECT_LT((packing.position.col(0) - Eigen::Vector3d(1, 1, 1)).norm(), 1e-12);
  EXPECT_LT((packing.position.col(1) - Eigen::Vector3d(3, 3, 3)).norm(), 1e-12);
}

TEST(PackingFile, FormatAndUnitMayBeWrittenInManyWays) {
  expect_two("a", xyz("", "A 1 1 1\nA 3 3 3\n"), kInD);
  expect_two("a.xyz", "2\r\n\r\nA 1 1 1\r\nA 3 3 3\r\n\r\n", kInD);
  expect_two("a.xyz", xyz("", "A 1 1 1\n\nA 3 3 3\n"), kInD);
  expect_two("a.xyz", xyz("length_unit=m", "A .003 3e-3 +3E-3 extra\nA 0.009 0.009 0.009"),
             kUnstated);
  expect_two("a.csv", "\xEF\xBB\xBF\"x\";\"y\";\"z\"\n1;1;1\n\n3;3;3\n", kInD);
  expect_two("a.csv", "# x_d, y_d, z_d\n1, 1, 1\n3, 3, 3\n", kUnstated);
  expect_two("a.txt", "z_m\tname\ty_m\tx_m\n0.003\tA\t0.003\t0.003\n0.009\tA\t0.009\t0.009\n",
             kUnstated);
  for (const std::string& first :
       {std::string("sep=;"), std::string("\"sep=;\""), std::string("SEP=")}) {
    expect_two("a.csv", first + "\r\nx;y;z\r\n1;1;1\r\n3;3;3\r\n", kInD);
  }
  expect_two("a.csv", "sep=|\nx|y|z\n1|1|1\n3|3|3\n", kInD);
  expect_two("a.csv", "sep=\t\nx_d\ty_d\tz_d\n1\t1\t1\n3\t3\t3\n", kUnstated);
  expect_two("a.txt", "# x y z\n1 1 1\n3 3 3\n", kInD);
  expect_two("a.txt", "   x_d    y_d   z_d\n  1.0   1.0   1.0\n  3.0   3.0   3.0\n", kUnstated);
  expect_two("a.csv", "id,x,y,z\n2,3,3,3\n1,1,1,1\n", kInD);
  expect_two("a.data", data(kBounds, kAtoms), kInD);
  expect_two("a.data", data("", "Atoms\n\n2 1 3 3 3 0 0 0\n1 1 1 1 1 0 0 0\n"), kInD);
  expect_two("a.dump", dump("id type xu yu zu", "2 1 3 3 3\n1 1 1 1 10\n"), kInD);  // z is wrapped
}

TEST(PackingFile, LengthsMayBeInMillimetresCentimetresOrMicrometres) {
  for (const char* names : {"x_mm,y_mm,z_mm", "x [mm],y(mm),z (mm)", "X mm,Y mm,Z mm"}) {
    expect_two("a.csv", fmt::format("{},diameter_mm\n3,3,3,3\n9,9,9,3\n", names), kUnstated);
  }
  expect_two("a.csv", "x_cm,y_cm,z_cm\n.3,.3,.3\n.9,.9,.9\n", kUnstated);
  for (const char* unit : {"um", "\u00b5m", "\u03bcm"}) {
    expect_two("a.csv", fmt::format("x_{0},y_{0},z_{0}\n3000,3000,3000\n9000,9000,9000\n", unit),
               kUnstated);
  }
  expect_two("a.csv", "x [m],y [m],z [m]\n3e-3,3e-3,3e-3\n9e-3,9e-3,9e-3\n", kUnstated);
  expect_two("a.xyz", xyz("length_unit=mm", "A 3 3 3\nA 9 9 9"), kUnstated);
  const std::string atoms = "Atoms # atomic\n\n1 1 .3 .3 .3\n2 1 .9 .9 .9\n";
  expect_two("a.data", "spheres, units = cgs" + data("", atoms).substr(10), kUnstated);
  expect_two("a.dump", "ITEM: UNITS\ncgs\n" + dump("id x y z", "1 .3 .3 .3\n2 .9 .9 .9\n"),
             kUnstated);
  PackingFacts in_mm = kUnstated;
  in_mm.unit = LengthUnit::mm;
  expect_two("a.csv", "x,y,z,vx [mm/s],vy [mm/s],vz [mm/s]\n3,3,3,0,0,0\n9,9,9,0,0,0\n", in_mm);
  const PackingFile moving = read_packing(
      "x_mm,y_mm,z_mm,vx_mm_per_s,vy_mm_per_s,vz_mm_per_s\n3,3,3,6,3,0\n", "a.csv", kUnstated);
  ASSERT_TRUE(moving.velocity);
  EXPECT_LT((moving.velocity->col(0) - Eigen::Vector3d(2, 1, 0)).norm(), 1e-12);
}

const std::string kKeys = kXyz + kOrRemove;
const std::string kLammpsUnits =
    " The unit of lengths must be one of m, d, mm, cm, um, si, cgs, lj. With lj, the manifest must "
    "give the unit.";
const std::string kOneUnit = "Write all lengths in m (x_m) or all in d (x_d).";
const std::string kUpright =
    "Use a rectangular box. A sheared cell is rectangular at the end of a cycle.";

/// A frame of extended XYZ with the columns species, position and these.
std::string with_columns(const std::string& properties, const std::string& values) {
  return xyz(kLattice + "Properties=species:S:1:pos:R:3:" + properties,
             "A 1 1 1 " + values + "\nA 3 3 3 " + values + "\n");
}

std::string csv(const std::string& column, const std::string& value) {
  return "x,y,z," + column + "\n1,1,1," + value + "\n3,3,3," + value + "\n";
}

std::string titled(const std::string& title) {
  return title + data(kBounds, kAtoms).substr(10);
}

std::string in_units(const std::string& units) {
  return "ITEM: UNITS\n" + units + "\n" + dump("id x y z", "1 1 1 1\n2 3 3 3\n");
}

/// What becomes of two grains at (1, 1, 1) and (3, 3, 3) d: what is read, or the message after the
/// name of the file.
struct Parts {
  std::string file, text, says;
};

const std::string kTwo = "2 grains, no box, no velocities", kBoxed = "2 grains, box 9 x 9 x 9 d, ",
                  kStill = kBoxed + "no velocities";

// No part of a file that changes box, unit, size or velocity is ignored without a word.
const std::vector<Parts> kParts = {
    // Keys of extended XYZ.
    {"a.xyz", xyz("Lattice = \"9 0 0 2 9 0 0 0 9\"", "A 1 1 1\nA 3 3 3\n"),
     ":2:1: cannot be read in this form (got Lattice). " + kKeys},
    {"a.xyz", xyz("Lattice= \"9 0 0 0 9 0 0 0 9\"", "A 1 1 1\nA 3 3 3\n"),
     ":2:1: cannot be read in this form (got Lattice). " + kKeys},
    {"a.xyz", xyz("pbc=\"F F T\" Origin\t=\t\"0 0 0\"", "A 1 1 1\nA 3 3 3\n"),
     ":2:13: cannot be read in this form (got Origin). " + kKeys},
    {"a.xyz", xyz("Properties = species:S:1:pos:R:3:radius:R:1", "A 1 1 1 .5\nA 3 3 3 .5\n"),
     ":2:1: cannot be read in this form (got Properties). " + kKeys},
    {"a.xyz", xyz("lattice=\"9 0 0 0 9 0 0 0 9\"", "A 1 1 1\nA 3 3 3\n"),
     ":2:1: cannot be read in this form (got lattice). " + kKeys},
    {"a.xyz", xyz("Cell=\"9 9 9\"", "A 1 1 1\nA 3 3 3\n"),
     ":2:1: cannot be read in this form (got Cell). " + kKeys},
    {"a.xyz", xyz("units=angstrom", "A 1 1 1\nA 3 3 3\n"),
     ":2:1: cannot be read in this form (got units). " + kKeys},
    {"a.xyz", xyz("length_unit = m", "A 1 1 1\nA 3 3 3\n"),
     ":2:1: gives lengths in m, but the manifest has lengths in d." + kTwoUnits},
    {"a.xyz", xyz("length_unit = 'd' Lattice='9 0 0 0 9 0 0 0 9'", "A 1 1 1\nA 3 3 3\n"),
     kStill + "; not read: species"},
    {"a.xyz", xyz("velocity_unit=mm/s", "A 1 1 1\nA 3 3 3\n"),
     ":2:1: gives lengths in mm, but the manifest has lengths in d." + kTwoUnits},
    {"a.xyz", xyz("energy= Lattice=\"9 0 0 1 9 0 0 0 9\"", "A 1 1 1\nA 3 3 3\n"),
     ":2:1: the box is not orthogonal: an edge leans by 1. " + kUpright},
    {"a.xyz", xyz(kLattice + "pbc=\"T T T\" energy=-1.0 note=\"a = b\"", "A 1 1 1\nA 3 3 3\n"),
     kStill + "; not read: species, pbc, energy, note"},
    // Comments without keys of ours.
    {"a.xyz", xyz(" i = 0, time = 0.000, E = -17.16", "A 1 1 1\nA 3 3 3\n"),
     kTwo + "; not read: species, i, time, E"},
    {"a.xyz", xyz("frame 0 | Written by MDAnalysis XYZWriter", "A 1 1 1\nA 3 3 3\n"),
     kTwo + "; not read: species, comment"},
    {"a.xyz", xyz("lengths [mm]", "A 1 1 1\nA 3 3 3\n"),
     ":2:1: gives lengths in mm, but the manifest has lengths in d." + kTwoUnits},
    {"a.xyz", xyz("saved in m:/sim, jammed in m dimensions", "A 1 1 1\nA 3 3 3\n"),
     kTwo + "; not read: species, comment"},
    {"a.xyz", xyz("domain=\"9 9 9\"", "A 1 1 1\nA 3 3 3\n"),
     ":2:1: cannot be read in this form (got domain). " + kKeys},
    {"a.xyz", xyz("Properties=species:S:1:pos:R:3:Z:I:1", "A 1 1 1 14\nA 3 3 3 14\n"),
     kTwo + "; not read: species, atomic number"},
    {"a.xyz", xyz("run 3, t = 0.5, E = -17.16", "A 1 1 1\nA 3 3 3\n"),
     kTwo + "; not read: species, t, E, comment"},
    {"a.xyz", xyz("Generated by ASE on 3 May; 2 spheres in metal", "A 1 1 1\nA 3 3 3\n"),
     kTwo + "; not read: species, comment"},
    {"a.xyz", xyz("an fcc lattice, a = = b E=-1 E=-2", "A 1 1 1\nA 3 3 3\n"),
     kTwo + "; not read: species, a, E, comment"},
    {"a.xyz", xyz("", "A 1 1 1 0 0 0\nA 3 3 3 0 0 0\n"),
     kTwo + "; not read: species, further columns"},
    // Columns of extended XYZ; momenta as ASE 3.22 writes them.
    {"a.xyz", xyz("Properties=species:S:1:forces:R:3:pos:R:3", "A 7 7 7 1 1 1\nA 8 8 8 3 3 3\n"),
     kTwo + "; not read: species, forces"},
    {"a.xyz", with_columns("momenta:R:3", "1.00800000 0.00000000 0.00000000"),
     ":2:60: is not a valid name for a position or velocity (got momenta). " + kXyz +
         kOrRemoveColumn},
    {"a.xyz", with_columns("velo:R:3:momenta:R:3", "1 0 0 1 0 0"),
     kBoxed + "velocities; not read: species, momenta"},
    {"a.xyz", with_columns("V:R:3", "1 0 0"),
     ":2:60: is not a valid name for a position or velocity (got V). " + kXyz + kOrRemoveColumn},
    {"a.xyz", with_columns("angular_velocity:R:3:Omega:R:3", "1 0 0 1 0 0"),
     kStill + "; not read: species, angular_velocity, Omega"},
    {"a.xyz", with_columns("Radius:R:1:magmoms:R:1", ".5 1"),
     kStill + "; not read: species, magmoms"},
    {"a.xyz", with_columns("radii:R:3", "1 1 1"),
     ":2:60: has 3 values in each row (got radii). It must have 1."},
    {"a.xyz", with_columns("R:R:1", "0.7"),
     ":3:9: R: is not the radius of the manifest's grains, 0.5 d (got 0.7)." + kEqual},
    {"a.xyz", with_columns("radius:R:1", "0.0015"),
     ":3:9: radius: is not the radius of the manifest's grains, 0.5 d (got 0.0015)." + kEqual},
    {"a.xyz", with_columns("particle_size:R:1", "0.9"),
     ":3:9: particle_size: is not the diameter of the manifest's grains, 1 d (got 0.9)." + kEqual},
    {"a.xyz", xyz("Properties=species:S:1:positions:R:3", "A 1 1 1\nA 3 3 3\n"),
     ":2:24: is not a valid name for a position or velocity (got positions). " + kXyz +
         kOrRemoveColumn},
    // LAMMPS data.
    {"a.data", titled("packing, all lengths in units of nm"),
     ":1:34: units: cannot be read (got nm)." + kLammpsUnits},
    {"a.data", titled("lengths in nm"), ":1:12: units: cannot be read (got nm)." + kLammpsUnits},
    {"a.data", data("0 9 xlo xhi # units nm\n", kAtoms),
     ":5:21: units: cannot be read (got nm)." + kLammpsUnits},
    {"a.data", data("# units: nm\n" + kBounds, kAtoms),
     ":5:10: units: cannot be read (got nm)." + kLammpsUnits},
    {"a.data", data(kBounds + "2 0 0 XY XZ YZ\n", kAtoms),
     ":8:1: cannot be read in this form (got 2 0 0 XY XZ YZ). " + kData + kOrRemove},
    {"a.data", data("0 bonds\n2 extra bond per atom\n" + kBounds, kAtoms),
     kStill + "; not read: type, 2 extra bond per atom"},
    {"a.data", data(kBounds, kAtoms + "\nvelocities\n\n1 0 0 0\n2 0 0 0\n"),
     ":14:1: cannot be read in this form (got velocities). " + kData + kOrRemove},
    {"a.data", data(kBounds, kAtoms + "\nEllipsoids\n\n1 2 1 1 1 0 0 0\n"),
     ":14:1: cannot be read in this form (got Ellipsoids). " + kData + kOrRemove},
    {"a.data", data("9 0 0 avec\n0 9 0 bvec\n0 0 9 cvec\n", kAtoms),
     ":5:1: cannot be read in this form (got 9 0 0 avec). " + kData + kOrRemove},
    {"a.data", data("0 9 xlo xhi\n0 9 ylo yhi\n", kAtoms),
     ":6:1: the box is not complete, or has an edge that is not positive: 9 x 9 x -inf. " + kData},
    {"a.data", data("2 0 0 xy xz yz\n", kAtoms),
     ":5:1: the box is not complete, or has an edge that is not positive: -inf x -inf x -inf. " +
         kData},
    {"a.data", data("2 0 0 xy xz yz\n" + kBounds, kAtoms),
     ":8:1: the box is not orthogonal: an edge leans by 2. " + kUpright},
    {"a.data", titled("LAMMPS data file via write_data, version 4 Feb 2025, units = cgs"),
     ":1:1: gives lengths in cm, but the manifest has lengths in d." + kTwoUnits},
    {"a.data", titled("soft spheres (units real)"),
     ":1:21: units: cannot be read (got real)." + kLammpsUnits},
    {"a.data", titled("LAMMPS data file via write_data, timestep = 0, units = lj"),
     kStill + "; not read: type"},
    {"a.data", titled("units: si"),
     ":1:1: gives lengths in m, but the manifest has lengths in d." + kTwoUnits},
    {"a.data", titled("units unknown to me"), kStill + "; not read: type"},
    {"a.data", data(kBounds, "Atoms\n\n1 1 1 1 1 # C\n2 1 3 3 3#C\n"), kStill + "; not read: type"},
    {"a.data",
     data(kBounds,
          "Atom Type Labels\n\n1 C\n\nMasses\n\n1 12\n\nAtoms # atomic\n\n# first\n1 C 1 1 1 "
          "0 0 0 # a\n2 C 3 3 3 0 0 0\n"),
     kStill + "; not read: type, image flags, Atom Type Labels, Masses"},
    {"a.data",
     data(kBounds,
          "Atoms # sphere\n\n1 1 1 1.9 1 1 1\n2 1 1 1.9 3 3 3\n\nVelocities\n\n1 1 0 0 0 0 "
          "0\n2 0 1 0 0 0 0\n"),
     kBoxed + "velocities; not read: type, density, angular velocities"},
    // LAMMPS dumps.
    {"a.dump", in_units("cgs"),
     ":2:1: gives lengths in cm, but the manifest has lengths in d." + kTwoUnits},
    {"a.dump", in_units("nano"), ":2:1: units: cannot be read (got nano)." + kLammpsUnits},
    {"a.dump", in_units("si"),
     ":2:1: gives lengths in m, but the manifest has lengths in d." + kTwoUnits},
    {"a.dump", in_units("lj"), kStill},
    {"a.dump", dump("id x y z xu yu zu", "1 1 1 1 1 1 10\n2 3 3 3 3 3 3\n"),
     kStill + "; not read: xu, yu, zu"},
    {"a.dump", dump("id type x y zu xs ix", "1 1 1 1 1 0.1 0\n2 1 3 3 12 0.3 0\n"),
     kStill + "; not read: type, xs, ix"},
    {"a.dump", dump("id x y z c_rad", "1 1 1 1 0.5\n2 3 3 3 0.7\n"),
     ":11:9: c_rad: is not the radius of the manifest's grains, 0.5 d (got 0.7)." + kEqual},
    {"a.dump", dump("id x y z v_x", "1 1 1 1 1\n2 3 3 3 1\n"),
     ":9:22: is not a valid name for a position or velocity (got v_x). " + kDump + kOrRemoveColumn},
    {"a.dump", dump("id x y z f_vel[1]", "1 1 1 1 1\n2 3 3 3 1\n"),
     ":9:22: is not a valid name for a position or velocity (got f_vel[1]). " + kDump +
         kOrRemoveColumn},
    {"a.dump", dump("id x y z vel", "1 1 1 1 1\n2 3 3 3 1\n"),
     ":9:22: is not a valid name for a position or velocity (got vel). " + kDump + kOrRemoveColumn},
    {"a.dump", dump("id x y z radius diameter d_radius", "1 1 1 1 .5 1 7\n2 3 3 3 .5 1 7\n"),
     kStill + "; not read: d_radius"},
    {"a.dump", dump("id x y z radius diameter", "1 1 1 1 .5 1\n2 3 3 3 .5 2\n"),
     ":11:12: diameter: is not the diameter of the manifest's grains, 1 d (got 2)." + kEqual},
    {"a.dump", dump("id x y z shapex shapey shapez", "1 1 1 1 1 1 1\n2 3 3 3 1 1 1\n"), kStill},
    {"a.dump", dump("id x y z shapex shapey shapez", "1 1 1 1 1 2 1\n2 3 3 3 1 2 1\n"),
     ":10:11: shapey: is not the diameter of the manifest's grains, 1 d (got 2)." + kEqual},
    {"a.dump", "ITEM: LENGTH UNIT\nmm\n" + dump("id x y z", "1 1 1 1\n2 3 3 3\n"),
     ":1:7: cannot be read in this form (got LENGTH UNIT). " + kDump + kOrRemove},
    {"a.dump", "ITEM: NOTES\none\ntwo\n" + dump("id x y z", "1 1 1 1\n2 3 3 3\n"),
     kStill + "; not read: NOTES"},
    {"a.dump",
     [] {
       std::string text = dump("id x y z", "1 1 1 1\n2 3 3 3\n");
       return text.replace(text.find("ff ff pp"), 8, "pp pp pp");
     }(),
     kStill + "; not read: boundary pp pp pp"},
    // CSV.
    {"a.csv", csv("vx_mm_per_s", "1"),
     ":1:7: is in another unit than the earlier columns (got vx_mm_per_s). " + kOneUnit},
    {"a.csv", csv("Vx (mm/s)", "1"),
     ":1:7: is in another unit than the earlier columns (got Vx (mm/s)). " + kOneUnit},
    {"a.csv", csv("vx_km_per_s", "1"),
     ":1:7: is not a valid name for a position or velocity (got vx_km_per_s). " + kCsv +
         kOrRemoveColumn},
    {"a.csv", csv("x_mm", "7"), kTwo + "; not read: x_mm"},
    {"a.csv", csv("Diameter [d]", "1"), kTwo},
    {"a.csv", "x_nm,y_nm,z_nm\n1,1,1\n3,3,3\n", ":1:1: the column x is missing. " + kCsv},
    {"a.csv", csv("velocity:0", "1"),
     ":1:7: is not a valid name for a position or velocity (got velocity:0). " + kCsv +
         kOrRemoveColumn},
    {"a.csv", csv("momentum_x", "1"),
     ":1:7: is not a valid name for a position or velocity (got momentum_x). " + kCsv +
         kOrRemoveColumn},
    {"a.csv", csv("Velocity.X", "1"),
     ":1:7: is not a valid name for a position or velocity (got Velocity.X). " + kCsv +
         kOrRemoveColumn},
    {"a.csv", csv("Points:0", "7"), kTwo + "; not read: Points:0"},
    {"a.csv", csv("vx_ms-1", "1"),
     ":1:7: is not a valid name for a position or velocity (got vx_ms-1). " + kCsv +
         kOrRemoveColumn},
    {"a.csv", csv("lin_vel_x", "1"),
     ":1:7: is not a valid name for a position or velocity (got lin_vel_x). " + kCsv +
         kOrRemoveColumn},
    {"a.csv", csv("d_p", "4"),
     ":2:7: d_p: is not the diameter of the manifest's grains, 1 d (got 4)." + kEqual},
    {"a.csv", csv("R0", "2"),
     ":2:7: R0: is not the radius of the manifest's grains, 0.5 d (got 2)." + kEqual},
    {"a.csv", csv("box_x", "9"),
     ":1:7: cannot be read in this form (got box_x). " + kCsv + kOrRemove},
    {"a.csv", csv("tilt_xy", "0.3"),
     ":1:7: cannot be read in this form (got tilt_xy). " + kCsv + kOrRemove},
    {"a.csv", csv("length_unit", "mm"),
     ":1:7: cannot be read in this form (got length_unit). " + kCsv + kOrRemove},
    {"a.csv", csv("radius_of_curvature,diameter ratio", "7,7"),
     kTwo + "; not read: radius_of_curvature, diameter ratio"},
    {"a.csv", csv("unit", "mm"),
     ":1:7: cannot be read in this form (got unit). " + kCsv + kOrRemove},
    {"a.csv", csv("r", "0.5"), kTwo},
    {"a.csv", csv("D", "1"), kTwo},
    {"a.csv", csv("Particle Radius", "0.5"), kTwo},
    {"a.csv", csv("sigma", "1"), kTwo},
    {"a.csv", csv("diameter_mm", "3"),
     ":1:7: is in another unit than the earlier columns (got diameter_mm). " + kOneUnit},
    {"a.csv", csv("diam", "3"),
     ":2:7: diam: is not the diameter of the manifest's grains, 1 d (got 3)." + kEqual},
    {"a.csv", csv("grain diam", "1.1"),
     ":2:7: grain diam: is not the diameter of the manifest's grains, 1 d (got 1.1)." + kEqual},
    {"a.csv", "x_d,y_d,z_d,radii_m\n1,1,1,.5\n3,3,3,.5\n",
     ":1:13: is in another unit than the earlier columns (got radii_m). " + kOneUnit},
    {"a.csv", csv("element", "C"), kTwo + "; not read: element"},
    {"a.csv", csv("theta_rad", "3"), kTwo + "; not read: theta_rad"},
    {"a.csv", csv("is diamond", "1"), kTwo + "; not read: is diamond"},
    {"a.csv", csv("cluster_size", "9"), kTwo + "; not read: cluster_size"},
    {"a.csv", csv("", "9"), kTwo + "; not read: column 4"},
    {"a.csv", "name,x,y,z\n\"a, b\",1,1,1\n\"say \"\"c\"\", d\",3,3,3\n",
     kTwo + "; not read: name"},
    {"a.csv", "x;y;z;n\n1;1;1;\"a;b\"\n3;3;3;5\" wide\n", kTwo + "; not read: n"},
    {"a.txt", std::string("\"my, name\"\tx\ty\tz\n\"a\tb\"\t1\t1\t1\nc\t3\t3\t3\n"),
     kTwo + "; not read: my, name"},
    {"a.csv", "n,x,y,z\n\"open,1,1,1\nb,3,3,3\n", ":2:1: has 1 fields instead of 4. " + kFields},
};

TEST(PackingFile, EveryPartIsReadRefusedOrNamed) {
  for (const Parts& parts : kParts) {
    SCOPED_TRACE(parts.text);
    std::string says;
    try {
      const PackingFile packing = read_packing(parts.text, parts.file, kInD);
      says = describe(packing);
      EXPECT_LT((packing.position.col(0).array() - 1).abs().maxCoeff(), 1e-12);
      EXPECT_LT((packing.position.col(1).array() - 3).abs().maxCoeff(), 1e-12);
    } catch (const ManifestError& error) {
      says = std::string(error.what()).substr(parts.file.size());
    }
    EXPECT_EQ(says, parts.says);
  }
}

/// Expects that two grains of a file of the manifest's unit d are refused because of this part.
void expect_unread(const std::string& file, const std::string& text, const std::string& part,
                   const std::string& problem = "cannot be read") {
  const std::string says = message_of<ManifestError>([&] { read_packing(text, file, kInD); });
  EXPECT_NE(says.find(problem), says.npos) << text << says;
  EXPECT_NE(says.find("(got " + part), says.npos) << text << says;
}

TEST(PackingFile, ABoxOrUnitInAnotherFormIsRefused) {
  const std::string nine = "9 0 0 2 9 0 0 0 9", rows = "A 1 1 1\nA 3 3 3\n";
  for (const std::string key : {"unit_cell", "cell_vectors", "Lattice_vectors", "anything"}) {
    expect_unread("a.xyz", xyz(key + "=\"" + nine + "\"", rows), key);
  }
  expect_unread("a.xyz", xyz("boxsize=\"9 8 9\"", rows), "boxsize");
  expect_unread("a.xyz", xyz("Lx=9 Ly=9 Lz=9", rows), "Lx");
  expect_unread("a.xyz", xyz("\"Lattice\"=\"" + nine + "\"", rows), "Lattice");
  expect_unread("a.xyz", xyz("Lattice:\"" + nine + "\"", rows), "Lattice:");
  expect_unread("a.xyz", xyz("CELL(H) " + nine, rows), "CELL(H) " + nine);
  expect_unread("a.xyz", xyz("tric d " + nine + " step=1", rows), "tric d " + nine);
  expect_unread("a.xyz", xyz("CRYST1 9.0 9.0 9.0 70.00 90.00 90.00", rows), "CRYST1 9.0");
  const std::string leaning = message_of<ManifestError>(
      [&] { read_packing(xyz("pbc=\"T T T\";Lattice=\"" + nine + "\"", rows), "a.xyz", kInD); });
  EXPECT_NE(leaning.find("the box is not orthogonal: an edge leans by 2"), leaning.npos) << leaning;
  for (const std::string key : {"unit_length", "distance_unit", "coordinates", "time_unit"}) {
    expect_unread("a.xyz", xyz(key + "=fractional", rows), key);
  }
  expect_unread("a.xyz", xyz("scale=0.001", rows), "scale=0.001");
  expect_unread("a.xyz", xyz(kLattice + "; units: nm", rows), "nm");
  expect_unread("a.xyz", xyz("fractional coordinates", rows), "fractional coord");
}

TEST(PackingFile, UnitsInProseAreReadRefusedOrNamed) {
  struct Prose {
    const char *comment, *unit;  // unit "": named
  };
  for (const auto& [comment, unit] :
       std::vector<Prose>{{"coordinates in Å", "Å"},
                          {"energy in eV, positions [Å], forces in eV/Å", "Å"},
                          {"lengths in \u212b", "\u212b"},
                          {"all in Ångström", "Ångström"},
                          {"i = 0, x [Angstrom]", "Angstrom"},
                          {"positions in A", "A"},
                          {"units: Ang", "Ang"},
                          {"velocities in Å/ps", "Å"},
                          {"Positions in Bohr", "Bohr"},
                          {"units: a.u.", "a.u."},
                          {"x/Å y/Å z/Å", "Å"},
                          {"atomic units", "atomic units"},
                          {"lengths in inches", "inches"},
                          {"coordinates in microns", "microns"},
                          {"unit of length: 1e-10 m", "1e-10 m"},
                          {"positions in 10^-6 m", "10^-6 m"},
                          {"x (nm) y (nm) z (nm)", "nm"},
                          {" i = 0, time = 0.000, E = -17.16", ""},
                          {"forces in eV/Å, stress in eV/Å^3", ""},
                          {"positions in a box", ""},
                          {"grains in a cell, at rest", ""},
                          {"molecule A of an ASE run", ""},
                          {"volume 9 Å\u00b3", ""}}) {
    const std::string text = xyz(comment, "A 1 1 1\nA 3 3 3\n");
    if (*unit != 0) {
      expect_unread("a.xyz", text, unit);
    } else {
      expect_two("a.xyz", text, kInD);
    }
  }
  expect_two("a.xyz", xyz("x (mm) y (mm) z (mm)", "A 3 3 3\nA 9 9 9\n"), kUnstated);
}

TEST(PackingFile, VelocitiesUnderOtherNamesAreRefused) {
  for (const std::string name : {"p", "dxdt", "u"}) {
    expect_unread("a.xyz", with_columns(name + ":R:3", "1 0 0"), name, "is not a valid name");
  }
  for (const std::string name : {"vcmx", "vxu", "vzu"}) {
    expect_unread("a.dump", dump("id x y z " + name, "1 1 1 1 1\n2 3 3 3 1\n"), name,
                  "is not a valid name");
  }
  for (const std::string name : {"ux", "U:0", "dx/dt"}) {
    expect_unread("a.csv", csv(name, "1"), name, "is not a valid name");
  }
  EXPECT_EQ(describe(read_packing(csv("p", "7"), "a.csv", kInD)), kTwo + "; not read: p");
}

TEST(PackingFile, DiametersUnderOtherNamesAreCompared) {
  for (const std::string name : {"dp", "Rp", "grain_size", "grain_d"}) {
    const std::string says =
        message_of<ManifestError>([&] { read_packing(csv(name, "0.8"), "a.csv", kInD); });
    EXPECT_NE(says.find(": " + name + ": is not the "), says.npos) << says;
  }
}

TEST(PackingFile, OfManyColumnsTheFirstAreNamed) {
  std::string names = "x,y,z", values = "1,1,1";
  for (int k = 0; k < 20; ++k) names += fmt::format(",c{}", k), values += ",0";
  EXPECT_EQ(
      describe(read_packing(names + "\n" + values + "\n", "a.csv", kInD)),
      "1 grain, no box, no velocities; not read: c0, c1, c2, c3, c4, c5, c6, c7, c8, c9, c10, "
      "c11 and 8 more");
  for (int k = 20; k < 1000; ++k) names += fmt::format(",c{}", k);
  EXPECT_EQ(
      message_of<ManifestError>([&] { read_packing(names + "\n", "a.csv", kInD); }),
      "a.csv:1:1: has 1003 columns. At most 1000 columns can be read. Leave out some columns.");
}

/// The numbers of truth.csv.
PackingFile truth(const fs::path& folder) {
  return read_packing(read_bytes(folder / "truth.csv"), "truth.csv", kUnstated);
}

TEST(PackingFile, ScriptsAseAndLammpsAreRead) {
  const TemporaryFolder folder;
  const fs::path& at = folder.path();
  const std::string script =
      fs::path(SHEARCELL_TEST_DATA) / ".." / "experiments" / "write_packings.py";
  ASSERT_EQ(std::system(("/usr/bin/python3 " + script + " " + at.string()).c_str()), 0);
  const PackingFile expected = truth(at);
  ASSERT_EQ(expected.position.cols(), 500);
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(at)) {
    const std::string name = entry.path().filename().string();
    SCOPED_TRACE(name);
    const PackingFile packing =
        read_packing(read_bytes(entry.path()), name, name == "truth.csv" ? kUnstated : kInD);
    // XYZ of ASE has 8 decimals, dump xyz of LAMMPS has 6 digits.
    const double rounding = name.find(".xyz") == name.npos || name == "plain.xyz" ? 1e-13 : 1e-4;
    ASSERT_EQ(packing.position.cols(), 500);
    EXPECT_LT((packing.position - expected.position).cwiseAbs().maxCoeff(), rounding);
    const bool still = name.find("_still") != name.npos || name == "plain.xyz";
    ASSERT_EQ(packing.velocity.has_value(), !still);
    if (!still) {
      EXPECT_LT((*packing.velocity - *expected.velocity).cwiseAbs().maxCoeff(), rounding);
    }
    const bool boxed = name.find(".csv") == name.npos && name != "plain.xyz" &&
                       name.find("_still.xyz") == name.npos;
    if (boxed) {
      ASSERT_TRUE(packing.box);
      EXPECT_EQ(packing.box->min(), Eigen::Vector3d::Zero());
      EXPECT_EQ(packing.box->max(), Eigen::Vector3d(10, 12, 11));
    }
    ++files;
  }
  EXPECT_GE(files, 5U);
  std::printf("%zu files\n", files);
}

}  // namespace
}  // namespace shearcell::test
