// SPDX-License-Identifier: BSD-3-Clause
// Points of a scan traced by several processes. Each run is what one process alone would have written, bit for bit: a
// trace depends on model, seed and histories only.
#pragma once

#include <atomic>
#include <set>

#include "app/scan_points.hpp"

namespace straytrace {

// Fills `runs/` of the folder with the traces that the points need, at most `jobs` at a time, each model once. The
// names of the run files that were made or continued. Complaints about a point are left to the scan that follows.
std::set<std::string> trace_together(std::vector<std::vector<std::string>> const& points, Options const&,
                                     Requirement const&, unsigned jobs, std::atomic<bool> const& stop);

}  // namespace straytrace
