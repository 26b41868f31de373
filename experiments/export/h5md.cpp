// SPDX-License-Identifier: GPL-3.0-or-later
// H5MD 1.1 (P. de Buyl, P. H. Colberg and F. Hofling, Comput. Phys. Commun. 185, 1546 (2014)).
#include <map>
#include <memory>
#include <numeric>
#include <stdexcept>

#include "experiments/export/formats.hpp"
#include "provenance/hdf5_write.hpp"

namespace shearcell {
namespace {

using hdf5::Handle;
using hdf5::make_group;
using hdf5::put_attribute;
using hdf5::put_dataset;
using hdf5::require;
using hdf5::Shape;

// MDAnalysis does not support metres, and reads units only as text of variable length. A velocity
// has the same value in nm/ns and in m/s.
constexpr double nm_per_m = 1e9;
constexpr std::size_t kHashDigits = 64;  // length of a SHA-256

void put_unit(const Handle& object, const std::string& unit) {
  if (unit.empty()) return;
  const Handle type(require(H5Tcopy(H5T_C_S1), "a text type"), H5Tclose);
  require(H5Tset_size(type.get(), H5T_VARIABLE), "a text type");
  const char* text = unit.c_str();
  put_attribute(object, "unit", type.get(), &text);
}

/// An H5MD file that is written frame by frame.
class Trajectory {
 public:
  Trajectory(const std::filesystem::path& path, std::size_t frames)
      : path_(path), frames_(frames), file_(create(path)) {}

  void add(const ExportedState& frame) {
    const hdf5::Library library;
    if (next_ == 0) begin(frame);
    if (frame.particles() != particles_) {
      throw std::runtime_error("the number of particles changes between checkpoints of one run");
    }
    const Eigen::Matrix3d edges = frame.edges * nm_per_m;  // columns become rows in the file
    const Eigen::Vector3d origin = frame.origin * nm_per_m;
    const Eigen::Matrix3Xd position = frame.position * nm_per_m;
    put("particles/all/step", H5T_STD_U64LE, {}, &frame.checkpoint.state.step);
    put("particles/all/time", H5T_IEEE_F64LE, {}, &frame.checkpoint.time_s, "s");
    element("particles/all/box/edges", H5T_IEEE_F64LE, {3, 3}, edges.data(), "nm");
    // The origin is an addition: H5MD does not define an origin of the box.
    element("particles/all/box/origin", H5T_IEEE_F64LE, {3}, origin.data(), "nm");
    element("particles/all/position", H5T_IEEE_F64LE, {particles_, 3}, position.data(), "nm");
    element("particles/all/velocity", H5T_IEEE_F64LE, {particles_, 3}, frame.velocity.data(),
            "nm ns-1");
    Eigen::Matrix3Xi image = Eigen::Matrix3Xi::Zero(3, static_cast<Eigen::Index>(particles_));
    image.row(2) = Eigen::Map<const Eigen::RowVectorXi>(frame.image.data(), image.cols());
    element("particles/all/image", H5T_STD_I32LE, {particles_, 3}, image.data());
    for (const ExportedColumn& column : frame.columns) {
      const std::string path = "particles/all/" + column.name;
      if (column.whole) {
        const std::vector<std::int32_t> whole(column.values.begin(), column.values.end());
        element(path, H5T_STD_I32LE, {particles_}, whole.data());
      } else {
        element(path, H5T_IEEE_F64LE, {particles_}, column.values.data());
      }
    }
    const Handle hash(require(H5Tcopy(H5T_C_S1), "a text type"), H5Tclose);
    require(H5Tset_size(hash.get(), kHashDigits), "a text type");
    std::string checkpoint = frame.sha256;
    checkpoint.resize(kHashDigits, '\0');
    element("observables/checkpoint", hash.get(), {}, checkpoint.data());
    element("observables/cycle", H5T_IEEE_F64LE, {}, &frame.checkpoint.cycle);
    element("observables/theta", H5T_IEEE_F64LE, {}, &frame.checkpoint.theta, "rad");
    for (const auto& [name, value] : frame.scalars) {
      element("observables/" + name, H5T_IEEE_F64LE, {}, &value);
    }
    require(H5Fflush(file_.get(), H5F_SCOPE_GLOBAL), path_.string());
    ++next_;
  }

 private:
  static Handle create(const std::filesystem::path& path) {
    const hdf5::Library library;
    const Handle creation = hdf5::creation_list(H5P_FILE_CREATE);
    return {
        require(H5Fcreate(path.c_str(), H5F_ACC_EXCL, creation.get(), H5P_DEFAULT), path.string()),
        H5Fclose};
  }

  /// Writes the value of an H5MD element {step, time, value} for the current frame. All elements
  /// share the datasets `step` and `time`.
  void element(const std::string& path, hid_t type, const Shape& shape, const void* data,
               const std::string& unit = "") {
    if (next_ == 0) {
      const Handle group = make_group(file_, path);
      for (const std::string shared : {"step", "time"}) {
        require(H5Lcreate_hard(file_.get(), ("particles/all/" + shared).c_str(), group.get(),
                               shared.c_str(), H5P_DEFAULT, H5P_DEFAULT),
                "a link");
      }
    }
    put(path + "/value", type, shape, data, unit);
  }

  void begin(const ExportedState& frame) {
    particles_ = frame.particles();
    hdf5::put_h5md(file_, "1");
    const Handle particles = make_group(file_, "particles");
    const Handle all = make_group(particles, "all", 20);
    // MDAnalysis reads the number of particles from the group `trajectory`, and needs no topology.
    require(
        H5Lcreate_soft("/particles/all", particles.get(), "trajectory", H5P_DEFAULT, H5P_DEFAULT),
        "a link");
    hdf5::put_h5md_box(all);
    std::vector<std::uint64_t> id(particles_);
    std::iota(id.begin(), id.end(), std::uint64_t{1});
    put_dataset(all, "id", H5T_STD_U64LE, id.data(), {particles_});
    put_dataset(all, "species", H5T_STD_I32LE, frame.type.data(), {particles_});
    const std::vector<double> mass(particles_, frame.mass);
    put_unit(put_dataset(all, "mass", H5T_IEEE_F64LE, mass.data(), {particles_}), "kg");
    const std::vector<double> radius(particles_, frame.radius * nm_per_m);
    put_unit(put_dataset(all, "radius", H5T_IEEE_F64LE, radius.data(), {particles_}), "nm");
    make_group(file_, "observables", 3 + frame.scalars.size());
    const Handle parameters =
        make_group(file_, "parameters", 0, frame.run.size() + frame.parameters.size());
    for (const auto* facts : {&frame.run, &frame.parameters}) {
      for (const auto& [key, value] : *facts) {
        if (value.is_string()) {
          put_attribute(parameters, key, value.get<std::string>());
        } else if (value.is_number_unsigned()) {
          put_attribute(parameters, key, value.get<std::uint64_t>());
        } else {
          put_attribute(parameters, key, value.get<double>());
        }
      }
    }
  }

  /// Writes `data` as the next row of a dataset. At the first frame, creates the dataset.
  void put(const std::string& path, hid_t type, const Shape& shape, const void* data,
           const std::string& unit = "") {
    Shape count = shape, start(shape.size() + 1, 0);
    count.insert(count.begin(), frames_);
    if (next_ == 0) {
      Handle made = put_dataset(file_, path, type, nullptr, count);
      put_unit(made, unit);
      sets_.emplace(path, std::move(made));
    }
    const Handle& set = sets_.at(path);
    const Handle space(require(H5Dget_space(set.get()), path), H5Sclose);
    count.front() = 1;
    start.front() = next_;
    require(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(),
                                nullptr),
            path);
    const Handle memory = hdf5::make_space(count);
    require(H5Dwrite(set.get(), type, memory.get(), space.get(), H5P_DEFAULT, data), path);
  }

  std::filesystem::path path_;
  std::size_t frames_;
  std::size_t particles_ = 0;
  std::size_t next_ = 0;
  Handle file_;
  std::map<std::string, Handle> sets_;
};

}  // namespace

FrameWriter h5md_writer(const std::filesystem::path& file, std::size_t frames) {
  // Must be the first call of HDF5. Without it, if a write fails because the disk is full, HDF5
  // repeats the write at exit and crashes.
  H5dont_atexit();
  return
      [out = std::make_shared<Trajectory>(file, frames)](const ExportedState& f) { out->add(f); };
}

}  // namespace shearcell
