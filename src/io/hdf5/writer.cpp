// SPDX-License-Identifier: BSD-3-Clause
#include "io/hdf5/writer.hpp"

#include <algorithm>
#include <numeric>
#include <zlib.h>

namespace straytrace::io::hdf5 {
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
  list.setDeflate(4);
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

std::string Writer::bytes() {
  file_.flush(H5F_SCOPE_GLOBAL);
  ssize_t const size = H5Fget_file_image(file_.getId(), nullptr, 0);
  std::string image(std::size_t(std::max<ssize_t>(size, 0)), '\0');
  if (size <= 0 || H5Fget_file_image(file_.getId(), image.data(), image.size()) != size)
    throw H5::FileIException("Writer::bytes", "cannot take the bytes of the file");
  file_.close();
  return image;
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
