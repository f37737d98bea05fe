// SPDX-License-Identifier: BSD-3-Clause
// Triangles for faces that have no carrier: B-splines and the like.
#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>

#include "step/cad_model.hpp"

namespace straytrace::step {

// Meshes all faces of a shape together, so that neighbours share the corners on their common edge; chords in m.
void prepare_triangles(TopoDS_Shape const&, double chord);
void add_triangles(TopoDS_Face const&, Triangles&);

}  // namespace straytrace::step
