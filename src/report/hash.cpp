// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>

#include "base/message.hpp"
#include "hdf5/hdf5.hpp"
#include "report/report.hpp"
#include "report/seal.hpp"

namespace straytrace {
namespace {

std::string shape_of(H5::DataSpace const& space) {
  std::vector<hsize_t> sizes(std::size_t(space.getSimpleExtentNdims()));
  if (!sizes.empty()) space.getSimpleExtentDims(sizes.data());
  return fmt::format("[{}]", fmt::join(sizes, ","));
}

std::string kind_of(H5::DataType const& type) {
  return fmt::format("type {} of {}", int(type.getClass()), type.getSize());
}

template <class Item>
std::string bytes_of(H5::DataType const& type, H5::DataSpace const& space, Item const& read) {
  std::string bytes(type.getSize() * std::size_t(space.getSimpleExtentNpoints()), '\0');
  if (!bytes.empty()) read(bytes.data());
  return bytes;
}

void add_attributes(Sha256& sum, H5::H5Object const& object, std::string const& path) {
  std::map<std::string, H5::Attribute> sorted;
  for (int i = 0; i < object.getNumAttrs(); ++i) {
    H5::Attribute const attribute = object.openAttribute(unsigned(i));
    sorted.emplace(attribute.getName(), attribute);
  }
  for (auto const& entry : sorted) {
    std::string const& name = entry.first;
    H5::Attribute const& attribute = entry.second;  // Clang 14 cannot hand a structured binding to a lambda
    if (path == "/" && name == "created") continue;
    H5::DataType const type = attribute.getDataType();
    H5::DataSpace const space = attribute.getSpace();
    sum.add_counted(fmt::format("{}@{} {} {}", path, name, kind_of(type), shape_of(space)));
    sum.add_counted(bytes_of(type, space, [&](char* into) { attribute.read(type, into); }));
  }
}

void add_group(Sha256& sum, H5::Group const& group, std::string const& path) {
  add_attributes(sum, group, path);
  std::map<std::string, H5O_type_t> children;
  for (hsize_t i = 0; i < group.getNumObjs(); ++i) {
    std::string const name = group.getObjnameByIdx(i);
    children[name] = group.childObjType(name);
  }
  for (auto const& [name, kind] : children) {
    std::string const full = path == "/" ? path + name : path + "/" + name;
    if (full == "/timing") continue;
    if (kind == H5O_TYPE_GROUP) {
      add_group(sum, group.openGroup(name), full);
      continue;
    }
    H5::DataSet const set = group.openDataSet(name);
    H5::DataType const type = set.getDataType();
    H5::DataSpace const space = set.getSpace();
    sum.add_counted(fmt::format("{} {} {}", full, kind_of(type), shape_of(space)));
    sum.add_counted(bytes_of(type, space, [&](char* into) { set.read(into, type); }));
    add_attributes(sum, set, full);
  }
}

}  // namespace

std::string model_hash(std::span<std::string const> texts) {
  Sha256 sum;
  for (std::string const& text : texts) sum.add_counted(text);
  return sum.hex();
}

std::string data_hash(std::string const& run_file) {
  hdf5::Reader const in(unsealed(read_file(run_file), run_file));
  try {
    Sha256 sum;
    add_group(sum, in.file().openGroup("/"), "/");
    return sum.hex();
  } catch (H5::Exception const&) {
    throw InputError(fmt::format("'{}' is damaged: its data cannot be read", run_file));
  }
}

std::string utc_now() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
}

}  // namespace straytrace
