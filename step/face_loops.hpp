// SPDX-License-Identifier: BSD-3-Clause
// The trimming of a face as closed polygons in its chart.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <functional>
#include <optional>

#include "step/chart.hpp"

namespace straytrace::step {

// Edges that are straight in the chart stay so; others become polygons that stray by `tolerance` at most (m). Every
// loop is then moved outwards, so that neighbouring faces overlap and no light passes between them: by `seam` where it
// is exact, otherwise by the tolerance, and by what the file itself leaves open at the edge.
constexpr double seam = 1e-11;  // m: ten times the rounding of coordinates of 10 km

// `room`: by how much more an edge is moved outwards, m, because the face beyond it is only near it. Nothing when the
// file does not join the edges to loops around an area.
std::optional<std::vector<Loop>> loops_of(TopoDS_Face const&, Chart const&, double tolerance,
                                          std::function<double(TopoDS_Edge const&)> const& room);

double area_of(std::vector<Loop> const&);  // in units of the chart

}  // namespace straytrace::step
