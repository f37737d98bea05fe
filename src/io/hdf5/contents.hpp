// SPDX-License-Identifier: BSD-3-Clause
// Contents of an HDF5 file as plain values. The HDF5 library crashes on some damaged files and exhausts the memory on
// others, so it reads them in a copy of the process (base/process/child_process.hpp).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/namespaces.hpp"

namespace straytrace::io::hdf5 {

using Sizes = std::vector<std::uint64_t>;

enum class Kind : std::uint8_t { integer, real, text, other };
// `elsewhere`: the values are in other files, which are never read.
enum class State : std::uint8_t { whole, left_out, impossible_size, elsewhere, unreadable };

// Of a dataset or an attribute.
struct Values {
  Kind kind = Kind::other;
  State state = State::unreadable;
  bool is_signed = false;
  std::uint64_t size = 0;  // bytes of one value: 1, 2, 4 or 8 of integers, 4 or 8 of reals; a text is padded with zeros
  Sizes shape;             // row-major; empty: one value
  std::string bytes;  // in the byte order of this machine; empty unless the state is `whole` and the kind not `other`

  std::uint64_t count() const;  // of values
};

struct Object {
  bool is_group = false;
  Values values;                             // of a dataset; of a group only the state, whether it was listed whole
  std::map<std::string, Values> attributes;  // by name
};

// By path from the root: "/", "/records", "/records/kappa". Links by name, also to other files, are not followed; an
// object with two names appears under both. A group inside itself, or inside 16 others, counts as unreadable.
using Contents = std::map<std::string, Object>;

struct Wanted {
  // Datasets to read; others are listed by path only.
  std::function<bool(std::string const& path)> set = [](std::string const&) { return true; };
  std::uint64_t largest = ~std::uint64_t{0};  // bytes; of larger datasets only shape and attributes are read
};

inline constexpr char const* copy_again = "copy the file again, or make it again";

// Of the bytes of a file. Throws InputError for other files, and when the library fails or crashes.
Contents contents_of(std::string const& image, Wanted const& wanted = {});
// The same in this process, which the library can end: for bytes that this program has just written, and for run files
// whose checksum holds. tools/lint/check_calls.py knows who calls it.
Contents own_contents(std::string const& image, Wanted const& wanted = {});

// `count` numbers of a list from `offset` on; throws InputError.
std::vector<double> slab(std::string const& image, std::string const& path, std::uint64_t offset, std::uint64_t count);

// Contents as bytes and back; throws InputError where they are cut short.
std::string packed(Contents const&);
Contents unpacked(std::string_view bytes);

}  // namespace straytrace::io::hdf5
