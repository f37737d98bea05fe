// SPDX-License-Identifier: BSD-3-Clause
#include "io/hdf5/read_write.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <numeric>
#include <utility>
#include <zlib.h>

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

namespace {

constexpr std::size_t core_step = std::size_t{1} << 20;         // bytes the file in memory grows by
constexpr hsize_t compress_from = 16384, chunk_bytes = 262144;  // smaller arrays are stored as they are
constexpr std::size_t tried_bytes = 16384;                      // of a larger one

// Fixed length, padded with zeros: no heap, hence the same bytes for the same content. HDF5 has no type of length 0.
H5::StrType string_type(std::size_t length) {
  H5::StrType type(H5::PredType::C_S1, std::max<std::size_t>(length, 1));
  type.setStrpad(H5T_STR_NULLPAD);
  type.setCset(H5T_CSET_UTF8);
  return type;
}

H5::FileCreatPropList without_times() {
  H5::FileCreatPropList list;
  H5Pset_obj_track_times(list.getId(), false);
  return list;
}

H5::FileAccPropList in_memory() {
  H5::FileAccPropList list;
  list.setCore(core_step, false);
  return list;
}

// Whether compression saves a quarter of an array, tried at its beginning. Numbers of full precision keep 80 to 90 % of
// their size, and take most of the time of writing a run file.
bool pays(unsigned char const* data, std::size_t count, std::size_t element) {
  count = std::min(count, std::max<std::size_t>(tried_bytes / element, 1));
  std::vector<unsigned char> shuffled;
  shuffled.reserve(count * element);
  for (std::size_t byte = 0; byte < element; ++byte)
    for (std::size_t i = 0; i < count; ++i) shuffled.push_back(data[i * element + byte]);
  uLongf size = compressBound(shuffled.size());
  std::vector<unsigned char> compressed(size);
  compress2(compressed.data(), &size, shuffled.data(), shuffled.size(), Z_BEST_SPEED);
  return 4 * size < 3 * shuffled.size();
}

H5::DSetCreatPropList layout(void const* data, Sizes const& shape, std::size_t element) {
  H5::DSetCreatPropList list;
  H5Pset_obj_track_times(list.getId(), false);
  hsize_t const count = std::accumulate(shape.begin(), shape.end(), hsize_t{1}, std::multiplies<>());
  if (shape.empty() || count * element < compress_from) return list;
  if (!pays(static_cast<unsigned char const*>(data), count, element)) return list;
  std::vector<hsize_t> chunk(shape.begin(), shape.end());
  chunk[0] = std::clamp<hsize_t>(chunk_bytes / (count / shape[0] * element), 1, shape[0]);
  list.setChunk(int(chunk.size()), chunk.data());
  list.setShuffle();
  list.setDeflate(Z_BEST_SPEED);
  return list;
}

template <class Action>
void on_object(H5::H5File const& file, std::string const& path, Action const& action) {
  if (file.childObjType(path) == H5O_TYPE_DATASET)
    action(file.openDataSet(path));
  else
    action(file.openGroup(path));
}

void add_text(H5::H5Object const& object, std::string const& name, std::string const& value) {
  H5::StrType const type = string_type(value.size());
  std::string padded = value;
  padded.resize(type.getSize());
  object.createAttribute(name, type, H5::DataSpace(H5S_SCALAR)).write(type, padded.data());
}

}  // namespace

// Any name does: nothing is stored on disk.
Writer::Writer() {
  H5::Exception::dontPrint();
  file_ = H5::H5File("straytrace-in-memory", H5F_ACC_TRUNC, without_times(), in_memory());
}

std::string_view Writer::image() {
  file_.flush(H5F_SCOPE_GLOBAL);
  void* memory = nullptr;  // points to the address of the file in memory
  ssize_t const size = H5Fget_file_image(file_.getId(), nullptr, 0);
  if (size <= 0 || H5Fget_vfd_handle(file_.getId(), H5P_DEFAULT, &memory) < 0)
    throw H5::FileIException("Writer::image", "cannot take the bytes of the file");
  return {*static_cast<char const* const*>(memory), std::size_t(size)};
}

void Writer::group(std::string const& path, std::string const& meaning) {
  add_text(file_.createGroup(path), "meaning", meaning);
}

void Writer::raw(std::string const& path, void const* data, H5::DataType const& in_file, H5::DataType const& in_memory,
                 Sizes const& shape, std::string const& unit) {
  std::vector<hsize_t> const sizes(shape.begin(), shape.end());
  H5::DataSpace const space =
      shape.empty() ? H5::DataSpace(H5S_SCALAR) : H5::DataSpace(int(sizes.size()), sizes.data());
  H5::DataSet const set = file_.createDataSet(path, in_file, space, layout(data, shape, in_file.getSize()));
  if (space.getSimpleExtentNpoints() > 0) set.write(data, in_memory);
  add_text(set, "unit", unit);
}

void Writer::strings(std::string const& path, std::vector<std::string> const& values) {
  std::size_t longest = 1;
  for (std::string const& v : values) longest = std::max(longest, v.size());
  std::string flat(longest * values.size(), '\0');
  for (std::size_t i = 0; i < values.size(); ++i) values[i].copy(flat.data() + i * longest, longest);
  H5::StrType const type = string_type(longest);
  raw(path, flat.data(), type, type, {values.size()}, "text");
}

void Writer::text(std::string const& path, std::string const& value) {
  H5::StrType const type = string_type(value.size());
  std::string padded = value;
  padded.resize(type.getSize());
  raw(path, padded.data(), type, type, {}, "text");
}

void Writer::attribute(std::string const& path, std::string const& name, std::string const& value) {
  on_object(file_, path, [&](H5::H5Object const& object) { add_text(object, name, value); });
}

void Writer::attribute(std::string const& path, std::string const& name, double value) {
  on_object(file_, path, [&](H5::H5Object const& object) {
    object.createAttribute(name, file_type<double>(), H5::DataSpace(H5S_SCALAR)).write(memory_type<double>(), &value);
  });
}

void Writer::attribute(std::string const& path, std::string const& name, std::vector<std::uint64_t> const& values) {
  hsize_t const count = values.size();
  H5::DataSpace const space = count == 1 ? H5::DataSpace(H5S_SCALAR) : H5::DataSpace(1, &count);
  on_object(file_, path, [&](H5::H5Object const& object) {
    object.createAttribute(name, file_type<std::uint64_t>(), space).write(memory_type<std::uint64_t>(), values.data());
  });
}

}  // namespace straytrace::io::hdf5
