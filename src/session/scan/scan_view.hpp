// SPDX-License-Identifier: BSD-3-Clause
// The table of a scan for people, spreadsheets and pictures.
#pragma once

#include <string>
#include <vector>

#include "session/scan/scan_axes.hpp"
#include "session/scan/scan_points.hpp"

namespace straytrace {

struct ScanTable {
  std::string model, line;  // file name; "0.1 x adv-lal", empty: not compared
  std::vector<ScanAxis> axes;
  std::vector<ScanPoint> points;
  std::size_t wanted = 0;  // points asked for
};

std::string scan_text(ScanTable const&);
std::string scan_csv(ScanTable const&);  // all digits
std::string scan_json(ScanTable const&);

}  // namespace straytrace
