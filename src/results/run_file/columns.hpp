// SPDX-License-Identifier: BSD-3-Clause
// Columns of tables in a run file. A list calls `column(name, unit, member)` for each column of a row type; the same
// list writes and reads the table.
#pragma once

#include <string>
#include <type_traits>
#include <vector>

#include "results/run_file/run_file.hpp"

namespace straytrace::results {

// The type in the file: flags and enumerations are bytes.
template <class T>
using StoredAs = std::conditional_t<std::is_same_v<T, bool> || std::is_enum_v<T>, std::uint8_t, T>;

template <class Row>
class ColumnWriter {
 public:
  ColumnWriter(hdf5::Writer& out, std::string group, std::vector<Row> const& rows)
      : out_(out), group_(std::move(group)), rows_(rows) {}

  // `missing`: value in files that lack the column.
  template <class Member, class... Missing>
  void operator()(char const* name, char const* unit, Member const& member, Missing const&... missing) const {
    static_assert(sizeof...(missing) <= 1);
    using T = std::remove_cvref_t<decltype(member(rows_.front()))>;
    std::vector<StoredAs<T>> values;
    values.reserve(rows_.size());
    for (Row const& row : rows_) values.push_back(StoredAs<T>(member(row)));
    std::string const path = group_ + "/" + name;
    if constexpr (std::is_same_v<T, std::string>)
      out_.strings(path, values);
    else
      out_.array(path, values, unit);
  }

 private:
  hdf5::Writer& out_;
  std::string group_;
  std::vector<Row> const& rows_;
};

template <class Row>
class ColumnReader {
 public:
  // `rows` has as many rows as the table.
  ColumnReader(hdf5::Reader const& in, std::string group, std::vector<Row>& rows)
      : in_(in), group_(std::move(group)), rows_(rows) {}

  template <class Member>
  void operator()(char const* name, char const* /*unit*/, Member const& member) const {
    using T = std::remove_cvref_t<decltype(member(rows_.front()))>;
    std::string const path = group_ + "/" + name;
    auto const values = [&] {
      if constexpr (std::is_same_v<T, std::string>)
        return in_.strings(path, rows_.size());
      else
        return in_.rows<StoredAs<T>>(path, rows_.size());
    }();
    for (std::size_t i = 0; i < rows_.size(); ++i) member(rows_[i]) = T(values[i]);
  }
  template <class Member, class Missing>
  void operator()(char const* name, char const* unit, Member const& member, Missing const& missing) const {
    if (in_.has(group_ + "/" + name)) return (*this)(name, unit, member);
    for (Row& row : rows_) member(row) = missing;
  }

 private:
  hdf5::Reader const& in_;
  std::string group_;
  std::vector<Row>& rows_;
};

}  // namespace straytrace::results
