// SPDX-License-Identifier: GPL-3.0-or-later
// Our HDF5 reader compared with the HDF5 library, and checkpoint files that were truncated, damaged
// or forged under a valid digest.
#include <gtest/gtest.h>
#include <hdf5.h>

#include <cstdio>
#include <functional>
#include <limits>

#include "provenance/checkpoint.hpp"
#include "provenance/errors.hpp"
#include "provenance/hdf5_write.hpp"
#include "tests/provenance/samples.hpp"
#include "tests/support/frame.hpp"

namespace shearcell {
namespace {

using hdf5::Handle;
using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

/// A file image opened by the HDF5 library.
Handle open_image(std::vector<std::byte> image, unsigned flags = H5F_ACC_RDONLY) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access.get(), 1 << 20, false);
  H5Pset_file_image(access.get(), image.data(), image.size());
  Handle file(H5Fopen("image", flags, access.get()), H5Fclose);
  EXPECT_GE(file.get(), 0);
  return file;
}

std::vector<double> numbers(const Handle& file, const std::string& path) {
  const Handle set(H5Dopen2(file.get(), path.c_str(), H5P_DEFAULT), H5Dclose);
  EXPECT_GE(set.get(), 0) << path;
  const Handle space(H5Dget_space(set.get()), H5Sclose);
  std::vector<double> data(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space.get())));
  if (data.empty()) return data;
  EXPECT_GE(H5Dread(set.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, data.data()), 0);
  return data;
}

double attribute(const Handle& file, const char* group, const char* name) {
  double value = 0;
  const Handle read(H5Aopen_by_name(file.get(), group, name, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  EXPECT_GE(H5Aread(read.get(), H5T_NATIVE_DOUBLE, &value), 0) << name;
  return value;
}

std::vector<double> columns(const Eigen::Matrix3Xd& m) {
  return {m.data(), m.data() + m.size()};
}

/// What others read: grains, then wall grains, in SI units.
void expect_particles_in_si_units(const Handle& file, const Checkpoint& written) {
  const double d = written.units.diameter_m;
  const Eigen::Index grains = written.state.position.cols();
  const Eigen::Matrix3Xd walls = wall_grain_positions(written.cell, pose_of(written));
  Eigen::Matrix3Xd position(3, grains + walls.cols());
  Eigen::Matrix3Xd velocity = Eigen::Matrix3Xd::Zero(3, position.cols());
  position.leftCols(grains) = written.state.position * d;
  position.rightCols(walls.cols()) = walls * d;
  velocity.leftCols(grains) = written.state.velocity * d;
  EXPECT_EQ(numbers(file, "/particles/all/position/value"), columns(position));
  EXPECT_EQ(numbers(file, "/particles/all/velocity/value"), columns(velocity));
  std::vector<double> species(static_cast<std::size_t>(grains), 0);
  for (const WallGrain& grain : written.cell.wall_grains) {
    species.push_back(1 + static_cast<int>(grain.side));
  }
  EXPECT_EQ(numbers(file, "/particles/all/species"), species);
}

TEST(Hdf5Read, AgreesWithTheLibrary) {
  for (const int observables : {0, 1, 8, 9, 40, 1000}) {
    for (const Eigen::Index grains : {0, 1, 700}) {
      Checkpoint written = sample_checkpoint("a", 7, grains);
      written.observables.clear();
      for (int k = 0; k < observables; ++k) {
        written.observables["quantity " + std::to_string(k)] = 0.5 * k;
      }
      const std::vector<std::byte> image = encode_checkpoint(written);
      const Checkpoint read = decode_checkpoint(image);
      const Handle file = open_image(image);
      EXPECT_EQ(columns(read.state.position), numbers(file, "/restart/position"));
      EXPECT_EQ(columns(read.state.velocity), numbers(file, "/restart/velocity"));
      EXPECT_EQ(read.cell.wall_grains.size() * 3,
                numbers(file, "/restart/cell/wall_grain_position").size());
      EXPECT_EQ(read.theta, attribute(file, "/restart", "theta"));
      EXPECT_EQ(static_cast<double>(read.state.step), attribute(file, "/restart", "step"));
      EXPECT_EQ(read.cell.width, attribute(file, "/restart/cell", "width"));
      EXPECT_EQ(read.observables, written.observables);
      for (const auto& [name, value] : read.observables) {
        EXPECT_EQ(numbers(file, "/observables/" + name + "/value"), std::vector{value});
      }
      EXPECT_EQ(state_hash(read), state_hash(written));
      expect_particles_in_si_units(file, written);
    }
  }
}

// ---- Changes made with the HDF5 library; the digest is made valid again.

using Change = std::function<void(hid_t file)>;

std::vector<std::byte> forge(const Change& change) {
  std::vector<std::byte> image = encode_checkpoint(sample_checkpoint("a", 1, 5));
  const Handle file = open_image(image, H5F_ACC_RDWR);
  change(file.get());
  H5Fflush(file.get(), H5F_SCOPE_GLOBAL);
  const ssize_t size = H5Fget_file_image(file.get(), nullptr, 0);
  image.resize(kFrame + static_cast<std::size_t>(size));
  H5Fget_file_image(file.get(), image.data() + kFrame, static_cast<std::size_t>(size));
  return sealed(image);
}

Change without(const std::string& path) {
  return [=](hid_t file) { EXPECT_GE(H5Ldelete(file, path.c_str(), H5P_DEFAULT), 0); };
}

Change without_attribute(const std::string& name) {
  return [=](hid_t file) {
    EXPECT_GE(H5Adelete_by_name(file, "/restart", name.c_str(), H5P_DEFAULT), 0);
  };
}

/// `path` replaced by what `make` creates there.
Change instead(const std::string& path, const Change& make) {
  return [=](hid_t file) {
    without(path)(file);
    make(file);
  };
}

Change dataset(
    const char* path, hid_t type, const std::vector<hsize_t>& shape,
    const std::function<void(hid_t list)>& storage = [](hid_t) {}) {
  return instead(path, [=](hid_t file) {
    const Handle list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    storage(list.get());
    const Handle space = hdf5::make_space(shape);
    const Handle set(
        H5Dcreate2(file, path, type, space.get(), H5P_DEFAULT, list.get(), H5P_DEFAULT), H5Dclose);
    EXPECT_GE(set.get(), 0);
  });
}

template <class T>
Change values(const char* path, hid_t type, const std::vector<T>& data) {
  return [=](hid_t file) {
    const Handle set(H5Dopen2(file, path, H5P_DEFAULT), H5Dclose);
    EXPECT_GE(H5Dwrite(set.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data.data()), 0);
  };
}

template <class T>
Change attribute(const char* group, const char* name, hid_t type, T value) {
  return [=](hid_t file) {
    const Handle object(H5Oopen(file, group, H5P_DEFAULT), H5Oclose);
    H5Adelete(object.get(), name);
    hdf5::put_attribute(object, name, type, &value);
  };
}

struct Forgery {
  const char* what;
  std::string named;  ///< the object that the message must name
  Change change;
};

std::vector<Forgery> forgeries() {
  const char* p = "/restart/position";
  const char* v = "/restart/velocity";
  const char* sides = "/restart/cell/wall_grain_side";
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::uint64_t seven = 7;
  std::vector<Forgery> all;
  for (const char* path :
       {"/restart", p, v, "/restart/cell", "/restart/cell/wall_grain_side", "/observables"}) {
    all.push_back({"object missing", path, without(path)});
  }
  for (const std::string name : {"step", "run", "theta", "format", "wall_velocity"}) {
    all.push_back({"attribute missing", "/restart/" + name, without_attribute(name)});
  }
  const hid_t f64 = H5T_IEEE_F64LE, u64 = H5T_STD_U64LE;
  const std::vector<Forgery> more = {
      {"32-bit numbers", p, dataset(p, H5T_IEEE_F32LE, {5, 3})},
      {"integers", p, dataset(p, H5T_STD_I64LE, {5, 3})},
      {"big-endian numbers", p, dataset(p, H5T_IEEE_F64BE, {5, 3})},
      {"one dimension", p, dataset(p, f64, {5})},
      {"four columns", p, dataset(p, f64, {5, 4})},
      {"three dimensions", p, dataset(p, f64, {5, 3, 1})},
      {"a group", p,
       instead(p,
               [=](hid_t file) {
                 H5Gclose(H5Gcreate2(file, p, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
               })},
      {"another length than position", v,
       [=](hid_t file) {
         dataset(v, f64, {4, 3})(file);
         values(v, H5T_NATIVE_DOUBLE, std::vector<double>(12))(file);
       }},
      {"more rows than bytes", p, dataset(p, f64, {100, 3})},
      {"10^8 rows", p, dataset(p, f64, {100'000'000, 3})},
      {"2^50 rows", p, dataset(p, f64, {hsize_t{1} << 50, 3})},
      {"link to another file", p,
       instead(p,
               [=](hid_t file) {
                 H5Lcreate_external("/etc/passwd", "/", file, p, H5P_DEFAULT, H5P_DEFAULT);
               })},
      {"soft link", p,
       instead(p, [=](hid_t file) { H5Lcreate_soft(v, file, p, H5P_DEFAULT, H5P_DEFAULT); })},
      {"data in another file", p,
       dataset(p, f64, {5, 3}, [](hid_t list) { H5Pset_external(list, "/etc/passwd", 0, 120); })},
      {"compressed chunks", p,
       dataset(p, f64, {1'000'000, 3},
               [](hid_t list) {
                 const hsize_t chunk[2] = {1000, 3};
                 H5Pset_chunk(list, 2, chunk);
                 H5Pset_deflate(list, 9);
               })},
      {"NaN", "/restart/theta", attribute("/restart", "theta", f64, nan)},
      {"integer for a number", "/restart/theta", attribute("/restart", "theta", u64, seven)},
      {"integer for a text", "/restart/run", attribute("/restart", "run", u64, seven)},
      {"unknown format", "/restart/format", attribute("/restart", "format", u64, seven)},
      {"unknown wall", "/restart/cell/moving", attribute("/restart/cell", "moving", u64, seven)},
      {"unknown side", sides, values(sides, H5T_STD_U8LE, std::vector<std::uint8_t>{0, 1, 2, 4})},
      {"NaN observable", "/observables/phi/value",
       values("/observables/phi/value", f64, std::vector<double>{nan})}};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

TEST(HostileCheckpoint, AForgedObjectIsRejectedByName) {
  const Checkpoint unchanged = decode_checkpoint(forge([](hid_t) {}));
  EXPECT_EQ(state_hash(unchanged), state_hash(sample_checkpoint("a", 1, 5)));
  for (const Forgery& forgery : forgeries()) {
    SCOPED_TRACE(forgery.what);
    const std::vector<std::byte> image = forge(forgery.change);
    expect_refused<StoreDamaged>([&image] { decode_checkpoint(image); }, {forgery.named});
  }
}

// ---- Every byte and every length.

TEST(HostileCheckpoint, EveryTruncationIsRejected) {
  const std::vector<std::byte> whole = encode_checkpoint(sample_checkpoint("a", 1, 5));
  for (std::size_t size = 0; size < whole.size(); size += (size < 1100 ? 1 : 37)) {
    std::vector<std::byte> cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_THROW(decode_checkpoint(cut), StoreDamaged) << size;
    if (size <= kFrame) continue;
    EXPECT_THROW(decode_checkpoint(sealed(cut)), StoreDamaged) << size << ", with a valid digest";
  }
}

TEST(HostileCheckpoint, EveryChangedByteIsRejectedOrReadWithoutHarm) {
  const std::vector<std::byte> whole = encode_checkpoint(sample_checkpoint("a", 1, 2));
  std::size_t refused = 0, taken = 0;
  for (std::size_t at = kFrame; at < whole.size(); ++at) {
    for (const unsigned flip : {0x01U, 0x80U, 0xffU}) {
      std::vector<std::byte> changed = whole;
      changed[at] ^= static_cast<std::byte>(flip);
      try {
        decode_checkpoint(sealed(changed));
        ++taken;
      } catch (const StoreDamaged&) {
        ++refused;
      }
    }
  }
  std::printf("%zu forged files: %zu refused, %zu read\n", refused + taken, refused, taken);
  EXPECT_GT(refused, 1000U);
}

}  // namespace
}  // namespace shearcell
