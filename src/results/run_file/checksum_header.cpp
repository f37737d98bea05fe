// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>

#include "base/errors.hpp"
#include "io/hdf5/reader.hpp"
#include "results/results.hpp"
#include "results/run_file/run_file.hpp"

namespace straytrace::results {
namespace {

constexpr std::size_t block = 512;  // smallest user block of HDF5
constexpr std::string_view mark = "straytrace-run sha256 ";
constexpr std::string_view hdf5_mark = "\x89HDF\r\n\x1a\n";

}  // namespace

std::string with_checksum_header(std::string const& hdf5_image) {
  std::string bytes = fmt::format("{}{} bytes {}\n", mark, sha256(hdf5_image), hdf5_image.size());
  bytes.resize(block, '\0');
  return bytes + hdf5_image;
}

std::string unsealed(std::string bytes, std::string const& name) {
  if (!bytes.starts_with(mark)) {
    char const* what = bytes.empty()                  ? "the file is empty"
                       : bytes.starts_with(hdf5_mark) ? "it is an HDF5 file of another program"
                                                      : "its first bytes are not those of a run file";
    throw InputError(fmt::format("'{}' is not a straytrace run file: {}", name, what),
                     "name the run.h5 that straytrace run wrote, or a file of straytrace trace");
  }
  std::string const line = bytes.substr(0, bytes.find('\n'));
  if (bytes.size() > block) {
    bytes.erase(0, block);
    if (line == fmt::format("{}{} bytes {}", mark, sha256(bytes), bytes.size())) return bytes;
  }
  throw InputError(
      fmt::format("'{}' is damaged: its content does not match its checksum; it was cut short, or changed by another "
                  "program",
                  name),
      make_again);
}

namespace {

// Codes of HDF5 for the classes of types.
int class_of(hdf5::Kind kind) { return kind == hdf5::Kind::text ? 3 : kind == hdf5::Kind::real ? 1 : 0; }

void add_values(Sha256& sum, std::string const& name, hdf5::Values const& v) {
  if (v.state != hdf5::State::whole) throw InputError(fmt::format("'{}' cannot be read", name), make_again);
  sum.add_counted(fmt::format("{} type {} of {} [{}]", name, class_of(v.kind), v.size, fmt::join(v.shape, ",")));
  sum.add_counted(v.bytes);
}

void add_attributes(Sha256& sum, hdf5::Object const& object, std::string const& path) {
  for (auto const& [name, values] : object.attributes)
    if (path != "/" || name != "created") add_values(sum, path + "@" + name, values);
}

void add_group(Sha256& sum, hdf5::Reader const& in, std::string const& path) {
  add_attributes(sum, in.object(path), path);
  for (std::string const& name : in.members(path)) {
    std::string const full = path == "/" ? path + name : path + "/" + name;
    if (full == "/timing") continue;
    if (in.is_group(full)) {
      add_group(sum, in, full);
      continue;
    }
    add_values(sum, full, in.object(full).values);
    add_attributes(sum, in.object(full), full);
  }
}

}  // namespace

std::string model_hash(std::span<std::string const> texts) {
  Sha256 sum;
  for (std::string const& text : texts) sum.add_counted(text);
  return sum.hex();
}

std::string data_hash(std::string const& run_file) {
  std::string const image = unsealed(read_file(run_file), run_file);
  try {
    Sha256 sum;
    add_group(sum, hdf5::Reader(hdf5::own_contents(image)), "/");
    return sum.hex();
  } catch (InputError const& e) {
    throw InputError(fmt::format("'{}' cannot be compared: {}", run_file, e.reason()), make_again);
  }
}

std::string utc_now() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
}

}  // namespace straytrace::results
