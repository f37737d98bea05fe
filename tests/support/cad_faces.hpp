// SPDX-License-Identifier: BSD-3-Clause
// CAD faces of every carrier, trimmed to odd pieces.
#pragma once

#include "base/every_module.hpp"
#include "geometry/cad/cad_face.hpp"

namespace straytrace::testing {

inline Storage& outline_storage() {
  static Storage kept;
  return kept;
}
inline CadFace cad_face(Carrier carrier, double radius, double second, std::vector<ChartLoop> const& loops) {
  CadFace face;
  face.carrier = carrier;
  face.radius = radius;
  face.second = second;
  face.outline = prepare_outline(loops, outline_storage());
  face.place({});
  return face;
}
// Corners of a window, against the clock when seen from the front.
inline ChartLoop window(double x0, double x1, double y0, double y1) { return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}; }
inline ChartLoop hole(double x0, double x1, double y0, double y1) { return {{x0, y0}, {x0, y1}, {x1, y1}, {x1, y0}}; }

inline std::vector<CadFace> cad_faces() {
  ChartLoop const angle = {{0, 0}, {2, 0}, {2, 0.5}, {0.5, 0.5}, {0.5, 1}, {0, 1}};
  ChartLoop const lens = {{-0.5, -0.2, 0.4}, {0.6, 0.1, 0.9}}, ring = {{0.1, 0.1, -1}, {0, 0.1, -1}};
  std::vector<CadFace> all = {cad_face(Carrier::plane, 0, 0, {angle, hole(0.1, 0.3, 0.2, 0.4)}),
                              cad_face(Carrier::plane, 0, 0, {lens, ring}),
                              cad_face(Carrier::cylinder, 0.5, 0, {window(-0.25, 0.3, -0.2, 1)}),
                              cad_face(Carrier::cylinder, 0.5, 0, {window(0, 1, 0, 1), hole(0.2, 0.4, 0.3, 0.7)}),
                              cad_face(Carrier::cone, 0, 0.6, {{{0.1, 0.04}, {0.7, 0.04}, {0.4, 0.36}}}),
                              cad_face(Carrier::sphere, 2, 0, {window(0.8, 1.3, -0.5, 1.9)}),
                              cad_face(Carrier::sphere, 100, 0, {window(0, 0.5, 99.9, 100)}),
                              cad_face(Carrier::torus, 1, 0.3, {window(0.4, 0.9, 0.6, 1.2), hole(0.5, 0.6, 0.8, 0.9)}),
                              cad_face(Carrier::torus, 2, 1.9, {window(0, 1, 0.1, 0.4)})};
  for (std::size_t i = 0; i < all.size(); i += 3) all[i].sense = -1;
  return all;
}

}  // namespace straytrace::testing
