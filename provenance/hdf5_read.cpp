// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/hdf5_read.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "provenance/errors.hpp"
#include "provenance/limits.hpp"

namespace shearcell::hdf5 {

namespace {

static_assert(std::endian::native == std::endian::little,
              "the machine must be little-endian, because checkpoint files are");

/// Types of messages in an object header (section IV.A.2 of the format). Messages of other types
/// are ignored. If an object stores its links or its layout in an ignored message, it is read as an
/// object without links or without a layout.
enum Message : std::uint64_t {
  kSpace = 1,
  kType = 3,
  kLink = 6,
  kLayout = 8,
  kAttribute = 12,
  kContinuation = 16
};

// Datatype messages, byte for byte: class and version, bit field, size, and properties.
using namespace std::string_view_literals;
constexpr std::string_view kFloat64 =
    "\x11\x20\x3f\0\x08\0\0\0\0\0\x40\0\x34\x0b\0\x34\xff\x03\0\0"sv;
constexpr std::string_view kUnsigned64 = "\x10\0\0\0\x08\0\0\0\0\0\x40\0"sv;
constexpr std::string_view kUnsigned8 = "\x10\0\0\0\x01\0\0\0\0\0\x08\0"sv;
constexpr std::string_view kFixedText = "\x13";

std::string text_in(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Thrown when a block of bytes ends too early.
struct Short {};

/// Reads a block of bytes from front to back. Throws Short.
class Cursor {
 public:
  explicit Cursor(Bytes bytes) : rest_(bytes) {}
  Bytes take(std::uint64_t size) {
    if (size > rest_.size()) throw Short();
    const Bytes front = rest_.first(static_cast<std::size_t>(size));
    rest_ = rest_.subspan(static_cast<std::size_t>(size));
    return front;
  }
  std::uint64_t number(std::size_t bytes) {
    std::uint64_t value = 0;
    std::memcpy(&value, take(bytes).data(), bytes);
    return value;
  }
  /// Version 1 of the format pads to a multiple of eight bytes.
  Bytes take_padded(std::uint64_t size) {
    const Bytes front = take(size);
    take((8 - size % 8) % 8);
    return front;
  }
  Bytes rest() const { return rest_; }

 private:
  Bytes rest_;
};

/// Whether a datatype message begins with these bytes; padding after them is ignored.
bool is_type(Bytes found, std::string_view wanted) {
  return found.size() >= wanted.size() &&
         std::memcmp(found.data(), wanted.data(), wanted.size()) == 0;
}

/// Size of each dimension (empty for a scalar); nothing if the message is not supported. Maximum
/// sizes, which the message may hold after the sizes, are not read.
std::optional<std::vector<std::uint64_t>> shape_of(Bytes space) {
  Cursor cursor(space);
  const std::uint64_t version = cursor.number(1), rank = cursor.number(1);
  if (version != 1 || rank > 2) return std::nullopt;
  cursor.take(6);  // flags and reserved bytes
  std::vector<std::uint64_t> shape;
  for (std::uint64_t d = 0; d < rank; ++d) shape.push_back(cursor.number(8));
  return shape;
}

template <class T>
std::vector<T> values_in(Bytes block) {
  std::vector<T> values(block.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), block.data(), block.size());
  return values;
}

}  // namespace

void refuse(const std::string& where, const std::string& why) {
  throw StoreDamaged("checkpoint: " + where + ": " + why);
}

void Object::fail(const std::string& why) const {
  refuse(path_.empty() ? "/" : path_, why);
}

Bytes Object::at(std::uint64_t address, std::uint64_t size) const {
  if (address > file_.size() || size > file_.size() - address) fail("points outside the file");
  return file_.subspan(static_cast<std::size_t>(address), static_cast<std::size_t>(size));
}

Object Object::root(Bytes file) {
  constexpr std::size_t superblock_size = 96;
  if (file.size() < superblock_size) refuse("file", "it is truncated");
  Cursor cursor(file);
  // Version 0; addresses and lengths have 8 bytes.
  if (text_in(cursor.take(8)) != "\x89HDF\r\n\x1a\n") refuse("file", "it is not HDF5");
  const bool known = cursor.number(5) == 0 && cursor.number(2) == 0x0808;
  cursor.take(9);
  if (!known || cursor.number(8) != kFrameSize) {
    refuse("file", "its superblock is not one that this program writes");
  }
  cursor.take(8);
  if (cursor.number(8) != kFrameSize + file.size()) {
    refuse("file", "its size differs from the size in its superblock");
  }
  cursor.take(16);
  return {file, cursor.number(8), ""};
}

Object::Object(Bytes file, std::uint64_t address, std::string path)
    : file_(file), path_(std::move(path)) {
  try {
    Cursor prefix(at(address, 16));
    if (prefix.number(1) != 1) fail("has an unsupported object header");
    prefix.take(1);
    std::uint64_t messages = prefix.number(2);
    prefix.take(4);
    std::vector<Bytes> blocks = {at(address + 16, prefix.number(4))};
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      for (Cursor cursor(blocks[b]); cursor.rest().size() >= 8;) {
        // The count decreases, so blocks that point at each other cannot cause an endless loop.
        if (messages-- == 0) fail("has more messages than its header states");
        const std::uint64_t type = cursor.number(2), size = cursor.number(2);
        if ((cursor.number(1) & 2) != 0) fail("shares a message with another object");
        cursor.take(3);
        Cursor body(cursor.take(size));
        if (type == kContinuation) {
          const std::uint64_t next = body.number(8);
          blocks.push_back(at(next, body.number(8)));
        } else {
          read_message(type, body.rest());
        }
      }
    }
    if (messages != 0) fail("has fewer messages than its header announces");
  } catch (const Short&) {
    fail("is truncated");
  }
}

void Object::read_message(std::uint64_t type, Bytes body) {
  if (type == kSpace) shape_ = shape_of(body);
  if (type == kType) type_ = body;
  if (type == kLink) read_link(body);
  if (type == kAttribute) read_attribute(body);
  if (type == kLayout) read_layout(body);
}

void Object::read_link(Bytes body) {
  Cursor cursor(body);
  if (cursor.number(1) != 1) fail("has a link of an unknown version");
  const std::uint64_t flags = cursor.number(1);
  const bool hard = (flags & 8) == 0 || cursor.number(1) == 0;
  if ((flags & 4) != 0) cursor.take(8);   // creation order
  if ((flags & 16) != 0) cursor.take(1);  // character set
  const std::uint64_t length = cursor.number(std::size_t{1} << (flags & 3));
  if (length == 0 || length > StoreLimits::text) fail("holds a bad name");
  const std::string name = text_in(cursor.take(length));
  if (hard) links_.emplace(name, cursor.number(8));
  if (links_.size() > StoreLimits::observables) fail("holds too many entries");
}

void Object::read_attribute(Bytes body) {
  Cursor cursor(body);
  if (cursor.number(1) != 1) fail("has an attribute of an unknown version");
  cursor.take(1);
  const std::uint64_t name_size = cursor.number(2);
  const std::uint64_t type_size = cursor.number(2);
  const std::uint64_t space_size = cursor.number(2);
  const std::string name = text_in(cursor.take_padded(name_size));
  const Bytes type = cursor.take_padded(type_size), space = cursor.take_padded(space_size);
  attributes_.emplace(name.substr(0, name.find('\0')),
                      Attribute{type, shape_of(space), cursor.rest()});
}

void Object::read_layout(Bytes body) {
  Cursor cursor(body);
  if (cursor.number(1) != 3 || cursor.number(1) != 1)
    fail("is not stored contiguously in this file");
  const std::uint64_t address = cursor.number(8);
  layout_ = Layout{address, cursor.number(8)};
}

Object Object::child(const std::string& name) const {
  const auto found = links_.find(name);
  if (found == links_.end()) refuse(below(name), "is missing or is not a hard link");
  return {file_, found->second, below(name)};
}

/// The attribute, which must be a single value.
const Object::Attribute& Object::scalar(const std::string& name) const {
  const auto found = attributes_.find(name);
  if (found == attributes_.end()) refuse(below(name), "is missing");
  const auto& shape = found->second.shape;
  if (!shape || !shape->empty()) refuse(below(name), "is not a single value");
  return found->second;
}

/// The eight bytes of a single number of this data type.
Bytes Object::word(const std::string& name, std::string_view type) const {
  const Attribute& attribute = scalar(name);
  if (!is_type(attribute.type, type)) refuse(below(name), "has the wrong data type");
  if (attribute.data.size() < 8) refuse(below(name), "is truncated");
  return attribute.data.first(8);
}

double Object::number(const std::string& name) const {
  const double value = values_in<double>(word(name, kFloat64))[0];
  if (!std::isfinite(value)) refuse(below(name), "is not finite");
  return value;
}

std::uint64_t Object::count(const std::string& name) const {
  return values_in<std::uint64_t>(word(name, kUnsigned64))[0];
}

std::string Object::text(const std::string& name) const {
  const auto& [type, shape, data] = scalar(name);
  if (type.size() < 8 || !is_type(type, kFixedText)) {
    refuse(below(name), "is not a text of fixed length");
  }
  const auto length = Cursor(type.subspan(4)).number(4);
  if (length > std::min(data.size(), StoreLimits::text)) refuse(below(name), "is too long");
  const std::string value = text_in(data.first(static_cast<std::size_t>(length)));
  return value.substr(0, value.find('\0'));
}

/// Checks the type, shape, size and address of a dataset and returns its data.
Bytes Object::values(const std::string& name, std::string_view type, std::uint64_t columns,
                     std::size_t bytes_each) const {
  const Object dataset = child(name);
  if (!dataset.layout_) dataset.fail("is not stored contiguously in this file");
  if (!is_type(dataset.type_, type)) dataset.fail("has the wrong data type");
  const auto& shape = dataset.shape_;
  if (!shape || shape->size() != (columns == 0 ? 1 : 2) ||
      (columns != 0 && shape->back() != columns)) {
    dataset.fail("has a wrong shape");
  }
  if (shape->front() > StoreLimits::grains) dataset.fail("has too many rows");
  const std::uint64_t size = shape->front() * std::max<std::uint64_t>(columns, 1) * bytes_each;
  if (size == 0) return {};
  if (dataset.layout_->size != size) dataset.fail("has a size that does not match its shape");
  return dataset.at(dataset.layout_->address, size);
}

std::vector<double> Object::numbers(const std::string& name, std::uint64_t columns) const {
  auto data = values_in<double>(values(name, kFloat64, columns, sizeof(double)));
  if (!std::ranges::all_of(data, [](double x) { return std::isfinite(x); })) {
    refuse(below(name), "holds a number that is not finite");
  }
  return data;
}

std::vector<std::uint8_t> Object::bytes(const std::string& name) const {
  return values_in<std::uint8_t>(values(name, kUnsigned8, 0, 1));
}

}  // namespace shearcell::hdf5
