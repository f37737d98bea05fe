// SPDX-License-Identifier: BSD-3-Clause
// Typed arrays and texts of an HDF5 file. All functions throw InputError with the path of the missing or damaged
// object.
#pragma once

#include <optional>

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

}  // namespace straytrace::io::hdf5
