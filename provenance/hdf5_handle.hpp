// SPDX-License-Identifier: GPL-3.0-or-later
// What writing and reading a checkpoint share: the file's frame, HDF5 handles, and one lock.
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <mutex>
#include <string>
#include <utility>

namespace shearcell::hdf5 {

/// The HDF5 user block before the HDF5 part: two lines of text, padded with zeros. It holds the
/// SHA-256 of all bytes after it, so that damage is found before HDF5 interprets anything.
inline constexpr std::size_t kFrameSize = 512;
inline constexpr const char* kFrameTitle = "shearcell checkpoint 1\n";

/// Version of the layout of /restart.
inline constexpr std::uint64_t kRestartFormat = 1;

/// HDF5 keeps global tables and need not be built thread-safe.
inline std::mutex& library_mutex() {
  static std::mutex mutex;
  return mutex;
}

/// Stops HDF5 from printing to standard error while it lives; the failed call's result tells.
class Quiet {
 public:
  Quiet() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Quiet() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

/// Owns an HDF5 identifier. A negative one stands for a failed call.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  hid_t get() const { return id_; }
  bool valid() const { return id_ >= 0; }

 private:
  hid_t id_;
  Close close_;
};

/// The text of the frame for a digest, without its padding.
inline std::string frame_text(const std::string& sha256) {
  return kFrameTitle + ("sha256 of all bytes after the first 512: " + sha256 + "\n");
}

}  // namespace shearcell::hdf5
