// SPDX-License-Identifier: BSD-3-Clause
// Reads the bytes of a file with the HDF5 library, in this process.
#pragma once

#include "io/hdf5/contents.hpp"

namespace straytrace::io::hdf5 {

Contents load_contents(std::string const& image, Wanted const& wanted);
std::vector<double> slab_here(std::string const& image, std::string const& path, std::uint64_t offset,
                              std::uint64_t count);

[[noreturn]] void broken_file(std::string const& how);

}  // namespace straytrace::io::hdf5
