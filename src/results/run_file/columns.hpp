// SPDX-License-Identifier: BSD-3-Clause
// Columns of tables in a run file. A list calls `column(name, unit, member)` for each column of a row type; the same
// list writes and reads the table.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "results/run_file/run_file.hpp"

namespace straytrace::results {

using Doubles = std::vector<double>;
using Counts = std::vector<std::uint64_t>;
using Small = std::vector<std::uint32_t>;
using Bytes = std::vector<std::uint8_t>;

// Attributes of a column: its unit and, for programs that show it, one phrase.
struct ColumnText {
  ColumnText(std::string of_values, std::string phrase = "") : unit(std::move(of_values)), meaning(std::move(phrase)) {}
  ColumnText(char const* of_values) : unit(of_values) {}
  std::string unit, meaning;
};

inline constexpr char const* yes_or_no = "0 or 1";

// A member of a member.
template <class Outer, class Inner>
auto through(Outer outer, Inner inner) {
  return [=](auto& row) -> auto& { return std::invoke(inner, std::invoke(outer, row)); };
}

// A column whose value, or array of values, is computed from a row and set in it.
template <class Get, class Set>
struct Converted {
  Get get;
  Set set;
  auto operator()(auto const& row) const { return get(row); }
};
template <class Get, class Set>
Converted(Get, Set) -> Converted<Get, Set>;

// How a value is stored: flags and enumerations as bytes, an array as so many numbers in each row.
template <class T>
struct Stored {
  using Type = std::conditional_t<std::is_same_v<T, bool> || std::is_enum_v<T>, std::uint8_t, T>;
  static constexpr std::size_t width = 0;  // no array
};
template <class T, std::size_t n>
struct Stored<std::array<T, n>> {
  using Type = T;
  static constexpr std::size_t width = n;
};
template <class T, std::size_t n>
struct Stored<T[n]> : Stored<std::array<T, n>> {};

// The rows of a list may be pointers to them.
template <class Row>
auto& row_at(Row& row) {
  if constexpr (std::is_pointer_v<std::remove_cvref_t<Row>>)
    return *row;
  else
    return row;
}

template <class Row>
class ColumnWriter {
 public:
  // `prefix`: of the paths of all columns.
  ColumnWriter(hdf5::Writer& out, std::string prefix, std::vector<Row> const& rows)
      : out_(out), prefix_(std::move(prefix)), rows_(rows) {}

  // `missing`: value in files that lack the column.
  template <class Member, class... Missing>
  void operator()(std::string const& name, ColumnText const& text, Member const& member, Missing const&...) const {
    using T = std::remove_cvref_t<decltype(std::invoke(member, row_at(rows_.front())))>;
    std::string const path = prefix_ + name;
    if constexpr (std::is_same_v<T, std::string>) {
      std::vector<std::string> values;
      for (Row const& row : rows_) values.push_back(std::invoke(member, row_at(row)));
      out_.strings(path, values);
    } else {
      write<T>(path, text.unit, member);
    }
    if (!text.meaning.empty()) out_.attribute(path, "meaning", text.meaning);
  }

 private:
  template <class T, class Member>
  void write(std::string const& path, std::string const& unit, Member const& member) const {
    constexpr std::size_t width = Stored<T>::width;
    std::vector<typename Stored<T>::Type> values;
    values.reserve(rows_.size() * (width > 0 ? width : 1));
    for (Row const& row : rows_) {
      auto const& value = std::invoke(member, row_at(row));
      if constexpr (width > 0)
        values.insert(values.end(), std::begin(value), std::end(value));
      else
        values.push_back(typename Stored<T>::Type(value));
    }
    out_.array(path, values, unit, width > 0 ? hdf5::Sizes{rows_.size(), width} : hdf5::Sizes{rows_.size()});
  }

  hdf5::Writer& out_;
  std::string prefix_;
  std::vector<Row> const& rows_;
};

enum class RowCount : std::uint8_t { as_given, of_first_column };

template <class Row>
class ColumnReader {
 public:
  // `rows` has as many rows as the table, or gets as many as the first column.
  ColumnReader(hdf5::Reader const& in, std::string prefix, std::vector<Row>& rows, RowCount count = RowCount::as_given)
      : in_(in), prefix_(std::move(prefix)), rows_(rows), count_(count) {}

  template <class Member>
  void operator()(std::string const& name, ColumnText const& /*text*/, Member const& member) {
    using T = std::remove_cvref_t<decltype(std::invoke(member, rows_.front()))>;
    std::string const path = prefix_ + name;
    if constexpr (std::is_same_v<T, std::string>) {
      std::vector<std::string> values = decides() ? in_.strings(path) : in_.strings(path, rows_.size());
      resize(values.size());
      for (std::size_t i = 0; i < rows_.size(); ++i) set(member, rows_[i], std::move(values[i]));
    } else {
      read<T>(path, member);
    }
  }
  template <class Member, class Missing>
  void operator()(std::string const& name, ColumnText const& text, Member const& member, Missing const& missing) {
    using T = std::remove_cvref_t<decltype(std::invoke(member, rows_.front()))>;
    if (in_.has(prefix_ + name)) return (*this)(name, text, member);
    for (Row& row : rows_) set(member, row, T(missing));
  }

 private:
  bool decides() const { return count_ == RowCount::of_first_column; }
  void resize(std::size_t rows) {
    if (decides()) rows_.resize(rows);
    count_ = RowCount::as_given;
  }
  template <class Member, class T>
  static void set(Member const& member, Row& row, T&& value) {
    if constexpr (requires { member.set(row, value); })
      member.set(row, value);
    else
      std::invoke(member, row) = std::forward<T>(value);
  }
  template <class T, class Member>
  void read(std::string const& path, Member const& member) {
    constexpr std::size_t width = Stored<T>::width, each = width > 0 ? width : 1;
    using Type = typename Stored<T>::Type;
    auto const values = decides() ? in_.array<Type>(path, each) : in_.rows<Type>(path, rows_.size(), each);
    resize(values.size() / each);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      auto const* const from = values.data() + each * i;
      if constexpr (width == 0) {
        set(member, rows_[i], T(*from));
      } else if constexpr (requires { member.set; }) {
        T value;
        std::copy_n(from, width, std::begin(value));
        member.set(rows_[i], value);
      } else {
        std::copy_n(from, width, std::begin(std::invoke(member, rows_[i])));
      }
    }
  }

  hdf5::Reader const& in_;
  std::string prefix_;
  std::vector<Row>& rows_;
  RowCount count_;
};

// The lists inside the rows of a table, laid end to end; list i is [offset[i], offset[i + 1]).
template <class Item>
struct EndToEnd {
  std::vector<Item const*> items;
  Counts offset = {0};
};
template <class Rows, class List>
auto end_to_end(Rows const& rows, List const& list) {
  EndToEnd<std::remove_cvref_t<decltype(*std::invoke(list, row_at(*std::begin(rows))).begin())>> all;
  for (auto const& row : rows) {
    for (auto const& item : std::invoke(list, row_at(row))) all.items.push_back(&item);
    all.offset.push_back(all.items.size());
  }
  return all;
}

// `offset`: the path of their offsets.
template <class Rows, class List, class Columns>
void write_lists(hdf5::Writer& out, std::string const& offset, std::string const& prefix, Rows const& rows,
                 List const& list, Columns const& columns) {
  auto const all = end_to_end(rows, list);
  out.array(offset, all.offset, "1");
  columns(ColumnWriter(out, prefix, all.items));
}

template <class Rows, class List, class Columns>
void read_lists(hdf5::Reader const& in, std::string const& offset, std::string const& prefix, Rows& rows,
                List const& list, Columns const& columns) {
  std::vector<std::remove_cvref_t<decltype(*std::invoke(list, rows.front()).begin())>> items;
  columns(ColumnReader(in, prefix, items, RowCount::of_first_column));
  Counts const offsets = read_offsets(in, offset, rows.size(), items.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    std::invoke(list, rows[i])
        .assign(std::make_move_iterator(items.begin() + std::ptrdiff_t(offsets[i])),
                std::make_move_iterator(items.begin() + std::ptrdiff_t(offsets[i + 1])));
}

// Products of phase sensitivities, of the nodes and of the routes.
template <class Column>
void product_columns(Column&& column) {
  column("_replica", "1", &PhaseSensitivityProduct::replica);
  column("_body", "row of /names/bodies",
         Converted{[](PhaseSensitivityProduct const& p) {
                     return std::array{p.first.value, p.second.value};
                   },
                   [](PhaseSensitivityProduct& p, std::array<std::uint32_t, 2> const& bodies) {
                     p.first = {bodies[0]};
                     p.second = {bodies[1]};
                   }});
  column("", "products of 3 x rad/m, 3 x rad/rad", &PhaseSensitivityProduct::sum);
}

}  // namespace straytrace::results
