// SPDX-License-Identifier: BSD-3-Clause
#include "hdf5/contents.hpp"

#include <fmt/format.h>

#include <H5Cpp.h>
#include <algorithm>
#include <cstring>
#include <set>

#include "base/apart.hpp"
#include "base/message.hpp"
#include "base/pack.hpp"

namespace straytrace::hdf5 {
namespace {

// Deflate makes at most 1032 bytes of one, and a real of two bytes becomes one of eight.
constexpr std::uint64_t deflated = 4400, always = 1 << 24;
constexpr int deepest = 16;

H5::FileAccPropList image_of(std::string const& bytes) {
  H5::FileAccPropList list;
  list.setCore(1 << 20, false);
  H5Pset_file_image(list.getId(), const_cast<char*>(bytes.data()), bytes.size());  // copies; the argument is not const
  return list;
}

H5::H5File opened(std::string const& image) {
  H5::Exception::dontPrint();
  return H5::H5File("straytrace-in-memory", H5F_ACC_RDONLY, H5::FileCreatPropList::DEFAULT, image_of(image));
}

Sizes shape_of(H5::DataSpace const& space) {
  if (space.getSimpleExtentType() == H5S_NULL) return {0};
  std::vector<hsize_t> sizes(std::size_t(space.getSimpleExtentNdims()));
  if (!sizes.empty()) space.getSimpleExtentDims(sizes.data());
  return {sizes.begin(), sizes.end()};
}

H5::PredType const& integer_type(std::uint64_t size, bool is_signed) {
  if (size == 1) return is_signed ? H5::PredType::NATIVE_INT8 : H5::PredType::NATIVE_UINT8;
  if (size == 2) return is_signed ? H5::PredType::NATIVE_INT16 : H5::PredType::NATIVE_UINT16;
  if (size == 4) return is_signed ? H5::PredType::NATIVE_INT32 : H5::PredType::NATIVE_UINT32;
  return is_signed ? H5::PredType::NATIVE_INT64 : H5::PredType::NATIVE_UINT64;
}

bool is_variable_text(H5::DataType const& type) {
  return type.getClass() == H5T_STRING && H5Tis_variable_str(type.getId()) > 0;
}

void cannot_be_read(Values& v) { v.state = State::unreadable, v.bytes.clear(); }

// Says what the values are; returns the type they have in memory.
H5::DataType describe(H5::DataType const& type, Values& v) {
  std::uint64_t const size = type.getSize();
  switch (type.getClass()) {
    case H5T_INTEGER:
      v.kind = Kind::integer, v.is_signed = H5Tget_sign(type.getId()) != H5T_SGN_NONE;
      v.size = size == 1 || size == 2 || size == 4 ? size : 8;
      return integer_type(v.size, v.is_signed);
    case H5T_FLOAT:
      v.kind = Kind::real, v.size = sizeof(double);
      return H5::PredType::NATIVE_DOUBLE;
    case H5T_STRING:
      v.kind = Kind::text, v.size = is_variable_text(type) ? sizeof(char*) : size;
      return type;
    default:
      v.kind = Kind::other;
      return type;
  }
}

// Of each text a pointer: as texts of one length, which is that of the longest.
void flatten(std::string const& pointers, Values& v) {
  std::vector<char const*> texts(pointers.size() / sizeof(char*));
  std::memcpy(texts.data(), pointers.data(), texts.size() * sizeof(char*));
  v.size = 1;
  for (char const*& text : texts) v.size = std::max<std::uint64_t>(v.size, std::strlen(text ? text : (text = "")));
  v.bytes.assign(v.size * texts.size(), '\0');
  for (std::size_t i = 0; i < texts.size(); ++i) std::string_view(texts[i]).copy(v.bytes.data() + i * v.size, v.size);
}

class Walk {
 public:
  Walk(std::uint64_t image_size, Wanted const& wanted)
      : left_(std::max(always, deflated * image_size)), wanted_(wanted) {}

  Contents all(H5::H5File const& file) {
    add_group(file.openGroup("/"), "/", 0);
    return std::move(contents_);
  }

 private:
  // A second name of a group, or a circle of them, brings nothing new.
  bool is_new(H5::Group const& group) {
    H5O_info_t info;
    return H5Oget_info2(group.getId(), &info, H5O_INFO_BASIC) >= 0 && seen_.insert(info.addr).second;
  }

  void add_group(H5::Group const& group, std::string const& path, int depth) {
    if (!is_new(group)) return;
    Object& here = contents_[path];
    here.is_group = true;
    add_attributes(group, here);
    std::string const before = path == "/" ? path : path + "/";
    for (hsize_t i = 0; i < group.getNumObjs(); ++i) {
      std::string const name = group.getObjnameByIdx(i);
      H5G_obj_t const type = group.getObjTypeByIdx(i);
      if (type == H5G_GROUP && depth < deepest) try_group(group, name, before + name, depth + 1);
      if (type == H5G_DATASET) add_dataset(group, name, before + name);
    }
    here.values.state = State::whole;
  }

  // A group or dataset that cannot be read leaves its state as it began: unreadable.
  void try_group(H5::Group const& parent, std::string const& name, std::string const& path, int depth) {
    try {
      add_group(parent.openGroup(name), path, depth);
    } catch (H5::Exception const&) {
      contents_[path].is_group = true;
    }
  }

  void add_dataset(H5::Group const& parent, std::string const& name, std::string const& path) {
    Object& here = contents_[path];
    try {
      H5::DataSet const set = parent.openDataSet(name);
      auto const read = [&](void* to, H5::DataType const& type) { set.read(to, type); };
      take(set, here.values, read, &path);
      add_attributes(set, here);
    } catch (H5::Exception const&) {
      cannot_be_read(here.values);
    }
  }

  void add_attributes(H5::H5Object const& object, Object& into) {
    for (int i = 0; i < object.getNumAttrs(); ++i) {
      H5::Attribute const a = object.openAttribute(unsigned(i));
      Values& here = into.attributes[a.getName()];
      try {
        take(
            a, here, [&](void* to, H5::DataType const& type) { a.read(type, to); }, nullptr);
      } catch (H5::Exception const&) {
        cannot_be_read(here);
      }
    }
  }

  // `path`: of a dataset, whose values may be left out.
  template <class Source, class Read>
  void take(Source const& source, Values& v, Read const& read, std::string const* path) {
    H5::DataType const type = source.getDataType(), memory = describe(type, v);
    v.shape = shape_of(source.getSpace());
    if (v.kind == Kind::other) return;
    std::uint64_t bytes = 0;
    v.state = State::impossible_size;
    if (__builtin_mul_overflow(v.count(), std::max<std::uint64_t>(v.size, 1), &bytes) || bytes > left_) return;
    v.state = State::left_out;
    if (path && !wanted_(*path, bytes)) return;
    v.state = State::unreadable;
    left_ -= bytes;
    v.bytes.resize(bytes);
    if (bytes > 0) read(v.bytes.data(), memory);
    if (is_variable_text(type)) flatten(std::string(std::move(v.bytes)), v);
    v.state = State::whole;
  }

  std::uint64_t left_;  // bytes that what is still to be read can have
  Wanted const& wanted_;
  std::set<haddr_t> seen_;
  Contents contents_;
};

[[noreturn]] void damaged(std::string const& how) { throw InputError("the HDF5 file is damaged: " + how); }

Contents read_here(std::string const& image, Wanted const& wanted) {
  try {
    return Walk(image.size(), wanted).all(opened(image));
  } catch (H5::Exception const&) {
    damaged("it cannot be opened");
  }
}

// In a copy of the process, which begins what it returns with its error, if there is one.
template <class Work>
std::string apart(std::string const& image, Work const& work) {
  auto const told = [&] {
    try {
      return '\0' + work();
    } catch (InputError const& e) {
      return '\1' + std::string(e.what());
    }
  };
  Apart const done = done_apart(told, (std::size_t{2} << 30) + 100 * image.size());
  if (!done.why.empty()) damaged(done.why);
  if (done.bytes.empty()) damaged("nothing could be read");
  std::string rest = done.bytes.substr(1);
  if (done.bytes[0] != '\0') throw InputError(rest);
  return rest;
}

std::vector<double> slab_here(std::string const& image, std::string const& path, hsize_t offset, hsize_t count) {
  std::vector<double> values(count);
  try {
    H5::H5File const file = opened(image);
    H5::DataSet const set = file.openDataSet(path);
    H5::DataSpace in_file = set.getSpace(), in_memory(1, &count);
    in_file.selectHyperslab(H5S_SELECT_SET, &count, &offset);
    set.read(values.data(), H5::PredType::NATIVE_DOUBLE, in_memory, in_file);
  } catch (H5::Exception const&) {
    damaged(fmt::format("'{}' cannot be read", path));
  }
  return values;
}

}  // namespace

std::uint64_t Values::count() const {
  std::uint64_t all = 1;
  for (std::uint64_t n : shape)
    if (__builtin_mul_overflow(all, n, &all)) return ~std::uint64_t{0};
  return all;
}

Contents contents_of(std::string const& image, Wanted const& wanted) {
  return unpacked(apart(image, [&] { return packed(read_here(image, wanted)); }));
}

Contents own_contents(std::string const& image) { return read_here(image, everything); }

std::vector<double> slab(std::string const& image, std::string const& path, std::uint64_t offset, std::uint64_t count) {
  std::string const bytes = apart(image, [&] {
    Packer out;
    out.add(slab_here(image, path, offset, count));
    return out.take();
  });
  return Unpacker(bytes).values<double>();
}

}  // namespace straytrace::hdf5
