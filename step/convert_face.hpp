// SPDX-License-Identifier: BSD-3-Clause
// One face of a file: its carrier with natural bounds or loops, or nothing where only triangles will do.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <functional>
#include <optional>

#include "step/cad_model.hpp"

namespace straytrace::step {

bool has_carrier(TopoDS_Face const&);
std::optional<Face> convert_face(TopoDS_Face const&, double tolerance,
                                 std::function<double(TopoDS_Edge const&)> const& room);

}  // namespace straytrace::step
