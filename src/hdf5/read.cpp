// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/message.hpp"
#include "hdf5/hdf5.hpp"

namespace straytrace::hdf5 {
namespace {

constexpr hsize_t most_bytes = hsize_t{1} << 34;      // of one array; more means a damaged size
constexpr hsize_t deflated = 1100, always = 1 << 24;  // deflate makes at most 1032 bytes of one

[[noreturn]] void damaged(std::string const& path, std::string const& how) {
  throw InputError(fmt::format("the run file is damaged: '{}' {}", path, how));
}

// Turns what the library throws into one sentence with the path.
template <class Action>
auto guarded(std::string const& path, Action const& action) {
  try {
    return action();
  } catch (H5::Exception const&) {
    damaged(path, "is missing or cannot be read");
  }
}

H5::FileAccPropList image_of(std::string const& bytes) {
  H5::FileAccPropList list;
  list.setCore(1 << 20, false);
  H5Pset_file_image(list.getId(), const_cast<char*>(bytes.data()), bytes.size());  // copies; the argument is not const
  return list;
}

Sizes sizes_of(H5::DataSet const& set) {
  H5::DataSpace const space = set.getSpace();
  Sizes sizes(std::size_t(space.getSimpleExtentNdims()));
  if (!sizes.empty()) space.getSimpleExtentDims(sizes.data());
  return sizes;
}

std::string trimmed(char const* begin, std::size_t length) {
  std::string text(begin, length);
  text.erase(text.find_last_not_of('\0') + 1);
  return text;
}

std::size_t string_length(std::string const& path, H5::DataType const& type, hsize_t count) {
  if (type.getClass() != H5T_STRING || H5Tis_variable_str(type.getId()) > 0) damaged(path, "is not text");
  if (count > 0 && type.getSize() > most_bytes / count) damaged(path, "has an impossible size");
  return type.getSize();
}

template <class Action>
auto with_attribute(H5::H5File const& file, std::string const& path, std::string const& name, Action const& action) {
  return guarded(path + " attribute " + name, [&] {
    if (file.childObjType(path) == H5O_TYPE_DATASET) return action(file.openDataSet(path).openAttribute(name));
    return action(file.openGroup(path).openAttribute(name));
  });
}

}  // namespace

Reader::Reader(std::string const& bytes) : size_(bytes.size()) {
  H5::Exception::dontPrint();
  guarded("/", [&] {
    file_ = H5::H5File("straytrace-in-memory", H5F_ACC_RDONLY, H5::FileCreatPropList::DEFAULT, image_of(bytes));
    return 0;
  });
}

bool Reader::can_hold(hsize_t bytes) const { return bytes <= std::max(always, deflated * size_); }

bool Reader::has(std::string const& path) const {
  return guarded(path, [&] { return file_.nameExists(path); });
}

Sizes Reader::shape(std::string const& path) const {
  return guarded(path, [&] { return sizes_of(file_.openDataSet(path)); });
}

std::size_t Reader::elements(std::string const& path, std::size_t columns) const {
  Sizes const sizes = shape(path);
  if (sizes.empty()) damaged(path, "is not an array");
  hsize_t width = 1;
  for (std::size_t i = 1; i < sizes.size(); ++i)
    if (__builtin_mul_overflow(width, sizes[i], &width)) damaged(path, "has an impossible size");
  if (width != columns) damaged(path, fmt::format("has rows of {} values, expected {}", width, columns));
  if (columns > 0 && (sizes[0] > most_bytes / columns / sizeof(double) || !can_hold(sizes[0] * columns)))
    damaged(path, "has an impossible size");
  return std::size_t(sizes[0]) * columns;
}

void Reader::raw(std::string const& path, void* into, H5::DataType const& in_memory) const {
  guarded(path, [&] {
    H5::DataSet const set = file_.openDataSet(path);
    if (set.getSpace().getSimpleExtentNpoints() > 0) set.read(into, in_memory);
    return 0;
  });
}

void Reader::expect(std::string const& path, std::size_t found, std::size_t wanted) {
  if (found != wanted) damaged(path, fmt::format("has {} values, expected {}", found, wanted));
}

std::vector<std::string> Reader::strings(std::string const& path) const {
  return guarded(path, [&] {
    H5::DataSet const set = file_.openDataSet(path);
    Sizes const sizes = sizes_of(set);
    if (sizes.size() != 1) damaged(path, "is not a list");
    std::size_t const length = string_length(path, set.getDataType(), sizes[0]);
    std::string flat(length * sizes[0], '\0');
    if (!flat.empty()) set.read(flat.data(), set.getDataType());
    std::vector<std::string> values;
    for (std::size_t i = 0; i < sizes[0]; ++i) values.push_back(trimmed(flat.data() + i * length, length));
    return values;
  });
}

std::vector<std::string> Reader::strings(std::string const& path, std::size_t count) const {
  std::vector<std::string> values = strings(path);
  expect(path, values.size(), count);
  return values;
}

std::string Reader::text(std::string const& path) const {
  return guarded(path, [&] {
    H5::DataSet const set = file_.openDataSet(path);
    if (!sizes_of(set).empty()) damaged(path, "is not a text");
    std::string flat(string_length(path, set.getDataType(), 1), '\0');
    set.read(flat.data(), set.getDataType());
    return trimmed(flat.data(), flat.size());
  });
}

std::string Reader::attribute_text(std::string const& path, std::string const& name) const {
  return with_attribute(file_, path, name, [&](H5::Attribute const& a) {
    if (a.getSpace().getSimpleExtentNpoints() != 1) damaged(path, "has a list where text is expected");
    std::string flat(string_length(path, a.getDataType(), 1), '\0');
    a.read(a.getDataType(), flat.data());
    return trimmed(flat.data(), flat.size());
  });
}

double Reader::attribute_number(std::string const& path, std::string const& name) const {
  return with_attribute(file_, path, name, [&](H5::Attribute const& a) {
    if (a.getSpace().getSimpleExtentNpoints() != 1) damaged(path, "has a list where a number is expected");
    double value = 0;
    a.read(memory_type<double>(), &value);
    return value;
  });
}

std::vector<std::uint64_t> Reader::attribute_counts(std::string const& path, std::string const& name) const {
  return with_attribute(file_, path, name, [&](H5::Attribute const& a) {
    hssize_t const count = a.getSpace().getSimpleExtentNpoints();
    if (count < 1 || count > 64) damaged(path, "has a list of impossible length");
    std::vector<std::uint64_t> values(std::size_t(count), 0);
    a.read(memory_type<std::uint64_t>(), values.data());
    return values;
  });
}

std::uint64_t Reader::attribute_count(std::string const& path, std::string const& name) const {
  return attribute_counts(path, name).front();
}

}  // namespace straytrace::hdf5
