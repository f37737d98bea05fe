// SPDX-License-Identifier: BSD-3-Clause
// What is good and what is doubtful about measured scatter. Page: docs/reference/scatter/measured_files.md.
#pragma once

#include <string_view>
#include <vector>

#include "world/scatter_data/scatter_file.hpp"

namespace straytrace {

// The total of one incidence, as shares of the incident power: BSDF cos over the hemisphere, with the BSDF of this
// incidence as a function of |alpha - alpha_0| alone.
struct IncidenceAudit {
  double theta_i = 0;  // rad
  std::size_t points = 0, limits = 0;
  double nearest = 0, farthest = 0;  // offsets
  double tis = 0;
  double sampling = 0;                // how much the total moves when every second point is left out
  double inside = 0, outside = 0;     // parts of `tis` nearer and farther than any point: extrapolated
  double stated = -1, integral = -1;  // what the file states, and the integral of its own table; below 0: nothing
};

struct ScatterAudit {
  std::vector<IncidenceAudit> incidences;
  std::size_t points = 0, limits = 0, duplicates = 0, turns = 0;  // turns: where the angle of scatter runs back
  // The same pair of directions measured both ways: ratio of the two values as |ln|.
  std::size_t pairs = 0;
  double worst_reciprocity = 0, rms_reciprocity = 0;
  double spread = 1;  // largest ratio of points of one incidence at the same offset
};
ScatterAudit audit_scatter(ScatterFile const&, std::string_view beyond);

}  // namespace straytrace
