// SPDX-License-Identifier: BSD-3-Clause
// Orders of a grating at a vertex (docs/theory/surfaces.md, eq. 3.27 and 3.28). The trace and the beam tree share them.
#pragma once

#include "optics/coating/specular.hpp"
#include "world/model/vertex.hpp"

namespace straytrace::world {

// A specular way out of a vertex: reflection or transmission, or an order of a grating other than 0.
struct SpecularWay {
  Vec3 out;  // unit
  bool through = false;
  double share = 0;  // of the incident power, of a grating
  int order = 0;
  double turns = 0;  // phase of the order, in turns: its in-surface wave vector times the place
  STRAY_HD Event event() const { return order != 0 ? Event::diffract : through ? Event::transmit : Event::reflect; }
};

// Unit direction across the grooves in which order +1 turns the light, projected onto the surface: grooves x axis of
// the shape, whichever side is lit. `place`: m along it, before the projection.
STRAY_HD Vec3 across_grooves(WorldView const& world, Vertex const& v, double& place) {
  Surface const& surface = world.surfaces[v.surface.value];
  Vec3 const away = world.shapes.visit(surface.shape, [&](auto const& s) { return v.point - s.reference(); });
  Vec3 const axis = world.shapes.visit(surface.shape, [](auto const& s) { return s.axis; });
  Vec3 const run = v.optic->lay == Lay::around ? cross(axis, away) : v.optic->lay_direction;
  Vec3 const wide = cross(run, axis);
  double const size = length(wide);
  if (!(size > 0)) return {};
  Vec3 const across = (1 / size) * wide;
  place = dot(across, away);
  return across - dot(across, v.frame.e3) * v.frame.e3;
}

// Calls f(SpecularWay) for each order of the grating that propagates on one side.
template <class F>
STRAY_HD void for_each_order(WorldView const& world, Vertex const& v, Vec3 travel, bool through, F&& f) {
  Grating const& grating = grating_of(world.interfaces, *v.optic);
  double place = 0;
  Vec3 const across = across_grooves(world, v, place);
  for (std::int64_t i = 0; i < grating.count; ++i) {
    GratingOrder const& o = grating.order[i];
    double const share = through ? o.transmit : o.reflect;
    SpecularWay way;
    if (!(share > 0) || !diffracted(travel, v.frame.e3, (o.order * grating.turn) * across, v.n_in,
                                    through ? v.n_out : v.n_in, through, way.out))
      continue;
    way.through = through;
    way.share = share;
    way.order = static_cast<int>(o.order);
    way.turns = o.order * grating.density * place;
    f(way);
  }
}

// Share of all orders that propagate on one side.
STRAY_HD double diffracted_share(WorldView const& world, Vertex const& v, Vec3 travel, bool through) {
  double sum = 0;
  for_each_order(world, v, travel, through, [&](SpecularWay const& way) { sum += way.share; });
  return sum;
}

// The order chosen by `choice`, even from 0 to the share of that side.
STRAY_HD SpecularWay chosen_order(WorldView const& world, Vertex const& v, Vec3 travel, bool through, double choice) {
  SpecularWay chosen;
  bool found = false;
  for_each_order(world, v, travel, through, [&](SpecularWay const& way) {
    if (!found) chosen = way;
    found = found || choice < way.share;
    choice -= way.share;
  });
  return chosen;
}

}  // namespace straytrace::world
