// SPDX-License-Identifier: BSD-3-Clause
// Paths of nearly equal strength share one spectrum.
#pragma once

#include <cstdint>
#include <vector>

#include "noise/motion_classes.hpp"
#include "trace/coupling.hpp"

namespace straytrace {

// A cell holds the records whose strengths kappa agree within a step of their logarithm in every motion class (two
// steps where the class is weak, so that coupling is linear; exactly zero stands apart), and is represented by their
// weighted mean. First order in the spread inside a cell is exact; second order leaves about 2e-4 at a step of 0.1.
struct Cells {
  std::vector<std::vector<double>> kappa;      // per cell and motion class
  std::vector<std::vector<std::uint32_t>> of;  // per coupling class and record: its cell
  double step = 0;                             // of ln kappa that was used
};

// `step` grows by half until there are at most `most` cells.
Cells make_cells(CouplingTable const&, MotionSet const&, std::vector<MotionClass> const&, double step = 0.1,
                 std::size_t most = 600);

}  // namespace straytrace
