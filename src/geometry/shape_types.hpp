// SPDX-License-Identifier: BSD-3-Clause
// THE list of shapes. A new shape is one header, its keys, its page and its name here. A shape is a trivially copyable
// struct with `axis`, `key` and
//   place(pose)                 puts it into the world: origin of the shape, e3 its axis, e1 and e2 across
//   distance(ray, leaving)      m along the ray to the first hit in (0, t_max), infinity: none. `leaving`: the ray
//   starts
//                               ON this surface, so the root at zero is not a hit; no epsilon anywhere
//   normal(p)                   unit normal of the front side; the page of the shape says which side that is
//   project(p)                  a computed hit put back on the surface (one Newton step)
//   area()                      m^2
//   sample(u, v)                a point uniform in area
//   extent(low, high, r_min, r_max)  heights along `axis` from reference(), and distances from that axis, that contain
//                               the surface; r_min > 0 promises that nothing of it is nearer to the axis
//   bounds()                    box in the world that contains it
//   reference()                 the point its equations are written about
// Shapes made of many flat pieces: pieces.hpp.
#pragma once

#include <tuple>

#include "geometry/cad/cad_face.hpp"
#include "geometry/common/pieces.hpp"
#include "geometry/mesh/triangle_mesh.hpp"
#include "geometry/shapes/cap.hpp"
#include "geometry/shapes/cone.hpp"
#include "geometry/shapes/conic.hpp"
#include "geometry/shapes/cuboid.hpp"
#include "geometry/shapes/cylinder.hpp"
#include "geometry/shapes/disk.hpp"
#include "geometry/shapes/polygon.hpp"
#include "geometry/shapes/rectangle.hpp"
#include "geometry/shapes/sphere.hpp"
#include "geometry/shapes/torus.hpp"

namespace straytrace {

using ShapeTypes = std::tuple<Disk, Cap, Cylinder, Cone, Sphere, Conic, Rectangle, Ellipse, Polygon, Cuboid, Torus,
                              PiercedCylinder, SerratedCone, Zone, CutCylinder, TriangleMesh, CadFace>;

template <>
inline constexpr bool may_hide_itself<Torus> = true;
template <>
inline constexpr bool may_hide_itself<Conic> = true;  // with aspheric terms

template <>
inline constexpr bool may_hide_itself<CadFace> = true;  // of a torus

template <std::size_t... I>
STRAY_HD bool kind_may_hide_itself(std::uint32_t kind, std::index_sequence<I...>) {
  return ((kind == I && may_hide_itself<std::tuple_element_t<I, ShapeTypes>>) || ...);
}
STRAY_HD bool kind_may_hide_itself(std::uint32_t kind) {
  return kind_may_hide_itself(kind, std::make_index_sequence<std::tuple_size_v<ShapeTypes>>());
}

}  // namespace straytrace
