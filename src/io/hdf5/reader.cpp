// SPDX-License-Identifier: BSD-3-Clause
#include "io/hdf5/reader.hpp"

#include <fmt/format.h>

#include <cstring>
#include <limits>
#include <utility>

#include "base/errors.hpp"

namespace straytrace::io::hdf5 {
namespace {

[[noreturn]] void damaged(std::string const& path, std::string const& how) {
  throw InputError(fmt::format("the HDF5 file is damaged: '{}' {}", path, how), copy_again);
}

std::string from_root(std::string const& path) { return path.starts_with('/') ? path : "/" + path; }

void require(std::string const& path, Values const& v) {
  if (v.state == State::impossible_size) damaged(path, "has an impossible size");
  if (v.state == State::elsewhere) damaged(path, "keeps its values in other files, which are not read");
  if (v.state == State::left_out) damaged(path, "was not read");
  if (v.state != State::whole) damaged(path, "is missing or cannot be read");
}

// The nearest value that T has; not-a-number becomes 0 where T has none.
template <class T, class Stored>
T nearest(Stored value) {
  if constexpr (std::is_floating_point_v<T>) {
    return T(value);
  } else if constexpr (std::is_floating_point_v<Stored>) {
    constexpr auto most = Stored(std::numeric_limits<T>::max());
    return value >= most ? std::numeric_limits<T>::max() : value > 0 ? T(value) : T(0);
  } else {
    if (std::cmp_less(value, 0)) return 0;
    return std::cmp_greater(value, std::numeric_limits<T>::max()) ? std::numeric_limits<T>::max() : T(value);
  }
}

template <class T, class Stored>
std::vector<T> copied(Values const& v) {
  std::vector<T> all(v.count());
  if constexpr (std::is_same_v<T, Stored>) {
    if (!all.empty()) std::memcpy(all.data(), v.bytes.data(), v.bytes.size());
    return all;
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    Stored one;
    std::memcpy(&one, v.bytes.data() + i * sizeof one, sizeof one);
    all[i] = nearest<T>(one);
  }
  return all;
}

template <class T>
std::vector<T> numbers(std::string const& path, Values const& v) {
  require(path, v);
  if (v.kind == Kind::real) return v.size == sizeof(float) ? copied<T, float>(v) : copied<T, double>(v);
  if (v.kind != Kind::integer) damaged(path, "is missing or cannot be read");
  switch (v.size) {
    case 1:
      return v.is_signed ? copied<T, std::int8_t>(v) : copied<T, std::uint8_t>(v);
    case 2:
      return v.is_signed ? copied<T, std::int16_t>(v) : copied<T, std::uint16_t>(v);
    case 4:
      return v.is_signed ? copied<T, std::int32_t>(v) : copied<T, std::uint32_t>(v);
    default:
      return v.is_signed ? copied<T, std::int64_t>(v) : copied<T, std::uint64_t>(v);
  }
}

std::vector<std::string> texts(std::string const& path, Values const& v) {
  require(path, v);
  if (v.kind != Kind::text) damaged(path, "is not text");
  std::vector<std::string> all;
  for (std::size_t i = 0; i < v.count(); ++i) {
    std::string text = v.bytes.substr(i * v.size, v.size);
    text.erase(text.find_last_not_of('\0') + 1);
    all.push_back(std::move(text));
  }
  return all;
}

Values const& attribute(Reader const& in, std::string const& path, std::string const& name) {
  auto const& all = in.object(path).attributes;
  auto const found = all.find(name);
  if (found == all.end()) damaged(path + " attribute " + name, "is missing or cannot be read");
  return found->second;
}

}  // namespace

std::optional<double> number_in(Values const& v) {
  if (v.state != State::whole || v.count() != 1 || (v.kind != Kind::real && v.kind != Kind::integer)) return {};
  return numbers<double>("", v)[0];
}

std::optional<std::string> text_in(Values const& v) {
  if (v.state != State::whole || v.count() != 1 || v.kind != Kind::text) return {};
  return v.bytes.substr(0, v.bytes.find('\0'));
}

bool Reader::has(std::string const& path) const { return contents_.contains(from_root(path)); }

bool Reader::is_group(std::string const& path) const { return has(path) && object(path).is_group; }

Object const& Reader::object(std::string const& path) const {
  auto const found = contents_.find(from_root(path));
  if (found == contents_.end()) damaged(path, "is missing or cannot be read");
  return found->second;
}

std::vector<std::string> Reader::members(std::string const& group) const {
  require(group, object(group).values);
  std::string const before = from_root(group) + (group == "/" ? "" : "/");
  std::vector<std::string> names;
  for (auto at = contents_.upper_bound(before); at != contents_.end() && at->first.starts_with(before); ++at)
    if (at->first.find('/', before.size()) == std::string::npos) names.push_back(at->first.substr(before.size()));
  return names;
}

Sizes Reader::shape(std::string const& path) const {
  Object const& set = object(path);
  if (set.is_group) damaged(path, "is not an array");
  return set.values.shape;
}

template <class T>
std::vector<T> Reader::array(std::string const& path, std::size_t columns) const {
  Sizes const sizes = shape(path);
  if (sizes.empty()) damaged(path, "is not an array");
  std::uint64_t width = 1;
  for (std::size_t i = 1; i < sizes.size(); ++i)
    if (__builtin_mul_overflow(width, sizes[i], &width)) damaged(path, "has an impossible size");
  if (width != columns) damaged(path, fmt::format("has rows of {} values, expected {}", width, columns));
  return numbers<T>(path, object(path).values);
}

template std::vector<double> Reader::array(std::string const&, std::size_t) const;
template std::vector<float> Reader::array(std::string const&, std::size_t) const;
template std::vector<std::uint64_t> Reader::array(std::string const&, std::size_t) const;
template std::vector<std::uint32_t> Reader::array(std::string const&, std::size_t) const;
template std::vector<std::uint8_t> Reader::array(std::string const&, std::size_t) const;

void Reader::expect(std::string const& path, std::size_t found, std::size_t wanted) {
  if (found != wanted) damaged(path, fmt::format("has {} values, expected {}", found, wanted));
}

std::vector<std::string> Reader::strings(std::string const& path) const {
  if (shape(path).size() != 1) damaged(path, "is not a list");
  return texts(path, object(path).values);
}

std::vector<std::string> Reader::strings(std::string const& path, std::size_t count) const {
  std::vector<std::string> values = strings(path);
  expect(path, values.size(), count);
  return values;
}

std::string Reader::text(std::string const& path) const {
  if (!shape(path).empty()) damaged(path, "is not a text");
  return texts(path, object(path).values)[0];
}

bool Reader::has_attribute(std::string const& path, std::string const& name) const {
  return object(path).attributes.contains(name);
}

std::string Reader::attribute_text(std::string const& path, std::string const& name) const {
  Values const& v = attribute(*this, path, name);
  if (v.count() != 1) damaged(path, "has a list where text is expected");
  return texts(path + " attribute " + name, v)[0];
}

double Reader::attribute_number(std::string const& path, std::string const& name) const {
  Values const& v = attribute(*this, path, name);
  if (v.count() != 1) damaged(path, "has a list where a number is expected");
  return numbers<double>(path + " attribute " + name, v)[0];
}

std::vector<std::uint64_t> Reader::attribute_counts(std::string const& path, std::string const& name) const {
  Values const& v = attribute(*this, path, name);
  if (v.count() < 1 || v.count() > 64) damaged(path, "has a list of impossible length");
  return numbers<std::uint64_t>(path + " attribute " + name, v);
}

std::uint64_t Reader::attribute_count(std::string const& path, std::string const& name) const {
  return attribute_counts(path, name).front();
}

}  // namespace straytrace::io::hdf5
