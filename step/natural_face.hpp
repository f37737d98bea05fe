// SPDX-License-Identifier: BSD-3-Clause
// Faces that end at full circles about one axis, or nowhere: they need no loops.
#pragma once

#include <TopoDS_Face.hxx>

#include "step/chart.hpp"

namespace straytrace::step {

// Fills the frame and `within` of a face with natural bounds; returns whether it is one.
bool set_natural(TopoDS_Face const&, Chart const&, Face&);

}  // namespace straytrace::step
