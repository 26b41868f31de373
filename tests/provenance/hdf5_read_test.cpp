// SPDX-License-Identifier: GPL-3.0-or-later
// Our reading of HDF5 beside the library's, and what becomes of files whose every byte was forged
// in turn under a right digest.
#include <gtest/gtest.h>
#include <hdf5.h>

#include <cstdio>
#include <cstring>

#include "core/limits.hpp"
#include "provenance/checkpoint.hpp"
#include "provenance/errors.hpp"
#include "tests/provenance/samples.hpp"

namespace shearcell {
namespace {

using test::kFrame;
using test::seal;

/// A file image opened by the library.
class Library {
 public:
  explicit Library(std::vector<std::byte> image) {
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_fapl_core(access, 1 << 20, false);
    H5Pset_file_image(access, image.data(), image.size());
    file_ = H5Fopen("image", H5F_ACC_RDONLY, access);
    H5Pclose(access);
    EXPECT_GE(file_, 0);
  }
  ~Library() { H5Fclose(file_); }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  std::vector<double> numbers(const std::string& path) const {
    const hid_t set = H5Dopen2(file_, path.c_str(), H5P_DEFAULT);
    EXPECT_GE(set, 0) << path;
    const hid_t space = H5Dget_space(set);
    std::vector<double> data(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    if (!data.empty()) {
      EXPECT_GE(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, data.data()), 0);
    }
    H5Sclose(space);
    H5Dclose(set);
    return data;
  }
  double attribute(const char* group, const char* name) const {
    double value = 0;
    const hid_t read = H5Aopen_by_name(file_, group, name, H5P_DEFAULT, H5P_DEFAULT);
    EXPECT_GE(H5Aread(read, H5T_NATIVE_DOUBLE, &value), 0) << name;
    H5Aclose(read);
    return value;
  }

 private:
  hid_t file_ = -1;
};

std::vector<double> columns(const Eigen::Matrix3Xd& m) {
  return {m.data(), m.data() + m.size()};
}

TEST(Hdf5Read, AgreesWithTheLibrary) {
  for (const int observables : {0, 1, 8, 9, 40, 1000}) {
    for (const Eigen::Index grains : {0, 1, 700}) {
      Checkpoint written = test::sample_checkpoint("a", 7, grains);
      written.observables.clear();
      for (int k = 0; k < observables; ++k) {
        written.observables["quantity " + std::to_string(k)] = 0.5 * k;
      }
      const std::vector<std::byte> image = encode_checkpoint(written);
      const Checkpoint read = decode_checkpoint(image);
      const Library library(image);
      EXPECT_EQ(columns(read.state.position), library.numbers("/restart/position"));
      EXPECT_EQ(columns(read.state.velocity), library.numbers("/restart/velocity"));
      EXPECT_EQ(read.cell.wall_grains.size() * 3,
                library.numbers("/restart/cell/wall_grain_position").size());
      EXPECT_EQ(read.theta, library.attribute("/restart", "theta"));
      EXPECT_EQ(static_cast<double>(read.state.step), library.attribute("/restart", "step"));
      EXPECT_EQ(read.cell.width, library.attribute("/restart/cell", "width"));
      EXPECT_EQ(read.observables, written.observables);
      for (const auto& [name, value] : read.observables) {
        EXPECT_EQ(library.numbers("/observables/" + name + "/value"), std::vector{value});
      }
      EXPECT_EQ(state_hash(read), state_hash(written));
    }
  }
}

TEST(Hdf5Read, RefusesToWriteWhatItWouldNotRead) {
  Checkpoint many = test::sample_checkpoint("a");
  for (std::size_t k = 0; k <= StoreLimits::observables; ++k) {
    many.observables[std::to_string(k)] = 0;
  }
  EXPECT_THROW(encode_checkpoint(many), std::invalid_argument);
  Checkpoint longwinded = test::sample_checkpoint("a");
  longwinded.observables[std::string(StoreLimits::text + 1, 'x')] = 0;
  EXPECT_THROW(encode_checkpoint(longwinded), std::invalid_argument);
}

TEST(Hdf5Read, AnyForgedByteIsRefusedOrReadWithoutHarm) {
  const std::vector<std::byte> sound = encode_checkpoint(test::sample_checkpoint("a", 1, 2));
  std::size_t refused = 0, taken = 0;
  for (std::size_t at = kFrame; at < sound.size(); ++at) {
    for (const unsigned flip : {0x01U, 0x80U, 0xffU}) {
      std::vector<std::byte> forged = sound;
      forged[at] ^= static_cast<std::byte>(flip);
      seal(forged);
      try {
        decode_checkpoint(forged);
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
