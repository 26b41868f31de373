// SPDX-License-Identifier: GPL-3.0-or-later
// Files that are sound HDF5 under a right digest, and yet claim what a checkpoint must not claim.
#include <gtest/gtest.h>
#include <hdf5.h>

#include <cstring>
#include <functional>
#include <limits>

#include "provenance/checkpoint.hpp"
#include "provenance/errors.hpp"
#include "tests/provenance/samples.hpp"

namespace shearcell {
namespace {

using test::kFrame;
using test::seal;
using Change = std::function<void(hid_t file)>;

/// A sound checkpoint, changed through HDF5 itself and sealed again.
std::vector<std::byte> forge(const Change& change) {
  std::vector<std::byte> image = encode_checkpoint(test::sample_checkpoint("a", 1, 5));
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_fapl_core(access, 1 << 20, false);
  H5Pset_file_image(access, image.data(), image.size());
  const hid_t file = H5Fopen("forged", H5F_ACC_RDWR, access);
  EXPECT_GE(file, 0);
  change(file);
  H5Fflush(file, H5F_SCOPE_GLOBAL);
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  image.resize(kFrame + static_cast<std::size_t>(size));
  H5Fget_file_image(file, image.data() + kFrame, static_cast<std::size_t>(size));
  H5Fclose(file);
  H5Pclose(access);
  seal(image);
  return image;
}

void remove(hid_t file, const char* path) {
  EXPECT_GE(H5Ldelete(file, path, H5P_DEFAULT), 0);
}

void make_dataset(hid_t file, const char* path, hid_t type, std::vector<hsize_t> shape,
                  hid_t list = H5P_DEFAULT) {
  const hid_t space = H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
  const hid_t dataset = H5Dcreate2(file, path, type, space, H5P_DEFAULT, list, H5P_DEFAULT);
  EXPECT_GE(dataset, 0);
  H5Dclose(dataset);
  H5Sclose(space);
}

void set_attribute(hid_t file, const char* group, const char* name, hid_t type, const void* value) {
  H5Adelete_by_name(file, group, name, H5P_DEFAULT);
  const hid_t space = H5Screate(H5S_SCALAR);
  const hid_t attribute =
      H5Acreate_by_name(file, group, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  EXPECT_GE(H5Awrite(attribute, type, value), 0);
  H5Aclose(attribute);
  H5Sclose(space);
}

/// The message must name the object that is wrong.
void expect_refused(const std::string& named, const Change& change) {
  const std::vector<std::byte> image = forge(change);
  const std::string message =
      test::message_of<StoreDamaged>([&image] { decode_checkpoint(image); });
  EXPECT_NE(message.find(named), std::string::npos) << message;
}

TEST(ForgedCheckpoint, IsReadWhenNothingWasChanged) {
  const Checkpoint read = decode_checkpoint(forge([](hid_t) {}));
  EXPECT_EQ(state_hash(read), state_hash(test::sample_checkpoint("a", 1, 5)));
}

TEST(ForgedCheckpoint, LacksAnObject) {
  for (const char* path : {"/restart", "/restart/position", "/restart/velocity", "/restart/cell",
                           "/restart/cell/wall_grain_side", "/observables"}) {
    expect_refused(path, [path](hid_t file) { remove(file, path); });
  }
  for (const char* name : {"step", "run", "theta", "format", "wall_velocity"}) {
    expect_refused(std::string("/restart/") + name, [name](hid_t file) {
      EXPECT_GE(H5Adelete_by_name(file, "/restart", name, H5P_DEFAULT), 0);
    });
  }
}

TEST(ForgedCheckpoint, HasAnotherTypeOrShape) {
  const auto instead = [](hid_t type, const std::vector<hsize_t>& shape) {
    expect_refused("/restart/position", [&](hid_t file) {
      remove(file, "/restart/position");
      make_dataset(file, "/restart/position", type, shape);
    });
  };
  instead(H5T_IEEE_F32LE, {5, 3});
  instead(H5T_STD_I64LE, {5, 3});
  instead(H5T_IEEE_F64BE, {5, 3});
  instead(H5T_IEEE_F64LE, {5});
  instead(H5T_IEEE_F64LE, {5, 4});
  instead(H5T_IEEE_F64LE, {5, 3, 1});
  expect_refused("/restart/position", [](hid_t file) {
    remove(file, "/restart/position");
    H5Gclose(H5Gcreate2(file, "/restart/position", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  });
}

TEST(ForgedCheckpoint, HasListsThatDoNotFitEachOther) {
  expect_refused("/restart/velocity", [](hid_t file) {
    remove(file, "/restart/velocity");
    const double zeros[12] = {};
    make_dataset(file, "/restart/velocity", H5T_IEEE_F64LE, {4, 3});
    const hid_t dataset = H5Dopen2(file, "/restart/velocity", H5P_DEFAULT);
    H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, zeros);
    H5Dclose(dataset);
  });
}

TEST(ForgedCheckpoint, ClaimsMoreThanItHolds) {
  for (const hsize_t rows : {hsize_t{100}, hsize_t{100'000'000}, hsize_t{1} << 50}) {
    expect_refused("/restart/position", [rows](hid_t file) {
      remove(file, "/restart/position");
      make_dataset(file, "/restart/position", H5T_IEEE_F64LE, {rows, 3});
    });
  }
}

TEST(ForgedCheckpoint, ReachesOutsideOrUnpacksABomb) {
  expect_refused("/restart/position", [](hid_t file) {
    remove(file, "/restart/position");
    H5Lcreate_external("/etc/passwd", "/", file, "/restart/position", H5P_DEFAULT, H5P_DEFAULT);
  });
  expect_refused("/restart/position", [](hid_t file) {
    remove(file, "/restart/position");
    H5Lcreate_soft("/restart/velocity", file, "/restart/position", H5P_DEFAULT, H5P_DEFAULT);
  });
  expect_refused("/restart/position", [](hid_t file) {
    const hid_t list = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_external(list, "/etc/passwd", 0, 120);
    remove(file, "/restart/position");
    make_dataset(file, "/restart/position", H5T_IEEE_F64LE, {5, 3}, list);
    H5Pclose(list);
  });
  expect_refused("/restart/position", [](hid_t file) {
    const hid_t list = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk[2] = {1000, 3};
    H5Pset_chunk(list, 2, chunk);
    H5Pset_deflate(list, 9);
    remove(file, "/restart/position");
    make_dataset(file, "/restart/position", H5T_IEEE_F64LE, {1'000'000, 3}, list);
    H5Pclose(list);
  });
}

TEST(ForgedCheckpoint, HoldsImpossibleValues) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::uint64_t seven = 7;
  const std::uint8_t sides[4] = {0, 1, 2, 4};
  expect_refused("/restart/theta", [&](hid_t file) {
    set_attribute(file, "/restart", "theta", H5T_IEEE_F64LE, &nan);
  });
  expect_refused("/restart/theta", [&](hid_t file) {
    set_attribute(file, "/restart", "theta", H5T_STD_U64LE, &seven);
  });
  expect_refused("/restart/run", [&](hid_t file) {
    set_attribute(file, "/restart", "run", H5T_STD_U64LE, &seven);
  });
  expect_refused("/restart/format", [&](hid_t file) {
    set_attribute(file, "/restart", "format", H5T_STD_U64LE, &seven);
  });
  expect_refused("/restart/cell/moving", [&](hid_t file) {
    set_attribute(file, "/restart/cell", "moving", H5T_STD_U64LE, &seven);
  });
  expect_refused("/restart/cell/wall_grain_side", [&](hid_t file) {
    const hid_t dataset = H5Dopen2(file, "/restart/cell/wall_grain_side", H5P_DEFAULT);
    EXPECT_GE(H5Dwrite(dataset, H5T_STD_U8LE, H5S_ALL, H5S_ALL, H5P_DEFAULT, sides), 0);
    H5Dclose(dataset);
  });
  expect_refused("/observables/phi/value", [&](hid_t file) {
    const hid_t dataset = H5Dopen2(file, "/observables/phi/value", H5P_DEFAULT);
    EXPECT_GE(H5Dwrite(dataset, H5T_IEEE_F64LE, H5S_ALL, H5S_ALL, H5P_DEFAULT, &nan), 0);
    H5Dclose(dataset);
  });
}

TEST(ForgedCheckpoint, IsCutShortUnderARightDigest) {
  const std::vector<std::byte> whole = encode_checkpoint(test::sample_checkpoint("a", 1, 5));
  for (const std::size_t size :
       {kFrame + 1, kFrame + 8, kFrame + 96, whole.size() / 2, whole.size() - 1}) {
    std::vector<std::byte> cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    seal(cut);
    EXPECT_THROW(decode_checkpoint(cut), StoreDamaged) << size;
  }
  EXPECT_THROW(decode_checkpoint({}), StoreDamaged);
}

}  // namespace
}  // namespace shearcell
