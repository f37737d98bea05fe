// SPDX-License-Identifier: BSD-3-Clause
// The state of one path, the vertex it stands on, and the rolling name of its route.
#pragma once

#include "geometry/strips.hpp"
#include "trace/result.hpp"
#include "world/world.hpp"

namespace straytrace {

// How the present direction was chosen. The density of the mixture depends on what is hit, so the weight of the hop is
// completed on arrival (trace/estimate/mixture.hpp).
struct Hop {
  double kept = 1;                       // share of the power at the vertex left that travels on, on average
  double value = 1;                      // f |cos| [1/sr]; specular: 1
  double lobe = 1;                       // probability with which the lobe was chosen
  double law_pdf = 0;                    // 1/sr, of the scatter law; 0 marks a specular hop, which has no density
  double pdf = 0;                        // 1/sr, of the whole mixture with its lobe; set on arrival
  Event left_by = Event::emit;           // what happened at the vertex left
  std::uint32_t side = WorldView::none;  // whose targets take part in the mixture
  SurfaceId aim;                         // surface of the target drawn; invalid: the scatter law chose the direction
  double aim_distance = 0;               // m to the point drawn on it: anything hit earlier hides it
};

struct PathState {
  std::uint64_t history = 0;
  std::uint32_t event = 0;  // number of this vertex in its history, siblings counted; the source is 0
  std::uint32_t order = 0;  // surface events since the source
  Ray ray;
  Departure from;      // what the ray starts on
  double power = 0;    // carried, relative to the main mode
  double emitted = 0;  // first scattered out of the mode by this history, relative to the main mode
  Hop hop;
  std::uint64_t route = 0;   // rolling hash of (group, event) of all vertices left so far
  std::uint32_t source = 0;  // footprint it started from
};

// One history: its path and the siblings that wait, depth first.
struct History {
  static constexpr std::uint32_t most_waiting = 16;
  PathState path;
  std::uint32_t events = 0;  // vertices numbered so far
  std::uint32_t waiting = 0;
  PathState sibling[most_waiting];
  STRAY_HD std::uint32_t new_event() { return ++events; }
  STRAY_HD bool next_sibling() {
    if (waiting == 0) return false;
    path = sibling[--waiting];
    return true;
  }
};

// A point on a surface that light has reached.
struct Vertex {
  SurfaceId surface;
  std::uint32_t piece = 0;
  bool front = true;  // lit on the side its normal points to
  Vec3 point;         // put back on its surface
  Frame frame;        // e3 = normal on the lit side
  Vec3 wi;            // towards where the light came from, local
  double leg = 0;     // m from the previous vertex
  Optic const* optic = nullptr;
  double albedo = 0, reflect = 0, transmit = 0;  // shares scattered, reflected and transmitted for this incidence
  std::uint32_t strip = WorldView::none;         // of the steering tables
  STRAY_HD double kept() const { return albedo + reflect + transmit; }
  STRAY_HD std::uint32_t side() const {
    return strip == WorldView::none ? WorldView::none : 2 * strip + (front ? 0 : 1);
  }
};

STRAY_HD std::uint32_t strip_of(WorldView const& world, SurfaceId id, Vec3 point) {
  if (!world.steering.on()) return WorldView::none;
  double const u =
      world.shapes.visit(world.surfaces[id.value].shape, [&](auto const& s) { return strip_coordinate(s, point); });
  return world.steering.strip_at(id, u);
}

STRAY_HD Vertex make_vertex(WorldView const& world, SurfaceId id, Vec3 point, Vec3 travel, std::uint32_t piece = 0) {
  Vertex v;
  v.surface = id;
  v.piece = piece;
  v.point = world.project(id, point, piece);
  Vec3 const normal = world.normal(id, v.point, piece);
  v.front = dot(travel, normal) < 0;
  v.frame = Frame::around(v.front ? normal : -normal);
  v.wi = v.frame.to_local(-travel);
  Surface const& surface = world.surfaces[id.value];
  v.optic = &world.optics[v.front ? surface.front : surface.back];
  v.albedo = v.wi.z > 0 ? scatter_albedo(world.laws, *v.optic, v.wi.z) : 0;
  v.reflect = v.optic->reflect;
  v.strip = strip_of(world, id, v.point);
  return v;
}

// Routes are named by what they visit: the hash of a route does not depend on ids of other routes or on order of
// arrival.
STRAY_HD std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}
STRAY_HD std::uint64_t extended(std::uint64_t route, GroupId group, Event event) {
  return mixed(route * 0x9e3779b97f4a7c15ull + (std::uint64_t(group.value) << 8 | std::uint64_t(event)) + 1);
}

}  // namespace straytrace
