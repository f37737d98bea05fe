// SPDX-License-Identifier: BSD-3-Clause
// Normals at the corners of the triangles of a mesh, for reflection, refraction and scatter. Which side of a triangle
// light meets, where it meets it, and areas remain those of the flat facet. Page: docs/reference/shapes/mesh.md.
#pragma once

#include <vector>

#include "geometry/mesh/triangle_mesh.hpp"

namespace straytrace::geometry {

// The mesh with normals of its own: at each corner the mean of the normals of those triangles at the vertex that differ
// by at most `angle` [rad] from the triangle, weighted by their angles there.
MeshContent smoothed(MeshContent, double angle, Storage&);
// The same with stated normals, three per triangle in the frame of the file, of any length. One of length 0, and one at
// a right angle to its triangle or beyond, is replaced by the normal of the facet or turned to its side.
MeshContent smoothed(MeshContent, std::vector<MeshVertex> normals, Storage&);

}  // namespace straytrace::geometry
