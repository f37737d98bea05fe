// SPDX-License-Identifier: BSD-3-Clause
// The state of one path, the vertex it stands on, and the rolling name of its route.
#pragma once

#include "trace/result.hpp"
#include "world/world.hpp"

namespace straytrace {

// How the present direction was chosen.
struct Hop {
  double pdf =
      0;  // 1/sr, of this direction among all scattered ones, lobe probability included; 0: specular, no density
};

struct PathState {
  std::uint64_t history = 0;
  std::uint32_t event = 0;  // number of the vertex in its history; the source is 0
  Ray ray;
  Departure from;      // surface the ray starts on
  double power = 0;    // carried, relative to the main mode
  double emitted = 0;  // first scattered out of the mode by this history, relative to the main mode
  Hop hop;
  std::uint64_t route = 0;   // rolling hash of (group, event) of all vertices left so far
  std::uint32_t source = 0;  // footprint it started from
};

// A point on a surface that light has reached.
struct Vertex {
  SurfaceId surface;
  std::uint32_t piece = 0;
  Vec3 point;      // put back on its surface
  Frame frame;     // e3 = normal on the lit side
  Vec3 wi;         // towards where the light came from, local
  double leg = 0;  // m from the previous vertex
  Optic const* optic = nullptr;
  double albedo = 0;  // scattered share for this incidence; specular share is optic->reflect
};

STRAY_HD Vertex make_vertex(WorldView const& world, SurfaceId id, Vec3 point, Vec3 travel, std::uint32_t piece = 0) {
  Vertex v;
  v.surface = id;
  v.piece = piece;
  v.point = world.project(id, point, piece);
  Vec3 const normal = world.normal(id, v.point, piece);
  bool const front = dot(travel, normal) < 0;
  v.frame = Frame::around(front ? normal : -normal);
  v.wi = v.frame.to_local(-travel);
  Surface const& surface = world.surfaces[id.value];
  v.optic = &world.optics[front ? surface.front : surface.back];
  v.albedo = v.wi.z > 0 ? scatter_albedo(world.laws, *v.optic, v.wi.z) : 0;
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
