// SPDX-License-Identifier: BSD-3-Clause
// `coating` of `specular`: a preset, or a table of shares against angle and wavelength
// (docs/reference/interfaces/coating.md).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/input/table.hpp"
#include "world/build/read_parts.hpp"

namespace straytrace {

// Nothing when the table is wrong, and reported.
std::optional<Coating> read_coating(Node const& specular, World&);

// Tables of shares of power against the angle of incidence and the wavelength, in the scene or in a file.

struct ShareTable {
  std::vector<double> angle;                           // rad
  std::vector<double> wavelength;                      // m, of each row; empty: the same numbers at every wavelength
  std::map<std::string, std::vector<double>> columns;  // power shares, one per angle; known names only
  std::vector<std::uint32_t> line;                     // of each row in the file; empty for a table in the scene
  std::string file;
};

// `node` is the name of a file or a table with `file`, or with `angle` and lists; problems go there, and an empty table
// comes back.
ShareTable read_share_table(Node const& node);

// Columns of shares a table may have besides `angle` and `wavelength`.
std::vector<std::string> const& share_columns();

}  // namespace straytrace
