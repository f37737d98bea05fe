// SPDX-License-Identifier: BSD-3-Clause
// Faces of a CAD file as shapes: full cylinders, cones, caps and disks become those, all others a CadFace. All normals
// point out of the part.
#pragma once

#include <variant>

#include "base/storage.hpp"
#include "geometry/shape_types.hpp"
#include "world/cad_file.hpp"

namespace straytrace {

using CadShape = std::variant<CadFace, Disk, Cap, Sphere, Zone, Cylinder, Cone, Torus>;

// A shape with where it stands in the frame of the file.
struct PlacedCadShape {
  CadShape shape;
  Pose frame;
};

// `scale`: m per metre of the file.
PlacedCadShape cad_shape(CadFileFace const&, double scale, Storage&);

}  // namespace straytrace
