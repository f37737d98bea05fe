// SPDX-License-Identifier: BSD-3-Clause
// Typed arrays with units as an HDF5 file in memory, without time stamps: equal contents give equal bytes.
#pragma once

#include <H5Cpp.h>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "io/hdf5/contents.hpp"

namespace straytrace::io::hdf5 {

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

}  // namespace straytrace::io::hdf5
