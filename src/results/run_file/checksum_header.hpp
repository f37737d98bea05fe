// SPDX-License-Identifier: BSD-3-Clause
// The first 512 bytes of a run file: a readable line with the sha256 of all that follows (an HDF5 user block). It is
// verified before the HDF5 library, which can crash on damaged files, sees a byte.
#pragma once

#include <string>

namespace straytrace {

std::string with_checksum_header(std::string const& hdf5_image);
// The HDF5 image of a run file; throws InputError when `bytes` are not one, or damaged. `name` for the message.
std::string unsealed(std::string bytes, std::string const& name);

}  // namespace straytrace
