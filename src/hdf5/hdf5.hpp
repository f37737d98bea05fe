// SPDX-License-Identifier: BSD-3-Clause
// Small layer over the HDF5 C++ interface: typed arrays with units, without time stamps, from and to memory.
#pragma once

#include <H5Cpp.h>
#include <array>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

namespace straytrace::hdf5 {

using Sizes = std::vector<hsize_t>;

// Type in the file (little endian) and type in memory.
template <class T>
H5::PredType const& file_type();
template <class T>
H5::PredType const& memory_type();
template <>
inline H5::PredType const& file_type<double>() {
  return H5::PredType::IEEE_F64LE;
}
template <>
inline H5::PredType const& file_type<std::uint64_t>() {
  return H5::PredType::STD_U64LE;
}
template <>
inline H5::PredType const& file_type<std::uint32_t>() {
  return H5::PredType::STD_U32LE;
}
template <>
inline H5::PredType const& file_type<std::uint8_t>() {
  return H5::PredType::STD_U8LE;
}
template <>
inline H5::PredType const& memory_type<double>() {
  return H5::PredType::NATIVE_DOUBLE;
}
template <>
inline H5::PredType const& memory_type<std::uint64_t>() {
  return H5::PredType::NATIVE_UINT64;
}
template <>
inline H5::PredType const& memory_type<std::uint32_t>() {
  return H5::PredType::NATIVE_UINT32;
}
template <>
inline H5::PredType const& memory_type<std::uint8_t>() {
  return H5::PredType::NATIVE_UINT8;
}

// A file that lives in memory until its bytes are taken, so that no disk error ever meets the library.
class Writer {
 public:
  Writer();
  std::string bytes();  // closes the file

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

// Reads from the bytes of a file. Everything throws InputError with the path of what is missing or damaged.
class Reader {
 public:
  explicit Reader(std::string const& bytes);

  bool has(std::string const& path) const;
  Sizes shape(std::string const& path) const;
  // `columns`: required product of all dimensions but the first; the result has rows times columns elements.
  template <class T>
  std::vector<T> array(std::string const& path, std::size_t columns = 1) const {
    std::vector<T> values(elements(path, columns));
    raw(path, values.data(), memory_type<T>());
    return values;
  }
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

  std::string attribute_text(std::string const& path, std::string const& name) const;
  double attribute_number(std::string const& path, std::string const& name) const;
  std::vector<std::uint64_t> attribute_counts(std::string const& path, std::string const& name) const;
  std::uint64_t attribute_count(std::string const& path, std::string const& name) const;

  H5::H5File const& file() const { return file_; }
  // Whether the file can hold so many bytes of numbers, as compressed as they may be.
  bool can_hold(hsize_t bytes) const;

 private:
  std::size_t elements(std::string const& path, std::size_t columns) const;
  void raw(std::string const& path, void* into, H5::DataType const& in_memory) const;
  static void expect(std::string const& path, std::size_t found, std::size_t wanted);
  H5::H5File file_;
  std::size_t size_;
};

}  // namespace straytrace::hdf5
