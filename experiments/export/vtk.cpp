// SPDX-License-Identifier: GPL-3.0-or-later
// Writes XML PolyData with appended raw data, as VTK's file formats specify.
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <numeric>

#include "experiments/export/formats.hpp"
#include "provenance/io/file.hpp"

namespace shearcell {
namespace {

static_assert(std::endian::native == std::endian::little, "the files declare LittleEndian");

/// Collects arrays. They are written after the XML elements that refer to them.
class PolyData {
 public:
  template <typename Number>
  std::string array(const std::string& name, const char* type, int components,
                    const std::vector<Number>& values, const char* more = "") {
    std::string element = fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" {}format=\"appended\" "
        "offset=\"{}\"/>\n",
        type, name, components, more, data_.size());
    const std::uint64_t bytes = values.size() * sizeof(Number);
    data_.append(reinterpret_cast<const char*>(&bytes), sizeof bytes);
    data_.append(reinterpret_cast<const char*>(values.data()), bytes);
    return element;
  }

  void write(const std::filesystem::path& file, const std::string& piece) const {
    append(file,
           "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
           "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n" +
               piece + "</PolyData>\n<AppendedData encoding=\"raw\">\n_" + data_ +
               "\n</AppendedData>\n</VTKFile>\n");
  }

 private:
  std::string data_;
};

std::vector<double> flat(const Eigen::Matrix3Xd& columns) {
  return {columns.data(), columns.data() + columns.size()};
}

std::vector<std::int64_t> count_from(std::int64_t first, std::size_t count) {
  std::vector<std::int64_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), first);
  return numbers;
}

void write_grains(const ExportedState& f, const std::filesystem::path& file) {
  PolyData out;
  std::string piece = "<FieldData>\n";
  const auto add_field = [&](const std::string& name, double value) {
    piece += out.array(name, "Float64", 1, std::vector<double>{value}, "NumberOfTuples=\"1\" ");
  };
  add_field("cycle", f.checkpoint.cycle);
  add_field("TimeValue", f.checkpoint.time_s);
  for (const auto& [name, value] : f.scalars) {
    if (std::isfinite(value)) add_field(name, value);
  }
  piece += "</FieldData>\n";
  piece += fmt::format("<Piece NumberOfPoints=\"{0}\" NumberOfVerts=\"{0}\" NumberOfPolys=\"0\">\n",
                       f.particles());
  piece += "<Points>\n" + out.array("Points", "Float64", 3, flat(f.position)) + "</Points>\n";
  piece += "<PointData>\n" + out.array("id", "Int64", 1, count_from(1, f.particles())) +
           out.array("velocity", "Float64", 3, flat(f.velocity)) +
           out.array("radius", "Float64", 1, std::vector<double>(f.particles(), f.radius));
  piece += out.array("type", "Int32", 1, f.type);
  for (const ExportedColumn& column : f.columns) {
    const std::vector<double>& all = column.values;
    piece += column.whole ? out.array(column.name, "Int32", 1,
                                      std::vector<std::int32_t>(all.begin(), all.end()))
                          : out.array(column.name, "Float64", 1, all);
  }
  piece += "</PointData>\n<Verts>\n" +
           out.array("connectivity", "Int64", 1, count_from(0, f.particles())) +
           out.array("offsets", "Int64", 1, count_from(1, f.particles())) + "</Verts>\n</Piece>\n";
  out.write(file, piece);
}

void write_cell(const ExportedState& f, const std::filesystem::path& file) {
  Eigen::Matrix3Xd corners(3, 8);
  for (int k = 0; k < 8; ++k) {
    corners.col(k) = f.origin + f.edges * Eigen::Vector3d(k & 1, (k >> 1) & 1, (k >> 2) & 1);
  }
  const std::vector<std::int64_t> faces = {0, 2, 6, 4, 1, 3, 7, 5, 0, 1, 5, 4,
                                           2, 3, 7, 6, 0, 1, 3, 2, 4, 5, 7, 6};
  PolyData out;
  std::string piece =
      "<Piece NumberOfPoints=\"8\" NumberOfVerts=\"0\" NumberOfPolys=\"6\">\n<Points>\n" +
      out.array("Points", "Float64", 3, flat(corners)) + "</Points>\n<Polys>\n" +
      out.array("connectivity", "Int64", 1, faces) +
      out.array("offsets", "Int64", 1, std::vector<std::int64_t>{4, 8, 12, 16, 20, 24}) +
      "</Polys>\n</Piece>\n";
  out.write(file, piece);
}

}  // namespace

FrameWriter vtk_writer(const std::filesystem::path& folder, std::size_t frames) {
  return [folder, left = frames, sets = std::string()](const ExportedState& f) mutable {
    const std::string grains = fmt::format("grains_{}.vtp", frame_name(f));
    const std::string cell = fmt::format("cell_{}.vtp", frame_name(f));
    write_grains(f, folder / grains);
    write_cell(f, folder / cell);
    sets += fmt::format(
        "<DataSet timestep=\"{0:.17g}\" part=\"0\" name=\"grains\" file=\"{1}\"/>\n"
        "<DataSet timestep=\"{0:.17g}\" part=\"1\" name=\"cell\" file=\"{2}\"/>\n",
        f.checkpoint.cycle == 0 ? f.checkpoint.time_s : f.checkpoint.cycle, grains, cell);
    if (--left > 0) return;
    write_output(folder / "frames.pvd",
                 "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" "
                 "version=\"1.0\">\n<Collection>\n" +
                     sets + "</Collection>\n</VTKFile>\n");
  };
}

}  // namespace shearcell
