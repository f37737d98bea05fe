// SPDX-License-Identifier: BSD-3-Clause
// Importer of `newmtl` material lists: lines `newmtl NAME`, `TR t r` (shares of power transmitted and reflected),
// `IOR n lambda`, `PPM s_t s_r` (scattered on the transmitted and on the reflected side, parts per million).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/errors.hpp"

namespace straytrace::world {

struct NewmtlMaterial {
  std::string name;
  double transmit = 0, reflect = 0;
  double index = 1, wavelength = 0;                  // m; 0: not given
  double scatter_transmit = 0, scatter_reflect = 0;  // shares of power
  std::uint32_t line = 0;
};

// Problems have line and column but no file. A sum above 1 is a problem.
std::vector<NewmtlMaterial> read_newmtl(std::string_view text, std::vector<Problem>& problems);

// The same as the tables `media:` (indices other than 1) and `materials:` of a scene. Scatter becomes lambertian, as
// the list does not state its distribution.
std::string materials_table(std::vector<NewmtlMaterial> const&);

}  // namespace straytrace::world
