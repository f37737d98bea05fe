// SPDX-License-Identifier: BSD-3-Clause
// Reads the bytes of a file with the HDF5 library, in this process.
#include "io/hdf5/contents.hpp"

#include <fmt/format.h>

#include <H5Cpp.h>
#include <algorithm>
#include <cstring>

#include "base/errors.hpp"
#include "base/process/child_process.hpp"

namespace straytrace::io::hdf5 {

Contents load_contents(std::string const& image, Wanted const& wanted);
std::vector<double> slab_here(std::string const& image, std::string const& path, std::uint64_t offset,
                              std::uint64_t count);

[[noreturn]] void broken_file(std::string const& how);

namespace {

constexpr std::size_t gigabyte = std::size_t{1} << 30;

// In a copy of the process, whose last byte is the outcome.
template <class Work>
std::string apart(Work const& work, std::size_t memory, std::size_t image_size) {
  auto const told = [&] {
    try {
      return work() + '\0';
    } catch (InputError const& e) {
      return e.reason() + '\1';
    }
  };
  SandboxResult done = run_sandboxed(told, {memory, 10 + image_size / 500000});
  if (!done.why.empty()) throw InputError("the HDF5 library cannot read the file: " + done.why, copy_again);
  if (done.bytes.empty()) broken_file("nothing could be read");
  char const how = done.bytes.back();
  done.bytes.pop_back();
  if (how != '\0') throw InputError(done.bytes, copy_again);
  return std::move(done.bytes);
}

}  // namespace

std::uint64_t Values::count() const {
  std::uint64_t all = 1;
  for (std::uint64_t n : shape)
    if (__builtin_mul_overflow(all, n, &all)) return ~std::uint64_t{0};
  return all;
}

Contents contents_of(std::string const& image, Wanted const& wanted) {
  auto const work = [&] { return packed(load_contents(image, wanted)); };
  return unpacked(apart(work, 2 * gigabyte + 100 * image.size(), image.size()));
}

Contents own_contents(std::string const& image, Wanted const& wanted) { return load_contents(image, wanted); }

std::vector<double> slab(std::string const& image, std::string const& path, std::uint64_t offset, std::uint64_t count) {
  auto const work = [&] {
    Packer out;
    out.add(slab_here(image, path, offset, count));
    return out.take();
  };
  std::size_t const size = image.size() + count * sizeof(double);
  return Unpacker(apart(work, gigabyte + 6 * size, size)).values<double>();
}

namespace {

void add(Packer& out, Values const& v) {
  out.value(v.kind), out.value(v.state), out.value(std::uint8_t{v.is_signed});
  out.value(v.size), out.add(v.shape), out.add(v.bytes);
}

std::uint8_t below(Unpacker& in, unsigned limit) {
  auto const code = in.value<std::uint8_t>();
  if (code >= limit) throw InputError("what HDF5 has read has no meaning", copy_again);
  return code;
}

bool is_sound(Values const& v) {
  if (v.state != State::whole) return v.bytes.empty();
  bool size = true;
  if (v.kind == Kind::text) size = v.size > 0;
  if (v.kind == Kind::real) size = v.size == 4 || v.size == 8;
  if (v.kind == Kind::integer) size = v.size == 1 || v.size == 2 || v.size == 4 || v.size == 8;
  std::uint64_t bytes = 0;
  return size && !__builtin_mul_overflow(v.count(), v.size, &bytes) && v.bytes.size() == bytes;
}

Values values_of(Unpacker& in) {
  Values v;
  v.kind = Kind(below(in, 4)), v.state = State(below(in, 5)), v.is_signed = below(in, 2) != 0;
  v.size = in.count(), v.shape = in.values<std::uint64_t>(), v.bytes = in.text();
  if (!is_sound(v)) throw InputError("what HDF5 has read has no meaning", copy_again);
  return v;
}

}  // namespace

std::string packed(Contents const& contents) {
  Packer out;
  out.count(contents.size());
  for (auto const& [path, object] : contents) {
    out.add(path), out.value(std::uint8_t{object.is_group});
    add(out, object.values);
    out.count(object.attributes.size());
    for (auto const& [name, values] : object.attributes) out.add(name), add(out, values);
  }
  return out.take();
}

Contents unpacked(std::string_view bytes) {
  Unpacker in(bytes);
  Contents contents;
  for (std::uint64_t n = in.count(); n > 0; --n) {
    Object& object = contents[in.text()];
    object.is_group = below(in, 2) != 0;
    object.values = values_of(in);
    for (std::uint64_t k = in.count(); k > 0; --k) {
      std::string const name = in.text();
      object.attributes[name] = values_of(in);
    }
  }
  return contents;
}

namespace {

// Deflate makes at most 1032 bytes of one, and a real of two bytes becomes one of eight.
constexpr std::uint64_t deflated = 4400, always = 1 << 24;
constexpr std::uint64_t usual_text = 512;  // bytes of a text whose length is not known before it is read
constexpr std::size_t deepest = 16;
constexpr std::size_t most_objects = 1000000;

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

// Describes the values; returns their type in memory.
H5::DataType describe(H5::DataType const& type, Values& v) {
  std::uint64_t const size = type.getSize();
  switch (type.getClass()) {
    case H5T_INTEGER:
      v.kind = Kind::integer, v.is_signed = H5Tget_sign(type.getId()) != H5T_SGN_NONE;
      v.size = size == 1 || size == 2 || size == 4 ? size : 8;
      return integer_type(v.size, v.is_signed);
    case H5T_FLOAT:
      v.kind = Kind::real, v.size = size == sizeof(float) ? sizeof(float) : sizeof(double);
      return v.size == sizeof(float) ? H5::PredType::NATIVE_FLOAT : H5::PredType::NATIVE_DOUBLE;
    case H5T_STRING:
      v.kind = Kind::text, v.size = is_variable_text(type) ? sizeof(char*) : size;
      return type;
    default:
      v.kind = Kind::other;
      return type;
  }
}

// Of each text a pointer: as texts of one length, which is that of the longest.
void flatten(std::string const& pointers, std::uint64_t most_bytes, Values& v) {
  std::vector<char const*> texts(pointers.size() / sizeof(char*));
  std::memcpy(texts.data(), pointers.data(), texts.size() * sizeof(char*));
  v.size = 1;
  for (char const*& text : texts) v.size = std::max<std::uint64_t>(v.size, std::strlen(text ? text : (text = "")));
  v.state = State::impossible_size;
  if (!texts.empty() && v.size > most_bytes / texts.size()) return;
  v.state = State::whole;
  v.bytes.assign(v.size * texts.size(), '\0');
  for (std::size_t i = 0; i < texts.size(); ++i) std::string_view(texts[i]).copy(v.bytes.data() + i * v.size, v.size);
}

using Names = std::vector<std::string>;

// Hard links alone: others lead elsewhere, also into other files.
Names members_of(H5::Group const& group) {
  Names names;
  auto const add = [](hid_t, char const* name, H5L_info_t const* link, void* to) -> herr_t {
    if (link->type == H5L_TYPE_HARD) static_cast<Names*>(to)->emplace_back(name);
    return 0;
  };
  if (H5Literate(group.getId(), H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, add, &names) < 0)
    throw H5::GroupIException("members_of", "cannot list the group");
  return names;
}

Names attributes_of(H5::H5Object const& object) {
  Names names;
  auto const add = [](hid_t, char const* name, H5A_info_t const*, void* to) -> herr_t {
    static_cast<Names*>(to)->emplace_back(name);
    return 0;
  };
  if (H5Aiterate2(object.getId(), H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, add, &names) < 0)
    throw H5::AttributeIException("attributes_of", "cannot list the attributes");
  return names;
}

// Whether the values are in other files, whose names the file chooses freely.
bool is_elsewhere(H5::DataSet const& set) {
  H5::DSetCreatPropList const list = set.getCreatePlist();
  return H5Pget_layout(list.getId()) == H5D_VIRTUAL || H5Pget_external_count(list.getId()) != 0;
}

class Walk {
 public:
  Walk(std::uint64_t image_size, Wanted const& wanted)
      : left_(std::max(always, deflated * image_size)), wanted_(wanted) {}

  Contents all(H5::H5File const& file) {
    add_group(file.openGroup("/"), "/");
    return std::move(contents_);
  }

 private:
  void add_group(H5::Group const& group, std::string const& path) {
    Object& here = contents_[path];
    here.is_group = true;
    H5O_info_t info;
    bool const known = H5Oget_info2(group.getId(), &info, H5O_INFO_BASIC) >= 0;
    bool const circle = std::ranges::find(above_, info.addr) != above_.end();
    if (!known || circle || above_.size() > deepest) return;
    above_.push_back(info.addr);
    add_attributes(group, here);
    for (std::string const& name : members_of(group)) add_member(group, name, (path == "/" ? path : path + "/") + name);
    above_.pop_back();
    here.values.state = State::whole;
  }

  // Unreadable objects are listed with that state.
  void add_member(H5::Group const& group, std::string const& name, std::string const& path) {
    if (contents_.size() == most_objects) broken_file("it has more than a million groups and datasets");
    std::size_t const depth = above_.size();
    Object& here = contents_[path];
    try {
      H5O_type_t const type = group.childObjType(name);
      if (type == H5O_TYPE_GROUP) add_group(group.openGroup(name), path);
      if (type == H5O_TYPE_DATASET) add_dataset(group, name, path, here);
      if (type != H5O_TYPE_GROUP && type != H5O_TYPE_DATASET) contents_.erase(path);  // a named type
    } catch (H5::Exception const&) {
      cannot_be_read(here.values);
      above_.resize(depth);
    }
  }

  void add_dataset(H5::Group const& group, std::string const& name, std::string const& path, Object& here) {
    here.values.state = State::left_out;
    if (!wanted_.set(path)) return;
    cannot_be_read(here.values);
    H5::DataSet const set = group.openDataSet(name);
    bool const elsewhere = is_elsewhere(set);
    take(set, here.values, elsewhere ? 0 : wanted_.largest,
         [&](void* to, H5::DataType const& type) { set.read(to, type); });
    if (elsewhere) here.values.state = State::elsewhere, here.values.bytes.clear();
    add_attributes(set, here);
  }

  void add_attributes(H5::H5Object const& object, Object& into) {
    for (std::string const& name : attributes_of(object)) {
      Values& here = into.attributes[name];
      try {
        H5::Attribute const a = object.openAttribute(name);
        take(a, here, ~std::uint64_t{0}, [&](void* to, H5::DataType const& type) { a.read(type, to); });
      } catch (H5::Exception const&) {
        cannot_be_read(here);
      }
    }
  }

  template <class Source, class Read>
  void take(Source const& source, Values& v, std::uint64_t largest, Read const& read) {
    H5::DataType const type = source.getDataType(), memory = describe(type, v);
    v.shape = shape_of(source.getSpace());
    v.state = State::unreadable;
    if (v.kind == Kind::other) return;
    std::uint64_t bytes = 0;
    v.state = State::impossible_size;
    if (__builtin_mul_overflow(v.count(), std::max<std::uint64_t>(v.size, 1), &bytes) || bytes > left_) return;
    v.state = State::left_out;
    bool const variable = is_variable_text(type);
    if (bytes > largest || (variable && v.count() > 1 && bytes * usual_text > largest)) return;
    v.state = State::unreadable;
    left_ -= bytes;
    v.bytes.resize(bytes);
    if (bytes > 0) read(v.bytes.data(), memory);
    v.state = State::whole;
    if (variable) flatten(std::string(std::move(v.bytes)), left_, v);
  }

  std::uint64_t left_;  // bytes left for the remaining values
  Wanted const& wanted_;
  std::vector<haddr_t> above_;  // the groups that this one is in
  Contents contents_;
};

}  // namespace

void broken_file(std::string const& how) { throw InputError("the HDF5 file is damaged: " + how, copy_again); }

Contents load_contents(std::string const& image, Wanted const& wanted) {
  try {
    return Walk(image.size(), wanted).all(opened(image));
  } catch (H5::Exception const&) {
    broken_file("it cannot be opened");
  }
}

std::vector<double> slab_here(std::string const& image, std::string const& path, std::uint64_t offset,
                              std::uint64_t count) {
  std::vector<double> values(count);
  try {
    H5::H5File const file = opened(image);
    H5::DataSet const set = file.openDataSet(path);
    if (is_elsewhere(set)) broken_file(fmt::format("'{}' keeps its values in other files", path));
    hsize_t const first = offset, many = count;
    H5::DataSpace in_file = set.getSpace(), in_memory(1, &many);
    in_file.selectHyperslab(H5S_SELECT_SET, &many, &first);
    set.read(values.data(), H5::PredType::NATIVE_DOUBLE, in_memory, in_file);
  } catch (H5::Exception const&) {
    broken_file(fmt::format("'{}' cannot be read", path));
  }
  return values;
}

}  // namespace straytrace::io::hdf5
