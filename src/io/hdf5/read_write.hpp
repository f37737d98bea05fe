// SPDX-License-Identifier: BSD-3-Clause
// Typed arrays and texts of an HDF5 file. All functions throw InputError with the path of the missing or damaged
// object.
#pragma once

#include <H5Cpp.h>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "io/hdf5/contents.hpp"

namespace straytrace::io::hdf5 {

class Reader {
 public:
  explicit Reader(std::string const& image, Wanted const& wanted = {}) : Reader(contents_of(image, wanted)) {}
  explicit Reader(Contents contents) : contents_(std::move(contents)) {}

  bool has(std::string const& path) const;
  bool is_group(std::string const& path) const;
  std::vector<std::string> members(std::string const& group) const;  // names, ascending
  Object const& object(std::string const& path) const;
  Sizes shape(std::string const& path) const;
  // `columns`: required product of all dimensions but the first; the result has rows times columns elements.
  template <class T>
  std::vector<T> array(std::string const& path, std::size_t columns = 1) const;
  // Also requires the number of rows.
  template <class T>
  std::vector<T> rows(std::string const& path, std::size_t count, std::size_t columns = 1) const {
    std::vector<T> values = array<T>(path, columns);
    expect(path, values.size(), count * columns);
    return values;
  }
  std::vector<std::string> strings(std::string const& path) const;
  std::vector<std::string> strings(std::string const& path, std::size_t count) const;
  std::string text(std::string const& path) const;

  bool has_attribute(std::string const& path, std::string const& name) const;
  std::string attribute_text(std::string const& path, std::string const& name) const;
  double attribute_number(std::string const& path, std::string const& name) const;
  std::vector<std::uint64_t> attribute_counts(std::string const& path, std::string const& name) const;
  std::uint64_t attribute_count(std::string const& path, std::string const& name) const;

 private:
  static void expect(std::string const& path, std::size_t found, std::size_t wanted);
  Contents contents_;
};

// One number or one text; empty for other values.
std::optional<double> number_in(Values const&);
std::optional<std::string> text_in(Values const&);

// Typed arrays with units as an HDF5 file in memory, without time stamps: equal contents give equal bytes.

// Type in the file (little endian) and type in memory.
template <class T>
H5::PredType const& file_type() {
  if constexpr (std::is_same_v<T, double>) return H5::PredType::IEEE_F64LE;
  if constexpr (std::is_same_v<T, float>) return H5::PredType::IEEE_F32LE;
  if constexpr (std::is_same_v<T, std::uint64_t>) return H5::PredType::STD_U64LE;
  if constexpr (std::is_same_v<T, std::uint32_t>) return H5::PredType::STD_U32LE;
  if constexpr (std::is_same_v<T, std::uint8_t>) return H5::PredType::STD_U8LE;
}
template <class T>
H5::PredType const& memory_type() {
  if constexpr (std::is_same_v<T, double>) return H5::PredType::NATIVE_DOUBLE;
  if constexpr (std::is_same_v<T, float>) return H5::PredType::NATIVE_FLOAT;
  if constexpr (std::is_same_v<T, std::uint64_t>) return H5::PredType::NATIVE_UINT64;
  if constexpr (std::is_same_v<T, std::uint32_t>) return H5::PredType::NATIVE_UINT32;
  if constexpr (std::is_same_v<T, std::uint8_t>) return H5::PredType::NATIVE_UINT8;
}

// A file in memory, so that the library never meets a disk error.
class Writer {
 public:
  Writer();
  // The bytes of the file, valid until the next call on this writer.
  std::string_view image();
  std::string bytes() { return std::string(image()); }

  void group(std::string const& path, std::string const& meaning);
  // `shape`: sizes of the dimensions, row-major; their product is values.size().
  template <class T>
  void array(std::string const& path, std::vector<T> const& values, std::string const& unit, Sizes shape = {}) {
    if (shape.empty()) shape = {values.size()};
    raw(path, values.data(), file_type<T>(), memory_type<T>(), shape, unit);
  }
  void strings(std::string const& path, std::vector<std::string> const& values);
  void text(std::string const& path, std::string const& value);  // one string, verbatim

  // Attributes of a group or dataset.
  void attribute(std::string const& path, std::string const& name, std::string const& value);
  void attribute(std::string const& path, std::string const& name, double value);
  void attribute(std::string const& path, std::string const& name, std::vector<std::uint64_t> const& values);

 private:
  void raw(std::string const& path, void const* data, H5::DataType const& in_file, H5::DataType const& in_memory,
           Sizes const& shape, std::string const& unit);
  H5::H5File file_;
};

}  // namespace straytrace::io::hdf5
