// SPDX-License-Identifier: BSD-3-Clause
// Tables of shares of power against the angle of incidence and the wavelength, in the scene or in a file.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/table.hpp"

namespace straytrace {

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
